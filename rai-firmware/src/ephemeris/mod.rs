//! Broadcast orbits and clocks.
//!
//! ```text
//! Broadcast ────────new()───────┐
//!                               ├─► Ephemeris { orbit, clock } ──at(received, travel)──► SatelliteState { position, clock }
//! StateBroadcast ──of_state()───┘
//! ```
//!
//! | form of the orbit | systems | module |
//! |---|---|---|
//! | [`Orbit::Kepler`] | GPS, QZSS, Galileo, `BeiDou`: the same elements; gravity, earth rate, time scale of `toe` and the rotation of the geostationary `BeiDou` satellites differ | [`kepler`] |
//! | [`Orbit::StateVector`] | GLONASS: position and velocity, integrated from the reference time ([`forces`]) | [`state_vector`] |
//!
//! [`Source`] and [`clock`] hold the constants that differ by message: age, satellite numbers,
//! signals that the clock refers to.
//!
//! - [`Ephemeris::new`] and [`Ephemeris::of_state`] check every field once, so that an
//!   [`Ephemeris`] is always usable for computations.
//! - [`Store`] has the last set of every satellite, and refuses unhealthy, old or contradicted ones
//!   with a reason.
//! - Every element stays the broadcast integer, and orbits and clocks are computed in integers
//!   ([`fixed`]).
//!
//! Accuracy: position and clock follow the interface documents to better than 0.1 mm. The broadcast
//! itself is accurate to 0.5 m to 2 m; [`Ephemeris::accuracy_m`] returns its sigma.
//!
//! References: [IS-GPS-200] 20.3.3, table 20-IV; [OS-SIS-ICD] 5.1.1 to 5.1.5; [BDS-SIS-B1I] 5.2.4,
//! table 5-11.
//!
//! [IS-GPS-200]: crate#references
//! [OS-SIS-ICD]: crate#references
//! [BDS-SIS-B1I]: crate#references

mod accuracy;
mod broadcast;
mod clock;
mod cnav;
mod elapsed;
mod fixed;
#[cfg(feature = "glonass")]
mod forces;
mod health;
mod kepler;
mod motion;
mod orbit;
mod orbit_types;
mod sight;
mod source;
#[cfg(feature = "glonass")]
mod state_vector;
mod store;

use core::fmt;

use raim_core::frame::{Ecef, SPEED_OF_LIGHT_M_S};
use raim_core::internals::numeric::absolute::{Absolute as _, Grid};
use raim_core::internals::numeric::bounds::is_within;
use raim_core::satellite::SatelliteId;

use crate::counters::{count, counters};
#[cfg(feature = "osnma")]
use crate::osnma::Seal;
use crate::raw::Band;
use crate::time::GpsTime;
#[cfg(feature = "glonass")]
use crate::time::WEEK_MS;
use clock::Clock;

pub(crate) use cnav::Word;
pub(crate) use fixed::{mul_high, nearest, scaled, times_power_of_two};

pub use accuracy::{galileo_sisa_m, glonass_accuracy_m, ura_m};
pub use broadcast::{Broadcast, BroadcastError};
pub use clock::GroupDelay;
#[cfg(feature = "cnav")]
pub use cnav::{CnavContent, CnavFrame, SignalDelays};
pub use elapsed::Elapsed;
pub use health::Health;
pub use kepler::Kepler;
pub use motion::Motion;
pub use orbit::Orbit;
pub use source::Source;
#[cfg(feature = "glonass")]
pub use state_vector::{StateBroadcast, StateVector};
#[cfg(feature = "osnma")]
pub(crate) use store::Demand;
pub use store::{CAPACITY, Insertion, Store};

/// Reason for which a satellite has no position now.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EphemerisError {
    /// No ephemeris has been received.
    Missing,
    /// The satellite reports that it or all received signals are unusable, or promises no accuracy.
    Unhealthy,
    /// The last ephemeris is too old, or its reference time is too far ahead.
    Stale,
    /// The travel time of the signal is impossible.
    TravelTime,
    /// The last two sets contradict each other, and no third set has decided between them.
    Disputed,
    /// The set is false, or not proved although the settings demand it.
    #[cfg(feature = "osnma")]
    Unproved,
}

impl fmt::Display for EphemerisError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Missing => "no ephemeris",
            Self::Unhealthy => "unhealthy satellite",
            Self::Stale => "stale ephemeris",
            Self::TravelTime => "travel time out of bounds",
            Self::Disputed => "ephemeris disputed",
            #[cfg(feature = "osnma")]
            Self::Unproved => "ephemeris false or not proved",
        })
    }
}

