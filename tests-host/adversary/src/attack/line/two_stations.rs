//! Ranges of a reference station on the receiver's own line, as its corrections arrive.
//!
//! The station is 11 km away. Its frames come before the receiver's in each second except the
//! first, and its ephemerides are the same. For a while only the station sends. A receiver that
//! sends everything twice is tried as well; it must not be taken for a second station.

use raim::signal::checksum::rtcm_frame;
use raim::signal::measurement::MeasuredSignal;

use crate::attack::prelude::*;
use crate::soak::noise::frames;

pub(super) const ATTACK: Attack = Attack {
    name: "two-stations",
    about: "the ranges of a reference station 11 km away on the same line, before the receiver's",
    branch: Branch::Line,
    before: "95 of 96 beyond, 11 km",
    note: "",
    run,
};

pub(super) const TUNNEL: Attack = Attack {
    name: "tunnel",
    about: "a receiver is silent for 80 s, has no satellites, or sends one epoch in five; the corrections of a base 1 to 11 km away continue",
    branch: Branch::Line,
    before: "273 of 627 beyond, 11 km",
    note: "",
    run: tunnel,
};

pub(super) const NAMESAKE: Attack = Attack {
    name: "namesake",
    about: "after half a minute the ranges of a base 55 m to 11 km away, of the receiver's own station number, before or behind its own",
    branch: Branch::Line,
    before: "156 of 336 beyond, 11 km",
    note: "`AMBIGUOUS`",
    run: namesake,
};

pub(super) const TWICE: Attack = Attack {
    name: "twice",
    about: "every epoch comes twice, with two codes of one band that a reflection sets 12 m apart",
    branch: Branch::Line,
    before: "nothing promised, `AMBIGUOUS`",
    note: "",
    run: twice,
};

/// Distance north of the receiver, degrees.
const AWAY_DEG: f64 = 0.1;

/// Number of the station. The receiver's is 0.
const STATION: u16 = 1234;

/// Seconds in which the receiver is silent.
const SILENT: std::ops::Range<usize> = 60..65;

fn run(_: Effort) -> Result<Vec<Figure>> {
    let receiver = Simulation::above_xian(3600.0, 120, 1);
    let station = Sky::of(&elsewhere(&receiver, AWAY_DEG), Frequency::Dual)?;
    let receiver = Sky::of(&receiver, Frequency::Dual)?;
    let (mut victim, mut tally) = (Victim::new(&[], 1.0)?, Tally::default());
    for (index, (own, of_station)) in
        receiver.unchanged()?.into_iter().zip(&station.recording.epochs).enumerate()
    {
        let own = if SILENT.contains(&index) { Vec::new() } else { own };
        let of_station = if index == 0 { Vec::new() } else { renumbered(&station.ranges(of_station)?) };
        tally.add_all(&victim.receive(&[of_station, own].concat(), receiver.truth)?);
    }
    let mut figures = tally.figures(0.0);
    // The station that replaces the silent receiver is elsewhere, so the module must recover
    // afterwards.
    figures.push(Figure::at_least("promised", tally.promised(), 105.0));
    Ok(figures)
}

/// Kind of absence of a receiver.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Missing {
    Silent,
    Empty,
    /// The receiver sends one of this many epochs; the base sends all.
    Slow(usize),
}

fn tunnel(_: Effort) -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    for missing in [Missing::Silent, Missing::Empty, Missing::Slow(5)] {
        let runs = [0.01, AWAY_DEG].into_iter().map(|away_deg| beside_a_base(away_deg, missing));
        let tally: Tally = runs.collect::<Result<_>>()?;
        let least = 2.0 * least_of(missing);
        figures.push(Figure::at_most(format!("misleading, {missing:?}"), tally.misleading(), 0.0));
        figures.push(Figure::at_least(format!("promised, {missing:?}"), tally.promised(), least));
    }
    Ok(figures)
}

/// Epochs of the base.
const EPOCHS: u32 = 180;

/// Returns the smallest number of the receiver's own epochs that must be promised, allowing for
/// recovery.
fn least_of(missing: Missing) -> f64 {
    match missing {
        Missing::Silent | Missing::Empty => (EPOCHS as usize - TUNNEL_EPOCHS.len()) as f64 - 5.0,
        Missing::Slow(interval) => (EPOCHS as usize / interval) as f64,
    }
}

