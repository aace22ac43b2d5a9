//! Threshold policies and the χ² inverses below them: against 50-digit tables, closed forms and
//! each other.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing, clippy::float_cmp)]

use std::path::Path;

use proptest::prelude::*;
use raim_core::internals::integrity::raim::detection::threshold::Thresholds;
use raim_core::internals::integrity::raim::detection::threshold::policy::{
    Decision, NoThreshold, Policy, Status, ThresholdProblem, Weights, range_threshold_m,
};
use raim_core::internals::integrity::raim::levels::noncentrality_at;
use raim_core::internals::integrity::raim::levels::{LevelInputs, Slopes};
use raim_core::internals::numeric::chi_square::{ChiSquare, LARGEST};
use raim_core::internals::numeric::probability::Probability;
use raim_core::internals::numeric::real::Real;
use raim_core::requirements::Requirements;

/// The relative errors that the functions declare, in double and in single precision.
const DECLARED: [f64; 2] = [3e-11, 3e-5];

fn probability(tail: f64) -> Probability {
    Probability::new(tail).expect("a tail")
}

fn chi_square<T: Real>(dof: f64) -> ChiSquare<T> {
    ChiSquare::new(dof as usize).expect("a number of degrees of freedom within the tables")
}

fn demand(dof: usize, noncentrality: f64, false_alarm: f64, missed: f64) -> ThresholdProblem<'static> {
    let missed_detection = probability(missed);
    let thresholds =
        Thresholds::from_tables(probability(false_alarm), missed_detection).expect("in the tables");
    ThresholdProblem { dof, noncentrality, thresholds, missed_detection, weights: Weights::EQUAL }
}

fn assert_close(have: f64, want: f64, relative: f64, case: &str) {
    assert!((have / want - 1.0).abs() <= relative, "{case}: have {have:e}, want {want:e}");
}

/// Rows of a gold table with as many columns as `N`, without the heading.
fn gold<const N: usize>(table: &str) -> Vec<[f64; N]> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests-host/vectors/gold");
    let text = std::fs::read_to_string(folder.join(table)).expect("the gold values come with the project");
    let row = |line: &str| {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().expect("a number")).collect();
        cells.try_into().expect("as many columns as the heading says")
    };
    text.lines().skip(1).map(row).collect()
}

/// Prints the worst relative error over all rows, and compares it with the declared one.
fn compare<const N: usize>(
    name: &str,
    rows: &[[f64; N]],
    have: [fn(&[f64; N]) -> f64; 2],
    want: fn(&[f64; N]) -> f64,
) {
    for (scalar, have, declared) in [("f64", have[0], DECLARED[0]), ("f32", have[1], DECLARED[1])] {
        let error = |row: &[f64; N]| (have(row) / want(row) - 1.0).abs();
        let worst = rows.iter().max_by(|a, b| error(a).total_cmp(&error(b))).expect("rows");
        println!(
            "{name} {scalar}: {} rows, worst relative error {:.1e} at {worst:?}",
            rows.len(),
            error(worst)
        );
        assert!(error(worst) <= declared, "{name} {scalar}: {:e} at {worst:?}", error(worst));
    }
}

fn quantile<T: Real>(&[dof, noncentrality, tail, _]: &[f64; 4]) -> f64 {
    chi_square::<T>(dof).quantile(probability(tail), noncentrality).widen()
}

fn crossing<T: Real>(&[dof, noncentrality, _]: &[f64; 3]) -> f64 {
    chi_square::<T>(dof).crossing(noncentrality, 0.0).widen()
}

fn noncentrality<T: Real>(&[dof, _, tail, statistic, _]: &[f64; 5]) -> f64 {
    chi_square::<T>(dof).noncentrality(statistic, probability(tail)).widen()
}

#[test]
fn quantiles_agree_with_every_row_of_the_gold_table() {
    let rows = gold("tau2.csv");
    compare("tau2", &rows, [quantile::<f64>, quantile::<f32>], |row| row[3]);
}

