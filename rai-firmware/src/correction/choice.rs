//! Choice among the ranges of a satellite.
//!
//! Two frequencies remove the ionosphere, at the price of noise:
//!
//! ```text
//! P = k_a P_a + k_b P_b        k_a = f_a² / (f_a² − f_b²)        k_b = 1 − k_a
//! σ(P) / σ(P_a) = √(k_a² + k_b²)        τ = k_a τ_a + k_b τ_b
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `f` | [`Band::frequency_hz`] | Hz |
//! | `P` | `range_m` | m |
//! | `τ` | [`Ephemeris::group_delay`]: difference between the satellite's clock and the time on that band | s |
//! | `√(k_a² + k_b²)` | `noise_gain` | 1 |
//!
//! Assumes equal noise of both codes, and an ionospheric delay that scales with `1/f²` (the
//! neglected higher orders are below 0.1 m). References: [IS-GPS-200] 20.3.3.3.3, [IS-GPS-705],
//! [OS-SIS-ICD] 5.1.5, [BDS-SIS-B1I] 5.2.4.10, [BDS-SIS-B3I].
//!
//! [IS-GPS-200]: crate#references
//! [IS-GPS-705]: crate#references
//! [OS-SIS-ICD]: crate#references
//! [BDS-SIS-B1I]: crate#references
//! [BDS-SIS-B3I]: crate#references

use raim_core::frame::SPEED_OF_LIGHT_M_S;
use raim_core::internals::numeric::sqrt;
use raim_core::internals::weighting::noise_factor_from_cn0;

use super::{difference_m, root_of_squares, sum_m};
use crate::ephemeris::{Ephemeris, Word};
use crate::raw::{Band, RawSignal};

/// The chosen range of a satellite, corrected for group delays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// Pseudorange, corrected for the group delay but not for the satellite clock, m.
    pub range_m: f64,
    /// Ratio of the noise of the range to that of one code range.
    pub noise_gain: f32,
    /// Ratio of the noise of its weakest signal to that of a strong signal.
    pub weakness: f32,
    /// Standard deviation of a group delay that is not broadcast, or that CNAV corrects, m; 0 for
    /// another one.
    pub uncalibrated_m: f32,
    /// Carriers of the range. If there is only the first, the range still has the ionospheric
    /// delay.
    pub bands: (Band, Option<Band>),
}

/// Speed of light: metres of delay per second.
const LIGHT_M_S: f32 = SPEED_OF_LIGHT_M_S as f32;

/// Two bands whose ranges combine.
struct Pair {
    first: Band,
    second: Band,
    /// Bits of both.
    bands: u16,
    /// Factor `k_a`; `k_b` is `1 − k_a`.
    share: f32,
}

impl Pair {
    const fn of(first: Band, second: Band) -> Self {
        let bands = bit(first) | bit(second);
        Self { first, second, bands, share: ionosphere_free(first, second).0 as f32 }
    }
}

/// Pairs by preference: the pair that the broadcast clock refers to comes first, a pair without a
/// broadcast delay last.
const PAIRS: [Pair; 8] = [
    Pair::of(Band::L1, Band::L2),
    Pair::of(Band::L1, Band::L5),
    Pair::of(Band::E1, Band::E5a),
    Pair::of(Band::E1, Band::E5b),
    Pair::of(Band::B1I, Band::B3I),
    Pair::of(Band::B1I, Band::B2I),
    Pair::of(Band::B1C, Band::B2a),
    // One factor serves all channels, because the two frequencies of each have the ratio 9 to 7.
    Pair::of(Band::G1, Band::G2),
];

/// Single bands by preference.
pub const SINGLES: [Band; 13] = [
    Band::L1,
    Band::L2,
    Band::L5,
    Band::E1,
    Band::E5b,
    Band::E5a,
    Band::B1I,
    Band::B3I,
    Band::B2I,
    Band::B1C,
    Band::B2a,
    Band::G1,
    Band::G2,
];

/// Usable ranges of a satellite: an ionosphere-free pair, one frequency, both, or none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choices {
    /// Best pair.
    pub pair: Option<Choice>,
    /// Best single range.
    pub single: Option<Choice>,
}

impl Choices {
    /// Returns the pair, or else the single range.
    pub fn preferred(&self) -> Option<&Choice> {
        self.pair.as_ref().or(self.single.as_ref())
    }
}

/// Chooses among a satellite's signals those that are in service, strong enough, and related to the
/// broadcast clock.
///
/// Signals whose reported strength is below `mask_dbhz` are left out. `unsaid_dbhz` is the assumed
/// strength of a signal without a report. It is infinite if the receiver never reports strength, so
/// that all signals count as strong.
pub fn choose(signals: &[RawSignal], ephemeris: &Ephemeris, mask_dbhz: f32, unsaid_dbhz: f32) -> Choices {
    choose_by(signals, ephemeris, Word::NOTHING, mask_dbhz, unsaid_dbhz)
}