/// Epochs in the tunnel.
const TUNNEL_EPOCHS: std::ops::Range<usize> = 60..140;

fn beside_a_base(away_deg: f64, missing: Missing) -> Result<Tally> {
    let receiver = Simulation::above_xian(3600.0, EPOCHS, 1);
    let station = Sky::of(&elsewhere(&receiver, away_deg), Frequency::Dual)?;
    let receiver = Sky::of(&receiver, Frequency::Dual)?;
    let own = receiver.bytes(|index, epoch| {
        if missing == Missing::Empty && TUNNEL_EPOCHS.contains(&index) {
            epoch.satellites.clear();
        }
    })?;
    let (mut victim, mut tally) = (Victim::new(&[], 1.0)?, Tally::default());
    for (index, (own, of_station)) in own.into_iter().zip(&station.recording.epochs).enumerate() {
        let is_there = match missing {
            Missing::Silent => !TUNNEL_EPOCHS.contains(&index),
            Missing::Empty => true,
            Missing::Slow(interval) => index % interval == 0,
        };
        let own = if is_there { own } else { Vec::new() };
        let of_station = if index == 0 { Vec::new() } else { renumbered(&station.ranges(of_station)?) };
        tally.add_all(&victim.receive(&[own, of_station].concat(), receiver.truth)?);
    }
    Ok(tally)
}

fn namesake(_: Effort) -> Result<Vec<Figure>> {
    /// All epochs, and those at the start in which the receiver is alone.
    const ALL: u32 = 90;
    const ALONE: usize = 30;
    let receiver = Simulation::above_xian(3600.0, ALL, 3);
    let (mut beside, mut alone) = (Tally::default(), Tally::default());
    for away_deg in [0.0005, 0.005, AWAY_DEG] {
        let station = Sky::of(&elsewhere(&receiver, away_deg), Frequency::Dual)?;
        let receiver = Sky::of(&receiver, Frequency::Dual)?;
        for is_first in [true, false] {
            let mut victim = Victim::new(&[], 1.0)?;
            let own = receiver.unchanged()?;
            for (index, (own, of_station)) in own.into_iter().zip(&station.recording.epochs).enumerate() {
                if index < ALONE {
                    alone.add_all(&victim.receive(&own, receiver.truth)?);
                    continue;
                }
                let of_station = station.ranges(of_station)?;
                let both = if is_first { [of_station, own] } else { [own, of_station] };
                beside.add_all(&victim.receive(&both.concat(), receiver.truth)?);
            }
        }
    }
    let mut figures = beside.figures(0.0);
    figures.push(Figure::at_least("promised before", alone.promised(), 6.0 * ALONE as f64));
    Ok(figures)
}

fn twice(_: Effort) -> Result<Vec<Figure>> {
    let mut sky = Sky::quiet(60, 3)?;
    for raw in sky.recording.epochs.iter_mut().flat_map(|epoch| &mut epoch.satellites) {
        // P code beside C/A, which a wall reflects.
        let of_gps = raw.signals.iter_mut().find(|signal| signal.band == 1);
        if let Some(signal) = of_gps {
            let coded = MeasuredSignal { attribute: 'W', ..*signal };
            signal.pseudorange_m += 12.0;
            raw.signals.push(coded);
        }
    }
    let (mut victim, mut tally) = (Victim::new(&[], 1.0)?, Tally::default());
    for (bytes, epoch) in sky.unchanged()?.into_iter().zip(&sky.recording.epochs) {
        tally.add_all(&victim.receive(&[bytes, sky.ranges(epoch)?].concat(), sky.truth)?);
    }
    let mut figures = tally.figures(0.0);
    figures.push(Figure::at_least("promised", tally.promised(), 60.0));
    Ok(figures)
}

/// Returns the same messages of ranges with the number of the other station.
fn renumbered(bytes: &[u8]) -> Vec<u8> {
    let renumbered = |frame: &[u8]| {
        let mut payload = frame[3..frame.len() - 3].to_vec();
        payload[1] = payload[1] & 0xF0 | (STATION >> 8) as u8;
        payload[2] = STATION as u8;
        rtcm_frame(&payload)
    };
    frames(bytes).into_iter().flat_map(renumbered).collect()
}