#[test]
fn crossings_agree_with_every_row_of_the_gold_table() {
    let rows = gold("tau_op.csv");
    compare("tau_OP", &rows, [crossing::<f64>, crossing::<f32>], |row| row[2]);
}

#[test]
fn noncentralities_agree_with_every_row_of_the_gold_table() {
    let rows = gold("lambda.csv");
    compare("lambda", &rows, [noncentrality::<f64>, noncentrality::<f32>], |row| row[4]);
}

#[test]
fn published_thresholds_are_met() {
    let tau2 =
        [(1, 50.0, 15.84705132), (4, 200.0, 124.7935572), (12, 300.0, 212.4676114), (16, 1e3, 828.3522348)];
    for (dof, delta, want) in tau2 {
        let have = chi_square::<f64>(f64::from(dof)).quantile(probability(1e-3), delta);
        assert_close(have, want, 1e-9, &format!("tau2 of {dof}, {delta}"));
    }
    let crossings =
        [(1, 50.0, 13.20275624), (4, 50.0, 18.43209131), (12, 300.0, 97.49053025), (16, 1e3, 285.9042734)];
    for (dof, delta, want) in crossings {
        let have = chi_square::<f64>(f64::from(dof)).crossing(delta, 0.0);
        assert_close(have, want, 1e-9, &format!("tau_OP of {dof}, {delta}"));
    }
}

#[test]
fn crossing_of_one_degree_of_freedom_is_an_inverse_hyperbolic_cosine() {
    for delta in [1e-6_f64, 1e-3, 0.7, 30.0, 119.0, 121.0, 700.0, 1e5, 1e8] {
        // cosh z = exp(δ/2), written so that it neither overflows nor cancels.
        let z = delta / 2.0 + (-(-delta).exp_m1()).sqrt().ln_1p();
        let (case, want) = (format!("delta {delta}"), z * z / delta);
        assert_close(chi_square::<f64>(1.0).crossing(delta, 0.0), want, DECLARED[0], &case);
        assert_close(f64::from(chi_square::<f32>(1.0).crossing(delta, 0.0)), want, 2.0 * DECLARED[1], &case);
    }
}

#[test]
fn crossing_of_three_degrees_of_freedom_solves_sinh_z_over_z() {
    for delta in [0.1_f64, 5.0, 100.0, 1e4, 1e7] {
        let have = chi_square::<f64>(3.0).crossing(delta, 0.0);
        let z = (delta * have).sqrt();
        // ln(sinh z / z)
        let have = z + (-(-2.0 * z).exp_m1()).ln() - (2.0 * z).ln();
        assert_close(have, delta / 2.0, DECLARED[0], &format!("delta {delta}"));
    }
}

#[test]
fn crossing_goes_to_the_degrees_of_freedom_as_the_fault_vanishes() {
    for dof in [1, 2, 7, 60] {
        for delta in [1e-6, 1e-12, 0.0, -1.0, f64::NAN] {
            let have = chi_square::<f64>(f64::from(dof)).crossing(delta, 0.0);
            assert_close(have, f64::from(dof), 1e-6, &format!("{dof} degrees of freedom, delta {delta}"));
        }
    }
}

#[test]
fn weighted_crossing_of_one_degree_of_freedom_is_the_same_function_of_a_shifted_argument() {
    for (weight, delta) in [(10.0_f64, 60.0_f64), (0.1, 60.0), (1e6, 300.0)] {
        let target = delta / 2.0 + weight.ln();
        let z = target + (-(-2.0 * target).exp_m1()).sqrt().ln_1p();
        let have = chi_square::<f64>(1.0).crossing(delta, weight.ln());
        assert_close(have, z * z / delta, DECLARED[0], &format!("weight {weight}, delta {delta}"));
    }
}

#[test]
fn densities_that_do_not_cross_have_no_crossing() {
    // g ≥ f exp(−δ/2): a false alarm that costs next to nothing is worth any detection.
    assert_eq!(chi_square::<f64>(4.0).crossing(2.0, -1.0), 0.0);
    assert_eq!(chi_square::<f32>(4.0).crossing(2.0, -50.0), 0.0);
}

