//! CNAV: delays and health of the signals of GPS and QZSS.
//!
//! | content | module |
//! |---|---|
//! | frames that receivers sent, and ranges of the same device | [`recorded`] |
//! | a day of a station with frames of its satellites: residuals, levels, use of L5 | [`station`] |
//! | wrong frames, and values at their ends | [`hostile`] |
//! | the verdicts of the module: health, alert, settings, sentence | [`module`] |

mod hostile;
mod module;
mod recorded;
mod station;

use std::collections::BTreeMap;
use std::io::Read as _;

use flate2::read::GzDecoder;
use raim::signal::encode::ubx::{self, CnavMessage};
use raim_core::satellite::{Constellation, SatelliteId};
use raim_firmware::ephemeris::{CnavContent, CnavFrame};
use raim_firmware::input::{Counters, Event, Input};
use raim_firmware::time::GpsTime;
use rig::shared;

/// Time of frames that have none of their own: 2020-06-25, noon.
const NOON: GpsTime = GpsTime { week: 2111, tow_ms: (4 * 86_400 + 43_200) * 1000 };

fn gps(number: u8) -> SatelliteId {
    SatelliteId::new(Constellation::Gps, number).unwrap()
}

/// Returns a frame of L5 I as UBX.
fn cnav(satellite: SatelliteId, message: CnavMessage, is_alert: bool) -> Vec<u8> {
    ubx::subframe(satellite, 6, &ubx::cnav_words(satellite, message, is_alert, NOON).unwrap())
}

/// Returns the frames of CNAV in some bytes.
fn heard(bytes: &[u8]) -> (Vec<CnavFrame>, Counters) {
    let (mut input, mut frames) = (Input::new(), Vec::new());
    input.feed(bytes, 0, |event| {
        if let Event::Cnav(frame) = event {
            frames.push(frame);
        }
    });
    (frames, *input.counters())
}

/// Returns the last delays that each satellite sent, 2⁻³⁵ s.
fn delays(frames: &[CnavFrame]) -> BTreeMap<SatelliteId, [i16; 5]> {
    let reported = frames.iter().filter_map(|frame| match frame.content {
        CnavContent::Delays(delays) => Some((frame.satellite, delays.steps)),
        _ => None,
    });
    reported.collect()
}

/// Returns a file of the reference folder, unpacked; counts the test as skipped if it is missing.
fn unpacked(relative: &str) -> Option<Vec<u8>> {
    let file = std::fs::File::open(shared::path_or_skip(relative)?).unwrap();
    let mut bytes = Vec::new();
    GzDecoder::new(file).read_to_end(&mut bytes).unwrap();
    Some(bytes)
}