impl core::error::Error for EphemerisError {}

counters! {
    /// Satellites that were observed but had no usable ephemeris, by reason.
    Refusals {
        /// See [`EphemerisError::Missing`].
        ephemeris_missing,
        /// See [`EphemerisError::Unhealthy`].
        satellite_unhealthy,
        /// See [`EphemerisError::Stale`].
        ephemeris_stale,
        /// See [`EphemerisError::TravelTime`].
        travel_time_out_of_bounds,
        /// See [`EphemerisError::Disputed`].
        ephemeris_disputed,
        /// See [`EphemerisError::Unproved`].
        ["osnma"] ephemeris_unproved,
    }
}

impl Refusals {
    /// Returns the number of satellites without a known orbit, or whose orbit is stale.
    pub fn without_orbit(&self) -> u32 {
        self.ephemeris_missing.saturating_add(self.ephemeris_stale)
    }

    /// Counts one satellite that was left out.
    pub fn count(&mut self, reason: EphemerisError) {
        count(match reason {
            EphemerisError::Missing => &mut self.ephemeris_missing,
            EphemerisError::Unhealthy => &mut self.satellite_unhealthy,
            EphemerisError::Stale => &mut self.ephemeris_stale,
            EphemerisError::TravelTime => &mut self.travel_time_out_of_bounds,
            EphemerisError::Disputed => &mut self.ephemeris_disputed,
            #[cfg(feature = "osnma")]
            EphemerisError::Unproved => &mut self.ephemeris_unproved,
        });
    }
}

/// Position and clock of a satellite at the transmission of the signal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SatelliteState {
    /// Position in the earth-fixed frame at the instant of transmission.
    pub position: Ecef,
    /// Satellite clock minus system time, s, with relativity but without group delay.
    pub clock_s: f64,
}

/// Position and clock in integers, which cost less on a core without doubles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct IntegerState {
    /// Position, 2⁻³⁶ m.
    position_m36: [i64; 3],
    /// Satellite clock, 2⁻⁶² s.
    clock_s62: i64,
}

impl IntegerState {
    /// Returns the position, on the grid of ranges.
    pub(crate) fn place(&self) -> [Grid; 3] {
        self.position_m36.map(|units| Grid::of_multiple(units, 36))
    }

    /// Returns the satellite clock times the speed of light, 2⁻³² m.
    pub(crate) const fn clock_m32(&self) -> i64 {
        /// The speed of light, which is a whole number of m/s.
        const LIGHT_M_S: i64 = SPEED_OF_LIGHT_M_S as i64;
        mul_high(self.clock_s62, LIGHT_M_S << 34)
    }

    /// Converts to doubles. The position, in 2⁻³⁶ m, is exact except for the last digit.
    fn in_metres(&self) -> SatelliteState {
        let [x_m, y_m, z_m] = self.position_m36.map(|units| scaled(units, -36));
        SatelliteState { position: Ecef::new(x_m, y_m, z_m), clock_s: scaled(self.clock_s62, -62) }
    }
}

/// Returns a place on the grid in single precision, m.
// Not inlined, and a loop, so that its callers share one copy of the conversion.
#[inline(never)]
pub(crate) fn coordinates_m(place: [Grid; 3]) -> [f32; 3] {
    let mut coordinates_m = [0.0; 3];
    for (coordinate_m, coordinate) in coordinates_m.iter_mut().zip(&place) {
        *coordinate_m = coordinate.narrow();
    }
    coordinates_m
}

/// Returns the difference of two places on the grid, m.
pub(crate) fn difference_m([x, y, z]: [Grid; 3], [from_x, from_y, from_z]: [Grid; 3]) -> [f32; 3] {
    coordinates_m([x.less(from_x), y.less(from_y), z.less(from_z)])
}

/// Where a set comes from, in the order of trust.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Origin {
    /// RTCM: a caster may have sent it.
    Relayed,
    /// The receiver decoded it, so that the module has checked no parity.
    #[cfg(feature = "sbf")]
    Decoded,
    /// The bits of the satellite, as the receiver sent them.
    Bits,
}

/// One satellite's orbit and clock, checked. Two are equal if they say the same, whatever their origin.
#[derive(Clone, Copy, Debug)]
pub struct Ephemeris {
    orbit: Orbit,
    clock: Clock,
    /// Sigmas of ranges without E5a and of ranges with it, m; not finite if the satellite promises
    /// none.
    accuracies_m: [f32; 2],
    toe: GpsTime,
    health: Health,
    satellite: SatelliteId,
    source: Source,
    origin: Origin,
    /// What is known of the words that it was read from.
    #[cfg(feature = "osnma")]
    seal: Seal,
}