#[test]
fn a_threshold_that_is_not_a_number_protects_nothing() {
    let have = chi_square::<f64>(2.0).noncentrality(f64::NAN, probability(1e-3));
    assert!(have >= LARGEST, "{have}");
}

/// Returns `G(t; 1, δ)` of the squared normal, by its tails.
fn lower_tail_of_one(statistic: f64, delta: f64) -> f64 {
    let (root, mean) = (statistic.sqrt(), delta.sqrt());
    let below = |x: f64| 0.5 * libm::erfc(-x / core::f64::consts::SQRT_2);
    below(root - mean) - below(-root - mean)
}

#[test]
fn quantiles_of_one_degree_of_freedom_have_their_normal_tail() {
    for (tail, delta) in [(1e-3, 40.0), (1e-6, 400.0), (1e-9, 1e5), (0.45, 1e3), (1e-3, 2e7)] {
        let have = lower_tail_of_one(chi_square::<f64>(1.0).quantile(probability(tail), delta), delta);
        // A root of 4,500 is rounded by 5e-13, which the tail shows threefold.
        assert_close(have, tail, 1e-9, &format!("tail {tail}, delta {delta}"));
    }
}

#[test]
fn central_quantile_of_two_degrees_of_freedom_is_a_logarithm() {
    for tail in [0.4, 1e-3, 1e-9] {
        let want = -2.0 * libm::log1p(-tail);
        for delta in [0.0, -3.0, f64::NAN] {
            let (case, tail) = (format!("tail {tail}, delta {delta}"), probability(tail));
            assert_close(chi_square::<f64>(2.0).quantile(tail, delta), want, 2e-9, &case);
            assert_close(f64::from(chi_square::<f32>(2.0).quantile(tail, delta)), want, 1e-4, &case);
        }
    }
}

#[test]
fn a_statistic_that_noise_alone_stays_below_rarely_enough_needs_no_fault() {
    // F(0.002; 2) = 0.001
    for statistic in [0.0015, 0.0, -1.0] {
        assert_eq!(chi_square::<f64>(2.0).noncentrality(statistic, probability(1e-3)), 0.0, "{statistic}");
        assert_eq!(chi_square::<f32>(2.0).noncentrality(statistic, probability(1e-3)), 0.0, "{statistic}");
    }
}

#[test]
fn optimal_threshold_has_the_least_sum_of_both_risks() {
    let delta = 40.0;
    let cost = |statistic: f64| libm::erfc((statistic / 2.0).sqrt()) + lower_tail_of_one(statistic, delta);
    let have = chi_square::<f64>(1.0).crossing(delta, 0.0);
    assert!(cost(have) < cost(have * 1.001) && cost(have) < cost(have * 0.999), "{have}");
}

fn assert_finite<T: Real>(dof: usize, tail: f64, delta: f64) {
    let test = chi_square::<T>(dof as f64);
    let (tau, lambda, op) = (
        test.quantile(probability(tail), delta),
        test.noncentrality(delta, probability(tail)),
        test.crossing(delta, 0.0),
    );
    for value in [tau, lambda, op].map(Real::widen) {
        assert!(value.is_finite() && value >= 0.0, "{dof} {tail:e} {delta:e}: {value}");
    }
}

#[test]
fn nothing_overflows_at_the_ends_of_the_range() {
    for dof in [1, 2, 3, 29, 60] {
        for tail in [1e-300, 1e-20, 1e-7, 0.499] {
            for delta in [0.0, 1e-300, 1e-9, 1.0, 1e5, 1e12, 1e300, f64::INFINITY, f64::NAN] {
                assert_finite::<f64>(dof, tail, delta);
                assert_finite::<f32>(dof, tail, delta);
            }
        }
    }
}

