//! Published constellations, as orbits at `t = 0`.
//!
//! | fleet | satellites | source |
//! |---|---|---|
//! | [`Fleet::Gps24`] | 24 MEO in six planes | baseline slots of [GPS-SPS] |
//! | [`Fleet::Gps31`] | 31 MEO | YUMA almanac of 2020-01-01 |
//! | [`Fleet::BeidouRegional`] | 5 GEO, 5 IGSO, 4 MEO | [Yang2015], [Lin2016]: the regional system of 2012 |
//! | [`Fleet::BeidouGlobal`] | 5 GEO, 3 IGSO, 24 MEO and 3 spares | [Yang2015]: the system as planned |
//! | [`Fleet::Beidou44`] | 7 GEO, 10 IGSO, 27 MEO | [Tian2024], about February 2022 |
//! | [`Fleet::Beidou24`] | 24 MEO in three planes: the satellites in view everywhere | [BDS-SIS-ICD] |
//! | [`Fleet::Galileo24`] | 24 MEO in three planes, Walker 24/3/1 | [Galileo-OS-SDD] |
//! | [`Fleet::Glonass24`] | 24 MEO in three planes, Walker 24/3/1 | [GLONASS-ICD] |
//!
//! No source gives the phase of a whole `BeiDou` constellation against the earth. Here Greenwich
//! sidereal time is 0 at `t = 0`, for Galileo and GLONASS too. Geostationary satellites are exactly
//! over the equator.
//!
//! [BDS-SIS-ICD]: crate#references
//! [Galileo-OS-SDD]: crate#references
//! [GLONASS-ICD]: crate#references
//! [GPS-SPS]: crate#references
//! [Lin2016]: crate#references
//! [Yang2015]: crate#references
//! [Tian2024]: crate#references

use raim_core::satellite::{Constellation, SatelliteId};

use super::orbit::{Orbit, mean_motion_rad_s};

/// A published constellation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Fleet {
    /// GPS, 24 baseline slots.
    Gps24,
    /// GPS, 31 satellites of 2020.
    Gps31,
    /// `BeiDou` regional, 14 satellites.
    BeidouRegional,
    /// `BeiDou` global, 35 satellites.
    BeidouGlobal,
    /// `BeiDou`, 44 satellites of 2022.
    Beidou44,
    /// `BeiDou`, the 24 medium orbits alone.
    Beidou24,
    /// Galileo, 24 slots.
    Galileo24,
    /// GLONASS, 24 slots.
    Glonass24,
}

/// A satellite on its orbit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Satellite {
    /// Name of the satellite.
    pub id: SatelliteId,
    /// Orbit of the satellite.
    pub orbit: Orbit,
}

impl Fleet {
    /// All fleets.
    pub const ALL: [Self; 8] = [
        Self::Gps24,
        Self::Gps31,
        Self::BeidouRegional,
        Self::BeidouGlobal,
        Self::Beidou44,
        Self::Beidou24,
        Self::Galileo24,
        Self::Glonass24,
    ];

    /// Fleets of the papers, with a table of elements for every satellite.
    pub const OF_PAPERS: [Self; 5] =
        [Self::Gps24, Self::Gps31, Self::BeidouRegional, Self::BeidouGlobal, Self::Beidou44];

