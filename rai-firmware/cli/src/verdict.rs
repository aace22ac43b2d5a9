//! What the module reports of an epoch or a silence, in the digits of its sentences.
//!
//! ```text
//! module in process ─► Judged, WithoutEpoch ─┐
//!                                            ├─► EpochOutput ─► tables, pages, summaries
//! module behind a wire ─► sentences ─────────┘
//! ```
//!
//! A module in process is read through its observer. Its numbers are rounded here, by
//! [`Figures`], as its sentences round them, so that both ways give equal values.

use raim_core::frame::Geodetic;
use raim_core::report::{Suspect, Verdict};
use raim_core::satellite::SatelliteId;
use raim_firmware::observer::{Figures, Judged, WithoutEpoch};
use raim_firmware::output::nmea::TimeOfDay;

/// Verdict with its numbers. Unknown ones are `None`.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Time of day in UTC, s; `None` before the first epoch.
    pub time_s: Option<f64>,
    /// `P`, `A` or `U`.
    pub state: char,
    /// Reason, as in the interface.
    pub reason: String,
    /// Number of satellites tracked.
    pub tracked: u32,
    /// Number of satellites used.
    pub used: u32,
    /// Degrees of freedom, if there was a test.
    pub dof: Option<u32>,
    /// Test statistic `√(SSE/dof)`.
    pub statistic: Option<f64>,
    /// Threshold of the statistic.
    pub threshold: Option<f64>,
    /// Horizontal protection level, m.
    pub hpl_m: Option<f64>,
    /// Vertical protection level, m.
    pub vpl_m: Option<f64>,
    /// Horizontal alert limit, m.
    pub hal_m: Option<f64>,
    /// Vertical alert limit, m.
    pub val_m: Option<f64>,
}

impl State {
    /// Returns a verdict without satellites.
    fn of(verdict: Verdict, utc: Option<TimeOfDay>, figures: &Figures) -> Self {
        let (state, reason) = verdict.words();
        Self {
            time_s: utc.map(TimeOfDay::second_of_day),
            state: state.chars().next().unwrap_or('U'),
            reason: reason.to_owned(),
            tracked: 0,
            used: 0,
            dof: None,
            statistic: figures.statistic,
            threshold: figures.threshold,
            hpl_m: figures.hpl_m,
            vpl_m: figures.vpl_m,
            hal_m: figures.hal_m,
            val_m: figures.val_m,
        }
    }

    /// Returns true if the position may be used.
    pub fn is_protected(&self) -> bool {
        self.state == 'P'
    }

    /// Returns true if an error, horizontal and vertical, m, is larger than a level. A missing
    /// level bounds nothing.
    pub fn is_misleading(&self, [horizontal_m, vertical_m]: [f64; 2]) -> bool {
        self.hpl_m.is_none_or(|level_m| horizontal_m > level_m)
            || self.vpl_m.is_none_or(|level_m| vertical_m > level_m)
    }

    /// Returns true if an error, horizontal and vertical, m, is larger than a limit in force.
    pub fn is_hazardous(&self, [horizontal_m, vertical_m]: [f64; 2]) -> bool {
        self.hal_m.is_some_and(|limit_m| horizontal_m > limit_m)
            || self.val_m.is_some_and(|limit_m| vertical_m > limit_m)
    }

    /// Returns false for a verdict that no epoch brought: of a silence, or of settings that have
    /// changed under a promise.
    pub fn has_epoch(&self) -> bool {
        self.reason != "STALE" && !(self.reason == "SETTINGS" && self.tracked == 0)
    }
}

/// A satellite left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Excluded {
    /// Name of the satellite.
    pub satellite: SatelliteId,
    /// W-test of its range at the time of exclusion.
    pub w_test: f64,
    /// Estimated bias of its range, m.
    pub bias_m: f64,
}

impl From<&Suspect> for Excluded {
    fn from(suspect: &Suspect) -> Self {
        let [w_test, bias_m] = Figures::of_suspect(suspect);
        Self { satellite: suspect.satellite, w_test, bias_m }
    }
}

/// What is known of Galileo's ephemerides.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "commands", derive(serde::Serialize))]
pub struct Authentication {
    /// State, as in the interface.
    pub state: String,
    /// Satellites in view whose ephemerides are proved.
    pub proved: u32,
    /// Those whose ephemerides are not.
    pub unproved: u32,
    /// Those whose ephemerides are false.
    #[cfg_attr(feature = "commands", serde(rename = "false"))]
    pub wrong: u32,
    /// Age of the oldest proof, s; `None` without a proof.
    pub oldest_proof_s: Option<u32>,
}

impl Authentication {
    fn of(judged: &Judged<'_>) -> Option<Self> {
        let (standing, summary) = judged.authentication()?;
        Some(Self {
            state: standing.word().to_owned(),
            proved: summary.proved.into(),
            unproved: summary.unproved.into(),
            wrong: summary.false_.into(),
            oldest_proof_s: summary.oldest_proof_s,
        })
    }
}

/// Report on one epoch, or on a silence.
#[derive(Clone, Debug, PartialEq)]
pub struct EpochOutput {
    /// Position, `None` without a fix.
    pub position: Option<Geodetic>,
    /// Verdict of the epoch.
    pub state: State,
    /// Satellites left out.
    pub excluded: Vec<Excluded>,
    /// What is known of Galileo's ephemerides; `None` without a key.
    pub authentication: Option<Authentication>,
}

impl From<&Judged<'_>> for EpochOutput {
    fn from(judged: &Judged<'_>) -> Self {
        let (report, figures) = (judged.report(), judged.figures());
        let state = State {
            tracked: report.tracked.into(),
            used: report.used.len() as u32,
            dof: report.test.map(|test| test.dof.into()),
            ..State::of(report.verdict, Some(judged.utc()), &figures)
        };
        Self {
            position: figures.position,
            state,
            excluded: report.excluded.iter().map(Excluded::from).collect(),
            authentication: Authentication::of(judged),
        }
    }
}

impl From<&WithoutEpoch<'_>> for EpochOutput {
    fn from(judged: &WithoutEpoch<'_>) -> Self {
        let state = State::of(judged.verdict, judged.utc(), &judged.figures());
        Self { position: None, state, excluded: Vec::new(), authentication: None }
    }
}