#[test]
fn no_degrees_of_freedom_and_more_than_the_tables_have_are_refused() {
    for dof in [0, 61, usize::MAX] {
        assert!(ChiSquare::<f64>::new(dof).is_none());
        let demand = demand(dof, 100.0, 1e-5, 1e-3);
        assert_eq!(demand.decide::<f64>(), None);
        for policy in [Policy::T1, Policy::T2, Policy::TOp] {
            assert_eq!(demand.threshold::<f64>(policy), Err(NoThreshold::Redundancy));
        }
    }
}

#[test]
fn a_poor_geometry_leaves_only_the_classic_threshold() {
    for noncentrality in [0.0, 60.0, f64::NAN] {
        let demand = demand(4, noncentrality, 3.33e-7, 1e-3);
        assert!(demand.threshold::<f32>(Policy::T1).is_ok());
        assert_eq!(demand.threshold::<f32>(Policy::T2), Err(NoThreshold::Risk));
        assert_eq!(demand.threshold::<f32>(Policy::TOp), Err(NoThreshold::Risk));
    }
}

#[test]
fn a_crossing_outside_the_bounds_is_held_at_them() {
    // Two of the published cases: rare false alarms, and missed detections rarer than false alarms.
    let cases = [
        (demand(10, 125.0, 1e-8, 1e-3), Status::OpIsTau1),
        (demand(10, 103.5, 1e-4, 1e-6), Status::OpIsTau2),
        (demand(10, 1e4, 1e-4, 1e-6), Status::Op),
    ];
    for (demand, want) in cases {
        let Decision { tau1, tau2, tau_op, status, .. } = demand.decide::<f64>().expect("redundancy");
        assert_eq!(status, want);
        match want {
            Status::OpIsTau1 => assert_eq!(tau_op, Some(tau1)),
            Status::OpIsTau2 => assert_eq!(tau_op, Some(tau2)),
            _ => assert!(tau_op.is_some_and(|tau| tau1 < tau && tau < tau2)),
        }
    }
}

#[test]
fn costlier_false_alarms_raise_the_optimal_threshold() {
    let equal = demand(6, 400.0, 3.33e-7, 1e-3);
    let weighted = ThresholdProblem { weights: Weights::new(1e4, 1.0).expect("weights"), ..equal };
    let tau = |demand: ThresholdProblem| demand.threshold::<f64>(Policy::TOp).map(|threshold| threshold.tau);
    assert!(tau(equal).expect("available") < tau(weighted).expect("available"));
    for (false_alarm, missed) in [(0.0, 1.0), (-1.0, -1.0), (1.0, 0.0), (f64::NAN, 1.0), (f64::INFINITY, 1.0)]
    {
        assert_eq!(Weights::new(false_alarm, missed), None);
    }
}

#[test]
fn noncentrality_at_a_limit_is_held_within_what_can_be_computed() {
    assert_eq!(noncentrality_at(528.2, 6.0), (528.2_f64 / 6.0).powi(2));
    assert_eq!([noncentrality_at(10.0, 0.0), noncentrality_at(10.0, f64::INFINITY)], [LARGEST, 0.0]);
    assert_eq!([noncentrality_at(10.0, f64::NAN), noncentrality_at(-10.0, 1.0)], [0.0; 2]);
}

#[test]
fn range_thresholds_are_the_published_ones() {
    for (dof, want) in [(4, 17.925711), (8, 14.266398), (12, 12.671085), (16, 11.730971)] {
        let tau1 = demand(dof, 0.0, 3.33e-7, 1e-3).thresholds.tau1(dof).expect("in the tables");
        let have = range_threshold_m(tau1, dof, 6.0);
        assert!((have - want).abs() < 1e-6, "{dof}: have {have}, want {want}");
    }
}

#[test]
fn vertical_limit_counts_where_it_is_set() {
    let largest = Slopes { horizontal: 1.0, vertical: 4.0 };
    let rows = demand(4, 0.0, 3.33e-7, 1e-3).thresholds;
    let noncentrality = |requirements: &Requirements| {
        ThresholdProblem::new(4, &LevelInputs::to_faults(largest), requirements, rows).noncentrality
    };
    let horizontal_only = Requirements::lpv200().with_val_m(None);
    assert_eq!(noncentrality(&horizontal_only), (0.95_f64 * 40.0).powi(2));
    assert_eq!(noncentrality(&Requirements::lpv200()), (0.95_f64 * 35.0 / 4.0).powi(2));
}

