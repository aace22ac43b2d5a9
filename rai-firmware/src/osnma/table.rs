//! What each tag of a MACK message is about: the look-up table of MAC sequences.
//!
//! A sequence has one slot for each tag. The first is always the satellite's own orbit and clock, and
//! is not in the table. A sequence has one form for the first half of a minute and one for the second.
//!
//! | letter | slot | ADKD | about |
//! |---|---|---|---|
//! | `S` | `00S` | 0 | orbit and clock of the satellite itself |
//! | `E` | `00E` | 0 | orbit and clock of any satellite |
//! | `T` | `04S` | 4 | time parameters |
//! | `s` | `12S` | 12 | orbit and clock of the satellite itself, with a later key |
//! | `e` | `12E` | 12 | orbit and clock of any satellite, with a later key |
//! | `x` | `FLX` | any | what the tag states, which `MACSEQ` protects |
//!
//! Reference: [OSNMA-ICD] annex C.
//!
//! [OSNMA-ICD]: crate#references

/// Each sequence with its number.
const SEQUENCES: [(u8, [&[u8]; 2]); 12] = [
    (27, [b"EEEsE", b"EETsE"]),
    (28, [b"EEESEEsEE", b"EESEETsEE"]),
    (31, [b"EEsE", b"EEsT"]),
    (33, [b"ETEsE", b"EEsEe"]),
    (34, [b"xTxsE", b"xEsEe"]),
    (35, [b"xTxsx", b"xxsxx"]),
    (36, [b"xTxs", b"xEse"]),
    (37, [b"ETEs", b"EEse"]),
    (38, [b"xTxs", b"xxsx"]),
    (39, [b"xTx", b"xEs"]),
    (40, [b"ETs", b"EEe"]),
    (41, [b"xTx", b"xxs"]),
];

/// Slot of a tag.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Slot {
    /// The tag has this ADKD. The flag is true if it is about the satellite that sends it.
    Fixed(u8, bool),
    /// The tag states what it is about.
    Flexible,
}

/// Returns the slots behind the first tag; `None` if no sequence has this number.
pub(super) fn sequence(number: u8, is_odd: bool) -> Option<&'static [u8]> {
    let (_, both) = SEQUENCES.iter().find(|(known, _)| *known == number)?;
    let [even, odd] = both;
    Some(if is_odd { odd } else { even })
}

/// Returns the slot of a letter.
pub(super) const fn slot(letter: u8) -> Slot {
    match letter {
        b'S' => Slot::Fixed(0, true),
        b'E' => Slot::Fixed(0, false),
        b'T' => Slot::Fixed(4, true),
        b's' => Slot::Fixed(12, true),
        b'e' => Slot::Fixed(12, false),
        _ => Slot::Flexible,
    }
}
