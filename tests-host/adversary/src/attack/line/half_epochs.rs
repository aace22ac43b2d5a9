//! One of two systems tagged wrong by tens of milliseconds, so that one instant becomes two epochs,
//! of one system each.
//!
//! ```text
//! δρ_i = ṙ_i δ        every satellite of the system, up to 80 m at 100 ms
//! ```
//!
//! Each half agrees with itself, and no satellite is in both. Half of them are at a wrong place.

use rtcm_rs::Message;

use crate::attack::forgery::{read, write};
use crate::attack::prelude::*;
use crate::soak::noise::frames;

pub(super) const ATTACK: Attack = Attack {
    name: "half-epochs",
    about: "GPS or Galileo tagged 60 to 200 ms ahead or behind: one instant arrives as two epochs",
    branch: Branch::Time,
    before: "83 of 530 beyond",
    note: "",
    run,
};

/// Offsets of the tags, ms.
const OFFSETS_MS: [i32; 6] = [-200, -100, -60, 60, 100, 200];

/// Epochs of a sky.
const EPOCHS: u32 = 12;

fn run(effort: Effort) -> Result<Vec<Figure>> {
    let mut tally = Tally::default();
    for seed in 0..effort.pick(8, 100) {
        let simulation = Simulation {
            satellites: satellites(GPS_GALILEO.1),
            ..Simulation::above_xian(1800.0 + 3600.0 * (seed % 24) as f64, EPOCHS, seed)
        };
        let sky = Sky::with(&simulation, "GE", Frequency::Dual)?;
        let epochs = sky.unchanged()?;
        for offset_ms in OFFSETS_MS {
            for of_gps in [true, false] {
                let mut victim = Victim::new(&[], 1.0)?;
                for bytes in &epochs {
                    let tagged = frames(bytes).into_iter().flat_map(|frame| tagged(frame, offset_ms, of_gps));
                    let tagged: Vec<u8> = tagged.collect();
                    tally.add_all(&victim.receive(&tagged, sky.truth)?);
                }
            }
        }
    }
    Ok(tally.figures(0.0))
}

/// Returns a frame of ranges with another tag, if it is of the system; other frames are unchanged.
fn tagged(frame: &[u8], offset_ms: i32, of_gps: bool) -> Vec<u8> {
    let message = match read(frame) {
        Some(Message::Msg1077(mut ranges)) if of_gps => {
            ranges.gps_epoch_time_ms = ranges.gps_epoch_time_ms.saturating_add_signed(offset_ms);
            Message::Msg1077(ranges)
        }
        Some(Message::Msg1097(mut ranges)) if !of_gps => {
            ranges.gal_epoch_time_ms = ranges.gal_epoch_time_ms.saturating_add_signed(offset_ms);
            Message::Msg1097(ranges)
        }
        _ => return frame.to_vec(),
    };
    write(&message).unwrap_or_default()
}
