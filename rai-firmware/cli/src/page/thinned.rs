//! Any number of epochs, thinned to as many as a picture has room for.
//!
//! All epochs are stored until [`MOST`] have come. Then each stretch of them gives way to its
//! extremes: the largest and the smallest value of every curve, the largest error against its
//! level, the first epoch of each verdict and the first with an exclusion. Stretches get longer as
//! more epochs come. An event of a single epoch is therefore in every picture.

use super::{Moment, Verdict};

/// Largest number of stored epochs: two for each pixel of a picture's width.
const MOST: usize = 2048;

/// Epochs of the first stretches.
const SHORTEST: u64 = 4;

/// Epochs, some of which represent others.
#[derive(Clone, Debug)]
pub struct Thinned {
    /// Stored epochs in the order of time, each with its number.
    kept: Vec<(u64, Moment)>,
    stretch: u64,
    all: u64,
    verdicts: [usize; 3],
}

impl Default for Thinned {
    fn default() -> Self {
        Self { kept: Vec::new(), stretch: SHORTEST, all: 0, verdicts: [0; 3] }
    }
}

impl Thinned {
    /// Takes the next epoch.
    pub fn push(&mut self, moment: Moment) {
        let verdict = match moment.verdict {
            Verdict::Protected => 0,
            Verdict::Alert => 1,
            Verdict::Unavailable => 2,
        };
        self.verdicts[verdict] += 1;
        self.kept.push((self.all, moment));
        self.all += 1;
        if self.kept.len() > MOST {
            // The epochs since the last time are thinned first, because longer stretches are for
            // epochs that are thin already.
            self.thin();
            while self.kept.len() > MOST / 2 {
                self.stretch *= 2;
                self.thin();
            }
        }
    }

    /// Replaces each stretch by its extremes.
    fn thin(&mut self) {
        let stretch = self.stretch;
        let kept = std::mem::take(&mut self.kept);
        for group in kept.chunk_by(|(one, _), (other, _)| one / stretch == other / stretch) {
            let moments: Vec<&Moment> = group.iter().map(|(_, moment)| moment).collect();
            self.kept.extend(extremes(&moments).into_iter().filter_map(|index| group.get(index).cloned()));
        }
    }

    /// Returns the stored epochs, in the order of time.
    pub fn moments(&self) -> Vec<Moment> {
        self.kept.iter().map(|(_, moment)| moment.clone()).collect()
    }

    /// Returns the number of all epochs.
    pub fn all(&self) -> u64 {
        self.all
    }

    /// Returns the number of all epochs of each verdict: protected, alert, unavailable.
    pub fn verdicts(&self) -> [usize; 3] {
        self.verdicts
    }
}

/// Returns the epochs of a stretch that show all events in it, in the order of time.
fn extremes(moments: &[&Moment]) -> Vec<usize> {
    type Value = fn(&Moment) -> Option<f64>;
    const CURVES: [Value; 7] = [
        |moment| moment.statistic,
        |moment| moment.hpl_m,
        |moment| moment.vpl_m,
        |moment| moment.horizontal_error_m,
        |moment| moment.vertical_error_m.map(f64::abs),
        |moment| Some(moment.horizontal_error_m? - moment.hpl_m?),
        |moment| Some(moment.vertical_error_m?.abs() - moment.vpl_m?),
    ];
    let first = |is: &dyn Fn(&Moment) -> bool| moments.iter().position(|moment| is(moment));
    let verdict = |verdict| first(&|moment: &Moment| moment.verdict == verdict);
    let mut found = vec![verdict(Verdict::Protected), verdict(Verdict::Alert), verdict(Verdict::Unavailable)];
    found.push(first(&|moment| !moment.excluded.is_empty()));
    for value in CURVES {
        let of = |(index, moment): (usize, &&Moment)| value(moment).map(|value| (value, index));
        let values = || moments.iter().enumerate().filter_map(of);
        let order = |one: &(f64, usize), other: &(f64, usize)| one.0.total_cmp(&other.0);
        found.push(values().max_by(order).map(|(_, index)| index));
        found.push(values().min_by(order).map(|(_, index)| index));
    }
    let mut found: Vec<usize> = found.into_iter().flatten().collect();
    found.sort_unstable();
    found.dedup();
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moment(number: u32) -> Moment {
        let is_alert = number == 70_001;
        Moment {
            time_s: f64::from(number),
            verdict: if is_alert { Verdict::Alert } else { Verdict::Protected },
            reason: "OK".to_owned(),
            statistic: Some(1.0 + f64::from(number * 7 % 100) * 1e-3),
            threshold: Some(2.0),
            hpl_m: Some(if number == 123_456 { 99.0 } else { 10.0 }),
            vpl_m: None,
            hal_m: Some(40.0),
            val_m: None,
            horizontal_error_m: Some(if number == 5 { 11.0 } else { 0.5 }),
            vertical_error_m: None,
            pin_is_high: Some(!is_alert),
            used: 9,
            excluded: Vec::new(),
        }
    }

    #[test]
    fn few_epochs_stay_as_they_are() {
        let mut thinned = Thinned::default();
        (0..MOST as u32).for_each(|number| thinned.push(moment(number)));
        assert_eq!(thinned.moments(), (0..MOST as u32).map(moment).collect::<Vec<_>>());
    }

    #[test]
    fn of_many_epochs_the_extremes_stay() {
        const MANY: u32 = 200_000;
        let mut thinned = Thinned::default();
        (0..MANY).for_each(|number| thinned.push(moment(number)));
        let kept = thinned.moments();
        assert!(kept.len() <= MOST && kept.len() > MOST / 8, "{}", kept.len());
        assert!(kept.is_sorted_by(|one, other| one.time_s < other.time_s));
        assert_eq!((thinned.all(), thinned.verdicts()), (u64::from(MANY), [199_999, 1, 0]));
        for number in [5, 70_001, 123_456] {
            assert!(kept.iter().any(|kept| *kept == moment(number)), "epoch {number}");
        }
        // The density of the curve is the same everywhere.
        let widest_s = kept.windows(2).map(|pair| pair[1].time_s - pair[0].time_s).fold(0.0, f64::max);
        assert!(widest_s < f64::from(MANY) / 100.0, "{widest_s} s");
    }
}
