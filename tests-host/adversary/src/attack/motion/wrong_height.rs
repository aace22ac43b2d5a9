//! A height from outside that is wrong, that drifts, and that contradicts a counterfeit sky.
//!
//! The ramps of [TSO-C129a] (a)(3)(xv) 1, tests 1 to 8: errors of one satellite and of the
//! altimeter in metres a minute. The constellation of those tests is not the one here, so that
//! their windows of time do not apply; the times to the alarm are printed.
//!
//! [TSO-C129a]: raim_core#references

use anyhow::bail;
use raim::signal::fault::Kind;
use raim_core::frame::LocalFrame;

use crate::attack::forgery::moved;
use crate::attack::prelude::*;
use crate::attack::victim::NoOpportunity;

pub(super) const WRONG: Attack = Attack {
    name: "wrong-height",
    about: "HEIGHTAID wrong by 5 to 1000 m, stepping or drifting by 0.3 to 10 m/s, said to be good to 3 m; four, five, six or all satellites",
    branch: Branch::Settings,
    before: "without the memory of the height 0 of 12,452; with a drifting satellite as well 38 of 902 with four satellites, 14 of 3,586 with five or six, 0 of 5,101 with all",
    note: "two errors at once, of the height and of a satellite, are beyond what a level bounds; at length they last five minutes",
    run: wrong,
};

pub(super) const RISING: Attack = Attack {
    name: "rising-sky",
    about: "all satellites agree on a place that rises by 0.2 to 2 m/s, without range rates; true HEIGHTAID",
    branch: Branch::Counterfeit,
    before: "without a height 258, 101 and 24 beyond",
    note: "the alert is `AMBIGUOUS`",
    run: rising,
};

pub(super) const RAMPS: Attack = Attack {
    name: "altimeter-ramps",
    about: "the ramps of TSO-C129a of one satellite (86.2, 135, 26.6, 19 m/min) and of the altimeter (−275, 200, 50, 37 m/min), six satellites: seconds to the alarm",
    branch: Branch::OneSatellite,
    before: "satellite without a height, at length: 14, 9, 38 and 56 s to the alarm or exclusion (median), 108 s at the latest",
    note: "",
    run: ramps,
};

/// Epochs with right heights before.
const BEFORE: u32 = 30;

/// Standard deviation that the host states, m.
const STATED_M: f64 = 3.0;

/// Rise of the sky in all, m. It exceeds the levels, so that a rise that is noticed too late
/// misleads.
const RISEN_M: f64 = 60.0;

/// Error of a height at a time after its begin.
#[derive(Clone, Copy)]
enum Wrong {
    Always(f64),
    Step(f64),
    Ramp(f64),
}

impl Wrong {
    fn at(self, index: u32) -> f64 {
        match (self, index.checked_sub(BEFORE)) {
            (Self::Always(error_m), _) | (Self::Step(error_m), Some(_)) => error_m,
            (Self::Ramp(rate_m_s), Some(seconds)) => rate_m_s * f64::from(seconds),
            (_, None) => 0.0,
        }
    }
}

const WRONGS: [Wrong; 10] = [
    Wrong::Always(5.0),
    Wrong::Always(-15.0),
    Wrong::Always(40.0),
    Wrong::Always(-100.0),
    Wrong::Always(1000.0),
    Wrong::Step(-30.0),
    Wrong::Step(100.0),
    Wrong::Ramp(0.3),
    Wrong::Ramp(-1.0),
    Wrong::Ramp(10.0),
];

fn height_m(sky: &Sky) -> f64 {
    LocalFrame::at(sky.truth).height_m()
}

fn state_height(victim: &mut Victim, height_m: f64) -> Result<()> {
    victim.obey(&format!("HEIGHTAID,{height_m:.3},{STATED_M}")).map(drop)
}

fn wrong(effort: Effort) -> Result<Vec<Figure>> {
    let (geometries, epochs) = effort.pick((6, 60), (60, 300));
    let mut figures = Vec::new();
    for count in [4, 5, 6, usize::MAX] {
        for has_fault in [false, true] {
            let tally: Tally = (0..geometries * WRONGS.len() as u64)
                .together(|seed| attempt(count, has_fault, epochs, seed))
                .collect::<Result<_>>()?;
            let satellites = if count == usize::MAX { "all".to_owned() } else { count.to_string() };
            let fault = if has_fault { " and a ramp of one" } else { "" };
            let what = format!("with {satellites} satellites{fault}");
            figures.push(Figure::plain(format!("promised {what}"), tally.promised()));
            // Two errors at once are beyond what a level bounds.
            let quantity = format!("beyond {what}");
            figures.push(if has_fault {
                Figure::plain(quantity, tally.misleading())
            } else {
                Figure::at_most(quantity, tally.misleading(), 0.0)
            });
        }
    }
    Ok(figures)
}

