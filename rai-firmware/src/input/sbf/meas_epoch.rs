//! `MeasEpoch`: the ranges of one epoch.
//!
//! | offset | type | field |
//! |---|---|---|
//! | 14 | u8 | number `N1` of sub-blocks of type 1 |
//! | 15, 16 | u8 | length of a sub-block of type 1 and of type 2, bytes |
//! | 17 | bits | 1: ranges are smoothed; 7: ranges are scrambled |
//! | 18 | u8 | milliseconds by which the receiver clock has jumped, modulo 256 |
//!
//! A sub-block of type 1 is the first signal of a satellite, and those of type 2 behind it are its
//! other signals:
//!
//! | type 1 | type 2 | field |
//! |---|---|---|
//! | 1, 18 | 0, 5 | signal with antenna, information ([`super::signals`]) |
//! | 2 | – | satellite |
//! | 3 (4 bits), 4 (u32) | 3 (3 bits), 6 (u16) | range `P`, mm: `P1 = MSB 2³² + LSB`, `P2 = P1 + MSB 2¹⁶ + LSB` |
//! | 8 (i32) | 3 (5 bits), 10 (u16) | Doppler `D`, 0.1 mHz: `D2 = D1 f2/f1 + MSB 2¹⁶ + LSB` |
//! | 15 | 2 | C/N0, 0.25 dB-Hz, from 10 dB-Hz on, but from 0 on for P(Y) of GPS |
//! | 19 | – | number `N2` of sub-blocks of type 2 |
//!
//! The fields of a type without a value are zero for `P1`, their smallest value for `D1`, and the
//! smallest MSB with LSB zero for the others. Only signals of the first antenna (0) are read. Of a
//! newer revision a sub-block may be longer, and is stepped over by its stated length.
//!
//! Single precision computes `D1` and `D2` to 0.001 Hz, or 0.2 mm/s.
//!
//! Reference: [SBF] 4.2.1, `MeasEpoch`.
//!
//! [SBF]: crate#references

use raim_core::satellite::SatelliteId;

use super::block::Block;
use super::signals::{self, Signal};
use crate::counters::count;
use crate::input::protocol::Measurements;
use crate::input::system::System;
use crate::input::{Counters, Unread};
use crate::raw::RawSignal;

/// Number of the block.
pub(super) const NUMBER: u16 = 4027;

/// Bytes before the sub-blocks.
const HEADER: usize = 20;

/// Bytes of each type of sub-block that are read.
const FIRST: usize = 20;
const FURTHER: usize = 12;

/// Flags of the block.
const SMOOTHED: u8 = 1 << 1;
const SCRAMBLED: u8 = 1 << 7;

/// Step of a Doppler frequency, Hz.
const DOPPLER_HZ: f32 = 1e-4;

/// A block whose sub-blocks are all inside it.
#[derive(Debug)]
pub(in crate::input) struct MeasEpoch<'a> {
    sub_blocks: &'a [u8],
    many: u8,
    first_bytes: usize,
    further_bytes: usize,
    flags: u8,
    /// Milliseconds by which the receiver clock has jumped, modulo 256.
    pub(super) clock_jumps_ms: u8,
}

/// Signals of one satellite, and what is behind them.
type Split<'a> = (&'a [u8; FIRST], &'a [u8], &'a [u8]);

impl<'a> MeasEpoch<'a> {
    /// Reads the header, and checks the lengths of all sub-blocks.
    pub(super) fn new(block: &Block<'a>) -> Result<Self, Unread> {
        block.at_least(HEADER)?;
        let epoch = Self {
            sub_blocks: block.behind(HEADER),
            many: block.u8(14),
            first_bytes: block.u8(15).into(),
            further_bytes: block.u8(16).into(),
            flags: block.u8(17),
            clock_jumps_ms: block.u8(18),
        };
        if epoch.flags & SCRAMBLED != 0 {
            return Err(Unread::Scrambled);
        }
        let is_readable = epoch.first_bytes >= FIRST && epoch.further_bytes >= FURTHER;
        let mut rest = epoch.sub_blocks;
        for _ in 0..epoch.many {
            let (_, _, behind) = epoch.split(rest).filter(|_| is_readable).ok_or(Unread::Malformed)?;
            rest = behind;
        }
        Ok(epoch)
    }

    /// Returns true if the ranges are smoothed by the phase of their carriers.
    pub(super) const fn is_smoothed(&self) -> bool {
        self.flags & SMOOTHED != 0
    }

    /// Splits bytes into the first signal of a satellite, its other signals, and the rest.
    fn split(&self, bytes: &'a [u8]) -> Option<Split<'a>> {
        let first = bytes.first_chunk::<FIRST>()?;
        let &[.., further] = first;
        let (further, rest) =
            bytes.get(self.first_bytes..)?.split_at_checked(usize::from(further) * self.further_bytes)?;
        Some((first, further, rest))
    }

    /// Passes the ranges of one satellite to `add`.
    fn each_signal(
        &self,
        first: &[u8; FIRST],
        further: &[u8],
        counters: &mut Counters,
        add: &mut impl FnMut(SatelliteId, RawSignal, bool, &mut Counters),
    ) {
        let &[_, _, svid, ..] = first;
        let Some((system, number)) = signals::numbered(svid) else {
            return count(&mut counters.observations_other);
        };
        let Some(satellite) = system.satellite(number) else {
            return count(&mut counters.satellites_unknown);
        };
        let main = Observed::first(first);
        // One of each type of sub-block, so that adding is compiled once.
        let mut sub_blocks = further.chunks_exact(self.further_bytes.max(1));
        let mut next = Some(main);
        while let Some(observed) = next {
            if let Some(signal) = observed.raw(system, counters) {
                add(satellite, signal, observed.signal.is_reference(), counters);
            }
            next = sub_blocks.next().and_then(|bytes| main.further(system, bytes));
        }
    }
}

impl Measurements for MeasEpoch<'_> {
    fn is_empty(&self) -> bool {
        self.many == 0
    }

