//! Ranges of a reference station on the receiver's own line, as corrections for it come.
//!
//! The station is 11 km away; its frames come before the receiver's in each second but the first, and its ephemerides are the same. For a
//! while the receiver is silent, and only the station goes on.

use anyhow::Result;

use super::forgery::{Sky, elsewhere};
use super::tally::Tally;
use super::victim::Victim;
use super::{Attack, Effort, Figure};
use crate::checksum::rtcm_frame;
use crate::encode::Frequency;
use crate::sky::raw::Simulation;

/// The attack.
pub(super) const ATTACK: Attack = Attack {
    name: "two-stations",
    about: "the ranges of a reference station 11 km away come on the same line",
    run,
};

/// North of the receiver, degrees.
const AWAY_DEG: f64 = 0.1;

/// Number of the station; that of the receiver is 0.
const STATION: u16 = 1234;

/// Seconds in which the receiver is silent.
const SILENT: std::ops::Range<usize> = 60..65;

fn run(_: Effort) -> Result<Vec<Figure>> {
    let receiver = Simulation::above_xian(3600.0, 120, 1);
    let station = Sky::of(&elsewhere(&receiver, AWAY_DEG), Frequency::Dual)?;
    let receiver = Sky::of(&receiver, Frequency::Dual)?;
    let (mut victim, mut tally) = (Victim::new(&[], 1.0)?, Tally::default());
    for (index, (own, of_station)) in
        receiver.bytes(|_, _| {})?.into_iter().zip(&station.recording.epochs).enumerate()
    {
        let own = if SILENT.contains(&index) { Vec::new() } else { own };
        let of_station = if index == 0 { Vec::new() } else { renumbered(&station.ranges(of_station)?) };
        tally.add_all(&victim.hear(&[of_station, own].concat(), receiver.truth)?);
    }
    let mut figures = tally.figures(0.0);
    // What stands in while the receiver is silent is elsewhere; then it has to recover.
    figures.push(Figure::at_least("promised", tally.promised as f64, 105.0));
    Ok(figures)
}

/// The same messages of ranges, of the other station.
fn renumbered(mut bytes: &[u8]) -> Vec<u8> {
    let mut frames = Vec::new();
    while let [0xD3, high, low, ..] = *bytes {
        let length = usize::from(u16::from_be_bytes([high & 3, low]));
        let (frame, rest) = bytes.split_at(length + 6);
        let mut payload = frame[3..3 + length].to_vec();
        payload[1] = payload[1] & 0xF0 | (STATION >> 8) as u8;
        payload[2] = STATION as u8;
        frames.extend(rtcm_frame(&payload));
        bytes = rest;
    }
    frames
}
