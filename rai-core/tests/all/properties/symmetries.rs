//! Invariances: the order of the satellites, the prime meridian, the receiver's clocks, the unit of
//! length, and the satellites left out.

use proptest::prelude::*;
use raim_core::epoch::Observation;
use raim_core::frame::Ecef;
use raim_core::internals::integrity::raim::levels::largest_slopes;
use raim_core::internals::numeric::real::Real;
use raim_core::monitor::Monitor;
use raim_core::report::{Alert, Protected, ProtectionLevels, Report, Solution, Verdict};
use raim_core::requirements::Requirements;
use raim_core::satellite::{Constellation, SatelliteId};

use crate::solved::solved;

use super::skies::{CAPACITY, Sky, any_sky, grossly_wrong_sky, turned};

const REQUIRED: Requirements = Requirements::non_precision_approach();

fn judge<T: Real>(sky: &Sky) -> Report<CAPACITY> {
    let mut monitor = Monitor::<T, CAPACITY>::new(REQUIRED).unwrap();
    monitor.disable_continuity();
    monitor.process(&sky.epoch())
}

/// Largest differences between two reports of the same thing: limits of the solution's accuracy and
/// of decisions.
#[derive(Clone, Copy)]
struct Rounding {
    /// Difference of a range, m: the position may differ by this for each unit of its dilution.
    range_m: f64,
    /// Difference of the position, as a part of its standard deviation: weights that differ cost
    /// digits beyond the dilution.
    of_sigma: f64,
    /// Relative difference of the statistic and of the protection levels.
    relative: f64,
    /// True if a hardly determined or tested quantity may count as undetermined, which is the safe
    /// side.
    may_give_up: bool,
}

/// A last correction of 10 m leaves 2 µm, or less if there was a further pass.
const DOUBLE: Rounding = Rounding { range_m: 2e-5, of_sigma: 0.0, relative: 1e-4, may_give_up: false };

/// Corrections of 10 m to 1e-3, where weights differ by a thousand.
const SINGLE: Rounding = Rounding { range_m: 1e-2, of_sigma: 1e-3, relative: 2e-2, may_give_up: true };

/// An exclusion that moves the position by less than 300 m is not linearised again: 2 mm of a
/// range.
const NOT_LINEARISED_AGAIN: Rounding = Rounding { range_m: 5e-3, relative: 1e-2, ..DOUBLE };

/// Steps of an absolute length beside `f32` in one metre.
const GRID_PER_M: f64 = 16_384.0;

/// Level above which neither is compared, m: both come from the hardly tested satellite, of whose
/// redundancy few digits are left, and no alert limit is there.
const LARGEST_LEVEL_M: f64 = 2000.0;

/// Returns true if a decision lies so close to its limit that rounding may make it.
fn rounding_decides(report: &Report<CAPACITY>, rounding: Rounding) -> bool {
    let near = |have: f64, limit: f64| (have / limit - 1.0).abs() <= rounding.relative;
    let limit_m = REQUIRED.guard_fraction * REQUIRED.hal_m;
    report.test.is_some_and(|test| near(test.statistic, test.threshold))
        || report.protection.is_some_and(|levels| near(levels.hpl_m, limit_m))
        || report.solution.as_ref().is_some_and(is_weak)
        || rounding.may_give_up && gives_up(report)
}

/// Returns true if few digits are left of a solution: the geometry is bad, or it is the other
/// minimum of the squares, far below the ground or above, that a few ranges may have.
fn is_weak(solution: &Solution) -> bool {
    solution.hdop.max(solution.vdop) > 20.0 || solution.geodetic.height_m.abs() > 1e5
}

/// Returns true if several satellites explain the ranges equally well, so that rounding decides the
/// order of the search and its result.
fn is_ambiguous(report: &Report<CAPACITY>) -> bool {
    report.verdict == Verdict::Alert(Alert::Ambiguous)
}

/// Returns true if the ranges were solved exactly and nothing is left to test.
///
/// The difference of two squared ranges is linear in the position, so that four ranges leave one
/// quadratic equation. Both roots may lie near the ground, and rounding decides which of them is
/// found. Nothing is promised about either.
fn have_two_solutions(have: &Report<CAPACITY>, want: &Report<CAPACITY>) -> bool {
    have.test.is_none() && want.test.is_none()
}

