//! The core compared with least squares with all columns, where leaving out is solving again.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing)]

mod consensus;
mod edges;
mod geometry;
mod parity;
mod removal;
mod snapshot;
mod worst;

/// The second opinion that recordings are compared with.
#[path = "../../../../rai-firmware/cli/src/second_opinion/dense.rs"]
#[allow(unreachable_pub, reason = "public where it is at home")]
mod oracle;
