//! Pictures and pages of what the module said.
//!
//! | picture | from |
//! |---|---|
//! | any lines, any bars, with units and legend | [`chart`] |
//! | statistic against threshold, error against protection level, states over time | [`timeline`] |
//! | satellites by azimuth and elevation | [`skyplot`] |
//! | error against protection level, epoch by epoch (Stanford diagram) | [`stanford`] |
//! | one self-contained HTML page | [`page`] |
//! | of any number of epochs, those that a picture needs | [`thinned`] |
//!
//! Every picture is SVG without scripts, fonts or links. On a page it has no ground of its own and
//! its ink is `currentColor`, so that it follows a light or a dark page; as a file it stands on
//! white.

pub mod bars;
pub mod canvas;
pub mod chart;
pub mod page;
pub mod skyplot;
pub mod stanford;
pub mod thinned;
pub mod timeline;

use raim_core::frame::Enu;
use raim_core::satellite::SatelliteId;

use crate::sentence::EpochOutput;

/// May the position be used?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Verdict {
    /// Yes: its error is bounded.
    Protected,
    /// No.
    Alert,
    /// That cannot be told.
    Unavailable,
}

impl Verdict {
    /// The verdict behind the letter of `PRAIS`; what is no known letter promises nothing.
    pub const fn from_letter(letter: char) -> Self {
        match letter {
            'P' => Self::Protected,
            'A' => Self::Alert,
            _ => Self::Unavailable,
        }
    }

    /// In lower-case words.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Protected => "protected",
            Self::Alert => "alert",
            Self::Unavailable => "unavailable",
        }
    }
}

/// What is known of one epoch, from the module's sentences and from the truth. What is unknown is
/// `None`.
#[derive(Clone, Debug, PartialEq)]
pub struct Moment {
    /// Seconds since the first epoch.
    pub time_s: f64,
    /// The module's verdict.
    pub verdict: Verdict,
    /// Why, as the module words it.
    pub reason: String,
    /// Test statistic, dimensionless.
    pub statistic: Option<f64>,
    /// What it was held against, dimensionless.
    pub threshold: Option<f64>,
    /// Horizontal protection level, m.
    pub hpl_m: Option<f64>,
    /// Vertical protection level, m.
    pub vpl_m: Option<f64>,
    /// Horizontal alert limit, m.
    pub hal_m: Option<f64>,
    /// Vertical alert limit, m.
    pub val_m: Option<f64>,
    /// Distance from the truth over the ground, m.
    pub horizontal_error_m: Option<f64>,
    /// Height above the true height, m.
    pub vertical_error_m: Option<f64>,
    /// Level of the integrity pin.
    pub pin_is_high: Option<bool>,
    /// Satellites used.
    pub used: usize,
    /// Satellites left out.
    pub excluded: Vec<SatelliteId>,
}

impl Moment {
    /// What the module said of one epoch, beside the error of its position, east, north, up in m.
    pub fn of(time_s: f64, said: &EpochOutput, error: Option<Enu>, pin_is_high: bool) -> Self {
        let state = &said.state;
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
            excluded: said.excluded.iter().map(|excluded| excluded.satellite).collect(),
        }
    }
}
