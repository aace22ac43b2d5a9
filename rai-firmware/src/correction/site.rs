//! The receiver's place: directions to satellites, and the delays of the air above it.
//!
//! Directions, delays and sigmas come from models or linearisation, for which single precision is
//! more than accurate enough.

use raim_core::epoch::{Epoch, EpochError, Observation};
use raim_core::frame::{Ecef, LocalAxes};
use raim_core::internals::numeric::angle::sine;
use raim_core::internals::weighting::ionosphere::IonosphereError;
use raim_core::internals::weighting::shared::SharedError;
use raim_core::internals::weighting::{
    ErrorBudget, Ism, MIXED_CARRIERS_M, UserModel, ephemeris_sigma_m, integrity_sigma_with_m, reflection_m2,
    sigma_with_m,
};
use raim_core::satellite::Constellation;

use super::atmosphere::{Klobuchar, Place, Troposphere};
use super::frequency::Ranges;
use super::horizon::Horizon;
use super::{CAPACITY, Choice, Fate, Located, Sky, Tally, sum_m};
use crate::counters::count;
use crate::raw::Band;
use crate::time::GpsTime;

/// The approximate place of a receiver, with the models of the air above it.
#[derive(Clone, Debug)]
pub struct Site {
    horizon: Horizon,
    time: GpsTime,
    place: Place,
    sin_mask: f32,
    troposphere: Troposphere,
    klobuchar: Option<Klobuchar>,
    ranges: Ranges,
    ism: Option<Ism>,
}

/// A range for the epoch.
#[derive(Clone, Copy)]
struct Corrected {
    range_m: f64,
    sigma_m: f32,
    /// Receiver's part of the variance, m².
    receiver_m2: f32,
    shared: SharedError,
}

/// Use of the ionosphere's residual error.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Ionosphere {
    /// The whole error counts as noise of each range.
    Whole,
    /// The error is divided into a part of each range and a part that all ranges share
    /// ([`raim_core::internals::weighting::ionosphere`]).
    Divided,
}

impl Site {
    /// Returns the site at a point known to some hundred metres.
    ///
    /// `mask_rad` is the elevation below which satellites are left out. `klobuchar` is the model of
    /// the ionosphere, if its coefficients are known. The site prefers pairs of frequencies, until
    /// [`Self::with_ranges`] changes that.
    pub fn new(point: Ecef, time: GpsTime, mask_rad: f64, klobuchar: Option<Klobuchar>) -> Self {
        let axes = LocalAxes::at(point);
        let [latitude_rad, longitude_rad] = axes.latitude_and_longitude_rad();
        Self {
            horizon: Horizon::at(point, &axes),
            time,
            place: Place::at(latitude_rad, longitude_rad, time),
            sin_mask: sine(mask_rad as f32),
            troposphere: Troposphere::above(axes.height_m(), axes.sin_latitude()),
            klobuchar,
            ranges: Ranges::Pairs,
            ism: None,
        }
    }

    /// Returns the same site, with this kind of ranges for a satellite that offers both.
    #[must_use]
    pub fn with_ranges(self, ranges: Ranges) -> Self {
        Self { ranges, ..self }
    }

    /// Returns the same site, with sigmas from the ISM. `None` keeps the sigmas of the error
    /// budget.
    #[must_use]
    pub fn weighted_by(self, ism: Option<Ism>) -> Self {
        Self { ism, ..self }
    }

    /// Builds the epoch of this site; satellites left out are counted by reason.
    #[inline(never)]
    pub fn correct(&self, sky: &Sky, tally: &mut Tally, epoch: &mut Epoch<CAPACITY>) {
        epoch.restart(self.time.to_s());
        let Tally { ranges: refusals, notes, .. } = tally;
        let usual = Usual::of(sky, self.ranges);
        let ionosphere = self.ionosphere_of(sky);
        for located in sky {
            let Some(corrected) = self.observe(located, self.ranges, &usual, ionosphere) else {
                count(&mut refusals.below_mask);
                notes.refuse(located.satellite, Fate::BelowMask);
                continue;
            };
            let observation = Observation {
                satellite: located.satellite,
                position: located.position(),
                range_m: corrected.range_m,
                sigma_m: f64::from(corrected.sigma_m),
            };
            let pushed = epoch.push_sharing(observation, corrected.shared);
            if cfg!(feature = "past") && pushed.is_ok() {
                epoch.set_receiver_m2(corrected.receiver_m2);
            }
            if let Err(error) = pushed {
                count(match error {
                    EpochError::Duplicate => &mut refusals.satellite_twice,
                    EpochError::Full => &mut refusals.epoch_full,
                    // A number of the range, its position or its sigma.
                    _ => &mut refusals.range_implausible,
                });
                notes.refuse(located.satellite, error);
            }
        }
    }

