//! RTCM 3: bytes in, epochs of raw ranges, ephemerides and a reference position out.
//!
//! ```text
//! byte ──► Framer ──frame──► Decoder ──► Event::Epoch(&RawEpoch) | Ephemeris(..) | ReferencePosition(..)
//!          CRC, resync        messages, week, assembly
//! ```
//!
//! One byte can complete several events (a bad frame may hide good ones; a message of a new epoch closes the last
//! one and may be complete itself), so a caller drains:
//!
//! ```
//! # use rai_firmware::rtcm::{Decoder, Event};
//! # let (mut decoder, bytes) = (Decoder::new(), [0xD3_u8, 0, 0]);
//! for byte in bytes {
//!     let mut event = decoder.push(byte);
//!     while let Some(Event::Epoch(_) | Event::Ephemeris(_) | Event::ReferencePosition(_)) = event {
//!         event = decoder.pending();
//!     }
//! }
//! ```
//!
//! What is read: MSM4 to MSM7 of GPS, Galileo and `BeiDou`; 1019, 1042, 1045, 1046; 1005 and 1006. MSM of the other
//! systems are counted, and still say when an epoch is complete. Everything else is counted.
//!
//! All input is hostile. Whatever is not used increments one of the [`Counters`]; the decoder's state survives.
//!
//! References: [RTCM-10403.3] 3.5.16 (MSM), 4 (transport layer).

mod assembly;
mod broadcast;
mod calendar;
mod framer;
mod msm;

use rai_core::frame::Ecef;
use rtcm_rs::{Message, MessageFrame};

use crate::counters::{count, counters};
use crate::ephemeris::Ephemeris;
use crate::time::GpsTime;

use assembly::{Admission, Assembly};
use calendar::Calendar;
use framer::Framer;
use msm::Header;

pub use assembly::{EPOCH_CAPACITY, RawEpoch, RawSatellite, SIGNAL_CAPACITY};
pub use calendar::NOT_BEFORE_WEEK;

counters! {
    /// What came in and what was not used, by reason.
    Counters {
        /// Frames with a right CRC.
        frames,
        /// Bytes that belong to no good frame.
        bytes_skipped,
        /// Frames whose CRC was wrong.
        crc_failures,
        /// Frames that had not ended when the line fell silent.
        frames_cut,
        /// Messages of a type that is not read.
        messages_other,
        /// Observations of systems that are not used: GLONASS, SBAS, QZSS, `NavIC`.
        observations_other,
        /// Messages too short for their type, or that contradict themselves.
        messages_malformed,
        /// Ephemerides decoded.
        ephemerides,
        /// Ephemerides with a value that no satellite sends.
        ephemerides_invalid,
        /// Reference positions far from the surface of the earth.
        positions_invalid,
        /// Epochs handed on.
        epochs,
        /// Epochs dropped because no ephemeris has told the week yet.
        epochs_without_week,
        /// Epochs dropped because they are not newer than the last one.
        epochs_backwards,
        /// Times that went back and were accepted because they went on from there.
        time_restarts,
        /// Weeks corrected because the ephemerides agreed on another one.
        week_corrections,
        /// Observations dropped because their time of week is none.
        times_out_of_range,
        /// Satellites that came twice in one epoch; the first is used.
        satellites_duplicate,
        /// Satellites with a number that their system does not have.
        satellites_unknown,
        /// Satellites beyond the capacity of an epoch.
        satellites_surplus,
        /// Signals on bands that are not used.
        signals_other,
        /// Signals beyond what is kept of one satellite, or a second code on the same band.
        signals_surplus,
        /// Signals without a range.
        ranges_missing,
        /// Ranges that no satellite can have.
        ranges_out_of_bounds,
    }
}

/// What the bytes said.
#[derive(Debug)]
pub enum Event<'a> {
    /// All observations of one instant.
    Epoch(&'a RawEpoch),
    /// A checked ephemeris.
    Ephemeris(Ephemeris),
    /// Where the station says it is: a first guess.
    ReferencePosition(Ecef),
}

/// What one frame led to.
enum Step {
    /// Nothing to tell; the frame is done with.
    Done,
    /// The open epoch is complete; the frame is done with.
    Complete,
    /// The open epoch is complete because this frame belongs to another; read it again.
    CompleteBefore,
    Ephemeris(Ephemeris),
    Position(Ecef),
}

/// The decoder: about 5 KiB, of which 3.6 KiB are the epoch.
#[derive(Debug)]
pub struct Decoder {
    framer: Framer,
    calendar: Calendar,
    assembly: Assembly,
    counters: Counters,
}

impl Default for Decoder {
    fn default() -> Self {
        Self::new()
    }
}

impl Decoder {
    /// A decoder that has seen nothing.
    pub fn new() -> Self {
        Self {
            framer: Framer::new(),
            calendar: Calendar::new(),
            assembly: Assembly::new(),
            counters: Counters::default(),
        }
    }

