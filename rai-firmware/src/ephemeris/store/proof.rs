//! Verdicts of the authentication on the sets in use, and what is demanded of them.
//!
//! A verdict belongs to the words that a satellite sent, by their version, and not to the satellite:
//! a set of other words has none until its own comes.

use raim_core::satellite::{Constellation, SatelliteId};

use super::Store;
use crate::ephemeris::Ephemeris;
use crate::osnma::{Proof, Seal, Verdict};
use crate::time::GpsTime;

/// What is demanded of a set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Demand {
    #[default]
    Nothing,
    /// That it is not false.
    NotFalse,
    /// That it is proved, if it is of Galileo: by a tag of any kind, by one with a later key, or by none
    /// that counts.
    Proved(Proof),
}

impl Demand {
    pub(super) fn is_met_by(self, ephemeris: &Ephemeris) -> bool {
        match self {
            Self::Nothing => true,
            Self::NotFalse => ephemeris.seal.verdict != Verdict::False,
            Self::Proved(_) if ephemeris.satellite.constellation() != Constellation::Galileo => true,
            Self::Proved(proof) => ephemeris.seal.is_proved(proof),
        }
    }
}

impl Store {
    /// Sets what is demanded of the sets in use.
    pub(crate) const fn demand(&mut self, demand: Demand) {
        self.demand = demand;
    }

    /// Returns true if a tag has proved the set in use.
    pub(crate) fn is_proved(&self, satellite: SatelliteId, time: GpsTime) -> bool {
        self.get(satellite, time).is_ok_and(|set| set.seal.is_proved(Proof::All))
    }

    /// Takes the verdict on the words of a satellite, if they are those of the known set.
    pub(crate) fn take_verdict(&mut self, satellite: SatelliteId, seal: Seal) {
        let known = self.entries.iter_mut().map(|entry| &mut entry.ephemeris);
        let rivals = self.rivals.iter_mut().map(|rival| &mut rival.ephemeris);
        for ephemeris in known.chain(rivals).filter(|ephemeris| ephemeris.satellite == satellite) {
            if ephemeris.seal.version.is_some() && ephemeris.seal.version == seal.version {
                ephemeris.seal = seal;
            }
        }
    }

    /// Discards all verdicts.
    pub(crate) fn forget_verdicts(&mut self) {
        let known = self.entries.iter_mut().map(|entry| &mut entry.ephemeris);
        let rivals = self.rivals.iter_mut().map(|rival| &mut rival.ephemeris);
        known.chain(rivals).for_each(|ephemeris| ephemeris.seal = Seal::NONE);
    }
}
