//! A navigation message of the tests, which shows that a message is one file and one row of the
//! table.
//!
//! A transmission is two words: the page's number from 1 and its 24 bits, then their complement. A
//! set has three pages, each with a leading part of Klobuchar's coefficients.

use raim_core::satellite::{Constellation, SatelliteId};

use super::message::{NavigationMessage, Reader};
use super::{Kind, Navigation, Refusal, Transmission};
use crate::input::bits::{Bits, Packed};
use crate::input::calendar::Calendar;
use crate::input::{Message, Unread};

/// The message.
pub(super) struct Toy;

impl NavigationMessage for Toy {
    const WORDS: usize = 2;
    const PAGE_BYTES: usize = 3;
    const PAGES: usize = 3;

    fn read<'a>(reader: &mut Reader<'_>) -> Result<Option<Message<'a>>, Unread> {
        let &[word, complement] = reader.words::<{ Self::WORDS }>()?;
        if word != !complement {
            return Err(Refusal::Parity.into());
        }
        let [number, page @ ..] = word.to_be_bytes();
        let index = u32::from(number).checked_sub(1).filter(|&index| index < 3).ok_or(Refusal::Malformed)?;
        let set = reader.add(index, &page)?;
        let Some(pages) = set.all() else {
            return Ok(None);
        };
        let mut packed = Packed::<8>::new();
        pages.iter().for_each(|page| packed.push(page.unsigned(0, 24), 24));
        drop(pages);
        set.keep(0);
        let coefficients = Bits(&packed.bytes).klobuchar(0);
        Ok(Some(Message::Corrections(Some((Constellation::Galileo, coefficients)), None)))
    }
}

mod tests {
    use super::*;

    /// One unit of each coefficient is 2⁻³⁰ to 2¹⁶, and page 3 has the last two.
    const PAGES: [[u8; 3]; 3] = [[1, 0, 0], [0, 2, 0], [0, 3, 0]];
    const WANT: [f64; 8] = [1.0 / 1_073_741_824.0, 0.0, 0.0, 0.0, 4096.0, 0.0, 0.0, 3.0 * 65_536.0];

    struct Line {
        navigation: Navigation,
        now_ms: u64,
    }

    impl Line {
        fn takes(
            &mut self,
            satellite: u8,
            kind: Kind,
            words: &[u32],
        ) -> Result<Option<Message<'static>>, Unread> {
            let satellite = SatelliteId::new(Constellation::Galileo, satellite).expect("a satellite");
            self.navigation.read(
                &Transmission {
                    satellite,
                    kind,
                    words,
                    #[cfg(feature = "osnma")]
                    is_e1: false,
                },
                self.now_ms,
                &Calendar::new(),
            )
        }

        fn page(&mut self, satellite: u8, number: u8) -> Result<Option<Message<'static>>, Unread> {
            let [a, b, c] = PAGES[usize::from(number) - 1];
            let word = u32::from_be_bytes([number, a, b, c]);
            self.takes(satellite, Kind::Toy, &[word, !word])
        }
    }

    fn line() -> Line {
        Line { navigation: Navigation::new(), now_ms: 0 }
    }

    fn is_set(read: Result<Option<Message<'_>>, Unread>) -> bool {
        match read {
            Ok(Some(Message::Corrections(Some((Constellation::Galileo, coefficients)), None))) => {
                assert_eq!(coefficients.map(f64::to_bits), WANT.map(f64::to_bits));
                true
            }
            Ok(None) => false,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_message_of_one_file_and_one_row_is_read_beside_the_others() {
        let mut line = line();
        // Two satellites in turn, in different orders, with words of other messages between them.
        assert!(!is_set(line.page(1, 3)));
        assert!(!is_set(line.page(2, 1)));
        assert_eq!(line.takes(1, Kind::Lnav, &[u32::MAX; 10]).unwrap_err(), Unread::BitsParity);
        assert_eq!(line.takes(1, Kind::D1, &[0; 10]).unwrap_err(), Unread::BitsMalformed);
        assert!(!is_set(line.page(1, 1)));
        assert!(!is_set(line.page(2, 2)));
        assert!(is_set(line.page(1, 2)));
        assert!(is_set(line.page(2, 3)));
        assert!(!is_set(line.page(2, 3)), "a new set begins");
    }

    #[test]
    fn a_refusal_has_its_name_and_an_old_set_is_abandoned() {
        let mut line = line();
        assert_eq!(line.takes(1, Kind::Toy, &[1]).unwrap_err(), Unread::BitsMalformed);
        assert_eq!(line.takes(1, Kind::Toy, &[0x0100_0000, 0]).unwrap_err(), Unread::BitsParity);
        assert_eq!(line.takes(1, Kind::Toy, &[0, !0]).unwrap_err(), Unread::BitsMalformed);
        assert!(!is_set(line.page(1, 1)));
        line.now_ms = 130_000;
        assert!(!is_set(line.page(1, 2)));
        assert!(!is_set(line.page(1, 3)));
        assert_eq!(line.navigation.abandoned(), 1);
        assert!(is_set(line.page(1, 1)));
    }
}
