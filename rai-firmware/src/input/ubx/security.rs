//! SEC-SIG and NAV-STATUS: jamming and spoofing that the receiver reports.
//!
//! | message | offset | field |
//! |---|---|---|
//! | SEC-SIG 1 | 4 | bit 0: jamming is watched for; bits 1, 2: 1 none, 2 warning (mitigated), 3 critical |
//! | | 8 | bit 0: spoofing is watched for; bits 1 to 3: 1 none, 2 indicated, 3 affirmed |
//! | SEC-SIG 2 | 1 | the same bits of jamming, then bits 3, and 4 to 6 of spoofing |
//! | NAV-STATUS | 7 | bits 3, 4: spoofing 1 none, 2 indicated, 3 indicated by several means |
//!
//! References: [UBX-F9] SEC-SIG, NAV-STATUS.
//!
//! [UBX-F9]: crate#references

use crate::input::{Jamming, Suspicion, Unread};

/// Reads SEC-SIG, version 1 or 2.
pub(super) fn sec_sig(payload: &[u8]) -> Result<Jamming, Unread> {
    // A state counts only if its detection is on.
    let state = |flags: u8, states: u8| if flags & 1 == 1 { states } else { 0 };
    match *payload {
        [1, _, _, _, jamming, _, _, _, spoofing, ..] => Ok(Jamming {
            jamming: Some(Suspicion::from_number(state(jamming, jamming >> 1 & 3))),
            spoofing: Some(Suspicion::from_number(state(spoofing, spoofing >> 1 & 7))),
        }),
        [2, flags, ..] => Ok(Jamming {
            jamming: Some(Suspicion::from_number(state(flags, flags >> 1 & 3))),
            spoofing: Some(Suspicion::from_number(state(flags >> 3, flags >> 4 & 7))),
        }),
        _ => Err(Unread::Malformed),
    }
}

/// Reads NAV-STATUS, which covers only spoofing; its highest state is an indication by several
/// means.
pub(super) fn nav_status(payload: &[u8]) -> Result<Jamming, Unread> {
    match *payload {
        [_, _, _, _, _, _, _, flags, _, _, _, _, _, _, _, _] => {
            Ok(Jamming { jamming: None, spoofing: Some(Suspicion::from_number(flags >> 3 & 3)) })
        }
        _ => Err(Unread::Malformed),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_versions_of_sec_sig_say_the_same() {
        // Jamming watched for and critical; spoofing watched for and indicated.
        let first = [1, 0, 0, 0, 0b111, 0, 0, 0, 0b0101, 0, 0, 0];
        let second = [2, 0b0010_1111, 0, 0];
        let want = Jamming { jamming: Some(Suspicion::Sure), spoofing: Some(Suspicion::Suspected) };
        assert_eq!((sec_sig(&first), sec_sig(&second)), (Ok(want), Ok(want)));
    }

    #[test]
    fn what_is_not_watched_for_is_unknown() {
        let unknown = Some(Suspicion::Unknown);
        assert_eq!(sec_sig(&[2, 0b0110_0110, 0, 0]), Ok(Jamming { jamming: unknown, spoofing: unknown }));
        assert_eq!(sec_sig(&[3, 0, 0, 0]), Err(Unread::Malformed));
        assert_eq!(nav_status(&[0; 15]), Err(Unread::Malformed));
    }
}
