//! The wire: good streams give what was sent, bad ones a named counter and nothing else.

mod ephemerides;
mod epochs;
mod frames;
mod qzss;
mod ranges;
mod time;

use crate::orbits::CASES;
use crate::wire::{Cell, L1C, L2W, ephemeris, feed, msm};
use rai_firmware::input::{Counters, Input};

/// Time of week of the first epoch: at the first case's reference time.
const TOW_MS: u32 = 360_000_000;

/// An input that knows the week.
fn knowing() -> Input {
    let mut input = Input::new();
    feed(&mut input, &ephemeris(&CASES[2]));
    input
}

fn gps(tow_ms: u32, more: bool) -> Vec<u8> {
    msm(1077, tow_ms, more, &[Cell(5, L1C, 2.2e7, 45.0), Cell(5, L2W, 2.2e7 + 5.0, 40.0)])
}

fn names_of_nonzero(counters: &Counters) -> Vec<(&'static str, u32)> {
    let dull = ["frames", "epochs", "ephemerides"];
    counters.iter().filter(|(name, value)| *value > 0 && !dull.contains(name)).collect()
}
