use std::vec::Vec;

use super::*;

/// Example of the standard's section 4, a message 1005.
const RTCM_FRAME: [u8; 25] = [
    0xD3, 0x00, 0x13, 0x3E, 0xD7, 0xD3, 0x02, 0x02, 0x98, 0x0E, 0xDE, 0xEF, 0x34, 0xB4, 0xBD, 0x62, 0xAC,
    0x09, 0x41, 0x98, 0x6F, 0x33, 0x36, 0x0B, 0x98,
];

/// MON-VER polled: the example of u-blox's own description, `B5 62 0A 04 00 00 0E 34`.
const UBX_FRAME: [u8; 8] = [0xB5, 0x62, 0x0A, 0x04, 0x00, 0x00, 0x0E, 0x34];

/// Returns the frames, taken after every chunk.
fn frames(framer: &mut Framer, bytes: &[u8], counters: &mut Counters) -> Vec<(Format, usize)> {
    frames_asked_when(|_| true, framer, bytes.chunks(46), counters)
}

fn frames_asked_when<'b>(
    is_asked: fn(&mut Framer) -> bool,
    framer: &mut Framer,
    chunks: impl Iterator<Item = &'b [u8]>,
    counters: &mut Counters,
) -> Vec<(Format, usize)> {
    let mut found = Vec::new();
    for mut rest in chunks {
        while !rest.is_empty() {
            rest = framer.take(rest, 0, counters);
            while is_asked(framer)
                && let Some((format, frame)) = framer.next(false, counters)
            {
                found.push((format, frame.bytes.len()));
            }
        }
    }
    found
}

#[test]
fn both_formats_are_found_in_one_stream() {
    let (mut framer, mut counters) = (Framer::new(), Counters::default());
    let stream = [&UBX_FRAME[..], b"$GPGGA,,*00\r\n", &RTCM_FRAME, &[0xB5], &UBX_FRAME].concat();
    let have = frames(&mut framer, &stream, &mut counters);
    assert_eq!(have, [(Format::Ubx, 8), (Format::Rtcm, 25), (Format::Ubx, 8)]);
    assert_eq!((counters.frames, counters.bytes_skipped, counters.crc_failures), (3, 14, 0));
}

/// The stream has whole frames, cut ones, beginnings of long ones and noise, in every order of
/// three, in chunks of every size.
#[test]
fn asked_only_when_it_is_worth_a_look_it_finds_the_same() {
    let pieces: [&[u8]; 8] = [
        &UBX_FRAME,
        &RTCM_FRAME,
        &RTCM_FRAME[..11],
        &UBX_FRAME[..5],
        &[0xD3, 0x00, 0x05],
        &[0xB5, 0x62, 0x02, 0x15, 0x30, 0x00],
        &[0xD3, 0x03, 0xFF],
        &[0xB5, 0x00, 0xD3],
    ];
    let orders = (0..pieces.len().pow(3)).map(|n| [n % 8, n / 8 % 8, n / 64].map(|n| pieces[n]).concat());
    let stream: Vec<u8> = orders.flatten().collect();
    for size in 1..=64 {
        let [always, seldom] = [|_: &mut Framer| true, Framer::is_worth_a_look].map(|is_asked| {
            let (mut framer, mut counters) = (Framer::new(), Counters::default());
            let found = frames_asked_when(is_asked, &mut framer, stream.chunks(size), &mut counters);
            (found, counters)
        });
        assert!(always.0.len() > 100, "{} frames", always.0.len());
        assert_eq!(always, seldom, "in pieces of {size}");
    }
}

#[test]
fn a_ubx_frame_with_one_wrong_bit_is_none() {
    for bit in 0..64 {
        let mut broken = UBX_FRAME;
        broken[bit / 8] ^= 1 << (bit % 8);
        let (mut framer, mut counters) = (Framer::new(), Counters::default());
        let have = frames(&mut framer, &broken, &mut counters);
        assert!(have.is_empty(), "bit {bit}: {have:?}");
    }
}

