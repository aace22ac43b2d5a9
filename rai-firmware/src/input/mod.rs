//! Bytes of the GNSS port to events: frames, messages, epochs.
//!
//! ```text
//! bytes ──► framer ──frame──► rtcm, ubx ──Message──► assembly ──► Event::Epoch
//!           checked once      read once              └─────────► Event::Ephemeris, Event::Position
//! ```
//!
//! | module | what |
//! |---|---|
//! | `protocol` | interface to a wire format, and the table of them |
//! | `framer` | finds frames of all formats in the stream, and checks each once |
//! | `rtcm` | reads the messages of RTCM 3 |
//! | [`ubx`] | reads those of u-blox receivers, and the navigation bits in them |
//! | `bits` | fields of navigation messages |
//! | `elements` | where each message has its orbital elements |
//! | `preference` | whose ranges are used where several send some |
//! | `assembly` | messages of one instant become one epoch |
//! | `epoch_ranges` | the ranges of one epoch |
//! | `turns` | two receivers that take turns on one line |
//! | `suspicion` | what a receiver says of jamming and spoofing |
//! | `system` | how each system numbers its satellites |
//! | `calendar`, `message_week`, `present_week`, `roll_over`, `week_votes` | the week of the present; time goes forward |
//! | `leap_seconds` | how far UTC is behind |
//! | [`Counters`] | what came in and what was not used |
//!
//! Behind [`Message`] no wire format is known. A new one is a module beside `rtcm` with a type that implements
//! `protocol::Protocol`, and a row for it in the table of formats in this file.
//!
//! ```
//! # use raim_firmware::input::{Event, Input};
//! # let (bytes, now_ms) = ([0xD3_u8, 0, 0], 0);
//! let mut input = Input::new();
//! input.feed(&bytes, now_ms, |event| match event {
//!     Event::Epoch(raw, came_ms) => drop((raw.time, came_ms)),
//!     Event::Ephemeris(ephemeris) => drop(ephemeris.satellite()),
//!     Event::Redated(present) => drop(present.week),
//!     Event::Position(point) => drop(point.radius_m()),
//!     Event::Ionosphere(constellation, coefficients) => drop((constellation, coefficients)),
//!     Event::Jamming(jamming) => drop(jamming.spoofing),
//!     Event::Rivalry(rivalry) => drop(rivalry),
//! });
//! ```
//!
//! All input is hostile. Whatever is not used increments one of the [`Counters`]; the state survives.

mod assembly;
mod bits;
mod calendar;
mod counters;
mod elements;
mod epoch_ranges;
mod framer;
mod leap_seconds;
mod message_week;
mod preference;
mod present_week;
mod protocol;
mod roll_over;
mod rtcm;
mod suspicion;
mod system;
#[cfg(test)]
mod toy;
mod turns;
#[cfg(feature = "ubx")]
pub mod ubx;
mod week_votes;

use raim_core::frame::Ecef;
use raim_core::satellite::{Constellation, SatelliteId};

use crate::counters::count;
#[cfg(feature = "glonass")]
use crate::ephemeris::StateBroadcast;
use crate::ephemeris::{Broadcast, BroadcastError, Ephemeris};
use crate::raw::{RawEpoch, RawSignal};
use crate::time::GpsTime;

use assembly::Assembly;
use calendar::Calendar;
use framer::Framer;
use preference::{Preference, Source};
use protocol::{Extent, Frame, Measurements, Protocol, formats};

pub use counters::Counters;
pub use leap_seconds::{LeapSecond, LeapSource};
pub use message_week::NOT_BEFORE_WEEK;
pub use suspicion::{Jamming, Suspicion, Suspicions};

