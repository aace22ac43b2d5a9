//! Signals that arrive by a repeater: all ranges are longer by its delay, and the receiver measures
//! no Doppler frequencies.
//!
//! All ranges agree, and the position stays. Only the receiver clock shows the repeater. It must
//! not show one where there is none: on hours of simulated oscillators, with a clock that is
//! steered, and on recordings whose Doppler frequencies are removed.

use rig::stations::Station;

use crate::attack::nature::recordings::{STATIONS, car, load, skipped};
use crate::attack::prelude::*;

pub(super) const ATTACK: Attack = Attack {
    name: "repeater",
    about: "all ranges longer by 200 m to 50 km at once, without range rates; and clean clocks beside",
    branch: Branch::Counterfeit,
    before: "without the clock's past none of 16 seen",
    note: "`CLOCK` in the epoch of the delay",
    run,
};

/// Delays of the repeater, m.
const DELAYS_M: [f64; 4] = [200.0, 500.0, 3000.0, 50_000.0];

/// Epochs before the repeater.
const BEFORE: u32 = 60;

/// Largest change of a steered clock from epoch to epoch, m.
const STEERED_M: f64 = 15.0;

/// Largest number of false alarms in an hour.
const FALSE_AN_HOUR: f64 = 0.1;

fn run(effort: Effort) -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    for delay_m in DELAYS_M {
        let runs = (0..effort.pick(4, 40)).together(|seed| repeated(seed, delay_m));
        let runs = runs.collect::<Result<Vec<[usize; 2]>>>()?;
        let seen: usize = runs.iter().map(|[seen, _]| seen).sum();
        let early: usize = runs.iter().map(|[_, early]| early).sum();
        let share = seen as f64 / runs.len().max(1) as f64;
        figures.push(Figure::at_least(format!("delay of {delay_m} m seen at once, share"), share, 1.0));
        figures.push(Figure::at_most("CLOCK before", early as f64, 0.0));
    }
    let quartz = Oscillator::temperature_compensated();
    let ovens = Oscillator::oven_controlled();
    for (name, oscillator, step_s, steered_m) in [
        ("quartz at 1 Hz", quartz, 1.0, 0.0),
        ("quartz at 30 s", quartz, 30.0, 0.0),
        ("quartz at 60 s", quartz, 60.0, 0.0),
        ("oven at 1 Hz", ovens, 1.0, 0.0),
        ("steered quartz at 1 Hz", quartz, 1.0, STEERED_M),
    ] {
        let epochs = effort.pick(1200, 14_400);
        let seeds = 0..effort.pick(2, 8);
        let runs = seeds.together(|seed| clean(seed, epochs, oscillator, step_s, steered_m));
        let all: Tally = runs.collect::<Result<_>>()?;
        figures.push(false_alarms(name, &all, step_s));
    }
    figures.extend(recorded(effort)?);
    Ok(figures)
}

/// Returns whether the first repeated epoch is an alert of the clock, and the number of those
/// before.
fn repeated(seed: u64, delay_m: f64) -> Result<[usize; 2]> {
    let simulation = Simulation::above_xian(3700.0 + 7200.0 * (seed % 12) as f64, BEFORE + 1, seed);
    let sky = Sky::of(&simulation, Frequency::Dual)?;
    let bytes = sky.bytes(|index, epoch| {
        if index as u32 >= BEFORE {
            lengthen_all(epoch, delay_m);
        }
    })?;
    let mut victim = Victim::new(&[], 1.0)?;
    let before = victim.judge(&bytes[..BEFORE as usize], sky.truth)?;
    let seen = victim.judge(&bytes[BEFORE as usize..], sky.truth)?;
    Ok([seen.of_reason("CLOCK").min(1), before.of_reason("CLOCK")])
}

fn clean(seed: u64, epochs: u32, oscillator: Oscillator, step_s: f64, steered_m: f64) -> Result<Tally> {
    let simulation = Simulation {
        oscillator,
        step_s,
        ..Simulation::above_xian(3700.0 + 7200.0 * (seed % 12) as f64, epochs, seed)
    };
    let sky = Sky::of(&simulation, Frequency::Dual)?;
    let bytes = sky.bytes(|index, epoch| lengthen_all(epoch, steered_m * (2.4 * index as f64).sin()))?;
    Victim::new(&[], step_s)?.judge(&bytes, sky.truth)
}

/// Returns the number of alerts of the clock, bounded by their rate.
fn false_alarms(name: &str, tally: &Tally, step_s: f64) -> Figure {
    let hours = tally.epochs() * step_s / 3600.0;
    let count = tally.of_reason("CLOCK") as f64;
    Figure::at_most(format!("CLOCK in {hours:.1} h of {name}"), count, (FALSE_AN_HOUR * hours).floor())
}

/// Returns the false alarms of the reference folder's recordings without Doppler frequencies.
fn recorded(effort: Effort) -> Result<Vec<Figure>> {
    let Some(folder) = shared::path("data/urban") else {
        return Ok(skipped());
    };
    let most = effort.pick(900, usize::MAX);
    let of_station = |(station, systems): (&Station, &str)| -> Result<Vec<Figure>> {
        let recording = load(station)?;
        let figure = |frequency: Frequency| {
            let tally = play(&recording, systems, frequency, most)?;
            Ok(false_alarms(&format!("{} {frequency:?}", station.folder), &tally, step_s(&recording)))
        };
        [Frequency::Dual, Frequency::Single].into_iter().map(figure).collect()
    };
    let stations: Vec<Vec<Figure>> = STATIONS.into_iter().together(of_station).collect::<Result<_>>()?;
    let mut figures = stations.concat();
    let tally = play(&car(&folder)?, "GC", Frequency::Single, usize::MAX)?;
    figures.push(false_alarms("a car between buildings", &tally, 1.0));
    Ok(figures)
}

/// Sends a recording without its Doppler frequencies.
fn play(recording: &Recording, systems: &str, frequency: Frequency, most: usize) -> Result<Tally> {
    let mut encoder = Encoder::new(&recording.ephemerides, Selection::new(systems, frequency)?);
    let (mut victim, mut tally) = (Victim::new(&[], step_s(recording))?, Tally::default());
    for epoch in recording.epochs.iter().take(most) {
        let mut epoch = epoch.clone();
        let signals = epoch.satellites.iter_mut().flat_map(|satellite| &mut satellite.signals);
        signals.for_each(|signal| signal.doppler_hz = None);
        tally.add_all(&victim.receive(&encoder.epoch(&epoch)?, Ecef::CENTRE)?);
    }
    Ok(tally)
}
