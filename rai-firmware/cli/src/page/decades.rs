//! Logarithmic axis of a picture, whose logarithm is that of libm.
//!
//! The standard library takes the logarithm of the system, whose last bit differs between systems. A
//! whole power of ten may then fall on another pixel, and the same report would differ.

use std::ops::Range;

use plotters::coord::combinators::{IntoLogRange as _, LogCoord};
use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged};
use plotters::coord::types::RangedCoordf64;

/// Logarithmic axis over positive values.
pub(super) struct Decades {
    logarithms: RangedCoordf64,
    labels: LogCoord<f64>,
}

impl From<Range<f64>> for Decades {
    fn from(range: Range<f64>) -> Self {
        let logarithms = libm::log10(range.start)..libm::log10(range.end);
        Self { logarithms: logarithms.into(), labels: range.log_scale().into() }
    }
}

impl Ranged for Decades {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        self.logarithms.map(&libm::log10(*value), limit)
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        self.labels.key_points(hint)
    }

    fn range(&self) -> Range<f64> {
        self.labels.range()
    }
}
