//! Window of equally spaced first differences of the clock, without the level.
//!
//! `x_t = Z_t − Z_{t−1} − x_ref`, `m = mean x`
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `Z` | receiver clock times the speed of light; only its differences are used | m |
//! | `x_ref` | `reference_m`, the first difference: the common drift of hundreds of metres | m |
//! | `x_t` | `differences`; `None` if the epoch before or at `t` is missing | m |
//! | `m` | [`Window::mean`] | m |
//!
//! Levels of 3e8 m and the drift stay in `f64`. The stored values are centimetres to metres, so
//! that `f32` suffices.

use heapless::Deque;

use crate::numeric::real::Real;

/// Differences of the last `L` values of a clock.
#[derive(Clone, Debug)]
pub(super) struct Window<T, const L: usize> {
    reference_m: Option<f64>,
    /// Differences. A missing one is NaN, because an [`Option`] would double the memory.
    differences: Deque<T, L>,
}

impl<T: Real, const L: usize> Window<T, L> {
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self { reference_m: None, differences: Deque::new() }
    }

    /// Forgets everything.
    pub(super) fn clear(&mut self) {
        self.reference_m = None;
        self.differences.clear();
    }

    /// Returns the reference of every difference, m.
    pub(super) fn reference_m(&self) -> f64 {
        self.reference_m.unwrap_or(0.0)
    }

    /// Returns the mean of `steps` differences whose sum is `change_m`, relative to the reference.
    /// The first difference becomes the reference.
    pub(super) fn relative(&mut self, change_m: f64, steps: usize) -> T {
        let reference_m = *self.reference_m.get_or_insert(change_m);
        T::narrow(change_m - steps as f64 * reference_m) / T::narrow(steps as f64)
    }

    /// Appends a relative difference, or a missing one; `L` values have `L − 1` differences.
    pub(super) fn push(&mut self, difference: Option<T>) {
        while self.differences.len() + 1 >= L {
            if self.differences.pop_front().is_none() {
                return;
            }
        }
        // Never full, because the oldest was removed above.
        let _ = self.differences.push_back(difference.unwrap_or(T::narrow(f64::NAN)));
    }

    /// Iterates over the differences, oldest first.
    fn each(&self) -> impl Iterator<Item = Option<T>> + Clone {
        // Two slices need one bounds test each; the ring would need one for each element.
        let (older, newer) = self.differences.as_slices();
        older.iter().chain(newer).map(|&x| x.is_finite().then_some(x))
    }

    /// Returns the mean of the relative differences that exist, or 0.
    pub(super) fn mean(&self) -> T {
        let add = |(sum, count), x| (sum + x, count + 1_u16);
        let (sum, count) = self.each().flatten().fold((T::zero(), 0), add);
        sum / T::narrow(f64::from(count.max(1)))
    }

    /// Iterates over the differences minus `mean`, oldest first.
    pub(super) fn centred(&self, mean: T) -> impl Iterator<Item = Option<T>> + Clone {
        self.each().map(move |difference| difference.map(|x| x - mean))
    }
}
