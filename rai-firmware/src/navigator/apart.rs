//! The greatest distance between the places of single systems.
//!
//! Each system with at least four satellites has a place of its own. They are computed between epochs,
//! one in a slice of the authentication, so that no epoch waits for them; an epoch therefore states the
//! distance of the one before. The distance says how far systems contradict each other, and in which
//! size a forgery would show. It bounds nothing.

use heapless::Vec;
use raim_core::frame::Ecef;
use raim_core::satellite::Constellation;

use super::tie::{distance_m, place_by};
use super::{Navigator, Room, found};

/// Least number of satellites that determine a place.
const LEAST: usize = 4;

/// Places of single systems in the last epoch, and what the one before has shown.
#[derive(Clone, Debug)]
pub(super) struct Apart {
    /// Index of the next system.
    next: usize,
    places: Vec<Ecef, { Constellation::COUNT }>,
    so_far_m: Option<f32>,
    /// Distance in the epoch before, m; `None` if fewer than two systems had a place.
    before_m: Option<f32>,
}

impl Apart {
    pub(super) const NONE: Self =
        Self { next: Constellation::COUNT, places: Vec::new(), so_far_m: None, before_m: None };

    /// Begins an epoch.
    pub(super) fn begin(&mut self) {
        let is_complete = self.next >= Constellation::COUNT;
        self.before_m = self.so_far_m.take().filter(|_| is_complete);
        self.next = 0;
        self.places.clear();
    }

    /// Adds the place of a system, or of several.
    pub(super) fn add(&mut self, place: Ecef) {
        for other in &self.places {
            let apart_m = Some(distance_m(place, *other));
            if self.so_far_m < apart_m {
                self.so_far_m = apart_m;
            }
        }
        // Never full: each system is asked once, and Galileo alone behind the place of all others.
        let _ = self.places.push(place);
    }
}

impl Navigator {
    /// Computes the place of the next system of the last epoch; returns false if there is none left.
    #[inline(never)]
    pub fn compare_systems(&mut self) -> bool {
        let start = found(self.report()).or_else(|| self.place()).unwrap_or(Ecef::CENTRE);
        let Self { apart, room: Room { epoch, memory, .. }, .. } = self;
        while let Some(system) = Constellation::ALL.get(apart.next) {
            apart.next += 1;
            let satellites = epoch.observations().iter().map(|seen| seen.satellite.constellation());
            if satellites.filter(|its| its == system).count() < LEAST {
                continue;
            }
            let is_its = |satellite: raim_core::satellite::SatelliteId| satellite.constellation() == *system;
            if let Some(place) = place_by(&is_its, epoch, start, memory.workspace()) {
                apart.add(place);
            }
            return true;
        }
        false
    }

    /// Returns the greatest distance between the places of single systems in the epoch before the last
    /// one, m.
    pub(crate) fn systems_apart_m(&self) -> Option<f64> {
        self.apart.before_m.map(f64::from)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x_m: f64) -> Ecef {
        Ecef::new(6.4e6 + x_m, 0.0, 0.0)
    }

    #[test]
    fn the_greatest_distance_is_stated_with_the_next_epoch_and_only_once() {
        let mut apart = Apart::NONE;
        apart.begin();
        for x_m in [0.0, 12.0, -30.0, 5.0] {
            apart.add(at(x_m));
        }
        apart.next = Constellation::COUNT;
        assert_eq!(apart.before_m, None);
        apart.begin();
        assert_eq!(apart.before_m, Some(42.0));
        // One place has no distance, and an epoch whose systems were not all asked states none.
        apart.add(at(0.0));
        apart.next = Constellation::COUNT;
        apart.begin();
        assert_eq!(apart.before_m, None);
        apart.add(at(0.0));
        apart.add(at(7.0));
        apart.begin();
        assert_eq!(apart.before_m, None);
    }
}
