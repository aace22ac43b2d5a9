//! SBF as a Septentrio receiver sends it: the module's reading compared with another program's, with
//! the same streams as UBX, and with every kind of error.
//!
//! | content | module |
//! |---|---|
//! | a real mosaic: ranges as `pysbf2` reads them, bits, decoded sets, positions, its own reports | [`mosaic`] |
//! | streams of an independent program beside their UBX | [`streams`] |
//! | wrong lengths, counts, times and antennas, nonsense with a correct CRC, blocks cut and mixed | [`hostile`] |

mod hostile;
mod mosaic;
mod streams;

use std::fs::File;
use std::io::Read as _;

use flate2::read::MultiGzDecoder;
use raim_firmware::ephemeris::Ephemeris;
use raim_firmware::input::{Counters, Event, Input, SelfReport};
use raim_firmware::raw::RawEpoch;
use rig::shared;

/// Content of some bytes.
#[derive(Default)]
struct Reported {
    ephemerides: Vec<Ephemeris>,
    epochs: Vec<RawEpoch>,
    reports: Vec<SelfReport>,
}

/// Returns the content of some bytes for a module without earlier input, as of one instant.
fn reported(bytes: &[u8]) -> (Reported, Counters) {
    let (mut input, mut reported) = (Input::new(), Reported::default());
    input.feed(bytes, 0, |event| match event {
        Event::Epoch(epoch, _) => reported.epochs.push(epoch.clone()),
        Event::Ephemeris(ephemeris) => reported.ephemerides.push(ephemeris),
        Event::SelfReport(report) => reported.reports.push(report),
        _ => {}
    });
    (reported, *input.counters())
}

/// Returns the bytes of a packed file below the reference folder; reports a skip if it is missing.
fn unpacked(name: &str) -> Option<Vec<u8>> {
    let path = shared::path_or_skip(&format!("data/{name}"))?;
    let mut bytes = Vec::new();
    MultiGzDecoder::new(File::open(path).unwrap()).read_to_end(&mut bytes).unwrap();
    Some(bytes)
}
