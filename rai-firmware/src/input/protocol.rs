//! Interface between the stream of bytes and a wire format.
//!
//! A wire format is one type that implements [`Protocol`], in its own folder, and one row of the
//! table of formats in `input/mod.rs`. From that table `formats!` generates everything that has a
//! case for each format, so that no other module names a format:
//!
//! | generated | use |
//! |---|---|
//! | `Format` | names the format of a frame; its functions call those of the implementation |
//! | `Memory` | holds the state of each format between frames, and what they share |
//! | `Measured` | holds the ranges of a message, still encoded |
//!
//! No function of [`Protocol`] has a default, so that an incomplete format does not compile. Calls
//! are resolved at compile time. They cost no more than a `match`, and the proof of no panic covers
//! them.

use core::fmt::Debug;

use raim_core::satellite::SatelliteId;

use super::calendar::Calendar;
#[cfg(feature = "ubx")]
use super::navigation::Navigation;
use super::{Counters, Message, Unread};
use crate::raw::RawSignal;

/// Wire format.
pub(super) trait Protocol {
    /// First bytes of every frame, at least one.
    const SYNC: &'static [u8];

    /// Length of the longest frame that is read, bytes.
    const LONGEST: usize;

    /// State of the format between frames.
    type Memory: Debug;

    /// Returns the state before the first frame. It is a function and no constant, because a
    /// constant would be copied from flash over the stack.
    fn at_start() -> Self::Memory;

    /// Ranges of one message, still encoded.
    type Ranges<'a>: Measurements;

    /// Returns the length of the frame that begins with these bytes. They begin with [`Self::SYNC`]
    /// and may end before the frame does. A length beyond [`Self::LONGEST`] is refused here.
    fn length(bytes: &[u8]) -> Extent;

    /// Returns true if a complete frame passes its check.
    fn check(frame: &[u8]) -> bool;

    /// Reads a frame that passed its check. The result is `None` if the frame is one part of a
    /// message whose other parts have not all come.
    ///
    /// # Errors
    /// [`Unread`] states why the frame leads to no message.
    fn read<'a>(
        frame: &Frame<'a>,
        memory: &mut Self::Memory,
        shared: &mut Shared,
        calendar: &Calendar,
        counters: &mut Counters,
    ) -> Result<Option<Message<'a>>, Unread>;
}

/// State that formats share: the satellites send the same bits to every receiver, so that their
/// pages need room only once.
#[derive(Debug)]
pub(super) struct Shared {
    /// Incomplete navigation messages.
    #[cfg(feature = "ubx")]
    pub(super) navigation: Navigation,
}

impl Shared {
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self {
            #[cfg(feature = "ubx")]
            navigation: Navigation::new(),
        }
    }
}

/// Ranges of one message, still encoded.
pub(super) trait Measurements: Debug {
    /// Returns true if the message has no satellite.
    fn is_empty(&self) -> bool;

    /// Passes each range to `add`. The flag is true if the broadcast clock refers to the code
    /// that measured the range.
    fn each(
        &self,
        counters: &mut Counters,
        add: &mut impl FnMut(SatelliteId, RawSignal, bool, &mut Counters),
    );
}

/// Length of a frame, from its first bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Extent {
    /// More bytes are needed.
    Unknown,
    /// Length of the whole frame, bytes.
    Bytes(usize),
    /// These bytes begin no frame.
    NoFrame,
}

/// Frame that passed its check.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame<'a> {
    /// The whole frame.
    pub(super) bytes: &'a [u8],
    /// Time no later than the arrival of its first byte, ms. The byte may have come later, but not
    /// earlier.
    pub(super) came_ms: u64,
}

impl<'a> Frame<'a> {
    /// Returns the bytes between a header and a check of these lengths.
    pub(super) fn between(&self, header: usize, check: usize) -> &'a [u8] {
        let end = self.bytes.len().saturating_sub(check);
        self.bytes.get(header..end).unwrap_or_default()
    }
}

/// Returns the frame if the bytes are exactly one frame of this format that passes its check.
pub(super) fn whole<P: Protocol>(bytes: &[u8]) -> Option<Frame<'_>> {
    let is_one = bytes.starts_with(P::SYNC) && P::length(bytes) == Extent::Bytes(bytes.len());
    (is_one && P::check(bytes)).then_some(Frame { bytes, came_ms: 0 })
}

/// Returns the extent of the frame of a format that begins with these bytes, however few they are.
pub(super) fn extent<P: Protocol>(bytes: &[u8]) -> Extent {
    if bytes.starts_with(P::SYNC) {
        P::length(bytes)
    } else if P::SYNC.starts_with(bytes) {
        Extent::Unknown
    } else {
        Extent::NoFrame
    }
}

