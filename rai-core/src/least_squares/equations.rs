//! The linearised epoch: one equation for each range, relative to a point.
//!
//! `y_i = h_i · x + b_c + ε_i`, `ε_i ~ N(0, σ_i²)`, with `h_i = −LOS_i`
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `LOS_i` | unit vector receiver → satellite, east, north, up | – |
//! | `h_i` | `design` | – |
//! | `y_i` | `residual`, measured minus predicted range, minus the constellation's reference | m |
//! | `w_i = 1/σ_i²` | `weight`; 0 leaves the row out | 1/m² |
//! | `x` | correction of the position, east, north, up | m |
//! | `b_c` | receiver clock of constellation `c` times the speed of light | m |
//!
//! A receiver clock can be 3e8 m while the residuals are metres. Each constellation's first
//! residual, rounded to [`Real::Absolute`], is therefore its reference and is subtracted from all.
//! The differences are small enough for `f32`.
//!
//! Aiding rows have the same form: a predicted clock has `h = 0`, a known height `h = (0, 0, 1)`
//! and no clock.

use core::fmt;

use heapless::Vec;
use nalgebra::Vector3;

pub use crate::bounded::MAX_ROWS;
use crate::bounded::assert_capacity;
use crate::frame::LineOfSight;
use crate::numeric::absolute::Absolute;
use crate::numeric::real::Real;
use crate::numeric::space::{dot, scaled, zero};
use crate::satellite::Constellation;

/// Range of the squared length that counts as a unit vector: the length may be off by 1e-3.
const UNIT_SQUARED: core::ops::RangeInclusive<f64> = 0.999 * 0.999..=1.001 * 1.001;

/// One equation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row<T> {
    /// Constellation of the receiver clock that the row depends on; `None` for a height.
    pub clock: Option<Constellation>,
    /// Partial derivative of the range with respect to the position, east, north, up.
    pub design: Vector3<T>,
    /// Measured minus predicted value, minus the reference of its clock, m.
    pub residual: T,
    /// Standard deviation, m.
    pub sigma: T,
    /// Inverse variance, 1/m²; 0 if the row is left out.
    pub weight: T,
}

impl<T: Real> Row<T> {
    fn new(
        clock: Option<Constellation>,
        design: Vector3<T>,
        residual: T,
        sigma: T,
    ) -> Result<Self, RowError> {
        // The difference of two infinities is NaN.
        if !residual.is_finite() {
            return Err(RowError::Residual);
        }
        let weight = (sigma * sigma).recip();
        // If the weight overflowed or underflowed, the row would silently have infinite or no
        // weight. The test reads the sign bit instead of `sigma > 0`: the compiler would compare
        // the double before rounding, by a library call on a Cortex-M4F.
        if !(sigma.is_sign_positive() && weight > T::zero() && weight.is_finite()) {
            return Err(RowError::Sigma);
        }
        Ok(Self { clock, design, residual, sigma, weight })
    }

    /// Returns the row of a known height.
    pub(crate) fn height(residual_m: f64, sigma_m: f64) -> Result<Self, RowError> {
        Self::new(None, Vector3::z(), T::narrow(residual_m), T::narrow(sigma_m))
    }

    /// Leaves the row out of all further computations.
    pub(crate) fn leave_out(&mut self) {
        self.weight = T::zero();
    }

    /// Takes the row back.
    pub(crate) fn take_back(&mut self) {
        self.weight = (self.sigma * self.sigma).recip();
    }
}

/// Reason why a row was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum RowError {
    /// The residual is not finite.
    Residual,
    /// The line of sight is not a unit vector.
    LineOfSight,
    /// The standard deviation is not finite, not positive, or so small or large that its weight is
    /// infinite or zero.
    Sigma,
    /// All `N` rows are taken.
    Full,
}

impl fmt::Display for RowError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Residual => "residual must be finite",
            Self::LineOfSight => "line of sight must be a unit vector within 1e-3",
            Self::Sigma => "sigma must be finite and positive",
            Self::Full => "all rows are in use",
        })
    }
}

impl core::error::Error for RowError {}

/// Offset that is subtracted from the residuals of each constellation: its first residual, rounded,
/// or its clock at a nearby point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct References<T: Real>([Option<T::Absolute>; Constellation::COUNT]);