/// The bound is the number of bytes checked for each received byte, besides the buffer's own size.
#[test]
fn a_stream_of_beginnings_is_checked_a_bounded_number_of_times() {
    const BYTES: usize = 100_000;
    for beginning in [&[0xD3, 0x03, 0xFF][..], &[0xD3, 0x00][..], &[0xB5, 0x62, 0x01, 0x07, 0xFF, 0x03][..]] {
        let (mut framer, mut counters) = (Framer::new(), Counters::default());
        let stream: Vec<u8> = beginning.iter().copied().cycle().take(BYTES).collect();
        let have = frames(&mut framer, &stream, &mut counters);
        assert!(have.is_empty(), "{have:?}");
        // The shortest of these candidates has 217 bytes.
        let most = (CREDIT_PER_BYTE * BYTES + CREDIT_MOST) / 217;
        assert!(counters.crc_failures as usize <= most, "{} checks", counters.crc_failures);
        assert!(counters.frames_unchecked > 0);
        // A frame is found again after the longest of the beginnings has run out.
        frames(&mut framer, &[0; CAPACITY], &mut counters);
        assert_eq!(frames(&mut framer, &RTCM_FRAME, &mut counters), [(Format::Rtcm, 25)]);
    }
}

#[test]
fn a_frame_is_as_old_as_its_first_byte_may_be() {
    let (mut framer, mut counters) = (Framer::new(), Counters::default());
    assert!(framer.take(&RTCM_FRAME[..5], 100, &mut counters).is_empty());
    assert!(framer.next(false, &mut counters).is_none());
    assert!(framer.take(&RTCM_FRAME[5..], 200, &mut counters).is_empty());
    assert_eq!(framer.next(false, &mut counters).map(|(_, frame)| frame.came_ms), Some(100));
    assert!(framer.next(false, &mut counters).is_none());
    // The end of one frame and the beginning of the next come together.
    framer.take(&RTCM_FRAME[..20], 300, &mut counters);
    assert!(framer.next(false, &mut counters).is_none());
    let both = [&RTCM_FRAME[20..], &RTCM_FRAME[..]].concat();
    framer.take(&both, 400, &mut counters);
    assert_eq!(framer.next(false, &mut counters).map(|(_, frame)| frame.came_ms), Some(300));
    assert_eq!(framer.next(false, &mut counters).map(|(_, frame)| frame.came_ms), Some(400));
}

/// Returns false beginnings: of the longest frames, of short ones, and several of them in a row.
fn false_beginnings() -> Vec<Vec<u8>> {
    let rtcm = |length: u16| [&[0xD3][..], &length.to_be_bytes()].concat();
    let ubx = |message: [u8; 2], length: u16| [&[0xB5, 0x62][..], &message, &length.to_le_bytes()].concat();
    let mut beginnings: Vec<Vec<u8>> = [0, 19, 46, 300, 1023].map(rtcm).to_vec();
    beginnings.extend([0, 8, 48, 300, 1023].map(|length| ubx([0x01, 0x07], length)));
    beginnings.extend([0, 1, 17, 160, 255].map(|many| ubx([0x02, 0x15], 16 + 32 * many)));
    let all = beginnings.concat();
    let repeated = beginnings.iter().map(|beginning| beginning.repeat(12)).collect::<Vec<_>>();
    beginnings.extend(repeated);
    beginnings.push(all);
    beginnings
}

