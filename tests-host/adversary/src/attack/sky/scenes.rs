//! The attacks on a signed sky.

use super::signals::{Lie, Skies};
use crate::attack::prelude::*;

/// Second of the module's life at which the sky is jammed, and at which the attack begins.
pub(super) const JAMMED: u32 = 240;
pub(super) const ATTACKED: u32 = 300;

/// Speed of the slow attack, m/s.
const SPEED_M_S: f64 = 0.5;

/// Extra length of all ranges of a relayed sky, m: a microsecond in cables.
const CABLES_M: f64 = 300.0;

/// An attack.
pub(super) struct Scene {
    /// Name in the table, and a short one.
    pub(super) name: &'static str,
    pub(super) short: &'static str,
    /// Ranges of the attack.
    pub(super) ranges: Ranges,
    /// Pages of the attack.
    pub(super) pages: Pages,
    /// Systems that are received, all the time.
    pub(super) systems: &'static str,
    /// Settings of the module beside those of its means.
    pub(super) settings: &'static [&'static str],
    /// Seconds by which everything is late.
    pub(super) late_s: u32,
    /// True if the module starts under the attack.
    pub(super) is_cold: bool,
    /// True if the attack begins without a minute of jamming.
    pub(super) is_sudden: bool,
}

/// Where ranges are received.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ranges {
    /// At the antenna.
    Genuine,
    /// All at the other place, and longer by cables.
    Relayed,
    /// All at the other place.
    Elsewhere,
    /// Those of one system at the other place.
    OneElsewhere(Constellation),
    /// Those of all systems but Galileo at the other place.
    OthersElsewhere,
    /// At a place that walks off.
    Walking,
}

/// Who makes the pages of Galileo.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pages {
    Genuine,
    Forged(Lie),
    /// One satellite sends senseless blocks, from the start on.
    Poisoned,
    OfAttacker,
}

const GENUINE: Scene = Scene {
    name: "genuine",
    short: "genuine",
    ranges: Ranges::Genuine,
    pages: Pages::Genuine,
    systems: "GE",
    settings: &[],
    late_s: 0,
    is_cold: false,
    is_sudden: false,
};

const RELAYED: Scene = Scene { ranges: Ranges::Relayed, ..GENUINE };

const GPS_FORGED: Scene = Scene {
    name: "(c) GPS forged 555 m away, Galileo genuine",
    short: "GPS forged, Galileo genuine",
    ranges: Ranges::OneElsewhere(Constellation::Gps),
    ..GENUINE
};

const OTHERS_FORGED: Scene = Scene {
    name: "(c) GPS and BeiDou forged alike 555 m away, Galileo genuine",
    short: "GPS and BeiDou forged, Galileo genuine",
    ranges: Ranges::OthersElsewhere,
    systems: "GEC",
    ..GENUINE
};

const GALILEO_FORGED: Scene = Scene {
    name: "(c) Galileo's ranges forged 555 m away with its signed data, GPS genuine",
    short: "Galileo's ranges forged, GPS genuine",
    ranges: Ranges::OneElsewhere(Constellation::Galileo),
    ..GENUINE
};