impl PartialEq for Ephemeris {
    fn eq(&self, other: &Self) -> bool {
        let reported = |set: &Self| (set.orbit, set.clock, set.toe, set.health, set.satellite, set.source);
        reported(self) == reported(other) && self.accuracies_m == other.accuracies_m
    }
}

impl Ephemeris {
    /// Checks a message of Kepler elements, field by field.
    ///
    /// # Errors
    /// [`BroadcastError`] names the first field that no satellite could have sent.
    pub fn new(broadcast: &Broadcast) -> Result<Self, BroadcastError> {
        broadcast::check(broadcast)?;
        Ok(Self {
            orbit: Orbit::Kepler(Kepler::new(broadcast)?),
            clock: Clock::new(
                [broadcast.af0_s, broadcast.af1_s_s, broadcast.af2_s_s2],
                // A day at most.
                broadcast.toc.since_ms(broadcast.toe) as i32 / 1000,
                broadcast.group_delays_s,
            ),
            accuracies_m: [broadcast.accuracy_m.unwrap_or(f32::NAN); 2],
            toe: broadcast.toe,
            health: broadcast.health,
            satellite: broadcast.satellite,
            source: broadcast.source,
            origin: Origin::Relayed,
            #[cfg(feature = "osnma")]
            seal: Seal::NONE,
        })
    }

    /// Checks a message with a state vector, field by field.
    ///
    /// # Errors
    /// As [`Self::new`].
    #[cfg(feature = "glonass")]
    pub fn of_state(broadcast: &StateBroadcast) -> Result<Self, BroadcastError> {
        let source = Source::GlonassStrings;
        if !source.can_name(broadcast.satellite) {
            return Err(BroadcastError::Satellite);
        }
        if broadcast.toe.tow_ms >= WEEK_MS {
            return Err(BroadcastError::ReferenceTime);
        }
        Ok(Self {
            orbit: Orbit::StateVector(StateVector::new(broadcast)?),
            clock: Clock::new([broadcast.clock_s, broadcast.clock_s_s, 0.0], 0, [0.0, broadcast.delay_l2_s]),
            accuracies_m: [broadcast.accuracy_m.unwrap_or(f32::NAN); 2],
            toe: broadcast.toe,
            health: broadcast.health,
            satellite: broadcast.satellite,
            source,
            origin: Origin::Relayed,
            #[cfg(feature = "osnma")]
            seal: Seal::NONE,
        })
    }

    /// Returns true if the receiver decoded this set, and the other one is of the same issue.
    #[cfg(feature = "sbf")]
    fn is_issue_of(&self, other: &Self) -> bool {
        self.origin == Origin::Decoded && (self.source, self.toe) == (other.source, other.toe)
    }

    /// Returns the satellite.
    pub fn satellite(&self) -> SatelliteId {
        self.satellite
    }

    /// Returns the message that the ephemeris came from.
    pub fn source(&self) -> Source {
        self.source
    }

    /// Returns the reference time of the elements.
    pub fn toe(&self) -> GpsTime {
        self.toe
    }

    /// Returns the same ephemeris of another origin ([`Store`]).
    #[must_use]
    pub(crate) const fn of(self, origin: Origin) -> Self {
        Self { origin, ..self }
    }

    /// Returns the same ephemeris with what is known of its words.
    #[cfg(feature = "osnma")]
    #[must_use]
    pub(crate) const fn sealed(self, seal: Seal) -> Self {
        Self { seal, ..self }
    }

    /// Moves the reference time to the same second of another week, because orbit and clock depend
    /// on the second alone.
    pub(crate) fn date(&mut self, toe: GpsTime) {
        if toe.tow_ms == self.toe.tow_ms {
            self.toe = toe;
        }
    }

    /// Returns the sigma that the satellite promises for a range made of these carriers, m; `None`
    /// if it promises none.
    pub fn accuracy_m(&self, bands: (Band, Option<Band>)) -> Option<f32> {
        let [plain_m, with_e5a_m] = self.accuracies_m;
        let has_e5a = bands.0 == Band::E5a || bands.1 == Some(Band::E5a);
        let accuracy_m = if has_e5a { with_e5a_m } else { plain_m };
        accuracy_m.is_finite().then_some(accuracy_m)
    }

    /// Precomputes the part of the computation that epochs soon after this instant share. No
    /// position changes.
    fn advance(&mut self, received: GpsTime) {
        self.orbit.advance(received.since_ms(self.toe) as f64 * 1e-3);
    }

