//! Encoder of measurements to UBX, as a u-blox receiver would send them: one lump of bytes per
//! epoch.
//!
//! A lump is, in this order: the pages of the new ephemerides ([`super::schedule`]) as RXM-SFRBX,
//! then all ranges as one RXM-RAWX. The pages are those of the satellites, packed field by field,
//! in the order of transmission; only their times are compressed into the lump.
//!
//! | what | pages |
//! |---|---|
//! | GPS ephemeris | LNAV subframes 1 to 3 ([`lnav`]); ionosphere and UTC: page 18 of subframe 4 |
//! | Galileo ephemeris | I/NAV words 1 to 5 or F/NAV pages 1 to 4 ([`galileo`]); UTC: word 6 |
//! | `BeiDou` ephemeris | D1 subframes 1 to 3 or D2 pages 1 to 10 ([`beidou`]) |
//! | GLONASS ephemeris | strings 1 to 4 ([`glonass`]) |
//!
//! Frames of CNAV ([`cnav_words`]) are for callers that add them.
//!
//! References: u-blox F9 HPG 1.32 interface description, RXM-RAWX and RXM-SFRBX.

mod beidou;
mod bits;
mod cnav;
mod galileo;
mod glonass;
mod lnav;
mod sealing;

use anyhow::{Context, Result, bail};
use raim_core::satellite::{Constellation, SatelliteId};
use raim_firmware::time::{BEIDOU_OFFSET_MS, GpsTime, WEEK_MS};

use super::Selection;
use super::channels::Channels;
use super::msm::chosen;
use super::schedule::Schedule;
use crate::signal::measurement::{
    Ephemeris, MeasuredEpoch, MeasuredSatellite, MeasuredSignal, TimedEphemeris,
};

pub use cnav::{CnavMessage, cnav_words};
pub use lnav::IonosphereAndUtc;
pub use sealing::Form;

/// Class and id of a message.
type Kind = [u8; 2];

/// RXM-RAWX.
const RAWX: Kind = [0x02, 0x15];
/// RXM-SFRBX.
const SFRBX: Kind = [0x02, 0x13];

/// Returns a frame: header, payload and Fletcher's sums.
pub fn frame(kind: Kind, payload: &[u8]) -> Vec<u8> {
    let mut bytes = vec![0xB5, 0x62, kind[0], kind[1]];
    bytes.extend_from_slice(&(payload.len() as u16).to_le_bytes());
    bytes.extend_from_slice(payload);
    let (mut a, mut b) = (0_u8, 0_u8);
    for byte in &bytes[2..] {
        a = a.wrapping_add(*byte);
        b = b.wrapping_add(a);
    }
    bytes.extend_from_slice(&[a, b]);
    bytes
}

/// Returns a frame of navigation bits of a satellite's signal.
pub fn subframe(satellite: SatelliteId, signal: u8, words: &[u32]) -> Vec<u8> {
    subframe_on(satellite, signal, 0, words)
}

/// Returns the same for a GLONASS satellite; `channel` is its frequency slot plus 7.
fn subframe_on(satellite: SatelliteId, signal: u8, channel: u8, words: &[u32]) -> Vec<u8> {
    let (system, number) = match satellite.name() {
        ('J', number) => (5, number),
        (_, number) => (system(satellite.constellation()), number),
    };
    let mut payload = vec![system, number, signal, channel, words.len() as u8, 0, 2, 0];
    for word in words {
        payload.extend_from_slice(&word.to_le_bytes());
    }
    frame(SFRBX, &payload)
}

/// Returns the number of a system.
const fn system(constellation: Constellation) -> u8 {
    match constellation {
        Constellation::Gps => 0,
        Constellation::Galileo => 2,
        Constellation::Beidou => 3,
        Constellation::Glonass => 6,
        _ => u8::MAX,
    }
}

/// Returns a frequency slot in the form of the message; 0 if all satellites of a system share their
/// carriers.
const fn channel(constellation: Constellation, slot: i8) -> u8 {
    match constellation {
        Constellation::Glonass => (slot + 7) as u8,
        _ => 0,
    }
}