fn is_alert(report: &Report<CAPACITY>) -> bool {
    matches!(report.verdict, Verdict::Alert(_))
}

/// Returns the standard deviation of the position, m.
fn sigma_m(solution: &Solution) -> f64 {
    let [east_m2, _, _, north_m2, _, up_m2] = solution.covariance_m2;
    (east_m2 + north_m2 + up_m2).sqrt()
}

/// Returns true if the geometry counts as singular, or a satellite as untestable that moves the
/// position.
fn gives_up(report: &Report<CAPACITY>) -> bool {
    let is_unbounded = |levels: &ProtectionLevels| levels.hpl_m.is_infinite() || levels.vpl_m.is_infinite();
    report.solution.is_none() || report.protection.as_ref().is_some_and(is_unbounded)
}

fn excluded(report: &Report<CAPACITY>) -> Vec<SatelliteId> {
    sorted(report.excluded.iter().map(|suspect| suspect.satellite))
}

fn used(report: &Report<CAPACITY>) -> Vec<SatelliteId> {
    sorted(report.used.iter().copied())
}

fn of_system(mut satellites: Vec<SatelliteId>, constellation: Constellation) -> Vec<SatelliteId> {
    satellites.retain(|satellite| satellite.constellation() == constellation);
    satellites
}

/// Satellites of one system in two reports.
type Listed = (Vec<SatelliteId>, Vec<SatelliteId>);

/// Returns true if two reports name different satellites of the last two of one system.
///
/// Two ranges with a clock of their own are one equation, their difference. Without either of them
/// it is gone, so that the position, the statistic and the degrees of freedom are the same, and
/// both w-tests are equal. Rounding decides which of them is named.
fn is_tie_of_a_pair(used: &Listed, excluded: &Listed) -> bool {
    let ([of_have], [of_want]) = (&used.0[..], &used.1[..]) else { return false };
    let swapped = excluded.1.iter().map(|satellite| if satellite == of_have { *of_want } else { *satellite });
    of_have != of_want && excluded.1.contains(of_have) && excluded.0 == sorted(swapped)
}

fn sorted(satellites: impl Iterator<Item = SatelliteId>) -> Vec<SatelliteId> {
    let mut satellites: Vec<_> = satellites.collect();
    satellites.sort_unstable();
    satellites
}

/// Compares a report on a changed sky with that on the original sky, whose position is now at
/// `moved`.
fn agree(
    have: &Report<CAPACITY>,
    want: &Report<CAPACITY>,
    moved: impl Fn(Ecef) -> Ecef,
    rounding: Rounding,
) -> Result<(), TestCaseError> {
    if rounding_decides(have, rounding) {
        return Ok(());
    }
    if is_ambiguous(have) || is_ambiguous(want) {
        prop_assert!(is_alert(have) && is_alert(want), "{:?} {:?}", have.verdict, want.verdict);
        return Ok(());
    }
    prop_assert_eq!(have.verdict, want.verdict);
    prop_assert_eq!(have.excluded_constellations, want.excluded_constellations);
    for constellation in Constellation::ALL {
        let of = |satellites: Vec<SatelliteId>| of_system(satellites, constellation);
        let used = (of(used(have)), of(used(want)));
        // Of a whole constellation only the first satellites are listed.
        let listed = (of(excluded(have)), of(excluded(want)));
        let excluded = if want.excluded_constellations == 0 { listed } else { Default::default() };
        if !is_tie_of_a_pair(&used, &excluded) {
            prop_assert_eq!(used.0, used.1);
            prop_assert_eq!(excluded.0, excluded.1);
        }
    }
    if have_two_solutions(have, want) {
        return Ok(());
    }
    if let (Some(have), Some(want)) = (&have.solution, &want.solution) {
        let apart_m = have.position.distance_m(moved(want.position));
        let limit_m = rounding.range_m * (1.0 + want.pdop()) + rounding.of_sigma * sigma_m(want);
        prop_assert!(apart_m < limit_m, "{} m apart, {} m allowed", apart_m, limit_m);
    }
    numbers_agree(have, want, rounding)
}

