//! Target: epochs with any values, under any requirements and strategy, one after another.
//!
//! Most satellites are at plausible positions with matching ranges, so that the input reaches the
//! searches and not only the refusals. Any number may have any bit pattern. The reports are checked
//! against the promises: a protected position is finite, and so are its levels, which are within
//! their share of the limits; no satellite is both used and left out; no number of a report is NaN.

use std::collections::BTreeSet;

use raim_core::epoch::{Aiding, Epoch, Observation};
use raim_core::frame::{Ecef, Enu, LocalFrame};
use raim_core::internals::integrity::araim::Allocation;
use raim_core::internals::integrity::raim::detection::threshold::policy::Policy;
use raim_core::internals::integrity::raim::isolation::parity;
use raim_core::internals::numeric::probability::Probability;
use raim_core::internals::numeric::real::Real;
use raim_core::monitor::{Method, Monitor, Strategy};
use raim_core::report::{Protected, Report, Unavailable, Verdict};
use raim_core::requirements::Requirements;
use raim_core::satellite::{Constellation, SatelliteId};

use super::tape::Tape;

/// Capacity of the monitor, satellites.
const ROOM: usize = 20;

/// Relative rounding of a level in `f32`.
const ROUNDED: f64 = 1e-5;

/// Largest distance of a position, m: beyond every satellite.
const FARTHEST_M: f64 = 2e8;

/// Sites on the ground, on the axes, and at the centre, where corrections fail.
const SITES_M: [[f64; 3]; 4] =
    [[-1.7e6, 5.0e6, 3.6e6], [6_378_137.0, 0.0, 0.0], [0.0, 0.0, -6_356_752.0], [0.0; 3]];

/// Reads the scalar type, and then epochs until the bytes end.
pub fn run(input: &[u8]) {
    let mut tape = Tape::new(input);
    if tape.byte() & 1 == 0 { monitor::<f32>(&mut tape) } else { monitor::<f64>(&mut tape) }
}

fn monitor<T: Real>(tape: &mut Tape<'_>) {
    let requirements = requirements(tape);
    let Ok(mut monitor) = Monitor::<T, ROOM>::new(requirements) else {
        return assert!(requirements.validate().is_err(), "refused: {requirements:?}");
    };
    let mut strategy = Strategy::CLASSIC;
    let mut time_s = 0.0;
    while !tape.is_over() {
        if tape.byte() < 64 {
            strategy = self::strategy(tape);
            monitor.set_strategy(strategy).expect("every method is built in");
        }
        if tape.byte() < 16 {
            monitor.start_from(point(tape));
        }
        time_s += tape.number(0.0, 2.0);
        let epoch = epoch(time_s, tape);
        check(&monitor.process(&epoch), &epoch, &requirements, strategy);
    }
}

fn requirements(tape: &mut Tape<'_>) -> Requirements {
    let probability = |tape: &mut Tape<'_>, tails: &[f64]| {
        Probability::new(tape.one_of(tails)).expect("above 0 and below 1")
    };
    Requirements::en_route()
        .with_hal_m(tape.number(1.0, 4e3))
        .with_val_m((tape.byte() < 64).then(|| tape.number(1.0, 4e3)))
        .with_false_alarm(probability(tape, &[3.33e-7, 5e-3, 1e-3, 1e-5, 1e-8]))
        .with_missed_detection(probability(tape, &[1e-3, 1e-4, 1e-6]))
        .with_fault_free_risk(probability(tape, &[1e-7, 1e-3, 1e-12]))
        .with_time_to_alert_s(tape.number(0.1, 3600.0))
        .with_guard_fraction(tape.number(0.01, 1.0))
        .with_allocation(tape.one_of(&[Allocation::horizontal(), Allocation::vertical_guidance()]))
}