/// Returns the number of a signal by its RINEX band and attribute; `None` for signals that a u-blox
/// receiver does not measure.
const fn signal(constellation: Constellation, signal: &MeasuredSignal) -> Option<u8> {
    match (constellation, signal.band, signal.attribute) {
        (Constellation::Gps | Constellation::Glonass, 1, 'C')
        | (Constellation::Galileo, 1, 'C' | 'X')
        | (Constellation::Beidou, 2, 'I') => Some(0),
        (Constellation::Galileo, 1, 'B') => Some(1),
        (Constellation::Beidou, 7, 'I') | (Constellation::Glonass, 2, 'C') => Some(2),
        (Constellation::Gps, 2, 'L' | 'X') | (Constellation::Galileo, 5, 'I') => Some(3),
        (Constellation::Gps, 2, 'S')
        | (Constellation::Galileo, 5, 'Q' | 'X')
        | (Constellation::Beidou, 6, 'I') => Some(4),
        (Constellation::Galileo, 7, 'I') | (Constellation::Beidou, 1, 'P' | 'X') => Some(5),
        (Constellation::Gps, 5, 'I') | (Constellation::Galileo, 7, 'Q' | 'X') => Some(6),
        (Constellation::Gps, 5, 'Q' | 'X') | (Constellation::Beidou, 5, 'P' | 'X') => Some(7),
        _ => None,
    }
}

/// Returns the part of an epoch that a u-blox receiver could have measured.
pub fn measurable(epoch: &MeasuredEpoch) -> MeasuredEpoch {
    let satellites = epoch.satellites.iter().filter_map(|satellite| {
        let constellation = satellite.satellite.constellation();
        let mut signals = satellite.signals.clone();
        signals.retain(|measured| signal(constellation, measured).is_some());
        (!signals.is_empty()).then_some(MeasuredSatellite { satellite: satellite.satellite, signals })
    });
    MeasuredEpoch { time: epoch.time, satellites: satellites.collect() }
}

/// Encoder of the epochs of one source, in the order of time.
pub struct Encoder {
    selection: Selection,
    schedule: Schedule,
    channels: Channels,
    ionosphere_and_utc: Option<IonosphereAndUtc>,
}

impl Encoder {
    /// Returns an encoder for these ephemerides; ionosphere and leap seconds go with the first GPS
    /// ephemeris.
    pub fn new(
        ephemerides: &[TimedEphemeris],
        selection: Selection,
        ionosphere_and_utc: Option<IonosphereAndUtc>,
    ) -> Self {
        let selected = |ephemeris: &&TimedEphemeris| is_sent(&selection, ephemeris.satellite);
        let schedule = Schedule::new(ephemerides.iter().filter(selected).cloned());
        Self { selection, schedule, channels: Channels::of(ephemerides), ionosphere_and_utc }
    }

    /// Sends ephemerides as a receiver does: only those of the satellites in view, repeatedly.
    #[must_use]
    pub fn as_receiver(self) -> Self {
        Self { schedule: self.schedule.like_a_receiver(), ..self }
    }

    /// Returns the bytes of an epoch, with the selected signals.
    ///
    /// # Errors
    /// A number does not fit its page.
    pub fn epoch(&mut self, epoch: &MeasuredEpoch) -> Result<Vec<u8>> {
        let mut bytes = Vec::new();
        for ephemeris in self.schedule.news(epoch) {
            let pages = pages(ephemeris, epoch.time)
                .with_context(|| format!("ephemeris of {}", ephemeris.satellite))?;
            bytes.extend(pages);
            if let (Ephemeris::Gps(_), Some(reported)) = (&ephemeris.message, self.ionosphere_and_utc.take())
            {
                bytes.extend(ionosphere_and_utc(ephemeris.satellite, &reported, epoch.time)?);
            }
        }
        bytes.extend(rawx(&measurable(epoch), &self.selection, &self.channels));
        Ok(bytes)
    }
}

/// Returns true for satellites of the selected systems; those of QZSS are sent as RTCM alone.
fn is_sent(selection: &Selection, satellite: SatelliteId) -> bool {
    selection.has(satellite) && !satellite.is_qzss()
}

/// Returns the index of the 30 s within the week.
fn frame_of_week(time: GpsTime) -> u32 {
    time.tow_ms / 30_000
}

/// Returns the frames of an ephemeris, sent in the 30 s about `time`.
///
/// # Errors
/// A number does not fit its page.
pub fn pages(ephemeris: &TimedEphemeris, time: GpsTime) -> Result<Vec<u8>> {
    let frame = frame_of_week(time);
    let system_time = galileo::SystemTime { week: time.week.saturating_sub(1024), tow_s: 30 * frame };
    let beidou_s = (time.tow_ms + WEEK_MS - BEIDOU_OFFSET_MS) % WEEK_MS / 30_000 * 30;
    let is_geostationary = matches!(ephemeris.satellite.number(), 1..=5 | 59..=63);
    let mut slot = 0;
    let (signal, pages) = match &ephemeris.message {
        Ephemeris::Gps(message) => (0, lnav::ephemeris(message, frame)?),
        Ephemeris::GalileoInav(message) => (1, galileo::inav(message, system_time)?),
        Ephemeris::GalileoFnav(message) => (3, galileo::fnav(message, system_time)?),
        Ephemeris::Beidou(message) if is_geostationary => (1, beidou::d2(message, beidou_s)?),
        Ephemeris::Beidou(message) => (0, beidou::d1(message, beidou_s)?),
        Ephemeris::Glonass(message) => {
            slot = message.glo_satellite_freq_chan_number;
            (0, glonass::ephemeris(message)?)
        }
        Ephemeris::Qzss(_) => bail!("{} is of QZSS, which is sent as RTCM alone", ephemeris.satellite),
    };
    let channel = channel(ephemeris.satellite.constellation(), slot);
    Ok(pages.iter().flat_map(|words| subframe_on(ephemeris.satellite, signal, channel, words)).collect())
}