#[test]
fn a_frame_inside_an_incomplete_candidate_is_found_with_its_last_byte() {
    for (format, frame) in [(Format::Rtcm, &RTCM_FRAME[..]), (Format::Ubx, &UBX_FRAME)] {
        for beginning in false_beginnings() {
            for is_asked in [|_: &mut Framer| true, Framer::is_worth_a_look] {
                let (mut framer, mut counters) = (Framer::new(), Counters::default());
                let stream = [&beginning[..], &[0; 3], frame, &[0]].concat();
                let last = stream.len() - 2;
                for (index, byte) in stream.iter().enumerate() {
                    let came = core::iter::once(core::slice::from_ref(byte));
                    let found = frames_asked_when(is_asked, &mut framer, came, &mut counters);
                    let want: &[_] = if index == last { &[(format, frame.len())] } else { &[] };
                    assert_eq!(found, want, "{beginning:02X?}, byte {index} of {last}");
                }
                let skipped = counters.bytes_skipped as usize + framer.waiting().len();
                assert_eq!(skipped, stream.len() - frame.len(), "{beginning:02X?}");
            }
        }
    }
}

#[test]
fn a_frame_inside_a_candidate_is_as_old_as_its_own_first_byte() {
    let (mut framer, mut counters) = (Framer::new(), Counters::default());
    framer.take(&[0xD3, 0x03, 0xFF], 100, &mut counters);
    assert!(!framer.is_worth_a_look());
    for (index, byte) in RTCM_FRAME.iter().enumerate() {
        assert!(!framer.is_worth_a_look(), "byte {index}");
        framer.take(&[*byte], 200 + index as u64, &mut counters);
    }
    assert!(framer.is_worth_a_look());
    assert_eq!(framer.next(false, &mut counters).map(|(_, frame)| frame.came_ms), Some(200));
    assert_eq!((counters.frames_cut, counters.bytes_skipped), (1, 3));
}

/// A long RXM-RAWX stays a candidate only while its number of measurements explains its length.
#[test]
fn a_long_message_of_ranges_is_none_as_soon_as_its_number_contradicts_its_length() {
    for (many, want) in [(160, true), (159, false), (0, false), (32, false), (0x2E, false)] {
        let (mut framer, mut counters) = (Framer::new(), Counters::default());
        let mut begun = [0xB5, 0x62, 0x02, 0x15, 0x10, 0x14].to_vec();
        begun.extend([0; 11]);
        assert!(frames(&mut framer, &begun, &mut counters).is_empty());
        assert!(matches!(framer.candidate(), Front::Incomplete(_)));
        frames(&mut framer, &[many], &mut counters);
        assert_eq!(!framer.is_empty(), want, "{many} measurements");
    }
}

/// Checks inside candidates leave credit for the candidates, so that good frames behind them are
/// found.
#[test]
fn a_stream_of_nested_beginnings_leaves_credit_for_what_follows() {
    let shorter_and_shorter: Vec<u8> = (3..=120_u8).rev().flat_map(|length| [0xD3, 0x00, length]).collect();
    let (mut framer, mut counters) = (Framer::new(), Counters::default());
    for _ in 0..200 {
        let stream = [&[0xB5, 0x62, 0x02, 0x15, 0x10, 0x14][..], &shorter_and_shorter].concat();
        assert!(frames(&mut framer, &stream, &mut counters).is_empty());
    }
    frames(&mut framer, &[0; CAPACITY], &mut counters);
    assert_eq!(frames(&mut framer, &RTCM_FRAME, &mut counters), [(Format::Rtcm, 25)]);
}

/// A frame from elsewhere may go in behind a whole frame and behind text, and nowhere else.
#[test]
fn it_is_empty_where_no_frame_is_incomplete() {
    let (mut framer, mut counters) = (Framer::new(), Counters::NONE);
    assert!(framer.is_empty());
    let stream = [&b"$GNRMC\r\n"[..], &RTCM_FRAME, &UBX_FRAME].concat();
    let ends = [8, 8 + RTCM_FRAME.len(), stream.len()];
    for (index, byte) in stream.iter().enumerate() {
        frames(&mut framer, &[*byte], &mut counters);
        // A dollar alone may begin a block of SBF.
        let is_between = (1..8).contains(&index) || ends.contains(&(index + 1));
        assert_eq!(framer.is_empty(), is_between, "after {} bytes", index + 1);
    }
}
