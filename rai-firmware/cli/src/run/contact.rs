//! First contact with a receiver: the bit rate of its port, and what its bytes lack.
//!
//! ```text
//! bytes without a frame for 5 s ─► next rate                 serial ports, as the board does
//! no epoch 10 s after the first byte ─► what `replay` says   once, on standard error
//! no position after a minute ─► what `replay` says is missing
//! ```
//!
//! The first bytes at each rate are kept, at most [`MOST_BYTES`] of them, until something was said
//! or the module has had a position. Text at a rate is a sign that the rate is right, so that a
//! receiver that sends only sentences is named before the next rate is tried.

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use anyhow::{Result, anyhow};
use raim_firmware::bit_rate::{BitRate, RATES};

use super::ranges::Ranges;
use crate::signal::capture::Capture;
use crate::signal::pieces::{Kind, pieces};
use crate::source::Source;

/// First bytes that are kept.
const MOST_BYTES: usize = 1 << 18;
/// Bytes of these that are searched for text or frames before another rate is tried.
const SEARCHED: usize = 1 << 16;
/// Time after the first byte within which a receiver has sent ranges, ms.
const TO_RANGES_MS: u64 = 10_000;
/// Time after the first byte within which a receiver has sent orbits, ms.
const TO_ORBITS_MS: u64 = 60_000;

/// What the module has made of the bytes so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Progress {
    /// Valid frames since start.
    pub(super) frames: u32,
    /// Epochs judged since start.
    pub(super) has_epoch: bool,
    /// True if the last epoch had a position.
    pub(super) has_position: bool,
    /// Rate that a command has set, bit/s.
    pub(super) fixed: Option<u32>,
    /// Time tag of the last epoch, s.
    pub(super) tag_s: Option<f64>,
}

/// The contact.
#[derive(Debug)]
pub(super) struct Contact {
    name: String,
    /// The rate of a serial port, which its reader follows; `None` for another source.
    port: Option<(BitRate, Arc<AtomicU32>)>,
    /// True if another line brings orbits.
    has_caster: bool,
    first_ms: Option<u64>,
    /// The first bytes at this rate; `None` once nothing is left to say.
    heard: Option<Vec<u8>>,
    /// Rates tried beside the first.
    trials: usize,
    frames: u32,
    has_epoch: bool,
    ranges: Ranges,
}

impl Contact {
    /// Returns the contact before the first byte; the reader of a serial port follows `rate`.
    pub(super) fn new(source: &Source, rate: &Arc<AtomicU32>, has_caster: bool) -> Self {
        let port = match source {
            Source::Serial(_, baud) => {
                let mut trial = BitRate::new();
                // The trial begins at the rate that the user has named.
                trial.next(0, Some(*baud));
                Some((trial, Arc::clone(rate)))
            }
            Source::Tcp(_) | Source::Standard | Source::File(_) => None,
        };
        Self {
            name: source.to_string(),
            port,
            has_caster,
            first_ms: None,
            heard: Some(Vec::new()),
            trials: 0,
            frames: 0,
            has_epoch: false,
            ranges: Ranges::default(),
        }
    }

    /// Returns true while the receiver sends messages and no ranges any more.
    pub(super) const fn lacks_ranges(&self) -> bool {
        self.ranges.are_missing()
    }

    /// Takes bytes of the receiver.
    pub(super) fn receive(&mut self, bytes: &[u8], now_ms: u64) {
        self.first_ms.get_or_insert(now_ms);
        if let Some((rate, _)) = &mut self.port {
            rate.receive(now_ms);
        }
        if let Some(heard) = &mut self.heard {
            let room = MOST_BYTES - heard.len();
            heard.extend(bytes.iter().take(room));
        }
    }

    /// Looks at what the module has made of the bytes; returns what is to be said, and sets the
    /// next rate of the port.
    pub(super) fn look(&mut self, progress: Progress, now_ms: u64) -> Option<String> {
        self.has_epoch |= progress.has_epoch;
        let found = self.note_frames(progress.frames);
        if progress.has_position {
            self.heard = None;
        }
        let age_ms = now_ms.saturating_sub(self.first_ms.unwrap_or(now_ms));
        let ended = self.ranges.look(progress.tag_s, progress.frames, now_ms);
        let ended = ended.map(|words| format!("{}: {words}", self.name));
        let reported = self.try_rate(progress).or_else(|| self.judge(age_ms));
        found.or(ended).or(reported)
    }

    /// Returns what is to be said at the end of a finite input without an epoch.
    pub(super) fn end(self) -> Result<()> {
        match self.heard {
            Some(heard) if !self.has_epoch => {
                let error = Capture::of(heard, None).err();
                Err(error.unwrap_or_else(|| anyhow!("no epoch was complete")).context(self.name))
            }
            _ => Ok(()),
        }
    }

    /// Notes valid frames; returns the rate at which the first come after a trial.
    fn note_frames(&mut self, frames: u32) -> Option<String> {
        let is_first = std::mem::replace(&mut self.frames, frames) != frames && self.trials > 0;
        let (_, rate) = self.port.as_ref().filter(|_| is_first)?;
        self.trials = 0;
        Some(format!("{}: frames at {} bit/s", self.name, rate.load(Ordering::Relaxed)))
    }

