//! Encoder of measurements to RTCM 3, as a receiver would send them: one lump of bytes per epoch.
//!
//! A lump is, in this order: the new ephemerides ([`schedule`]), then the ranges of each system as
//! MSM7 ([`msm`]). The last message of the lump states that it is the last (multiple-message bit
//! 0).
//!
//! | what | message |
//! |---|---|
//! | GPS ephemeris | 1019 |
//! | `BeiDou` ephemeris | 1042 |
//! | Galileo ephemeris F/NAV, I/NAV | 1045, 1046 |
//! | GLONASS ephemeris | 1020 |
//! | date and leap seconds, by a receiver with GLONASS | 1013 |
//! | QZSS ephemeris | 1044 |
//! | ranges of GPS, GLONASS, Galileo, QZSS, `BeiDou` | 1077, 1087, 1097, 1117, 1127 |
//!
//! References: [RTCM-10403.3] §3.5.16 for MSM, DF002 ff. for the fields, as implemented by the
//! `rtcm-rs` crate.
//!
//! [RTCM-10403.3]: crate#references

mod channels;
mod msm;
pub mod sbf;
mod schedule;
pub mod ubx;

use anyhow::{Context, Result, ensure};
use raim_core::satellite::SatelliteId;
use raim_firmware::time::{BEIDOU_OFFSET_MS, BEIDOU_WEEK_OFFSET, GALILEO_WEEK_OFFSET, GpsTime};
use rtcm_rs::msg::{Msg1019T, Msg1042T, Msg1044T, Msg1045T, Msg1046T};
use rtcm_rs::{Message, MessageBuilder};

use self::channels::Channels;
pub use self::msm::Frequency;
use self::schedule::Schedule;
use crate::signal::calendar::leap_seconds;
use crate::signal::checksum::rtcm_frame;
use crate::signal::measurement::{Ephemeris, MeasuredEpoch, TimedEphemeris};

/// Selection of the measurements that are sent.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Selection {
    /// Letters of the systems, in the order in which they are sent, each once.
    letters: Vec<char>,
    /// Number of signals of a satellite: one, or a pair.
    pub frequency: Frequency,
}

impl Selection {
    /// Letters of a selection, with names.
    const NAMES: &str = "G (GPS), C (BeiDou), E (Galileo), R (GLONASS) or J (QZSS)";

    /// Returns the selection of RINEX letters such as `GCER`.
    ///
    /// # Errors
    /// A letter is not G, C, E, R or J, or there is none; the message names it.
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

/// Meaning of the week number in ephemerides. Near the end of a week the two differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StatedWeek {
    /// The week of transmission, as satellites send it ([IS-GPS-200] 20.3.3.3.1.1).
    ///
    /// [IS-GPS-200]: crate#references
    Transmission,
    /// The week of the reference time, as in RINEX and in many programs.
    Toe,
}

/// Encoder of the epochs of one source, in the order of time.
pub struct Encoder {
    stated: StatedWeek,
    selection: Selection,
    schedule: Schedule,
    channels: Channels,
    builder: MessageBuilder,
    unsendable: u64,
    /// GPS time minus UTC as stated in files, s.
    leap_s: Option<u8>,
    /// Time of the last statement of date and leap seconds.
    dated: Option<GpsTime>,
    is_receiver: bool,
}

/// Interval at which a receiver repeats the date, ms, as it repeats the set of a satellite.
const DATE_REPEATS_MS: i64 = 60_000;

/// Length of an epoch of three systems without ephemerides, bytes; longer ones grow.
const EPOCH_BYTES: usize = 2048;

impl Encoder {
    /// Returns an encoder for these ephemerides.
    pub fn new(ephemerides: &[TimedEphemeris], selection: Selection) -> Self {
        let selected = |ephemeris: &&TimedEphemeris| selection.has(ephemeris.satellite);
        let schedule = Schedule::new(ephemerides.iter().filter(selected).cloned());
        let channels = Channels::of(ephemerides);
        let (stated, builder) = (StatedWeek::Transmission, MessageBuilder::new());
        Self {
            stated,
            selection,
            schedule,
            channels,
            builder,
            unsendable: 0,
            leap_s: None,
            dated: None,
            is_receiver: false,
        }
    }

    /// Changes the meaning of week numbers, which is that of transmission by default.
    #[must_use]
    pub fn stating(self, stated: StatedWeek) -> Self {
        Self { stated, ..self }
    }

    /// Sends ephemerides as a receiver does: only those of the satellites in view, repeatedly. With
    /// GLONASS it also states date and leap seconds.
    #[must_use]
    pub fn as_receiver(self) -> Self {
        Self { schedule: self.schedule.like_a_receiver(), is_receiver: true, ..self }
    }

    /// Takes GPS time minus UTC, s, as files state it.
    #[must_use]
    pub fn counting(self, leap_s: Option<u8>) -> Self {
        Self { leap_s, ..self }
    }

