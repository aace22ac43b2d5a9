//! Thresholds of the tests for any pair of tail probabilities.
//!
//! | row | meaning | equation |
//! |---|---|---|
//! | `tau1` | threshold of the global test | `Q(tau1; ν) = Pfa` |
//! | `lambda` | non-centrality that is missed with `Pmd` | `G(tau1; ν, lambda) = Pmd` |
//! | `w_test` | two-sided threshold of one of `n` w-tests | `Q(w²; 1) = Pfa / n` |

use raim_core::internals::integrity::raim::detection::threshold::{MAX_DOF, MAX_TESTS};

use super::chi_square;

/// Rows of one pair of probabilities, in the form of
/// [`raim_core::internals::integrity::raim::detection::threshold::Thresholds`].
#[derive(Clone, Debug)]
pub struct Rows {
    /// Thresholds of the global test for 1, 2, … degrees of freedom.
    pub tau1: Vec<f64>,
    /// Non-centralities for 1, 2, … degrees of freedom.
    pub lambda: Vec<f64>,
    /// Thresholds of the w-test for 1, 2, … tests.
    pub w_test: Vec<f64>,
}

impl Rows {
    /// Computes all rows of any pair of tail probabilities.
    pub fn compute(false_alarm: f64, missed_detection: f64) -> Self {
        let tau1 = tau1_row(false_alarm);
        let lambda = lambda_row(&tau1, missed_detection);
        Self { tau1, lambda, w_test: w_test_row(false_alarm) }
    }
}

/// Returns the thresholds of the global test for 1, 2, … degrees of freedom.
pub fn tau1_row(false_alarm: f64) -> Vec<f64> {
    (1..=MAX_DOF).map(|dof| chi_square::upper_quantile(false_alarm, dof)).collect()
}

/// Returns the non-centralities that are missed with this probability, beside those thresholds.
pub fn lambda_row(tau1: &[f64], missed_detection: f64) -> Vec<f64> {
    (1..).zip(tau1).map(|(dof, &tau1)| chi_square::noncentrality(tau1, dof, missed_detection)).collect()
}

/// Returns the two-sided thresholds of one of 1, 2, … w-tests.
pub fn w_test_row(false_alarm: f64) -> Vec<f64> {
    (1..=MAX_TESTS).map(|n| chi_square::two_sided_normal_quantile(false_alarm / n as f64)).collect()
}