/// What the bytes said.
#[derive(Debug)]
pub enum Event<'a> {
    /// All observations of one instant, and when its first byte came, in ms.
    Epoch(&'a RawEpoch, u64),
    /// A checked ephemeris.
    Ephemeris(Ephemeris),
    /// The present, whose week was named or moved only now: sets told before are dated a week off where the instant nearest to
    /// it says so ([`crate::ephemeris::Store::redate`]).
    Redated(GpsTime),
    /// Where a station says it is: a first guess.
    Position(Ecef),
    /// Coefficients of the ionosphere as the satellites of GPS or `BeiDou` broadcast them, each for its own model,
    /// `α0…α3, β0…β3`.
    Ionosphere(Constellation, [f64; 8]),
    /// What the receiver says of jamming and spoofing.
    Jamming(Jamming),
    /// Evidence that the ranges of the next epoch are not all of one antenna at one instant.
    Rivalry(Rivalry),
}

/// Evidence against the ranges of an epoch, known before it is judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rivalry {
    /// Two receivers share the line: a range came twice, and the second is another.
    Receivers,
    /// The same, within the epoch that is judged next: one message may be forged, and the next epoch right.
    Joined,
    /// Two receivers may share the line: the ranges moved to and fro once.
    Suspected,
    /// One instant came as two epochs, of other systems each: the tag of one is wrong.
    Halves,
}

/// What one message says, whatever format it came in.
#[derive(Debug)]
enum Message<'a> {
    /// Ranges of one instant, or of a part of it.
    Ranges(Ranges<'a>),
    /// An orbit and a clock, not yet judged.
    Broadcast(Broadcast),
    /// A position, a velocity and a clock, not yet judged.
    #[cfg(feature = "glonass")]
    State(StateBroadcast),
    /// Where a station says it is.
    Position(Ecef),
    /// Coefficients of the ionosphere and whose they are, and GPS time minus UTC in seconds.
    #[cfg(feature = "ubx")]
    Corrections(Option<(Constellation, [f64; 8])>, Option<u8>),
    /// What the receiver says of jamming and spoofing.
    #[cfg(feature = "ubx")]
    Jamming(Jamming),
}

/// A message of ranges.
#[derive(Debug)]
struct Ranges<'a> {
    /// Number of the station that they are of, 0 where the format has none.
    station: u16,
    /// The system that the message is of; `None` where it speaks for all.
    series: Option<Series>,
    /// Milliseconds into the week of GPS time; `None` where the format's own time cannot be told as such.
    tow_ms: Option<u32>,
    /// Milliseconds into the week of UTC, where the format counts so.
    of_utc_ms: Option<u32>,
    /// The same with its week, and GPS time minus UTC, where the format says them.
    stated: Option<(GpsTime, Option<u8>)>,
    /// Whether it says that more of the same instant follows.
    more_follow: bool,
    measured: Measured<'a>,
}

/// A series of messages that says for itself whether more follow: a number that stays the same, below 16.
type Series = u8;

// One row for each wire format.
formats! {
    rtcm::Rtcm,
    #[cfg(feature = "ubx")]
    ubx::Ubx,
    #[cfg(test)]
    toy::Toy,
}

/// The GNSS port's way in.
#[derive(Debug)]
pub struct Input {
    framer: Framer,
    calendar: Calendar,
    assembly: Assembly,
    memory: Memory,
    preference: Preference,
    counters: Counters,
}

impl Default for Input {
    fn default() -> Self {
        Self::new()
    }
}

impl Input {
    /// A way in through which nothing has come.
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub const fn new() -> Self {
        Self {
            framer: Framer::new(),
            calendar: Calendar::new(),
            assembly: Assembly::new(),
            memory: Memory::new(),
            preference: Preference::new(),
            counters: Counters::NONE,
        }
    }

