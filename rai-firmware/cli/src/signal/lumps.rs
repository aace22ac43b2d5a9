//! Encoding of a recording: the bytes of each epoch, within a window and with faults.

use std::collections::BTreeSet;

use anyhow::{Context as _, Result, ensure};
use raim_core::frame::{Ecef, Enu, LocalFrame};
use raim_core::satellite::SatelliteId;
use raim_firmware::time::GpsTime;

use super::corrected::Corrector;
use super::lump::Lump;
use crate::signal::encode::{Encoder, Selection};
use crate::signal::fault::Fault;
use crate::signal::measurement::{MeasuredEpoch, TimedEphemeris};
use crate::signal::recording::Recording;

/// Part of a recording that is used; seconds after its first epoch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// First second used.
    pub from_s: f64,
    /// First second that is no longer used.
    pub to_s: f64,
    /// Minimum time between two epochs, s.
    pub every_s: f64,
}

impl Window {
    /// The whole recording.
    pub const ALL: Self = Self { from_s: 0.0, to_s: f64::INFINITY, every_s: 0.0 };
}

impl Window {
    /// Returns true if an epoch is in the window, after the last one that was.
    pub(crate) fn holds(&self, elapsed_s: f64, last_s: Option<f64>) -> bool {
        // Half a millisecond of tolerance, because time tags are rounded to milliseconds.
        let is_next = last_s.is_none_or(|last_s| elapsed_s - last_s >= self.every_s - 5e-4);
        elapsed_s >= self.from_s && elapsed_s < self.to_s && is_next
    }
}

/// Encodes a recording. Faults are timed from the recording's first epoch, whatever the window.
///
/// # Errors
/// As for [`Encoding`].
pub fn encode(
    recording: &Recording,
    selection: &Selection,
    faults: &[Fault],
    window: &Window,
) -> Result<Vec<Lump>> {
    let epochs = recording.epochs.iter().cloned().map(Ok);
    let broadcast = Broadcast {
        ephemerides: &recording.ephemerides,
        klobuchar: recording.klobuchar,
        leap_s: recording.leap_s,
        approximate_position: recording.approximate_position,
    };
    Encoding::of(epochs, &broadcast, selection, faults, window)?.collect()
}

/// Returns the encoder of a receiver that knows these broadcasts.
fn encoder(broadcast: &Broadcast<'_>, selection: &Selection) -> Encoder {
    Encoder::new(broadcast.ephemerides, selection.clone()).as_receiver().counting(broadcast.leap_s)
}

/// Content of a recording beside its epochs.
#[derive(Clone, Copy, Debug)]
pub struct Broadcast<'a> {
    /// All ephemerides, in the order of the files.
    pub ephemerides: &'a [TimedEphemeris],
    /// GPS coefficients of the ionosphere, `α0…α3, β0…β3`.
    pub klobuchar: Option<[f64; 8]>,
    /// GPS time minus UTC that the files state, s.
    pub leap_s: Option<u8>,
    /// Position of the antenna in the header.
    pub approximate_position: Option<Ecef>,
}

/// The lumps of a window of a recording, encoded epoch by epoch. None is stored, so that the length
/// of the recording does not matter. An error comes at the end if a fault affects no satellite of
/// the recording, or if the window is empty. It comes earlier if a number does not fit its message.
pub struct Encoding<I> {
    epochs: I,
    encoder: Encoder,
    faults: Vec<Fault>,
    /// Directions of the satellites, which only a shift needs.
    heaven: Option<Heaven>,
    window: Window,
    satellites: BTreeSet<SatelliteId>,
    /// Satellites of the last epoch, in its order.
    seen_last: Vec<SatelliteId>,
    span: Option<(GpsTime, GpsTime)>,
    /// Time from the first epoch to the last one of the window, s.
    last_used_s: Option<f64>,
    has_ended: bool,
}

impl<I: Iterator<Item = Result<MeasuredEpoch>>> Encoding<I> {
    /// Returns the lumps of `epochs`, which are in the order of time.
    ///
    /// # Errors
    /// A shift is asked for, and the header does not state the position of the antenna.
    pub fn of(
        epochs: I,
        broadcast: &Broadcast<'_>,
        selection: &Selection,
        faults: &[Fault],
        window: &Window,
    ) -> Result<Self> {
        let encoder = encoder(broadcast, selection);
        let is_directed = faults.iter().any(Fault::needs_directions);
        let heaven = is_directed.then(|| Heaven::of(broadcast, selection)).transpose()?;
        Ok(Self {
            epochs,
            encoder,
            faults: faults.to_vec(),
            heaven,
            window: *window,
            satellites: BTreeSet::new(),
            seen_last: Vec::new(),
            span: None,
            last_used_s: None,
            has_ended: false,
        })
    }