fn strategy(tape: &mut Tape<'_>) -> Strategy {
    use parity::Isolation::{Grouping, Hybrid, HybridWithoutGrouping, Sequential, Simultaneous};
    let parity = [Simultaneous, Sequential, HybridWithoutGrouping, Hybrid, Grouping].map(Method::Parity);
    let methods =
        [Method::Baarda, Method::Ransac, Method::Araim].into_iter().chain(parity).collect::<Vec<_>>();
    Strategy::CLASSIC
        .with_policy(tape.one_of(&[Policy::T1, Policy::T2, Policy::TOp]))
        .with_method(tape.one_of(&methods))
        .with_clock_aid(tape.byte() & 1 == 1)
}

fn point(tape: &mut Tape<'_>) -> Ecef {
    Ecef::new(tape.number(-7e6, 7e6), tape.number(-7e6, 7e6), tape.number(-7e6, 7e6))
}

/// Returns an epoch of the ranges that the core accepts; a refused range must be one that may be
/// refused.
fn epoch(time_s: f64, tape: &mut Tape<'_>) -> Epoch<ROOM> {
    let mut epoch = Epoch::new(time_s);
    let [x, y, z] = tape.one_of(&SITES_M);
    let (site, clock_m, quiet) = (Ecef::new(x, y, z), tape.number(-3e5, 3e5), tape.byte() < 128);
    for _ in 0..tape.byte() % 24 {
        let observation = observation(site, clock_m, quiet, tape);
        if epoch.push(observation).is_ok() {
            let numbers = [observation.range_m, observation.sigma_m, observation.position.radius_m()];
            assert!(numbers.iter().all(|number| number.is_finite()), "let in: {observation:?}");
        }
    }
    for _ in 0..tape.byte() % 4 {
        let known = known(site, clock_m, tape);
        let _ = epoch.aid(known);
    }
    epoch
}

fn observation(site: Ecef, clock_m: f64, quiet: bool, tape: &mut Tape<'_>) -> Observation {
    use Constellation::{Beidou, Galileo, Glonass, Gps};
    let constellation = tape.one_of(&[Gps, Gps, Gps, Beidou, Beidou, Galileo, Galileo, Glonass]);
    let satellite = SatelliteId::new(constellation, tape.byte() % 99 + 1).expect("1 to 99");
    let (azimuth, height) = (tape.within(0.0, std::f64::consts::TAU), tape.within(0.05, 1.0));
    let distance_m = tape.number(2.0e7, 2.6e7);
    let level = (1.0 - height * height).sqrt() * distance_m;
    let direction =
        Enu { east: level * azimuth.sin(), north: level * azimuth.cos(), up: height * distance_m };
    let position = site + LocalFrame::at(site).unrotate(direction);
    let sigma_m = tape.number(0.5, 20.0);
    let fault_m = if quiet || tape.byte() < 200 { 0.0 } else { tape.number(-1e4, 1e4) };
    let noise_m = sigma_m * tape.within(-1.5, 1.5);
    Observation { satellite, position, range_m: distance_m + clock_m + noise_m + fault_m, sigma_m }
}

fn known(site: Ecef, clock_m: f64, tape: &mut Tape<'_>) -> Aiding {
    let (off_m, sigma_m) = (tape.number(-30.0, 30.0), tape.number(0.5, 100.0));
    if tape.byte() & 1 == 0 {
        Aiding::Height { value_m: LocalFrame::at(site).height_m() + off_m, sigma_m }
    } else {
        Aiding::Clock { constellation: tape.one_of(&Constellation::ALL), value_m: clock_m + off_m, sigma_m }
    }
}

