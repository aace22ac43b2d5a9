//! Inputs of the stages: skies of a given size, with faults, and a receiver's bytes for them.
//!
//! The geometry is that of GPS and `BeiDou` above Wuhan at an instant when both together have 40
//! satellites in view. A smaller sky takes every second or third of the list; for one constellation
//! all are named as GPS. Every third satellite is faulty, as far apart as the list allows.

use std::sync::LazyLock;

use anyhow::{Context, Result};
use raim::signal::encode::{Encoder, Frequency, Selection, ubx};
use raim::signal::fault::{Fault, Kind, Target};
use raim::signal::measurement::MeasuredSignal;
use raim::signal::recording::Recording;
use raim::signal::sky::raw::Simulation;
use raim::signal::sky::{Fleet, Noise, Oscillator, Satellite, Sight, Site, sights};
use raim_core::epoch::{Epoch, Observation};
use raim_core::frame::Ecef;
use raim_core::satellite::{Constellation, SatelliteId};
use raim_firmware::correction::CAPACITY;
use raim_firmware::time::GpsTime;

/// Letters of the systems of the measured sky.
const TWO_SYSTEMS: &str = "GC";
/// Standard deviation of every range, m.
const SIGMA_M: f64 = 2.0;
/// Receiver clock times the speed of light, m: 0.1 ms.
const CLOCK_M: f64 = 3e4;
/// Errors of faulty ranges, m; no two agree.
const FAULTS_M: [f64; 3] = [120.0, -95.0, 150.0];
/// Elevation above which satellites count for the full sky, rad.
const MASK_RAD: f64 = 10.0 / 180.0 * core::f64::consts::PI;

/// Returns the site of the antenna: the station JFNG.
pub fn site() -> Site {
    Site::geodetic(30.5156, 114.4910, 71.0)
}

/// Returns a point 1 km from the antenna, at which a fix starts.
pub fn start() -> Ecef {
    site().position + Ecef::new(600.0, 700.0, -387.3)
}

/// Returns the satellites of systems, by their letters.
fn satellites(systems: &str) -> Vec<Satellite> {
    let fleets = [('G', Fleet::Gps31), ('C', Fleet::Beidou44), ('E', Fleet::Galileo24)];
    let chosen = fleets.into_iter().filter(|(letter, _)| systems.contains(*letter));
    chosen.flat_map(|(_, fleet)| fleet.satellites()).collect()
}

/// Returns the start of the first quarter of an hour with 40 satellites in view, or with the most
/// of the day, s.
fn fullest_s(satellites: &[Satellite]) -> f64 {
    let quarters = (0..96).map(|quarter| f64::from(quarter) * 900.0);
    let count = |t_s: f64| sights(satellites, &site(), t_s, MASK_RAD).len().min(40);
    quarters.rev().max_by_key(|&t_s| count(t_s)).unwrap_or(0.0)
}

/// Returns all satellites at the fullest moment, found once.
fn full_sky() -> &'static [Sight] {
    static SKY: LazyLock<Vec<Sight>> = LazyLock::new(|| {
        let satellites = satellites(TWO_SYSTEMS);
        // Satellites below the mask are included, so that there are always 40.
        sights(&satellites, &site(), fullest_s(&satellites), 0.0)
    });
    &SKY
}

/// Returns `count` elements of a list, evenly spaced.
fn spread<T>(list: &[T], count: usize) -> impl Iterator<Item = &T> {
    (0..count).filter_map(move |index| list.get(index * list.len() / count))
}

/// Returns an epoch of `count` satellites of one to four constellations, `faults` of them wrong.
///
/// # Errors
/// If the sky has fewer satellites, or the core refuses a range.
pub fn epoch(count: usize, constellations: usize, faults: usize) -> Result<Epoch<CAPACITY>> {
    let noise = Noise::new(count as u64);
    let mut epoch = Epoch::new(0.0);
    for (index, sight) in spread(full_sky(), count).enumerate() {
        let satellite = named(index, count, constellations)?;
        let error_m = SIGMA_M * noise.normal(satellite, 0, 0) + fault_m(index, faults);
        epoch.push(Observation {
            satellite,
            position: sight.position,
            range_m: sight.range_m + CLOCK_M + error_m,
            sigma_m: SIGMA_M,
        })?;
    }
    anyhow::ensure!(epoch.observations().len() == count, "the sky has fewer than {count} satellites");
    Ok(epoch)
}

fn fault_m(index: usize, faults: usize) -> f64 {
    let number = (index % 3 == 2).then_some(index / 3).filter(|&number| number < faults);
    number.and_then(|number| FAULTS_M.get(number)).copied().unwrap_or(0.0)
}

fn named(index: usize, count: usize, constellations: usize) -> Result<SatelliteId> {
    let constellation = *Constellation::ALL
        .get(index * constellations / count)
        .context("the number of constellations must be within 1 to 4")?;
    SatelliteId::new(constellation, index as u8 + 1)
        .context("the constellation has no satellite of this number")
}

/// Faults of a stream.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wrong {
    /// Number of faulty satellites, evenly spaced and, while there are few, never adjacent.
    pub faults: usize,
    /// Scale of the biases. At 1 they are some hundred metres, and differ.
    pub scale: f64,
    /// Start of the faults in the stream, s.
    pub from_s: f64,
}

impl Wrong {
    /// No faults.
    pub const NOTHING: Self = Self { faults: 0, scale: 0.0, from_s: 0.0 };

