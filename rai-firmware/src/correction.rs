//! From raw ranges to an epoch: which range, which orbit, what delays, how uncertain.
//!
//! ```text
//! ρ = P − τ_b c + c Δt_sat − T(el) − I(el)
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `P − τ_b c` | [`crate::signal::Choice::range_m`] | m |
//! | `Δt_sat` | [`crate::ephemeris::SatelliteState::clock_s`] | s |
//! | `T`, `I` | tropospheric and ionospheric slant delay ([`crate::atmosphere`]) | m |
//! | `ρ` | [`Observation::range_m`] | m |
//!
//! It happens in two steps, because only the second needs to know where the receiver is: [`locate`] finds the
//! satellites once for each epoch, which is the expensive part; [`Site::correct`] can be repeated about a better point.
//!
//! References: [Klobuchar1987] J. A. Klobuchar, *Ionospheric time-delay algorithm for single-frequency GPS users*.

use heapless::Vec;
use rai_core::epoch::{Epoch, EpochError, Observation};
use rai_core::frame::{Ecef, Enu, Geodetic, LocalFrame, SPEED_OF_LIGHT_M_S};
use rai_core::satellite::{Constellation, SatelliteId};
use rai_core::weighting::{ErrorBudget, ephemeris_sigma_m, sigma_m};

use crate::atmosphere::{Klobuchar, Troposphere};
use crate::counters::{count, counters};
use crate::ephemeris::{self, EphemerisError, Store};
use crate::rtcm::{RawEpoch, RawSatellite};
use crate::signal::{Band, choose};
use crate::time::GpsTime;

pub use rai_core::single::CAPACITY;

/// Share of the modelled delay that the model misses, one sigma: the broadcast coefficients remove half of the
/// delay, rms ([Klobuchar1987]).
const IONOSPHERE_MISSED: f64 = 0.5;

/// The same without coefficients, when only the night-time constant of 1.5 m is modelled: 3 m at the zenith.
const IONOSPHERE_MISSED_BLIND: f64 = 2.0;

/// What a range that is not combined like most of its system's differs by, one sigma, m.
///
/// A receiver's delay differs between carriers by some metres, and combining amplifies that. Common to all satellites
/// of a system it is part of the clock; where combinations are mixed it is an error of the few.
const MIXED_M: f64 = 10.0;

/// Sigma of every range while the position is unknown, m.
const COARSE_SIGMA_M: f64 = 30.0;

counters! {
    /// Why satellites of an epoch were not used.
    Refusals {
        /// No signal whose delay is known.
        signal_unusable,
        /// More satellites than an epoch holds.
        epoch_full,
        /// A corrected range, position or sigma that no satellite can have.
        range_implausible,
        /// The same satellite twice.
        satellite_twice,
        /// Below the elevation mask. Not a fault.
        below_mask,
    }
}

/// What became of an epoch's satellites, since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Without a usable ephemeris.
    pub ephemerides: ephemeris::Refusals,
    /// Refused for another reason.
    pub ranges: Refusals,
}

/// A satellite whose position is known and whose range lacks only what depends on the receiver's position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Located {
    satellite: SatelliteId,
    position: Ecef,
    range_m: f64,
    noise_gain: f64,
    ephemeris_m: f64,
    bands: (Band, Option<Band>),
}

/// The satellites of an epoch whose positions are known.
pub type Sky = Vec<Located, CAPACITY>;

/// Finds the satellites of an epoch; what cannot be used is counted by reason.
///
/// Not inlined: the sky is then made where the caller wants it, and not moved there.
#[inline(never)]
pub fn locate(raw: &RawEpoch, store: &Store, tally: &mut Tally) -> Sky {
    let mut sky = Sky::new();
    for satellite in &raw.satellites {
        match locate_one(satellite, raw.time, store) {
            Ok(Some(located)) => {
                if sky.push(located).is_err() {
                    count(&mut tally.ranges.epoch_full);
                }
            }
            Ok(None) => count(&mut tally.ranges.signal_unusable),
            Err(reason) => tally.ephemerides.count(reason),
        }
    }
    charge_mixing(&mut sky);
    sky
}

/// Adds the receiver's delay between carriers to those whose combination is not the most frequent of their system.
fn charge_mixing(sky: &mut Sky) {
    for constellation in Constellation::ALL {
        let usual = usual_bands(sky, constellation);
        let others = sky.iter_mut().filter(|located| {
            located.satellite.constellation() == constellation && Some(located.bands) != usual
        });
        for located in others {
            located.ephemeris_m = libm::hypot(located.ephemeris_m, MIXED_M);
        }
    }
}

/// The combination that most satellites of a system have; the first of equals.
fn usual_bands(sky: &Sky, constellation: Constellation) -> Option<(Band, Option<Band>)> {
    let of_system = || sky.iter().filter(|located| located.satellite.constellation() == constellation);
    let mut usual = None;
    for located in of_system() {
        let count = of_system().filter(|other| other.bands == located.bands).count();
        if usual.is_none_or(|(most, _)| count > most) {
            usual = Some((count, located.bands));
        }
    }
    usual.map(|(_, bands)| bands)
}

