//! Target: the GNSS port of a u-blox receiver. The bytes are read as those of [`super::stream`];
//! the seeds differ, and grow by other code.

pub use super::stream::run;