impl<T: Real> References<T> {
    /// Returns references without rows.
    pub(crate) const fn none() -> Self {
        Self([None; Constellation::COUNT])
    }

    /// Returns a constellation's reference, or `None` if it has no row.
    pub(crate) fn of(&self, constellation: Constellation) -> Option<T::Absolute> {
        self.0.get(constellation as usize).copied().flatten()
    }

    fn satellite(
        &mut self,
        constellation: Constellation,
        line_of_sight: Vector3<f64>,
        residual_m: f64,
        sigma_m: f64,
    ) -> Result<Row<T>, RowError> {
        if !UNIT_SQUARED.contains(&dot(&line_of_sight, &line_of_sight)) {
            return Err(RowError::LineOfSight);
        }
        let away = scaled(-1.0, &line_of_sight);
        let design = Vector3::new(T::narrow(away.x), T::narrow(away.y), T::narrow(away.z));
        self.relative(constellation, design, residual_m, sigma_m)
    }

    /// Returns the row of a satellite on a line of sight, with its range.
    pub(crate) fn sighted(
        &mut self,
        constellation: Constellation,
        sight: &LineOfSight<T>,
        range_m: f64,
        sigma_m: f64,
    ) -> Result<Row<T>, RowError> {
        let longer = T::Absolute::of_admitted(range_m).less(sight.distance.whole);
        let reference = self.of(constellation).unwrap_or(longer);
        // Small terms are subtracted last, when the scalar's digits suffice.
        let residual = longer.less(reference).narrow() - (sight.distance.rest + sight.rotation);
        let row = Row::new(Some(constellation), sight.design, residual, T::narrow(sigma_m))?;
        self.keep(constellation, reference);
        Ok(row)
    }

    /// Returns the row of a predicted clock. `residual_m` has the same zero as the constellation's
    /// residuals before their reference is subtracted.
    pub(crate) fn clock(
        &mut self,
        constellation: Constellation,
        residual_m: f64,
        sigma_m: f64,
    ) -> Result<Row<T>, RowError> {
        self.relative(constellation, zero(), residual_m, sigma_m)
    }

    fn relative(
        &mut self,
        constellation: Constellation,
        design: Vector3<T>,
        residual_m: f64,
        sigma_m: f64,
    ) -> Result<Row<T>, RowError> {
        let reference = self.of(constellation).unwrap_or_else(|| T::Absolute::of(residual_m));
        let residual = T::narrow(residual_m - reference.widen());
        let row = Row::new(Some(constellation), design, residual, T::narrow(sigma_m))?;
        self.keep(constellation, reference);
        Ok(row)
    }

    /// Returns the row of a range rate: `residual` and `sigma` in m/s, all of type `T`.
    fn rate(
        &mut self,
        constellation: Constellation,
        line_of_sight: &Vector3<T>,
        residual: T,
        sigma: T,
    ) -> Result<Row<T>, RowError> {
        let (shortest, longest) = (T::narrow(*UNIT_SQUARED.start()), T::narrow(*UNIT_SQUARED.end()));
        let squared = dot(line_of_sight, line_of_sight);
        // NaN is not within the bounds.
        if !(squared >= shortest && squared <= longest) {
            return Err(RowError::LineOfSight);
        }
        let reference = self.of(constellation).unwrap_or_else(|| T::Absolute::of(residual.widen()));
        let design = scaled(-T::one(), line_of_sight);
        let row = Row::new(Some(constellation), design, residual - reference.narrow(), sigma)?;
        self.keep(constellation, reference);
        Ok(row)
    }

    /// Sets a constellation's reference.
    pub(crate) fn keep(&mut self, constellation: Constellation, reference: T::Absolute) {
        if let Some(slot) = self.0.get_mut(constellation as usize) {
            *slot = Some(reference);
        }
    }
}

/// The equations of one epoch, satellites first, then aiding rows; at most `N`.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearEpoch<T: Real, const N: usize> {
    rows: Vec<Row<T>, N>,
    references: References<T>,
}

impl<T: Real, const N: usize> Default for LinearEpoch<T, N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Real, const N: usize> LinearEpoch<T, N> {
    /// Returns an epoch without equations.
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub fn new() -> Self {
        const { assert_capacity(N) };
        Self { rows: Vec::new(), references: References::none() }
    }

