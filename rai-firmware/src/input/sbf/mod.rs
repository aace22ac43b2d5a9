//! SBF: ranges that a Septentrio receiver measured, and the navigation bits that it received.
//!
//! ```text
//! 24 40 | CRC-16 | number, revision u16 | length u16 | TOW u32, ms | WNc u16 | …    low byte first
//! ```
//!
//! | block | content |
//! |---|---|
//! | `MeasEpoch` 4027 | ranges of an epoch ([`mod@meas_epoch`]) |
//! | `Meas3Ranges` 4109 | compressed ranges, which are not read; [`Counters::meas3_only`] counts them if `MeasEpoch` is missing |
//! | `GPSRawCA` 4017, `QZSRawL1CA` 4066, `GALRawFNAV` 4022, `GALRawINAV` 4023, `GLORawCA` 4026, `BDSRaw` 4047 | navigation bits ([`raw_bits`]), which [`super::navigation`] reads |
//! | `GPSRawL2C` 4018, `GPSRawL5` 4019, `QZSRawL2C` 4067, `QZSRawL5` 4068 | the same, in builds with `cnav` |
//! | `GEORawL1` 4020 | navigation bits that are only counted |
//! | `GPSNav` 5891, `GALNav` 4002, `BDSNav` 4081, `GLONav` 4004 | ephemerides that the receiver decoded ([`decoded`]) |
//! | `GPSIon` 5893, `BDSIon` 4120, `GPSUtc` 5894, `GALUtc` 4031 | ionosphere and leap seconds that the receiver decoded |
//! | `RFStatus` 4092, `GALAuthStatus` 4245, DOP 4001, `RAIMStatistics` 4011 | the receiver's own judgement ([`judgement`]) |
//!
//! `MeasEpoch` has all signals of its instant, so that the epoch is complete with it, and nothing
//! waits for `EndOfMeas` 5922, which many streams do not have.
//!
//! References: [SBF]; `pysbf2` 1.0.7 and RTKLIB's `septentrio.c` have the same layouts.
//!
//! [SBF]: crate#references

mod block;
mod decoded;
mod judgement;
mod meas_epoch;
mod raw_bits;
mod signals;
mod transport;

use super::calendar::Calendar;
use super::navigation::Navigation;
use super::protocol::Frame;
use super::{Counters, Measured, Message, Ranges, Unread};
use crate::counters::count;
use crate::time::WEEK_MS;

use block::Block;
use judgement::Levels;
use meas_epoch::MeasEpoch;
pub(super) use transport::Sbf;

/// Time without a `MeasEpoch` after which compressed ranges count as the only ones, ms.
const ALONE_MS: u32 = 2_000;

/// Number of compressed epochs after which they count as the only ones.
const ALONE: u8 = 2;

/// State between blocks.
#[derive(Debug)]
pub(super) struct State {
    /// Time of week of the last `MeasEpoch`, or of the first compressed ranges, ms.
    ranges_ms: Option<u32>,
    /// Number of compressed epochs since the last `MeasEpoch`.
    compressed: u8,
    levels: Levels,
}

impl State {
    const fn new() -> Self {
        Self { ranges_ms: None, compressed: 0, levels: Levels::new() }
    }

    /// Counts compressed ranges if no others come.
    fn hear_compressed(&mut self, tow_ms: u32, counters: &mut Counters) {
        let since_ms = self.ranges_ms.get_or_insert(tow_ms);
        let waited_ms = (tow_ms + WEEK_MS).saturating_sub(*since_ms) % WEEK_MS;
        if self.compressed >= ALONE && waited_ms > ALONE_MS {
            count(&mut counters.meas3_only);
        }
        self.compressed = self.compressed.saturating_add(1);
    }
}

/// Reads one frame that passed its check. The result is `None` if the frame is one part of a
/// message whose other parts have not all come.
fn read<'a>(
    frame: &Frame<'a>,
    state: &mut State,
    navigation: &mut Navigation,
    calendar: &Calendar,
    counters: &mut Counters,
) -> Result<Option<Message<'a>>, Unread> {
    let block = Block::of(frame);
    match block.number() {
        4027 => meas_epoch(&block, state, counters).map(Some),
        4109 => {
            state.hear_compressed(block.time()?.tow_ms, counters);
            Err(Unread::Other)
        }
        number @ (4017..=4020 | 4022 | 4023 | 4026 | 4047 | 4066..=4068) => {
            let told = raw_bits::read(number, &block, navigation, frame.came_ms, calendar);
            counters.subframes_abandoned = navigation.abandoned();
            let told = told?;
            count(&mut counters.subframes);
            Ok(told)
        }
        number @ (5891 | 4002 | 4081) => decoded::elements(number, &block).map(Message::Decoded).map(Some),
        #[cfg(feature = "glonass")]
        4004 => decoded::state(&block).map(Message::DecodedState).map(Some),
        number @ (5893 | 4120) => decoded::ionosphere(number, &block).map(Some),
        5894 | 4031 => decoded::leap_seconds(&block, calendar).map(Some),
        4092 => judgement::rf_status(&block).map(Message::SelfReport).map(Some),
        4245 => judgement::authentication(&block).map(Message::SelfReport).map(Some),
        4001 => state.levels.dop(&block, frame.came_ms).map(Message::SelfReport).map(Some),
        4011 => Ok(state.levels.raim(&block, frame.came_ms)?.map(Message::SelfReport)),
        _ => Err(Unread::Other),
    }
}

/// Reads the ranges of an epoch.
fn meas_epoch<'a>(
    block: &Block<'a>,
    state: &mut State,
    counters: &mut Counters,
) -> Result<Message<'a>, Unread> {
    let time = block.time()?;
    (state.ranges_ms, state.compressed) = (Some(time.tow_ms), 0);
    let epoch = MeasEpoch::new(block)?;
    if epoch.is_smoothed() {
        count(&mut counters.codes_smoothed);
    }
    Ok(Message::Ranges(Ranges {
        station: 0,
        series: None,
        tow_ms: Some(time.tow_ms),
        of_utc_ms: None,
        stated: Some((time, None)),
        more_follow: false,
        clock_jumps_ms: Some(epoch.clock_jumps_ms),
        measured: Measured::Sbf(epoch),
    }))
}