    /// Returns the name on command lines and in tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Gps24 => "gps24",
            Self::Gps31 => "gps31",
            Self::BeidouRegional => "bds_regional",
            Self::BeidouGlobal => "bds_global",
            Self::Beidou44 => "bds44",
            Self::Beidou24 => "bds24",
            Self::Galileo24 => "galileo24",
            Self::Glonass24 => "glonass24",
        }
    }

    /// Returns the system of the fleet.
    pub const fn constellation(self) -> Constellation {
        match self {
            Self::Gps24 | Self::Gps31 => Constellation::Gps,
            Self::BeidouRegional | Self::BeidouGlobal | Self::Beidou44 | Self::Beidou24 => {
                Constellation::Beidou
            }
            Self::Galileo24 => Constellation::Galileo,
            Self::Glonass24 => Constellation::Glonass,
        }
    }

    /// Returns the satellites, numbered from 1 in the order of their slots. The medium orbits of
    /// `BeiDou` alone are numbered from 19, where its third generation begins.
    ///
    /// Numbers are slots, not the codes that real satellites send. In the regional and the global
    /// fleet 1 to 5 are geostationary as in reality; any further agreement is by chance.
    pub fn satellites(self) -> Vec<Satellite> {
        let numbered = |(number, orbit)| {
            SatelliteId::new(self.constellation(), number).map(|id| Satellite { id, orbit })
        };
        let first = if self == Self::Beidou24 { 19 } else { 1 };
        (first..).zip(self.orbits()).filter_map(numbered).collect()
    }

    fn orbits(self) -> Vec<Orbit> {
        match self {
            Self::Gps24 => gps24(),
            Self::Gps31 => gps31(),
            Self::BeidouRegional => beidou_regional(),
            Self::BeidouGlobal => beidou_global(),
            Self::Beidou44 => beidou44(),
            Self::Beidou24 => walker(BEIDOU_AXIS_M, INCLINATION_DEG).collect(),
            Self::Galileo24 => walker(GALILEO_AXIS_M, GALILEO_INCLINATION_DEG).collect(),
            Self::Glonass24 => walker(GLONASS_AXIS_M, GLONASS_INCLINATION_DEG).collect(),
        }
    }
}

/// Nodes of the six planes A to F and arguments of latitude of their slots 1 to 4, degrees
/// ([GPS-SPS] table 3.2-1).
///
/// [GPS-SPS]: crate#references
const GPS_SLOTS_DEG: [(f64, [f64; 4]); 6] = [
    (272.847, [268.126, 161.786, 11.676, 41.806]),
    (332.847, [80.956, 173.336, 309.976, 204.376]),
    (32.847, [111.876, 11.796, 339.666, 241.556]),
    (92.847, [135.226, 265.446, 35.156, 167.356]),
    (152.847, [197.046, 302.596, 66.066, 333.686]),
    (212.847, [238.886, 345.226, 105.206, 135.346]),
];

/// Semi-major axis of the GPS baseline, m ([GPS-SPS]).
///
/// [GPS-SPS]: crate#references
const GPS_AXIS_M: f64 = 26_559_710.0;

/// Semi-major axis of a medium `BeiDou` orbit, m: 21,528 km above the equator ([BDS-SIS-ICD]).
///
/// [BDS-SIS-ICD]: crate#references
const BEIDOU_AXIS_M: f64 = 27_906_100.0;

/// Semi-major axis of a Galileo orbit, m, and its inclination, degrees ([Galileo-OS-SDD]).
///
/// [Galileo-OS-SDD]: crate#references
const GALILEO_AXIS_M: f64 = 29_599_801.0;
const GALILEO_INCLINATION_DEG: f64 = 56.0;

/// Semi-major axis of a GLONASS orbit, m: 19,100 km above the ground, and its inclination, degrees
/// ([GLONASS-ICD]).
///
/// [GLONASS-ICD]: crate#references
const GLONASS_AXIS_M: f64 = 25_508_000.0;
const GLONASS_INCLINATION_DEG: f64 = 64.8;

/// Inclination of the orbits of GPS and `BeiDou` but the geostationary ones, degrees.
const INCLINATION_DEG: f64 = 55.0;

fn gps24() -> Vec<Orbit> {
    let inclination_rad = INCLINATION_DEG.to_radians();
    let plane = |(node_deg, slots_deg): (f64, [f64; 4])| {
        slots_deg.map(|slot_deg| {
            Orbit::circular(GPS_AXIS_M, inclination_rad, node_deg.to_radians(), slot_deg.to_radians())
        })
    };
    GPS_SLOTS_DEG.into_iter().flat_map(plane).collect()
}

fn gps31() -> Vec<Orbit> {
    include_str!("gps_almanac_2020.csv")
        .lines()
        .filter(|line| line.starts_with(|first: char| first.is_ascii_digit()))
        .map(almanac_line)
        .collect()
}

