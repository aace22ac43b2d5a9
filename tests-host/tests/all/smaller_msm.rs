//! Faults put into the ranges of MSM4, MSM5 and MSM6: the same frames as MSM7 with fewer and
//! coarser fields.
//!
//! | | whole ms | info | rough range | rough rate | fine range | phase | lock | half cycle | C/N0 | fine rate |
//! |---|---|---|---|---|---|---|---|---|---|---|
//! | MSM4 | 8 | | 10 | | 15 | 22 | 4 | 1 | 6 | |
//! | MSM5 | 8 | 4 | 10 | 14 | 15 | 22 | 4 | 1 | 6 | 15 |
//! | MSM6 | 8 | | 10 | | 20 | 24 | 10 | 1 | 10 | |
//! | MSM7 | 8 | 4 | 10 | 14 | 20 | 24 | 10 | 1 | 10 | 15 |
//!
//! Reference: [RTCM-10403.3] tables 3.5-78 to 3.5-91.
//!
//! [RTCM-10403.3]: raim#references

use raim::replay::{self, Lump, Pace, Track, Window};
use raim::signal::capture::Capture;
use raim::signal::checksum::crc24q;
use raim::signal::encode::{Frequency, Selection};
use raim::signal::fault::Fault;
use raim::signal::pieces::{Kind, pieces};
use rig::stations::STATIC_BASE;

/// Number of bits of an MSM before the masks of satellites, signals and cells, and of the first
/// two.
const BEFORE_MASKS: usize = 73;
const SATELLITE_MASK: usize = 64;
const SIGNAL_MASK: usize = 32;

/// Widths of the fields of MSM7, satellite by satellite, then cell by cell.
const OF_SATELLITES: [usize; 4] = [8, 4, 10, 14];
const OF_CELLS: [usize; 6] = [20, 24, 10, 1, 10, 15];

/// Reader of bits from the front.
struct Bits<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Bits<'_> {
    fn next(&mut self, width: usize) -> u64 {
        let bit = |at: usize| u64::from(self.bytes[at / 8] >> (7 - at % 8) & 1);
        let value = (self.at..self.at + width).fold(0, |value, at| value << 1 | bit(at));
        self.at += width;
        value
    }

    fn ones(&mut self, width: usize) -> usize {
        (0..width).filter(|_| self.next(1) == 1).count()
    }
}

/// Writer of bits.
#[derive(Default)]
struct Written(Vec<bool>);

impl Written {
    fn put(&mut self, value: u64, width: usize) {
        self.0.extend((0..width).rev().map(|bit| value >> bit & 1 == 1));
    }

    fn bytes(&self) -> Vec<u8> {
        let byte =
            |bits: &[bool]| (0..8).fold(0, |byte, at| byte << 1 | u8::from(*bits.get(at).unwrap_or(&false)));
        self.0.chunks(8).map(byte).collect()
    }
}

/// Shortens a number in two's complement by bits at its end, rounded. The most negative number,
/// which means no value, stays.
fn coarser(value: u64, from: usize, to: usize) -> u64 {
    let signed = ((value << (64 - from)).cast_signed()) >> (64 - from);
    let step = 1_i64 << (from - to);
    let none = -(1_i64 << (from - 1));
    let most = (1_i64 << (to - 1)) - 1;
    let rounded =
        if signed == none { none / step } else { (signed + step / 2).div_euclid(step).clamp(-most, most) };
    rounded.cast_unsigned() & ((1 << to) - 1)
}

