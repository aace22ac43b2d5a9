//! Places that walk off for a quarter of an hour and more, leap, climb stairs or swing.
//!
//! All ranges of an epoch agree. The range rates are those of the true receiver, at rest; or they
//! are missing; or each contradicts the others by a constant error. After the first alert, nothing
//! may be promised while the place is elsewhere.

use rig::stations::{STATIC_BASE, Station, TLSE};

use crate::attack::nature::recordings::load;
use crate::attack::nature::streets::{Directions, directions};
use crate::attack::prelude::*;

pub(super) const LONG: Attack = Attack {
    name: "long-walk-off",
    about: "a place that walks off at 1 to 100 m/s for 20 minutes, from second 30 and 200, with true, missing and contradicting rates; real recordings too",
    branch: Branch::Counterfeit,
    before: "with true rates promised again after 2 to 8 minutes, up to 21 km off; with contradicting ones no alert",
    note: "with contradicting rates not promised after 5 s, with noisy ones or none not seen: [the table](#walks-of-twenty-minutes)",
    run: long,
};

pub(super) const LEAPS: Attack = Attack {
    name: "leaps-and-waves",
    about: "leaps of 10 to 500 m, stairs of 10 and 30 m a minute, growing waves, with true rates",
    branch: Branch::Counterfeit,
    before: "stairs of 30 m a minute reached 603 m under a simulated sky; waves of 300 s 177 m",
    note: "on recordings a leap of 10 m is an alert at once: [the table](#leaps-stairs-and-waves)",
    run: leaps,
};

/// Speeds, m/s, and beginnings, epochs.
const SPEEDS_M_S: [f64; 8] = [1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 50.0, 100.0];
const BEGINNINGS: [u32; 2] = [30, 200];

/// Leaps, m.
const LEAPS_M: [f64; 8] = [10.0, 15.0, 20.0, 30.0, 60.0, 100.0, 200.0, 500.0];

/// Epochs of a simulated sky, one a second.
const EPOCHS: u32 = 1400;

/// Least distance, m, at which a place is elsewhere: below it a promise is right.
const ELSEWHERE_M: f64 = 15.0;

/// Wavelength of GPS L1, m.
const WAVELENGTH_M: f64 = 0.19;

/// What the range rates say.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Rates {
    True,
    Missing,
    /// Each satellite has a constant error of up to this many m/s.
    Apart(f64),
}

impl Rates {
    fn name(self) -> String {
        match self {
            Self::True => "true rates".into(),
            Self::Missing => "no rates".into(),
            Self::Apart(by_m_s) => format!("rates {by_m_s} m/s apart"),
        }
    }

    fn apply(self, epoch: &mut MeasuredEpoch) {
        for raw in &mut epoch.satellites {
            let name = u64::from(raw.satellite.number()) << 8 | raw.satellite.constellation() as u64;
            let mut chance = ChaCha8Rng::seed_from_u64(name);
            let error_hz = match self {
                Self::Apart(by_m_s) => chance.random_range(-by_m_s..by_m_s) / WAVELENGTH_M,
                _ => 0.0,
            };
            for signal in &mut raw.signals {
                let doppler_hz = signal.doppler_hz.filter(|_| self != Self::Missing);
                signal.doppler_hz = doppler_hz.map(|doppler_hz| doppler_hz + error_hz);
            }
        }
    }
}

/// A receiver at rest, and the directions of its satellites.
struct Scene {
    is_recorded: bool,
    recording: Recording,
    selection: Selection,
    directions: Directions,
    truth: Ecef,
}

impl Scene {
    fn simulated(seed: u64) -> Result<Self> {
        let simulation = Simulation {
            has_range_rates: true,
            ..Simulation::above_xian(3700.0 + 7200.0 * seed as f64, EPOCHS, seed)
        };
        let truth = simulation.site.position;
        Self::of(false, simulation.record(), "GC", truth)
    }

    fn recorded(station: &Station) -> Result<Self> {
        Self::of(true, load(station)?, "GCE", station.truth)
    }

