//! Ties by draws: an attacker chooses satellites, data, ranges and place, and the rule may never let
//! Galileo promise a place that is not true.

extern crate std;

use std::boxed::Box;
use std::println;
use std::vec::Vec;

use raim_core::epoch::Observation;
use raim_core::frame::{EARTH_ROTATION_RAD_S, SPEED_OF_LIGHT_M_S};
use raim_core::internals::velocity::VelocityError;
use raim_core::requirements::Requirements;

use super::*;

/// Random numbers.
struct Dice(u64);

impl Dice {
    /// Returns a number within 0 to 1.
    fn roll(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Returns a number with mean 0 and variance 1.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.roll()).sum::<f64>() - 6.0
    }

    fn within(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * self.roll()
    }

    /// Returns a unit vector within an angle of another one.
    fn direction(&mut self, about: Ecef, least_cosine: f64) -> Ecef {
        loop {
            let [x, y, z] = [(); 3].map(|()| self.normal());
            let drawn = Ecef::new(x, y, z);
            let unit = scaled(drawn, 1.0 / length_m(drawn));
            if dot(unit, about) > least_cosine {
                return unit;
            }
        }
    }
}

fn scaled(vector: Ecef, by: f64) -> Ecef {
    Ecef::new(by * vector.x_m, by * vector.y_m, by * vector.z_m)
}

fn dot(one: Ecef, other: Ecef) -> f64 {
    one.x_m * other.x_m + one.y_m * other.y_m + one.z_m * other.z_m
}

fn length_m(vector: Ecef) -> f64 {
    dot(vector, vector).sqrt()
}

/// What is forged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Forged {
    /// Ranges of all satellites of Galileo, with its true data.
    Ranges,
    /// Ranges of some satellites of Galileo, with its true data.
    SomeRanges,
    /// Data of some or all satellites of Galileo, which are therefore not proved.
    Data,
    /// All satellites of the other systems.
    Others,
}

struct Seen {
    satellite: SatelliteId,
    place: Ecef,
    sigma_m: f64,
}

struct Draw {
    truth: Ecef,
    sky: Vec<Seen>,
    clocks_m: [f64; Constellation::COUNT],
    /// Place to which the forged ranges lead.
    false_place: Ecef,
    forged: u64,
    witnesses: u64,
}

impl Draw {
    fn new(kind: Forged, dice: &mut Dice) -> Self {
        let up = dice.direction(Ecef::new(0.0, 0.0, 1.0), -1.0);
        let truth = scaled(up, 6.371e6);
        let mut sky = Vec::new();
        let has_third = dice.roll() < 0.5;
        let mut counts = [(Constellation::Galileo, 4 + (8.0 * dice.roll()) as u8), (Constellation::Gps, 0)];
        counts[1].1 = 5 + (8.0 * dice.roll()) as u8;
        // The others are a majority of two systems, or of one beside a lone satellite, or one alone.
        let third = has_third.then_some((Constellation::Beidou, 1 + (8.0 * dice.roll()) as u8));
        let noise = dice.within(0.5, 6.0);
        for (system, count) in counts.into_iter().chain(third) {
            for number in 1..=count {
                let way = scaled(dice.direction(up, 0.1), 2.3e7);
                let sigma_m = noise * dice.within(0.5, 2.0);
                let satellite = SatelliteId::new(system, number).expect("a satellite");
                sky.push(Seen { satellite, place: truth + way, sigma_m });
            }
        }
        let own = 1 + (f64::from(counts[0].1) * dice.roll()) as u8;
        let all = (2_u64 << counts[0].1) - 2;
        let some = (2_u64 << own) - 2;
        let (forged, witnesses) = match kind {
            Forged::Ranges => (all, all),
            Forged::SomeRanges => (some, all),
            Forged::Data => (some, all & !some),
            Forged::Others => (0, all),
        };
        let size_m = 10_f64.powf(dice.within(1.5, 4.5));
        let false_place = truth + scaled(dice.direction(up, -1.0), size_m);
        let clocks_m = [(); Constellation::COUNT].map(|()| dice.within(-1e4, 1e4));
        Self { truth, sky, clocks_m, false_place, forged, witnesses }
    }

    fn fill(&self, epoch: &mut Epoch, time_s: f64, kind: Option<Forged>, dice: &mut Dice) {
        epoch.restart(time_s);
        for seen in &self.sky {
            let is_own = seen.satellite.constellation() == Constellation::Galileo;
            let is_forged = match kind {
                None => false,
                Some(Forged::Others) => !is_own,
                Some(_) => is_in(self.forged, seen.satellite),
            };
            let place = if is_forged { self.false_place } else { self.truth };
            let turn_m = EARTH_ROTATION_RAD_S / SPEED_OF_LIGHT_M_S
                * (seen.place.x_m * place.y_m - seen.place.y_m * place.x_m);
            let clock_m = self.clocks_m[seen.satellite.constellation() as usize];
            let range_m = length_m(seen.place - place) + turn_m + clock_m + seen.sigma_m * dice.normal();
            let observation = Observation {
                satellite: seen.satellite,
                position: seen.place,
                range_m,
                sigma_m: seen.sigma_m,
            };
            epoch.push(observation).expect("a row");
        }
    }
}

