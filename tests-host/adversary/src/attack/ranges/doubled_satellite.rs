//! One satellite under two numbers, as a converter sends it that maps two to one: ranges and orbits
//! of the second are those of the first, and wrong by the same amount.
//!
//! ```text
//! δρ_i = δρ_j = δ        two ranges agree that the third is wrong
//! ```

use crate::attack::prelude::*;

pub(super) const ATTACK: Attack = Attack {
    name: "doubled-satellite",
    about: "a satellite that is 20 to 300 m wrong comes under two or three numbers, AUTO and SEPARATION",
    branch: Branch::Several,
    before: "6 of 76 beyond",
    note: "",
    run,
};

/// Sizes of the fault, m.
const SIZES_M: [f64; 5] = [20.0, 40.0, 80.0, 150.0, 300.0];

fn run(effort: Effort) -> Result<Vec<Figure>> {
    let (mut tally, mut twice) = (Tally::default(), 0);
    for seed in 0..effort.pick(40, 400) {
        for method in ["METHOD,AUTO", "METHOD,SEPARATION"] {
            for copies in [1, 2] {
                let (one, counted) = attempt(seed, method, copies)?;
                tally += &one;
                twice += counted;
            }
        }
    }
    let mut figures = tally.figures(0.0);
    figures.push(Figure::at_least("satellite_twice", f64::from(twice), 1.0));
    Ok(figures)
}

fn attempt(seed: u64, method: &str, copies: u8) -> Result<(Tally, u32)> {
    let mut chance = ChaCha8Rng::seed_from_u64(seed);
    let size_m = SIZES_M[seed as usize % SIZES_M.len()];
    let simulation = Simulation {
        satellites: Fleet::Gps31.satellites(),
        ..Simulation::above_xian(start_s(&mut chance), 1, seed)
    };
    let mut sky = Sky::with(&simulation, "G", Frequency::Dual)?;
    let seen = sky.recording.epochs[0].satellites();
    let doubled = seen[chance.random_range(0..seen.len())];
    // Numbers whose satellites are below the horizon.
    let free = (1..=31).filter_map(|number| SatelliteId::new(Constellation::Gps, number));
    let names: Vec<SatelliteId> =
        free.filter(|name| !seen.contains(name)).take(usize::from(copies)).collect();
    sky.recording.ephemerides.retain(|set| !names.contains(&set.satellite));
    let own: Vec<_> =
        sky.recording.ephemerides.iter().filter(|set| set.satellite == doubled).cloned().collect();
    for &name in &names {
        for mut set in own.clone() {
            set.satellite = name;
            if let Ephemeris::Gps(message) = &mut set.message {
                message.gps_satellite_id = name.number();
            }
            sky.recording.ephemerides.push(set);
        }
    }
    let bytes = sky.bytes(|_, epoch| {
        epoch.lengthen(doubled, size_m);
        let raw = epoch.satellites.iter().find(|raw| raw.satellite == doubled).cloned();
        for &name in &names {
            epoch.satellites.extend(raw.clone().map(|mut raw| {
                raw.satellite = name;
                raw
            }));
        }
    })?;
    let mut victim = Victim::new(&[method], 1.0)?;
    let tally = victim.judge(bytes, sky.truth)?;
    Ok((tally, victim.counter("satellite_twice")?))
}
