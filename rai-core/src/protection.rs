//! Protection levels: how large can the position error be that the test does not see?
//!
//! A bias `b` of satellite `i` adds `b²r_i/σ_i²` to the non-centrality of SSE and moves the position by `b A_i`. The bias
//! that is missed with probability `P_md` has the non-centrality `λ(dof, P_fa, P_md)`, hence
//!
//! ```text
//! slope_h,i = √(w_i (g_iE² + g_iN²) / r_i)     slope_v,i = √w_i |g_iU| / √r_i
//! HPL = max slope_h √λ                         VPL = max slope_v √λ
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `slope_h`, `slope_v` | [`Slopes`] | m per unit of `√λ` |
//! | `HPL`, `VPL` | [`ProtectionLevels`] | m |
//!
//! A satellite without redundancy has slope 0 if it does not move the position (the lone satellite of a
//! constellation), else an infinite one. By the identity `HDOP_i² − HDOP² = (A_1i² + A_2i²)/S_ii` the change of HDOP
//! bounds the same thing for a common sigma ([Lin2016] eq. 22–26).
//!
//! **Hardly tested rows.** `r_i` is what is left of 1, and where little is left, single precision is too coarse: a slope
//! would come out as much as a fifth too small. Below a redundancy of 0.1 both are therefore taken from what the other
//! rows say of this one, where nothing cancels. With `P`, `d_i` and `W_c` of the others, `q_i = 1/W_c + d_i·P d_i` is the
//! variance of their prediction, and
//!
//! ```text
//! r_i = 1 / (1 + w_i q_i)                      slope_i² = w_i r_i |P d_i|²
//! ```
//!
//! Slopes below 100 m, protection levels of some 700 m, are then understated by 3 % at most in `f32`, and hardly ever by
//! more than 0.1 %; the guard on the alert limit is 5 %.
//!
//! **Not monotone.** A satellite fewer leaves the position less well known, by just the square of its slope
//! (`P_h` without `i` is `P_h + slope_h,i²`), and every other one less well tested. Yet the protection level may shrink, even
//! with the same `λ`: the satellite that is hardest to test takes the largest slope with it, and `λ` falls with the
//! degrees of freedom besides.
//!
//! Meaning: the worst bias of a single satellite, without the noise on the position. It is not an ARAIM protection
//! level. References: [Yang2015] eq. 6–8, [Lin2016] eq. 21–26, [Brown1992].

use crate::linear::Row;
use crate::real::Real;
use crate::report::ProtectionLevels;
use crate::snapshot::{Fit, Snapshot, infinity};

/// Redundancy number below which a slope is worked out from the other rows, dimensionless: above, `f32` is good to 0.5 %.
const HARDLY_TESTED: f64 = 0.1;

/// How far a row's bias moves the position by the time it shows in the test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slopes<T> {
    /// Horizontal, m per unit of `√λ`.
    pub horizontal: T,
    /// Vertical, m per unit of `√λ`.
    pub vertical: T,
}

/// The slopes of one row; 0 for a row that is left out.
pub fn slopes<T: Real>(row: &Row<T>, fit: &Fit<T>) -> Slopes<T> {
    let Squared { horizontal, vertical } = squared_slopes(row, fit);
    Slopes { horizontal: horizontal.sqrt(), vertical: vertical.sqrt() }
}

/// Squared slopes: the largest is found without a root for each row.
struct Squared<T> {
    horizontal: T,
    vertical: T,
}

impl<T: Real> Squared<T> {
    /// Below all others.
    fn none() -> Self {
        Self { horizontal: T::zero(), vertical: T::zero() }
    }

    /// The larger of both, each component by itself.
    fn or(&self, other: &Self) -> Self {
        Self {
            horizontal: larger(self.horizontal, other.horizontal),
            vertical: larger(self.vertical, other.vertical),
        }
    }
}

fn squared_slopes<T: Real>(row: &Row<T>, fit: &Fit<T>) -> Squared<T> {
    let horizontal = fit.gain.x * fit.gain.x + fit.gain.y * fit.gain.y;
    let vertical = fit.gain.z * fit.gain.z;
    if fit.gauge > T::zero() {
        return Squared { horizontal: horizontal * fit.gauge, vertical: vertical * fit.gauge };
    }
    if row.weight > T::zero() {
        return untestable(row, fit);
    }
    Squared::none()
}

/// The squared slopes of a row whose bias never shows.
fn untestable<T: Real>(row: &Row<T>, fit: &Fit<T>) -> Squared<T> {
    let unmoved = T::UNMOVED / row.weight;
    let limit = unmoved * unmoved;
    let slope = |moved: T| if moved <= limit { T::zero() } else { infinity() };
    Squared {
        horizontal: slope(fit.gain.x * fit.gain.x + fit.gain.y * fit.gain.y),
        vertical: slope(fit.gain.z * fit.gain.z),
    }
}

