//! Invariances of solution separation: the order of the rows, the direction of north, the way in
//! which a satellite is missing.
//!
//! Priors are such that single satellites and constellations are monitored and no other mode is,
//! because two events at once are rarer than the allowed unmonitored probability. `P_nm` is then
//! the probability of two events and more, which is summed up here from elementary symmetric sums.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing)]

use crate::noise::Noise;
use nalgebra::Vector3;
use proptest::prelude::*;
use raim_core::internals::integrity::araim::{
    Allocation, AraimJudgement, AraimOutcome, Finding, Prior, Priors, ROWS, judge,
};
use raim_core::internals::least_squares::equations::LinearEpoch;
use raim_core::internals::least_squares::{Snapshot, Workspace};
use raim_core::internals::numeric::real::Real;
use raim_core::satellite::Constellation;

/// Probability that a constellation fails.
const CONSTELLATION: f64 = 5e-5;

/// One satellite of a sky.
#[derive(Clone, Copy, Debug)]
struct Sighted {
    constellation: usize,
    azimuth: f64,
    up: f64,
    residual_m: f64,
    sigma_m: f64,
    bias_m: f64,
    fault: f64,
}

/// Returns two constellations of five to seven satellites.
fn sky() -> impl Strategy<Value = Vec<Sighted>> {
    let one = (0.0..std::f64::consts::TAU, 0.08..1.0f64, -3.0..3.0f64, 0.5..3.0f64, 0.0..1.0f64, 0.2..1.0f64);
    let of =
        |constellation: usize| {
            let one = one.clone().prop_map(move |(azimuth, up, residual_m, sigma_m, bias_m, fault)| {
                Sighted { constellation, azimuth, up, residual_m, sigma_m, bias_m, fault: 1e-5 * fault }
            });
            prop::collection::vec(one, 5..=7)
        };
    (of(0), of(2)).prop_map(|(gps, galileo)| [gps, galileo].concat())
}

fn direction(one: &Sighted, turned: f64) -> Vector3<f64> {
    let level = (1.0 - one.up * one.up).sqrt();
    let azimuth = one.azimuth + turned;
    Vector3::new(level * azimuth.sin(), level * azimuth.cos(), one.up)
}

fn allocation() -> Allocation {
    let mut allocation = Allocation::vertical_guidance();
    allocation.consolidation = 0.0;
    allocation
}

fn epoch<T: Real>(sky: &[Sighted], turned: f64) -> LinearEpoch<T, ROWS> {
    let mut epoch = LinearEpoch::new();
    for one in sky {
        let constellation = Constellation::ALL[one.constellation];
        epoch.satellite(constellation, direction(one, turned), one.residual_m, one.sigma_m).unwrap();
    }
    epoch
}

fn priors<T: Real>(sky: &[Sighted]) -> Vec<Prior<T>> {
    let prior = |one: &Sighted| Prior {
        accuracy_m: T::narrow(0.7 * one.sigma_m),
        bias_m: T::narrow(one.bias_m),
        fault: T::narrow(one.fault),
    };
    sky.iter().map(prior).collect()
}

fn judged<T: Real>(snapshot: &mut Snapshot<'_, T, ROWS>, sky: &[Sighted]) -> AraimJudgement<T> {
    let constellations = [T::narrow(CONSTELLATION); Constellation::COUNT];
    judge(snapshot, &Priors { satellites: &priors(sky), constellations }, &allocation()).unwrap()
}

/// Solutions of geometries that determine a position well enough to compare roundings.
fn solved(sky: &[Sighted], turned: f64) -> Option<AraimJudgement<f64>> {
    let mut workspace = Workspace::of(epoch(sky, turned));
    let mut snapshot = workspace.solve().ok()?;
    Some(judged(&mut snapshot, sky))
}

/// Returns true if two numbers are the same but for rounding; infinities are.
fn same(have: f64, want: f64, within: f64) -> bool {
    have.to_bits() == want.to_bits() || (have - want).abs() <= within * want.abs()
}

fn assert_same(have: &Finding<f64>, want: &Finding<f64>, within: f64) -> Result<(), TestCaseError> {
    prop_assert_eq!(have.modes, want.modes);
    prop_assert_eq!(have.alarm, want.alarm);
    let pairs = [
        (have.unmonitored_probability, want.unmonitored_probability),
        (have.hpl_m(), want.hpl_m()),
        (have.vpl_m(), want.vpl_m()),
        (have.effective_monitor_threshold_m, want.effective_monitor_threshold_m),
        (have.accuracy_m, want.accuracy_m),
    ];
    for (have, want) in pairs {
        prop_assert!(same(have, want, within), "have {}, want {}", have, want);
    }
    Ok(())
}

