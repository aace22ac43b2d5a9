//! Lumps as the firmware corrects them at a known antenna: the ranges, sigmas and directions that
//! the module works with, without the position that it computes.

use raim_core::epoch::Epoch;
use raim_core::frame::Ecef;
use raim_firmware::correction::{CAPACITY, Klobuchar, Site, Sky, Tally, locate};
use raim_firmware::ephemeris::Store;
use raim_firmware::input::{Event, Input};
use raim_firmware::settings::Systems;
use raim_firmware::time::GpsTime;

use super::lump::Lump;

/// Signal mask at start, dB-Hz.
const SIGNAL_MASK_DBHZ: f32 = 28.0;

/// Returns the epochs of the lumps, of the satellites above the mask; `klobuchar` are the
/// ionospheric coefficients for ranges on one frequency.
pub fn corrected(
    lumps: &[Lump],
    antenna: Ecef,
    mask_rad: f64,
    klobuchar: Option<[f64; 8]>,
) -> Vec<Epoch<CAPACITY>> {
    let mut corrector = Corrector::new(antenna, mask_rad, klobuchar);
    lumps.iter().flat_map(|lump| corrector.receive(&lump.bytes)).collect()
}

/// Corrector of successive epochs.
pub(super) struct Corrector {
    input: Input,
    store: Store,
    tally: Tally,
    sky: Sky,
    antenna: Ecef,
    mask_rad: f64,
    klobuchar: Option<[f64; 8]>,
    /// Time of the last epoch.
    now: Option<GpsTime>,
}

impl Corrector {
    pub(super) fn new(antenna: Ecef, mask_rad: f64, klobuchar: Option<[f64; 8]>) -> Self {
        let (input, store, tally, sky) = (Input::new(), Store::new(), Tally::default(), Sky::new());
        Self { input, store, tally, sky, antenna, mask_rad, klobuchar, now: None }
    }

    /// Takes the bytes of a lump; returns the epochs that they complete.
    pub(super) fn receive(&mut self, bytes: &[u8]) -> Vec<Epoch<CAPACITY>> {
        let Self { input, store, tally, sky, antenna, mask_rad, klobuchar, now } = self;
        let mut epochs = Vec::new();
        input.feed(bytes, 0, |event| match event {
            Event::Ephemeris(ephemeris) => drop(store.insert(ephemeris, *now)),
            Event::Redated(present) => store.redate(present),
            Event::Cnav(frame) => store.hear_cnav(&frame, 0),
            Event::Epoch(raw, _) => {
                *now = Some(raw.time);
                locate(raw, store, SIGNAL_MASK_DBHZ, Systems::AT_START, tally, sky);
                let site = Site::new(*antenna, raw.time, *mask_rad, klobuchar.and_then(Klobuchar::new));
                let mut epoch = Epoch::new(0.0);
                site.correct(sky, tally, &mut epoch);
                epochs.push(epoch);
            }
            _ => {}
        });
        epochs
    }
}
