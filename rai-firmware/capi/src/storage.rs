//! How much memory an object takes: constants, for memory that is laid out when the program is compiled.
//!
//! | a library with the feature | a program defines | satellites |
//! |---|---|---|
//! | `satellites-16` | `RAI_SATELLITES_16` | 16 |
//! | `satellites-32` | `RAI_SATELLITES_32` | 32 |
//! | neither | neither | 48 |
//!
//! A program that defines less than its library was built for hands in memory that is too short, and is refused with
//! `RAI_STATUS_SHORT`. The constants are a little larger than what the objects take today, on the widest processor: within them
//! an object may grow from version to version.

/// Most satellites in one epoch.
#[cfg(feature = "satellites-16")]
pub const RAI_MAX_SATELLITES: usize = 16;
/// Most satellites in one epoch.
#[cfg(all(feature = "satellites-32", not(feature = "satellites-16")))]
pub const RAI_MAX_SATELLITES: usize = 32;
/// Most satellites in one epoch.
#[cfg(not(any(feature = "satellites-16", feature = "satellites-32")))]
pub const RAI_MAX_SATELLITES: usize = 48;

/// Words of eight bytes that a monitor takes, on every processor at most.
#[cfg(feature = "satellites-16")]
pub const RAI_MONITOR_WORDS: usize = 1408;
/// Words of eight bytes that a monitor takes, on every processor at most.
#[cfg(all(feature = "satellites-32", not(feature = "satellites-16")))]
pub const RAI_MONITOR_WORDS: usize = 1792;
/// Words of eight bytes that a monitor takes, on every processor at most.
#[cfg(not(any(feature = "satellites-16", feature = "satellites-32")))]
pub const RAI_MONITOR_WORDS: usize = 2176;

/// Bytes of a monitor.
pub const RAI_MONITOR_SIZE: usize = RAI_MONITOR_WORDS * 8;

/// Words of eight bytes that a receiver takes, on every processor at most.
#[cfg(feature = "satellites-16")]
pub const RAI_RECEIVER_WORDS: usize = 5376;
/// Words of eight bytes that a receiver takes, on every processor at most.
#[cfg(all(feature = "satellites-32", not(feature = "satellites-16")))]
pub const RAI_RECEIVER_WORDS: usize = 6016;
/// Words of eight bytes that a receiver takes, on every processor at most.
#[cfg(not(any(feature = "satellites-16", feature = "satellites-32")))]
pub const RAI_RECEIVER_WORDS: usize = 6656;

/// Bytes of a receiver.
pub const RAI_RECEIVER_SIZE: usize = RAI_RECEIVER_WORDS * 8;
