//! The core against least squares with all columns, in which leaving out is solving again.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing)]

mod consensus;
mod edges;
mod geometry;
mod parity;
mod removal;
mod snapshot;
mod worst;

/// The same second opinion that recordings are held against.
#[path = "../../../../tests-host/src/oracle.rs"]
#[allow(unreachable_pub, reason = "public where it is at home")]
mod oracle;