/// Makes everything that has a case for each wire format from rows `module::Implementation`.
macro_rules! formats {
    ($($(#[$condition:meta])* $module:ident::$Name:ident,)+) => {
        /// Wire format of a frame.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        enum Format {
            $($(#[$condition])* $Name,)+
        }

        impl Format {
            /// Length of the longest frame of any format, bytes.
            const LONGEST: usize = {
                let mut longest = 0;
                $($(#[$condition])*
                {
                    let length = <$module::$Name as Protocol>::LONGEST;
                    longest = if length > longest { length } else { longest };
                })+
                longest
            };

            /// Returns true if a frame of some format begins with this byte.
            fn may_begin_with(byte: u8) -> bool {
                $($(#[$condition])*
                if byte == const { <$module::$Name as Protocol>::SYNC[0] } {
                    return true;
                })+
                false
            }

            /// Returns true if a frame of some format may begin with one of the four bytes of a
            /// word: Each byte of the word minus the sync byte is tested for zero: `(x − 0x01…) &
            /// !x & 0x80…` is nonzero exactly if `x` has a zero byte.
            fn may_begin_within(word: u32) -> bool {
                const ONES: u32 = 0x0101_0101;
                // One test for all formats, because most words have no sync byte.
                let mut zeros = 0;
                $($(#[$condition])*
                {
                    let rest = word ^ ONES * u32::from(const { <$module::$Name as Protocol>::SYNC[0] });
                    zeros |= rest.wrapping_sub(ONES) & !rest;
                })+
                zeros & ONES << 7 != 0
            }

            /// Returns the format and the extent of the frame that begins with these bytes.
            fn at(bytes: &[u8]) -> Option<(Self, Extent)> {
                $($(#[$condition])*
                match protocol::extent::<$module::$Name>(bytes) {
                    Extent::NoFrame => {}
                    extent => return Some((Self::$Name, extent)),
                })+
                None
            }

            /// Returns true if a complete frame passes its check.
            fn check(self, frame: &[u8]) -> bool {
                match self {
                    $($(#[$condition])* Self::$Name => <$module::$Name as Protocol>::check(frame),)+
                }
            }

            /// Reads a frame that passed its check.
            fn read<'a>(
                self,
                frame: &Frame<'a>,
                memory: &mut Memory,
                calendar: &Calendar,
                counters: &mut Counters,
            ) -> Result<Option<Message<'a>>, Unread> {
                match self {
                    $($(#[$condition])*
                    Self::$Name => {
                        <$module::$Name as Protocol>::read(
                            frame,
                            &mut memory.$module,
                            &mut memory.shared,
                            calendar,
                            counters,
                        )
                    })+
                }
            }
        }

        /// State that the formats keep between frames.
        #[derive(Debug)]
        struct Memory {
            $($(#[$condition])* $module: <$module::$Name as Protocol>::Memory,)+
            shared: protocol::Shared,
        }

        impl Memory {
            /// Returns the state before the first frame.
            #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
            #[inline(always)]
            fn new() -> Self {
                Self {
                    $($(#[$condition])* $module: <$module::$Name as Protocol>::at_start(),)+
                    shared: protocol::Shared::new(),
                }
            }
        }

        /// Ranges of one message, still encoded in its format.
        #[derive(Debug)]
        enum Measured<'a> {
            /// No range that is used.
            Nothing,
            $($(#[$condition])* $Name(<$module::$Name as Protocol>::Ranges<'a>),)+
        }

        impl Measured<'_> {
            /// Returns true if the message has no satellite.
            fn is_empty(&self) -> bool {
                match self {
                    Self::Nothing => true,
                    $($(#[$condition])* Self::$Name(ranges) => ranges.is_empty(),)+
                }
            }

            /// Passes each range to `add`. The flag is true if the broadcast clock refers to the
            /// code that measured the range.
            fn each(
                &self,
                counters: &mut Counters,
                mut add: impl FnMut(SatelliteId, RawSignal, bool, &mut Counters),
            ) {
                match self {
                    Self::Nothing => {}
                    $($(#[$condition])* Self::$Name(ranges) => ranges.each(counters, &mut add),)+
                }
            }
        }
    };
}

pub(super) use formats;

#[cfg(test)]
mod tests {
    /// A format that lacks a function does not compile, because none has a default.
    #[test]
    fn no_function_of_a_format_has_a_default() {
        let text = include_str!("protocol.rs");
        for name in ["Protocol", "Measurements"] {
            let begin = std::format!("pub(super) trait {name}");
            let (_, behind) = text.split_once(&begin).expect("the trait");
            let (body, _) = behind.split_once("\n}\n").expect("its end");
            let defaults = body.lines().skip(1).filter(|line| !line.trim_start().starts_with("///"));
            let defaults: std::vec::Vec<_> =
                defaults.filter(|line| line.contains('{') || line.contains("= ")).collect();
            assert!(defaults.is_empty(), "{name}: {defaults:?}");
        }
    }
}