fn check(report: &Report<ROOM>, epoch: &Epoch<ROOM>, requirements: &Requirements, strategy: Strategy) {
    // A NaN does not equal itself.
    assert_eq!(*report, report.clone(), "a number that is none");
    check_satellites(report, epoch);
    check_redundancy(report, epoch, strategy);
    assert!(report.residual_rms_m.is_finite(), "{report:?}");
    assert!(report.sigma_check.is_none_or(|ratio| ratio.is_finite() && ratio >= 0.0), "{report:?}");
    let has_no_position = matches!(report.verdict, Verdict::Unavailable(Unavailable::NoFix));
    assert!(!(has_no_position && report.solution.is_some()), "{report:?}");
    if let Verdict::Protected(reason) = report.verdict {
        check_promise(report, reason, requirements, strategy);
    }
}

/// Checks that each used satellite is in the epoch, once, and not left out.
fn check_satellites(report: &Report<ROOM>, epoch: &Epoch<ROOM>) {
    let tracked: BTreeSet<_> = epoch.observations().iter().map(|observation| observation.satellite).collect();
    let used: BTreeSet<_> = report.used.iter().copied().collect();
    let excluded: BTreeSet<_> = report.excluded.iter().map(|suspect| suspect.satellite).collect();
    assert_eq!(usize::from(report.tracked), tracked.len());
    assert_eq!((used.len(), excluded.len()), (report.used.len(), report.excluded.len()), "twice: {report:?}");
    assert!(used.is_disjoint(&excluded), "used and left out: {report:?}");
    assert!(used.union(&excluded).all(|satellite| tracked.contains(satellite)), "from nowhere: {report:?}");
    assert!(report.solution.is_some() || used.is_empty(), "used for nothing: {report:?}");
}

/// Checks the degrees of freedom: rows minus unknowns. Aiding rows, including a forecast, may take
/// part or be left out.
fn check_redundancy(report: &Report<ROOM>, epoch: &Epoch<ROOM>, strategy: Strategy) {
    let Some(test) = report.test else { return };
    let clocks: BTreeSet<_> = report.used.iter().map(|satellite| satellite.constellation()).collect();
    let rows = report.used.len() + epoch.aiding().len() + usize::from(strategy.clock_aid);
    let most = rows.checked_sub(3 + clocks.len());
    assert!(test.dof > 0 && most.is_some_and(|most| usize::from(test.dof) <= most), "{report:?}");
    if epoch.aiding().is_empty() && !strategy.clock_aid {
        assert_eq!(Some(usize::from(test.dof)), most, "{report:?}");
    }
}

fn check_promise(report: &Report<ROOM>, reason: Protected, requirements: &Requirements, strategy: Strategy) {
    let solution = report.solution.as_ref().expect("protected without a position");
    assert!(solution.position.radius_m() <= FARTHEST_M, "{report:?}");
    let [ee, _, _, nn, _, uu] = solution.covariance_m2;
    let spreads = [ee, nn, uu, solution.hdop, solution.vdop];
    assert!(spreads.iter().all(|spread| spread.is_finite() && *spread > 0.0), "{report:?}");
    let test = report.test.expect("protected without a test");
    assert!(test.statistic >= 0.0 && test.statistic <= test.threshold, "{report:?}");
    let levels = report.protection.expect("protected without levels");
    // Levels of ARAIM may fill the limits. A policy other than `T1` chooses a threshold whose plain
    // level is within the guard; what scaling adds may use the rest of the limit.
    let is_guarded = report.araim.is_none() && strategy.policy == Policy::T1;
    let fraction = if is_guarded { requirements.guard_fraction } else { 1.0 };
    let share = |limit_m: f64| fraction * limit_m * (1.0 + ROUNDED);
    assert!(
        levels.hpl_m >= 0.0 && levels.hpl_m <= share(requirements.hal_m),
        "{report:?} of {requirements:?}"
    );
    let vertical = requirements.val_m.is_none_or(|val_m| levels.vpl_m >= 0.0 && levels.vpl_m <= share(val_m));
    assert!(vertical, "{report:?} of {requirements:?}");
    let has_excluded = matches!(reason, Protected::Excluded | Protected::Covered);
    assert_eq!(has_excluded, !report.excluded.is_empty(), "{report:?}");
}
