//! The receiver's reports of jamming, spoofing, authentication and its own protection levels:
//! `RFStatus`, `GALAuthStatus`, DOP and `RAIMStatistics`.
//!
//! | block | offset | field |
//! |---|---|---|
//! | `RFStatus` | 14, 15 | number and length of the sub-blocks from 20 on, one for each disturbed band |
//! | | 16 | bit 0: signals may be inauthentic; bit 1: the navigation data are |
//! | | +6 | bits 0 to 3: 1 suppressed by a notch, 2 by the wideband filter, 8 not suppressed |
//! | `GALAuthStatus` | 14 | bits 0 to 2: 6 authenticating |
//! | | 20, 28, 36, 44 | u64: satellites of Galileo that take part, and that are authentic; the same of GPS |
//! | DOP | 24, 28 | f32: horizontal and vertical protection level, m |
//! | `RAIMStatistics` | 14 | 0 the test passed, 1 failed, 2 none |
//! | | 16, 20 | f32: horizontal and vertical external reliability level, m |
//!
//! Either flag of `RFStatus` is the highest certainty that a receiver can state. A satellite that
//! takes part and is not authentic is a suspicion. A level that the receiver does not know is
//! −2·10¹⁰.
//!
//! The levels of DOP are those of an augmentation system, those of `RAIMStatistics` the largest
//! effect of an undetected outlier. While DOP has levels, those of `RAIMStatistics` are left out.
//!
//! References: [SBF] 4.2.14, 4.2.10; `pysbf2` 1.0.7; `sbf-tools` 0.4.
//!
//! [SBF]: crate#references

use super::block::Block;
use crate::input::{Jamming, ReceiverLevels, Reporter, SelfReport, Suspicion, Unread};

/// Reads the states of `RFStatus`.
pub(super) fn rf_status(block: &Block<'_>) -> Result<SelfReport, Unread> {
    const HEADER: usize = 20;
    const BAND: usize = 7;
    block.at_least(HEADER)?;
    let (many, bytes) = (usize::from(block.u8(14)), usize::from(block.u8(15)));
    if many > 0 && bytes < BAND {
        return Err(Unread::Malformed);
    }
    block.at_least(HEADER + many * bytes)?;
    let states = (0..many).map(|index| match block.u8(HEADER + index * bytes + 6) & 15 {
        0 => Suspicion::None,
        1 | 2 => Suspicion::Suspected,
        8 => Suspicion::Sure,
        _ => Suspicion::Unknown,
    });
    let is_inauthentic = block.u8(16) & 0b11 != 0;
    Ok(SelfReport::Interference(Jamming {
        reporter: Reporter::Detector,
        jamming: Some(states.fold(Suspicion::None, Suspicion::max)),
        spoofing: Some(if is_inauthentic { Suspicion::Sure } else { Suspicion::None }),
    }))
}

/// Reads the number of authentic satellites of `GALAuthStatus`.
pub(super) fn authentication(block: &Block<'_>) -> Result<SelfReport, Unread> {
    const AUTHENTICATING: u16 = 6;
    block.at_least(52)?;
    let [galileo, authentic, gps, authentic_gps] = [20, 28, 36, 44].map(|at| block.u64(at));
    let is_under_way = block.u16(14) & 7 == AUTHENTICATING;
    let spoofing = match galileo & !authentic | gps & !authentic_gps {
        _ if !is_under_way || galileo | gps == 0 => Suspicion::Unknown,
        0 => Suspicion::None,
        _ => Suspicion::Suspected,
    };
    let signals = (galileo & authentic).count_ones() + (gps & authentic_gps).count_ones();
    // At most 128.
    let signals = if is_under_way { signals as u8 } else { 0 };
    Ok(SelfReport::Authenticity(signals, spoofing))
}

/// Levels that the receiver reports in two blocks.
#[derive(Debug)]
pub(super) struct Levels {
    /// Arrival of the last levels of DOP, ms.
    augmented_ms: Option<u64>,
}

impl Levels {
    /// Time for which levels of DOP count, ms.
    const HOLDS_MS: u64 = 3_000;

    /// Numbers of the frames in `PRAIE`, beyond those of u-blox: horizontal radius twice, and
    /// vertical.
    const OF_DOP: u8 = 10;
    const OF_RAIM: u8 = 11;

    pub(super) const fn new() -> Self {
        Self { augmented_ms: None }
    }

    /// Reads the levels of DOP.
    pub(super) fn dop(&mut self, block: &Block<'_>, came_ms: u64) -> Result<SelfReport, Unread> {
        block.at_least(32)?;
        let levels = levels(Self::OF_DOP, [block.f32(24), block.f32(28)]);
        self.augmented_ms = levels.map(|_| came_ms);
        Ok(SelfReport::Levels(levels))
    }

    /// Reads the levels of `RAIMStatistics`; `None` while DOP has levels.
    pub(super) fn raim(&self, block: &Block<'_>, came_ms: u64) -> Result<Option<SelfReport>, Unread> {
        const PASSED: u8 = 0;
        block.at_least(24)?;
        if self.augmented_ms.is_some_and(|then_ms| came_ms.abs_diff(then_ms) <= Self::HOLDS_MS) {
            return Ok(None);
        }
        let levels = levels(Self::OF_RAIM, [block.f32(16), block.f32(20)]);
        Ok(Some(SelfReport::Levels(levels.filter(|_| block.u8(14) == PASSED))))
    }
}

/// Returns a horizontal and a vertical level, if both are possible. Their risk is not stated.
fn levels(frame: u8, levels_m: [f32; 2]) -> Option<ReceiverLevels> {
    /// Beyond it the level has more digits than its field, and no meaning.
    const MOST_M: f32 = 1e6;
    if !levels_m.iter().all(|level_m| (0.0..MOST_M).contains(level_m)) {
        return None;
    }
    let [horizontal_mm, vertical_mm] = levels_m.map(|level_m| (level_m * 1e3 + 0.5) as u32);
    Some(ReceiverLevels { frame, axes_mm: [horizontal_mm, horizontal_mm, vertical_mm], risk: (0, 0) })
}