/// All attacks, behind the genuine sky of a module that has run before and of one that starts.
pub(super) const SCENES: [Scene; 23] = [
    GENUINE,
    Scene { is_cold: true, ..GENUINE },
    Scene { is_sudden: true, ..GENUINE },
    // Most proved satellites are below the mask, and contradict nothing.
    Scene { is_sudden: true, systems: "GEC", settings: &["MASK,35"], ..GENUINE },
    Scene {
        name: "(a) forged data of one Galileo satellite, its clock wrong by 300 m",
        short: "forged data of one Galileo satellite",
        pages: Pages::Forged(Lie::Clocks(1)),
        ..GENUINE
    },
    Scene {
        name: "(a) of two",
        short: "forged data of two Galileo satellites",
        pages: Pages::Forged(Lie::Clocks(2)),
        ..GENUINE
    },
    Scene {
        name: "(a) of all Galileo satellites, their orbits turned by 500 m",
        short: "forged data of all",
        pages: Pages::Forged(Lie::Turned),
        ..GENUINE
    },
    Scene {
        name: "(a) the same without GPS",
        short: "forged data of all, without GPS",
        pages: Pages::Forged(Lie::Turned),
        systems: "E",
        ..GENUINE
    },
    Scene { name: "(b) the sky of a place 555 m away, relayed at once", short: "relayed at once", ..RELAYED },
    Scene { name: "(b) 5 s late", short: "relayed 5 s late", late_s: 5, ..RELAYED },
    Scene { name: "(b) 40 s late", short: "relayed 40 s late", late_s: 40, ..RELAYED },
    Scene { name: "(b) 10 min late", short: "relayed 10 min late", late_s: 600, ..RELAYED },
    Scene {
        name: "(b) 40 s late, to a module that starts",
        short: "relayed 40 s late, from the start",
        late_s: 40,
        is_cold: true,
        ..RELAYED
    },
    Scene {
        name: "(b) 10 min late, to a module that starts",
        short: "relayed 10 min late, from the start",
        late_s: 600,
        is_cold: true,
        ..RELAYED
    },
    GPS_FORGED,
    GALILEO_FORGED,
    Scene {
        name: "(c) GPS forged 555 m away, Galileo genuine, without jamming",
        short: "GPS forged, without jamming",
        is_sudden: true,
        ..GPS_FORGED
    },
    Scene {
        name: "(c) Galileo's ranges forged 555 m away with its signed data, GPS genuine, without jamming",
        short: "Galileo's ranges forged, without jamming",
        is_sudden: true,
        ..GALILEO_FORGED
    },
    OTHERS_FORGED,
    Scene {
        name: "(c) GPS and BeiDou forged alike 555 m away, Galileo genuine, without jamming",
        short: "GPS and BeiDou forged, without jamming",
        is_sudden: true,
        ..OTHERS_FORGED
    },
    Scene {
        name: "(d) all ranges and rates pulled off at 0.5 m/s",
        short: "all ranges pulled off at 0.5 m/s",
        ranges: Ranges::Walking,
        ..GENUINE
    },
    Scene {
        name: "(e) one satellite poisons the root key's blocks from the start",
        short: "poisoned root key",
        pages: Pages::Poisoned,
        ..GENUINE
    },
    Scene {
        name: "(f) all forged 555 m away, Galileo signed by the attacker's own key",
        short: "all forged, signed by another key",
        ranges: Ranges::Elsewhere,
        pages: Pages::OfAttacker,
        ..GENUINE
    },
];

impl Scene {
    /// Returns true for a sky without an attack.
    pub(super) fn is_genuine(&self) -> bool {
        self.short == GENUINE.short
    }

    /// Returns the epoch of a second; `None` while the sky is jammed.
    pub(super) fn epoch(&self, skies: &Skies, second: u32, has_rates: bool) -> Option<MeasuredEpoch> {
        let mut epoch = match (second, self.ranges) {
            (JAMMED..ATTACKED, _) if !self.is_sudden => return None,
            (..ATTACKED, _) if self.is_cold => return None,
            (..ATTACKED, _) | (_, Ranges::Genuine) => {
                skies.here(second, self.late_in(second), has_rates).clone()
            }
            (_, Ranges::Relayed) => {
                let mut epoch = skies.there(second, self.late_s, has_rates).clone();
                lengthen_all(&mut epoch, CABLES_M);
                epoch
            }
            (_, Ranges::Elsewhere) => skies.there(second, self.late_s, has_rates).clone(),
            (_, Ranges::OneElsewhere(system)) => skies.mixed(second, has_rates, |its| its == system),
            (_, Ranges::OthersElsewhere) => {
                skies.mixed(second, has_rates, |its| its != Constellation::Galileo)
            }
            (_, Ranges::Walking) => {
                let moved_m = SPEED_M_S * f64::from(second - ATTACKED);
                skies.walked(second, moved_m, SPEED_M_S, has_rates)
            }
        };
        epoch.satellites.retain(|seen| self.systems.contains(seen.satellite.name().0));
        Some(epoch)
    }

    /// Returns by how much a second is late.
    pub(super) const fn late_in(&self, second: u32) -> u32 {
        if second < ATTACKED { 0 } else { self.late_s }
    }
}