fn numbers_agree(
    have: &Report<CAPACITY>,
    want: &Report<CAPACITY>,
    rounding: Rounding,
) -> Result<(), TestCaseError> {
    let close = |have: f64, want: f64| (have - want).abs() <= rounding.relative * want.max(1.0);
    if let (Some(have), Some(want)) = (have.test, want.test) {
        prop_assert_eq!(have.dof, want.dof);
        prop_assert!(close(have.statistic, want.statistic), "{:?} {:?}", have, want);
    }
    if let (Some(have), Some(want)) = (have.protection, want.protection) {
        let largest_m = |levels: ProtectionLevels| levels.hpl_m.max(levels.vpl_m);
        let is_beyond = largest_m(have).min(largest_m(want)) > LARGEST_LEVEL_M;
        let is_close = close(have.hpl_m, want.hpl_m) && close(have.vpl_m, want.vpl_m);
        prop_assert!(is_beyond || is_close, "{:?} {:?}", have, want);
    }
    Ok(())
}

/// Returns the sky with its satellites in another order.
fn reordered(sky: &Sky, by: usize) -> Sky {
    let count = sky.observations.len();
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by_key(|index| (index * by % 29, *index));
    Sky {
        receiver: sky.receiver,
        observations: order.into_iter().map(|index| sky.observations[index]).collect(),
    }
}

fn turned_sky(sky: &Sky, angle_rad: f64) -> Sky {
    sky.map(|observation| {
        let position = turned(observation.position, angle_rad);
        Observation { position, ..*observation }
    })
}

fn with_clock(sky: &Sky, clock_m: impl Fn(Constellation) -> f64) -> Sky {
    sky.map(|observation| {
        let range_m = observation.range_m + clock_m(observation.satellite.constellation());
        Observation { range_m, ..*observation }
    })
}

fn symmetries_hold<T: Real>(sky: &Sky, changes: &Changes, rounding: Rounding) -> Result<(), TestCaseError> {
    let want = judge::<T>(sky);
    if rounding_decides(&want, rounding) {
        return Ok(());
    }
    let stays = |position| position;
    agree(&judge::<T>(&reordered(sky, changes.by)), &want, stays, rounding)?;
    let turn = |position| turned(position, changes.angle_rad);
    agree(&judge::<T>(&turned_sky(sky, changes.angle_rad)), &want, turn, rounding)?;
    let late = judge::<T>(&with_clock(sky, |_| changes.common_m));
    agree(&late, &want, stays, rounding)?;
    let one = |constellation| if constellation == changes.constellation { changes.common_m } else { 0.0 };
    let one_late = judge::<T>(&with_clock(sky, one));
    agree(&one_late, &want, stays, rounding)?;
    clocks_follow(&one_late, &want, one, rounding)
}

/// Checks that each clock has moved by the value added to its ranges, and no other clock has.
fn clocks_follow(
    have: &Report<CAPACITY>,
    want: &Report<CAPACITY>,
    added_m: impl Fn(Constellation) -> f64,
    rounding: Rounding,
) -> Result<(), TestCaseError> {
    if rounding_decides(have, rounding)
        || is_ambiguous(have)
        || is_ambiguous(want)
        || have_two_solutions(have, want)
    {
        return Ok(());
    }
    let (used_of_have, used_of_want) = (used(have), used(want));
    let (Some(have), Some(want)) = (&have.solution, &want.solution) else { return Ok(()) };
    let clocks = have.clocks_m.into_iter().zip(want.clocks_m).zip(Constellation::ALL);
    for ((have_m, want_m), constellation) in clocks {
        // The clock of a lone satellite is its own: of another satellite it is another.
        if of_system(used_of_have.clone(), constellation) != of_system(used_of_want.clone(), constellation) {
            continue;
        }
        prop_assert_eq!(have_m.is_some(), want_m.is_some());
        let moved_m = have_m.unwrap_or(0.0) - want_m.unwrap_or(0.0);
        let want_m = if want_m.is_some() { added_m(constellation) } else { 0.0 };
        let limit_m = rounding.range_m * (2.0 + want.pdop());
        prop_assert!((moved_m - want_m).abs() < limit_m, "{:?}: {} for {}", constellation, moved_m, want_m);
    }
    Ok(())
}

/// Changes of a sky.
#[derive(Clone, Debug)]
struct Changes {
    by: usize,
    angle_rad: f64,
    constellation: Constellation,
    common_m: f64,
}

