//! Levels of random skies against bisection of the same sum of tails, in double precision and with
//! an independent normal tail.

use std::prelude::rust_2024::*;
use std::{println, vec};

use nalgebra::Vector3;

use super::super::exclusion::choose;
use super::super::modes::PriorOdds;
use super::super::monitored::MonitoredModes;
use super::super::subsets::SubsetSolutions;
use super::super::{Allocation, AraimJudgement, Prior, Priors, ROWS, View, judge};
use super::{Dice, Each};
use crate::least_squares::equations::LinearEpoch;
use crate::least_squares::{Snapshot, Workspace};
use crate::numeric::real::Real;
use crate::satellite::Constellation;

/// Skies of the test, each under both allocations.
const SKIES: u64 = 10_000;

/// Sine of the lowest elevation, 5°.
const LOWEST: f64 = 0.0872;

/// Largest excess of a level over the root.
const EXCESS: f64 = 1.05;

/// Level above which single precision may count a mode as singular, m; the largest alarm limit of
/// any flight is 7.4 km.
const USABLE_M: f64 = 1e4;

/// Term of the sum: probability, offset in m, standard deviation in m.
type Tail = (f64, f64, f64);

/// Levels of skies by their agreement with the roots.
#[derive(Debug, Default, PartialEq, Eq)]
struct Agreement {
    judged: usize,
    compared: usize,
    infinite: usize,
    below: usize,
    above: usize,
    huge: usize,
    wrongly_unavailable: usize,
}

/// Returns `Q(u)` by the series about 0, and by Laplace's continued fraction from 3 on.
fn upper_tail(u: f64) -> f64 {
    let density = (-0.5 * u * u).exp() / core::f64::consts::TAU.sqrt();
    if u < 3.0 {
        let terms = (1..60).scan(u, |term, k| {
            let this = *term;
            *term *= u * u / f64::from(2 * k + 1);
            Some(this)
        });
        return 0.5 - density * terms.sum::<f64>();
    }
    density / (1..60).rev().fold(u, |below, k| u + f64::from(k) / below)
}

/// Returns the sum of the tails at a distance.
fn risk_at(tails: &[Tail], level_m: f64) -> f64 {
    let value = |&(probability, offset_m, sigma_m): &Tail| {
        let u = (level_m - offset_m) / sigma_m;
        probability * if u > 0.0 { upper_tail(u) } else { 1.0 }
    };
    tails.iter().map(value).sum()
}

/// Returns the distance at which the sum falls to the risk, by bisection.
fn root(tails: &[Tail], risk: f64) -> f64 {
    let farthest = |&(_, offset_m, sigma_m): &Tail| offset_m + 10.0 * sigma_m;
    let (mut low, mut high) = (0.0, tails.iter().map(farthest).fold(0.0, f64::max));
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        *(if risk_at(tails, middle) > risk { &mut low } else { &mut high }) = middle;
    }
    high
}

/// A sky of one to four systems and six to twelve satellites.
struct RandomSky<T: Real> {
    epoch: LinearEpoch<T, ROWS>,
    priors: Vec<Prior<T>>,
    constellations: [T; Constellation::COUNT],
}

impl<T: Real> RandomSky<T> {
    fn of(seed: u64) -> Self {
        let mut dice = Dice(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15));
        dice.roll();
        let count = 6 + (7.0 * dice.roll()) as usize;
        let systems = 1 + (4.0 * dice.roll()) as usize;
        let bias_m = if dice.roll() < 0.5 { 0.0 } else { 0.75 };
        let mut epoch = LinearEpoch::new();
        let mut priors = Vec::new();
        for index in 0..count {
            let (azimuth, up) = (dice.roll() * core::f64::consts::TAU, LOWEST + (1.0 - LOWEST) * dice.roll());
            let level = (1.0 - up * up).sqrt();
            let sight = Vector3::new(level * azimuth.sin(), level * azimuth.cos(), up);
            // Each system has a satellite; the others are drawn.
            let system = if index < systems { index } else { (systems as f64 * dice.roll()) as usize };
            let sigma_m = (0.7 + 0.3 / (up * up)).sqrt() * (0.8 + 0.4 * dice.roll());
            let residual_m = sigma_m * (dice.roll() + dice.roll() + dice.roll() - 1.5);
            epoch.satellite(Constellation::ALL[system], sight, residual_m, sigma_m).expect("a row");
            priors.push(Prior {
                accuracy_m: T::narrow(0.8 * sigma_m),
                bias_m: T::narrow(bias_m),
                fault: T::narrow(1e-5),
            });
        }
        let constellations = [1e-8, 1e-4, 1e-4, 1e-4].map(T::narrow);
        Self { epoch, priors, constellations }
    }
}

