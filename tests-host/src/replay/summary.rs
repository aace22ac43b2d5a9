//! A run in one object: what `replay` prints, in words or as JSON.

use std::collections::BTreeMap;
use std::fmt;

use rai_core::frame::Enu;
use serde::Serialize;

use super::track::{Moment, Track};
use crate::fault::{Fault, Kind};
use crate::recording::Skipped;

/// Counts and errors of a run. Errors, misleading and hazardous epochs are known only where there is a truth; errors
/// are those of protected epochs, since nobody is asked to use the others.
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
    /// Root mean square of the horizontal error of protected epochs, m.
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
    /// Protected epochs whose error exceeds a protection level; `null` without a truth.
    pub misleading: Option<usize>,
    /// Protected epochs whose error exceeds an alert limit; `null` without a truth.
    pub hazardous: Option<usize>,
    /// Epochs in which each satellite was left out.
    pub excluded: BTreeMap<String, usize>,
    /// What became of each injected fault.
    pub injected: Vec<Injected>,
    /// Whether the board said what the host said, byte for byte; `null` where it did not run.
    pub host_target_identical: Option<bool>,
    /// Largest horizontal error of a protected epoch, m.
    pub horizontal_max_m: Option<f64>,
    /// Largest vertical error of a protected epoch, m.
    pub vertical_max_m: Option<f64>,
    /// Largest horizontal protection level, m.
    pub hpl_max_m: Option<f64>,
    /// Largest vertical protection level, m.
    pub vpl_max_m: Option<f64>,
    /// Mean of SSE/dof over all protected epochs in percent: about 100 where the sigmas are right, less where they are
    /// too large.
    pub sigma_check_pct: Option<f64>,
    /// Protected epochs with a truth beside them.
    pub with_truth: usize,
    /// Times that the module complained of a silent line.
    pub stale: usize,
    /// Records of RINEX files that were passed over.
    pub skipped: Skipped,
    /// The module's counters at the end, without those that stand at zero.
    pub counters: BTreeMap<String, u32>,
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
    /// Its size, m; of a ramp the largest reached, `null` of an outage.
    pub bias_m: Option<f64>,
    /// Seconds from its start to the first alert or correct exclusion.
    pub first_alert_or_exclusion_s: Option<f64>,
    /// Epochs in which the faulty satellite was left out.
    pub excluded_epochs: usize,
    /// Epochs protected while another satellite was left out than a faulty one.
    pub wrong_exclusions: usize,
    /// Epochs while it lasted.
    pub epochs: usize,
    /// Of these, protected ones.
    pub protected_epochs: usize,
}

impl Summary {
    /// Sums a run up; `has_truth` says whether anything is known of where the antenna was.
    pub fn of(track: &Track, faults: &[Fault], has_truth: bool) -> Self {
        let judged = has_truth.then_some(0);
        let mut summary =
            Self { epochs: track.len(), misleading: judged, hazardous: judged, ..Self::default() };
        for moment in track {
            summary.count(moment);
        }
        let errors = |part: fn(Enu) -> f64| sorted(track.iter().filter_map(protected_error).map(part));
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
        (summary.horizontal_max_m, summary.vertical_max_m) =
            (quantile(&horizontal, 1.0), quantile(&vertical, 1.0));
        summary.with_truth = horizontal.len();
        let (hpl, vpl) = (levels(|state| state.hpl_m), levels(|state| state.vpl_m));
        (summary.hpl_median_m, summary.vpl_median_m) = (quantile(&hpl, 0.5), quantile(&vpl, 0.5));
        (summary.hpl_max_m, summary.vpl_max_m) = (quantile(&hpl, 1.0), quantile(&vpl, 1.0));
        summary.sigma_check_pct = sigma_check_pct(track);
        summary.injected = faults.iter().map(|fault| injected(fault, faults, track)).collect();
        summary
    }

    fn count(&mut self, moment: &Moment) {
        self.stale += usize::from(moment.stale_s.is_some());
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
        if let Some(error) = protected_error(moment) {
            let add =
                |count: &mut Option<usize>, is: bool| *count = count.map(|count| count + usize::from(is));
            add(&mut self.misleading, exceeds(error, state.hpl_m, state.vpl_m));
            add(&mut self.hazardous, exceeds(error, state.hal_m, state.val_m));
        }
    }
}

/// The error of a position that the module promised to bound.
fn protected_error(moment: &Moment) -> Option<Enu> {
    moment.error.filter(|_| moment.output.as_ref().is_some_and(|output| output.state.is_protected()))
}