/// Degrees of freedom, logarithm of the non-centrality, false alarm and missed detection of the
/// tables.
fn any_demand() -> impl Strategy<Value = ThresholdProblem<'static>> {
    let tail = |tails: &'static [f64]| prop::sample::select(tails);
    (1_usize..=60, -1.0..7.0_f64, tail(&[1e-3, 1e-4, 1e-5, 3.33e-7, 1e-8]), tail(&[1e-3, 1e-4, 1e-5, 1e-6]))
        .prop_map(|(dof, decades, alarm, missed)| demand(dof, 10_f64.powf(decades), alarm, missed))
}

fn assert_policies_agree<T: Real>(demand: &ThresholdProblem, relative: f64) {
    let decision = demand.decide::<T>().expect("redundancy");
    let threshold = |policy| demand.threshold::<T>(policy);
    let classic = threshold(Policy::T1).expect("redundancy");
    assert_eq!(classic.tau, decision.tau1);
    let Some(want) = decision.tau_op else {
        assert_eq!([threshold(Policy::T2), threshold(Policy::TOp)], [Err(NoThreshold::Risk); 2]);
        return;
    };
    let (highest, have) =
        (threshold(Policy::T2).expect("available"), threshold(Policy::TOp).expect("available"));
    assert_eq!((highest.tau, highest.lambda), (decision.tau2, demand.noncentrality));
    assert_close(have.tau, want, relative, "tau_OP of both ways");
    assert!(decision.tau1 <= want && want <= decision.tau2 * (1.0 + relative), "{decision:?}");
    let lambda = classic.lambda * (1.0 - relative)..=highest.lambda;
    assert!(lambda.contains(&have.lambda), "{have:?} outside {lambda:?}");
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn quantile_increases_with_the_noncentrality(demand in any_demand(), more in 1e-3..1.0_f64) {
        let greater = demand.noncentrality * (1.0 + more);
        let missed = demand.missed_detection;
        let (double, single) = (chi_square::<f64>(demand.dof as f64), chi_square::<f32>(demand.dof as f64));
        prop_assert!(double.quantile(missed, demand.noncentrality) < double.quantile(missed, greater));
        // In single precision where the increase is above what is declared: the tail of ν ≫ δ
        // hardly moves.
        if demand.noncentrality > demand.dof as f64 {
            prop_assert!(single.quantile(missed, demand.noncentrality) < single.quantile(missed, greater));
        }
    }

    #[test]
    fn noncentrality_takes_the_quantile_back(demand in any_demand()) {
        let (test, missed) = (chi_square::<f64>(demand.dof as f64), demand.missed_detection);
        let have = test.noncentrality(test.quantile(missed, demand.noncentrality), missed);
        prop_assert!((have / demand.noncentrality - 1.0).abs() < 1e-9, "{have}, {}", demand.noncentrality);
    }

    #[test]
    fn bounds_are_in_order_exactly_where_the_protection_level_is_within_its_share(
        demand in any_demand(), slope in 0.1..100.0_f64,
    ) {
        let limit_m = slope * demand.noncentrality.sqrt();
        let lambda: f64 = demand.thresholds.lambda(demand.dof).expect("in the tables");
        let hpl_m = slope * lambda.sqrt();
        let Decision { tau1, tau2, status, .. } = demand.decide::<f64>().expect("redundancy");
        prop_assume!((demand.noncentrality / lambda - 1.0).abs() > 1e-9);
        prop_assert_eq!(tau1 < tau2, hpl_m < limit_m);
        prop_assert_eq!(status == Status::Unavailable, hpl_m >= limit_m);
    }

    #[test]
    fn one_threshold_is_that_of_all(demand in any_demand()) {
        assert_policies_agree::<f64>(&demand, 1e-9);
        assert_policies_agree::<f32>(&demand, 1e-4);
    }
}