/// Keeps some GPS satellites of a sky, at random, or all of both systems.
fn kept(sky: &Sky, count: usize, chance: &mut ChaCha8Rng) -> Vec<SatelliteId> {
    let all = sky.recording.epochs.last().map_or_else(Vec::new, MeasuredEpoch::satellites);
    let of_gps: Vec<SatelliteId> =
        all.iter().copied().filter(|id| id.constellation() == Constellation::Gps).collect();
    if count > of_gps.len() { all } else { of_gps.sample(chance, count).copied().collect() }
}

fn attempt(count: usize, has_fault: bool, epochs: u32, seed: u64) -> Result<Tally> {
    let mut chance = ChaCha8Rng::seed_from_u64(seed);
    let simulation = Simulation::above_xian(3600.0 + 600.0 * seed as f64, BEFORE + epochs, seed);
    let sky = Sky::of(&simulation, Frequency::Dual)?;
    let kept = kept(&sky, count, &mut chance);
    let wrong = WRONGS[seed as usize % WRONGS.len()];
    let rate_m_s = [2.0, -0.5, 10.0][chance.random_range(0..3)];
    let fault = lasting(kept[0], Kind::Ramp { rate_m_s, limit_m: f64::INFINITY }, BEFORE);
    let bytes = sky.bytes(|index, epoch| {
        epoch.satellites.retain(|raw| kept.contains(&raw.satellite));
        if has_fault {
            fault.apply(epoch, index as f64);
        }
    })?;
    let (mut victim, mut tally) = (Victim::new(&[], 1.0)?, Tally::default());
    for (index, bytes) in (0..).zip(&bytes) {
        state_height(&mut victim, height_m(&sky) + wrong.at(index))?;
        tally.add_all(&victim.receive(bytes, sky.truth)?);
    }
    Ok(tally)
}

/// Returns the seconds from the beginning of an error to the first epoch that notices it: an alert,
/// or an exclusion.
fn noticed_s(seen: &[Vec<Seen>], notices: impl Fn(&Seen) -> bool) -> f64 {
    let after = seen.iter().skip(BEFORE as usize);
    let first = after.enumerate().find(|(_, seen)| seen.iter().any(&notices));
    first.map_or(f64::INFINITY, |(seconds, _)| seconds as f64)
}

fn rising(effort: Effort) -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    for speed_m_s in [0.2, 0.5, 2.0] {
        let epochs = (RISEN_M / speed_m_s) as u32;
        for has_height in [false, true] {
            let runs = (0..effort.pick(2, 12)).together(|seed| {
                let start_s = 3700.0 + 7200.0 * seed as f64;
                let simulation = Simulation::above_xian(start_s, BEFORE + epochs, seed);
                let seen = risen(&simulation, speed_m_s, has_height)?;
                let alert_s = noticed_s(&seen, |seen| seen.reported.state.state == 'A');
                let promised = seen.iter().flatten().filter(|seen| seen.is_misleading()).count();
                Ok((alert_s, promised))
            });
            let runs = runs.collect::<Result<Vec<_>>>()?;
            let latest_s = runs.iter().map(|run| run.0).fold(0.0, f64::max);
            let beyond: usize = runs.iter().map(|run| run.1).sum();
            if has_height {
                let quantity = format!("s to the alert at {speed_m_s} m/s");
                figures.push(Figure::at_most(quantity, latest_s, f64::from(epochs)));
                figures.push(Figure::at_most("beyond", beyond as f64, 0.0));
            } else {
                let quantity = format!("beyond at {speed_m_s} m/s without a height");
                figures.push(Figure::plain(quantity, beyond as f64));
            }
        }
    }
    Ok(figures)
}

/// Returns the reports on a sky that rises after a while, with the true height or without.
fn risen(simulation: &Simulation, speed_m_s: f64, has_height: bool) -> Result<Vec<Vec<Seen>>> {
    let sky = Sky::of(simulation, Frequency::Dual)?;
    let bytes = sky.bytes(|index, epoch| {
        let index = index as u32;
        let risen_m = speed_m_s * f64::from(index.saturating_sub(BEFORE));
        let there = moved(simulation, 0.0, risen_m);
        move_ranges(epoch, &simulation.sights_at(index), &there.sights_at(index));
    })?;
    let mut victim = Victim::new(&[], 1.0)?;
    let mut reports = Vec::new();
    for bytes in &bytes {
        if has_height {
            state_height(&mut victim, height_m(&sky))?;
        }
        reports.push(victim.receive(bytes, sky.truth)?);
    }
    Ok(reports)
}

