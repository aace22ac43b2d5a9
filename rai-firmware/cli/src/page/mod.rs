//! Pictures and pages of the module's output.
//!
//! | picture | module |
//! |---|---|
//! | any lines, any bars, with units and legend | [`chart`] |
//! | statistic against threshold, error against protection level, states over time | [`timeline`] |
//! | satellites by azimuth and elevation | [`skyplot`] |
//! | error against protection level, epoch by epoch (Stanford diagram) | [`stanford`] |
//! | colours, and their difference for every reader | [`palette`] |
//! | one self-contained HTML page | [`html`] |
//! | the state of a running module, for a page that shows it live | [`live`] |
//! | the report of `replay`, `run` and `demo`: what happened when, and why | [`report`] |
//! | epochs that a picture needs, out of any number | [`thinned`] |
//!
//! Every picture is SVG without scripts, fonts or links. On a page it has no background and takes
//! the page's colours, so that it follows a light or a dark page; as a file it has a white
//! background. Only the report has a script, which replaces some of its pictures by ones that can
//! be zoomed.

pub mod bars;
pub mod canvas;
pub mod chart;
mod dashes;
mod decades;
pub mod html;
pub mod live;
pub mod palette;
pub mod report;
pub mod skyplot;
pub mod stanford;
pub mod thinned;
pub mod timeline;
#[cfg(test)]
mod vision;

use raim_core::frame::Enu;
use raim_core::satellite::SatelliteId;

use crate::verdict::EpochOutput;

/// Verdict on the use of a position.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Verdict {
    /// The position may be used, because its error is bounded.
    Protected,
    /// The position must not be used.
    Alert,
    /// The use of the position is unknown.
    Unavailable,
}

impl Verdict {
    /// Returns the verdict for the letter of `PRAIS`; an unknown letter is unavailable.
    pub const fn from_letter(letter: char) -> Self {
        match letter {
            'P' => Self::Protected,
            'A' => Self::Alert,
            _ => Self::Unavailable,
        }
    }

    /// Returns the verdict in lower case.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Protected => "protected",
            Self::Alert => "alert",
            Self::Unavailable => "unavailable",
        }
    }
}

/// Facts of one epoch, from the module's sentences and from the truth. Unknown ones are `None`.
#[derive(Clone, Debug, PartialEq)]
pub struct Moment {
    /// Seconds since the first epoch.
    pub time_s: f64,
    /// Verdict of the module.
    pub verdict: Verdict,
    /// Reason, in the module's word.
    pub reason: String,
    /// Test statistic, dimensionless.
    pub statistic: Option<f64>,
    /// Threshold of the statistic, dimensionless.
    pub threshold: Option<f64>,
    /// Horizontal protection level, m.
    pub hpl_m: Option<f64>,
    /// Vertical protection level, m.
    pub vpl_m: Option<f64>,
    /// Horizontal alert limit, m.
    pub hal_m: Option<f64>,
    /// Vertical alert limit, m.
    pub val_m: Option<f64>,
    /// Horizontal distance from the truth, m.
    pub horizontal_error_m: Option<f64>,
    /// Height above the true height, m.
    pub vertical_error_m: Option<f64>,
    /// Level of the integrity pin.
    pub pin_is_high: Option<bool>,
    /// Satellites used.
    pub used: usize,
    /// Satellites excluded.
    pub excluded: Vec<SatelliteId>,
}

impl Moment {
    /// Returns the moment of one epoch, from its output and from the error of its position, east,
    /// north, up in m.
    pub fn of(time_s: f64, reported: &EpochOutput, error: Option<Enu>, pin_is_high: bool) -> Self {
        let state = &reported.state;
        Self {
            time_s,
            verdict: Verdict::from_letter(state.state),
            reason: state.reason.clone(),
            statistic: state.statistic,
            threshold: state.threshold,
            hpl_m: state.hpl_m,
            vpl_m: state.vpl_m,
            hal_m: state.hal_m,
            val_m: state.val_m,
            horizontal_error_m: error.map(Enu::horizontal),
            vertical_error_m: error.map(|error| error.up),
            pin_is_high: Some(pin_is_high),
            used: state.used as usize,
            excluded: reported.excluded.iter().map(|excluded| excluded.satellite).collect(),
        }
    }
}
