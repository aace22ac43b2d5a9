//! Interface to a navigation message.
//!
//! A navigation message is one type that implements [`NavigationMessage`], in its own file, and one
//! row of the table in `navigation/mod.rs`. From that table `messages!` generates everything that
//! has a case for each message:
//!
//! | generated | use |
//! |---|---|
//! | `Kind` | names the message of a transmission; its `read` calls that of the implementation |
//! | `Kind::WORDS`, `Kind::PAGES`, `Kind::SET_BYTES` | the largest sizes of all messages, which determine the memory |
//!
//! No item of [`NavigationMessage`] has a default, so that an incomplete message does not compile.
//! Calls are resolved at compile time. They cost no more than a `match`, and the proof of no panic
//! covers them.

use raim_core::satellite::SatelliteId;

use super::leap::Announcement;
use super::pages::{Page, Pages, Set};
use super::sizes::Sizes;
use super::{Refusal, Transmission};
use crate::ephemeris::Broadcast;
use crate::input::bits::Bits;
use crate::input::calendar::Calendar;
use crate::input::{Message, Unread};

/// Navigation message.
pub(super) trait NavigationMessage {
    /// Number of words of one transmission in normal order.
    const WORDS: usize;

    /// Number of bytes of a page that are stored.
    const PAGE_BYTES: usize;

    /// Number of pages of a complete set, at most 16.
    const PAGES: usize;

    /// Reads one transmission. The result is `None` if it is one part of a set whose other parts
    /// have not all come.
    ///
    /// # Errors
    /// [`Unread`] states why the transmission leads to no message.
    fn read<'a>(reader: &mut Reader<'_>) -> Result<Option<Message<'a>>, Unread>;
}

/// Transmission that is read, and the state for it.
pub(super) struct Reader<'r> {
    pub(super) transmission: &'r Transmission<'r>,
    pub(super) pages: &'r mut Pages,
    #[cfg(feature = "osnma")]
    pub(super) authentication: &'r mut crate::osnma::Authentication,
    pub(super) calendar: &'r Calendar,
    pub(super) now_ms: u64,
}

impl Reader<'_> {
    /// Returns the first `N` words.
    pub(super) fn words<const N: usize>(&self) -> Result<&[u32; N], Refusal> {
        self.transmission.words.first_chunk().ok_or(Refusal::Malformed)
    }

    /// Adds a page with this index, from 0, to its set.
    pub(super) fn add(&mut self, index: u32, bytes: &[u8]) -> Result<Set<'_>, Unread> {
        let &Transmission { satellite, kind, .. } = self.transmission;
        let page = Page { satellite, kind, index: index as usize, bytes };
        self.pages.add(&page, self.now_ms).ok_or(Unread::BitsSurplus)
    }

    /// Adds a page, and reads the set if it is complete. After that the pages of the mask `kept`
    /// stay, and belong to the next set until others come.
    #[inline(never)]
    pub(super) fn complete<'a>(
        &mut self,
        index: u32,
        bytes: &[u8],
        kept: u16,
        read: fn(SatelliteId, &[Bits<'_>], &Calendar) -> Result<Broadcast, Refusal>,
    ) -> Result<Option<Message<'a>>, Unread> {
        let (satellite, calendar) = (self.transmission.satellite, self.calendar);
        let set = self.add(index, bytes)?;
        let Some(pages) = set.all() else {
            return Ok(None);
        };
        let ephemeris = read(satellite, &pages, calendar)?;
        drop(pages);
        set.keep(kept);
        Ok(Some(Message::Broadcast(ephemeris)))
    }

    /// Returns GPS time minus UTC according to an announcement, s; `None` until the present is
    /// known.
    pub(super) fn leap_s(&self, announcement: &Announcement) -> Option<u8> {
        announcement.at(self.calendar.present()?)
    }
}

/// Returns the sizes that an implementation states.
pub(super) const fn sizes_of<M: NavigationMessage>() -> Sizes {
    assert!(M::PAGE_BYTES > 0 && M::PAGES > 0 && M::PAGES <= 16);
    Sizes { words: M::WORDS, page_bytes: M::PAGE_BYTES, pages: M::PAGES }
}

/// Makes everything that has a case for each navigation message from rows `module::Implementation`.
macro_rules! messages {
    ($($(#[$condition:meta])* $module:ident::$Name:ident,)+) => {
        /// Navigation message of a transmission.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(super) enum Kind {
            $($(#[$condition])* $Name,)+
        }

        impl Kind {
            const LARGEST: (usize, usize, usize) =
                Sizes::largest(&[$($(#[$condition])* sizes_of::<$module::$Name>(),)+]);

            /// Largest number of words of a transmission.
            pub(super) const WORDS: usize = Self::LARGEST.0;

            /// Largest number of pages of a set.
            const PAGES: usize = Self::LARGEST.1;

            /// Bytes of the largest set.
            const SET_BYTES: usize = Self::LARGEST.2;

            /// Returns the sizes of the message.
            const fn sizes(self) -> Sizes {
                match self {
                    $($(#[$condition])* Self::$Name => const { sizes_of::<$module::$Name>() },)+
                }
            }

            /// Reads one transmission.
            fn read<'a>(self, reader: &mut Reader<'_>) -> Result<Option<Message<'a>>, Unread> {
                match self {
                    $($(#[$condition])*
                    Self::$Name => <$module::$Name as NavigationMessage>::read(reader),)+
                }
            }
        }
    };
}

pub(super) use messages;

#[cfg(test)]
mod tests {
    /// A message that lacks an item does not compile, because none has a default.
    #[test]
    fn no_item_of_a_navigation_message_has_a_default() {
        let text = include_str!("message.rs");
        let (_, behind) = text.split_once("pub(super) trait NavigationMessage").expect("the trait");
        let (body, _) = behind.split_once("\n}\n").expect("its end");
        let items = body.lines().skip(1).filter(|line| !line.trim_start().starts_with("///"));
        let defaults: std::vec::Vec<_> =
            items.filter(|line| line.contains('{') || line.contains("= ")).collect();
        assert!(defaults.is_empty(), "{defaults:?}");
    }
}