/// Whether too little of 1 is left for a row's redundancy, though others speak of it.
fn is_hardly_tested<T: Real, const N: usize>(snapshot: &Snapshot<T, N>, row: &Row<T>, fit: &Fit<T>) -> bool {
    let shares_clock = |other: &Row<T>| other.clock == row.clock && other.weight > T::zero();
    row.weight > T::zero()
        && fit.redundancy < T::narrow(HARDLY_TESTED)
        && snapshot.dof() > 0
        && (row.clock.is_none() || snapshot.rows().filter(|(other, _)| shares_clock(other)).count() > 1)
}

/// The squared slopes of a row by what the others say of it; `None` where it is untestable.
///
/// `room` holds the same rows, solved or not; it ends without this one.
fn by_the_others<T: Real, const N: usize>(
    snapshot: &Snapshot<T, N>,
    room: &mut Snapshot<T, N>,
    index: usize,
) -> Option<Squared<T>> {
    let (row, _) = snapshot.row(index)?;
    room.epoch_mut().leave_out(index);
    room.solve_again().ok()?;
    let (_, fit) = room.row(index)?;
    let predicted = room.level_variance(row) + fit.centred.dot(&fit.gain);
    let redundancy = (T::one() + row.weight * predicted).recip();
    if !(redundancy >= T::UNTESTABLE) {
        return None;
    }
    let scale = row.weight * redundancy;
    let horizontal = fit.gain.x * fit.gain.x + fit.gain.y * fit.gain.y;
    Some(Squared { horizontal: horizontal * scale, vertical: fit.gain.z * fit.gain.z * scale })
}

/// The largest slopes of a snapshot.
pub fn largest_slopes<T: Real, const N: usize>(snapshot: &Snapshot<T, N>) -> Slopes<T> {
    let (mut largest, mut all_are_tested) = (Squared::none(), true);
    for (row, fit) in snapshot.rows() {
        largest = largest.or(&squared_slopes(row, fit));
        all_are_tested &= fit.redundancy >= T::narrow(HARDLY_TESTED);
    }
    if !all_are_tested {
        largest = largest_with_care(snapshot);
    }
    Slopes { horizontal: largest.horizontal.sqrt(), vertical: largest.vertical.sqrt() }
}

/// As [`largest_slopes`], where some rows are hardly tested, or not at all.
///
/// Not inlined: only such epochs pay for the room on the stack.
#[inline(never)]
fn largest_with_care<T: Real, const N: usize>(snapshot: &Snapshot<T, N>) -> Squared<T> {
    let mut room = Snapshot::unsolved();
    room.epoch_mut().copy_from(snapshot.epoch());
    let mut largest = Squared::none();
    for (index, (row, fit)) in snapshot.rows().enumerate() {
        let squared = if is_hardly_tested(snapshot, row, fit) {
            let squared = by_the_others(snapshot, &mut room, index);
            room.epoch_mut().take_back(index);
            squared.unwrap_or_else(|| untestable(row, fit))
        } else {
            squared_slopes(row, fit)
        };
        largest = largest.or(&squared);
    }
    largest
}

/// The larger of two numbers; one comparison, where a library call also orders what is not a number.
fn larger<T: Real>(a: T, b: T) -> T {
    if b > a { b } else { a }
}

impl<T: Real> Slopes<T> {
    /// Protection levels for a non-centrality `λ` ([`crate::threshold::Thresholds::lambda`]), where these slopes are
    /// the largest.
    pub fn protect(&self, lambda: f64) -> ProtectionLevels {
        let root = libm::sqrt(lambda);
        ProtectionLevels { hpl_m: self.horizontal.widen() * root, vpl_m: self.vertical.widen() * root }
    }
}

/// The largest change of HDOP that leaving out one satellite brings, `max √(HDOP_i² − HDOP²)`, dimensionless.
pub fn largest_hdop_change<T: Real, const N: usize>(snapshot: &Snapshot<T, N>) -> T {
    let (hdop, _) = snapshot.dilutions();
    let changes = (0..snapshot.rows().count()).filter_map(|index| {
        let without = snapshot.hdop_without(index)?;
        Some((without * without - hdop * hdop).max(T::zero()))
    });
    changes.fold(T::zero(), T::max).sqrt()
}

/// The change of HDOP at which the protection level reaches the alert limit, `HAL/(σ√λ)`, dimensionless ([Lin2016] eq. 25).
pub fn hdop_change_limit(hal_m: f64, sigma_m: f64, lambda: f64) -> f64 {
    hal_m / (sigma_m * libm::sqrt(lambda))
}
