//! A recorded receiver whose clock is steered, while its Doppler frequencies show an oscillator.

use adversary::attack::victim::Victim;
use raim::signal::encode::{Encoder, Frequency, Selection};
use raim::signal::measurement::MeasuredEpoch;
use raim_core::frame::SPEED_OF_LIGHT_M_S;
use rig::stations::STATIC_BASE;

/// Drift of the receiver's clock, m/s, by its own Doppler frequencies.
const OWN_M_S: f64 = -61.57;

/// Lets the rates say that the clock drifts by `steered_m_s` more than it does, and makes the ranges
/// shorter by `applied_m`.
fn steer(epoch: &mut MeasuredEpoch, steered_m_s: f64, applied_m: f64) {
    for satellite in &mut epoch.satellites {
        let system = satellite.satellite.constellation();
        for signal in &mut satellite.signals {
            let per_hz = signal.frequency_hz(system, 0).map(|hz| SPEED_OF_LIGHT_M_S / hz);
            signal.doppler_hz =
                signal.doppler_hz.zip(per_hz).map(|(doppler_hz, per_hz)| doppler_hz - steered_m_s / per_hz);
            signal.pseudorange_m -= applied_m;
        }
    }
}

/// Returns the protected epochs of five minutes.
fn protected(frequency: Frequency, steered_m_s: f64, applied_m_s: f64) -> Option<usize> {
    let promised = promised(frequency, steered_m_s, |second_s| applied_m_s * second_s)?;
    Some(promised.iter().filter(|is_promised| **is_promised).count())
}

/// Returns whether each second is promised, if the ranges are shorter by `applied_m` of it.
fn promised(frequency: Frequency, steered_m_s: f64, applied_m: impl Fn(f64) -> f64) -> Option<Vec<bool>> {
    let recording = STATIC_BASE.load()?;
    let selection = Selection::new("GCE", frequency).expect("systems");
    let mut encoder = Encoder::new(&recording.ephemerides, selection);
    let mut victim = Victim::new(&[], 1.0).expect("a module");
    let mut promised = Vec::new();
    for (second, epoch) in (0_u32..).zip(&recording.epochs) {
        let mut epoch = epoch.clone();
        steer(&mut epoch, steered_m_s, applied_m(f64::from(second)));
        let bytes = encoder.epoch(&epoch).expect("bytes");
        let seen = victim.receive(&bytes, STATIC_BASE.truth).expect("sentences");
        promised.push(seen.iter().all(|seen| seen.is_promised));
    }
    Some(promised)
}

#[test]
fn a_receiver_that_steers_its_clock_once_a_second_is_protected() {
    for frequency in [Frequency::Dual, Frequency::Single] {
        for steered_m_s in [0.1, -0.1, 0.5, 2.0, -15.0, 100.0, 265.7, 1000.0] {
            let Some(promised) = protected(frequency, steered_m_s, 0.0) else { return };
            assert!(promised >= 295, "{steered_m_s} m/s, {frequency:?}: {promised} of 301");
        }
    }
}

#[test]
fn ranges_with_the_clock_applied_beside_raw_doppler_are_protected() {
    for beside_m_s in [0.0, 0.1 - OWN_M_S, -1.0 - OWN_M_S, 10.0, 939.0] {
        let Some(promised) = protected(Frequency::Dual, beside_m_s, OWN_M_S) else { return };
        assert!(promised >= 295, "{beside_m_s} m/s: {promised} of 301");
    }
}

/// The clock drifts with its rates for a minute and a half, and stays from then on: an alert, 130 s
/// until the rates have agreed, and promises again.
#[test]
fn a_receiver_that_begins_to_steer_its_clock_is_promised_again() {
    const BEGINS_S: f64 = 90.0;
    for more_m_s in [-60.0, 0.0, 50.0, 56.0, 60.0, 200.0] {
        let applied_m = |now_s: f64| OWN_M_S * (now_s - BEGINS_S).max(0.0) - more_m_s * now_s.min(BEGINS_S);
        let Some(promised) = promised(Frequency::Dual, more_m_s, applied_m) else { return };
        let lost: Vec<_> = (0_usize..).zip(&promised).filter(|(_, is_promised)| !**is_promised).collect();
        let [Some((first_s, _)), Some((last_s, _))] = [lost.first(), lost.last()] else { panic!("no alert") };
        // A clock that leaps away at once is a single leap.
        let is_awaited = matches!(lost.len(), 11 | 130..=135);
        assert!(is_awaited, "{more_m_s} m/s: {} epochs", lost.len());
        assert_eq!(last_s - first_s + 1, lost.len(), "{more_m_s} m/s: not at once");
        assert!(*last_s < 260, "{more_m_s} m/s: until {last_s} s");
    }
}