/// Works like [`choose`], with what CNAV says of the satellite.
pub(super) fn choose_by(
    signals: &[RawSignal],
    ephemeris: &Ephemeris,
    word: Word<'_>,
    mask_dbhz: f32,
    unsaid_dbhz: f32,
) -> Choices {
    let is_usable = |signal: &&RawSignal| {
        let band = signal.carrier.band;
        // A test that is always true would still change the code of an image without CNAV.
        #[cfg(feature = "cnav")]
        if !word.serves(band) {
            return false;
        }
        ephemeris.serves(band) && signal.cn0_dbhz().is_none_or(|strength_dbhz| strength_dbhz >= mask_dbhz)
    };
    // Most pairs and bands belong to other systems; these bits skip them cheaply.
    let bands = signals.iter().fold(0_u16, |bands, signal| bands | bit(signal.carrier.band));
    let find = |band| signals.iter().find(|signal| signal.carrier.band == band).filter(is_usable);
    let pair =
        |pair: &Pair| combine(find(pair.first)?, find(pair.second)?, pair, ephemeris, word, unsaid_dbhz);
    let single = |&band: &Band| alone(find(band)?, ephemeris, word, unsaid_dbhz);
    Choices {
        pair: PAIRS.iter().filter(|pair| pair.bands & !bands == 0).find_map(pair),
        single: SINGLES.iter().filter(|band| bit(**band) & bands != 0).find_map(single),
    }
}

/// Returns the bit of a band.
const fn bit(band: Band) -> u16 {
    1 << band as u16
}

/// Returns the ionosphere-free combination of two signals.
fn combine(
    first: &RawSignal,
    second: &RawSignal,
    pair: &Pair,
    ephemeris: &Ephemeris,
    word: Word<'_>,
    unsaid_dbhz: f32,
) -> Option<Choice> {
    let (delay_first, delay_second) =
        (ephemeris.delay_of(pair.first, first, word)?, ephemeris.delay_of(pair.second, second, word)?);
    // k_a P_a + (1 − k_a) P_b = P_b + k_a (P_a − P_b): the added part is small, so that single
    // precision holds it.
    let delay_s = delay_second.seconds() + pair.share * (delay_first.seconds() - delay_second.seconds());
    let apart_m = difference_m(first.range_m, second.range_m);
    let added_m = pair.share * apart_m - LIGHT_M_S * delay_s;
    // A signal without its code is tracked with the help of the other, and has that signal's
    // strength.
    let strength_dbhz = match (first.is_codeless(), second.is_codeless()) {
        (false, false) => strength(first, unsaid_dbhz).min(strength(second, unsaid_dbhz)),
        (true, _) => strength(second, unsaid_dbhz),
        (_, true) => strength(first, unsaid_dbhz),
    };
    Some(Choice {
        bands: (pair.first, Some(pair.second)),
        range_m: sum_m(second.range_m, 0, added_m),
        noise_gain: sqrt(pair.share * pair.share + (1.0 - pair.share) * (1.0 - pair.share)),
        weakness: noise_factor_from_cn0(Some(strength_dbhz)),
        uncalibrated_m: root_of_squares(
            pair.share * delay_first.uncalibrated_m(),
            (1.0 - pair.share) * delay_second.uncalibrated_m(),
        ),
    })
}

/// Returns the range of one signal.
fn alone(signal: &RawSignal, ephemeris: &Ephemeris, word: Word<'_>, unsaid_dbhz: f32) -> Option<Choice> {
    let delay = ephemeris.delay_of(signal.carrier.band, signal, word)?;
    Some(Choice {
        bands: (signal.carrier.band, None),
        range_m: sum_m(signal.range_m, 0, -LIGHT_M_S * delay.seconds()),
        noise_gain: 1.0,
        weakness: noise_factor_from_cn0(Some(strength(signal, unsaid_dbhz))),
        uncalibrated_m: delay.uncalibrated_m(),
    })
}

/// Returns the strength of a signal, reported or assumed, dB-Hz.
fn strength(signal: &RawSignal, unsaid_dbhz: f32) -> f32 {
    signal.cn0_dbhz().unwrap_or(unsaid_dbhz)
}

/// Returns the two factors `k_a`, `k_b` of the ionosphere-free combination.
pub const fn ionosphere_free(first: Band, second: Band) -> (f64, f64) {
    let (first_hz, second_hz) = (first.frequency_hz(), second.frequency_hz());
    let squared = first_hz * first_hz;
    let k_first = squared / (squared - second_hz * second_hz);
    (k_first, 1.0 - k_first)
}