/// Returns the sum of tails on each axis, from the same modes and solutions as the level.
fn tails<T: Real>(
    snapshot: &Snapshot<'_, T, ROWS>,
    priors: &Priors<'_, T>,
    allocation: &Allocation,
    factors: &[T; 3],
) -> [Vec<Tail>; 3] {
    let mut monitored = MonitoredModes::nothing(priors.constellations, allocation);
    let (mut odds, mut own) = (PriorOdds::<T, ROWS>::new(), heapless::Vec::<_, ROWS>::new());
    choose(&mut monitored, &mut odds, &View::of(snapshot), priors).expect("a choice");
    let mut solutions = SubsetSolutions::of(View::of(snapshot), &mut own);
    solutions.prepare(priors.satellites);
    let (whole, bias) = (solutions.whole(), solutions.whole_bias());
    let all = |axis: usize| vec![(2.0, bias[axis].widen(), whole.variance[axis].widen().sqrt())];
    let mut sums = [0, 1, 2].map(all);
    let mut add = Each(|mode: &super::Mode<T>| {
        let taken = monitored.modes.taken_by(mode.hypothesis);
        let solution = solutions.without(mode.hypothesis).filter(|_| monitored.leaves_enough(taken, 0));
        if let Some(solution) = solution {
            let bias = solutions.bias();
            for (axis, sum) in sums.iter_mut().enumerate() {
                let separation_m = solution.separation[axis].widen().max(0.0).sqrt();
                let offset_m = factors[axis].widen() * separation_m + bias[axis].widen();
                sum.push((mode.probability.widen(), offset_m, solution.variance[axis].widen().sqrt()));
            }
        }
        core::ops::ControlFlow::Continue(())
    });
    let _ = monitored.modes.visit(&monitored.modes.remains(0), &(1..=3), &|_| true, &mut add);
    sums
}

/// Compares the levels of a sky with the roots.
fn compare_levels<T: Real>(
    sums: &[Vec<Tail>; 3],
    judged: &AraimJudgement<T>,
    allocation: &Allocation,
    seed: u64,
    agreement: &mut Agreement,
) {
    let found = &judged.whole;
    let left =
        judged.risk_share.widen() * (1.0 - found.unmonitored_probability.widen() / allocation.integrity());
    let horizontal = left * allocation.integrity_horizontal / 2.0;
    let risks = [horizontal, horizontal, left * allocation.integrity_vertical];
    for (axis, (sum, risk)) in sums.iter().zip(risks).enumerate() {
        let level_m = found.levels_m[axis].widen();
        assert_eq!(sum.len(), found.modes + 1, "sky {seed}");
        assert!(level_m > 0.0, "sky {seed}");
        agreement.compared += 1;
        if !(risk > 0.0) {
            assert!(level_m.is_infinite(), "sky {seed}");
            agreement.infinite += 1;
            continue;
        }
        let single = T::default_epsilon().widen() > 1e-10;
        let tolerance_m = if single { f64::max(5e-3, 1e-4 * level_m) } else { 1e-6 };
        let is_below = risk_at(sum, level_m + tolerance_m) > risk;
        let is_above = risk_at(sum, level_m / EXCESS) <= risk;
        agreement.below += usize::from(is_below);
        agreement.above += usize::from(is_above && level_m.is_finite());
        agreement.huge += usize::from(is_above && level_m.is_finite() && level_m > 1e6);
        agreement.wrongly_unavailable += usize::from(level_m.is_infinite());
        if is_below || is_above {
            println!(
                "sky {seed} axis {axis} {} modes: level {level_m:e}, root {:e}, risk {risk:e}",
                found.modes,
                root(sum, risk)
            );
        }
    }
}