    /// Takes from Galileo's F/NAV the health of its signals, and the accuracy of ranges with them.
    fn merge_health(&mut self, fnav: &Self) {
        self.health = fnav.health.over(self.health);
        let [_, with_e5a_m] = &mut self.accuracies_m;
        [_, *with_e5a_m] = fnav.accuracies_m;
    }

    /// Takes the health and the accuracy of a set that the receiver decoded, which may be newer than
    /// those of the same issue.
    #[cfg(feature = "sbf")]
    fn merge_decoded(&mut self, decoded: &Self) {
        self.health = decoded.health.over(self.health);
        let ([own_m, _], [decoded_m, _]) = (&mut self.accuracies_m, decoded.accuracies_m);
        *own_m = decoded_m;
    }

    /// Copies the earlier health of signals that this message does not report on. From a stale set
    /// only bad health is copied, because no message confirms that those signals are still good.
    fn inherit_health(&mut self, before: &Self, is_before_stale: bool) {
        if self.source == Source::GalileoInav && before.health.mentions(Band::E5a) {
            let [_, with_e5a_m] = &mut self.accuracies_m;
            [_, *with_e5a_m] = before.accuracies_m;
        }
        let kept = if is_before_stale { before.health.bad_alone() } else { before.health };
        self.health = self.health.over(kept);
    }

    /// Returns true if both have the same orbit and clock, whatever their health.
    fn describes_as(&self, other: &Self) -> bool {
        (self.source, self.toe) == (other.source, other.toe)
            && self.orbit == other.orbit
            && self.clock == other.clock
    }

    /// Checks that the ephemeris may be used at that time.
    ///
    /// # Errors
    /// [`EphemerisError::Unhealthy`] or [`EphemerisError::Stale`].
    pub fn usable_at(&self, time: GpsTime) -> Result<(), EphemerisError> {
        if self.health.is_bad() || !self.accuracies_m[0].is_finite() {
            return Err(EphemerisError::Unhealthy);
        }
        if self.is_stale(time) { Err(EphemerisError::Stale) } else { Ok(()) }
    }

    /// Returns true if the satellite promises an accuracy for this carrier and reports it in
    /// service.
    pub fn serves(&self, band: Band) -> bool {
        self.health.serves(band) && self.accuracy_m((band, None)).is_some()
    }

    /// Returns true if the elements are too far from their reference time.
    // Not inlined, so that its many callers share one copy.
    #[inline(never)]
    fn is_stale(&self, time: GpsTime) -> bool {
        time.since_ms(self.toe).unsigned_abs() > self.source.age_limit_ms()
    }

    /// Returns position and clock at the transmission of a signal that was received at `received`
    /// with this pseudorange.
    ///
    /// `received` is the receiver's time tag. The range is measured by the same clock, so that the
    /// clock's offset cancels: `received − range/c` is the time of transmission by the satellite's
    /// clock.
    ///
    /// # Errors
    /// [`EphemerisError::TravelTime`] if the range is not finite, negative or longer than light
    /// travels in a second, or if `received` is more than a day from the reference time;
    /// [`EphemerisError::Stale`] for a state vector that is more than half an hour old.
    pub fn at(&self, received: GpsTime, range_m: f64) -> Result<SatelliteState, EphemerisError> {
        self.seen_at(received, range_m).map(|state| state.in_metres())
    }

    /// Works like [`Self::at`], in integers.
    pub(crate) fn seen_at(&self, received: GpsTime, range_m: f64) -> Result<IntegerState, EphemerisError> {
        const PER_METRE_2_77: i64 = ((1_u128 << 77) / SPEED_OF_LIGHT_M_S as u128) as i64;
        let since_toe_ms = received.since_ms(self.toe);
        let is_travel = is_within(range_m, &(0.0..=SPEED_OF_LIGHT_M_S));
        if !is_travel || since_toe_ms.unsigned_abs() > Elapsed::LIMIT_MS {
            return Err(EphemerisError::TravelTime);
        }
        let travel_2_46 = mul_high(nearest(range_m, 33), PER_METRE_2_77);
        let shown = Elapsed::of_ms(since_toe_ms).earlier(travel_2_46);
        let polynomial_s62 = self.clock.polynomial_s62(shown);
        let motion = self.orbit.at(shown.earlier(polynomial_s62 >> 16))?;
        let clock_s62 = polynomial_s62 + motion.relativity_s62;
        Ok(IntegerState { position_m36: motion.position_m36, clock_s62 })
    }
}
