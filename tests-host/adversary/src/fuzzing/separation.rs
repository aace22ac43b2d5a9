//! Target: linearised epochs with any values, directly into the separation of solutions, in both
//! scalars.
//!
//! [`super::epoch`] reaches it through a position. Here geometry, residuals, sigmas, priors and
//! allocations are free, and any number may have any bit pattern. Invariants: all results are
//! numbers; monitored and unmonitored probabilities are within their bounds; an outcome agrees with
//! the tests; exactly the stated satellites are left out.

use nalgebra::Vector3;
use raim_core::internals::integrity::araim::{
    Allocation, AraimError, AraimJudgement, AraimOutcome, Finding, MAX_MODES, Prior, Priors, ROWS, judge,
};
use raim_core::internals::least_squares::equations::LinearEpoch;
use raim_core::internals::least_squares::{Snapshot, Workspace};
use raim_core::internals::numeric::real::Real;
use raim_core::satellite::Constellation;

use super::tape::Tape;

/// Reads the scalar type, and then epochs until the bytes end.
pub fn run(input: &[u8]) {
    let mut tape = Tape::new(input);
    if tape.byte() & 1 == 0 { epochs::<f32>(&mut tape) } else { epochs::<f64>(&mut tape) }
}

fn epochs<T: Real>(tape: &mut Tape<'_>) {
    while !tape.is_over() {
        let allocation = allocation(tape);
        let (epoch, priors) = epoch::<T>(tape);
        let constellations = [(); Constellation::COUNT].map(|()| T::narrow(probability(tape)));
        let priors = Priors { satellites: &priors, constellations };
        let mut workspace = Workspace::<T, ROWS>::of(epoch);
        let Ok(mut snapshot) = workspace.solve() else { continue };
        match judge(&mut snapshot, &priors, &allocation) {
            Ok(judged) => check(&judged, &snapshot, &allocation),
            Err(AraimError::Prior) => assert!(!are_sound(&priors, &snapshot), "refused: {priors:?}"),
            Err(AraimError::Rows | AraimError::Modes) => {}
        }
    }
}

/// Returns one of the two allocations in use, with some of its numbers changed.
fn allocation(tape: &mut Tape<'_>) -> Allocation {
    let mut allocation = tape.one_of(&[Allocation::horizontal(), Allocation::vertical_guidance()]);
    let unmonitored = [allocation.unmonitored_probability, 1e-12, 1e-4];
    allocation.unmonitored_probability = tape.one_of(&unmonitored);
    allocation.consolidation = tape.one_of(&[allocation.consolidation, 0.0, 1.0]);
    allocation.exclusion = tape.byte() < 200;
    allocation
}

fn epoch<T: Real>(tape: &mut Tape<'_>) -> (LinearEpoch<T, ROWS>, Vec<Prior<T>>) {
    let (mut epoch, mut priors) = (LinearEpoch::new(), Vec::new());
    let is_quiet = tape.byte() < 128;
    for _ in 0..tape.byte() % 42 {
        let (azimuth, up) = (tape.within(0.0, std::f64::consts::TAU), tape.within(-1.0, 1.0));
        let level = (1.0 - up * up).sqrt();
        let direction = Vector3::new(level * azimuth.sin(), level * azimuth.cos(), up);
        let sigma_m = tape.number(0.1, 20.0);
        let fault_m = if is_quiet || tape.byte() < 200 { 0.0 } else { tape.number(-1e4, 1e4) };
        let residual_m = sigma_m * tape.within(-1.5, 1.5) + fault_m;
        let constellation = tape.one_of(&Constellation::ALL);
        let prior = Prior {
            accuracy_m: T::narrow(tape.number(0.1, 20.0)),
            bias_m: T::narrow(tape.number(0.0, 5.0)),
            fault: T::narrow(probability(tape)),
        };
        // A refused satellite has no row, and so no prior.
        if epoch.satellite(constellation, direction, residual_m, sigma_m).is_ok() {
            priors.push(prior);
        }
    }
    (epoch, priors)
}

/// Returns mostly a plausible probability, sometimes any number.
fn probability(tape: &mut Tape<'_>) -> f64 {
    match tape.byte() {
        0..8 => tape.number(0.0, 1.0),
        8..24 => tape.within(0.0, 0.49),
        _ => tape.one_of(&[1e-5, 1e-4, 1e-8, 0.0, 3e-3]),
    }
}

fn are_sound<T: Real>(priors: &Priors<'_, T>, snapshot: &Snapshot<'_, T, ROWS>) -> bool {
    let probability = |value: T| value >= T::zero() && value < T::narrow(0.5);
    let size = |value: T| value >= T::zero() && value <= T::narrow(1e6);
    let satellite =
        |prior: &Prior<T>| probability(prior.fault) && size(prior.accuracy_m) && size(prior.bias_m);
    let measured = |sigma_m: T| sigma_m >= T::narrow(1e-3) && sigma_m <= T::narrow(1e6);
    snapshot.equations().iter().all(|row| measured(row.sigma))
        && priors.satellites.iter().all(satellite)
        && priors.constellations.into_iter().all(probability)
}

fn check<T: Real>(judged: &AraimJudgement<T>, after: &Snapshot<'_, T, ROWS>, allocation: &Allocation) {
    check_finding(&judged.whole, judged);
    let share = judged.risk_share.widen();
    let want = if allocation.exclusion { 1.0 / (judged.options + 1) as f64 } else { 1.0 };
    assert!((share / want - 1.0).abs() < 1e-6, "{judged:?}");
    assert_eq!(judged.outcome == AraimOutcome::Passed, !judged.whole.alarm, "{judged:?}");
    let left_out = after.equations().iter().enumerate().filter(|(_, row)| row.weight <= T::zero());
    let left_out = left_out.fold(0_u64, |set, (index, _)| set | 1 << index);
    match &judged.outcome {
        AraimOutcome::Passed | AraimOutcome::NotIsolated | AraimOutcome::Ambiguous => {
            assert_eq!(left_out, 0, "{judged:?}");
        }
        AraimOutcome::Excluded { rows, finding, .. } => {
            assert!(allocation.exclusion && *rows != 0, "{judged:?}");
            assert_eq!(left_out, *rows, "{judged:?}");
            assert!(
                !finding.alarm && finding.unmonitored_probability >= judged.whole.unmonitored_probability,
                "{judged:?}"
            );
            check_finding(finding, judged);
        }
    }
}

fn check_finding<T: Real>(finding: &Finding<T>, judged: &AraimJudgement<T>) {
    let [east, north, up] = finding.levels_m;
    let numbers = [
        east,
        north,
        up,
        finding.hpl_m(),
        finding.unmonitored_probability,
        finding.effective_monitor_threshold_m,
        finding.accuracy_m,
        finding.ratio,
    ];
    // A NaN is not at least zero.
    assert!(numbers.iter().all(|number| *number >= T::zero()), "{judged:?}");
    assert!(finding.modes <= MAX_MODES, "{judged:?}");
    assert!(finding.factors.iter().all(|factor| factor.is_finite() && *factor > T::zero()), "{judged:?}");
}
