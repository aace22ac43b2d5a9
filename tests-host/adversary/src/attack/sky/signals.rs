//! What arrives at the antenna: the genuine sky, that of another place, and pages of several signers.

use raim::signal::measurement::MeasuredSatellite;
use raim::signal::osnma::words::{Sets, Words as _};
use raim::signal::osnma::{Chain, Page, Secret, System};

use crate::attack::prelude::*;

/// Seconds that the skies begin before the module, which is how late they can be relayed.
pub(super) const AHEAD: u32 = 600;

/// Seconds of the module's life.
pub(super) const LENGTH: u32 = 600;

/// Start of the module's life, s: no set changes then.
const START_S: f64 = 3700.0;

/// Distance of the other place, degrees to the north, and in m.
const NORTH_DEG: f64 = 0.005;
const NORTH_M: f64 = 554.6;

/// Weeks by which Galileo's count begins later.
const GALILEO_WEEKS: u64 = 1024;

/// Seconds of a week.
const WEEK_S: u64 = 604_800;

/// Sets that a forger changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Lie {
    /// The clocks of this number of satellites are wrong by [`CLOCK_M`].
    Clocks(usize),
    /// All orbits are turned together, which moves the place.
    Turned,
}

/// Error of a forged clock, m, and of a turned sky on the ground.
const CLOCK_M: f64 = 300.0;
const TURNED_M: f64 = 500.0;

/// Distance of the place from the earth's axis, m.
const FROM_AXIS_M: f64 = 5.28e6;

/// All signals, second by second.
pub(super) struct Skies {
    pub(super) truth: Ecef,
    /// Recordings here and at the other place, without and with Doppler frequencies.
    here: [Recording; 2],
    there: [Recording; 2],
    satellites: Vec<u8>,
    genuine: System,
    pub(super) pages: Vec<Page>,
    /// Pages that the attacker signs with a key of his own.
    pub(super) of_attacker: Vec<Page>,
}

impl Skies {
    pub(super) fn new() -> Result<Self> {
        let simulation = |has_range_rates| Simulation {
            satellites: satellites(&[Fleet::Gps31, Fleet::Galileo24, Fleet::Beidou24]),
            has_range_rates,
            ..Simulation::above_xian(START_S - f64::from(AHEAD), AHEAD + LENGTH, 1)
        };
        let record = |simulation: &Simulation| {
            let mut recording = simulation.record();
            recording.epochs.iter_mut().for_each(measurable);
            recording
        };
        let both = [false, true].map(simulation);
        let here = both.each_ref().map(record);
        let there = both.each_ref().map(|simulation| record(&elsewhere(simulation, NORTH_DEG)));
        let satellites: Vec<u8> = here[0].epochs[0]
            .satellites
            .iter()
            .map(|seen| seen.satellite)
            .filter(|id| id.constellation() == Constellation::Galileo)
            .map(SatelliteId::number)
            .collect();
        let system = |secret, seed| -> Result<System> {
            let words = Sets::new(&here[0].ephemerides)?;
            let first_s = gst_s(here[0].epochs[0].time);
            let root = Chain::root(first_s / WEEK_S as u32, first_s % WEEK_S as u32 / 3600);
            Ok(System::with(secret, seed, root, satellites.clone(), Box::new(words)))
        };
        let (genuine, attacker) = (system(Secret::test(), 1)?, system(Secret::of(b"attacker"), 2)?);
        let first = gst_s(here[0].epochs[0].time) / 30;
        let subframes = first..first + (AHEAD + LENGTH) / 30 + 1;
        Ok(Self {
            truth: both[0].site.position,
            pages: genuine.pages(subframes.clone()),
            of_attacker: attacker.pages(subframes),
            satellites,
            genuine,
            here,
            there,
        })
    }

    pub(super) fn key(&self) -> [u8; 33] {
        self.genuine.public()
    }

    pub(super) fn ephemerides(&self) -> &[TimedEphemeris] {
        &self.here[0].ephemerides
    }

    /// Returns the epoch that the antenna receives in a second of the module's life, so late.
    pub(super) fn here(&self, second: u32, late_s: u32, has_rates: bool) -> &MeasuredEpoch {
        &self.here[usize::from(has_rates)].epochs[(AHEAD + second - late_s) as usize]
    }