/// Converts an MSM7 frame to MSM4, MSM5 or MSM6.
fn smaller(frame: &[u8], to: u64) -> Vec<u8> {
    let mut bits = Bits { bytes: &frame[3..frame.len() - 3], at: 0 };
    let mut written = Written::default();
    let number = bits.next(12);
    assert_eq!(number % 10, 7, "{number} is no MSM7");
    written.put(number - 7 + to, 12);
    for _ in 12..BEFORE_MASKS {
        written.put(bits.next(1), 1);
    }
    let masks = bits.at;
    let (satellites, signals) = (bits.ones(SATELLITE_MASK), bits.ones(SIGNAL_MASK));
    let cells = bits.ones(satellites * signals);
    let width = bits.at - masks;
    bits.at = masks;
    for _ in 0..width {
        written.put(bits.next(1), 1);
    }
    let has_rates = to == 5;
    for (field, width) in OF_SATELLITES.into_iter().enumerate() {
        for _ in 0..satellites {
            let value = bits.next(width);
            if has_rates || matches!(field, 0 | 2) {
                written.put(value, width);
            }
        }
    }
    let is_coarse = to < 6;
    for (field, width) in OF_CELLS.into_iter().enumerate() {
        for _ in 0..cells {
            let value = bits.next(width);
            match (field, is_coarse) {
                (5, _) if !has_rates => {}
                (0, true) => written.put(coarser(value, width, 15), 15),
                (1, true) => written.put(coarser(value, width, 22), 22),
                // The two messages encode the lock time differently, and it is not used.
                (2, true) => written.put(15, 4),
                (4, true) => written.put((value + 8) >> 4, 6),
                _ => written.put(value, width),
            }
        }
    }
    let payload = written.bytes();
    let mut frame = vec![0xD3, (payload.len() >> 8) as u8, payload.len() as u8];
    frame.extend(payload);
    let parity = crc24q(&frame);
    frame.extend(parity);
    frame
}

fn all_smaller(lumps: &[Lump], to: u64) -> Vec<Lump> {
    let of_lump = |lump: &Lump| {
        let bytes = pieces(&lump.bytes).flat_map(|piece| match piece.kind {
            Kind::Rtcm(1071..=1137) => smaller(piece.bytes, to),
            _ => piece.bytes.to_vec(),
        });
        Lump { bytes: bytes.collect(), ..lump.clone() }
    };
    lumps.iter().map(of_lump).collect()
}

fn run(lumps: &[Lump]) -> Track {
    replay::track(lumps, &replay::on_host(lumps, &[], Pace::Recorded, |_| ()).unwrap(), None)
}

#[test]
fn a_fault_put_into_any_msm_is_the_fault_put_into_the_recording() {
    let Some(recording) = STATIC_BASE.load() else { return };
    let selection = Selection::new("GCE", Frequency::Dual).unwrap();
    let window = Window { to_s: 45.0, ..Window::ALL };
    let clean = replay::encode(&recording, &selection, &[], &window).unwrap();
    // Ranges are rounded before and after the fault to 18 mm or 0.6 mm, which two frequencies
    // triple.
    for (to, apart_at_most_m) in [(4, 0.15), (5, 0.15), (6, 0.01)] {
        let bytes: Vec<u8> = all_smaller(&clean, to).into_iter().flat_map(|lump| lump.bytes).collect();
        let capture = Capture::of(bytes, None).unwrap();
        for text in ["C08:+100@20..40", "C08:-50000@20..40", "G:lost@20..40", "*:+150@20..40"] {
            let fault = Fault::parse_inject(text).unwrap();
            let recorded = replay::encode(&recording, &selection, &[fault], &window).unwrap();
            let want = run(&all_smaller(&recorded, to));
            let have = run(&capture.lumps(&[fault], &Window::ALL).unwrap().lumps);
            assert_eq!(have.len(), want.len(), "MSM{to} {text}");
            let mut touched = 0;
            for (have, want) in have.iter().zip(&want) {
                let (have, want) = (have.output.as_ref().unwrap(), want.output.as_ref().unwrap());
                let who = |output: &raim::verdict::EpochOutput| {
                    let left_out = output.excluded.iter().map(|excluded| excluded.satellite.to_string());
                    (
                        output.state.state,
                        output.state.reason.clone(),
                        output.state.used,
                        left_out.collect::<Vec<_>>(),
                    )
                };
                assert_eq!(who(have), who(want), "MSM{to} {text}");
                let apart_m =
                    have.position.zip(want.position).map(|(a, b)| a.to_ecef().distance_m(b.to_ecef()));
                assert!(
                    apart_m.is_none_or(|apart_m| apart_m < apart_at_most_m),
                    "MSM{to} {text}: {apart_m:?} m"
                );
                touched += usize::from(!have.excluded.is_empty());
            }
            assert!(
                !text.starts_with("C08") || touched >= 15,
                "MSM{to} {text}: left out in {touched} epochs"
            );
        }
    }
}