    /// Returns the use of the ionosphere's error for these ranges: divided if all are of one
    /// frequency, except for ARAIM.
    fn ionosphere_of(&self, sky: &Sky) -> Ionosphere {
        let is_pair = |located: &Located| {
            located.range(self.ranges).is_some_and(|(choice, _)| choice.bands.1.is_some())
        };
        if self.ism.is_none() && !sky.iter().any(is_pair) { Ionosphere::Divided } else { Ionosphere::Whole }
    }

    /// Returns the corrected range of one satellite, or `None` below the mask.
    fn observe(
        &self,
        located: &Located,
        ranges: Ranges,
        usual: &Usual,
        ionosphere: Ionosphere,
    ) -> Option<Corrected> {
        let line_of_sight = self.line_of_sight(located);
        let [.., sin_elevation] = line_of_sight;
        if sin_elevation < self.sin_mask {
            return None;
        }
        let (choice, promised_m) = located.range(ranges)?;
        let (delay_m, error) = self.ionosphere(choice, line_of_sight);
        let is_single = ionosphere == Ionosphere::Divided;
        let error = if is_single { error } else { error.undivided() };
        let reflection_m2 = reflection_m2(sin_elevation, choice.weakness, is_single);
        let mixed_m =
            if usual.is(located.satellite.constellation(), choice) { 0.0 } else { MIXED_CARRIERS_M };
        let others_m2 = choice.uncalibrated_m * choice.uncalibrated_m + mixed_m * mixed_m + reflection_m2;
        let budget = ErrorBudget {
            sin_elevation,
            ephemeris_m: ephemeris_sigma_m(located.satellite, promised_m),
            noise_gain: choice.noise_gain,
            weakness: choice.weakness,
            ionosphere_m: error.own_m,
            user: self.ism.map_or(UserModel::Ground, |ism| ism.user),
        };
        let own_m2 = budget.receiver_m2();
        let air_m = self.troposphere.delay_m(sin_elevation) + delay_m;
        Some(Corrected {
            range_m: sum_m(choice.range_m, located.clock_m32, -air_m),
            sigma_m: match &self.ism {
                Some(ism) if cfg!(feature = "araim") => {
                    let support = ism.of(located.satellite.constellation());
                    integrity_sigma_with_m(&support, promised_m, &budget, own_m2 + others_m2)
                }
                _ => sigma_with_m(&budget, own_m2 + others_m2),
            },
            receiver_m2: own_m2,
            shared: error.shared,
        })
    }

    /// Returns the unit vector towards a satellite, east, north, up.
    fn line_of_sight(&self, located: &Located) -> [f32; 3] {
        self.horizon.direction(&self.horizon.way_to(located.coordinates_m()))
    }

    /// Returns the ionospheric delay of a range, m, and the residual of the model.
    fn ionosphere(&self, choice: &Choice, line_of_sight: [f32; 3]) -> (f32, IonosphereError) {
        let (band, None) = choice.bands else {
            return (0.0, IonosphereError::NONE);
        };
        let model = self.klobuchar.unwrap_or(Klobuchar::NIGHT);
        let slant = model.slant(self.place, line_of_sight);
        let [.., sin_elevation] = line_of_sight;
        let is_modelled = self.klobuchar.is_some();
        let error = IonosphereError::of(slant.delay_m, sin_elevation, slant.geomagnetic_sc, is_modelled);
        let dispersion = dispersion(band);
        (dispersion * slant.delay_m, error.times(dispersion))
    }
}

/// Returns the ratio of a band's ionospheric delay to that of L1, `f₁²/f²`.
fn dispersion(band: Band) -> f32 {
    let ratio = Band::L1.frequency_hz() as f32 / band.frequency_hz() as f32;
    ratio * ratio
}

/// Combination of bands that most satellites of each system have. If several are equally frequent,
/// it is the first.
struct Usual([Option<(Band, Option<Band>)>; Constellation::COUNT]);

impl Usual {
    fn of(sky: &Sky, ranges: Ranges) -> Self {
        Self(Constellation::ALL.map(|constellation| {
            let of_system = || {
                let mine = sky.iter().filter(|located| located.satellite.constellation() == constellation);
                mine.filter_map(|located| located.range(ranges)).map(|(choice, _)| choice.bands)
            };
            let mut usual = None;
            for bands in of_system() {
                if usual.is_some_and(|(_, known)| known == bands) {
                    continue;
                }
                let votes = of_system().filter(|other| *other == bands).count();
                if usual.is_none_or(|(most, _)| votes > most) {
                    usual = Some((votes, bands));
                }
            }
            usual.map(|(_, bands)| bands)
        }))
    }

    fn is(&self, constellation: Constellation, choice: &Choice) -> bool {
        let of_system = Constellation::ALL.iter().zip(&self.0).find(|(known, _)| **known == constellation);
        of_system.is_none_or(|(_, usual)| *usual == Some(choice.bands))
    }
}
