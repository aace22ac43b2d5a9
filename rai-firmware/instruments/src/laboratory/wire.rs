//! Stages with bytes as input: the length of the first part, that part, which is not timed, then
//! the timed bytes.

use core::convert::Infallible;
use core::hint::black_box;

use embedded_io::Write;
use raim_core::epoch::Epoch;
use raim_firmware::correction::{Klobuchar, Site, Sky, Tally};
use raim_firmware::ephemeris::Store;
use raim_firmware::input::{Event, Input as Gnss};
use raim_firmware::navigator::Navigator;
use raim_firmware::output::nmea::write_epoch;
use raim_firmware::output::{Interference, Motion, Statement};
use raim_firmware::pin::MemoryPin;
use raim_firmware::raw::RawEpoch;
use raim_firmware::receiver::{Boot, Receiver};
use raim_firmware::settings::{Configuration, Systems};
use raim_firmware::time::GpsTime;

use crate::answer::Answers;
use crate::epochs::point;
use crate::request::Input;
use crate::stopwatch::Stopwatch;

/// Returns the first bytes and the timed bytes.
fn halves(input: Input<'_>) -> Option<(&[u8], &[u8])> {
    let (length, rest) = input.0.split_first_chunk()?;
    rest.split_at_checked(u32::from_le_bytes(*length) as usize)
}

/// Times the decoding of a receiver's bytes, in any format, to raw epochs and ephemerides.
#[inline(never)]
pub fn decode(input: Input<'_>, stopwatch: &mut Stopwatch, answers: &mut Answers) -> Option<()> {
    let (before, bytes) = halves(input)?;
    let mut gnss = Gnss::new();
    gnss.feed(before, 0, |_| ());
    let mut satellites = 0;
    let ((), ticks) = stopwatch.time(|| {
        gnss.feed(black_box(bytes), 0, |event| {
            if let Event::Epoch(raw, _) = event {
                satellites += raw.satellites.len();
            }
        });
    });
    answers.write(ticks, &satellites)
}

/// Puts the ephemerides and the last epoch of some bytes into memory of the caller.
#[inline(never)]
fn learn(bytes: &[u8], store: &mut Store, last: &mut RawEpoch) {
    let mut gnss = Gnss::new();
    gnss.feed(bytes, 0, |event| match event {
        Event::Epoch(raw, _) => {
            last.time = raw.time;
            last.satellites.clone_from(&raw.satellites);
        }
        Event::Ephemeris(ephemeris) => {
            store.insert(ephemeris, None);
        }
        _ => {}
    });
}

/// Returns an empty epoch, to be filled.
const fn nothing() -> RawEpoch {
    RawEpoch::new(GpsTime { week: 0, tow_ms: 0 })
}

/// Times satellite positions and clocks of the last epoch.
#[inline(never)]
pub fn locate(input: Input<'_>, stopwatch: &mut Stopwatch, answers: &mut Answers) -> Option<()> {
    let (mut store, mut raw) = (Store::new(), nothing());
    learn(input.0, &mut store, &mut raw);
    let mut tally = Tally::default();
    let mut sky = Sky::new();
    let ((), ticks) = stopwatch.time(|| {
        let raw = black_box(&raw);
        raim_firmware::correction::locate(raw, &store, 28.0, Systems::AT_START, &mut tally, &mut sky);
    });
    answers.write(ticks, &sky.len())
}

#[inline(never)]
fn sky(raw: &RawEpoch, store: &Store) -> Sky {
    let mut sky = Sky::new();
    raim_firmware::correction::locate(raw, store, 28.0, Systems::AT_START, &mut Tally::default(), &mut sky);
    sky
}

/// Times atmosphere and sigmas at a point, which comes first in the input.
#[inline(never)]
pub fn correct(mut input: Input<'_>, stopwatch: &mut Stopwatch, answers: &mut Answers) -> Option<()> {
    let point = point(&mut input)?;
    let (mut store, mut raw) = (Store::new(), nothing());
    learn(input.0, &mut store, &mut raw);
    let sky = sky(&raw, &store);
    let configuration = Configuration::at_start();
    let mut tally = Tally::default();
    let mut epoch = Epoch::new(0.0);
    let ((), ticks) = stopwatch.time(|| {
        let klobuchar = configuration.klobuchar.and_then(Klobuchar::new);
        let site = Site::new(black_box(point), raw.time, configuration.mask_rad(), klobuchar);
        site.correct(&sky, &mut tally, &mut epoch);
    });
    answers.write(ticks, &epoch.observations().len())
}

