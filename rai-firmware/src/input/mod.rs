//! Bytes of the GNSS port to events: frames, messages, epochs.
//!
//! ```text
//! bytes ──► framer ──frame──► rtcm, ubx, sbf ──Message──► assembly ──► Event::Epoch
//!           checked once      read once                   └─────────► Event::Ephemeris, Event::Position
//! ```
//!
//! | module | content |
//! |---|---|
//! | `protocol` | interface to a wire format |
//! | `framer` | finds frames of all formats in the stream, and checks each once |
//! | `rtcm` | reads the messages of RTCM 3 |
//! | [`ubx`] | reads the messages of u-blox receivers |
//! | `sbf` | reads the blocks of Septentrio receivers |
//! | `navigation` | reads the navigation bits of satellites, whatever format brings them |
//! | `bits` | fields of navigation messages |
//! | `elements` | places of the orbital elements in each message |
//! | `preference` | choice between sources of ranges |
//! | `assembly` | joins the messages of one instant to one epoch; systems whose tag contradicts, receivers that take turns |
//! | `message` | what a frame says, or why it says nothing |
//! | `event` | what [`Input`] passes on |
//! | `suspicion` | a receiver's reports of jamming and spoofing |
//! | `system` | satellite numbers of each system |
//! | `calendar` | the present week, time that only goes forward, and GPS time minus UTC |
//! | [`Counters`] | counters of received and unused input |
//!
//! Code behind [`Message`] is independent of the wire format. A new format is a folder next to
//! `rtcm`, with a type that implements `protocol::Protocol`. It also needs a row in the table of
//! formats in this file.
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
//!     Event::SelfReport(report) => drop(report),
//!     Event::Rivalry(rivalry) => drop(rivalry),
//!     _ => {}
//! });
//! ```
//!
//! All input is hostile. Unused input increments one of the [`Counters`], and the state stays
//! valid.

mod assembly;
pub(crate) mod bits;
mod calendar;
mod counters;
mod crc24q;
mod elements;
mod event;
mod framer;
mod message;
#[cfg(feature = "ubx")]
mod navigation;
mod preference;
mod protocol;
mod rtcm;
#[cfg(feature = "sbf")]
mod sbf;
mod suspicion;
mod system;
#[cfg(test)]
mod toy;
#[cfg(feature = "ubx")]
pub mod ubx;

use raim_core::frame::Ecef;
use raim_core::satellite::{Constellation, SatelliteId};

use crate::counters::count;
#[cfg(feature = "osnma")]
use crate::ephemeris::Source as MessageSource;
use crate::ephemeris::{BroadcastError, Ephemeris, Origin};
#[cfg(feature = "osnma")]
use crate::osnma::{Authentication, Seal};
use crate::raw::RawSignal;
use crate::time::GpsTime;

use assembly::Assembly;
use calendar::Calendar;
use framer::Framer;
use message::{Message, Ranges, Series, Unread};
use preference::{Preference, Source};
use protocol::{Extent, Frame, Measurements, Protocol, formats};

#[cfg(feature = "osnma")]
pub(crate) use calendar::begins_half_year;
pub use calendar::{LeapSecond, LeapSource, NOT_BEFORE_WEEK};
pub use counters::Counters;
pub use event::{Event, Rivalry};
pub use suspicion::{Jamming, LoggedEvents, ReceiverLevels, Reporter, SelfReport, Suspicion, Suspicions};

// One row for each wire format.
formats! {
    rtcm::Rtcm,
    #[cfg(feature = "ubx")]
    ubx::Ubx,
    #[cfg(feature = "sbf")]
    sbf::Sbf,
    #[cfg(test)]
    toy::Toy,
}