    /// Returns the bias of one of `count` satellites, m.
    fn of_m(&self, index: usize, count: usize) -> f64 {
        let before = |index: usize| index * self.faults / count;
        if before(index) == before(index + 1) {
            return 0.0;
        }
        let number = before(index);
        let size_m = FAULTS_M.get(number % FAULTS_M.len()).copied().unwrap_or_default();
        self.scale * size_m * (1 + number / FAULTS_M.len()) as f64
    }
}

/// Bytes of a receiver of two frequencies, in epochs of one second; the first includes the
/// ephemerides.
pub struct Stream {
    /// Bytes of each epoch.
    pub epochs: Vec<Vec<u8>>,
    /// Number of satellites at or above the mask of the module.
    pub satellites: usize,
}

impl Stream {
    /// Encodes UBX for a sky of `count` satellites: RXM-RAWX with two signals of each, after
    /// RXM-SFRBX.
    ///
    /// # Errors
    /// If a message cannot be encoded, or a satellite lacks two signals that such a receiver
    /// measures.
    pub fn of_ubx(epochs: u32, count: usize) -> Result<Self> {
        let simulation = simulation(epochs, count, TWO_SYSTEMS);
        let satellites = simulation.sights_at(0).len();
        let mut recording = simulation.record();
        for epoch in &mut recording.epochs {
            epoch.satellites.iter_mut().flat_map(|one| &mut one.signals).for_each(as_civil);
            let signals: usize = ubx::measurable(epoch).satellites.iter().map(|one| one.signals.len()).sum();
            anyhow::ensure!(signals == 2 * satellites, "{signals} signals of {satellites} satellites");
        }
        let selection = Selection::new(TWO_SYSTEMS, Frequency::Dual)?;
        let mut encoder = ubx::Encoder::new(&recording.ephemerides, selection, None);
        let epochs = recording.epochs.iter().map(|epoch| encoder.epoch(epoch)).collect::<Result<_>>()?;
        Ok(Self { epochs, satellites })
    }

    /// Encodes RTCM for a sky of `count` satellites, from a receiver without Doppler frequencies.
    ///
    /// # Errors
    /// If a message cannot be encoded.
    pub fn without_range_rates(epochs: u32, count: usize) -> Result<Self> {
        let simulation = Simulation { has_range_rates: false, ..simulation(epochs, count, TWO_SYSTEMS) };
        Self::of(&simulation.record(), simulation.sights_at(0).len(), TWO_SYSTEMS)
    }

    /// Encodes RTCM for a sky of `count` satellites of two systems, some of them wrong.
    ///
    /// # Errors
    /// If a message cannot be encoded.
    pub fn with(epochs: u32, count: usize, wrong: Wrong) -> Result<Self> {
        Self::of_systems(TWO_SYSTEMS, epochs, count, wrong)
    }

    /// Encodes the same for any of GPS, `BeiDou` and Galileo, by their letters.
    ///
    /// # Errors
    /// If a message cannot be encoded.
    pub fn of_systems(systems: &str, epochs: u32, count: usize, wrong: Wrong) -> Result<Self> {
        let simulation = simulation(epochs, count, systems);
        let seen = simulation.sights_at(0);
        let mut recording = simulation.record();
        for (index, sight) in seen.iter().enumerate() {
            let kind = Kind::Step { bias_m: wrong.of_m(index, seen.len()) };
            let target = Target::Satellite(sight.satellite);
            let fault = Fault { target, kind, start_s: wrong.from_s, end_s: f64::INFINITY };
            for (number, epoch) in recording.epochs.iter_mut().enumerate() {
                fault.apply(epoch, number as f64);
            }
        }
        Self::of(&recording, seen.len(), systems)
    }

    fn of(recording: &Recording, satellites: usize, systems: &str) -> Result<Self> {
        let mut encoder = Encoder::new(&recording.ephemerides, Selection::new(systems, Frequency::Dual)?);
        let epochs = recording.epochs.iter().map(|epoch| encoder.epoch(epoch)).collect::<Result<_>>()?;
        Ok(Self { epochs, satellites })
    }

    /// Splits the stream into the bytes before the last epoch and the last epoch.
    ///
    /// # Errors
    /// If there is no epoch.
    pub fn split(&self) -> Result<(Vec<u8>, &[u8])> {
        let (last, before) = self.epochs.split_last().context("the stream has no epochs")?;
        Ok((before.concat(), last))
    }
}

/// Replaces the encrypted code by the civil one on the same carrier, which these receivers measure.
fn as_civil(signal: &mut MeasuredSignal) {
    if signal.attribute == 'W' {
        signal.attribute = 'L';
    }
}

fn simulation(epochs: u32, count: usize, systems: &str) -> Simulation {
    let satellites = satellites(systems);
    let start_s = fullest_s(&satellites);
    let mut simulation = Simulation {
        satellites,
        site: site(),
        origin: GpsTime { week: 2295, tow_ms: 86_400_000 },
        start_s,
        epochs,
        step_s: 1.0,
        mask_rad: MASK_RAD,
        oscillator: Oscillator::temperature_compensated(),
        electrons_tecu: 20.0,
        seed: 7,
        has_range_rates: true,
    };
    let seen = simulation.sights_at(0);
    let kept: Vec<SatelliteId> = spread(&seen, count.min(seen.len())).map(|sight| sight.satellite).collect();
    simulation.satellites.retain(|satellite| kept.contains(&satellite.id));
    simulation
}
