//! Stages that begin with bytes: what has come before, its length first, then what is timed.

use core::convert::Infallible;
use core::hint::black_box;

use embedded_hal::digital::{ErrorType, OutputPin};
use embedded_io::Write;
use rai_firmware::config::Configuration;
use rai_firmware::correction::{Site, Sky, Tally};
use rai_firmware::ephemeris::Store;
use rai_firmware::navigator::Navigator;
use rai_firmware::nmea::write_epoch;
use rai_firmware::receiver::{Boot, Receiver};
use rai_firmware::rtcm::{Decoder, Event, RawEpoch};

use crate::answer::Answers;
use crate::epochs::point;
use crate::request::Input;
use crate::stopwatch::Stopwatch;

/// Bytes that come before, bytes that are timed.
fn halves(input: Input<'_>) -> Option<(&[u8], &[u8])> {
    let (length, rest) = input.0.split_first_chunk()?;
    rest.split_at_checked(u32::from_le_bytes(*length) as usize)
}

/// Hands every event of some bytes to `take`.
fn follow(decoder: &mut Decoder, bytes: &[u8], mut take: impl FnMut(&Event<'_>)) {
    for &byte in bytes {
        let mut event = decoder.push(byte);
        while let Some(found) = event {
            take(&found);
            event = decoder.pending();
        }
    }
}

/// RTCM to raw epochs and ephemerides.
#[inline(never)]
pub fn decode(input: Input<'_>, stopwatch: &mut Stopwatch, answers: &mut Answers) -> Option<()> {
    let (before, bytes) = halves(input)?;
    let mut decoder = Decoder::new();
    follow(&mut decoder, before, |_| ());
    let mut satellites = 0;
    let ((), ticks) = stopwatch.time(|| {
        follow(&mut decoder, black_box(bytes), |event| {
            if let Event::Epoch(raw) = event {
                satellites += raw.satellites.len();
            }
        });
    });
    answers.write(ticks, &satellites)
}

/// Ephemerides and the last epoch of some bytes.
#[inline(never)]
fn learn(bytes: &[u8]) -> Option<(Store, RawEpoch)> {
    let (mut decoder, mut store, mut last) = (Decoder::new(), Store::new(), None);
    follow(&mut decoder, bytes, |event| match event {
        Event::Epoch(raw) => last = Some((*raw).clone()),
        Event::Ephemeris(ephemeris) => {
            store.insert(*ephemeris, None);
        }
        Event::ReferencePosition(_) => {}
    });
    Some((store, last?))
}

/// Satellite positions and clocks of the last epoch.
#[inline(never)]
pub fn locate(input: Input<'_>, stopwatch: &mut Stopwatch, answers: &mut Answers) -> Option<()> {
    let (store, raw) = learn(input.0)?;
    let mut tally = Tally::default();
    let (sky, ticks) =
        stopwatch.time(|| rai_firmware::correction::locate(black_box(&raw), &store, &mut tally));
    answers.write(ticks, &sky.len())
}

#[inline(never)]
fn sky(raw: &RawEpoch, store: &Store) -> Sky {
    rai_firmware::correction::locate(raw, store, &mut Tally::default())
}

/// Atmosphere and sigmas about a point, which comes first.
#[inline(never)]
pub fn correct(mut input: Input<'_>, stopwatch: &mut Stopwatch, answers: &mut Answers) -> Option<()> {
    let point = point(&mut input)?;
    let (store, raw) = learn(input.0)?;
    let sky = sky(&raw, &store);
    let configuration = Configuration::at_start();
    let mut refusals = Tally::default().ranges;
    let (epoch, ticks) = stopwatch.time(|| {
        let site = Site::new(black_box(point), raw.time, configuration.mask_rad, configuration.klobuchar);
        site.correct(&sky, &mut refusals)
    });
    answers.write(ticks, &epoch.observations().len())
}

/// Sentences of the last epoch's report.
#[inline(never)]
pub fn speak(input: Input<'_>, stopwatch: &mut Stopwatch, answers: &mut Answers) -> Option<()> {
    let (mut decoder, mut last) = (Decoder::new(), None);
    let configuration = Configuration::at_start();
    let mut navigator = Navigator::new(configuration.requirements).ok()?;
    follow(&mut decoder, input.0, |event| match event {
        Event::Epoch(raw) => last = Some((navigator.judge(raw, &configuration), raw.time)),
        Event::Ephemeris(ephemeris) => {
            navigator.learn(*ephemeris, None);
        }
        Event::ReferencePosition(_) => {}
    });
    let (report, time) = last?;
    let mut host = Host { bytes: 0 };
    let (_, ticks) =
        stopwatch.time(|| write_epoch(black_box(&report), time, 18, &configuration.requirements, &mut host));
    answers.write(ticks, &host.bytes)
}

/// Bytes in to bytes out. A command comes first, its length in a byte.
#[inline(never)]
pub fn whole(mut input: Input<'_>, stopwatch: &mut Stopwatch, answers: &mut Answers) -> Option<()> {
    let length = usize::from(input.byte()?);
    let (command, rest) = input.0.split_at_checked(length)?;
    let (before, bytes) = halves(Input(rest))?;
    let boot = Boot { git: "laboratory", reset_cause: heapless::String::new() };
    let mut receiver = Receiver::new(Pin, boot).ok()?;
    let mut host = Host { bytes: 0 };
    receiver.command(command, &mut host);
    receiver.gnss(before, 0, &mut host);
    let said_before = host.bytes;
    let ((), ticks) = stopwatch.time(|| receiver.gnss(black_box(bytes), 0, &mut host));
    answers.write(ticks, &(host.bytes - said_before))
}

/// A host that counts what it hears.
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

/// A pin that leads nowhere.
struct Pin;

impl ErrorType for Pin {
    type Error = Infallible;
}

impl OutputPin for Pin {
    fn set_low(&mut self) -> Result<(), Infallible> {
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}
