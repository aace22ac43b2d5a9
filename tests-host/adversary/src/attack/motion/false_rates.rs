//! Range rates with the wrong sign, as early firmware of a common receiver sends them, and random
//! range rates.
//!
//! The ranges are right, so the position is promised; the receiver stands still. If enough
//! satellites may be left out, some of the few that remain always agree by chance.

use crate::attack::forgery::keep_first;
use crate::attack::prelude::*;

pub(super) const NEGATED: Attack = Attack {
    name: "negated-rates",
    about: "right ranges, and all range rates of 5 to 10 satellites with the wrong sign",
    branch: Branch::Counterfeit,
    before: "84 velocities reported, up to 24.7 km/s",
    note: "",
    run: negated,
};

pub(super) const RANDOM: Attack = Attack {
    name: "random-rates",
    about: "right ranges, and all range rates of 5 to 10 satellites off by a random number, up to 0.5 to 100 m/s",
    branch: Branch::Counterfeit,
    before: "3,019 of 16,000 reported, 1,172 beyond their levels, up to 376 m/s",
    note: "",
    run: random,
};

/// Satellites in sight.
const KEPT: [usize; 5] = [5, 6, 7, 8, 10];

/// Largest errors of random rates, m/s.
const SPREADS_M_S: [f64; 4] = [0.5, 2.0, 10.0, 100.0];

/// Epochs sent.
const EPOCHS: u32 = 200;

/// Wavelength of GPS L1, m.
const WAVELENGTH_M: f64 = 0.19;

/// Counts of the velocities that the module reports beside a promised position.
#[derive(Clone, Copy, Debug, Default)]
struct Told {
    epochs: usize,
    promised: usize,
    velocities: usize,
    /// Velocities with an error above a level.
    misleading: usize,
    worst_m_s: f64,
}

impl Told {
    fn with(self, other: &Self) -> Self {
        Self {
            epochs: self.epochs + other.epochs,
            promised: self.promised + other.promised,
            velocities: self.velocities + other.velocities,
            misleading: self.misleading + other.misleading,
            worst_m_s: self.worst_m_s.max(other.worst_m_s),
        }
    }

    /// Counts the report on an epoch. The true velocity is zero.
    fn add(&mut self, victim: &Victim) {
        self.epochs += 1;
        self.promised += usize::from(victim.is_promised());
        let Some(velocity) = victim.module.velocity().filter(|_| victim.is_promised()) else { return };
        let [east, north, up] = velocity.east_north_up_m_s;
        let (ground_m_s, levels) = (east.hypot(north), velocity.levels_m_s);
        self.velocities += 1;
        self.misleading += usize::from(ground_m_s > levels.hpl_m || up.abs() > levels.vpl_m);
        self.worst_m_s = self.worst_m_s.max(ground_m_s).max(up.abs());
    }

    fn figures(&self) -> Vec<Figure> {
        vec![
            Figure::plain("epochs", self.epochs as f64),
            Figure::plain("velocities told", self.velocities as f64),
            Figure::plain("largest of them, m/s", self.worst_m_s),
        ]
    }
}

fn negated(effort: Effort) -> Result<Vec<Figure>> {
    let seeds = effort.pick(24, 96);
    let reverse = |sign: f64| {
        attempts(seeds, &|kept, seed| {
            attempt(kept, seed, |epoch| change(epoch, |doppler_hz| sign * doppler_hz))
        })
    };
    let (wrong, right) = (reverse(-1.0)?, reverse(1.0)?);
    let mut figures = wrong.figures();
    figures.push(Figure::at_most("beyond their level", wrong.misleading as f64, 0.0));
    let told = 100.0 * right.velocities as f64 / right.promised as f64;
    figures.push(Figure::at_least("told with the right sign, % of promised epochs", told, 95.0));
    Ok(figures)
}

fn random(effort: Effort) -> Result<Vec<Figure>> {
    let (mut all, mut figures) = (Told::default(), Vec::new());
    for spread_m_s in SPREADS_M_S {
        let told = attempts(effort.pick(4, 60), &|kept, seed| {
            let mut chance = ChaCha8Rng::seed_from_u64(seed);
            let spread_hz = spread_m_s / WAVELENGTH_M;
            attempt(kept, seed, |epoch| {
                change(epoch, |doppler_hz| doppler_hz + chance.random_range(-spread_hz..spread_hz));
            })
        })?;
        let name = format!("beyond their level, off by up to {spread_m_s} m/s");
        figures.push(Figure::plain(name, told.misleading as f64));
        all = all.with(&told);
    }
    figures.extend(all.figures());
    figures.push(Figure::at_most("their rate is above", least_rate(all.misleading, all.epochs), MISSED));
    Ok(figures)
}

/// Attempts every seed with every number of satellites.
fn attempts(seeds: u64, attempt: &(impl Fn(usize, u64) -> Result<Told> + Sync)) -> Result<Told> {
    let runs = KEPT.into_iter().flat_map(|kept| (0..seeds).map(move |seed| (kept, seed)));
    let told = runs.together(|(kept, seed)| attempt(kept, seed)).collect::<Result<Vec<_>>>()?;
    Ok(told.iter().fold(Told::default(), Told::with))
}

/// Sends a sky of a few GPS satellites whose rates `change` alters.
fn attempt(kept: usize, seed: u64, mut change: impl FnMut(&mut MeasuredEpoch)) -> Result<Told> {
    let simulation = Simulation {
        satellites: Fleet::Gps31.satellites(),
        has_range_rates: true,
        ..Simulation::above_xian(1900.0 + 3500.0 * seed as f64, EPOCHS, seed)
    };
    let sky = Sky::of(&simulation, Frequency::Dual)?;
    let bytes = sky.bytes(|_, epoch| {
        keep_first(epoch, Constellation::Gps, kept);
        change(epoch);
    })?;
    let (mut victim, mut told) = (Victim::new(&[], 1.0)?, Told::default());
    for bytes in &bytes {
        let _ = victim.receive(bytes, sky.truth)?;
        told.add(&victim);
    }
    Ok(told)
}

/// Applies `change` to the Doppler of every signal.
fn change(epoch: &mut MeasuredEpoch, mut change: impl FnMut(f64) -> f64) {
    let signals = epoch.satellites.iter_mut().flat_map(|raw| &mut raw.signals);
    for doppler_hz in signals.filter_map(|signal| signal.doppler_hz.as_mut()) {
        *doppler_hz = change(*doppler_hz);
    }
}