    /// Returns the number of signals that could not be sent so far. Their pseudorange is negative,
    /// 255 ms or more, or more than 200 m away from the satellite's other one; or they are of a
    /// GLONASS satellite with an unknown frequency slot. The message cannot hold these.
    pub fn unsendable(&self) -> u64 {
        self.unsendable
    }

    /// Returns the bytes of an epoch. If no satellite is in view, they have no ranges, and thus end
    /// no epoch for the receiver.
    ///
    /// # Errors
    /// A number does not fit its message.
    pub fn epoch(&mut self, epoch: &MeasuredEpoch) -> Result<Vec<u8>> {
        let mut bytes = Vec::with_capacity(EPOCH_BYTES);
        let leap_s = leap_seconds(epoch.time, self.leap_s);
        let is_due = self.dated.is_none_or(|dated| epoch.time.since_ms(dated) >= DATE_REPEATS_MS);
        if self.is_receiver && self.selection.letters.contains(&'R') && is_due {
            self.dated = Some(epoch.time);
            bytes.extend(date(epoch.time, leap_s));
        }
        for ephemeris in self.schedule.news(epoch) {
            let week_of = match self.stated {
                // A set that is sent ahead of its broadcast is sent as if it were broadcast now.
                StatedWeek::Transmission => ephemeris.sent.min(epoch.time),
                StatedWeek::Toe => ephemeris.toe,
            };
            append(&mut self.builder, &mut bytes, &broadcast(&ephemeris.message, week_of))
                .with_context(|| format!("ephemeris of {}", ephemeris.satellite))?;
        }
        let ranges = msm::frames(epoch, &self.selection, &self.channels, leap_s, &mut self.unsendable);
        ranges.for_each(|frame| bytes.extend_from_slice(&frame));
        Ok(bytes)
    }
}

/// Returns the frame of the date and the leap seconds.
///
/// The fields are number 12, station 12, modified Julian day 16, second of the day in UTC 17,
/// number of announcements 5, leap seconds 8.
fn date(time: GpsTime, leap_s: u8) -> Vec<u8> {
    /// Modified Julian day of 1980-01-06.
    const FIRST_DAY: u64 = 44_244;
    let utc_s = (time.to_ms() / 1000).saturating_sub(u64::from(leap_s));
    let (day, second) = (FIRST_DAY + utc_s / 86_400, utc_s % 86_400);
    let fields = [(1013, 12), (0, 12), (day, 16), (second, 17), (0, 5), (u64::from(leap_s), 8), (0, 2)];
    let bits = fields.iter().fold(0_u128, |bits, (value, width)| bits << width | u128::from(*value));
    let [.., b0, b1, b2, b3, b4, b5, b6, b7, b8] = bits.to_be_bytes();
    rtcm_frame(&[b0, b1, b2, b3, b4, b5, b6, b7, b8])
}

/// Returns the message of an ephemeris, with the week number of an instant.
fn broadcast(ephemeris: &Ephemeris, week_of: GpsTime) -> Message {
    let week = week_of.week;
    match ephemeris.clone() {
        Ephemeris::Gps(message) => Message::Msg1019(Msg1019T { gps_week_number: week % 1024, ..message }),
        Ephemeris::Beidou(message) => {
            let own = GpsTime::from_ms(week_of.to_ms().saturating_sub(u64::from(BEIDOU_OFFSET_MS)));
            let bds_week_number = own.week.saturating_sub(BEIDOU_WEEK_OFFSET);
            Message::Msg1042(Msg1042T { bds_week_number, ..message })
        }
        Ephemeris::GalileoFnav(message) => {
            let gal_week_number = week.saturating_sub(GALILEO_WEEK_OFFSET) % 4096;
            Message::Msg1045(Msg1045T { gal_week_number, ..message })
        }
        Ephemeris::GalileoInav(message) => {
            let gal_week_number = week.saturating_sub(GALILEO_WEEK_OFFSET) % 4096;
            Message::Msg1046(Msg1046T { gal_week_number, ..message })
        }
        Ephemeris::Glonass(message) => Message::Msg1020(message),
        Ephemeris::Qzss(message) => Message::Msg1044(Msg1044T { qzss_week_number: week % 1024, ..message }),
    }
}

fn append(builder: &mut MessageBuilder, bytes: &mut Vec<u8>, message: &Message) -> Result<()> {
    let built = builder.build_message(message);
    let number = message.number().unwrap_or(0);
    bytes.extend_from_slice(
        built.map_err(|error| anyhow::anyhow!("message {number} cannot be built: {error:?}"))?,
    );
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn date_is_as_another_program_writes_it() {
        // 2020-06-24 21:00:00 UTC, 18 leap seconds: pyrtcm 1.1.
        let want = [0xD3, 0, 9, 0x3F, 0x50, 0, 0xE6, 0x90, 0x93, 0xA8, 0, 0x48, 0x1D, 0xDB, 0x91];
        let time = GpsTime { week: 2111, tow_ms: (3 * 86_400 + 21 * 3600 + 18) * 1000 };
        assert_eq!(date(time, 18), want);
    }
}
