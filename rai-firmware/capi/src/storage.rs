//! Memory of the objects, as constants for memory that is laid out at compile time.
//!
//! | a library with the feature | a program defines | satellites |
//! |---|---|---|
//! | `satellites-48` | nothing | 48 |
//! | `satellites-32` | `RAI_SATELLITES_32` | 32 |
//! | neither | `RAI_SATELLITES_16` | 16 |
//!
//! If a program defines less than its library was built for, its memory is too short and is refused
//! with `RAI_STATUS_SHORT`. The constants are a little larger than the objects are today, on the
//! widest processor, so that an object may grow from version to version.

/// Most satellites in one epoch.
#[cfg(not(any(feature = "satellites-32", feature = "satellites-48")))]
pub const RAI_MAX_SATELLITES: usize = 16;
/// Most satellites in one epoch.
#[cfg(all(feature = "satellites-32", not(feature = "satellites-48")))]
pub const RAI_MAX_SATELLITES: usize = 32;
/// Most satellites in one epoch.
#[cfg(feature = "satellites-48")]
pub const RAI_MAX_SATELLITES: usize = 48;

/// Words of eight bytes of a monitor, enough on every processor.
#[cfg(not(any(feature = "satellites-32", feature = "satellites-48")))]
pub const RAI_MONITOR_WORDS: usize = 1408;
/// Words of eight bytes of a monitor, enough on every processor.
#[cfg(all(feature = "satellites-32", not(feature = "satellites-48")))]
pub const RAI_MONITOR_WORDS: usize = 1792;
/// Words of eight bytes of a monitor, enough on every processor.
#[cfg(feature = "satellites-48")]
pub const RAI_MONITOR_WORDS: usize = 2176;

/// Bytes of a monitor.
pub const RAI_MONITOR_SIZE: usize = RAI_MONITOR_WORDS * 8;

/// Words of eight bytes of a receiver, enough on every processor.
#[cfg(not(any(feature = "satellites-32", feature = "satellites-48")))]
pub const RAI_RECEIVER_WORDS: usize = 5376;
/// Words of eight bytes of a receiver, enough on every processor.
#[cfg(all(feature = "satellites-32", not(feature = "satellites-48")))]
pub const RAI_RECEIVER_WORDS: usize = 6016;
/// Words of eight bytes of a receiver, enough on every processor.
#[cfg(feature = "satellites-48")]
pub const RAI_RECEIVER_WORDS: usize = 8896;

/// Bytes of a receiver.
pub const RAI_RECEIVER_SIZE: usize = RAI_RECEIVER_WORDS * 8;