/// Returns the probability of two events and more, by elementary symmetric sums of the odds.
fn two_and_more(sky: &[Sighted]) -> f64 {
    let mut events: Vec<f64> = sky.iter().map(|one| one.fault).collect();
    for constellation in 0..Constellation::COUNT {
        if sky.iter().any(|one| one.constellation == constellation) {
            events.push(CONSTELLATION);
        }
    }
    let healthy: f64 = events.iter().map(|event| 1.0 - event).product();
    let mut exactly = vec![0.0; events.len() + 1];
    exactly[0] = healthy;
    for event in &events {
        for count in (1..exactly.len()).rev() {
            exactly[count] += exactly[count - 1] * event / (1.0 - event);
        }
    }
    exactly.iter().skip(2).sum()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn the_order_of_the_satellites_means_nothing(sky in sky(), seed in any::<u64>()) {
        let Some(want) = solved(&sky, 0.0) else { return Ok(()) };
        let mut shuffled = sky.clone();
        // By Fisher and Yates.
        let mut noise = Noise(seed);
        for last in (1..shuffled.len()).rev() {
            shuffled.swap(last, noise.index(last + 1));
        }
        let have = solved(&shuffled, 0.0).expect("the same geometry");
        assert_same(&have.whole, &want.whole, 1e-6)?;
        prop_assert_eq!(have.options, want.options);
    }

    /// A quarter turn changes the names of east and north; any other turn leaves the height as it
    /// is.
    #[test]
    fn the_direction_of_north_means_nothing(sky in sky(), turned in 0.0..std::f64::consts::TAU) {
        let Some(want) = solved(&sky, 0.0) else { return Ok(()) };
        let quarter = solved(&sky, std::f64::consts::FRAC_PI_2).expect("the same geometry");
        assert_same(&quarter.whole, &want.whole, 1e-6)?;
        let [east, north, _] = want.whole.levels_m;
        let [turned_east, turned_north, _] = quarter.whole.levels_m;
        prop_assert!(same(turned_east, north, 1e-6) && same(turned_north, east, 1e-6));
        let any = solved(&sky, turned).expect("the same geometry");
        prop_assert!(same(any.whole.vpl_m(), want.whole.vpl_m(), 1e-6));
        prop_assert!(same(any.whole.accuracy_m, want.whole.accuracy_m, 1e-6));
        prop_assert_eq!(any.whole.modes, want.whole.modes);
    }

    /// `P_nm` is that of the existing satellites: left out of a solution, or never in it.
    #[test]
    fn a_satellite_that_is_left_out_is_as_one_that_never_was(sky in sky(), choice in any::<prop::sample::Index>()) {
        let gone = choice.index(sky.len());
        let mut workspace = Workspace::of(epoch(&sky, 0.0));
        let Ok(mut snapshot) = workspace.solve() else { return Ok(()) };
        if snapshot.leave_out(gone).is_err() {
            return Ok(());
        }
        let have = judged(&mut snapshot, &sky);
        let mut rest = sky.clone();
        rest.remove(gone);
        let Some(want) = solved(&rest, 0.0) else { return Ok(()) };
        assert_same(&have.whole, &want.whole, 1e-6)?;
        prop_assert_eq!(have.options, want.options);
        // Every single and every constellation is monitored; if geometry forbids one, its
        // probability is added.
        let least = two_and_more(&rest);
        prop_assert!(have.whole.unmonitored_probability >= least * (1.0 - 1e-9), "{} < {}", have.whole.unmonitored_probability, least);
        let events = rest.len() + 2;
        if have.whole.modes == events {
            prop_assert!(same(have.whole.unmonitored_probability, least, 1e-6), "{} {}", have.whole.unmonitored_probability, least);
        }
    }

    /// For any fault: a finding after an exclusion has lost no probability, and belongs to the
    /// others.
    #[test]
    fn an_exclusion_loses_no_probability(sky in sky(), choice in any::<prop::sample::Index>(), size_m in -500.0..500.0f64) {
        let mut sky = sky;
        let faulty = choice.index(sky.len());
        sky[faulty].residual_m += size_m;
        let Some(judged) = solved(&sky, 0.0) else { return Ok(()) };
        prop_assert_eq!(judged.outcome == AraimOutcome::Passed, !judged.whole.alarm);
        if let AraimOutcome::Excluded { rows, finding, .. } = judged.outcome {
            prop_assert!(rows != 0 && rows >> sky.len() == 0);
            prop_assert!(finding.unmonitored_probability >= judged.whole.unmonitored_probability);
            prop_assert!(!finding.alarm && finding.modes <= judged.whole.modes);
        }
    }

    /// For any geometry and any magnitude, in both scalars.
    #[test]
    fn no_number_is_none(
        sky in prop::collection::vec(
            (0usize..4, 0.0..std::f64::consts::TAU, -1.0..1.0f64, -1e6..1e6f64, 1e-2..1e3f64, 0.0..100.0f64, 0.0..0.49f64),
            4..24,
        ),
        flat in any::<bool>(),
    ) {
        let sky: Vec<Sighted> = sky
            .into_iter()
            .map(|(constellation, azimuth, up, residual_m, sigma_m, bias_m, fault)| Sighted {
                constellation,
                azimuth,
                // All at one height: the geometry of a cone determines no position.
                up: if flat { 0.3 + 1e-6 * up } else { up },
                residual_m,
                sigma_m,
                bias_m,
                fault,
            })
            .collect();
        check_numbers::<f32>(&sky)?;
        check_numbers::<f64>(&sky)?;
    }
}

fn check_numbers<T: Real>(sky: &[Sighted]) -> Result<(), TestCaseError> {
    let mut workspace = Workspace::<T, ROWS>::of(epoch(sky, 0.0));
    let Ok(mut snapshot) = workspace.solve() else { return Ok(()) };
    let constellations = [T::narrow(CONSTELLATION); Constellation::COUNT];
    let priors = Priors { satellites: &priors(sky), constellations };
    let Ok(judged) = judge(&mut snapshot, &priors, &allocation()) else { return Ok(()) };
    let excluded = match &judged.outcome {
        AraimOutcome::Excluded { finding, .. } => Some(finding),
        AraimOutcome::Passed | AraimOutcome::NotIsolated | AraimOutcome::Ambiguous => None,
    };
    for finding in [Some(&judged.whole), excluded].into_iter().flatten() {
        let numbers = [
            finding.unmonitored_probability,
            finding.hpl_m(),
            finding.vpl_m(),
            finding.effective_monitor_threshold_m,
            finding.accuracy_m,
            finding.ratio,
        ];
        for number in numbers {
            prop_assert!(number.widen() >= 0.0, "{:?}", finding);
        }
    }
    Ok(())
}
