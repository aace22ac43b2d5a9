//! The receiver's reports of jamming, spoofing, authentication and its own protection levels:
//! SEC-SIG, SEC-SIGLOG, MON-RF, NAV-STATUS, NAV-SIG and NAV-PL.
//!
//! | message | offset | field |
//! |---|---|---|
//! | SEC-SIG 1 | 4 | bit 0: detection of jamming is on; bits 1, 2: 1 none, 2 warning (mitigated), 3 critical |
//! | | 8 | bit 0: detection of spoofing is on; bits 1 to 3: 1 none, 2 indicated, 3 affirmed |
//! | SEC-SIG 2 | 1 | the same bits of jamming, then bits 3, and 4 to 6 of spoofing |
//! | SEC-SIGLOG 1 | 1 | number of events, 8 bytes each from 8 on |
//! | | +0, +4, +5 | seconds since the event; 0 simulated, 1 abnormal signals, 2 contradiction to inertial sensors, 3 abrupt changes, 4 jamming; 0 started, 1 stopped, 2 triggered |
//! | MON-RF 0 | 1 | number of blocks, 24 bytes each from 4 on, or 20 as a ZED-F9R sends them; +1 bits 0, 1: jamming 1 none, 2 warning, 3 critical |
//! | NAV-STATUS | 7 | bits 3, 4: spoofing 1 none, 2 indicated, 3 indicated by several means |
//! | NAV-SIG 0 | 5 | number of signals, 16 bytes each from 8 on; +10 bit 9: authenticated |
//! | NAV-PL 1 | 1, 2 | coefficient and power of ten of the risk |
//! | | 3, 4 | 1 if valid; frame of the axes |
//! | | 16, 20, 24 | level along each axis, mm |
//!
//! References: [UBX-F9]; `pyubx2` 1.4.0 has the same layouts.
//!
//! [UBX-F9]: crate#references

use crate::input::{Jamming, LoggedEvents, ReceiverLevels, Reporter, SelfReport, Suspicion, Unread};

/// Kind of a logged event that means jamming; smaller kinds mean spoofing.
const EVENT_OF_JAMMING: u8 = 4;

/// Logged event that ends an interference.
const EVENT_STOPPED: u8 = 1;

/// Reads SEC-SIG, version 1 or 2.
pub(super) fn sec_sig(payload: &[u8]) -> Result<SelfReport, Unread> {
    // A state counts only if its detection is on.
    let state = |flags: u8, states: u8| Suspicion::from_number(if flags & 1 == 1 { states } else { 0 });
    let (jamming, spoofing) = match *payload {
        [1, _, _, _, jamming, _, _, _, spoofing, ..] => {
            (state(jamming, jamming >> 1 & 3), state(spoofing, spoofing >> 1 & 7))
        }
        [2, flags, ..] => (state(flags, flags >> 1 & 3), state(flags >> 3, flags >> 4 & 7)),
        _ => return Err(Unread::Malformed),
    };
    Ok(SelfReport::Interference(Jamming {
        reporter: Reporter::Detector,
        jamming: Some(jamming),
        spoofing: Some(spoofing),
    }))
}

/// Reads NAV-STATUS, which reports only spoofing. Its highest state is an indication by several
/// means.
pub(super) fn nav_status(payload: &[u8]) -> Result<SelfReport, Unread> {
    match *payload {
        [_, _, _, _, _, _, _, flags, _, _, _, _, _, _, _, _] => Ok(SelfReport::Interference(Jamming {
            reporter: Reporter::Navigation,
            jamming: None,
            spoofing: Some(Suspicion::from_number(flags >> 3 & 3)),
        })),
        _ => Err(Unread::Malformed),
    }
}

/// Reads the jamming state of MON-RF: the worst of all blocks.
pub(super) fn mon_rf(payload: &[u8]) -> Result<SelfReport, Unread> {
    let [0, count, _, _, rest @ ..] = payload else { return Err(Unread::Malformed) };
    let worst = match groups::<24>(*count, rest) {
        Ok(blocks) => worst_of(blocks),
        Err(_) => worst_of(groups::<20>(*count, rest)?),
    };
    Ok(SelfReport::Interference(Jamming {
        reporter: Reporter::FrontEnd,
        jamming: Some(worst),
        spoofing: None,
    }))
}

