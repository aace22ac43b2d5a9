//! Identification: the row whose removal lowers SSE most, if that is enough and no other row does
//! as well.

use nalgebra::Vector3;
use proptest::prelude::*;
use raim_core::internals::integrity::raim::detection::threshold::Thresholds;
use raim_core::internals::integrity::raim::isolation::baarda::{identify, worst_two};
use raim_core::internals::integrity::raim::isolation::exclusion::{ExclusionOutcome, Unidentified};
use raim_core::internals::integrity::raim::isolation::ransac::{self, MAX_WORK, Selection};
use raim_core::internals::integrity::raim::levels::Slopes;
use raim_core::internals::least_squares::Snapshot;
use raim_core::internals::least_squares::equations::LinearEpoch;
use raim_core::internals::numeric::probability::Probability;
use raim_core::satellite::Constellation;

use crate::solved::solved;

use super::oracle::{self, Range};

fn thresholds() -> Thresholds<'static> {
    let probability = |tail| Probability::new(tail).unwrap();
    Thresholds::from_tables(probability(1e-5), probability(1e-3)).unwrap()
}

fn range(azimuth: f64, up: f64, constellation: Constellation, residual_m: f64) -> Range {
    let level = (1.0 - up * up).sqrt();
    let line_of_sight = [level * azimuth.sin(), level * azimuth.cos(), up];
    Range { line_of_sight, constellation, residual_m, sigma_m: 2.0 }
}

fn solve(ranges: &[Range]) -> Snapshot<'static, f64> {
    let mut epoch = LinearEpoch::new();
    for range in ranges {
        let line_of_sight = Vector3::from(range.line_of_sight);
        epoch.satellite(range.constellation, line_of_sight, range.residual_m, range.sigma_m).unwrap();
    }
    solved(epoch).unwrap()
}

/// Returns eight ranges of GPS, and two of Galileo, of which the second has an error of `fault_m`.
fn ten(fault_m: f64) -> Vec<Range> {
    let ups = [0.3, 0.8, 0.2, 0.6, 0.4, 0.95, 0.25, 0.5];
    let mut ranges: Vec<Range> = ups
        .iter()
        .enumerate()
        .map(|(index, &up)| range(0.79 * index as f64, up, Constellation::Gps, 0.0))
        .collect();
    ranges.push(range(0.5, 0.55, Constellation::Galileo, 0.0));
    ranges.push(range(3.5, 0.35, Constellation::Galileo, fault_m));
    ranges
}

/// A fault in one of a constellation's two satellites could as well be in the other.
#[test]
fn one_of_a_pair_is_never_named() {
    for fault_m in [30.0, -40.0, 300.0, 30_000.0] {
        assert_eq!(
            identify(&solve(&ten(fault_m)), &thresholds()),
            Err(Unidentified::Ambiguous),
            "{fault_m} m"
        );
    }
}

#[test]
fn consensus_is_not_asked_where_nothing_is_detected() {
    let mut solution = solve(&ten(0.0));
    let (selection, limits) =
        (Selection::choose(solution.equations(), MAX_WORK), ransac::ConsensusLimits::published().unwrap());
    let exclusion = ransac::exclude(&mut solution, &selection, &thresholds(), &limits);
    assert_eq!((exclusion.outcome, exclusion.rows.len(), solution.used()), (ExclusionOutcome::Passed, 0, 10));
}

#[test]
fn a_level_is_a_slope_times_the_root_of_the_noncentrality() {
    let levels = Slopes { horizontal: 2.0_f64, vertical: 3.0 }.protect(16.0);
    assert!((levels.hpl_m - 8.0).abs() < 1e-12 && (levels.vpl_m - 12.0).abs() < 1e-12, "{levels:?}");
}

fn any_range() -> impl Strategy<Value = Range> {
    (0.0..std::f64::consts::TAU, 0.1f64..1.0, -3.0f64..3.0)
        .prop_map(|(azimuth, up, residual_m)| range(azimuth, up, Constellation::Gps, residual_m))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn the_worst_row_is_named_from_the_threshold_on(ranges in prop::collection::vec(any_range(), 7..16)) {
        let full = oracle::solve(&ranges);
        prop_assume!(full.as_ref().is_some_and(|full| full.covariance_m2.trace() < 1e3));
        let falls: Option<Vec<f64>> = (0..ranges.len())
            .map(|index| oracle::solve_without(&ranges, &[index]).filter(|without| without.covariance_m2.trace() < 1e4))
            .map(|without| without.map(|without| full.as_ref().unwrap().sse - without.sse))
            .collect();
        prop_assume!(falls.is_some());
        let mut order: Vec<(f64, usize)> = falls.unwrap().into_iter().zip(0..).collect();
        order.sort_by(|a, b| b.0.total_cmp(&a.0));
        let ((largest, worst), (runner_up, _)) = (order[0], order[1]);
        prop_assume!(runner_up < 0.999 * largest && largest > 1e-3);

        let (have, have_largest, have_runner_up) = worst_two(&solve(&ranges)).unwrap();
        prop_assert_eq!(have, worst);
        prop_assert!((have_largest / largest - 1.0).abs() < 1e-6, "{} {}", have_largest, largest);
        prop_assert!((have_runner_up - runner_up).abs() < 1e-6 * largest, "{} {}", have_runner_up, runner_up);

        // Residuals twice as large have w-tests twice as large.
        let threshold = thresholds().w_test::<f64>(ranges.len()).unwrap();
        let scaled = |w: f64| {
            let scale = w / largest.sqrt();
            let scaled: Vec<Range> =
                ranges.iter().map(|range| Range { residual_m: range.residual_m * scale, ..*range }).collect();
            identify(&solve(&scaled), &thresholds())
        };
        prop_assert_eq!(scaled(0.999 * threshold), Err(Unidentified::BelowThreshold));
        prop_assert_eq!(scaled(1.001 * threshold), Ok(worst));
    }
}
