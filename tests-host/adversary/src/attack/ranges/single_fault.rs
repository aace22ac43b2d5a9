//! One satellite wrong by a step or a ramp of any size, under every method, policy and aid.
//!
//! Sizes range from undetectable to obvious. A level holds with a probability, so the rate of
//! faulty epochs above their level may equal that of missed detections.

use raim::signal::fault::{Fault, Kind, Target};

use crate::attack::prelude::*;

/// Attack with steps.
pub(super) const STEPS: Attack = Attack {
    name: "step",
    about: "one satellite wrong by 2 m to 2 km, every method, policy and aid",
    branch: Branch::OneSatellite,
    before: "0 of 1,122 beyond",
    note: "",
    run: |effort| run(effort, |bias_m| Kind::Step { bias_m }),
};

/// Attack with ramps.
pub(super) const RAMPS: Attack = Attack {
    name: "ramp",
    about: "one satellite drifting by 2 m to 2 km within a minute, every method, policy and aid",
    branch: Branch::OneSatellite,
    before: "14 of 1,249, all with `CLOCKAID`",
    note: "",
    run: |effort| {
        run(effort, |bias_m| Kind::Ramp { rate_m_s: bias_m / f64::from(FAULTY), limit_m: bias_m.abs() })
    },
};

/// Attack with gross faults, such as whole milliseconds, which receivers confuse.
pub(super) const GROSS: Attack = Attack {
    name: "gross-fault",
    about: "one satellite wrong by 20 km, 100 km or a millisecond and more, every method and aid",
    branch: Branch::OneSatellite,
    before: "promised: `AUTO`, `RANSAC` 75 %, `SEQUENTIAL`, `HYBRID`, `GROUPING` 33 %",
    note: "",
    run: gross,
};

/// Every identification method, alone and with an aid.
const METHODS: [&[&str]; 9] = [
    &["METHOD,AUTO"],
    &["METHOD,BAARDA"],
    &["METHOD,SIMULTANEOUS"],
    &["METHOD,SEQUENTIAL"],
    &["METHOD,HYBRID"],
    &["METHOD,GROUPING"],
    &["METHOD,RANSAC"],
    &["METHOD,SEPARATION"],
    &["METHOD,GROUPING", "CLOCKAID,ON"],
];

/// Gross faults, m.
const GROSS_M: [f64; 6] = [2e4, 1e5, -1e5, 299_792.458, -299_792.458, 5_995_849.16];

/// Smallest share of the epochs that must be promised in spite of the fault.
const KEPT: f64 = 0.95;

/// Sizes of faults, m, drawn uniformly in their logarithm.
const SIZES_M: std::ops::Range<f64> = 2.0..2000.0;

/// Healthy epochs, and the faulty ones that follow.
const HEALTHY: u32 = 20;
const FAULTY: u32 = 60;

/// Probability of missed detection at start.
const MISSED: f64 = 1e-3;

/// Settings of the module. Limits close to the levels are included, because there a fault matters.
const SETTINGS: [&[&str]; 11] = [
    &["METHOD,BAARDA"],
    &["METHOD,SIMULTANEOUS"],
    &["METHOD,SEQUENTIAL"],
    &["METHOD,HYBRID"],
    &["METHOD,GROUPING"],
    &["METHOD,RANSAC"],
    &["METHOD,GROUPING", "CLOCKAID,ON"],
    &["CLOCKAID,ON", "HAL,40"],
    &["HAL,40", "VAL,50"],
    &["POLICY,T2", "HAL,60"],
    &["POLICY,TOP", "HAL,60"],
];

fn run(effort: Effort, kind: fn(f64) -> Kind) -> Result<Vec<Figure>> {
    let runs: Vec<(usize, u64)> =
        (0..SETTINGS.len()).flat_map(|set| (0..effort.pick(2, 60)).map(move |seed| (set, seed))).collect();
    let tallies: Vec<Tally> =
        runs.iter().together(|&(set, seed)| attempt(SETTINGS[set], seed, kind)).collect::<Result<_>>()?;
    let all = tallies.iter().fold(Tally::default(), Tally::with);
    let mut figures = all.figures_by_rate(MISSED);
    for (set, commands) in SETTINGS.iter().enumerate() {
        let of_set = runs.iter().zip(&tallies).filter(|((of, _), _)| *of == set).map(|(_, tally)| tally);
        let tally = of_set.fold(Tally::default(), Tally::with);
        if tally.outcomes.misleading > 0 {
            figures.push(Figure::plain(
                format!("of these {}", commands.join(" ")),
                tally.outcomes.misleading as f64,
            ));
        }
    }
    Ok(figures)
}

