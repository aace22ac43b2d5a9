//! Numbers: scalars, probabilities and distributions, independent of satellites.

pub mod absolute;
pub mod angle;
pub mod bounds;
pub mod chi_square;
pub(crate) mod cholesky;
pub mod four;
pub mod normal;
pub mod precision;
pub mod probability;
pub mod real;
mod scalars;
pub(crate) mod space;

pub use raim_root::{sqrt, sqrt_f64};
