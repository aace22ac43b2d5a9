//! Streams of RTCM: valid ones give the sent values, invalid ones only a named counter.

mod astray;
mod ephemerides;
mod epochs;
mod frames;
mod leap;
mod qzss;
mod ranges;
mod time;

use crate::orbits::CASES;
use crate::wire::{Cell, L1C, L2W, ephemeris, feed, msm};
use raim_firmware::input::{Counters, Input};

/// Time of week of the first epoch: at the first case's reference time.
const TOW_MS: u32 = 360_000_000;

/// Returns an input that knows the week.
fn knowing() -> Input {
    let mut input = Input::new();
    feed(&mut input, &ephemeris(&CASES[2]));
    input
}

/// Ranges of G05 that grow with time: the same ranges under another tag are a repeated epoch.
fn gps(tow_ms: u32, more: bool) -> Vec<u8> {
    gps_at(tow_ms, 2.2e7 + f64::from(tow_ms % 7_000_003) * 0.1, more)
}

/// Ranges of G05 under a tag.
fn gps_at(tow_ms: u32, range_m: f64, more: bool) -> Vec<u8> {
    msm(1077, tow_ms, more, &[Cell(5, L1C, range_m, 45.0), Cell(5, L2W, range_m + 5.0, 40.0)])
}

fn names_of_nonzero(counters: &Counters) -> Vec<(&'static str, u32)> {
    let dull = ["frames", "epochs", "ephemerides"];
    counters.iter().filter(|(name, value)| *value > 0 && !dull.contains(name)).collect()
}