    /// Adds a satellite: its direction (east, north, up), its residual and its standard deviation
    /// in metres.
    ///
    /// # Errors
    /// [`RowError`] names the invalid value; nothing is added then.
    // Not inlined, so that its many callers share one copy.
    #[inline(never)]
    pub fn satellite(
        &mut self,
        constellation: Constellation,
        line_of_sight: Vector3<f64>,
        residual_m: f64,
        sigma_m: f64,
    ) -> Result<(), RowError> {
        self.add(|references| references.satellite(constellation, line_of_sight, residual_m, sigma_m))
    }

    /// Adds a range rate; arguments as for [`Self::satellite`], of type `T`, in m/s.
    ///
    /// # Errors
    /// As [`Self::satellite`].
    pub(crate) fn rate(
        &mut self,
        constellation: Constellation,
        line_of_sight: &Vector3<T>,
        residual_m_s: T,
        sigma_m_s: T,
    ) -> Result<(), RowError> {
        self.add(|references| references.rate(constellation, line_of_sight, residual_m_s, sigma_m_s))
    }

    /// Adds a predicted clock of a constellation. `residual_m` has the same zero as the
    /// constellation's residuals before their reference is subtracted.
    ///
    /// # Errors
    /// As [`Self::satellite`].
    pub fn clock(
        &mut self,
        constellation: Constellation,
        residual_m: f64,
        sigma_m: f64,
    ) -> Result<(), RowError> {
        self.add(|references| references.clock(constellation, residual_m, sigma_m))
    }

    /// Adds a known height, as its difference to the linearisation point.
    ///
    /// # Errors
    /// As [`Self::satellite`].
    pub fn height(&mut self, residual_m: f64, sigma_m: f64) -> Result<(), RowError> {
        self.add(|_| Row::height(residual_m, sigma_m))
    }

    /// Replaces all equations by those that `write` forms relative to the references.
    ///
    /// Returns `None` if `write` stops early or forms more than `N`.
    pub(crate) fn refill(
        &mut self,
        write: impl FnOnce(&mut References<T>, &mut dyn FnMut(Row<T>) -> Option<()>) -> Option<()>,
    ) -> Option<()> {
        self.clear();
        let Self { rows, references } = self;
        write(references, &mut |row| rows.push(row).ok())
    }

    /// Adds a row that `make` forms relative to the references.
    fn add(
        &mut self,
        make: impl FnOnce(&mut References<T>) -> Result<Row<T>, RowError>,
    ) -> Result<(), RowError> {
        if self.rows.is_full() {
            return Err(RowError::Full);
        }
        let row = make(&mut self.references)?;
        self.rows.push(row).map_err(|_| RowError::Full)
    }

    /// Returns the equations, in the order they were added.
    pub fn rows(&self) -> &[Row<T>] {
        &self.rows
    }

    /// Returns the reference of a constellation's residuals, m, or `None` if it has no row.
    pub fn reference_m(&self, constellation: Constellation) -> Option<f64> {
        self.references.of(constellation).map(Absolute::widen)
    }

    /// Replaces all equations. Returns `None` if they are more than `N`.
    pub(crate) fn copy_from(&mut self, rows: &[Row<T>], references: &References<T>) -> Option<()> {
        self.rows.clear();
        self.references = *references;
        self.rows.extend_from_slice(rows).ok()
    }

    /// Returns the equations and their references, for solving in place.
    pub(crate) fn parts_mut(&mut self) -> (&mut [Row<T>], &mut References<T>) {
        (&mut self.rows, &mut self.references)
    }

    /// Removes all equations.
    pub fn clear(&mut self) {
        self.rows.clear();
        self.references = References::none();
    }

    /// Leaves a row out of all further computations; its index stays in use.
    pub fn leave_out(&mut self, index: usize) {
        if let Some(row) = self.rows.get_mut(index) {
            row.leave_out();
        }
    }

    /// Takes a left-out row back.
    pub fn take_back(&mut self, index: usize) {
        if let Some(row) = self.rows.get_mut(index) {
            row.take_back();
        }
    }
}