/// Parses one line of the almanac file. The file is part of the program, so a bad line is a mistake
/// in the source.
fn almanac_line(line: &str) -> Orbit {
    let fields: Vec<f64> = line.split(',').map(|field| field.parse().expect("a number")).collect();
    let [_, axis_m, eccentricity, inclination_rad, node_rad, perigee_rad, mean_rad, rate_rad_s] = fields[..]
    else {
        panic!("eight fields in {line:?}")
    };
    Orbit {
        semi_major_axis_m: axis_m,
        eccentricity,
        inclination_rad,
        node_rad,
        node_rate_rad_s: rate_rad_s,
        perigee_rad,
        mean_anomaly_rad: mean_rad,
        mean_motion_rad_s: mean_motion_rad_s(axis_m),
    }
}

fn geostationary(longitude_deg: f64) -> Orbit {
    Orbit::geosynchronous(0.0, 0.0, longitude_deg.to_radians())
}

fn inclined(node_deg: f64, knot_deg: f64) -> Orbit {
    Orbit::geosynchronous(INCLINATION_DEG.to_radians(), node_deg.to_radians(), knot_deg.to_radians())
}

/// Returns a slot of the Walker constellation 24/3/1, planes and slots from 1; spares are between
/// slots.
fn slot(axis_m: f64, inclination_deg: f64, plane: f64, slot: f64) -> Orbit {
    let node_deg = 120.0 * (plane - 1.0);
    let argument_deg = 45.0 * (slot - 1.0) + 15.0 * (plane - 1.0);
    Orbit::circular(axis_m, inclination_deg.to_radians(), node_deg.to_radians(), argument_deg.to_radians())
}

/// Returns a medium orbit of `BeiDou`.
fn medium(plane: f64, number: f64) -> Orbit {
    slot(BEIDOU_AXIS_M, INCLINATION_DEG, plane, number)
}

fn walker(axis_m: f64, inclination_deg: f64) -> impl Iterator<Item = Orbit> {
    (0..24)
        .map(move |index| slot(axis_m, inclination_deg, f64::from(1 + index / 8), f64::from(1 + index % 8)))
}

const GEOSTATIONARY_DEG: [f64; 5] = [58.75, 80.0, 110.5, 140.0, 160.0];

fn beidou_regional() -> Vec<Orbit> {
    let inclined = [(0.0, 118.0), (120.0, 118.0), (240.0, 118.0), (0.0, 95.0), (120.0, 95.0)]
        .map(|(node_deg, knot_deg)| inclined(node_deg, knot_deg));
    let medium = [(1.0, 7.0), (1.0, 8.0), (2.0, 3.0), (2.0, 4.0)].map(|(plane, slot)| medium(plane, slot));
    GEOSTATIONARY_DEG.map(geostationary).into_iter().chain(inclined).chain(medium).collect()
}

fn beidou_global() -> Vec<Orbit> {
    let inclined = [0.0, 120.0, 240.0].map(|node_deg| inclined(node_deg, 118.0));
    let spares = [1.0, 2.0, 3.0].map(|plane| medium(plane, 8.5));
    let stationary = GEOSTATIONARY_DEG.map(geostationary);
    stationary
        .into_iter()
        .chain(inclined)
        .chain(walker(BEIDOU_AXIS_M, INCLINATION_DEG))
        .chain(spares)
        .collect()
}

fn beidou44() -> Vec<Orbit> {
    // The inclined orbits have three planes, 120° apart; two satellites of later launches follow
    // 60° behind them.
    let second =
        [(210.0, 118.0), (330.0, 118.0), (450.0, 118.0), (210.0, 95.0), (330.0, 95.0), (450.0, 112.0)];
    let third = [(450.0, 95.0)];
    let last = [(270.0, 118.0), (390.0, 118.0), (510.0, 118.0)];
    let tilted = |(node_deg, knot_deg)| inclined(node_deg, knot_deg);
    let spares = [(1.0, 8.3), (2.0, 3.3), (2.0, 4.3)].map(|(plane, slot)| medium(plane, slot));
    let stationary = [140.0, 84.0, 110.5, 160.0, 58.75].map(geostationary);
    stationary
        .into_iter()
        .chain(second.map(tilted))
        .chain(third.map(tilted))
        .chain(spares)
        .chain(walker(BEIDOU_AXIS_M, INCLINATION_DEG))
        .chain(last.map(tilted))
        .chain([140.1, 80.1].map(geostationary))
        .collect()
}