/// Compares the levels of every random sky.
fn agreement<T: Real>() -> Agreement {
    let mut agreement = Agreement::default();
    for seed in 0..SKIES {
        let RandomSky { epoch, priors, constellations } = RandomSky::<T>::of(seed);
        let mut workspace = Workspace::of(epoch);
        let Ok(mut snapshot) = workspace.solve() else { continue };
        if snapshot.dof() == 0 {
            continue;
        }
        let priors = Priors { satellites: &priors, constellations };
        for allocation in [Allocation::vertical_guidance(), Allocation::horizontal()] {
            let Ok(judged) = judge(&mut snapshot, &priors, &allocation) else { continue };
            if judged.whole.alarm {
                // An exclusion changes the snapshot.
                break;
            }
            agreement.judged += 1;
            let sums = tails(&snapshot, &priors, &allocation, &judged.whole.factors);
            compare_levels(&sums, &judged, &allocation, seed, &mut agreement);
        }
    }
    println!("{agreement:?}");
    agreement
}

fn levels_are_roots<T: Real>() {
    let found = agreement::<T>();
    assert!(found.judged > 15_000, "{found:?}");
    let wrong = (found.below, found.above, found.wrongly_unavailable);
    assert_eq!(wrong, (0, 0, 0), "{found:?}");
}

#[test]
fn levels_of_random_skies_are_the_roots_in_single_precision() {
    levels_are_roots::<f32>();
}

#[test]
fn levels_of_random_skies_are_the_roots_in_double_precision() {
    levels_are_roots::<f64>();
}

#[test]
fn the_upper_tail_has_published_values() {
    // NIST Digital Library of Mathematical Functions 7.2 by tables: Q(1), Q(3), Q(6).
    for (u, want) in
        [(1.0, 0.158_655_253_931_457_05), (3.0, 1.349_898_031_630_094_5e-3), (6.0, 9.865_876_450_376_98e-10)]
    {
        assert!((upper_tail(u) / want - 1.0).abs() < 1e-12, "Q({u}) = {:e}", upper_tail(u));
    }
}

/// Returns for each allocation the number of modes, `P_nm` and the levels, m.
fn found<T: Real>(seed: u64) -> Option<[(usize, f64, [f64; 3]); 2]> {
    let RandomSky { epoch, priors, constellations } = RandomSky::<T>::of(seed);
    let mut workspace = Workspace::of(epoch);
    let mut snapshot = workspace.solve().ok()?;
    let priors = Priors { satellites: &priors, constellations };
    let mut describe = |allocation: &Allocation| {
        let whole =
            judge(&mut snapshot, &priors, allocation).ok().filter(|judged| !judged.whole.alarm)?.whole;
        Some((whole.modes, whole.unmonitored_probability.widen(), whole.levels_m.map(Real::widen)))
    };
    Some([describe(&Allocation::vertical_guidance())?, describe(&Allocation::horizontal())?])
}

#[test]
fn an_epoch_is_available_in_single_precision_where_it_is_in_double_precision() {
    let mut differing = 0;
    for seed in 0..SKIES {
        let (Some(single), Some(double)) = (found::<f32>(seed), found::<f64>(seed)) else { continue };
        for (single, double) in single.iter().zip(&double) {
            // Modes whose geometry is nearly singular are so only to some digits.
            let is_usable = double.2.iter().all(|&level_m| level_m < USABLE_M);
            if is_usable && !single.2.iter().all(|level_m| level_m.is_finite()) {
                println!("sky {seed}: {single:?} {double:?}");
                differing += 1;
            }
        }
    }
    assert_eq!(differing, 0);
}
