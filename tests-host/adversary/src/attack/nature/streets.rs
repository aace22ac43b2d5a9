//! Streets: real recordings between simulated walls that block low satellites or reflect them late.
//!
//! ```text
//! satellite:  e < atan(tan(r) |sin(a − s)|)   behind a wall
//! reflected:  δρ = 2 d cos(e) |sin(a − s)|
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | `e`, `a` | elevation and azimuth of the satellite | rad |
//! | `s` | direction of the street | rad |
//! | `r`, `d` | elevation of the roof across the street, and distance of the reflecting wall | rad, m |
//!
//! A block of houses lasts for [`BLOCK_S`]; then the street has another direction, other roofs and
//! other walls. A wall between satellite and antenna blocks the signal, or the antenna receives the
//! reflection of the other side. Noise and signal strength stay those of the recording, so that the
//! ranges alone reveal the walls.
//!
//! A level bounds one fault, and a street makes several at once. Therefore the share of promised
//! epochs above their level is bounded, but not zero. The share of promised epochs has a bound as
//! well, because a module that promises nothing misleads nobody.

use raim::signal::lumps::{Broadcast, Heaven};
use rig::stations::{ESBC, STATIC_BASE, Station, TLSE};

use super::recordings::{load, skipped};
use crate::attack::prelude::*;

pub(super) const ATTACK: Attack = Attack {
    name: "streets",
    about: "three real recordings on two frequencies between simulated walls that block low satellites or reflect them late, the method at start",
    branch: Branch::Several,
    before: "24 of 14,446 promised epochs; at length 420 of 270,714, before the rest after an exclusion counted",
    note: "at length 40 drives of each recording",
    run,
};

/// Recordings, and the systems sent of each.
const STREETS: [(&Station, &str); 5] =
    [(&ESBC, "GCE"), (&ESBC, "GC"), (&TLSE, "GCE"), (&TLSE, "GC"), (&STATIC_BASE, "GCE")];

/// Length of a block of houses, s, and least number of its epochs.
const BLOCK_S: f64 = 30.0;
const BLOCK_EPOCHS: usize = 8;

/// Probability that a wall blocks a satellite and does not reflect it.
const BLOCKED: f64 = 0.5;

/// Largest share of the promised epochs that may exceed a level.
pub(in crate::attack) const BEYOND: f64 = 2e-4;

/// Least share of the epochs that must be promised: four fifths of the 14,446 of 16,206 that were
/// promised before any evidence of the last minute counted.
const PROMISED: f64 = 0.8 * 14_446.0 / 16_206.0;

/// Walls of one block of houses.
struct Block {
    street_rad: f64,
    /// Roofs on both sides of the street.
    roof_tangents: [f64; 2],
    /// Distances of both walls, m.
    walls_m: [f64; 2],
    chance: u64,
}

impl Block {
    fn draw(chance: &mut ChaCha8Rng) -> Self {
        let mut roof_tangent = || chance.random_range(-30.0_f64..45.0).max(0.0).to_radians().tan();
        let roof_tangents = [roof_tangent(), roof_tangent()];
        let mut wall_m = || chance.random_range(5.0..70.0);
        let walls_m = [wall_m(), wall_m()];
        Self {
            street_rad: chance.random_range(0.0..std::f64::consts::PI),
            roof_tangents,
            walls_m,
            chance: chance.random(),
        }
    }

    /// Returns the delay of a satellite in this direction, m: 0 in the open, `None` if it is
    /// blocked.
    fn delay_m(&self, satellite: SatelliteId, towards: Enu) -> Option<f64> {
        let aside = (towards.east.atan2(towards.north) - self.street_rad).sin();
        let (near, far) = if aside < 0.0 { (0, 1) } else { (1, 0) };
        let level = towards.east.hypot(towards.north);
        if towards.up > self.roof_tangents[near] * aside.abs() * level {
            return Some(0.0);
        }
        let name = u64::from(satellite.number()) << 8 | satellite.constellation() as u64;
        let mut chance = ChaCha8Rng::seed_from_u64(self.chance ^ name);
        let is_blocked = chance.random_bool(BLOCKED);
        (!is_blocked).then(|| 2.0 * self.walls_m[far] * level * aside.abs())
    }
}

/// Directions of the satellites of each epoch.
pub(in crate::attack) type Directions = Vec<Vec<(SatelliteId, Enu)>>;