/// Ramps of the standard, m/min: of a satellite, and of the altimeter in the same geometry.
const STANDARD_M_MIN: [(f64, f64); 4] = [(86.2, -275.0), (135.0, 200.0), (26.6, 50.0), (19.0, 37.0)];

fn ramps(effort: Effort) -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    let mut beyond = 0;
    for (satellite_m_min, altimeter_m_min) in STANDARD_M_MIN {
        for (name, of_satellite, of_altimeter) in [
            ("of a satellite without a height", Some(satellite_m_min), None),
            ("of a satellite with a height", Some(satellite_m_min), Some(0.0)),
            ("of the altimeter", None, Some(altimeter_m_min)),
        ] {
            let runs = (0..effort.pick(3, 20)).together(|seed| ramp(seed, of_satellite, of_altimeter));
            let runs = runs.collect::<Result<Vec<_>>>()?;
            // Where nothing is promised when the ramp begins, there is nothing to take back.
            let runs: Vec<_> = runs.into_iter().flatten().collect();
            let mut times: Vec<f64> = runs.iter().map(|run| run.0).collect();
            times.sort_by(f64::total_cmp);
            let Some(latest_s) = times.last() else {
                bail!(NoOpportunity("no sky of the ramps is promised at first"))
            };
            beyond += runs.iter().map(|run| run.1).sum::<usize>();
            let rate = of_satellite.unwrap_or(altimeter_m_min);
            let what = format!("s at {rate} m/min {name}");
            figures.push(Figure::plain(format!("median {what}"), times[times.len() / 2]));
            figures.push(Figure::at_most(format!("latest {what}"), *latest_s, 900.0));
        }
    }
    figures.push(Figure::at_most("beyond a level", beyond as f64, 0.0));
    Ok(figures)
}

/// Returns the GPS satellites that are above the mask from the first epoch to the last.
fn high(simulation: &Simulation) -> Vec<SatelliteId> {
    /// A degree above the mask at start.
    const LEAST_DEG: f64 = 11.0;
    let above = |index| {
        let sights = simulation.sights_at(index);
        let is_high = |sight: &&Sight| sight.elevation_rad().to_degrees() > LEAST_DEG;
        sights.iter().filter(is_high).map(|sight| sight.satellite).collect::<Vec<_>>()
    };
    let last = above(simulation.epochs - 1);
    let is_gps = |id: &SatelliteId| id.constellation() == Constellation::Gps && last.contains(id);
    above(0).into_iter().filter(is_gps).collect()
}

/// Returns the time to the alarm or exclusion, s, and the misleading epochs of one sky; `None` if
/// nothing is promised when the ramp begins.
fn ramp(seed: u64, of_satellite: Option<f64>, of_altimeter: Option<f64>) -> Result<Option<(f64, usize)>> {
    let mut chance = ChaCha8Rng::seed_from_u64(seed);
    let simulation = Simulation::above_xian(3600.0 + 3600.0 * seed as f64, BEFORE + 900, seed);
    let sky = Sky::of(&simulation, Frequency::Dual)?;
    let high = high(&simulation);
    let kept: Vec<SatelliteId> = high.sample(&mut chance, 6).copied().collect();
    let Some(faulty) = kept.first() else { return Ok(None) };
    let rate_m_s = of_satellite.unwrap_or(0.0) / 60.0;
    let fault = lasting(*faulty, Kind::Ramp { rate_m_s, limit_m: f64::INFINITY }, BEFORE);
    let bytes = sky.bytes(|index, epoch| {
        epoch.satellites.retain(|raw| kept.contains(&raw.satellite));
        fault.apply(epoch, index as f64);
    })?;
    let (mut victim, mut reports) = (Victim::new(&[], 1.0)?, Vec::new());
    for (index, bytes) in (0_u32..).zip(&bytes) {
        if let Some(rate_m_min) = of_altimeter {
            let wrong = Wrong::Ramp(rate_m_min / 60.0);
            state_height(&mut victim, height_m(&sky) + wrong.at(index))?;
        }
        reports.push(victim.receive(bytes, sky.truth)?);
    }
    let is_promised = |seen: &Seen| seen.reported.state.state == 'P';
    if !reports.get(BEFORE as usize - 1).is_some_and(|seen| seen.iter().any(is_promised)) {
        return Ok(None);
    }
    let noticed_s =
        noticed_s(&reports, |seen| seen.reported.state.state == 'A' || !seen.reported.excluded.is_empty());
    Ok(Some((noticed_s, reports.iter().flatten().filter(|seen| seen.is_misleading()).count())))
}
