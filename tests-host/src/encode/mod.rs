//! Measurements to RTCM 3, as a receiver would send them: one lump of bytes per epoch.
//!
//! A lump is, in this order: the ephemerides that have become known ([`schedule`]), then the ranges of each system
//! as MSM7 ([`msm`]). The last message of the lump says that it is the last (multiple-message bit 0).
//!
//! | what | message |
//! |---|---|
//! | GPS ephemeris | 1019 |
//! | `BeiDou` ephemeris | 1042 |
//! | Galileo ephemeris F/NAV, I/NAV | 1045, 1046 |
//! | GLONASS ephemeris | 1020 |
//! | QZSS ephemeris | 1044 |
//! | ranges of GPS, GLONASS, Galileo, QZSS, `BeiDou` | 1077, 1087, 1097, 1117, 1127 |
//!
//! References: [RTCM-10403.3] §3.5.16 for MSM, DF002 ff. for the fields, as implemented by the `rtcm-rs` crate.
//!
//! [RTCM-10403.3]: crate#references

mod channels;
mod msm;
mod schedule;
pub mod ubx;

use anyhow::{Context, Result, ensure};
use rai_core::satellite::SatelliteId;
use rtcm_rs::{Message, MessageBuilder};

use self::channels::Channels;
pub use self::msm::Frequency;
use self::schedule::Schedule;
use crate::measurement::{Ephemeris, MeasuredEpoch, TimedEphemeris};

/// The measurements that are sent.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Selection {
    /// Letters of the systems, in the order in which they are sent; each comes once.
    letters: Vec<char>,
    /// One signal per satellite or a pair.
    pub frequency: Frequency,
}

impl Selection {
    /// The letters that a selection may hold, with names.
    const NAMES: &str = "G (GPS), C (BeiDou), E (Galileo), R (GLONASS) or J (QZSS)";

    /// The systems of RINEX letters such as `GCER`.
    ///
    /// # Errors
    /// A letter that is not G, C, E, R or J, or none at all; the message names it.
    pub fn new(letters: &str, frequency: Frequency) -> Result<Self> {
        let mut distinct = Vec::new();
        for letter in letters.chars() {
            let is_known = SatelliteId::from_name(letter, 1).is_some();
            ensure!(is_known, "system `{letter}` of `{letters}` is not {}", Self::NAMES);
            if !distinct.contains(&letter) {
                distinct.push(letter);
            }
        }
        ensure!(!distinct.is_empty(), "no system is selected: name some of {}", Self::NAMES);
        Ok(Self { letters: distinct, frequency })
    }

    /// Returns true if a satellite's system is selected.
    pub fn has(&self, satellite: SatelliteId) -> bool {
        self.letters.contains(&satellite.name().0)
    }
}

/// Turns the epochs of one source into bytes, in the order of time.
pub struct Encoder {
    selection: Selection,
    schedule: Schedule,
    channels: Channels,
    builder: MessageBuilder,
    unsendable: u64,
}

impl Encoder {
    /// An encoder that knows what will be broadcast.
    pub fn new(ephemerides: &[TimedEphemeris], selection: Selection) -> Self {
        let selected = |ephemeris: &&TimedEphemeris| selection.has(ephemeris.satellite);
        let schedule = Schedule::new(ephemerides.iter().filter(selected).cloned());
        let channels = Channels::of(ephemerides);
        Self { selection, schedule, channels, builder: MessageBuilder::new(), unsendable: 0 }
    }

    /// How many signals could not be sent so far: their pseudorange is negative, 255 ms or more, or more than 200 m
    /// away from the satellite's other one, or of a GLONASS satellite whose frequency slot is unknown, which the message
    /// has no numbers for.
    pub fn unsendable(&self) -> u64 {
        self.unsendable
    }

    /// The bytes of an epoch; they hold no ranges, and so end no epoch for the receiver, where nothing is seen.
    ///
    /// # Errors
    /// A number that its message has no room for.
    pub fn epoch(&mut self, epoch: &MeasuredEpoch) -> Result<Vec<u8>> {
        let mut bytes = Vec::new();
        for ephemeris in self.schedule.news(epoch) {
            append(&mut self.builder, &mut bytes, &broadcast(&ephemeris.message))
                .with_context(|| format!("ephemeris of {}", ephemeris.satellite))?;
        }
        let ranges = msm::messages(epoch, &self.selection, &self.channels, &mut self.unsendable);
        for message in ranges {
            append(&mut self.builder, &mut bytes, &message).context("ranges")?;
        }
        Ok(bytes)
    }
}

/// The message of an ephemeris.
fn broadcast(ephemeris: &Ephemeris) -> Message {
    match ephemeris {
        Ephemeris::Gps(message) => Message::Msg1019(message.clone()),
        Ephemeris::Beidou(message) => Message::Msg1042(message.clone()),
        Ephemeris::GalileoFnav(message) => Message::Msg1045(message.clone()),
        Ephemeris::GalileoInav(message) => Message::Msg1046(message.clone()),
        Ephemeris::Glonass(message) => Message::Msg1020(message.clone()),
        Ephemeris::Qzss(message) => Message::Msg1044(message.clone()),
    }
}

/// Checks that the message of an ephemeris has room for all of its numbers.
///
/// # Errors
/// A number that its field has no room for.
pub(crate) fn check(ephemeris: &TimedEphemeris) -> Result<()> {
    append(&mut MessageBuilder::new(), &mut Vec::new(), &broadcast(&ephemeris.message))
}

fn append(builder: &mut MessageBuilder, bytes: &mut Vec<u8>, message: &Message) -> Result<()> {
    let built = builder.build_message(message);
    let number = message.number().unwrap_or(0);
    bytes.extend_from_slice(
        built.map_err(|error| anyhow::anyhow!("message {number} cannot be built: {error:?}"))?,
    );
    Ok(())
}