/// Returns the ionosphere and the leap seconds as a GPS satellite sends them in the 30 s about
/// `time`.
///
/// # Errors
/// A number does not fit the page.
pub fn ionosphere_and_utc(
    satellite: SatelliteId,
    reported: &IonosphereAndUtc,
    time: GpsTime,
) -> Result<Vec<u8>> {
    Ok(subframe(satellite, 0, &lnav::ionosphere_and_utc(reported, frame_of_week(time))?))
}

/// Returns words 1 to 5 of I/NAV, without a time in the last.
///
/// # Errors
/// A number does not fit its word.
#[cfg(feature = "sign")]
pub(in crate::signal) fn inav_words(message: &rtcm_rs::msg::Msg1046T) -> Result<[[u8; 16]; 5]> {
    galileo::inav_words(message)
}

/// Returns a page of I/NAV on E1: a word, and the bits for its authentication.
#[cfg(feature = "sign")]
pub(in crate::signal) fn inav_page(satellite: SatelliteId, word: &[u8; 16], bits: [u8; 5]) -> Vec<u8> {
    let row = word.iter().try_fold(bits::Row::default(), |row, byte| row.unsigned(u64::from(*byte), 8));
    let words = row.and_then(|row| galileo::signed_page(row, bits)).expect("bytes have eight bits");
    subframe(satellite, 1, &words)
}

/// Returns the leap seconds as a Galileo satellite sends them.
///
/// # Errors
/// The leap seconds do not fit the word.
pub fn utc(satellite: SatelliteId, reported: &IonosphereAndUtc) -> Result<Vec<u8>> {
    Ok(subframe(satellite, 1, &galileo::utc(reported)?))
}

/// Returns the ranges of an epoch.
fn rawx(epoch: &MeasuredEpoch, selection: &Selection, channels: &Channels) -> Vec<u8> {
    /// A time of one second of lock or more, as most have it.
    const LOCK_MS: u16 = 64_500;
    /// Sigma of a range 0.01·2⁵ m.
    const SIGMA: u8 = 5;
    let mut measurements = Vec::new();
    let selected = |satellite: &&MeasuredSatellite| is_sent(selection, satellite.satellite);
    for satellite in epoch.satellites.iter().filter(selected) {
        let constellation = satellite.satellite.constellation();
        let Some(channel) = channels.slot(satellite.satellite).map(|slot| channel(constellation, slot))
        else {
            continue;
        };
        for measured in chosen(satellite, selection.frequency).into_iter().flatten() {
            let Some(number) = signal(constellation, measured) else { continue };
            let phase = measured.carrier_cycles;
            measurements.extend_from_slice(&measured.pseudorange_m.to_le_bytes());
            measurements.extend_from_slice(&phase.unwrap_or(-0.5).to_le_bytes());
            // NaN means that there is no Doppler.
            let doppler_hz = measured.doppler_hz.map_or(f32::NAN, |doppler_hz| doppler_hz as f32);
            measurements.extend_from_slice(&doppler_hz.to_le_bytes());
            measurements.extend_from_slice(&[
                system(constellation),
                satellite.satellite.number(),
                number,
                channel,
            ]);
            measurements.extend_from_slice(&LOCK_MS.to_le_bytes());
            let cn0 = measured.cn0_dbhz.map_or(0, |cn0_dbhz| cn0_dbhz.round() as u8);
            let valid = if phase.is_some() { 0b111 } else { 0b001 };
            measurements.extend_from_slice(&[cn0, SIGMA, 1, 5, valid, 0]);
        }
    }
    let mut payload = Vec::with_capacity(16 + measurements.len());
    payload.extend_from_slice(&(f64::from(epoch.time.tow_ms) * 1e-3).to_le_bytes());
    payload.extend_from_slice(&epoch.time.week.to_le_bytes());
    payload.extend_from_slice(&[18, (measurements.len() / 32) as u8, 0, 1, 0, 0]);
    payload.append(&mut measurements);
    frame(RAWX, &payload)
}