/// What became of draws.
#[derive(Debug, Default)]
struct Fates {
    ties: u32,
    wins: u32,
    /// Wins, and promises without half of the proved satellites, with an error beyond a level.
    misleading: u32,
}

fn judge(navigator: &mut Navigator, search: Search<'_>, start: Ecef) {
    let Room { epoch, memory, .. } = &mut navigator.room;
    raim_single::judge(&navigator.monitor, epoch, start, search, None, memory);
}

/// Returns how many of the witnesses are used.
fn proved_of(report: &Report<CAPACITY>, witnesses: u64) -> usize {
    report.used.iter().filter(|its| is_in(witnesses, **its)).count()
}

/// Returns true if a promise has an error beyond a level.
fn is_misleading(report: &Report<CAPACITY>, truth: Ecef) -> bool {
    let Verdict::Protected(_) = report.verdict else { return false };
    let levels = report.protection.expect("levels");
    let error = report.solution.as_ref().expect("a position").position - truth;
    let up_m = dot(error, scaled(truth, 1.0 / length_m(truth)));
    let horizontal_m = (dot(error, error) - up_m * up_m).max(0.0).sqrt();
    horizontal_m > levels.hpl_m || up_m.abs() > levels.vpl_m
}

/// Returns the fates of draws in which something is forged behind three genuine epochs.
fn fates(kind: Forged, draws: u32, seed: u64) -> Fates {
    let (mut fates, mut dice) = (Fates::default(), Dice(seed));
    let mut navigator = Box::new(Navigator::new(Requirements::en_route()).expect("in the tables"));
    for _ in 0..draws {
        let draw = Draw::new(kind, &mut dice);
        navigator.monitor = raim_single::Monitor::new(Requirements::en_route()).expect("in the tables");
        for second in 0..3 {
            draw.fill(&mut navigator.room.epoch, f64::from(second), None, &mut dice);
            judge(&mut navigator, Search::Anew, draw.truth);
            let outcome = navigator.room.memory.outcome_mut();
            navigator.monitor.learn(outcome, Some(second.into()), Err(VelocityError::Redundancy));
        }
        let Some(before) = navigator.place() else { continue };
        draw.fill(&mut navigator.room.epoch, 3.0, Some(kind), &mut dice);
        judge(&mut navigator, Search::Anew, before);
        let count = draw.witnesses.count_ones() as usize;
        if contradiction(navigator.report(), draw.witnesses, count).is_none() {
            let report = navigator.report();
            let left_out = count - proved_of(report, draw.witnesses);
            if count >= LEAST && 2 * left_out >= count && is_misleading(report, draw.truth) {
                fates.misleading += 1;
            }
            continue;
        }
        fates.ties += 1;
        navigator.held = Held { time: GpsTime::from_ms(0), speed_m_s: Some(0.0) };
        let is_enough = count >= LEAST;
        let found = navigator.unmoved(draw.witnesses, GpsTime::from_ms(1000), 515.0);
        let Some(place) = found.filter(|_| is_enough) else { continue };
        navigator.room.epoch = some_of(&navigator.room.epoch, &|satellite| is_in(draw.witnesses, satellite));
        judge(&mut navigator, Search::Known(&[]), place);
        let report = navigator.report();
        if report.verdict != Verdict::Protected(Protected::Ok) {
            continue;
        }
        fates.wins += 1;
        assert!(report.used.len() >= 4 && report.used.iter().all(|its| is_in(draw.witnesses, *its)));
        if is_misleading(report, draw.truth) {
            fates.misleading += 1;
        }
    }
    println!("{kind:?}, {draws} draws: {fates:?}");
    fates
}

/// Galileo never wins with forged ranges or forged data, and wins where the others are forged.
fn never_by_a_forgery(draws: u32) {
    for (seed, kind) in [(1, Forged::Ranges), (2, Forged::SomeRanges), (3, Forged::Data), (4, Forged::Others)]
    {
        let fates = fates(kind, draws, seed);
        assert!(fates.ties > draws / 10, "{kind:?}: {fates:?}");
        assert_eq!(fates.misleading, 0, "{kind:?}");
        match kind {
            Forged::Ranges => assert_eq!(fates.wins, 0, "{fates:?}"),
            // What is not forged may win.
            Forged::SomeRanges | Forged::Data => {}
            Forged::Others => assert!(fates.wins > fates.ties / 2, "{fates:?}"),
        }
    }
}

#[test]
fn forged_data_and_ranges_never_win() {
    never_by_a_forgery(100);
}

mod at_length {
    use super::*;

    #[test]
    fn forged_data_and_ranges_never_win_in_ten_thousand_ties() {
        never_by_a_forgery(30_000);
    }
}
