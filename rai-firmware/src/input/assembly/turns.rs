//! Detection of two receivers that take turns on one line, by their ranges alone.
//!
//! The ranges of one antenna change almost linearly from epoch to epoch: they bend little. If two
//! antennas take turns, their ranges bend to and fro, by the same amounts:
//!
//! ```text
//! b = P₁ − (P₀ t₂ + P₂ t₁) / (t₁ + t₂)        e = b − median of b
//! s = median of |e|        e is then limited to ±4 s
//! in turn if  s > 4 m,  s' > 4 m,  (Σ e e')² > 0.95 Σ e² Σ e'²,  Σ e e' < 0
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | `P₀, P₁, P₂` | ranges of one satellite on one band in three epochs in a row | m |
//! | `t₁, t₂` | time from the first epoch to the second, and from the second to the third | ms |
//! | `b`, `e` | bend of the range, with and without that of the receiver clock | m |
//! | `e'`, `s'` | the same for the epoch before | m |
//!
//! Whole milliseconds are first removed from each step, because receiver clocks jump by them. The
//! acceleration of a satellite bends a range by 0.1 m in a second. A step of the antenna bends it
//! to and fro once, so that a single turn is only a suspicion. Two turns in a row prove another
//! receiver. White noise alone gives a correlation of −2/3. With eight satellites it exceeds the
//! bound by chance in one epoch of a thousand.
//!
//! **Limits.** The first epoch of the other receiver cannot be compared with an earlier one.
//! Antennas less than some ten metres apart are not detected, nor are epochs more than
//! [`LONGEST_MS`] apart.

use heapless::Vec;
use raim_core::frame::SPEED_OF_LIGHT_M_S;
use raim_core::satellite::SatelliteId;

use crate::ephemeris::nearest;
use crate::input::Rivalry;
use crate::median::{apart_m, median};
use crate::raw::{Band, RawEpoch};
use crate::time::GpsTime;

/// Most satellites whose bends are compared.
const TRACKS: usize = if cfg!(feature = "signs") { 16 } else { 1 };

/// Least number of satellites for a detection.
const LEAST_TRACKS: usize = 5;

/// Longest time between two epochs whose ranges are compared, ms. In a longer time a turning
/// vehicle bends its ranges as much.
const LONGEST_MS: i64 = 1500;

/// Least median of the bends, m. The median excludes faults of some satellites, which do not bend
/// the other ranges.
const LEAST_M: f32 = 4.0;

/// Multiple of that median to which a bend is limited, so that no single bend decides.
const MOST_SPREADS: f32 = 4.0;

/// Least share of one bend that the other explains: the square of their correlation.
const EXPLAINED: f32 = 0.95;

/// Resolution of a stored range, steps per metre, as a power of two.
const STEPS_POWER: i32 = 9;

/// Length of a step, m.
const STEP_M: f32 = 1.0 / (1 << STEPS_POWER) as f32;

/// Range that light travels in a millisecond, m.
const MILLISECOND_M: f32 = (SPEED_OF_LIGHT_M_S * 1e-3) as f32;

/// Ranges of a satellite, as far as bends need them.
#[derive(Clone, Copy, Debug)]
struct Track {
    satellite: SatelliteId,
    band: Band,
    /// Last range modulo 2³² steps.
    range: u32,
    /// Last step of the range relative to that of the first satellite, m; NaN if unknown.
    step_m: f32,
    /// Last bend of the range without that of the clock, m. NaN if it is unknown, or if too few
    /// bends are known or large.
    bend_m: f32,
}

/// Memory of the last epochs.
#[derive(Debug)]
pub(super) struct Turns {
    tracks: Vec<Track, TRACKS, u8>,
    last: GpsTime,
    step_ms: f32,
    /// Number of turns in a row.
    in_a_row: u8,
}

/// Sums over the bends of an epoch, and over those of the epoch before.
#[derive(Default)]
struct Sums {
    count: u8,
    now_squared: f32,
    before_squared: f32,
    product: f32,
}

impl Sums {
    fn add(&mut self, before: f32, now: f32) {
        self.count = self.count.saturating_add(1);
        self.now_squared += now * now;
        self.before_squared += before * before;
        self.product += before * now;
    }

    /// Returns true if the bends of both epochs have similar sizes and opposite signs.
    fn is_turn(&self) -> bool {
        usize::from(self.count) >= LEAST_TRACKS
            && self.product < 0.0
            && self.product * self.product > EXPLAINED * self.now_squared * self.before_squared
    }
}