fn run(effort: Effort) -> Result<Vec<Figure>> {
    if shared::path("data").is_none() {
        return Ok(skipped());
    }
    let (seeds, most) = (effort.pick(6, 40), effort.pick(600, usize::MAX));
    let (mut all, mut figures) = (Tally::default(), Vec::new());
    for (station, systems) in STREETS {
        let streets = of_station(station, systems, seeds, most)?;
        figures.extend(streets.figures(&format!("{} {systems}", station.folder)));
        all += &streets.all;
    }
    figures.push(Figure::at_least(format!("all protected {}, share", all.promised()), all.share(), PROMISED));
    figures.push(Figure::at_most(format!("{} beyond, share", all.misleading()), all.beyond(), BEYOND));
    Ok(figures)
}

/// Epochs of the streets, in all and by the number of excluded satellites.
#[derive(Clone, Debug, Default)]
pub(in crate::attack) struct Streets {
    pub(in crate::attack) all: Tally,
    by_excluded: [Tally; 4],
}

impl Streets {
    fn add(&mut self, seen: &Seen) {
        self.all.add(seen);
        if let Some(tally) = self.by_excluded.get_mut(seen.reported.excluded.len()) {
            tally.add(seen);
        }
    }

    fn with(mut self, other: &Self) -> Self {
        self.all += &other.all;
        self.by_excluded.iter_mut().zip(&other.by_excluded).for_each(|(sum, more)| *sum += more);
        self
    }

    fn figures(&self, name: &str) -> Vec<Figure> {
        let all = &self.all;
        let mut figures = vec![
            Figure::plain(format!("{name} protected of {}", all.outcomes.epochs()), all.promised()),
            Figure::plain("beyond", all.misleading()),
        ];
        for (count, tally) in self.by_excluded.iter().enumerate() {
            let quantity = format!("of {} without {count}", tally.outcomes.promised);
            figures.push(Figure::plain(quantity, tally.misleading()));
        }
        figures.push(Figure::plain("largest error, m", all.worst_m()));
        figures.push(Figure::plain("SIGMAS", all.of_reason("SIGMAS") as f64));
        figures
    }
}

fn of_station(station: &Station, systems: &str, seeds: u64, most: usize) -> Result<Streets> {
    let recording = load(station)?;
    let selection = Selection::new(systems, Frequency::Dual)?;
    let directions = directions(&recording, &selection, station.truth, most)?;
    let runs: Vec<Streets> = (0..seeds)
        .together(|seed| drive(&recording, &selection, &directions, station.truth, (0, seed)))
        .collect::<Result<_>>()?;
    Ok(runs.iter().fold(Streets::default(), Streets::with))
}

/// Returns the directions of the satellites, as the module locates them.
pub(in crate::attack) fn directions(
    recording: &Recording,
    selection: &Selection,
    antenna: Ecef,
    most: usize,
) -> Result<Directions> {
    let broadcast = Broadcast {
        ephemerides: &recording.ephemerides,
        klobuchar: recording.klobuchar,
        leap_s: recording.leap_s,
        approximate_position: Some(antenna),
    };
    let mut heaven = Heaven::of(&broadcast, selection)?;
    recording.epochs.iter().take(most).map(|epoch| heaven.directions(epoch)).collect()
}

/// Drives one street with the antenna of a recording. The epochs before the first one of the street
/// are received in the open, and not counted.
pub(in crate::attack) fn drive(
    recording: &Recording,
    selection: &Selection,
    directions: &Directions,
    truth: Ecef,
    (begins, seed): (usize, u64),
) -> Result<Streets> {
    let step_s = step_s(recording);
    let epochs_per_block = BLOCK_EPOCHS.max((BLOCK_S / step_s) as usize);
    let mut chance = ChaCha8Rng::seed_from_u64(seed);
    let mut block = Block::draw(&mut chance);
    let mut victim = Victim::new(&[], step_s)?;
    let mut encoder = Encoder::new(&recording.ephemerides, selection.clone());
    let mut streets = Streets::default();
    for (index, (epoch, seen)) in recording.epochs.iter().zip(directions).enumerate() {
        if index < begins {
            victim.receive(&encoder.epoch(epoch)?, truth)?;
            continue;
        }
        if index > begins && (index - begins) % epochs_per_block == 0 {
            block = Block::draw(&mut chance);
        }
        let mut epoch = epoch.clone();
        for &(satellite, towards) in seen {
            match block.delay_m(satellite, towards) {
                Some(late_m) => epoch.lengthen(satellite, late_m),
                None => epoch.lose(satellite),
            }
        }
        victim.receive(&encoder.epoch(&epoch)?, truth)?.iter().for_each(|seen| streets.add(seen));
    }
    Ok(streets)
}
