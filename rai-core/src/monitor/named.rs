//! Satellites that were excluded lately, and that support no exclusion of others.
//!
//! An exclusion assumes that the remaining satellites are right. A satellite that was found faulty
//! a moment ago cannot confirm this, even if it agrees with the others now. In a street canyon
//! several reflected ranges agree with each other once a healthy satellite is left out. The
//! satellite counts again after it has agreed for [`WEAK`].

use crate::continuity::WEAK;
use crate::satellite::SatelliteId;

/// Largest number of satellites that are remembered.
const SATELLITES: usize = 8;

/// A satellite, and its agreement since it was excluded.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Doubtful {
    satellite: SatelliteId,
    epochs: u16,
    agreed_s: f32,
}

/// Satellites that were excluded lately.
#[derive(Clone, Debug)]
pub(super) struct Named {
    places: [Option<Doubtful>; SATELLITES],
    /// Place that was overwritten last because none was free.
    next: u8,
    /// Time of the last epoch whose satellites agreed, s.
    latest_s: f64,
}

impl Named {
    /// Returns a memory without exclusions.
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub(super) const fn new() -> Self {
        Self { places: [None; SATELLITES], next: 0, latest_s: 0.0 }
    }

    /// Returns true if a satellite was excluded and has not agreed for long enough since.
    pub(super) fn contains(&self, satellite: SatelliteId) -> bool {
        self.places.iter().flatten().any(|doubtful| doubtful.satellite == satellite)
    }

    /// Returns true if no satellite is remembered.
    pub(super) fn is_empty(&self) -> bool {
        self.places.iter().all(Option::is_none)
    }

    /// Remembers an excluded satellite. If no place is free, it overwrites the places in turn.
    pub(super) fn name(&mut self, satellite: SatelliteId) {
        let is_same = |place: &Option<Doubtful>| place.is_some_and(|known| known.satellite == satellite);
        let mut place = self.places.iter().position(is_same);
        if place.is_none() {
            place = self.places.iter().position(Option::is_none);
        }
        let place = place.unwrap_or_else(|| {
            self.next = (self.next + 1) % SATELLITES as u8;
            usize::from(self.next)
        });
        if let Some(place) = self.places.get_mut(place) {
            *place = Some(Doubtful { satellite, epochs: 0, agreed_s: 0.0 });
        }
    }

    /// Counts an epoch whose satellites agree, and forgets those that have agreed for long enough.
    pub(super) fn agree(&mut self, time_s: f64, used: &[SatelliteId]) {
        let step_s = (time_s - self.latest_s) as f32;
        self.latest_s = time_s;
        for place in &mut self.places {
            let Some(doubtful) = place.as_mut().filter(|doubtful| used.contains(&doubtful.satellite)) else {
                continue;
            };
            // If the time goes back or is NaN, the agreement begins anew.
            if doubtful.epochs > 0 && step_s >= 0.0 {
                doubtful.agreed_s += step_s;
            } else {
                (doubtful.epochs, doubtful.agreed_s) = (0, 0.0);
            }
            doubtful.epochs = doubtful.epochs.saturating_add(1);
            if WEAK.is_met(doubtful.epochs, f64::from(doubtful.agreed_s), false) {
                *place = None;
            }
        }
    }
}

#[cfg(test)]
#[allow(clippy::expect_used)]
mod tests {
    use super::{Named, SATELLITES};
    use crate::satellite::{Constellation, SatelliteId};

    fn gps(number: u8) -> SatelliteId {
        SatelliteId::new(Constellation::Gps, number).expect("a satellite")
    }

    #[test]
    fn satellite_counts_again_after_ten_epochs_and_ten_seconds() {
        let mut named = Named::new();
        named.name(gps(9));
        for second in 0..10 {
            named.agree(f64::from(second), &[gps(9), gps(3)]);
            assert!(named.contains(gps(9)) && !named.contains(gps(3)), "{second} s");
        }
        named.agree(10.0, &[gps(9)]);
        assert!(named.is_empty());
    }

    #[test]
    fn next_exclusion_begins_anew_and_absence_is_no_agreement() {
        let mut named = Named::new();
        named.name(gps(9));
        (0..8).for_each(|second| named.agree(f64::from(second), &[gps(9)]));
        named.name(gps(9));
        (8..16).for_each(|second| named.agree(f64::from(second), &[gps(9)]));
        (16..60).for_each(|second| named.agree(f64::from(second), &[gps(3)]));
        assert!(named.contains(gps(9)));
    }

    #[test]
    fn memory_is_bounded_and_keeps_the_latest() {
        let mut named = Named::new();
        (1..=31).for_each(|number| named.name(gps(number)));
        assert!((32 - SATELLITES as u8..=31).all(|number| named.contains(gps(number))));
        assert_eq!((1..=31).filter(|&number| named.contains(gps(number))).count(), SATELLITES);
    }
}