/// One satellite; `None` without a signal whose delay is known.
fn locate_one(
    satellite: &RawSatellite,
    time: GpsTime,
    store: &Store,
) -> Result<Option<Located>, EphemerisError> {
    let ephemeris = store.get(satellite.satellite, time)?;
    let Some(choice) = choose(&satellite.signals, ephemeris) else {
        return Ok(None);
    };
    let state = ephemeris.at(time, choice.range_m)?;
    let promised_m = ephemeris.accuracy_m().unwrap_or(0.0);
    Ok(Some(Located {
        satellite: satellite.satellite,
        position: state.position,
        range_m: choice.range_m + SPEED_OF_LIGHT_M_S * state.clock_s,
        noise_gain: choice.noise_factor,
        ephemeris_m: libm::hypot(ephemeris_sigma_m(satellite.satellite, promised_m), choice.uncalibrated_m),
        bands: choice.bands,
    }))
}

/// An epoch without atmosphere and mask, to find out roughly where the receiver is.
pub fn coarse(sky: &Sky, time: GpsTime) -> Epoch<CAPACITY> {
    let mut epoch = Epoch::new(time.to_s());
    for located in sky {
        // What is refused here is refused, and counted, again by `correct`.
        let _ = epoch.push(Observation {
            satellite: located.satellite,
            position: located.position,
            range_m: located.range_m,
            sigma_m: COARSE_SIGMA_M,
        });
    }
    epoch
}

/// Where a receiver is, roughly, and what is known of the air above it.
#[derive(Clone, Copy, Debug)]
pub struct Site {
    point: Ecef,
    frame: LocalFrame,
    geodetic: Geodetic,
    time: GpsTime,
    sin_mask: f64,
    troposphere: Troposphere,
    klobuchar: Klobuchar,
    ionosphere_missed: f64,
}

impl Site {
    /// The site at a point known to some hundred metres.
    ///
    /// `mask_rad` is the elevation below which satellites are left out; `coefficients` are Klobuchar's, where a
    /// command gave them.
    pub fn new(point: Ecef, time: GpsTime, mask_rad: f64, coefficients: Option<[f64; 8]>) -> Self {
        let frame = LocalFrame::at(point);
        let (klobuchar, ionosphere_missed) = match coefficients.and_then(Klobuchar::new) {
            Some(klobuchar) => (klobuchar, IONOSPHERE_MISSED),
            None => (Klobuchar::NIGHT, IONOSPHERE_MISSED_BLIND),
        };
        Self {
            point,
            frame,
            geodetic: frame.geodetic(),
            time,
            sin_mask: libm::sin(mask_rad),
            troposphere: Troposphere::above(frame.height_m(), frame.sin_latitude()),
            klobuchar,
            ionosphere_missed,
        }
    }

    /// The epoch as this site sees it; what is left out is counted by reason.
    ///
    /// Not inlined: the epoch is then made where the caller wants it, and not moved there.
    #[inline(never)]
    pub fn correct(&self, sky: &Sky, refusals: &mut Refusals) -> Epoch<CAPACITY> {
        let mut epoch = Epoch::new(self.time.to_s());
        for located in sky {
            let line_of_sight = self.line_of_sight(located.position);
            if line_of_sight.up < self.sin_mask {
                count(&mut refusals.below_mask);
                continue;
            }
            if let Err(error) = epoch.push(self.observe(located, line_of_sight)) {
                count(match error {
                    EpochError::Range | EpochError::Position | EpochError::Sigma => {
                        &mut refusals.range_implausible
                    }
                    EpochError::Duplicate => &mut refusals.satellite_twice,
                    EpochError::Full => &mut refusals.epoch_full,
                });
            }
        }
        epoch
    }

    /// Unit vector towards a satellite.
    fn line_of_sight(&self, satellite: Ecef) -> Enu {
        let difference = satellite - self.point;
        let scale = 1.0 / difference.radius_m();
        let Enu { east, north, up } = self.frame.rotate(difference);
        Enu { east: east * scale, north: north * scale, up: up * scale }
    }

    fn observe(&self, located: &Located, line_of_sight: Enu) -> Observation {
        let ionosphere_m = match located.bands {
            (band, None) => self.klobuchar.delay_m(&self.geodetic, line_of_sight, self.time, band),
            (_, Some(_)) => 0.0,
        };
        let budget = ErrorBudget {
            sin_elevation: line_of_sight.up,
            ephemeris_m: located.ephemeris_m,
            noise_gain: located.noise_gain,
            ionosphere_m: self.ionosphere_missed * ionosphere_m,
        };
        Observation {
            satellite: located.satellite,
            position: located.position,
            range_m: located.range_m - self.troposphere.delay_m(line_of_sight.up) - ionosphere_m,
            sigma_m: sigma_m(&budget),
        }
    }
}
