//! A file on standard input, in the time that it was recorded in.
//!
//! ```text
//! rai run < FILE  =  the sentences of  rai replay FILE --nmea
//! ```
//!
//! The bytes of a file come at once, so the clock of the computer would make every epoch but the
//! first one too early. Time therefore passes by the tags of the epochs, as in `replay`. No
//! consumer loses a sentence, because a file waits.

use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::{Context as _, Result};
use raim_firmware::settings::Configuration;

use super::Plan;
use super::outbox::Outbox;
use super::pin::Wire;
use super::report::Recorder;
use crate::replay::{Pace, Playback};
use crate::run::words::say;
use crate::signal::capture::{self, Bytes};

/// Name of standard input as a file.
pub(super) const NAME: &str = "/dev/stdin";

/// Plays the file; returns the settings at its end.
///
/// # Errors
/// If the module refuses a setting, the file is no capture, or the pin cannot be set.
pub(super) fn play(
    plan: &Plan,
    wire: &Wire,
    outbox: &mut Outbox,
    mut recorder: Option<&mut Recorder>,
    stop: &AtomicBool,
) -> Result<Configuration> {
    let body = |(key, value): &(String, String)| {
        if value.is_empty() { key.clone() } else { format!("{key},{value}") }
    };
    let settings: Vec<String> = plan.settings.iter().map(body).collect();
    // A setting is refused before the first byte is read.
    Playback::start(std::iter::empty(), &settings, Pace::Recorded)?;
    let bytes = Bytes::open(NAME, f64::INFINITY)?;
    let cut = bytes.cut();
    let (lumps, mut setup) = capture::for_the_module(NAME, bytes).context("standard input")?;
    setup.extend(settings);
    let mut playback = Playback::start(lumps, &setup, Pace::Recorded)?;
    outbox.report_start(plan, playback.configuration());
    if recorder.is_some() {
        playback.watch();
    }
    while let Some((lump, reported)) = playback.advance()? {
        for line in
            [&reported.of_epoch, &reported.of_silence].into_iter().flat_map(|text| text.split_inclusive('\n'))
        {
            outbox.send(line.as_bytes());
        }
        outbox.wake();
        let is_high = playback.pin_is_high();
        if is_high != wire.is_high() {
            wire.drive(is_high).context("the pin cannot be set")?;
        }
        let seen = || reported.seen.iter().chain(reported.silence.iter().map(|(_, seen)| seen));
        seen().for_each(|seen| outbox.note(seen));
        if let Some(recorder) = recorder.as_deref_mut() {
            recorder.take(seen(), is_high, lump.elapsed_ms());
        }
        if stop.load(Ordering::Relaxed) || outbox.has_failed() {
            break;
        }
    }
    if let Some(words) = cut.words() {
        say!("{words}");
    }
    Ok(*playback.configuration())
}