fn gross(effort: Effort) -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    let mut all = Tally::default();
    for commands in METHODS {
        let runs: Vec<(f64, u64)> = GROSS_M
            .into_iter()
            .flat_map(|bias_m| (0..effort.pick(4, 24)).map(move |seed| (bias_m, seed)))
            .collect();
        let tallies: Vec<Tally> =
            runs.iter().together(|&(bias_m, seed)| grossly(commands, bias_m, seed)).collect::<Result<_>>()?;
        let tally = tallies.iter().fold(Tally::default(), Tally::with);
        let share = 100.0 * tally.outcomes.promised as f64 / tally.outcomes.epochs() as f64;
        figures.push(Figure::at_least(format!("% protected by {}", commands.join(" ")), share, 100.0 * KEPT));
        all = all.with(&tally);
    }
    figures.extend(all.figures(0.0));
    Ok(figures)
}

/// Sends all GPS satellites in view, with `BeiDou` in every other sky, one of them grossly wrong.
fn grossly(commands: &[&str], bias_m: f64, seed: u64) -> Result<Tally> {
    let start_s = 2000.0 + 3300.0 * seed as f64;
    let sky = Sky::of(&Simulation::above_xian(start_s, HEALTHY + FAULTY, seed), Frequency::Dual)?;
    let is_alone = seed % 2 == 1;
    let mut seen: Vec<SatelliteId> = sky.recording.epochs[0].satellites();
    seen.retain(|satellite| !is_alone || satellite.constellation() == Constellation::Gps);
    let faulty = seen[ChaCha8Rng::seed_from_u64(seed).random_range(0..seen.len())];
    let bytes = sky.bytes(|index, epoch| {
        epoch.satellites.retain(|raw| seen.contains(&raw.satellite));
        if index >= HEALTHY as usize {
            epoch.lengthen(faulty, bias_m);
        }
    })?;
    receive(commands, &sky, &bytes)
}

fn attempt(commands: &[&str], seed: u64, kind: fn(f64) -> Kind) -> Result<Tally> {
    let sky = Sky::quiet(HEALTHY + FAULTY, seed)?;
    let mut chance = ChaCha8Rng::seed_from_u64(seed);
    let seen: Vec<SatelliteId> = sky.recording.epochs[0].satellites();
    let size_m = chance.random_range(SIZES_M.start.ln()..SIZES_M.end.ln()).exp();
    let bias_m = if chance.random() { size_m } else { -size_m };
    // The number kept ranges from all in view down to hardly a redundant one.
    let kept = chance.random_range(7..=seen.len().max(8));
    let kept: Vec<SatelliteId> = seen.sample(&mut chance, kept).copied().collect();
    let faulty = *kept.choose(&mut chance).unwrap_or(&seen[0]);
    let fault = Fault {
        target: Target::Satellite(faulty),
        kind: kind(bias_m),
        start_s: f64::from(HEALTHY),
        end_s: f64::INFINITY,
    };
    let bytes = sky.bytes(|index, epoch| {
        epoch.satellites.retain(|raw| kept.contains(&raw.satellite));
        fault.apply(epoch, index as f64);
    })?;
    receive(commands, &sky, &bytes)
}

/// Counts the reports of a module with these settings on the faulty epochs.
fn receive(commands: &[&str], sky: &Sky, bytes: &[Vec<u8>]) -> Result<Tally> {
    let (mut victim, mut tally) = (Victim::new(commands, 1.0)?, Tally::default());
    for (index, bytes) in bytes.iter().enumerate() {
        let seen = victim.receive(bytes, sky.truth)?;
        if index >= HEALTHY as usize {
            tally.add_all(&seen);
        }
    }
    Ok(tally)
}
