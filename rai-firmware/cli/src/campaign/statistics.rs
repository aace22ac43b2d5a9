//! Outcomes, levels and errors of a cell's epochs, under one fault and one judge.

use raim_core::frame::Enu;
use raim_core::report::{Report, Verdict};
use raim_core::requirements::Requirements;

use crate::outcomes::{Outcome, Outcomes};

/// Counts, levels and errors of many epochs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CellStatistics {
    outcomes: Outcomes,
    excluded: u64,
    hpl_m: Vec<f32>,
    vpl_m: Vec<f32>,
    horizontal_m2: f64,
    vertical_m2: f64,
    fixes: u64,
}

/// Columns that the statistics fill.
pub const COLUMNS: [&str; 14] = [
    "epochs",
    "protected",
    "alerts",
    "unavailable",
    "excluded",
    "misleading",
    "hazardous",
    "availability",
    "hpl_median_m",
    "hpl_99_m",
    "vpl_median_m",
    "vpl_99_m",
    "horizontal_rms_m",
    "vertical_rms_m",
];

impl CellStatistics {
    /// Adds an epoch; `error` is the error of the position.
    pub fn add<const N: usize>(&mut self, report: &Report<N>, error: Option<Enu>, limits: &Requirements) {
        self.excluded += u64::from(!report.excluded.is_empty());
        let levels = report.protection.map(|levels| (levels.hpl_m, levels.vpl_m));
        let (hpl_m, vpl_m) = levels.unwrap_or((f64::INFINITY, f64::INFINITY));
        self.hpl_m.push(hpl_m as f32);
        self.vpl_m.push(vpl_m as f32);
        if let Some(error) = error {
            self.fixes += 1;
            self.horizontal_m2 += error.horizontal() * error.horizontal();
            self.vertical_m2 += error.up * error.up;
        }
        let exceeds = |horizontal_m: f64, vertical_m: Option<f64>| {
            error.is_some_and(|error| {
                error.horizontal() > horizontal_m
                    || vertical_m.is_some_and(|vertical_m| error.up.abs() > vertical_m)
            })
        };
        self.outcomes.add(match report.verdict {
            Verdict::Protected(_) => Outcome::Promised {
                is_misleading: exceeds(hpl_m, limits.val_m.map(|_| vpl_m)),
                is_hazardous: exceeds(limits.hal_m, limits.val_m),
            },
            Verdict::Alert(_) => Outcome::Alert,
            Verdict::Unavailable(_) => Outcome::Unavailable,
        });
    }

    /// Formats the cells of a row, in the order of [`COLUMNS`].
    pub fn cells(mut self) -> String {
        let Outcomes { promised, alerts, unavailable, misleading, hazardous } = self.outcomes;
        let epochs = self.outcomes.epochs();
        let share = promised as f64 / epochs.max(1) as f64;
        let rms = |sum_m2: f64| if self.fixes == 0 { f64::NAN } else { (sum_m2 / self.fixes as f64).sqrt() };
        let (horizontal_m, vertical_m) = (rms(self.horizontal_m2), rms(self.vertical_m2));
        let hpl = [0.5, 0.99].map(|share| quantile(&mut self.hpl_m, share)).map(metres);
        let vpl = [0.5, 0.99].map(|share| quantile(&mut self.vpl_m, share)).map(metres);
        format!(
            "{epochs},{promised},{alerts},{unavailable},{},{misleading},{hazardous},{share:.6},{},{},{},{},{},{}",
            self.excluded,
            hpl[0],
            hpl[1],
            vpl[0],
            vpl[1],
            metres(horizontal_m),
            metres(vertical_m),
        )
    }
}

/// Returns the smallest value that a share of all values does not exceed, or NaN if there are none.
fn quantile(values: &mut [f32], share: f64) -> f64 {
    values.sort_by(f32::total_cmp);
    let rank = (share * values.len() as f64).ceil() as usize;
    values.get(rank.max(1) - 1).map_or(f64::NAN, |&value| f64::from(value))
}

/// Formats metres to the centimetre: `inf` without a level, an empty string for NaN.
fn metres(value: f64) -> String {
    if value.is_nan() { String::new() } else { format!("{value:.2}") }
}

#[cfg(test)]
mod tests {
    use super::{metres, quantile};

    #[test]
    fn quantiles_are_values_that_occur() {
        let mut values = [4.0, 1.0, 3.0, 2.0, f32::INFINITY];
        assert_eq!(metres(quantile(&mut values, 0.5)), "3.00");
        assert_eq!(metres(quantile(&mut values, 0.8)), "4.00");
        assert_eq!(metres(quantile(&mut values, 0.99)), "inf");
        assert!(quantile(&mut [], 0.5).is_nan());
    }
}