impl Turns {
    /// Returns the memory of no epoch.
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub(super) const fn new() -> Self {
        Self { tracks: Vec::new(), last: GpsTime { week: 0, tow_ms: 0 }, step_ms: 0.0, in_a_row: 0 }
    }

    /// Compares an epoch with those before it.
    // Not inlined: the copy of the tracks leaves the stack before the epoch is judged.
    #[inline(never)]
    pub(super) fn take(&mut self, epoch: &RawEpoch) -> Option<Rivalry> {
        let step_ms = epoch.time.since_ms(self.last);
        let is_near = (1..=LONGEST_MS).contains(&step_ms);
        let (before_ms, now_ms) = (self.step_ms, step_ms as f32);
        let mut tracks = Vec::<Track, TRACKS, u8>::new();
        let (mut before, mut bends) = (Vec::<f32, TRACKS>::new(), Vec::<f32, TRACKS>::new());
        let mut first = None;
        for raw in &epoch.satellites {
            let Some(signal) = raw.signals.first() else { continue };
            let band = signal.carrier.band;
            let mut track = Track {
                satellite: raw.satellite,
                band,
                // Only the last digits of a range are needed.
                range: nearest(signal.range_m, STEPS_POWER) as u32,
                step_m: f32::NAN,
                bend_m: f32::NAN,
            };
            let mut before_m = f32::NAN;
            let is_same = |known: &&Track| known.satellite == raw.satellite && known.band == band;
            if is_near
                && let Some(known) =
                    self.known(tracks.len()).filter(is_same).or_else(|| self.tracks.iter().find(is_same))
            {
                let moved = track.range.wrapping_sub(known.range);
                let apart = moved.wrapping_sub(*first.get_or_insert(moved)).cast_signed();
                track.step_m = without_milliseconds(apart as f32 * STEP_M);
                track.bend_m = (known.step_m * now_ms - track.step_m * before_ms) / (before_ms + now_ms);
                before_m = known.bend_m;
                if track.bend_m.is_finite() {
                    let _ = bends.push(track.bend_m);
                }
            }
            let _ = before.push(before_m);
            if tracks.push(track).is_err() {
                break;
            }
        }
        (self.tracks, self.last, self.step_ms) = (tracks, epoch.time, now_ms);
        self.in_a_row = if self.turns(&before, &bends) { self.in_a_row.saturating_add(1) } else { 0 };
        match self.in_a_row {
            0 => None,
            1 => Some(Rivalry::Suspected),
            _ => Some(Rivalry::Receivers),
        }
    }

    /// Centres the bends of the tracks; returns true if they are those of the epoch before with the
    /// opposite sign.
    fn turns(&mut self, before: &[f32], bends: &[f32]) -> bool {
        // Cheap test first: the bends of one antenna are mostly this close together.
        if bends.len() < LEAST_TRACKS || apart_m(bends) <= LEAST_M {
            self.tracks.iter_mut().for_each(|track| track.bend_m = f32::NAN);
            return false;
        }
        let middle_m = median(bends);
        let deviations: Vec<f32, TRACKS> =
            bends.iter().take(TRACKS).map(|bend_m| (bend_m - middle_m).abs()).collect();
        let spread_m = median(&deviations);
        let is_large = spread_m > LEAST_M;
        let most_m = MOST_SPREADS * spread_m;
        let mut sums = Sums::default();
        for (track, before_m) in self.tracks.iter_mut().zip(before) {
            let bend_m = track.bend_m - middle_m;
            // Written so that NaN stays.
            let within_m = if bend_m.abs() > most_m { most_m.copysign(bend_m) } else { bend_m };
            track.bend_m = if is_large { within_m } else { f32::NAN };
            if track.bend_m.is_finite() && before_m.is_finite() {
                sums.add(*before_m, track.bend_m);
            }
        }
        sums.is_turn()
    }

    /// Returns the track at this index in the epoch before, which mostly is of the same satellite.
    fn known(&self, index: usize) -> Option<&Track> {
        self.tracks.get(index)
    }
}

/// Returns a step without the whole milliseconds of a clock jump, m.
fn without_milliseconds(step_m: f32) -> f32 {
    if step_m.abs() < 0.5 * MILLISECOND_M {
        return step_m;
    }
    step_m - libm::roundf(step_m / MILLISECOND_M) * MILLISECOND_M
}
