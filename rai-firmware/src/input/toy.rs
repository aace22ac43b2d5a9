//! A wire format of the tests, which shows that a format is one file and one row of the table.
//!
//! ```text
//! AA 55 | number of satellites | week u16 | time of week u32, ms | satellite u8, range f64, each | sum of all before u8
//! ```

use raim_core::satellite::{Constellation, SatelliteId};

use super::calendar::Calendar;
use super::protocol::{Extent, Frame, Measurements, Protocol, Shared};
use super::{Counters, Measured, Message, Ranges, Unread};
use crate::raw::{Band, Carrier, RawSignal};
use crate::time::GpsTime;

const HEADER: usize = 3;
const TIME: usize = 6;
const MEASUREMENT: usize = 9;
const CHECK: usize = 1;

/// The format.
#[derive(Debug)]
pub(super) struct Toy;

/// Ranges of GPS on L1.
#[derive(Debug)]
pub(super) struct ToyRanges<'a>(&'a [u8]);

impl Protocol for Toy {
    const SYNC: &'static [u8] = &[0xAA, 0x55];
    const LONGEST: usize = HEADER + TIME + 255 * MEASUREMENT + CHECK;

    /// Number of frames so far.
    type Memory = u32;

    type Ranges<'a> = ToyRanges<'a>;

    fn at_start() -> u32 {
        0
    }

    fn length(bytes: &[u8]) -> Extent {
        match *bytes {
            [_, _, many, ..] => Extent::Bytes(HEADER + TIME + usize::from(many) * MEASUREMENT + CHECK),
            _ => Extent::Unknown,
        }
    }

    fn check(frame: &[u8]) -> bool {
        frame.split_last().is_some_and(|(sum, before)| *sum == sum_of(before))
    }

    fn read<'a>(
        frame: &Frame<'a>,
        frames: &mut u32,
        _: &mut Shared,
        _: &Calendar,
        _: &mut Counters,
    ) -> Result<Option<Message<'a>>, Unread> {
        *frames += 1;
        let (&time, measurements) =
            frame.between(HEADER, CHECK).split_first_chunk::<TIME>().ok_or(Unread::Malformed)?;
        let [w0, w1, t0, t1, t2, t3] = time;
        let tow_ms = u32::from_le_bytes([t0, t1, t2, t3]);
        let time = GpsTime { week: u16::from_le_bytes([w0, w1]), tow_ms };
        Ok(Some(Message::Ranges(Ranges {
            station: 0,
            series: None,
            tow_ms: Some(tow_ms),
            of_utc_ms: None,
            stated: Some((time, None)),
            more_follow: false,
            #[cfg(feature = "sbf")]
            clock_jumps_ms: None,
            measured: Measured::Toy(ToyRanges(measurements)),
        })))
    }
}

impl Measurements for ToyRanges<'_> {
    fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    fn each(
        &self,
        counters: &mut Counters,
        add: &mut impl FnMut(SatelliteId, RawSignal, bool, &mut Counters),
    ) {
        for measurement in self.0.chunks_exact(MEASUREMENT) {
            let (number, range) = measurement.split_first().expect("a measurement");
            let range_m = f64::from_le_bytes(range.try_into().expect("eight bytes"));
            if let Some(satellite) = SatelliteId::new(Constellation::Gps, *number) {
                add(satellite, RawSignal::new(Carrier::of(Band::L1), range_m), true, counters);
            }
        }
    }
}

fn sum_of(bytes: &[u8]) -> u8 {
    bytes.iter().fold(0, |sum, byte| sum.wrapping_add(*byte))
}

mod tests {
    use std::vec::Vec;

    use super::*;
    use crate::input::{Event, Input};

    fn frame(time: GpsTime, satellites: u8) -> Vec<u8> {
        let mut bytes = [0xAA, 0x55, satellites].to_vec();
        bytes.extend(time.week.to_le_bytes());
        bytes.extend(time.tow_ms.to_le_bytes());
        for number in 1..=satellites {
            bytes.push(number);
            bytes.extend((2.2e7 + f64::from(number)).to_le_bytes());
        }
        bytes.push(sum_of(&bytes));
        bytes
    }

    /// Satellites of each epoch that these bytes complete.
    fn epochs(input: &mut Input, bytes: &[u8]) -> Vec<usize> {
        let mut epochs = Vec::new();
        for (ms, piece) in bytes.chunks(7).enumerate() {
            input.feed(piece, ms as u64, |event| match event {
                Event::Epoch(raw, _) => epochs.push(raw.satellites.len()),
                event => panic!("{event:?}"),
            });
        }
        epochs
    }

    #[test]
    fn a_format_of_one_file_and_one_row_is_read_beside_the_others() {
        let mut input = Input::new();
        let at = |tow_ms| GpsTime { week: 2400, tow_ms };
        let mut stream = frame(at(1000), 5);
        // Beginnings of the others, a cut frame, a wrong sum.
        stream.extend([0xD3, 0x03, 0xFF]);
        stream.extend(frame(at(2000), 7));
        stream.extend([0xB5, 0x62, 0x02, 0x15, 0x10, 0x14]);
        stream.extend(&frame(at(3000), 20)[..50]);
        stream.extend(frame(at(4000), 9));
        let mut wrong = frame(at(5000), 3);
        *wrong.last_mut().expect("a sum") ^= 1;
        stream.extend(wrong);
        stream.extend(frame(at(6000), 4));
        assert_eq!(epochs(&mut input, &stream), [5, 7, 9, 4]);
        assert_eq!((input.memory.toy, input.counters().frames, input.counters().crc_failures), (4, 4, 1));
    }
}