fn any_changes() -> impl Strategy<Value = Changes> {
    let constellation = prop::sample::select(&Constellation::ALL[..]);
    (1..28_usize, -3.1..3.1_f64, constellation, -3e8..3e8_f64).prop_map(
        |(by, angle_rad, constellation, common_m)| Changes { by, angle_rad, constellation, common_m },
    )
}

/// Judges from a start near the solution: the squares of so few ranges may have another minimum, to
/// which the way from the earth's centre may lead.
fn judge_from(sky: &Sky, start: Ecef) -> Report<CAPACITY> {
    let mut monitor = Monitor::<f64, CAPACITY>::new(REQUIRED).unwrap();
    monitor.disable_continuity();
    monitor.start_from(start);
    monitor.process(&sky.epoch())
}

/// Checks that leaving satellites out equals their absence, which double precision judges.
fn excluded_as_if_absent<T: Real>(sky: &Sky, rounding: Rounding) -> Result<(), TestCaseError> {
    let want = judge::<T>(sky);
    if want.verdict != Verdict::Protected(Protected::Excluded) || rounding_decides(&want, rounding) {
        return Ok(());
    }
    let mut rest = sky.clone();
    rest.observations.retain(|observation| want.used.contains(&observation.satellite));
    let solution = want.solution.as_ref().unwrap();
    let have = judge_from(&rest, solution.position);
    prop_assert_eq!(have.verdict, Verdict::Protected(Protected::Ok));
    prop_assert_eq!(&have.used, &want.used);
    let apart_m = have.solution.as_ref().unwrap().position.distance_m(solution.position);
    let limit_m = rounding.range_m * (1.0 + solution.pdop()) + rounding.of_sigma * sigma_m(solution);
    prop_assert!(apart_m < limit_m, "{} m apart, {} m allowed", apart_m, limit_m);
    numbers_agree(&have, &want, rounding)
}

/// Checks that in a unit that is a power of two every result is the same to the last bit.
///
/// The reference of a constellation's residuals is a whole multiple of 2⁻¹⁴ m beside `f32`. Ranges
/// are such multiples here, so that the reference is exactly the first residual in both units.
fn unit_does_not_matter<T: Real>(sky: &Sky) -> Result<(), TestCaseError> {
    let on_grid = |range_m: f64| (range_m * GRID_PER_M).round() / GRID_PER_M;
    let sky = sky.map(|observation| Observation { range_m: on_grid(observation.range_m), ..*observation });
    let solve = |unit| solved::<T>(sky.linearised(unit));
    let (Ok(want), Ok(have)) = (solve(1.0), solve(4.0)) else {
        prop_assert_eq!(solve(1.0).err(), solve(4.0).err());
        return Ok(());
    };
    let four = T::narrow(4.0);
    prop_assert_eq!((have.sse(), have.dof()), (want.sse(), want.dof()));
    prop_assert_eq!(have.correction(), want.correction() * four);
    prop_assert_eq!(have.dilutions(), want.dilutions());
    let (have, want) = (largest_slopes(&have), largest_slopes(&want));
    prop_assert_eq!((have.horizontal, have.vertical), (want.horizontal * four, want.vertical * four));
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn what_does_not_matter_changes_nothing(sky in any_sky(0), changes in any_changes()) {
        symmetries_hold::<f64>(&sky, &changes, DOUBLE)?;
        symmetries_hold::<f32>(&sky, &changes, SINGLE)?;
    }

    #[test]
    fn what_does_not_matter_changes_no_isolation(sky in any_sky(3), changes in any_changes()) {
        symmetries_hold::<f64>(&sky, &changes, NOT_LINEARISED_AGAIN)?;
    }

    #[test]
    fn satellites_left_out_are_as_if_absent(sky in any_sky(2)) {
        excluded_as_if_absent::<f64>(&sky, NOT_LINEARISED_AGAIN)?;
    }

    #[test]
    fn a_gross_fault_costs_the_others_no_digits(sky in grossly_wrong_sky()) {
        excluded_as_if_absent::<f32>(&sky, SINGLE)?;
    }

    #[test]
    fn unit_of_length_does_not_matter(sky in any_sky(2)) {
        unit_does_not_matter::<f64>(&sky)?;
        unit_does_not_matter::<f32>(&sky)?;
    }
}
