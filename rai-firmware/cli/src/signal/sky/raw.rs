//! Raw measurements of a simulated sky, as a two-frequency receiver at a site would record them.
//!
//! ```text
//! ρ = |x_sat − x_rec| + c (dt − dt_sat) + T + I_f + b + σ ε          t = t_tag − dt
//! ```
//!
//! | symbol | meaning | from |
//! |---|---|---|
//! | `dt`, `t_tag` | receiver clock, and the time that it shows | [`super::oscillator`] |
//! | `dt_sat` | satellite clock with relativity | [`super::broadcast`] |
//! | `T`, `I_f` | troposphere, ionosphere at the signal's frequency | [`super::atmosphere`] |
//! | `b` | error of the broadcast orbit and clock, constant for each satellite | [`BROADCAST_ERROR_M`] |
//! | `σ ε` | code noise, independent from signal to signal and epoch to epoch | [`super::noise`] |
//!
//! Signals are L1 C/A and L2 P(Y) of GPS, E1 and E5a of Galileo, B1I and B3I of `BeiDou`, whose
//! broadcast clock refers to B3I. Group delays are zero. The result is a [`Recording`], so
//! everything that works on recordings works on it.

use std::f64::consts::FRAC_PI_2;
use std::slice;

use raim_core::frame::SPEED_OF_LIGHT_M_S;
use raim_core::satellite::Constellation;
use raim_firmware::time::GpsTime;

use super::atmosphere::{ionosphere_m, troposphere_m};
use super::broadcast::{SatelliteClock, ephemeris};
use super::{Fleet, Noise, Oscillator, ReceiverClock, Satellite, Sight, Site, sights};
use crate::signal::measurement::Recording;
use crate::signal::measurement::{MeasuredEpoch, MeasuredSatellite, MeasuredSignal, TimedEphemeris};
use crate::signal::skipped::Skipped;

/// Interval between new ephemerides, s.
const RENEWAL_S: f64 = 3600.0;

/// Standard deviation of the error of a broadcast orbit and clock along the line of sight, m, as
/// the operators report it for ordinary days.
pub const BROADCAST_ERROR_M: f64 = 0.7;

/// Channel of the noise of that error; signals count their channels from 0.
const BROADCAST_CHANNEL: u8 = u8::MAX;

/// A sky to be recorded.
#[derive(Clone, Debug)]
pub struct Simulation {
    /// Satellites of the sky.
    pub satellites: Vec<Satellite>,
    /// Site of the antenna.
    pub site: Site,
    /// GPS time of `t = 0`: a multiple of 16 s.
    pub origin: GpsTime,
    /// Time of the first epoch, s.
    pub start_s: f64,
    /// Number of epochs.
    pub epochs: u32,
    /// Time between epochs, s.
    pub step_s: f64,
    /// Elevation below which nothing is received, rad.
    pub mask_rad: f64,
    /// Oscillator of the receiver.
    pub oscillator: Oscillator,
    /// Electron content above the site, 10¹⁶ per m².
    pub electrons_tecu: f64,
    /// Seed of all random choices.
    pub seed: u64,
    /// True if the receiver measures Doppler frequencies.
    pub has_range_rates: bool,
}

/// A signal, by its RINEX name, and its frequency.
struct Signal {
    band: u8,
    attribute: char,
    frequency_hz: f64,
}

/// L1 C/A, L2 P(Y) ([IS-GPS-200] 3.3.1.1).
///
/// [IS-GPS-200]: crate#references
const GPS: [Signal; 2] = [
    Signal { band: 1, attribute: 'C', frequency_hz: 1_575.42e6 },
    Signal { band: 2, attribute: 'W', frequency_hz: 1_227.60e6 },
];

/// E1 C, E5a Q ([Galileo-OS-SIS-ICD] table 2).
///
/// [Galileo-OS-SIS-ICD]: crate#references
const GALILEO: [Signal; 2] = [
    Signal { band: 1, attribute: 'C', frequency_hz: 1_575.42e6 },
    Signal { band: 5, attribute: 'Q', frequency_hz: 1_176.45e6 },
];

/// B1I, B3I ([BDS-SIS-ICD]).
///
/// [BDS-SIS-ICD]: crate#references
const BEIDOU: [Signal; 2] = [
    Signal { band: 2, attribute: 'I', frequency_hz: 1_561.098e6 },
    Signal { band: 6, attribute: 'I', frequency_hz: 1_268.52e6 },
];

impl Simulation {
    /// Returns a simulation of New Year's Day of 2024 (`t = 0` is midnight, GPS time) above Xi'an,
    /// the site of the papers: GPS of 31 satellites and the regional `BeiDou` system, one epoch per
    /// second.
    pub fn above_xian(start_s: f64, epochs: u32, seed: u64) -> Self {
        let fleets = [Fleet::Gps31, Fleet::BeidouRegional];
        Self {
            satellites: fleets.into_iter().flat_map(Fleet::satellites).collect(),
            site: Site::geodetic(34.17, 108.57, 400.0),
            origin: GpsTime { week: 2295, tow_ms: 86_400_000 },
            start_s,
            epochs,
            step_s: 1.0,
            mask_rad: 5.0_f64.to_radians(),
            oscillator: Oscillator::temperature_compensated(),
            electrons_tecu: 20.0,
            seed,
            has_range_rates: false,
        }
    }

    /// Records the sky.
    pub fn record(&self) -> Recording {
        Recording {
            epochs: self.epochs().collect(),
            ephemerides: self.ephemerides(),
            klobuchar: None,
            leap_s: None,
            skipped: Skipped::default(),
            approximate_position: Some(self.site.position),
        }
    }

