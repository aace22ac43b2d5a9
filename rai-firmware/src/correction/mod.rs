//! Corrections that turn raw ranges into an epoch: choice of ranges, orbits, delays and sigmas.
//!
//! ```text
//! ρ = P − τ_b c + c Δt_sat − T(el) − I(el)
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `P − τ_b c` | [`Choice::range_m`] | m |
//! | `Δt_sat` | [`crate::ephemeris::SatelliteState::clock_s`] | s |
//! | `T`, `I` | tropospheric and ionospheric slant delay ([`atmosphere`]) | m |
//! | `ρ` | [`Observation::range_m`] | m |
//!
//! Correction has two steps, because only the second depends on the receiver's position. [`locate`]
//! computes the satellite positions once for each epoch, which is the expensive part.
//! [`Site::correct`] can be repeated at a better point. If satellites have two frequencies, the
//! site also computes the noise part of the levels twice, with pairs of frequencies and with single
//! ones, and compares both ([`frequency`]).
//!
//! References: [Klobuchar1987] J. A. Klobuchar, *Ionospheric time-delay algorithm for
//! single-frequency GPS users*.
//!
//! [Klobuchar1987]: crate#references

use heapless::Vec;
use raim_core::epoch::{Epoch, Observation};
use raim_core::frame::{Ecef, LocalAxes};
use raim_core::internals::numeric::absolute::{Absolute as _, Grid};
use raim_core::internals::numeric::angle::sine;
use raim_core::internals::numeric::sqrt;
use raim_core::internals::weighting::COARSE_M;
use raim_core::satellite::SatelliteId;

use crate::counters::{count, counters};
use crate::ephemeris::{self, EphemerisError, Store, nearest, scaled};
#[cfg(feature = "cnav")]
use crate::raw::Band;
use crate::raw::{RawEpoch, RawSatellite, RawSignal};
use crate::settings::Systems;
use crate::time::GpsTime;
use horizon::Horizon;

mod atmosphere;
mod bands;
mod choice;
mod fate;
mod frequency;
pub(crate) mod horizon;
mod notes;
mod site;
mod twins;

pub use atmosphere::{Klobuchar, Place, Slant, Troposphere};
use choice::choose_by;
pub use choice::{Choice, Choices, SINGLES, choose, ionosphere_free};
pub use fate::Fate;
pub use frequency::{Cost, Preference, Ranges};
use notes::{Mark, Notes};
pub use raim_single::CAPACITY;
pub use site::Site;
#[cfg(feature = "osnma")]
pub(crate) use twins::remove;

counters! {
    /// Reasons for which satellites of an epoch were not used.
    Refusals {
        /// No signal is strong enough and has a known delay.
        signal_unusable,
        /// The epoch holds no more satellites.
        epoch_full,
        /// A corrected range, position or sigma is impossible for a satellite.
        range_implausible,
        /// Its two bands differ by more than the ionosphere can explain.
        bands_apart,
        /// The same satellite appeared twice, or two satellite numbers of one system have the same
        /// position.
        satellite_twice,
        /// The satellite is below the elevation mask, which is no fault.
        below_mask,
        /// The satellite's system is not in use, which is no fault.
        system_left_out,
    }
}

/// Counters of unused satellites since start, and notes on those of the last epoch.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tally {
    /// Satellites without a usable ephemeris.
    pub ephemerides: ephemeris::Refusals,
    /// Satellites refused for another reason.
    pub ranges: Refusals,
    pub(crate) notes: Notes,
}

impl Tally {
    /// Returns the state to which [`Self::restore`] returns.
    pub(crate) fn mark(&self) -> (Refusals, Mark) {
        (self.ranges, self.notes.mark())
    }

    /// Forgets the refusals after a mark, because they do not count.
    pub(crate) fn restore(&mut self, (ranges, notes): (Refusals, Mark)) {
        self.ranges = ranges;
        self.notes.truncate(notes);
    }
}

/// A satellite with a known position. Its ranges lack only the corrections that depend on the
/// receiver's position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Located {
    satellite: SatelliteId,
    place: [Grid; 3],
    /// Satellite clock times the speed of light, 2⁻³² m.
    clock_m32: i64,
    choices: Choices,
    /// Broadcast standard deviation of orbit and clock, for the pair and for the single range, m.
    promised_m: [f32; 2],
    /// Edition of its ephemeris among those that were received.
    edition: u32,
    /// True if the satellite calls its L5 out of service.
    #[cfg(feature = "cnav")]
    l5_is_out: bool,
}