    /// Takes one byte. Call [`Decoder::pending`] until it returns `None` before the next one.
    pub fn push(&mut self, byte: u8) -> Option<Event<'_>> {
        self.framer.push(byte, &mut self.counters);
        self.pending()
    }

    /// The next event of the bytes that are here already.
    pub fn pending(&mut self) -> Option<Event<'_>> {
        self.assembly.retire();
        // Each pass removes a frame from the buffer or leaves.
        let step = loop {
            let frame = self.framer.frame(&mut self.counters)?;
            let step = read(frame, &mut self.calendar, &mut self.assembly, &mut self.counters);
            if !matches!(step, Step::CompleteBefore) {
                count(&mut self.counters.frames);
                self.framer.consume();
            }
            if !matches!(step, Step::Done) {
                break step;
            }
        };
        Some(match step {
            Step::Ephemeris(ephemeris) => Event::Ephemeris(ephemeris),
            Step::Position(position) => Event::ReferencePosition(position),
            Step::Done | Step::Complete | Step::CompleteBefore => {
                count(&mut self.counters.epochs);
                Event::Epoch(self.assembly.complete())
            }
        })
    }

    /// The line has been silent for longer than a gap inside a frame can be: what is incomplete stays incomplete.
    ///
    /// A cut frame may announce more bytes than are left of the burst it came in, and would hold back the good
    /// frames behind it until the next burst. Call it until it returns `None`.
    pub fn silence(&mut self) -> Option<Event<'_>> {
        self.framer.give_up(&mut self.counters);
        self.pending()
    }

    /// Whether no byte waits for a frame to be complete.
    pub fn is_between_frames(&self) -> bool {
        self.framer.is_empty()
    }

    /// Whether an epoch has begun that is not complete.
    pub fn is_within_epoch(&self) -> bool {
        self.assembly.is_open()
    }

    /// What came in and what was not used.
    pub fn counters(&self) -> &Counters {
        &self.counters
    }

    /// The time of the last epoch that was accepted.
    pub fn time(&self) -> Option<GpsTime> {
        self.calendar.time()
    }
}

/// Reads one frame whose CRC is right.
fn read(frame: &[u8], calendar: &mut Calendar, assembly: &mut Assembly, counters: &mut Counters) -> Step {
    match message_number(frame) {
        Some(1005 | 1006) => read_position(frame, counters),
        Some(1019 | 1042 | 1045 | 1046) => read_ephemeris(frame, calendar, counters),
        Some(number) => match Header::read(number, frame) {
            Some(Ok(header)) => read_observations(header, frame, calendar, assembly, counters),
            Some(Err(_)) => refuse(&mut counters.messages_malformed),
            None => refuse(&mut counters.messages_other),
        },
        None => refuse(&mut counters.messages_malformed),
    }
}

/// Counts a frame that leads to nothing.
fn refuse(reason: &mut u32) -> Step {
    count(reason);
    Step::Done
}

/// The message number: the first twelve bits of the payload.
fn message_number(frame: &[u8]) -> Option<u16> {
    let payload = framer::payload(frame)?;
    let [high, low] = *payload.first_chunk::<2>()?;
    Some(u16::from(high) << 4 | u16::from(low) >> 4)
}

/// The decoded message, by value: small while only the small messages are compiled in.
fn decode(frame: &[u8]) -> Message {
    MessageFrame::new(frame).map_or(Message::Empty, |frame| frame.get_message())
}

#[inline(never)]
fn read_position(frame: &[u8], counters: &mut Counters) -> Step {
    let position = match decode(frame) {
        Message::Msg1005(m) => Ecef::new(
            m.antenna_ref_point_ecef_x_m,
            m.antenna_ref_point_ecef_y_m,
            m.antenna_ref_point_ecef_z_m,
        ),
        Message::Msg1006(m) => Ecef::new(
            m.antenna_ref_point_ecef_x_m,
            m.antenna_ref_point_ecef_y_m,
            m.antenna_ref_point_ecef_z_m,
        ),
        _ => return refuse(&mut counters.messages_malformed),
    };
    // From the deepest sea to an aircraft, with room: farther out it is no receiver's place.
    if (6.3e6..=6.5e6).contains(&position.radius_m()) {
        Step::Position(position)
    } else {
        refuse(&mut counters.positions_invalid)
    }
}

#[inline(never)]
fn read_ephemeris(frame: &[u8], calendar: &mut Calendar, counters: &mut Counters) -> Step {
    let broadcast = match broadcast::read(&decode(frame), calendar) {
        Ok(broadcast) => broadcast,
        Err(broadcast::Unreadable::Malformed) => return refuse(&mut counters.messages_malformed),
        Err(broadcast::Unreadable::Satellite) => return refuse(&mut counters.ephemerides_invalid),
    };
    match Ephemeris::new(&broadcast) {
        Ok(ephemeris) => {
            count(&mut counters.ephemerides);
            calendar.learn(ephemeris.toe(), counters);
            Step::Ephemeris(ephemeris)
        }
        Err(_) => refuse(&mut counters.ephemerides_invalid),
    }
}

fn read_observations(
    header: Header,
    frame: &[u8],
    calendar: &mut Calendar,
    assembly: &mut Assembly,
    counters: &mut Counters,
) -> Step {
    if header.is_used() {
        let Some(tow_ms) = header.gps_tow_ms() else {
            return refuse(&mut counters.times_out_of_range);
        };
        match assembly.admit(tow_ms, calendar, counters) {
            Admission::OtherEpochFirst => return Step::CompleteBefore,
            Admission::Open => msm::read(header, frame, assembly.epoch_mut(), counters),
            Admission::Dropped => {}
        }
    } else {
        count(&mut counters.observations_other);
    }
    if !header.more_follow && assembly.close() { Step::Complete } else { Step::Done }
}
