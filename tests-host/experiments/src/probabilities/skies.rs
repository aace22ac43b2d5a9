//! Skies of six to forty satellites of one to three constellations, drawn from those in view at
//! some instant of a day.

use raim::signal::sky::{Fleet, Satellite, Sight, Site, sights};
use raim_core::satellite::{Constellation, SatelliteId};
use rand::RngExt as _;
use rand::rngs::ChaCha8Rng;

use super::geometry::Geometry;
use crate::draw::{distinct, generator};

/// Elevation mask, degrees: low, for skies of many satellites.
const MASK_DEG: f64 = 5.0;

/// Redundancy number below which dense inversion of a row is inaccurate.
const UNTESTABLE: f64 = 1e-6;

/// Numbers of satellites, by the number of constellations.
pub(super) const KINDS: [(usize, &[usize]); 3] =
    [(1, &[6, 8, 10, 12]), (2, &[8, 10, 14, 20, 26]), (3, &[10, 16, 24, 32, 40])];

/// Satellites in view of a receiver, with their dense least squares.
pub(super) struct Scene {
    pub(super) sights: Vec<Sight>,
    pub(super) geometry: Geometry,
}

/// Returns the number of constellations in words.
pub(super) fn systems_in_words(constellations: usize) -> &'static str {
    match constellations {
        1 => "one constellation",
        2 => "two constellations",
        _ => "three constellations",
    }
}

/// Draws `count` satellites of `constellations` constellations from those in view at an instant;
/// returns `None` if there is no such sky.
pub(super) fn scene(site: &Site, constellations: usize, count: usize, number: u64) -> Option<Scene> {
    const ATTEMPTS: u32 = 200;
    let mut chance = generator(3000 + (constellations * 100 + count) as u64, number);
    let fleet: Vec<Satellite> = fleets().into_iter().take(constellations).flatten().collect();
    (0..ATTEMPTS).find_map(|_| {
        let t_s = chance.random_range(0.0..86_400.0);
        let seen = sights(&fleet, site, t_s, MASK_DEG.to_radians());
        chosen(&seen, constellations, count, &mut chance)
    })
}

fn chosen(seen: &[Sight], constellations: usize, count: usize, chance: &mut ChaCha8Rng) -> Option<Scene> {
    if seen.len() < count {
        return None;
    }
    let sights: Vec<Sight> = distinct(chance, count, seen.len())
        .into_iter()
        .filter_map(|index| seen.get(index).copied())
        .collect();
    let mut systems: Vec<Constellation> =
        sights.iter().map(|sight| sight.satellite.constellation()).collect();
    systems.sort_unstable();
    systems.dedup();
    if systems.len() != constellations {
        return None;
    }
    Some(Scene { geometry: Geometry::seen(&sights)?, sights })
}

/// Returns GPS, `BeiDou`, and the baseline of GPS instead of Galileo, because a third system only
/// adds a clock, whatever its orbits.
fn fleets() -> [Vec<Satellite>; 3] {
    let renamed = |satellite: Satellite| {
        let id = SatelliteId::new(Constellation::Galileo, satellite.id.number())?;
        Some(Satellite { id, ..satellite })
    };
    [
        Fleet::Gps31.satellites(),
        Fleet::Beidou44.satellites(),
        Fleet::Gps24.satellites().into_iter().filter_map(renamed).collect(),
    ]
}

/// Returns the satellites with the largest slopes: `tried` horizontal ones, and `tried` vertical
/// ones.
pub(super) fn steepest(geometry: &Geometry, tried: usize) -> Vec<usize> {
    let testable =
        (0..geometry.rows.len()).filter(|&index| geometry.dense.projection[(index, index)] > UNTESTABLE);
    let slope = |index: usize, rows: &[usize]| {
        let moved: f64 = rows.iter().map(|&row| geometry.dense.gain[(row, index)].powi(2)).sum();
        moved.sqrt() / geometry.visibility(index)
    };
    let mut chosen = Vec::new();
    for rows in [&[0, 1][..], &[2]] {
        let mut order: Vec<usize> = testable.clone().collect();
        order.sort_by(|&a, &b| slope(b, rows).total_cmp(&slope(a, rows)));
        chosen.extend(order.into_iter().take(tried));
    }
    chosen.sort_unstable();
    chosen.dedup();
    chosen
}
