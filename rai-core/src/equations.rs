//! The linearised epoch: one equation for each range, relative to a point.
//!
//! `y_i = h_i · x + b_c + ε_i`, `ε_i ~ N(0, σ_i²)`, with `h_i = −LOS_i`
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `LOS_i` | unit vector receiver → satellite, east, north, up | – |
//! | `h_i` | `design` | – |
//! | `y_i` | `residual`, measured minus predicted range, less the constellation's reference | m |
//! | `w_i = 1/σ_i²` | `weight`; 0 leaves the row out | 1/m² |
//! | `x` | correction of the position, east, north, up | m |
//! | `b_c` | receiver clock of constellation `c` times the speed of light | m |
//!
//! A receiver clock can be 3e8 m while the residuals are metres. Each constellation's first residual is therefore
//! kept aside in `f64`, and the rows hold the differences to it, which are small enough for `f32`.
//!
//! An aiding row is a row like any other: a predicted clock has `h = 0`, a known height `h = (0, 0, 1)` and no clock.

use core::fmt;

use heapless::Vec;
use nalgebra::Vector3;

use crate::frame::Sight;
use crate::numeric::absolute::Absolute;
use crate::numeric::real::Real;
use crate::satellite::Constellation;

/// Squared length of what passes as a unit vector: the length may be off by 1e-3.
const UNIT_SQUARED: core::ops::RangeInclusive<f64> = 0.999 * 0.999..=1.001 * 1.001;

/// One equation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row<T> {
    /// Whose receiver clock the row touches; `None` for a height.
    pub clock: Option<Constellation>,
    /// Partial derivative of the range by the position, east, north, up.
    pub design: Vector3<T>,
    /// Measured minus predicted, less the reference of its clock, m.
    pub residual: T,
    /// Standard deviation, m.
    pub sigma: T,
    /// Inverse variance, 1/m²; 0 where the row is left out.
    pub weight: T,
}

impl<T: Real> Row<T> {
    /// `1/σ²`: the weight of a row that takes part.
    fn full_weight(&self) -> T {
        (self.sigma * self.sigma).recip()
    }
}

/// Why a row was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum RowError {
    /// The residual is not finite.
    Residual,
    /// The line of sight is not a unit vector.
    LineOfSight,
    /// The standard deviation is not finite or not positive.
    Sigma,
    /// All `N` rows are taken.
    Full,
}

impl fmt::Display for RowError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Residual => "residual not finite",
            Self::LineOfSight => "line of sight not a unit vector",
            Self::Sigma => "sigma not finite or not positive",
            Self::Full => "too many rows",
        })
    }
}

impl core::error::Error for RowError {}

/// The equations of one instant, satellites first, then aiding rows; at most `N`.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearEpoch<T: Real, const N: usize> {
    rows: Vec<Row<T>, N>,
    /// What the residuals of each constellation are relative to.
    references: [Option<T::Absolute>; Constellation::COUNT],
}

impl<T: Real, const N: usize> Default for LinearEpoch<T, N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Real, const N: usize> LinearEpoch<T, N> {
    /// No equations yet.
    pub fn new() -> Self {
        Self { rows: Vec::new(), references: [None; Constellation::COUNT] }
    }

    /// Adds a satellite: its direction (east, north, up), its residual and its standard deviation in metres.
    ///
    /// # Errors
    /// [`RowError`] names what is wrong; nothing is added then.
    pub fn satellite(
        &mut self,
        constellation: Constellation,
        line_of_sight: Vector3<f64>,
        residual_m: f64,
        sigma_m: f64,
    ) -> Result<(), RowError> {
        if !UNIT_SQUARED.contains(&line_of_sight.dot(&line_of_sight)) {
            return Err(RowError::LineOfSight);
        }
        let residual = self.relative(constellation, residual_m);
        self.push(Some(constellation), -line_of_sight.map(T::narrow), residual, sigma_m)
    }

    /// Adds a satellite as it is seen, with its range.
    ///
    /// # Errors
    /// As [`Self::satellite`].
    pub(crate) fn sighted(
        &mut self,
        constellation: Constellation,
        sight: &Sight<T>,
        range_m: f64,
        sigma_m: f64,
    ) -> Result<(), RowError> {
        let longer = T::Absolute::of(range_m).less(sight.distance.whole);
        let reference = self.reference(constellation).unwrap_or(longer);
        // What is small enough for the scalar is taken off where no more digits are needed.
        let residual = longer.less(reference).narrow() - (sight.distance.rest + sight.rotation);
        self.push(Some(constellation), -sight.direction, (residual, reference), sigma_m)
    }

