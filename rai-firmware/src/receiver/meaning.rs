//! What the report of an epoch says about the sky and about the week.

use raim_core::report::{Alert, Report, Unavailable, Verdict};
use raim_core::satellite::Constellation;

/// Least degrees of freedom with which ambiguous ranges are a sign. With fewer, the noise of an
/// ordinary receiver leaves two explanations of one fault: all 247 ambiguous epochs of a car with
/// one to four degrees of freedom were.
const TELLING_DOF: u8 = 5;

/// Returns true for a report that counterfeit signals may cause.
pub(super) fn is_sign<const N: usize>(report: &Report<N>) -> bool {
    use Alert::{Ambiguous, Clock, Jump, Time, Track};
    match report.verdict {
        Verdict::Alert(Ambiguous) => report.test.is_some_and(|test| test.dof >= TELLING_DOF),
        verdict => matches!(verdict, Verdict::Alert(Clock | Jump | Time | Track)),
    }
}

/// Returns true if ranges agree with orbits that determine the week, even if not well enough for
/// protection. The tag is then right. GLONASS alone proves no week: its ephemerides state none, so
/// that they take the week of the tag.
pub(super) fn agree<const N: usize>(report: &Report<N>) -> bool {
    use Unavailable::{Accuracy, Emt, Hpl, Risk, Vpl};
    let is_contradicted = !matches!(
        report.verdict,
        Verdict::Protected(_) | Verdict::Unavailable(Hpl | Vpl | Emt | Accuracy | Risk)
    );
    !is_contradicted
        && report.used.iter().any(|satellite| satellite.constellation() != Constellation::Glonass)
}

#[cfg(test)]
mod tests {
    use raim_core::epoch::Epoch;
    use raim_core::report::TestStatistic;
    use raim_core::requirements::Requirements;
    use raim_single::CAPACITY;

    use super::*;

    #[test]
    fn ambiguous_ranges_of_few_satellites_are_no_sign_and_a_leap_always_is() {
        let npa = Requirements::non_precision_approach();
        let mut monitor = raim_single::Monitor::new(npa).expect("in the tables");
        let mut report = raim_single::process(&mut monitor, &Epoch::<CAPACITY>::new(0.0));
        for dof in 1..=40 {
            report.test = Some(TestStatistic::new(2.0, 1.0, dof));
            let signs = [Alert::Ambiguous, Alert::Track, Alert::Fault].map(|alert| {
                report.verdict = Verdict::Alert(alert);
                is_sign(&report)
            });
            assert_eq!(signs, [dof > 4, true, false], "{dof} degrees of freedom");
        }
    }
}