    /// Sets the next rate of the port if this one brings nothing; returns what is to be said.
    fn try_rate(&mut self, progress: Progress) -> Option<String> {
        let (trial, rate) = self.port.as_mut()?;
        let baud = trial.next(progress.frames, progress.fixed)?;
        let last = rate.swap(baud, Ordering::Relaxed);
        let heard = self.heard.as_mut()?;
        let words = said_of(&self.name, heard, |kind| kind != Kind::Rest);
        let has_words = words.is_some();
        let reported = words.or_else(|| {
            (self.trials == 0 && progress.fixed.is_none()).then(|| {
                format!("{}: no frame of UBX, SBF or RTCM 3 at {last} bit/s; trying other rates", self.name)
            })
        });
        let tried_all = self.trials >= RATES.len();
        self.trials += 1;
        let reported = if tried_all && !has_words {
            let all = RATES.map(|rate| rate.to_string()).join(", ");
            self.heard = None;
            Some(format!("{}: no frame of UBX, SBF or RTCM 3 at any of {all} bit/s", self.name))
        } else {
            heard.clear();
            reported
        };
        if has_words {
            self.heard = None;
        }
        reported
    }

    /// Judges the bytes of a source that cannot have a wrong rate, or that has sent frames.
    fn judge(&mut self, age_ms: u64) -> Option<String> {
        let has_readable = self.port.is_none() || self.frames > 0;
        let heard = self.heard.as_ref().filter(|_| has_readable)?;
        let due_ms = if self.has_epoch { TO_ORBITS_MS } else { TO_RANGES_MS };
        if age_ms < due_ms || heard.is_empty() {
            return None;
        }
        let heard = self.heard.take()?;
        match Capture::of(heard, None) {
            Err(error) => Some(format!("{}: {error:#}", self.name)),
            Ok(capture) => {
                capture.advice().filter(|_| !self.has_caster).map(|advice| format!("{}: {advice}", self.name))
            }
        }
    }
}

/// Returns what `replay` says of bytes, if they have a piece of this kind.
fn said_of(name: &str, heard: &[u8], is_wanted: impl Fn(Kind) -> bool) -> Option<String> {
    let searched = heard.get(..heard.len().min(SEARCHED)).unwrap_or_default();
    if !pieces(searched).any(|piece| is_wanted(piece.kind)) {
        return None;
    }
    Capture::of(heard.to_vec(), None).err().map(|error| format!("{name}: {error:#}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SENTENCE: &[u8] = b"$GPGLL,4916.45,N,12311.12,W,225444,A,*1D\r\n";

    const NOTHING: Progress =
        Progress { frames: 0, has_epoch: false, has_position: false, fixed: None, tag_s: None };

    /// Returns what is said of a receiver that sends this ten times a second, and the rates that
    /// are tried.
    fn reported(source: &str, seconds: u64, sent: impl Fn(u32) -> Vec<u8>) -> (Vec<String>, Vec<u32>) {
        let source: Source = source.parse().unwrap();
        let rate = Arc::new(AtomicU32::new(match source {
            Source::Serial(_, baud) => baud,
            _ => 0,
        }));
        let mut contact = Contact::new(&source, &rate, false);
        let (mut reported, mut rates) = (Vec::new(), Vec::new());
        for now_ms in (0..seconds * 1000).step_by(100) {
            let baud = rate.load(Ordering::Relaxed);
            if rates.last() != Some(&baud) {
                rates.push(baud);
            }
            contact.receive(&sent(baud), now_ms);
            reported.extend(contact.look(NOTHING, now_ms));
        }
        (reported, rates)
    }

    #[test]
    fn receiver_of_sentences_is_named_once_at_the_rate_at_which_they_are_read() {
        let at = |baud| move |now| if now == baud { SENTENCE.to_vec() } else { vec![0xFF, 0x80, 0x3F] };
        for (baud, named_s) in [(115_200, 6), (9_600, 35)] {
            let (reported, rates) = reported("serial:/dev/x@115200", named_s, at(baud));
            let last = reported.last().unwrap();
            assert!(
                last.starts_with("serial:/dev/x@115200: holds ") && last.contains("lines of NMEA"),
                "{reported:?}"
            );
            assert!(rates.contains(&baud));
        }
        let (reported, _) = reported("serial:/dev/x@115200", 120, at(115_200));
        assert_eq!(reported.len(), 1, "{reported:?}");
        let (reported, _) = self::reported("tcp://a:1", 120, at(0));
        assert!(reported.len() == 1 && reported[0].contains("lines of NMEA"), "{reported:?}");
    }

    #[test]
    fn noise_is_reported_at_the_first_trial_and_after_the_last() {
        let (reported, rates) = reported("serial:/dev/x@57600", 60, |_| vec![0xFF, 0x80, 0x3F]);
        assert_eq!(rates[0], 57_600);
        assert!(RATES.iter().all(|baud| rates.contains(baud)), "{rates:?}");
        assert_eq!(reported.len(), 2, "{reported:?}");
        assert!(reported[0].contains("at 57600 bit/s; trying other rates"), "{reported:?}");
        assert!(reported[1].contains("at any of 115200, 38400"), "{reported:?}");
    }

    #[test]
    fn pipe_without_an_epoch_is_an_error_with_the_words_of_replay() {
        let contact = || Contact::new(&Source::Standard, &Arc::default(), false);
        let words = |contact: Contact| format!("{:#}", contact.end().unwrap_err());
        assert!(words(contact()).contains("is empty: give what a receiver sent"));
        let mut text = contact();
        text.receive(&SENTENCE.repeat(3), 0);
        assert!(words(text).contains("3 lines of NMEA"));
        let mut judged = contact();
        judged.look(Progress { has_epoch: true, ..NOTHING }, 0);
        judged.end().unwrap();
    }
}