impl Located {
    /// Returns true if two of its ranges combine.
    pub fn has_pair(&self) -> bool {
        self.choices.pair.is_some()
    }

    /// Returns the satellite.
    pub(crate) const fn satellite(&self) -> SatelliteId {
        self.satellite
    }

    /// Returns its position when the signal left.
    pub(crate) fn position(&self) -> Ecef {
        let [x_m, y_m, z_m] = self.place.map(Grid::widen);
        Ecef::new(x_m, y_m, z_m)
    }

    /// Returns its position when the signal left, on the grid of ranges.
    pub(crate) const fn place(&self) -> [Grid; 3] {
        self.place
    }

    /// Returns its position when the signal left, for directions, m: in steps of 1/8 m or those of
    /// single precision.
    fn coordinates_m(&self) -> [f32; 3] {
        Grid::vector(self.place)
    }

    /// Returns its clock when the signal left, times the speed of light, on the grid of ranges.
    pub(crate) const fn clock(&self) -> Grid {
        Grid::of_multiple(self.clock_m32, DIGITS as u32)
    }

    /// Returns a measured range, accurate to some ten metres, m.
    pub(crate) fn measured_m(&self) -> Option<f64> {
        self.range(Ranges::Singles).map(|(choice, _)| choice.range_m)
    }

    /// Returns a number that changes with the ephemeris.
    pub(crate) const fn edition(&self) -> u32 {
        self.edition
    }

    /// Returns true if its range contains an L5 that the satellite calls out of service.
    #[cfg(feature = "cnav")]
    pub(crate) fn uses_unhealthy_l5(&self, ranges: Ranges) -> bool {
        let has_l5 =
            |(choice, _): (&Choice, f32)| choice.bands.0 == Band::L5 || choice.bands.1 == Some(Band::L5);
        self.l5_is_out && self.range(ranges).is_some_and(has_l5)
    }

    /// Returns the chosen range, and the broadcast sigma of orbit and clock, m.
    fn range(&self, ranges: Ranges) -> Option<(&Choice, f32)> {
        let [of_pair_m, of_single_m] = self.promised_m;
        let pair = self.choices.pair.as_ref().map(|pair| (pair, of_pair_m));
        let single = self.choices.single.as_ref().map(|single| (single, of_single_m));
        match ranges {
            Ranges::Pairs => pair.or(single),
            Ranges::Singles => single.or(pair),
        }
    }
}

/// Returns `√(a² + b²)`.
fn root_of_squares(a: f32, b: f32) -> f32 {
    if b == 0.0 { a } else { sqrt(a * a + b * b) }
}

/// Binary digits behind the point of lengths that are stored as integers. Such an integer holds
/// every digit of a range, and an addition costs a third of that of doubles here.
const DIGITS: i32 = 32;

/// Returns `length + second + added`, m, for lengths up to 10⁹ m. `second_m32` is in units of 2⁻³²
/// m.
#[inline(never)]
fn sum_m(length_m: f64, second_m32: i64, added_m: f32) -> f64 {
    /// Digits of the larger part of the added length.
    const COARSE: i32 = 12;
    /// Largest added length whose larger part fits 32 bits, m.
    const LARGEST_M: f32 = 5e5;
    if !(added_m.abs() < LARGEST_M) {
        return length_m + scaled(second_m32, -DIGITS) + f64::from(added_m);
    }
    let coarse = (added_m * (1 << COARSE) as f32) as i32;
    let rest_m = added_m - coarse as f32 * (1.0 / (1 << COARSE) as f32);
    let rest = (rest_m * (1_u64 << DIGITS) as f32) as i32;
    let added = (i64::from(coarse) << (DIGITS - COARSE)) + i64::from(rest);
    // Wrapping avoids an overflow if a length is not finite. No epoch accepts such a sum.
    let sum = nearest(length_m, DIGITS).wrapping_add(second_m32);
    scaled(sum.wrapping_add(added), -DIGITS)
}

/// Returns the difference of two lengths up to 5·10⁷ m, in single precision, m.
#[inline(never)]
fn difference_m(first_m: f64, second_m: f64) -> f32 {
    /// Bits of the lower part, chosen so that each part fits into 32 bits.
    const LOWER: i32 = 27;
    const COARSE_M: f32 = 1.0 / (1 << (DIGITS - LOWER)) as f32;
    const FINE_M: f32 = 1.0 / (1_u64 << DIGITS) as f32;
    let difference = nearest(first_m, DIGITS).wrapping_sub(nearest(second_m, DIGITS));
    let lower = (difference & ((1 << LOWER) - 1)) as i32;
    (difference >> LOWER) as i32 as f32 * COARSE_M + lower as f32 * FINE_M
}