    fn of(is_recorded: bool, recording: Recording, systems: &str, truth: Ecef) -> Result<Self> {
        let selection = Selection::new(systems, Frequency::Dual)?;
        let directions = directions(&recording, &selection, truth, usize::MAX)?;
        Ok(Self { is_recorded, recording, selection, directions, truth })
    }

    /// Sends the recording; from epoch `from` on, its place is `away_m(seconds)` east of the truth.
    fn attack(&self, from: u32, rates: Rates, away_m: &(dyn Fn(f64) -> f64 + Sync)) -> Result<Run> {
        let (mut victim, mut run) = (Victim::new(&[], 1.0)?, Run::default());
        let mut encoder = Encoder::new(&self.recording.ephemerides, self.selection.clone());
        for (index, (epoch, seen)) in (0_u32..).zip(self.recording.epochs.iter().zip(&self.directions)) {
            let mut epoch = epoch.clone();
            let since_s = index.checked_sub(from).map(f64::from);
            let place_m = since_s.map_or(0.0, away_m);
            for &(satellite, towards) in seen {
                let raw = epoch.satellites.iter().find(|raw| raw.satellite == satellite);
                let Some(range_m) =
                    raw.and_then(|raw| raw.signals.first()).map(|signal| signal.pseudorange_m)
                else {
                    continue;
                };
                let [east_m, north_m, up_m] =
                    [towards.east * range_m - place_m, towards.north * range_m, towards.up * range_m];
                let longer_m = east_m.hypot(north_m).hypot(up_m) - range_m;
                epoch.lengthen(satellite, longer_m);
            }
            // Missing rates are missing from the start.
            if since_s.is_some() || rates == Rates::Missing {
                rates.apply(&mut epoch);
            }
            for seen in victim.receive(&encoder.epoch(&epoch)?, self.truth)? {
                run.add(&seen, since_s, place_m);
            }
        }
        Ok(run)
    }
}

/// What came of one attack.
#[derive(Clone, Copy, Debug, Default)]
struct Run {
    /// Alerts of place or clock before the attack.
    early: usize,
    /// Time from the first epoch elsewhere to the first alert, s.
    alert_s: Option<f64>,
    /// Epochs promised beyond a level before the first alert.
    beyond_before: usize,
    /// Epochs promised elsewhere after the first alert, and those of them beyond a level.
    promised_after: usize,
    beyond_after: usize,
    /// Largest error of a promised position, m.
    farthest_m: f64,
}

impl Run {
    /// Returns the latest alert, the largest error and the sums of several runs.
    fn worst(runs: &[Self]) -> Self {
        let sum = |count: fn(&Self) -> usize| runs.iter().map(count).sum::<usize>();
        let latest_s = runs.iter().map(Self::alert).fold(0.0, f64::max);
        Self {
            early: sum(|run| run.early),
            alert_s: Some(latest_s).filter(|latest_s| latest_s.is_finite()),
            beyond_before: sum(|run| run.beyond_before),
            promised_after: sum(|run| run.promised_after),
            beyond_after: sum(|run| run.beyond_after),
            farthest_m: runs.iter().map(|run| run.farthest_m).fold(0.0, f64::max),
        }
    }

    /// Returns the time to the first alert, s; infinite without one.
    fn alert(&self) -> f64 {
        self.alert_s.unwrap_or(f64::INFINITY)
    }

    fn add(&mut self, seen: &crate::attack::seen::Seen, since_s: Option<f64>, place_m: f64) {
        // Other signs, such as ranges that bend once, do not tell that the place is another.
        let is_alert = ["TRACK", "CLOCK", "JUMP"].contains(&seen.reported.state.reason.as_str());
        let Some(since_s) = since_s else {
            self.early += usize::from(is_alert);
            return;
        };
        if is_alert {
            self.alert_s.get_or_insert(since_s);
        }
        if !seen.is_promised {
            return;
        }
        self.farthest_m = self.farthest_m.max(seen.horizontal_error_m);
        let is_beyond = usize::from(seen.is_misleading());
        if self.alert_s.is_some() {
            self.promised_after += usize::from(place_m.abs() > ELSEWHERE_M);
            self.beyond_after += is_beyond;
        } else {
            self.beyond_before += is_beyond;
        }
    }
}

