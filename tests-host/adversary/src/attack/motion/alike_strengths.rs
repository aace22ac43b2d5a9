//! Counterfeit signals of one antenna: all of one strength. The sign alone withdraws nothing;
//! beside a receiver that suspects spoofing it does.

use raim::signal::encode::ubx;

use crate::attack::nature::recordings::{STATIONS, car, load, skipped};
use crate::attack::prelude::*;

pub(super) const ATTACK: Attack = Attack {
    name: "alike-strengths",
    about: "signals that become alike in strength within 0.5 dB, beside a suspicion of the receiver; 48 h of recordings and half an hour of streets without",
    branch: Branch::Counterfeit,
    before: "not tried",
    note: "",
    run,
};

/// Genuine epochs before.
const BEFORE: usize = 20;

/// Counterfeit epochs.
const DURING: usize = 40;

/// Largest number of false signs in an hour.
const FALSE_SIGNS: f64 = 0.1;

/// Spread of the strengths of the counterfeit about its mean, dB.
const SPREAD_DB: f64 = 0.5;

fn run(effort: Effort) -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    for is_suspected in [true, false] {
        let sky = Sky::quiet((BEFORE + DURING) as u32, 3)?;
        let bytes = sky.bytes(|index, epoch| {
            if index >= BEFORE {
                for (number, raw) in epoch.satellites.iter_mut().enumerate() {
                    for signal in &mut raw.signals {
                        let apart_db = if number % 2 == 0 { SPREAD_DB } else { -SPREAD_DB };
                        signal.cn0_dbhz = Some(46.0 + apart_db);
                    }
                }
            }
        })?;
        let state = if is_suspected { 0b0010_1011 } else { 0b0001_1011 };
        let reported = ubx::frame([0x27, 0x09], &[2, state, 0, 0]);
        let steps: Vec<Vec<u8>> = bytes.iter().map(|bytes| [&reported[..], bytes].concat()).collect();
        let mut victim = Victim::new(&[], 1.0)?;
        let before = victim.judge(&steps[..BEFORE], sky.truth)?;
        let (mut during, mut alert_s) = (Tally::default(), f64::INFINITY);
        for (seconds, bytes) in steps[BEFORE..].iter().enumerate() {
            let seen = victim.receive(bytes, sky.truth)?;
            if seen.iter().any(|seen| seen.reported.state.reason == "SPOOFED") {
                alert_s = alert_s.min(seconds as f64);
            }
            during.add_all(&seen);
        }
        figures.push(Figure::at_least("promised before", before.promised(), BEFORE as f64));
        if is_suspected {
            figures.push(Figure::at_most("s to `SPOOFED` beside a suspicion", alert_s, 11.0));
        } else {
            let promised = during.promised();
            figures.push(Figure::at_least("promised without a suspicion", promised, DURING as f64));
        }
    }
    if shared::path("data").is_none() {
        figures.extend(skipped());
        return Ok(figures);
    }
    let most = effort.pick(2880, usize::MAX);
    let signs = STATIONS
        .iter()
        .together(|(station, systems)| false_signs(&load(station)?, systems, most))
        .collect::<Result<Vec<_>>>()?;
    let (count, hours) = signs.iter().fold((0.0, 0.0), |sum, one| (sum.0 + one.0, sum.1 + one.1));
    figures.push(Figure::plain("hours of recordings", hours));
    figures.push(Figure::at_most("false signs an hour", count / hours, FALSE_SIGNS));
    if let Some(folder) = shared::path("data/urban") {
        let (count, hours) = false_signs(&car(&folder)?, "GC", most)?;
        figures.push(Figure::at_most(format!("false signs in {hours:.2} h of streets"), count, 0.0));
    }
    Ok(figures)
}

/// Returns the epochs of a recording with the sign, and its hours.
fn false_signs(recording: &Recording, systems: &str, most: usize) -> Result<(f64, f64)> {
    let step_s = step_s(recording);
    let mut victim = Victim::new(&[], step_s)?;
    let mut encoder = Encoder::new(&recording.ephemerides, Selection::new(systems, Frequency::Dual)?);
    for epoch in recording.epochs.iter().take(most) {
        victim.receive(&encoder.epoch(epoch)?, Ecef::CENTRE)?;
    }
    let hours = step_s * recording.epochs.len().min(most) as f64 / 3600.0;
    Ok((f64::from(victim.counter("strengths_alike")?), hours))
}
