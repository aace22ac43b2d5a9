//! Weak signals whose strength the receiver does not report.
//!
//! Some satellites are behind leaves or in a null of the antenna. Their code noise is that of a
//! weak signal, while their C/N0 field is 0, which MSM defines as *not computed*. The other
//! satellites report theirs. The sky is GPS alone, with pairs of frequencies.
//!
//! ```text
//! σ = a · 10^((42 − C/N0)/20)        a: code noise and multipath at the zenith, 0.42 m
//! ```
//!
//! A receiver that reports no strength for any signal, because its format carries none, is believed
//! as before.

use rand_distr::StandardNormal;

use crate::attack::prelude::*;

pub(super) const ATTACK: Attack = Attack {
    name: "unsaid-strength",
    about: "GPS, a third to two thirds of the satellites as noisy as at 28, 24, 20 and 14 dB-Hz with a C/N0 of 0, which means not computed; a healthy sky with C/N0 0 for all",
    branch: Branch::Sigmas,
    before: "19 of 2,196 beyond, up to 170 m; at length 26 of 52,052 at 14 dB-Hz, while the rest after an exclusion did not count",
    note: "a healthy sky without any C/N0 is promised as before",
    run,
};

/// Strength of the weak signals, dB-Hz: at the mask, and below it.
const WEAK_DBHZ: [f64; 4] = [28.0, 24.0, 20.0, 14.0];

/// Code noise and multipath of a strong signal at the zenith, m.
const STRONG_M: f64 = 0.42;

fn run(effort: Effort) -> Result<Vec<Figure>> {
    let (mut all, mut figures) = (Tally::default(), Vec::new());
    for weak_dbhz in WEAK_DBHZ {
        let seeds = 0..effort.pick(60, 600);
        let tally: Tally = seeds.map(|seed| receive(seed, Some(weak_dbhz))).collect::<Result<_>>()?;
        figures.push(Figure::plain(format!("beyond at {weak_dbhz} dB-Hz"), tally.misleading()));
        figures.push(Figure::plain("of protected", tally.promised()));
        all += &tally;
    }
    let silent: Tally = (0..effort.pick(12, 120)).map(|seed| receive(seed, None)).collect::<Result<_>>()?;
    figures.push(Figure::at_most("their rate is above", all.least_rate(), MISSED));
    figures.extend(all.figures(f64::INFINITY));
    let lost = silent.outcomes.epochs() - silent.outcomes.promised;
    figures.push(Figure::at_most("not promised where no strength is said", lost as f64, 0.0));
    Ok(figures)
}

/// Sends half a minute in which some satellites are that weak and report no strength. If
/// `weak_dbhz` is `None`, no satellite reports its strength.
fn receive(seed: u64, weak_dbhz: Option<f64>) -> Result<Tally> {
    let start_s = 600.0 + 5400.0 * (seed % 16) as f64;
    let sky = Sky::with(&Simulation::above_xian(start_s, 30, seed), "G", Frequency::Dual)?;
    let mut chance = ChaCha8Rng::seed_from_u64(seed);
    let seen = of_system(&sky.recording.epochs[0], Constellation::Gps);
    let count = match weak_dbhz {
        Some(_) => chance.random_range(seen.len() / 3..=2 * seen.len() / 3),
        None => seen.len(),
    };
    let unsaid: Vec<SatelliteId> = seen.sample(&mut chance, count).copied().collect();
    let noise_m = weak_dbhz.map_or(0.0, |weak_dbhz| STRONG_M * 10_f64.powf((42.0 - weak_dbhz) / 20.0));
    let bytes = sky.bytes(|_, epoch| {
        let hidden = epoch.satellites.iter_mut().filter(|raw| unsaid.contains(&raw.satellite));
        for signal in hidden.flat_map(|raw| &mut raw.signals) {
            signal.cn0_dbhz = None;
            signal.pseudorange_m += noise_m * chance.sample::<f64, _>(StandardNormal);
        }
    })?;
    Victim::new(&[], 1.0)?.judge(&bytes, sky.truth)
}