    /// Returns the first and the last epoch so far.
    pub fn span(&self) -> Option<(GpsTime, GpsTime)> {
        self.span
    }

    /// Returns the satellites of the epochs so far.
    pub fn satellites(&self) -> &BTreeSet<SatelliteId> {
        &self.satellites
    }

    /// Notes the satellites of an epoch. Few epochs bring another one.
    fn note(&mut self, epoch: &MeasuredEpoch) {
        let now = epoch.satellites.iter().map(|measured| measured.satellite);
        if !now.clone().eq(self.seen_last.iter().copied()) {
            self.satellites.extend(now.clone());
            self.seen_last.clear();
            self.seen_last.extend(now);
        }
    }

    /// Returns the source of the epochs.
    pub fn epochs(&self) -> &I {
        &self.epochs
    }

    fn advance(&mut self) -> Result<Option<Lump>> {
        while let Some(epoch) = self.epochs.next().transpose()? {
            let first = self.span.map_or(epoch.time, |(first, _)| first);
            self.span = Some((first, epoch.time));
            let elapsed_s = epoch.time.since_ms(first) as f64 * 1e-3;
            self.note(&epoch);
            let epoch = self.falsified(epoch, elapsed_s)?;
            if self.window.holds(elapsed_s, self.last_used_s) {
                self.last_used_s = Some(elapsed_s);
                return Ok(Some(Lump { time: epoch.time, elapsed_s, bytes: self.encoder.epoch(&epoch)? }));
            }
        }
        let satellites: Vec<SatelliteId> = self.satellites.iter().copied().collect();
        for fault in &self.faults {
            fault.check_against(&satellites)?;
        }
        let Window { from_s, to_s, .. } = self.window;
        ensure!(
            self.last_used_s.is_some() || self.span.is_none(),
            "no epoch between {from_s} s and {to_s} s of the recording"
        );
        Ok(None)
    }

    fn falsified(&mut self, mut epoch: MeasuredEpoch, elapsed_s: f64) -> Result<MeasuredEpoch> {
        let directions = self.heaven.as_mut().map_or(Ok(Vec::new()), |heaven| heaven.directions(&epoch))?;
        let direction = |satellite| {
            directions.iter().find(|(other, _)| *other == satellite).map(|(_, direction)| *direction)
        };
        for fault in &self.faults {
            fault.apply_towards(&mut epoch, elapsed_s, direction);
        }
        Ok(epoch)
    }
}

impl<I: Iterator<Item = Result<MeasuredEpoch>>> Iterator for Encoding<I> {
    type Item = Result<Lump>;

    fn next(&mut self) -> Option<Result<Lump>> {
        if self.has_ended {
            return None;
        }
        let lump = self.advance().transpose();
        self.has_ended = !matches!(lump, Some(Ok(_)));
        lump
    }
}

/// Positions of the satellites as the module computes them, seen from the antenna position of the
/// recording.
pub struct Heaven {
    encoder: Encoder,
    corrector: Corrector,
    antenna: Ecef,
}

impl Heaven {
    /// Returns the positions for a recording whose approximate antenna position is known.
    ///
    /// # Errors
    /// The recording must state an approximate position.
    pub fn of(broadcast: &Broadcast<'_>, selection: &Selection) -> Result<Self> {
        let antenna =
            broadcast.approximate_position.context("a shift needs the antenna's approximate position")?;
        Ok(Self {
            encoder: encoder(broadcast, selection),
            corrector: Corrector::new(antenna, 0.0, broadcast.klobuchar),
            antenna,
        })
    }

    /// Returns unit vectors from the antenna to the satellites of the next epoch.
    ///
    /// # Errors
    /// The encoder must be able to encode the epoch.
    pub fn directions(&mut self, epoch: &MeasuredEpoch) -> Result<Vec<(SatelliteId, Enu)>> {
        let frame = LocalFrame::at(self.antenna);
        let towards = |position: Ecef| {
            let difference = position - self.antenna;
            let distance_m = difference.radius_m();
            let Enu { east, north, up } = frame.rotate(difference);
            Enu { east: east / distance_m, north: north / distance_m, up: up / distance_m }
        };
        let bytes = self.encoder.epoch(epoch)?;
        let corrected = self.corrector.receive(&bytes);
        let seen = corrected.last().map_or(&[][..], |epoch| epoch.observations());
        Ok(seen.iter().map(|one| (one.satellite, towards(one.position))).collect())
    }
}