/// Input of the GNSS port.
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
    /// Returns an input before the first byte.
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub fn new() -> Self {
        Self {
            framer: Framer::new(),
            calendar: Calendar::new(),
            assembly: Assembly::new(),
            memory: Memory::new(),
            preference: Preference::new(),
            counters: Counters::NONE,
        }
    }

    /// Takes bytes that came at an instant, and passes the events that they complete to `tell`, in
    /// order.
    pub fn feed(&mut self, bytes: &[u8], came_ms: u64, mut tell: impl FnMut(Event<'_>)) {
        let mut rest = bytes;
        while !rest.is_empty() {
            rest = self.framer.take(rest, came_ms, &mut self.counters);
            if self.framer.is_worth_a_look() {
                self.drain(false, &mut tell);
            }
        }
    }

    /// Ends incomplete frames, because the line has been silent for longer than any gap inside a
    /// frame.
    ///
    /// A cut frame may announce more bytes than its burst has left. It would delay the good frames
    /// behind it until the next burst.
    pub fn silence(&mut self, mut tell: impl FnMut(Event<'_>)) {
        self.drain(true, &mut tell);
    }

    /// Completes an epoch whose end only one system has stated. Earlier statements of that system
    /// were wrong. The pause of the line confirms this one, because it is longer than any gap
    /// inside a burst.
    pub fn pause(&mut self, mut tell: impl FnMut(Event<'_>)) {
        self.assembly.pause(&mut self.counters, &mut tell);
    }

    /// Completes the open epoch, if it has ranges, because the line has been silent for longer than
    /// any pause inside an epoch.
    ///
    /// Some casters announce in every message that more follow. If the next epoch comes only after
    /// the time to alert, its first message would complete this one too late. A slow line that is
    /// busy until the next epoch is never silent. There the next epoch completes this one early
    /// enough.
    pub fn end_epoch(&mut self, mut tell: impl FnMut(Event<'_>)) {
        self.assembly.silence(&mut self.counters, &mut tell);
    }

    /// Returns true if an epoch is open.
    pub fn has_open_epoch(&self) -> bool {
        self.assembly.is_open()
    }

    /// Returns true if no byte may belong to a frame that is not complete.
    pub(crate) fn is_between_frames(&self) -> bool {
        self.framer.is_empty()
    }

    /// Discards incomplete frames and the open epoch, because bytes were lost. The next message and
    /// all others of its instant are also dropped.
    pub fn interrupt(&mut self) {
        self.framer.forget(&mut self.counters);
        self.assembly.interrupt(&mut self.counters);
    }

    /// Confirms an epoch that came at `came_ms`: its ranges agreed with orbits, so that its time
    /// and week are right and its source is the receiver.
    pub fn confirm(&mut self, time: GpsTime, came_ms: u64) {
        self.calendar.confirm(time, came_ms);
        self.preference.settle();
    }

    /// Takes the full GPS week of the next epoch from a trusted source, such as the date of a
    /// recording. The week also selects the cycle of 1024 GPS weeks.
    pub fn assume(&mut self, week: u16) {
        self.calendar.assume(week);
    }

    /// Discards every confirmation, because the next bytes may come from another receiver and
    /// another time.
    pub fn forget(&mut self) {
        self.calendar.forget();
        self.preference = Preference::new();
    }

    /// Returns true if the source that was confirmed as the receiver is missing, and epochs of
    /// another source arrive. The other source may be another receiver, or the same one after a
    /// change of format or station number.
    pub fn hears_others(&self) -> bool {
        self.preference.hears_others()
    }

    /// Returns the authentication of Galileo's words.
    #[cfg(feature = "osnma")]
    pub(crate) const fn authentication(&self) -> &Authentication {
        &self.memory.shared.navigation.authentication
    }

    /// Returns the same, to work on.
    #[cfg(feature = "osnma")]
    pub(crate) const fn authentication_mut(&mut self) -> &mut Authentication {
        &mut self.memory.shared.navigation.authentication
    }

    /// Returns the counters of received and unused input.
    pub fn counters(&self) -> &Counters {
        &self.counters
    }

    /// Returns the time of the last accepted epoch.
    pub fn time(&self) -> Option<GpsTime> {
        self.calendar.time()
    }

    /// Returns GPS time minus UTC, with its source and time; `None` until it is known.
    pub fn leap_second(&self) -> Option<LeapSecond> {
        self.calendar.leap_second()
    }

    // `read` and `learn` are not inlined, because this stack frame still exists while an epoch is
    // judged.
    fn drain(&mut self, is_silent: bool, tell: &mut dyn FnMut(Event<'_>)) {
        let Self { framer, calendar, assembly, memory, preference, counters } = self;
        while let Some((format, frame)) = framer.next(is_silent, counters) {
            let origin = if format == Format::Rtcm { Origin::Relayed } else { Origin::Bits };
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
                    #[cfg(feature = "osnma")]
                    let seal = match (origin, broadcast.source) {
                        (Origin::Bits, MessageSource::GalileoInav) => {
                            memory.shared.navigation.authentication.seal_of(broadcast.satellite.number())
                        }
                        _ => Seal::default(),
                    };
                    let read = || {
                        let ephemeris = Ephemeris::new(&broadcast);
                        #[cfg(feature = "osnma")]
                        let ephemeris = ephemeris.map(|ephemeris| ephemeris.sealed(seal));
                        ephemeris
                    };
                    learn(&read, origin, calendar, assembly, counters, tell);
                }
                #[cfg(feature = "glonass")]
                Some(Message::State(state)) => {
                    learn(&|| Ephemeris::of_state(&state), origin, calendar, assembly, counters, tell);
                }
                #[cfg(feature = "sbf")]
                Some(Message::Decoded(broadcast)) => {
                    let origin = Origin::Decoded;
                    learn(&|| Ephemeris::new(&broadcast), origin, calendar, assembly, counters, tell);
                }
                #[cfg(all(feature = "sbf", feature = "glonass"))]
                Some(Message::DecodedState(state)) => {
                    let origin = Origin::Decoded;
                    learn(&|| Ephemeris::of_state(&state), origin, calendar, assembly, counters, tell);
                }
                #[cfg(feature = "glonass")]
                Some(Message::Time(time, leap_s)) => calendar.hear_receiver(time, Some(leap_s), counters),
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
                #[cfg(feature = "cnav")]
                Some(Message::Cnav(frame)) => tell(Event::Cnav(frame)),
                #[cfg(feature = "ubx")]
                Some(Message::SelfReport(report)) => tell(Event::SelfReport(report)),
                None => {}
            }
        }
    }
}

/// Returns the position of the station in a single RTCM frame, which is checked and read as in a
/// stream.
pub(crate) fn station(frame: &[u8]) -> Option<Ecef> {
    let frame = protocol::whole::<rtcm::Rtcm>(frame)?;
    match rtcm::Rtcm::read_alone(&frame, &Calendar::new()) {
        Ok(Some(Message::Position(point))) => Some(point),
        _ => None,
    }
}

/// Reads a frame. Counts a frame that leads to no message.
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

/// Checks the message of a satellite, and reports its ephemeris.
// Not inlined, so that the ephemeris leaves the stack before an epoch is judged. One copy serves
// both kinds of messages.
#[inline(never)]
fn learn(
    ephemeris: &dyn Fn() -> Result<Ephemeris, BroadcastError>,
    origin: Origin,
    calendar: &mut Calendar,
    assembly: &mut Assembly,
    counters: &mut Counters,
    tell: &mut dyn FnMut(Event<'_>),
) {
    let Ok(ephemeris) = ephemeris() else {
        return count(&mut counters.ephemerides_invalid);
    };
    let mut ephemeris = ephemeris.of(origin);
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