/// Judges all epochs of some bytes; returns the time of the last.
#[inline(never)]
fn judge(bytes: &[u8], navigator: &mut Navigator, configuration: &Configuration) -> Option<GpsTime> {
    let (mut gnss, mut last) = (Gnss::new(), None);
    gnss.feed(bytes, 0, |event| match event {
        Event::Epoch(raw, _) => {
            navigator.judge(raw, 0, configuration);
            last = Some(raw.time);
        }
        Event::Ephemeris(ephemeris) => {
            navigator.learn(ephemeris, None);
        }
        _ => {}
    });
    last
}

/// Times the places of single systems behind the last epoch; the answer has the longest of them.
#[inline(never)]
pub fn compare(input: Input<'_>, stopwatch: &mut Stopwatch, answers: &mut Answers) -> Option<()> {
    let configuration = Configuration::at_start();
    let mut navigator = Navigator::new(configuration.requirements()).ok()?;
    judge(input.0, &mut navigator, &configuration)?;
    let (mut most_ticks, mut places) = (0, 0);
    loop {
        let (is_one, ticks) = stopwatch.time(|| navigator.compare_systems());
        most_ticks = most_ticks.max(ticks);
        if !is_one {
            return answers.write(most_ticks, &places);
        }
        places += 1;
    }
}

/// Times the sentences of the last epoch's report.
#[inline(never)]
pub fn speak(input: Input<'_>, stopwatch: &mut Stopwatch, answers: &mut Answers) -> Option<()> {
    let configuration = Configuration::at_start();
    let mut navigator = Navigator::new(configuration.requirements()).ok()?;
    let time = judge(input.0, &mut navigator, &configuration)?;
    let mut host = Host { bytes: 0 };
    let statement = Statement {
        report: navigator.report(),
        time,
        gps_minus_utc_s: 18,
        requirements: &configuration.requirements(),
        motion: Some(Motion { east_m_s: 12.0, north_m_s: -7.5, up_m_s: 0.25, sigma_m_s: 0.05 }),
        interference: Interference::default(),
        settings_hash: 0x1234_5678,
        unhealthy_l5: 0,
        in_view: None,
    };
    let due = configuration.outputs.due(0);
    let (_, ticks) = stopwatch.time(|| write_epoch(black_box(&statement), due, &mut host));
    answers.write(ticks, &host.bytes)
}

/// Bytes per pass of the loop: those of a millisecond at 115,200 baud.
const BYTES_PER_PASS: usize = 11;

/// Times everything from bytes to sentences, as from a line. A command comes first, after its
/// length in a byte.
#[inline(never)]
pub fn whole(mut input: Input<'_>, stopwatch: &mut Stopwatch, answers: &mut Answers) -> Option<()> {
    let length = usize::from(input.byte()?);
    let (command, rest) = input.0.split_at_checked(length)?;
    let (before, bytes) = halves(Input(rest))?;
    let boot = Boot::on_host("laboratory");
    // Borrowed and not taken out, because there is no room for two.
    let mut receiver = Receiver::new(MemoryPin::default(), boot);
    let receiver = receiver.as_mut().ok()?;
    let mut host = Host { bytes: 0 };
    receiver.command(command, &mut host);
    receiver.gnss(before, 0, &mut host);
    let said_before = host.bytes;
    let ((), ticks) = stopwatch.time(|| {
        for together in black_box(bytes).chunks(BYTES_PER_PASS) {
            receiver.gnss(together, 0, &mut host);
        }
    });
    answers.write(ticks, &(host.bytes - said_before))
}

/// A host that counts the bytes it receives.
struct Host {
    bytes: usize,
}

impl embedded_io::ErrorType for Host {
    type Error = Infallible;
}

impl Write for Host {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        self.bytes += black_box(bytes).len();
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}