    /// Takes bytes that came at an instant, and tells what they complete, in order.
    pub fn feed(&mut self, bytes: &[u8], came_ms: u64, mut tell: impl FnMut(Event<'_>)) {
        let mut rest = bytes;
        while !rest.is_empty() {
            rest = self.framer.take(rest, came_ms, &mut self.counters);
            if self.framer.is_worth_a_look() {
                self.drain(false, &mut tell);
            }
        }
    }

    /// The line has been silent for longer than a gap inside a frame can be: what is incomplete stays incomplete.
    ///
    /// A cut frame may announce more bytes than are left of the burst it came in, and would hold back the good frames
    /// behind it until the next burst.
    pub fn silence(&mut self, mut tell: impl FnMut(Event<'_>)) {
        self.drain(true, &mut tell);
    }

    /// The line pauses, for longer than between two messages of one burst: an epoch is complete whose end was said by a
    /// system that has said so wrongly before.
    pub fn pause(&mut self, mut tell: impl FnMut(Event<'_>)) {
        self.assembly.pause(&mut self.counters, &mut tell);
    }

    /// Bytes were lost: what is under way is dropped, and so is what is left of the next epoch.
    pub fn interrupt(&mut self) {
        self.framer.forget(&mut self.counters);
        self.assembly.interrupt(&mut self.counters);
    }

    /// The ranges of an epoch that came at `came_ms` agreed with orbits: its time is right, in its week, and its source is the
    /// receiver.
    pub fn confirm(&mut self, time: GpsTime, came_ms: u64) {
        self.calendar.confirm(time, came_ms);
        self.preference.settle();
    }

    /// Takes the GPS week of the next epoch, not rolled over, from a source that is to be believed: the date of a recording. It
    /// also chooses the cycle of GPS weeks.
    pub fn assume(&mut self, week: u16) {
        self.calendar.assume(week);
    }

    /// Nothing that was confirmed is so any more: what comes next may be of another receiver, and another time.
    pub fn forget(&mut self) {
        self.calendar.forget();
        self.preference = Preference::new();
    }

    /// Returns true if epochs of other sources come since the settled one is missing: a receiver that returned with another station
    /// number or format, or somebody else on its line.
    pub fn hears_others(&self) -> bool {
        self.preference.hears_others()
    }

    /// What came in and what was not used.
    pub fn counters(&self) -> &Counters {
        &self.counters
    }

    /// The time of the last epoch that was accepted.
    pub fn time(&self) -> Option<GpsTime> {
        self.calendar.time()
    }

    /// GPS time minus UTC, who said so and when; none until somebody has.
    pub fn leap_second(&self) -> Option<LeapSecond> {
        self.calendar.leap_second()
    }

    // What reads a message and what learns from one are not inlined: an epoch is told of, and judged, below this frame.
    fn drain(&mut self, is_silent: bool, tell: &mut dyn FnMut(Event<'_>)) {
        let Self { framer, calendar, assembly, memory, preference, counters } = self;
        while let Some((format, frame)) = framer.next(is_silent, counters) {
            match read(format, &frame, memory, calendar, counters) {
                Some(Message::Ranges(ranges)) => {
                    let source = Source { format, station: ranges.station };
                    if preference.takes(source, ranges.tow_ms, ranges.measured.is_empty()) {
                        assembly.take(&ranges, frame.came_ms, calendar, counters, tell);
                    } else {
                        count(&mut counters.observations_doubled);
                    }
                }
                Some(Message::Broadcast(broadcast)) => {
                    learn(|| Ephemeris::new(&broadcast), calendar, assembly, counters, tell);
                }
                #[cfg(feature = "glonass")]
                Some(Message::State(state)) => {
                    learn(|| Ephemeris::of_state(&state), calendar, assembly, counters, tell);
                }
                Some(Message::Position(point)) => tell(Event::Position(point)),
                #[cfg(feature = "ubx")]
                Some(Message::Corrections(coefficients, leap_s)) => {
                    if let Some(leap_s) = leap_s {
                        calendar.hear_leap(leap_s, LeapSource::Satellites);
                    }
                    if let Some((constellation, coefficients)) = coefficients {
                        tell(Event::Ionosphere(constellation, coefficients));
                    }
                }
                #[cfg(feature = "ubx")]
                Some(Message::Jamming(jamming)) => tell(Event::Jamming(jamming)),
                None => {}
            }
        }
    }
}

/// Returns the position of the station that a single RTCM frame contains: checked and read as in a stream, without the
/// memory of one.
pub(crate) fn station(frame: &[u8]) -> Option<Ecef> {
    let frame = protocol::whole::<rtcm::Rtcm>(frame)?;
    match rtcm::Rtcm::read(&frame, &mut (), &Calendar::new(), &mut Counters::NONE.clone()) {
        Ok(Some(Message::Position(point))) => Some(point),
        _ => None,
    }
}

/// Reads a frame; one that leads to nothing is counted.
#[inline(never)]
fn read<'a>(
    format: Format,
    frame: &Frame<'a>,
    memory: &mut Memory,
    calendar: &Calendar,
    counters: &mut Counters,
) -> Option<Message<'a>> {
    match format.read(frame, memory, calendar, counters) {
        Ok(message) => message,
        Err(reason) => {
            count(reason.counter(counters));
            None
        }
    }
}

/// Why a frame leads to no message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Unread {
    /// Its type is not read.
    Other,
    /// It is too short for its type, or contradicts itself.
    Malformed,
    /// A time of week that is none.
    Time,
    /// An ephemeris with a number or a time that no satellite has.
    Ephemeris,
    /// A position that is none of a receiver.
    Position,
    /// The receiver does not know the week yet.
    WithoutWeek,
    /// A satellite number that the system does not have.
    Satellite,
    /// GLONASS, before anything has said how many leap seconds there are.
    LeapUnknown,
    /// Navigation bits of a signal that is not read.
    BitsOther,
    /// Navigation bits that are none: wrong number of words, preamble or flags.
    BitsMalformed,
    /// Navigation bits with a wrong parity or CRC.
    BitsParity,
    /// A set of navigation bits whose pages are of different issues.
    BitsMixed,
    /// Navigation bits for which no set is free.
    BitsSurplus,
}

impl Unread {
    fn counter(self, counters: &mut Counters) -> &mut u32 {
        match self {
            Self::Other => &mut counters.messages_other,
            Self::Malformed => &mut counters.messages_malformed,
            Self::Time => &mut counters.times_out_of_range,
            Self::Ephemeris => &mut counters.ephemerides_invalid,
            Self::Position => &mut counters.positions_invalid,
            Self::WithoutWeek => &mut counters.epochs_without_week,
            Self::Satellite => &mut counters.satellites_unknown,
            Self::LeapUnknown => &mut counters.leap_unknown,
            Self::BitsOther => &mut counters.subframes_other,
            Self::BitsMalformed => &mut counters.subframes_malformed,
            Self::BitsParity => &mut counters.subframes_parity,
            Self::BitsMixed => &mut counters.subframes_mixed,
            Self::BitsSurplus => &mut counters.subframes_surplus,
        }
    }
}

/// Judges what a satellite says of itself, and takes it.
// Not inlined: the ephemeris is on this frame, and not on the one below which an epoch is judged.
#[inline(never)]
fn learn(
    ephemeris: impl FnOnce() -> Result<Ephemeris, BroadcastError>,
    calendar: &mut Calendar,
    assembly: &mut Assembly,
    counters: &mut Counters,
    tell: &mut dyn FnMut(Event<'_>),
) {
    let Ok(mut ephemeris) = ephemeris() else {
        return count(&mut counters.ephemerides_invalid);
    };
    count(&mut counters.ephemerides);
    ephemeris.date(calendar.learn(constellation(&ephemeris), ephemeris.toe(), counters));
    if let Some(present) = calendar.take_redating() {
        assembly.redate(present);
        tell(Event::Redated(present));
    }
    tell(Event::Ephemeris(ephemeris));
}

fn constellation(ephemeris: &Ephemeris) -> Constellation {
    ephemeris.satellite().constellation()
}