/// Mean of SSE/dof over the protected epochs that were tested, in percent.
fn sigma_check_pct(track: &Track) -> Option<f64> {
    let states = track.iter().filter_map(|moment| moment.output.as_ref()).map(|output| &output.state);
    let statistics: Vec<f64> =
        states.filter(|state| state.is_protected()).filter_map(|state| state.statistic).collect();
    rms(&statistics).map(|root| 100.0 * root * root)
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
        bias_m: (!matches!(fault.kind, Kind::Outage)).then_some(largest_m),
        first_alert_or_exclusion_s: noticed.map(|moment| moment.elapsed_s - fault.start_s),
        excluded_epochs: during.iter().filter(|moment| excludes_it(moment)).count(),
        wrong_exclusions: during.iter().filter(|moment| excludes_healthy(moment, faults)).count(),
        epochs: during.len(),
        protected_epochs: during
            .iter()
            .filter(|moment| moment.output.as_ref().is_some_and(|output| output.state.is_protected()))
            .count(),
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

impl fmt::Display for Summary {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let metres = |value: Option<f64>| value.map_or("–".to_owned(), |value| format!("{value:.2} m"));
        writeln!(
            formatter,
            "epochs {}, fixes {}: protected {}, alerts {}, unavailable {}",
            self.epochs, self.fixes, self.protected, self.alerts, self.unavailable
        )?;
        let list = |counts: &mut dyn Iterator<Item = String>| counts.collect::<Vec<_>>().join(", ");
        let reasons = list(&mut self.by_reason.iter().map(|(reason, count)| format!("{reason} {count}")));
        writeln!(formatter, "reasons            {reasons}")?;
        if self.stale > 0 {
            writeln!(formatter, "silences           {} noticed (STALE)", self.stale)?;
        }
        let error =
            |rms, p95, max| format!("{} rms, {} at 95 %, {} most", metres(rms), metres(p95), metres(max));
        match (self.misleading, self.hazardous) {
            (Some(misleading), Some(hazardous)) => {
                let horizontal = error(self.horizontal_rms_m, self.horizontal_p95_m, self.horizontal_max_m);
                let vertical = error(self.vertical_rms_m, self.vertical_p95_m, self.vertical_max_m);
                let known = self.with_truth;
                writeln!(formatter, "error              horizontal {horizontal}")?;
                writeln!(formatter, "                   vertical   {vertical}")?;
                writeln!(
                    formatter,
                    "                   of the {known} protected epochs with a truth beside them"
                )?;
                writeln!(formatter, "misleading {misleading}, hazardous {hazardous} of these")?;
            }
            _ => writeln!(
                formatter,
                "error              unknown: --truth or --truth-csv says where the antenna was"
            )?,
        }
        writeln!(
            formatter,
            "protection levels  HPL {} median, {} most; VPL {} median, {} most",
            metres(self.hpl_median_m),
            metres(self.hpl_max_m),
            metres(self.vpl_median_m),
            metres(self.vpl_max_m)
        )?;
        if let Some(percent) = self.sigma_check_pct {
            writeln!(
                formatter,
                "sigma check        {percent:.0} % (100: the sigmas are right; less: too large)"
            )?;
        }
        let excluded =
            list(&mut self.excluded.iter().map(|(satellite, count)| format!("{satellite} {count}")));
        if !excluded.is_empty() {
            writeln!(formatter, "left out, epochs   {excluded}")?;
        }
        if !self.skipped.is_empty() {
            writeln!(formatter, "records skipped    {}", self.skipped)?;
        }
        self.injected.iter().try_for_each(|fault| writeln!(formatter, "{fault}"))
    }
}

impl fmt::Display for Injected {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (satellite, start_s) = (&self.sat, self.start);
        let Some(bias_m) = self.bias_m else {
            return write!(
                formatter,
                "injected outage of {satellite} from {start_s} s: {} epochs without it, {} of them protected",
                self.epochs, self.protected_epochs
            );
        };
        let noticed =
            self.first_alert_or_exclusion_s.map_or("never".to_owned(), |s| format!("after {s:.1} s"));
        write!(
            formatter,
            "injected {satellite} {bias_m:+.1} m from {start_s} s: noticed {noticed}, excluded in {} epochs, wrong \
             exclusions {}",
            self.excluded_epochs, self.wrong_exclusions
        )
    }
}
