//! A run in one object: what `replay --json` prints.

use std::collections::BTreeMap;

use rai_core::frame::Enu;
use serde::Serialize;

use super::track::{Moment, Track};
use crate::fault::{Fault, Kind};

/// Counts and errors of a run. Errors and misleading epochs are known only where there is a truth.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Summary {
    /// Epochs sent to the module.
    pub epochs: usize,
    /// Epochs with a position.
    pub fixes: usize,
    /// Epochs with state P.
    pub protected: usize,
    /// Epochs with state A.
    pub alerts: usize,
    /// Epochs with state U.
    pub unavailable: usize,
    /// Epochs by reason.
    pub by_reason: BTreeMap<String, usize>,
    /// Root mean square of the horizontal error, m.
    pub horizontal_rms_m: Option<f64>,
    /// Root mean square of the vertical error, m.
    pub vertical_rms_m: Option<f64>,
    /// 95th percentile of the horizontal error, m.
    pub horizontal_p95_m: Option<f64>,
    /// 95th percentile of the vertical error, m.
    pub vertical_p95_m: Option<f64>,
    /// Median horizontal protection level, m.
    pub hpl_median_m: Option<f64>,
    /// Median vertical protection level, m.
    pub vpl_median_m: Option<f64>,
    /// Protected epochs whose error exceeds a protection level.
    pub misleading: usize,
    /// Protected epochs whose error exceeds an alert limit.
    pub hazardous: usize,
    /// Epochs in which each satellite was left out.
    pub excluded: BTreeMap<String, usize>,
    /// What became of each injected fault.
    pub injected: Vec<Injected>,
    /// Whether the board said what the host said, byte for byte; `null` where it did not run.
    pub host_target_identical: Option<bool>,
}

/// What became of one injected fault.
#[derive(Clone, Debug, Serialize)]
pub struct Injected {
    /// Whom it befell, as written on the command line.
    pub sat: String,
    /// When it began, seconds after the first epoch.
    pub start: f64,
    /// When it ended; `null` where it did not.
    pub end: Option<f64>,
    /// Its size, m; of a ramp the largest reached, of an outage 0.
    pub bias_m: f64,
    /// Seconds from its start to the first alert or correct exclusion.
    pub first_alert_or_exclusion_s: Option<f64>,
    /// Epochs in which the faulty satellite was left out.
    pub excluded_epochs: usize,
    /// Epochs protected while another satellite was left out than a faulty one.
    pub wrong_exclusions: usize,
}

impl Summary {
    /// Sums a run up.
    pub fn of(track: &Track, faults: &[Fault]) -> Self {
        let mut summary = Self { epochs: track.len(), ..Self::default() };
        for moment in track {
            summary.count(moment);
        }
        let errors = |part: fn(Enu) -> f64| sorted(track.iter().filter_map(|moment| moment.error.map(part)));
        let levels = |part: fn(&crate::sentence::State) -> Option<f64>| {
            sorted(
                track
                    .iter()
                    .filter_map(|moment| moment.output.as_ref().and_then(|output| part(&output.state))),
            )
        };
        let (horizontal, vertical) = (errors(Enu::horizontal), errors(|error| error.up.abs()));
        summary.horizontal_rms_m = rms(&horizontal);
        summary.vertical_rms_m = rms(&vertical);
        summary.horizontal_p95_m = quantile(&horizontal, 0.95);
        summary.vertical_p95_m = quantile(&vertical, 0.95);
        summary.hpl_median_m = quantile(&levels(|state| state.hpl_m), 0.5);
        summary.vpl_median_m = quantile(&levels(|state| state.vpl_m), 0.5);
        summary.injected = faults.iter().map(|fault| injected(fault, faults, track)).collect();
        summary
    }

    fn count(&mut self, moment: &Moment) {
        let Some(output) = &moment.output else { return };
        let state = &output.state;
        self.fixes += usize::from(output.position.is_some());
        match state.state {
            'P' => self.protected += 1,
            'A' => self.alerts += 1,
            _ => self.unavailable += 1,
        }
        *self.by_reason.entry(state.reason.clone()).or_default() += 1;
        for excluded in &output.excluded {
            *self.excluded.entry(excluded.satellite.to_string()).or_default() += 1;
        }
        if let Some(error) = moment.error.filter(|_| state.is_protected()) {
            self.misleading += usize::from(exceeds(error, state.hpl_m, state.vpl_m));
            self.hazardous += usize::from(exceeds(error, state.hal_m, state.val_m));
        }
    }
}

/// True when an error is beyond one of two bounds that are given.
fn exceeds(error: Enu, horizontal_m: Option<f64>, vertical_m: Option<f64>) -> bool {
    horizontal_m.is_some_and(|bound_m| error.horizontal() > bound_m)
        || vertical_m.is_some_and(|bound_m| error.up.abs() > bound_m)
}

fn injected(fault: &Fault, faults: &[Fault], track: &Track) -> Injected {
    let during: Vec<&Moment> = track.iter().filter(|moment| fault.is_active(moment.elapsed_s)).collect();
    let excludes_it = |moment: &Moment| {
        moment.output.as_ref().is_some_and(|output| {
            output.excluded.iter().any(|excluded| fault.target.covers(excluded.satellite))
        })
    };
    let alerts = |moment: &Moment| moment.output.as_ref().is_some_and(|output| output.state.state == 'A');
    let noticed = during.iter().find(|moment| excludes_it(moment) || alerts(moment));
    let largest_m = during.iter().map(|moment| fault.bias_m(moment.elapsed_s)).fold(0.0, largest_magnitude);
    Injected {
        sat: fault.target.to_string(),
        start: fault.start_s,
        end: Some(fault.end_s).filter(|end_s| end_s.is_finite()),
        bias_m: if matches!(fault.kind, Kind::Outage) { 0.0 } else { largest_m },
        first_alert_or_exclusion_s: noticed.map(|moment| moment.elapsed_s - fault.start_s),
        excluded_epochs: during.iter().filter(|moment| excludes_it(moment)).count(),
        wrong_exclusions: during.iter().filter(|moment| excludes_healthy(moment, faults)).count(),
    }
}

/// True when a protected epoch leaves out a satellite that no fault befalls.
fn excludes_healthy(moment: &Moment, faults: &[Fault]) -> bool {
    let faulty = |satellite| {
        faults.iter().any(|fault| fault.is_active(moment.elapsed_s) && fault.target.covers(satellite))
    };
    moment.output.as_ref().is_some_and(|output| {
        output.state.is_protected() && output.excluded.iter().any(|excluded| !faulty(excluded.satellite))
    })
}

fn largest_magnitude(largest: f64, value: f64) -> f64 {
    if value.abs() > largest.abs() { value } else { largest }
}

fn sorted(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values
}

fn rms(values: &[f64]) -> Option<f64> {
    let squares: f64 = values.iter().map(|value| value * value).sum();
    (!values.is_empty()).then(|| (squares / values.len() as f64).sqrt())
}

/// The value below which that share of the sorted values lies.
fn quantile(sorted: &[f64], share: f64) -> Option<f64> {
    let index = (share * sorted.len().saturating_sub(1) as f64).round() as usize;
    sorted.get(index).copied()
}
