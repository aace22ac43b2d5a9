//! Baarda's w-test and sequential exclusion.
//!
//! ```text
//! w_i = v_i √(w_i / r_i)         N(0, 1) without fault, mean √r_i b_i/σ_i under a bias b_i
//! T_d = Q⁻¹(P_fa / 2n)           two-sided over n rows
//! SSE without i = SSE − w_i²     so the largest |w| explains the data best
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `w_i` | [`w_test`] | – |
//! | `r_i` | [`Fit::redundancy`] | – |
//! | `b_i = v_i / r_i` | [`Suspect::bias_m`](crate::report::Suspect::bias_m) with standard deviation `σ_i/√r_i` | m |
//!
//! A row is identified when a fault was detected, `dof ≥ 2`, its |w| is the largest, above `T_d`, and unique. It is
//! removed and the rest tested again, until the test passes or no row can be named.
//!
//! **Separability.** The largest |w| may belong to a healthy satellite when two are strongly correlated. Under a fault of
//! `j`, `w_i² − w_j²` exceeds `κ²` with a probability of at most `Q(κ)`, whatever the fault's size and the
//! correlation: with `u = w_i − w_j`, `s = w_i + w_j` and correlation ρ, the product `u s` needs `u ≥ κ²/((1+ρ)δ)`,
//! which is `κ √2/√(1+ρ) ≥ κ` standard deviations from its mean at the most favourable δ. [`separable`] therefore asks
//! the runner-up to be worse by `T_d²`: a wrong exclusion is then no likelier than a false alarm.
//!
//! Departures from the papers: [Lin2016] prints `d_i > T_d` without the absolute value; [Chen2009] eq. 13 prints
//! `ω_i/S_ii` where the statistic is `ω_i²/S_ii`. References: [Baarda1968], [Lin2016] eq. 14–20, [Wang1994] on
//! separability.

use heapless::Vec;

use crate::detection::detect;
use crate::real::Real;
use crate::report::MAX_EXCLUDED;
use crate::snapshot::{Fit, Snapshot, SnapshotError};
use crate::threshold::Thresholds;

/// The w-test of a row, dimensionless; 0 where the row is untestable or left out.
pub fn w_test<T: Real>(fit: &Fit<T>) -> T {
    fit.residual * fit.gauge.sqrt()
}

/// The w-test squared, without the root: the decrease of SSE when the row is left out.
fn w_squared<T: Real>(fit: &Fit<T>) -> T {
    fit.residual * fit.residual * fit.gauge
}

/// Which row a detected fault is in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Identification {
    /// This row of the epoch.
    Row(usize),
    /// With fewer than two degrees of freedom all |w| are equal.
    NoRedundancy,
    /// No |w| is large enough.
    BelowThreshold,
    /// Two rows fit equally badly.
    Ambiguous,
    /// No set of rows that may be left out explains it.
    NoSet,
    /// The declared work ended the search.
    Budget,
}

/// The row with the largest |w| and its w², and the w² of the runner-up. First of equals wins.
pub fn worst_two<T: Real, const N: usize>(snapshot: &Snapshot<T, N>) -> Option<(usize, T, T)> {
    let mut worst = None;
    for (index, (row, fit)) in snapshot.rows().enumerate() {
        if row.weight > T::zero() {
            let squared = w_squared(fit);
            worst = Some(match worst {
                Some((_, largest, _)) if squared > largest => (index, squared, largest),
                Some((known, largest, runner_up)) if squared > runner_up => (known, largest, squared),
                Some(worst) => worst,
                None => (index, squared, T::zero()),
            });
        }
    }
    worst
}

/// Names the faulty row of a snapshot in which a fault was detected.
pub fn identify<T: Real, const N: usize>(
    snapshot: &Snapshot<T, N>,
    thresholds: &Thresholds<'_>,
) -> Identification {
    if snapshot.dof() < 2 {
        return Identification::NoRedundancy;
    }
    let (Some((index, largest, runner_up)), Some(threshold)) =
        (worst_two(snapshot), thresholds.w_test(snapshot.used()))
    else {
        return Identification::BelowThreshold;
    };
    let threshold = T::narrow(threshold);
    // Written so that a w which is not a number is never identified.
    if !(largest > threshold * threshold) {
        return Identification::BelowThreshold;
    }
    let unique = T::one() - T::TIE;
    if runner_up < largest * unique * unique { Identification::Row(index) } else { Identification::Ambiguous }
}

