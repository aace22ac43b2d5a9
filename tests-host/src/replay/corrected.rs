//! Lumps as the firmware corrects them at a known antenna: the ranges, sigmas and directions that the module works with,
//! without the position that it finds.

use rai_core::epoch::Epoch;
use rai_core::frame::Ecef;
use rai_firmware::correction::{CAPACITY, Site, Tally, locate};
use rai_firmware::ephemeris::Store;
use rai_firmware::rtcm::{Decoder, Event};

use super::Lump;

/// The epochs of the lumps, of the satellites above the mask.
pub fn corrected(lumps: &[Lump], antenna: Ecef, mask_rad: f64) -> Vec<Epoch<CAPACITY>> {
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
                    let site = Site::new(antenna, raw.time, mask_rad, None);
                    epochs.push(site.correct(&sky, &mut tally.ranges));
                }
            }
            event = decoder.pending();
        }
    }
    epochs
}
