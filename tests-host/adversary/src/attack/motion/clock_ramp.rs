//! A clock forecast that follows a fault, with too few satellites to notice.
//!
//! The module learns its clock with the whole sky. Then four, five or six satellites remain and one
//! of them drifts. The drift is slow enough that a forecast learning only from positions it vouches
//! for itself would follow it.

use raim::signal::fault::Kind;

use crate::attack::prelude::*;

pub(super) const ATTACK: Attack = Attack {
    name: "clock-ramp",
    about: "CLOCKAID, 4 to 6 satellites of one or two systems, one of them drifting off by 0.3 to 10 m/s",
    branch: Branch::OneSatellite,
    before: "367 of 2,462",
    note: "",
    run,
};

/// Epochs with all satellites, in which the module learns its clock.
const LEARNT: u32 = 90;

/// Drifts, m/s.
const RATES_M_S: [f64; 4] = [10.0, 2.0, -5.0, 0.3];

fn run(effort: Effort) -> Result<Vec<Figure>> {
    let (geometries, epochs) = effort.pick((6, 150), (40, 1200));
    let mut figures = Vec::new();
    for systems in [&[Constellation::Gps][..], &[Constellation::Gps, Constellation::Beidou]] {
        for count in 4..=6 {
            let runs = (0..geometries).together(|seed| attempt(systems, count, epochs, seed));
            let tally: Tally = runs.collect::<Result<_>>()?;
            let what = format!("{count} of {} systems", systems.len());
            figures.push(Figure::plain(format!("protected with {what}"), tally.promised()));
            figures.push(Figure::at_most(format!("beyond with {what}"), tally.misleading(), 0.0));
        }
    }
    Ok(figures)
}

fn attempt(systems: &[Constellation], count: usize, epochs: u32, seed: u64) -> Result<Tally> {
    let sky = Sky::quiet(LEARNT + epochs, seed)?;
    let mut chance = ChaCha8Rng::seed_from_u64(seed);
    let last = sky.recording.epochs.last().map_or_else(Vec::new, MeasuredEpoch::satellites);
    let seen: Vec<SatelliteId> =
        last.into_iter().filter(|satellite| systems.contains(&satellite.constellation())).collect();
    let kept: Vec<SatelliteId> = seen.sample(&mut chance, count).copied().collect();
    let rate_m_s = RATES_M_S[chance.random_range(0..RATES_M_S.len())];
    let fault = lasting(kept[0], Kind::Ramp { rate_m_s, limit_m: f64::INFINITY }, LEARNT);
    let bytes = sky.bytes(|index, epoch| {
        if index >= LEARNT as usize {
            epoch.satellites.retain(|raw| kept.contains(&raw.satellite));
        }
        fault.apply(epoch, index as f64);
    })?;
    let mut victim = Victim::new(&["CLOCKAID,ON"], 1.0)?;
    victim.judge(&bytes[..LEARNT as usize], sky.truth)?;
    victim.judge(&bytes[LEARNT as usize..], sky.truth)
}