    /// Counts unusable signals.
    fn each(
        &self,
        counters: &mut Counters,
        add: &mut impl FnMut(SatelliteId, RawSignal, bool, &mut Counters),
    ) {
        let mut rest = self.sub_blocks;
        for _ in 0..self.many {
            let Some((first, further, behind)) = self.split(rest) else { return };
            self.each_signal(first, further, counters, add);
            rest = behind;
        }
    }
}

/// Measurements of one signal.
#[derive(Clone, Copy, Debug)]
struct Observed {
    signal: Signal,
    antenna: u8,
    /// Range, mm; 0 if there is none.
    range_mm: u64,
    doppler_hz: Option<f32>,
    cn0: u8,
}

impl Observed {
    /// Reads a sub-block of type 1.
    fn first(bytes: &[u8; FIRST]) -> Self {
        let &[_, kind, _, high, c0, c1, c2, c3, d0, d1, d2, d3, _, _, _, cn0, _, _, information, _] = bytes;
        let doppler = i32::from_le_bytes([d0, d1, d2, d3]);
        Self {
            signal: Signal::new(kind, information),
            antenna: kind >> 5,
            range_mm: u64::from(high & 15) << 32 | u64::from(u32::from_le_bytes([c0, c1, c2, c3])),
            doppler_hz: (doppler != i32::MIN).then_some(doppler as f32 * DOPPLER_HZ),
            cn0,
        }
    }

    /// Reads a sub-block of type 2, whose fields are relative to this one.
    fn further(&self, system: System, bytes: &[u8]) -> Option<Self> {
        let &[kind, _, cn0, high, _, information, c0, c1, _, _, d0, d1] = bytes.first_chunk::<FURTHER>()?;
        let signal = self.signal.further(kind, information);
        // Both MSBs are in one byte: three bits and five bits in two's complement.
        let code = offset(high << 5, 5, [c0, c1]);
        let doppler = offset(high, 3, [d0, d1]);
        let ratio = signal
            .doppler_of_a_metre_hz(system)
            .zip(self.signal.doppler_of_a_metre_hz(system))
            .map(|(own, main)| own / main);
        let range_mm = match code {
            Some(offset_mm) if self.range_mm != 0 => self.range_mm.saturating_add_signed(offset_mm.into()),
            _ => 0,
        };
        let doppler_hz = match (self.doppler_hz, ratio, doppler) {
            (Some(main_hz), Some(ratio), Some(offset)) => Some(main_hz * ratio + offset as f32 * DOPPLER_HZ),
            _ => None,
        };
        Some(Self { signal, antenna: kind >> 5, range_mm, doppler_hz, cn0 })
    }

    /// Returns the range, unless it is not used; counts the reason.
    fn raw(&self, system: System, counters: &mut Counters) -> Option<RawSignal> {
        /// Carrier to noise density that is unknown.
        const UNKNOWN: u8 = 255;
        if self.antenna != 0 {
            count(&mut counters.observations_other);
            return None;
        }
        let Some(carrier) = self.signal.carrier(system) else {
            count(&mut counters.signals_other);
            return None;
        };
        if self.range_mm == 0 {
            count(&mut counters.ranges_missing);
            return None;
        }
        // At most 37 bits, which a double holds.
        let raw = RawSignal::new(carrier, self.range_mm as f64 * 1e-3).with_code(self.signal.code(system));
        let raw = match self.cn0 {
            _ if self.signal.is_codeless() => raw.codeless(),
            UNKNOWN => raw,
            quarters => raw.with_cn0_dbhz(10.0 + 0.25 * f32::from(quarters)),
        };
        Some(self.doppler_hz.map_or(raw, |doppler_hz| raw.with_doppler_hz(doppler_hz)))
    }
}

/// Returns the number of an MSB, in the upper bits of a byte above `unused` ones, and an LSB; `None`
/// for the smallest one, which marks a missing value.
fn offset(high: u8, unused: u32, low: [u8; 2]) -> Option<i32> {
    let high = i32::from(high.cast_signed() >> unused);
    let number = high << 16 | i32::from(u16::from_le_bytes(low));
    (number != i32::from(i8::MIN >> unused) << 16).then_some(number)
}

/// Returns the length of a block with these numbers of satellites and of signals of each, bytes.
pub(super) const fn block_of(satellites: usize, signals: usize) -> usize {
    HEADER + satellites * (FIRST + (signals - 1) * FURTHER)
}

/// Returns true if a block of this length may have these bytes behind its length: the sub-blocks of
/// type 1 fit into it, or their number has not come yet.
pub(super) fn may_have(begun: &[u8], length: usize) -> bool {
    match *begun {
        [_, _, _, _, _, _, many, bytes, ..] => HEADER + usize::from(many) * usize::from(bytes) <= length,
        _ => true,
    }
}
