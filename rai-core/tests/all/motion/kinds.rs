//! Ranges of two kinds in turn: of one frequency, and of pairs, which are three times as noisy.

use super::{Epoch, noise_m, report, velocity};
use raim_core::internals::continuity::Motion;
use raim_core::report::Alert;

/// Returns an epoch at rest, ten a second, of a noise that wanders within some eight seconds.
fn epoch(number: u32, size: f64) -> Epoch {
    let wander = |salt: u32| {
        let (before, share) = (number / 80 + salt, f64::from(number % 80) / 80.0);
        size * (noise_m(before) * (1.0 - share) + noise_m(before + 1) * share)
    };
    Epoch { time_s: f64::from(number) / 10.0, east_m: wander(0), clock_m: wander(7919), ..Epoch::default() }
}

fn alert(motion: &mut Motion, epoch: Epoch) -> Option<Alert> {
    motion.judge(epoch.time_s, &report(epoch), Ok(&velocity(epoch)))
}

/// Judges epochs of a noise; returns the number of alerts.
fn alerts(motion: &mut Motion, numbers: core::ops::Range<u32>, size: f64) -> usize {
    numbers.filter(|number| alert(motion, epoch(*number, size)).is_some()).count()
}

#[test]
fn pairs_may_be_noisier_than_what_one_frequency_has_taught() {
    for (is_told, want) in [(true, true), (false, false)] {
        let mut motion = Motion::new();
        assert_eq!(alerts(&mut motion, 0..6000, 1.0), 0);
        motion.restart();
        if is_told {
            motion.change_kind(3.0);
        }
        let false_alerts = alerts(&mut motion, 6000..36_000, 3.5);
        assert_eq!(false_alerts == 0, want, "{false_alerts} alerts, {is_told}");
    }
}

/// However often the kind changes, a walk is seen as soon as before.
#[test]
fn what_pairs_have_taught_hides_no_walk_of_one_frequency() {
    let mut motion = Motion::new();
    let mut begin = 0;
    for (noise, noisier) in [(1.0, 3.0), (3.5, 1.0), (1.0, 3.0), (3.5, 1.0), (1.0, 3.0), (3.5, 1.0)] {
        assert_eq!(alerts(&mut motion, begin..begin + 6000, noise), 0);
        begin += 6000;
        motion.restart();
        motion.change_kind(noisier);
    }
    let walk = |number: u32| {
        let at_rest = epoch(number, 1.0);
        Epoch { clock_m: at_rest.clock_m + 0.5 * (at_rest.time_s - f64::from(begin) / 10.0), ..at_rest }
    };
    let first = (begin..begin + 900).find(|number| alert(&mut motion, walk(*number)).is_some());
    assert!(first.is_some_and(|number| number - begin < 400), "{first:?} from {begin}");
}