/// Satellites of an epoch with known positions.
pub type Sky = Vec<Located, CAPACITY>;

/// The sky above the mask of a receiver at a point.
pub(crate) struct View {
    horizon: Horizon,
    sin_mask: f32,
}

impl View {
    /// Returns the view from a point, above an elevation.
    pub(crate) fn from(point: Ecef, mask_rad: f64) -> Self {
        Self { horizon: Horizon::at(point, &LocalAxes::at(point)), sin_mask: sine(mask_rad as f32) }
    }

    fn shows(&self, located: &Located) -> bool {
        let way = self.horizon.way_to(located.coordinates_m());
        let [.., sin_elevation] = self.horizon.direction(&way);
        sin_elevation >= self.sin_mask
    }
}

/// Computes the satellites of an epoch, and replaces those in `sky` by them. Unused satellites are
/// counted by reason.
#[inline(never)]
pub fn locate(
    raw: &RawEpoch,
    store: &Store,
    mask_dbhz: f32,
    systems: Systems,
    tally: &mut Tally,
    sky: &mut Sky,
) {
    locate_within(raw, store, mask_dbhz, systems, None, tally, sky);
}

/// Strength of a signal of which a receiver says none, while it says that of others, dB-Hz: in streets
/// two thirds of all signals are stronger.
const UNSAID_DBHZ: f32 = 28.0;

/// Works like [`locate`]. If the satellites exceed the capacity, those outside the view are left
/// out.
#[inline(never)]
pub(crate) fn locate_within(
    raw: &RawEpoch,
    store: &Store,
    mask_dbhz: f32,
    systems: Systems,
    view: Option<&View>,
    tally: &mut Tally,
    sky: &mut Sky,
) {
    sky.clear();
    tally.notes.clear();
    let mut crowd = Crowd { view, seen: 0 };
    // If a receiver reports strength for some signals, one without a report counts as weak.
    let mut signals = raw.satellites.iter().flat_map(|satellite| &satellite.signals);
    let is_said = signals.any(|signal| signal.cn0_dbhz().is_some());
    let unsaid_dbhz = if is_said { mask_dbhz.max(UNSAID_DBHZ) } else { f32::INFINITY };
    for satellite in &raw.satellites {
        let (letter, _) = satellite.satellite.name();
        if !systems.contains(letter) {
            count(&mut tally.ranges.system_left_out);
            tally.notes.refuse(satellite.satellite, Fate::SystemLeftOut);
            continue;
        }
        match locate_one(satellite, raw.time, store, (mask_dbhz, unsaid_dbhz), &mut crowd, sky) {
            Ok(Placed::Yes) => {}
            Ok(Placed::Instead) => count(&mut tally.ranges.below_mask),
            Ok(Placed::Full) => {
                count(&mut tally.ranges.epoch_full);
                tally.notes.refuse(satellite.satellite, Fate::EpochFull);
            }
            Ok(Placed::WithoutSignal) => {
                count(&mut tally.ranges.signal_unusable);
                tally.notes.refuse(satellite.satellite, Fate::SignalUnusable);
            }
            Err(reason) => {
                tally.ephemerides.count(reason);
                tally.notes.refuse(satellite.satellite, reason);
            }
        }
    }
    // Those that others have replaced.
    tally.notes.refuse_missing(raw, sky, Fate::BelowMask);
    if cfg!(feature = "signs") {
        twins::remove_twins(sky, &mut tally.ranges.satellite_twice);
        tally.notes.refuse_missing(raw, sky, Fate::Twice);
        bands::remove_apart(sky, &mut tally.ranges.bands_apart);
        tally.notes.refuse_missing(raw, sky, Fate::BandsApart);
    }
}

/// Outcome for a satellite with a usable ephemeris.
enum Placed {
    /// The satellite is in the sky.
    Yes,
    /// The satellite is in the sky, and has replaced one outside the view.
    Instead,
    /// The sky is full.
    Full,
    /// No signal is strong enough and has a known delay.
    WithoutSignal,
}

/// Rule for a sky with more satellites than capacity.
struct Crowd<'v> {
    view: Option<&'v View>,
    /// Number of satellites at the beginning of the sky that are known to be inside the view, and
    /// stay.
    seen: usize,
}