/// How an exclusion ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Outcome {
    /// Nothing was detected.
    Passed,
    /// What remains passes the test.
    Isolated,
    /// The fault remains, and the reason why no row could be named.
    NotIsolated(Identification),
}

/// What can be tested, and solved again without one of its rows.
pub trait Reducible<T: Real, const N: usize> {
    /// The linearised epoch as it stands.
    fn snapshot(&self) -> &Snapshot<T, N>;

    /// Leaves one more row out.
    ///
    /// # Errors
    /// What is left does not determine a position; nothing has changed then.
    fn leave_out(&mut self, index: usize) -> Result<(), SnapshotError>;

    /// Takes a left-out row back.
    ///
    /// # Errors
    /// As [`Self::leave_out`].
    fn take_back(&mut self, index: usize) -> Result<(), SnapshotError>;
}

impl<T: Real, const N: usize> Reducible<T, N> for Snapshot<T, N> {
    fn snapshot(&self) -> &Snapshot<T, N> {
        self
    }

    fn leave_out(&mut self, index: usize) -> Result<(), SnapshotError> {
        Snapshot::leave_out(self, index)
    }

    fn take_back(&mut self, index: usize) -> Result<(), SnapshotError> {
        Snapshot::take_back(self, index)
    }
}

/// A row that was left out, as it stood at that moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Excluded<T> {
    /// Index of the row in the epoch.
    pub index: usize,
    /// Its w-test, signed, dimensionless.
    pub w_test: T,
}

/// Rows left out one after the other.
#[derive(Clone, Debug, PartialEq)]
pub struct Exclusion<T> {
    /// In the order of removal.
    pub rows: Vec<Excluded<T>, MAX_EXCLUDED>,
    /// How it ended.
    pub outcome: Outcome,
}

/// Leaves out the worst row until the rest passes the global test, at most [`MAX_EXCLUDED`] of them.
///
/// `solution` ends as the solution without the rows listed. A snapshot without redundancy passes nothing: it ends
/// as [`Outcome::NotIsolated`].
pub fn exclude_sequentially<T: Real, const N: usize>(
    solution: &mut impl Reducible<T, N>,
    thresholds: &Thresholds<'_>,
) -> Exclusion<T> {
    let mut rows = Vec::new();
    loop {
        let passed = detect(solution.snapshot(), thresholds).is_some_and(|detection| !detection.fault());
        if passed {
            let outcome = if rows.is_empty() { Outcome::Passed } else { Outcome::Isolated };
            return Exclusion { rows, outcome };
        }
        let identification = identify(solution.snapshot(), thresholds);
        let removed = match identification {
            Identification::Row(index) if !rows.is_full() => {
                let w_test = solution.snapshot().row(index).map_or(T::zero(), |(_, fit)| w_test(fit));
                solution.leave_out(index).is_ok() && rows.push(Excluded { index, w_test }).is_ok()
            }
            _ => false,
        };
        if !removed {
            return Exclusion { rows, outcome: Outcome::NotIsolated(identification) };
        }
    }
}

/// True when no other exclusion explains the data nearly as well as the one found.
///
/// Each row left out is taken back in turn; no other row's removal may then pass the global test with a sum of
/// squares within `T_d²` of the found one's. `solution` ends as it began.
pub fn separable<T: Real, const N: usize>(
    solution: &mut impl Reducible<T, N>,
    exclusion: &Exclusion<T>,
    thresholds: &Thresholds<'_>,
) -> bool {
    exclusion.rows.iter().all(|excluded| {
        let taken_back = solution.take_back(excluded.index).is_ok();
        let stands_out = taken_back && stands_out(solution.snapshot(), excluded.index, thresholds);
        solution.leave_out(excluded.index).is_ok() && stands_out
    })
}

/// True when removing any other row instead of `index` is clearly worse.
fn stands_out<T: Real, const N: usize>(
    snapshot: &Snapshot<T, N>,
    index: usize,
    thresholds: &Thresholds<'_>,
) -> bool {
    let (Some((_, fit)), Some(margin), Some(tau)) = (
        snapshot.row(index),
        thresholds.w_test(snapshot.used()),
        snapshot.dof().checked_sub(1).and_then(|dof| thresholds.tau1(dof)),
    ) else {
        return false;
    };
    let bound = w_squared(fit) - T::narrow(margin * margin);
    let tau = T::narrow(tau);
    snapshot.rows().enumerate().all(|(other, (_, fit))| {
        let explained = w_squared(fit);
        other == index || explained <= bound || snapshot.sse() - explained >= tau
    })
}