/// Returns the simulated skies and, with the reference folder, two recordings.
fn scenes(skies: u64) -> Result<Vec<Scene>> {
    let mut scenes: Vec<Scene> = (0..skies).map(Scene::simulated).collect::<Result<_>>()?;
    if shared::path("data").is_some() {
        for station in [&TLSE, &STATIC_BASE] {
            scenes.push(Scene::recorded(station)?);
        }
    }
    Ok(scenes)
}

fn long(effort: Effort) -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    let speeds: &[f64] = effort.pick(&[2.0, 20.0], &SPEEDS_M_S);
    let beginnings: &[u32] = effort.pick(&[200], &BEGINNINGS);
    let scenes = scenes(effort.pick(1, 4))?;
    for rates in [Rates::True, Rates::Apart(0.2), Rates::Apart(1.5), Rates::Apart(38.0), Rates::Missing] {
        for &from in beginnings {
            let name = format!("{}, from {from} s", rates.name());
            let mut all = Vec::new();
            for &speed_m_s in speeds {
                let runs: Vec<Run> = scenes
                    .iter()
                    .together(|scene| scene.attack(from, rates, &|since_s| speed_m_s * since_s))
                    .collect::<Result<_>>()?;
                let run = Run::worst(&runs);
                figures.push(Figure::plain(format!("{name}, {speed_m_s} m/s: alert after s"), run.alert()));
                figures.push(Figure::plain("promised up to m", run.farthest_m));
                all.push(run);
            }
            figures.extend(bounds(&name, &Run::worst(&all)));
        }
    }
    Ok(figures)
}

/// Returns the bounds that hold after the first alert.
fn bounds(name: &str, run: &Run) -> [Figure; 3] {
    [
        Figure::at_most(format!("{name}: beyond after the first alert"), run.beyond_after as f64, 0.0),
        Figure::at_most("promised elsewhere after it", run.promised_after as f64, 0.0),
        Figure::at_most("alerts before the attack", run.early as f64, 0.0),
    ]
}

fn leaps(effort: Effort) -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    let (recorded, simulated): (Vec<Scene>, Vec<Scene>) =
        scenes(effort.pick(1, 4))?.into_iter().partition(|scene| scene.is_recorded);
    let sizes: &[f64] = effort.pick(&[15.0, 30.0, 100.0], &LEAPS_M);
    for (name, scenes) in [("simulated", simulated), ("recorded", recorded)] {
        let attack = |from: u32, away_m: &(dyn Fn(f64) -> f64 + Sync)| -> Result<Run> {
            let runs = scenes.iter().together(|scene| scene.attack(from, Rates::True, away_m));
            Ok(Run::worst(&runs.collect::<Result<Vec<_>>>()?))
        };
        for &size_m in sizes {
            let run = attack(200, &|_| size_m)?;
            figures.extend(row(&format!("{name}, a leap of {size_m} m"), &run, 0.0));
        }
        for step_m in [10.0, 30.0] {
            let run = attack(200, &|since_s| step_m * (1.0 + (since_s / 60.0).floor()))?;
            figures.extend(row(&format!("{name}, stairs of {step_m} m a minute"), &run, 0.0));
        }
        for period_s in [20.0, 60.0, 300.0] {
            // The amplitude grows by 10 m a minute.
            let wave = |since_s: f64| since_s / 6.0 * (std::f64::consts::TAU * since_s / period_s).sin();
            let run = attack(30, &wave)?;
            // A wave returns to the true place, where a promise is right, and departs again.
            figures.extend(row(&format!("{name}, growing waves of {period_s} s"), &run, f64::INFINITY));
        }
    }
    Ok(figures)
}

fn row(name: &str, run: &Run, most_after: f64) -> [Figure; 4] {
    [
        Figure::plain(format!("{name}: alert after s"), run.alert()),
        Figure::plain("promised up to m", run.farthest_m),
        Figure::plain("beyond before the alert", run.beyond_before as f64),
        Figure::at_most("beyond after it", run.beyond_after as f64, most_after),
    ]
}