    /// Returns the satellites in view at an epoch, by true time.
    pub fn sights_at(&self, epoch: u32) -> Vec<Sight> {
        let t_s = self.start_s + f64::from(epoch) * self.step_s;
        sights(&self.satellites, &self.site, t_s, self.mask_rad)
    }

    /// Returns the ephemerides that the satellites broadcast meanwhile.
    pub fn ephemerides(&self) -> Vec<TimedEphemeris> {
        let first = (self.start_s / RENEWAL_S).floor() as u32;
        let end_s = self.start_s + f64::from(self.epochs) * self.step_s;
        let last = (end_s / RENEWAL_S).floor() as u32 + 1;
        let of_hour = |hour: u32| {
            let of_satellite = move |satellite: &Satellite| {
                // Twenty-five numbers suffice, as many as the hours that the shortest field counts.
                ephemeris(satellite, self.origin, f64::from(hour) * RENEWAL_S, (hour % 25) as u8)
            };
            self.satellites.iter().filter_map(of_satellite)
        };
        (first..=last).flat_map(of_hour).collect()
    }

    /// Returns the receiver's clock before the first epoch. It advances from epoch to epoch.
    pub fn clock(&self) -> ReceiverClock {
        const AT_START_S: f64 = 5e-5;
        ReceiverClock::new(self.oscillator, self.step_s, AT_START_S, self.seed ^ u64::MAX)
    }

    /// Returns the epochs one by one, for recordings of any length.
    pub fn epochs(&self) -> impl Iterator<Item = MeasuredEpoch> + '_ {
        let noise = Noise::new(self.seed);
        let mut clock = self.clock();
        (0..self.epochs).map(move |epoch| {
            let tag_s = self.start_s + f64::from(epoch) * self.step_s;
            let clock_s = clock.advance();
            let seen = sights(&self.satellites, &self.site, tag_s - clock_s, self.mask_rad);
            let drift_m_s = SPEED_OF_LIGHT_M_S * clock.fractional_frequency();
            let raw =
                |sight: &Sight| self.raw_satellite(sight, (clock_s, drift_m_s), &noise, u64::from(epoch));
            MeasuredEpoch { time: self.time_at(tag_s), satellites: seen.iter().filter_map(raw).collect() }
        })
    }

    fn time_at(&self, t_s: f64) -> GpsTime {
        GpsTime::from_ms(self.origin.to_ms() + (t_s * 1e3).round() as u64)
    }

    fn raw_satellite(
        &self,
        sight: &Sight,
        (clock_s, drift_m_s): (f64, f64),
        noise: &Noise,
        epoch: u64,
    ) -> Option<MeasuredSatellite> {
        let satellite = self.satellites.iter().find(|satellite| satellite.id == sight.satellite)?;
        let sin_elevation = sight.line_of_sight.up;
        let satellite_clock_s =
            SatelliteClock::of(satellite.id).at(sight.sent_s) + satellite.orbit.relativity_s(sight.sent_s);
        let error_m = BROADCAST_ERROR_M * noise.normal(satellite.id, BROADCAST_CHANNEL, 0);
        let common_m = sight.range_m
            + error_m
            + SPEED_OF_LIGHT_M_S * (clock_s - satellite_clock_s)
            + troposphere_m(sin_elevation, self.site.frame.height_m());
        let received_s = sight.sent_s + sight.range_m / SPEED_OF_LIGHT_M_S;
        let rate_m_s = self.has_range_rates.then(|| self.range_rate_m_s(satellite, received_s)).flatten();
        let rate_m_s = rate_m_s.map(|rate_m_s| rate_m_s + drift_m_s);
        let signal = |(channel, signal): (u8, &Signal)| MeasuredSignal {
            band: signal.band,
            attribute: signal.attribute,
            pseudorange_m: common_m
                + ionosphere_m(sin_elevation, signal.frequency_hz, self.electrons_tecu)
                + code_noise_m(sin_elevation) * noise.normal(satellite.id, channel, epoch),
            carrier_cycles: None,
            cn0_dbhz: Some(36.0 + 14.0 * sin_elevation),
            doppler_hz: rate_m_s.map(|rate_m_s| -rate_m_s * signal.frequency_hz / SPEED_OF_LIGHT_M_S),
        };
        let signals = signals_of(satellite.id.constellation())?;
        Some(MeasuredSatellite { satellite: satellite.id, signals: (0..).zip(signals).map(signal).collect() })
    }

    /// Returns the rate of a satellite's range about an instant, by a receiver's clock without
    /// drift, m/s.
    fn range_rate_m_s(&self, satellite: &Satellite, t_s: f64) -> Option<f64> {
        const APART_S: f64 = 1.0;
        let clock = SatelliteClock::of(satellite.id);
        let range_m = |t_s: f64| {
            let sight = sights(slice::from_ref(satellite), &self.site, t_s, -FRAC_PI_2).pop()?;
            let clock_s = clock.at(sight.sent_s) + satellite.orbit.relativity_s(sight.sent_s);
            Some(sight.range_m - SPEED_OF_LIGHT_M_S * clock_s)
        };
        Some((range_m(t_s + APART_S / 2.0)? - range_m(t_s - APART_S / 2.0)?) / APART_S)
    }
}

fn signals_of(constellation: Constellation) -> Option<&'static [Signal]> {
    match constellation {
        Constellation::Gps => Some(&GPS),
        Constellation::Beidou => Some(&BEIDOU),
        Constellation::Galileo => Some(&GALILEO),
        _ => None,
    }
}

/// Returns code noise and multipath of a good antenna in the open, m: 0.3 m independent of the
/// direction, and 0.3 m at the zenith that grow towards the horizon.
fn code_noise_m(sin_elevation: f64) -> f64 {
    0.3 * libm::hypot(1.0, 1.0 / sin_elevation.max(0.05))
}