/// Returns the worst jamming state of the blocks of a front end.
fn worst_of<const N: usize>(blocks: &[[u8; N]]) -> Suspicion {
    let states =
        blocks.iter().filter_map(|block| block.get(1)).map(|flags| Suspicion::from_number(flags & 3));
    states.fold(Suspicion::Unknown, Suspicion::max)
}

/// Reads SEC-SIGLOG. Events that ended and events of unknown kinds do not count.
pub(super) fn sec_siglog(payload: &[u8]) -> Result<SelfReport, Unread> {
    let [1, count, _, _, _, _, _, _, rest @ ..] = payload else { return Err(Unread::Malformed) };
    let mut logged = LoggedEvents::default();
    for [a, b, c, d, kind, event, _, _] in groups::<8>(*count, rest)? {
        let age_s = u32::from_le_bytes([*a, *b, *c, *d]);
        let latest = match *kind {
            _ if *event == EVENT_STOPPED => continue,
            EVENT_OF_JAMMING => &mut logged.jamming_s,
            kind if kind < EVENT_OF_JAMMING => &mut logged.spoofing_s,
            _ => continue,
        };
        *latest = Some(latest.map_or(age_s, |known_s| known_s.min(age_s)));
    }
    Ok(SelfReport::Log(logged))
}

/// Class and id of NAV-SIG.
pub(super) const NAV_SIG: [u8; 2] = [0x01, 0x43];

/// Returns true if a payload that begins with these bytes may be a NAV-SIG of this length: the number
/// of signals explains it, or has not come yet.
pub(super) fn may_be_signals(begun: &[u8], length: usize) -> bool {
    length <= 8 + 255 * 16 && begun.get(5).is_none_or(|&count| length == 8 + 16 * usize::from(count))
}

/// Reads the number of authenticated signals of NAV-SIG.
pub(super) fn nav_sig(payload: &[u8]) -> Result<SelfReport, Unread> {
    let [_, _, _, _, 0, count, _, _, rest @ ..] = payload else { return Err(Unread::Malformed) };
    let signals = groups::<16>(*count, rest)?;
    let authenticated = signals.iter().filter(|[_, _, _, _, _, _, _, _, _, _, _, high, ..]| high & 2 != 0);
    // The message counts its signals in a byte, so that the cast loses nothing.
    Ok(SelfReport::Authentication(authenticated.count() as u8))
}

/// Reads the levels of the position in NAV-PL.
pub(super) fn nav_pl(payload: &[u8]) -> Result<SelfReport, Unread> {
    let [1, coefficient, exponent, is_valid, frame, ..] = payload else { return Err(Unread::Malformed) };
    let at = |offset: usize| match payload.get(offset..offset + 4) {
        Some(&[a, b, c, d]) if payload.len() == NAV_PL_BYTES => Ok(u32::from_le_bytes([a, b, c, d])),
        _ => Err(Unread::Malformed),
    };
    let levels = ReceiverLevels {
        frame: *frame,
        axes_mm: [at(16)?, at(20)?, at(24)?],
        risk: (*coefficient, exponent.cast_signed()),
    };
    Ok(SelfReport::Levels((*is_valid == 1).then_some(levels)))
}

/// Length of NAV-PL, bytes.
const NAV_PL_BYTES: usize = 52;