    /// Adds a predicted clock of a constellation, on the same scale as its residuals.
    ///
    /// # Errors
    /// As [`Self::satellite`].
    pub fn clock(
        &mut self,
        constellation: Constellation,
        residual_m: f64,
        sigma_m: f64,
    ) -> Result<(), RowError> {
        let residual = self.relative(constellation, residual_m);
        self.push(Some(constellation), Vector3::zeros(), residual, sigma_m)
    }

    /// Adds a known height: how far it is above the linearisation point.
    ///
    /// # Errors
    /// As [`Self::satellite`].
    pub fn height(&mut self, residual_m: f64, sigma_m: f64) -> Result<(), RowError> {
        self.push(None, Vector3::z(), (T::narrow(residual_m), T::Absolute::of(0.0)), sigma_m)
    }

    /// A residual less the reference of its constellation, and that reference: nearly the first residual itself.
    fn relative(&self, constellation: Constellation, residual_m: f64) -> (T, T::Absolute) {
        let reference = self.reference(constellation).unwrap_or_else(|| T::Absolute::of(residual_m));
        (T::narrow(residual_m - reference.widen()), reference)
    }

    fn reference(&self, constellation: Constellation) -> Option<T::Absolute> {
        self.references.get(constellation as usize).copied().flatten()
    }

    fn push(
        &mut self,
        clock: Option<Constellation>,
        design: Vector3<T>,
        (residual, reference): (T, T::Absolute),
        sigma_m: f64,
    ) -> Result<(), RowError> {
        // Neither is a difference of two infinities.
        if !residual.is_finite() {
            return Err(RowError::Residual);
        }
        let sigma = T::narrow(sigma_m);
        let weight = (sigma * sigma).recip();
        // Beyond the scalar's range a row would silently weigh nothing, or everything.
        if !(sigma > T::zero() && weight > T::zero() && weight.is_finite()) {
            return Err(RowError::Sigma);
        }
        let row = Row { clock, design, residual, sigma, weight };
        self.rows.push(row).map_err(|_| RowError::Full)?;
        if let Some(slot) = clock.and_then(|clock| self.references.get_mut(clock as usize)) {
            *slot = Some(reference);
        }
        Ok(())
    }

    /// The equations, in the order they were added.
    pub fn rows(&self) -> &[Row<T>] {
        &self.rows
    }

    /// What a constellation's residuals are relative to, m; `None` where it has no row.
    pub fn reference_m(&self, constellation: Constellation) -> Option<f64> {
        self.reference(constellation).map(Absolute::widen)
    }

    /// Makes room for the equations of another instant.
    pub(crate) fn clear(&mut self) {
        self.rows.clear();
        self.references = [None; Constellation::COUNT];
    }

    /// Takes over the equations of another epoch, row by row: a clone is made elsewhere on the stack first, and then moved.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.rows.clear();
        for &row in &other.rows {
            // Both hold N: never full here.
            let _ = self.rows.push(row);
        }
        self.references = other.references;
    }

    /// Leaves a row out of everything computed from now on; its index stays taken.
    pub fn leave_out(&mut self, index: usize) {
        if let Some(row) = self.rows.get_mut(index) {
            row.weight = T::zero();
        }
    }

    /// Takes a left-out row back.
    pub fn take_back(&mut self, index: usize) {
        if let Some(row) = self.rows.get_mut(index) {
            row.weight = row.full_weight();
        }
    }

    /// Leaves several rows out.
    pub(crate) fn leave_all_out(&mut self, rows: &[usize]) {
        for &index in rows {
            self.leave_out(index);
        }
    }

    /// Takes several rows back.
    pub(crate) fn take_all_back(&mut self, rows: &[usize]) {
        for &index in rows {
            self.take_back(index);
        }
    }

    /// Leaves out all rows but those chosen, which take part.
    pub(crate) fn keep_only(&mut self, is_chosen: impl Fn(usize) -> bool) {
        for (index, row) in self.rows.iter_mut().enumerate() {
            row.weight = if is_chosen(index) { row.full_weight() } else { T::zero() };
        }
    }
}
