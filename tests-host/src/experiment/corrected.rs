//! A recording as the firmware corrects it at a known antenna: the ranges, sigmas and directions that the module works
//! with, without the position that it finds.

use anyhow::Result;
use rai_core::epoch::Epoch;
use rai_core::frame::Ecef;
use rai_firmware::correction::{CAPACITY, Site, Tally, locate};
use rai_firmware::ephemeris::Store;
use rai_firmware::rtcm::{Decoder, Event};

use crate::encode::{Frequency, Selection};
use crate::recording::Recording;
use crate::replay::{self, Window};

/// The epochs of a recording, one every so many seconds, of the named systems on two frequencies.
pub(super) fn corrected(
    recording: &Recording,
    systems: &str,
    antenna: Ecef,
    mask_rad: f64,
    every_s: f64,
) -> Result<Vec<Epoch<CAPACITY>>> {
    let systems = Selection::new(systems, Frequency::Dual)?;
    let lumps = replay::encode(recording, &systems, &[], &Window { every_s, ..Window::ALL })?;
    let (mut decoder, mut store, mut tally) = (Decoder::new(), Store::new(), Tally::default());
    let mut epochs = Vec::new();
    for &byte in lumps.iter().flat_map(|lump| &lump.bytes) {
        let mut event = decoder.push(byte);
        while let Some(found) = event {
            match found {
                Event::Ephemeris(ephemeris) => drop(store.insert(ephemeris, None)),
                Event::ReferencePosition(_) => {}
                Event::Epoch(raw) => {
                    let sky = locate(raw, &store, &mut tally);
                    epochs
                        .push(Site::new(antenna, raw.time, mask_rad, None).correct(&sky, &mut tally.ranges));
                }
            }
            event = decoder.pending();
        }
    }
    Ok(epochs)
}
