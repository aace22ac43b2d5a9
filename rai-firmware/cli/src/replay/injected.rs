//! Outcome of one injected fault: when the module noticed it, and what it did about it.

use std::fmt;

use super::track::Moment;
use crate::satellites::{Fate, View};
use crate::signal::fault::{Fault, Kind};

/// Outcome of one injected fault.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "commands", derive(serde::Serialize))]
pub struct Injected {
    /// Target of the fault, as on the command line.
    pub sat: String,
    /// Start of the fault, seconds after the first epoch.
    pub start: f64,
    /// End of the fault, seconds after the first epoch; `null` if it lasts.
    pub end: Option<f64>,
    /// Size of the fault, m; of a ramp the largest that was reached, `null` for an outage.
    pub bias_m: Option<f64>,
    /// Seconds from the start to the first alert or correct exclusion.
    pub first_alert_or_exclusion_s: Option<f64>,
    /// Epochs in which the faulty satellite was excluded.
    pub excluded_epochs: usize,
    /// Protected epochs in which a satellite without a fault was excluded.
    pub wrong_exclusions: usize,
    /// Epochs during the fault.
    pub epochs: usize,
    /// Protected epochs among these.
    pub protected_epochs: usize,
    /// Reason for which the faulty satellite was not used, if it never was; of a system, that of its first satellite.
    pub unused: Option<String>,
    /// True once the module has tested it.
    #[cfg_attr(feature = "commands", serde(skip))]
    is_tested: bool,
}

impl Injected {
    /// Returns the outcome of a fault before the first epoch.
    pub(super) fn of(fault: &Fault) -> Self {
        Self {
            sat: fault.target.to_string(),
            start: fault.start_s,
            end: Some(fault.end_s).filter(|end_s| end_s.is_finite()),
            bias_m: (!matches!(fault.kind, Kind::Outage)).then_some(0.0),
            first_alert_or_exclusion_s: None,
            excluded_epochs: 0,
            wrong_exclusions: 0,
            epochs: 0,
            protected_epochs: 0,
            unused: None,
            is_tested: false,
        }
    }

    /// Takes the fates of an epoch's satellites while the fault lasts.
    pub(super) fn look(&mut self, fault: &Fault, view: &View) {
        for account in view.satellites.iter().filter(|account| fault.target.covers(account.satellite)) {
            self.is_tested |= account.fate == Fate::Used || account.fate.is_excluded();
            self.unused.get_or_insert_with(|| account.fate.to_string());
        }
        self.unused.take_if(|_| self.is_tested);
    }

    /// Counts an epoch while the fault lasts.
    pub(super) fn count(&mut self, fault: &Fault, faults: &[Fault], moment: &Moment) {
        let output = moment.output.as_ref();
        let is_excluded = output.is_some_and(|output| {
            output.excluded.iter().any(|excluded| fault.target.covers(excluded.satellite))
        });
        if is_excluded || output.is_some_and(|output| output.state.state == 'A') {
            self.first_alert_or_exclusion_s.get_or_insert(moment.elapsed_s - fault.start_s);
        }
        let bias_m = fault.bias_m(moment.elapsed_s);
        self.bias_m = self.bias_m.map(|largest_m| largest_magnitude(largest_m, bias_m));
        self.excluded_epochs += usize::from(is_excluded);
        self.wrong_exclusions += usize::from(excludes_healthy(moment, faults));
        self.epochs += 1;
        self.protected_epochs += usize::from(output.is_some_and(|output| output.state.is_protected()));
    }
}

/// Returns true if a protected epoch excludes a satellite without a fault.
fn excludes_healthy(moment: &Moment, faults: &[Fault]) -> bool {
    let faulty = |satellite| {
        faults.iter().any(|fault| fault.is_active(moment.elapsed_s) && fault.target.covers(satellite))
    };
    moment.output.as_ref().is_some_and(|output| {
        output.state.is_protected() && output.excluded.iter().any(|excluded| !faulty(excluded.satellite))
    })
}

fn largest_magnitude(largest: f64, value: f64) -> f64 {
    if value.abs() > largest.abs() { value } else { largest }
}

impl fmt::Display for Injected {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (satellite, start_s) = (&self.sat, self.start);
        let Some(bias_m) = self.bias_m else {
            return write!(
                formatter,
                "injected outage of {satellite} from {start_s} s: {} epochs without it, {} of them protected",
                self.epochs, self.protected_epochs
            );
        };
        let noticed = match (self.first_alert_or_exclusion_s, &self.unused) {
            (Some(s), _) => format!("after {s:.1} s"),
            (None, Some(why)) => format!("never, because it was not used ({why})"),
            (None, None) => "never".to_owned(),
        };
        write!(
            formatter,
            "injected {satellite} {bias_m:+.1} m from {start_s} s: noticed {noticed}, excluded in {} epochs, wrong \
             exclusions {}",
            self.excluded_epochs, self.wrong_exclusions
        )
    }
}

#[cfg(test)]
mod tests {
    use raim_core::satellite::SatelliteId;

    use super::super::{Pace, Playback, RunningSummary, Window, encode};
    use super::*;
    use crate::signal::encode::{Frequency, Selection};
    use crate::signal::sky::raw::Simulation;

    #[test]
    fn a_satellite_below_the_mask_has_no_part_in_the_position() {
        let recording = Simulation::above_xian(0.0, 20, 1).record();
        let selection = Selection::new("GC", Frequency::Dual).unwrap();
        let outcome = |satellite: SatelliteId| {
            let fault = Fault::parse_inject(&format!("{satellite}:+80@5..15")).unwrap();
            let lumps = encode(&recording, &selection, &[fault], &Window::ALL).unwrap();
            let lumps = lumps.into_iter().map(Ok);
            let mut playback = Playback::start(lumps, &["MASK,30".to_owned()], Pace::Recorded).unwrap();
            playback.watch();
            let mut summary = RunningSummary::new(&[fault], false);
            while let Some((lump, reported)) = playback.advance().unwrap() {
                summary.count(&Moment::of(&lump, &reported, None));
                reported.view().into_iter().for_each(|view| summary.look(view, lump.elapsed_s));
            }
            summary.summary().injected[0].clone()
        };
        // The simulated signal of a satellite is the stronger, the higher it stands.
        let mut satellites = recording.epochs[0].satellites.clone();
        satellites.sort_by(|a, b| a.signals[0].cn0_dbhz.partial_cmp(&b.signals[0].cn0_dbhz).unwrap());
        let [lowest, .., highest] = &satellites[..] else { panic!("{satellites:?}") };
        let reported = outcome(lowest.satellite).to_string();
        assert!(reported.contains("never, because it was not used (below the elevation mask)"), "{reported}");
        let noticed = outcome(highest.satellite);
        assert_eq!(
            (noticed.first_alert_or_exclusion_s, noticed.excluded_epochs),
            (Some(0.0), 10),
            "{noticed}"
        );
        assert_eq!(noticed.unused, None);
    }
}
