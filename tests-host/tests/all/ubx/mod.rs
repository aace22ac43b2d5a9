//! UBX as a u-blox receiver sends it: the module's results compared with those of equivalent RTCM
//! and with other programs, and with every kind of error.
//!
//! | content | module |
//! |---|---|
//! | every bit of every navigation message, compared with RTCM | [`bits`] |
//! | frames that real receivers sent | [`as_sent`] |
//! | streams of an independent program against the recordings that they were made of | [`streams`] |
//! | the same epochs as RTCM and as UBX: verdicts, positions | [`module`] |
//! | a receiver's reports on its own signals, written by `pyubx2` | [`own_reports`] |
//! | GLONASS: strings, and their effect on positions | [`glonass`] |
//! | QZSS: the bits of GPS, and the clock of GPS | [`qzss`] |
//! | RTKLIB's reading of the encoder's bytes | [`rtklib`] |
//! | wrong parities, lengths, times, doubles; pages mixed, missing and out of order; frames cut and interleaved | [`hostile`] |

mod as_sent;
mod bits;
mod glonass;
mod hostile;
mod module;
mod own_reports;
mod qzss;
mod rtklib;
mod streams;

use raim::signal::encode::{Encoder, Frequency, Selection};
use raim::signal::measurement::{MeasuredEpoch, TimedEphemeris};
use raim_core::satellite::Constellation;
use raim_firmware::ephemeris::Ephemeris;
use raim_firmware::input::{Counters, Event, Input};
use raim_firmware::raw::RawEpoch;
use raim_firmware::time::GpsTime;

/// Content of some bytes.
#[derive(Default)]
struct Reported {
    ephemerides: Vec<Ephemeris>,
    epochs: Vec<RawEpoch>,
    ionosphere: Vec<(Constellation, [f64; 8])>,
}

impl Reported {
    fn receive(&mut self, event: &Event<'_>) {
        match event {
            Event::Epoch(epoch, _) => self.epochs.push((*epoch).clone()),
            Event::Ephemeris(ephemeris) => self.ephemerides.push(*ephemeris),
            Event::Ionosphere(of, coefficients) => self.ionosphere.push((*of, *coefficients)),
            _ => {}
        }
    }
}

/// Returns the content of some bytes for a module without earlier input.
fn reported(bytes: &[u8]) -> (Reported, Counters) {
    let (mut input, mut reported) = (Input::new(), Reported::default());
    input.feed(bytes, 0, |event| reported.receive(&event));
    (reported, *input.counters())
}

/// Returns an ephemeris as RTCM carries it.
fn by_rtcm(ephemeris: &TimedEphemeris) -> Vec<Ephemeris> {
    let selection = Selection::new("GCE", Frequency::Dual).unwrap();
    let nothing = MeasuredEpoch { time: ephemeris.toe, satellites: Vec::new() };
    let bytes = Encoder::new(std::slice::from_ref(ephemeris), selection).epoch(&nothing).unwrap();
    reported(&bytes).0.ephemerides
}

/// Time of the messages made here: 2020-06-25, noon.
const NOON: GpsTime = GpsTime { week: 2111, tow_ms: (4 * 86_400 + 43_200) * 1000 };