impl Crowd<'_> {
    /// Replaces a satellite outside the view by this one.
    #[cold]
    #[inline(never)]
    fn replace(&mut self, sky: &mut Sky, located: &Located) -> Placed {
        let Some(view) = self.view else { return Placed::Full };
        for place in sky.iter_mut().skip(self.seen) {
            if !view.shows(place) {
                *place = *located;
                return Placed::Instead;
            }
            self.seen += 1;
        }
        Placed::Full
    }
}

/// Puts one satellite into the sky.
fn locate_one(
    satellite: &RawSatellite,
    time: GpsTime,
    store: &Store,
    (mask_dbhz, unsaid_dbhz): (f32, f32),
    crowd: &mut Crowd<'_>,
    sky: &mut Sky,
) -> Result<Placed, EphemerisError> {
    let (ephemeris, edition) = store.get_edition(satellite.satellite, time)?;
    let word = store.word(satellite.satellite);
    let choices = choose_by(&satellite.signals, ephemeris, word, mask_dbhz, unsaid_dbhz);
    let Some(choice) = choices.preferred() else {
        let is_served =
            |signal: &RawSignal| ephemeris.serves(signal.carrier.band) && word.serves(signal.carrier.band);
        return if satellite.signals.iter().any(is_served) {
            Ok(Placed::WithoutSignal)
        } else {
            Err(EphemerisError::Unhealthy)
        };
    };
    // One range serves both choices, because they differ by less than 100 m. While a signal travels
    // 100 m, the satellite moves by a millimetre.
    let state = ephemeris.seen_at(time, choice.range_m)?;
    let promise = |choice: &Option<Choice>| {
        choice.as_ref().and_then(|choice| ephemeris.accuracy_m(choice.bands)).unwrap_or(0.0)
    };
    let promised_m = [promise(&choices.pair), promise(&choices.single)];
    let pushed = sky.push(Located {
        satellite: satellite.satellite,
        place: state.place(),
        clock_m32: state.clock_m32(),
        choices,
        promised_m,
        edition,
        #[cfg(feature = "cnav")]
        l5_is_out: word.l5_is_out,
    });
    Ok(match pushed {
        Ok(()) => Placed::Yes,
        Err(located) => crowd.replace(sky, &located),
    })
}

/// Builds an epoch without atmosphere and mask, for a coarse position of the receiver.
pub fn coarse(sky: &Sky, time: GpsTime, epoch: &mut Epoch<CAPACITY>) {
    epoch.restart(time.to_s());
    for located in sky {
        let Some((choice, _)) = located.range(Ranges::Pairs) else { continue };
        // `correct` refuses and counts the same observation again.
        let _ = epoch.push(Observation {
            satellite: located.satellite,
            position: located.position(),
            range_m: sum_m(choice.range_m, located.clock_m32, 0.0),
            sigma_m: f64::from(COARSE_M),
        });
    }
}

#[cfg(test)]
mod tests {
    use super::{DIGITS, difference_m, nearest, sum_m};

    #[test]
    fn sums_and_differences_of_lengths_are_those_of_doubles() {
        let lengths_m = [1.0e7, 2.345_678_901_234e7, 5.2e7, -123_456.789, 0.0, 3.7e7];
        let added_m = [0.0, 1e-6, -2.997_924_6, 7.123_456, -137.25, 9_999.9, 4.9e5, -5e5, 1e6, -4.2e7_f32];
        for (first, second) in lengths_m.iter().flat_map(|a| lengths_m.iter().map(move |b| (*a, *b))) {
            for added in added_m {
                let second_m32 = nearest(second, DIGITS);
                let (have, want) = (sum_m(first, second_m32, added), first + second + f64::from(added));
                // Roundings of the two additions, and one of the integers.
                assert!((have - want).abs() <= 3e-8, "{first} + {second} + {added}: {have}, not {want}");
            }
            let (have, want) = (f64::from(difference_m(first, second)), first - second);
            // Three roundings to 24 digits.
            assert!((have - want).abs() <= 1e-9 + 1.2e-7 * want.abs(), "{first} - {second}: {have}");
        }
        let second_m32 = nearest(2e7, DIGITS);
        assert!(!(sum_m(f64::NAN, second_m32, 1.0).abs() <= 1e9), "no length");
        assert!(!(sum_m(f64::INFINITY, -second_m32, 1.0).abs() <= 1e9), "no length");
    }
}