    /// Returns that of the other place.
    pub(super) fn there(&self, second: u32, late_s: u32, has_rates: bool) -> &MeasuredEpoch {
        &self.there[usize::from(has_rates)].epochs[(AHEAD + second - late_s) as usize]
    }

    /// Returns the epoch at the antenna with some systems as at the other place.
    pub(super) fn mixed(
        &self,
        second: u32,
        has_rates: bool,
        is_there: impl Fn(Constellation) -> bool,
    ) -> MeasuredEpoch {
        let mut epoch = self.here(second, 0, has_rates).clone();
        let is_elsewhere = |seen: &&MeasuredSatellite| is_there(seen.satellite.constellation());
        epoch.satellites.retain(|seen| !is_elsewhere(&seen));
        let there = self.there(second, 0, has_rates).satellites.iter();
        epoch.satellites.extend(there.filter(is_elsewhere).cloned());
        epoch
    }

    /// Returns an epoch whose ranges and rates are those of a place that has moved to the north.
    pub(super) fn walked(&self, second: u32, moved_m: f64, speed_m_s: f64, has_rates: bool) -> MeasuredEpoch {
        let (mut epoch, there) = (self.here(second, 0, has_rates).clone(), self.there(second, 0, has_rates));
        for satellite in &mut epoch.satellites {
            let Some(other) = there.satellites.iter().find(|other| other.satellite == satellite.satellite)
            else {
                continue;
            };
            let Some((mine, its)) = satellite.signals.first().zip(other.signals.first()) else { continue };
            let per_m = (its.pseudorange_m - mine.pseudorange_m) / NORTH_M;
            let system = satellite.satellite.constellation();
            for signal in &mut satellite.signals {
                signal.pseudorange_m += per_m * moved_m;
                let hz = signal.frequency_hz(system, 0).unwrap_or(0.0);
                signal.doppler_hz =
                    signal.doppler_hz.map(|doppler| doppler - per_m * speed_m_s * hz / SPEED_OF_LIGHT_M_S);
            }
        }
        epoch
    }

    /// Returns the pages with a forger's words instead of the system's, with right checks.
    pub(super) fn forged(&self, lie: Lie) -> Result<Vec<Page>> {
        let liars = match lie {
            Lie::Clocks(count) => self.satellites.get(..count).context("satellites")?,
            Lie::Turned => &self.satellites,
        };
        let mut sets = self.ephemerides().to_vec();
        sets.retain(|set| {
            set.satellite.constellation() == Constellation::Galileo && liars.contains(&set.satellite.number())
        });
        for set in &mut sets {
            let Ephemeris::GalileoInav(message) = &mut set.message else { continue };
            message.iodnav += 50;
            match lie {
                Lie::Clocks(_) => message.af0_s += CLOCK_M / SPEED_OF_LIGHT_M_S,
                Lie::Turned => message.omega0_sc += TURNED_M / FROM_AXIS_M / std::f64::consts::PI,
            }
        }
        let words = Sets::new(&sets)?;
        let forged = |page: &Page| match page.word[0] >> 2 {
            kind @ 1..=5 if liars.contains(&page.satellite) => {
                Page { word: words.word(page.satellite, kind, page.begin_s), ..*page }
            }
            _ => *page,
        };
        Ok(self.pages.iter().map(forged).collect())
    }

    /// Returns the pages with other blocks in each subframe from one satellite.
    pub(super) fn poisoned(&self) -> Vec<Page> {
        let poison = |page: &Page| {
            let mut page = *page;
            if self.satellites.first() == Some(&page.satellite) && page.begin_s % 30 > 3 {
                page.bits[0] ^= (page.begin_s % 251) as u8;
            }
            page
        };
        self.pages.iter().map(poison).collect()
    }
}

/// Gives an epoch the civil signal on L2, which receivers measure.
fn measurable(epoch: &mut MeasuredEpoch) {
    let signals = epoch.satellites.iter_mut().flat_map(|satellite| &mut satellite.signals);
    signals.filter(|signal| signal.attribute == 'W').for_each(|signal| signal.attribute = 'L');
}

/// Returns a time as seconds since the start of Galileo's.
pub(super) fn gst_s(time: GpsTime) -> u32 {
    (time.to_ms() / 1000 - GALILEO_WEEKS * WEEK_S) as u32
}
