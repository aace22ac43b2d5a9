//! What the stages are fed: skies of a given size, with faults, and the bytes of a receiver under them.
//!
//! The geometry is that of GPS and `BeiDou` above Wuhan at an instant when both show 40 satellites and more. For a smaller sky
//! they are dealt out evenly over the list; for one constellation all are called GPS.

use anyhow::{Context, Result};
use rai_core::epoch::{Epoch, Observation};
use rai_core::frame::Ecef;
use rai_core::satellite::{Constellation, SatelliteId};
use rai_firmware::correction::CAPACITY;

use crate::encode::{Encoder, Selection};
use crate::sky::raw::Simulation;
use crate::sky::{Fleet, Noise, Sight, Site, sights};

/// Standard deviation of every range, m.
const SIGMA_M: f64 = 2.0;
/// Receiver clock times the speed of light, m: 0.1 ms.
const CLOCK_M: f64 = 3e4;
/// What a faulty range is off by, m. Two faults that agree could hide each other.
const FAULTS_M: [f64; 3] = [120.0, -95.0, 150.0];

/// Where the antenna is: JFNG.
pub fn site() -> Site {
    Site::geodetic(30.5156, 114.4910, 71.0)
}

/// All that is above the horizon, at the first minute of the day that shows 40.
fn full_sky() -> Vec<Sight> {
    let satellites: Vec<_> =
        [Fleet::Gps31, Fleet::Beidou44].into_iter().flat_map(Fleet::satellites).collect();
    let at_minute = |minute: u32| sights(&satellites, &site(), f64::from(minute) * 60.0, 0.0);
    (0..1440).map(at_minute).find(|seen| seen.len() >= 40).unwrap_or_default()
}

/// An epoch of `count` satellites of one or two constellations, the first `faults` of every third one wrong.
///
/// # Errors
/// Where the core refuses a range, which it does not do with these.
pub fn epoch(count: usize, constellations: usize, faults: usize) -> Result<Epoch<CAPACITY>> {
    let sky = full_sky();
    let noise = Noise::new(count as u64);
    let mut epoch = Epoch::new(0.0);
    for index in 0..count {
        let sight = sky.get(index * sky.len() / count).context("the sky shows fewer")?;
        let fault_m =
            if index % 3 == 2 { FAULTS_M.get(..faults).and_then(|all| all.get(index / 3)) } else { None };
        let satellite = named(index, count, constellations)?;
        let error_m = SIGMA_M * noise.normal(satellite, 0, 0) + fault_m.unwrap_or(&0.0);
        epoch.push(Observation {
            satellite,
            position: sight.position,
            range_m: sight.range_m + CLOCK_M + error_m,
            sigma_m: SIGMA_M,
        })?;
    }
    Ok(epoch)
}

fn named(index: usize, count: usize, constellations: usize) -> Result<SatelliteId> {
    let is_second = constellations == 2 && index >= count / 2;
    let constellation = if is_second { Constellation::Beidou } else { Constellation::Gps };
    SatelliteId::new(constellation, index as u8 + 1).context("no such number")
}

/// A point 1 km from the antenna, where a fix is to start.
pub fn start() -> Ecef {
    site().position + Ecef::new(600.0, 700.0, -387.3)
}

/// RTCM of a two-system receiver: ephemerides and some epochs, then the epoch that is timed.
pub struct Stream {
    /// All that came before.
    pub before: Vec<u8>,
    /// The last epoch.
    pub last: Vec<u8>,
}

/// A stream of `epochs` seconds over a sky of 20 satellites, GPS and `BeiDou`.
///
/// # Errors
/// Where a message cannot be encoded.
pub fn stream(epochs: u32, count: usize) -> Result<Stream> {
    let mut simulation = Simulation::above_xian(43_200.0, epochs, 7);
    let seen = simulation.sights_at(0);
    let kept: Vec<_> = (0..count).filter_map(|index| seen.get(index * seen.len() / count)).collect();
    simulation.satellites.retain(|satellite| kept.iter().any(|sight| sight.satellite == satellite.id));
    let recording = simulation.record();
    let selection = Selection::new("GC", crate::encode::Frequency::Dual)?;
    let mut encoder = Encoder::new(&recording.ephemerides, selection);
    let (last, before) = recording.epochs.split_last().context("no epochs")?;
    let before: Vec<Vec<u8>> = before.iter().map(|epoch| encoder.epoch(epoch)).collect::<Result<_>>()?;
    Ok(Stream { before: before.concat(), last: encoder.epoch(last)? })
}