/// Returns the repeated groups behind the head of a message, if they are as many as it states.
fn groups<const N: usize>(count: u8, rest: &[u8]) -> Result<&[[u8; N]], Unread> {
    match rest.as_chunks() {
        (groups, []) if groups.len() == usize::from(count) => Ok(groups),
        _ => Err(Unread::Malformed),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn interference(
        reporter: Reporter,
        jamming: Option<Suspicion>,
        spoofing: Option<Suspicion>,
    ) -> SelfReport {
        SelfReport::Interference(Jamming { reporter, jamming, spoofing })
    }

    #[test]
    fn both_versions_of_sec_sig_say_the_same() {
        // Jamming watched for and critical; spoofing watched for and indicated.
        let first = [1, 0, 0, 0, 0b111, 0, 0, 0, 0b0101, 0, 0, 0];
        let second = [2, 0b0010_1111, 0, 0];
        let want = interference(Reporter::Detector, Some(Suspicion::Sure), Some(Suspicion::Suspected));
        assert_eq!((sec_sig(&first), sec_sig(&second)), (Ok(want), Ok(want)));
    }

    #[test]
    fn what_is_not_watched_for_is_unknown() {
        let unknown = Some(Suspicion::Unknown);
        let want = interference(Reporter::Detector, unknown, unknown);
        assert_eq!(sec_sig(&[2, 0b0110_0110, 0, 0]), Ok(want));
        assert_eq!(sec_sig(&[3, 0, 0, 0]), Err(Unread::Malformed));
        assert_eq!(nav_status(&[0; 15]), Err(Unread::Malformed));
    }

    #[test]
    fn mon_rf_is_as_bad_as_its_worst_block() {
        let mut payload = [0; 4 + 2 * 24];
        payload[1] = 2;
        payload[5] = 0b1111_1101;
        payload[29] = 0b10;
        assert_eq!(mon_rf(&payload), Ok(interference(Reporter::FrontEnd, Some(Suspicion::Suspected), None)));
        assert_eq!(mon_rf(&payload[..51]), Err(Unread::Malformed));
        payload[1] = 1;
        assert_eq!(mon_rf(&payload), Err(Unread::Malformed));
    }

    /// A ZED-F9R sent these bytes.
    #[test]
    fn mon_rf_of_a_recorded_receiver_has_shorter_blocks() {
        let block = |state, rest: [u8; 12]| [&[0, state, 2, 15, 0, 0, 0, 0][..], &rest].concat();
        let first = block(1, [0, 0, 0, 0, 0x45, 0x00, 0x32, 0x13, 0x13, 0x95, 0x16, 0x95]);
        let second = block(1, [0, 0, 0, 0, 0x27, 0x00, 0x91, 0x14, 0x0D, 0xA9, 0x0B, 0xA5]);
        let payload = [&[0, 2, 0, 0][..], &first, &second].concat();
        assert_eq!(mon_rf(&payload), Ok(interference(Reporter::FrontEnd, Some(Suspicion::None), None)));
    }

    #[test]
    fn log_has_the_latest_event_of_each_kind_that_did_not_end() {
        let event = |age: u32, kind: u8, event: u8| {
            let [a, b, c, d] = age.to_le_bytes();
            [a, b, c, d, kind, event, 0, 0]
        };
        let mut payload = std::vec![1, 5, 0, 0, 0, 0, 0, 0];
        payload.extend(
            [event(70_000, 1, 0), event(300, 3, 2), event(5, 0, 1), event(9, 4, 0), event(1, 5, 0)].concat(),
        );
        let want = LoggedEvents { jamming_s: Some(9), spoofing_s: Some(300) };
        assert_eq!(sec_siglog(&payload), Ok(SelfReport::Log(want)));
        assert_eq!(sec_siglog(&payload[..47]), Err(Unread::Malformed));
        assert_eq!(sec_siglog(&[1, 0, 0, 0, 0, 0, 0, 0]), Ok(SelfReport::Log(LoggedEvents::default())));
    }

    #[test]
    fn nav_sig_counts_bit_nine_of_the_flags() {
        let mut payload = [0; 8 + 3 * 16];
        payload[5] = 3;
        payload[8 + 10] = 0xFF;
        payload[24 + 11] = 0x02;
        payload[40 + 11] = 0xFF;
        assert_eq!(nav_sig(&payload), Ok(SelfReport::Authentication(2)));
        assert_eq!(nav_sig(&payload[..55]), Err(Unread::Malformed));
    }

    #[test]
    fn nav_pl_has_levels_only_while_it_is_valid() {
        let mut payload = [0; 52];
        (payload[0], payload[1], payload[2], payload[3], payload[4]) = (1, 3, 0xF9, 1, 2);
        (payload[16], payload[21], payload[26]) = (1, 1, 1);
        let levels = ReceiverLevels { frame: 2, axes_mm: [1, 256, 65_536], risk: (3, -7) };
        assert_eq!(nav_pl(&payload), Ok(SelfReport::Levels(Some(levels))));
        payload[3] = 0;
        assert_eq!(nav_pl(&payload), Ok(SelfReport::Levels(None)));
        assert_eq!(nav_pl(&payload[..51]), Err(Unread::Malformed));
        payload[0] = 2;
        assert_eq!(nav_pl(&payload), Err(Unread::Malformed));
    }
}
