//! One satellite wrong by a step or a ramp of any size, under every method, policy and aid.
//!
//! Sizes range from undetectable to obvious. A level holds with a probability, so the rate of
//! faulty epochs above their level may equal that of missed detections.

use raim::signal::fault::Kind;

use crate::attack::prelude::*;

pub(super) const STEPS: Attack = Attack {
    name: "step",
    about: "one satellite wrong by 2 m to 2 km, every method, policy and aid",
    branch: Branch::OneSatellite,
    before: "0 of 1,122 beyond",
    note: "",
    run: |effort| run(effort, |bias_m| Kind::Step { bias_m }),
};

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
    let all: Tally = tallies.iter().collect();
    let mut figures = all.figures_by_rate(MISSED);
    for (set, commands) in SETTINGS.iter().enumerate() {
        let of_set = runs.iter().zip(&tallies).filter(|((of, _), _)| *of == set).map(|(_, tally)| tally);
        let tally: Tally = of_set.collect();
        if tally.outcomes.misleading > 0 {
            figures.push(Figure::plain(format!("of these {}", commands.join(" ")), tally.misleading()));
        }
    }
    Ok(figures)
}

fn gross(effort: Effort) -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    let mut all = Tally::default();
    for commands in METHODS {
        let seeds = 0..effort.pick(4, 24);
        let runs = GROSS_M.into_iter().flat_map(|bias_m| seeds.clone().map(move |seed| (bias_m, seed)));
        let runs = runs.together(|(bias_m, seed)| grossly(commands, bias_m, seed));
        let tally: Tally = runs.collect::<Result<_>>()?;
        let quantity = format!("% protected by {}", commands.join(" "));
        figures.push(Figure::at_least(quantity, tally.percent(), 100.0 * KEPT));
        all += &tally;
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
    let bias_m = signed_size(SIZES_M, &mut chance);
    // The number kept ranges from all in view down to hardly a redundant one.
    let (kept, faulty) = sky.draw(&mut chance);
    let fault = lasting(faulty, kind(bias_m), HEALTHY);
    let bytes = sky.bytes(|index, epoch| {
        epoch.satellites.retain(|raw| kept.contains(&raw.satellite));
        fault.apply(epoch, index as f64);
    })?;
    receive(commands, &sky, &bytes)
}

/// Counts the reports of a module with these settings on the faulty epochs.
fn receive(commands: &[&str], sky: &Sky, bytes: &[Vec<u8>]) -> Result<Tally> {
    let mut victim = Victim::new(commands, 1.0)?;
    victim.judge(&bytes[..HEALTHY as usize], sky.truth)?;
    victim.judge(&bytes[HEALTHY as usize..], sky.truth)
}
