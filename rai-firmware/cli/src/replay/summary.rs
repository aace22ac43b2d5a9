//! Summary of a run, which `replay` prints in words or as JSON.

use std::collections::BTreeMap;
use std::fmt;

use raim_core::frame::Enu;
use raim_firmware::output::geoid::Altitude;

use super::injected::Injected;
use super::quantiles::Quantiles;
use super::track::{Moment, Track};
use crate::outcomes::{Outcome, Outcomes};
use crate::satellites::View;
use crate::signal::fault::Fault;
use crate::signal::skipped::Skipped;
use crate::verdict::Authentication;

/// Counts and errors of a run. Errors, misleading and hazardous epochs are known only with a truth.
/// Errors are those of protected epochs, because the others must not be used.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "commands", derive(serde::Serialize))]
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
    /// Epochs in which each satellite was excluded.
    pub excluded: BTreeMap<String, usize>,
    /// Epochs by the state of OSNMA; empty without a key.
    pub osnma_by_state: BTreeMap<String, usize>,
    /// What was known of Galileo's ephemerides in the last epoch; `null` without a key.
    pub osnma_last: Option<Authentication>,
    /// Largest number of satellites with false ephemerides in an epoch.
    pub osnma_most_false: u32,
    /// Outcome of each injected fault.
    pub injected: Vec<Injected>,
    /// True if the board's sentences equal the host's byte for byte; `null` if it did not run.
    pub host_target_identical: Option<bool>,
    /// Largest horizontal error of a protected epoch, m.
    pub horizontal_max_m: Option<f64>,
    /// Largest vertical error of a protected epoch, m.
    pub vertical_max_m: Option<f64>,
    /// Largest horizontal protection level, m.
    pub hpl_max_m: Option<f64>,
    /// Largest vertical protection level, m.
    pub vpl_max_m: Option<f64>,
    /// Mean of SSE/dof over all protected epochs in percent, under every method: about 100 if the
    /// sigmas are right, less if they are too large.
    pub sigma_check_pct: Option<f64>,
    /// Protected epochs with a truth.
    pub with_truth: usize,
    /// Height of the geoid above the ellipsoid, m, if the heights of the truth look like altitudes
    /// above sea level: the errors are as large as that; else `null`.
    pub truth_looks_above_sea_m: Option<f64>,
    /// Number of alerts for a silent line.
    pub stale: usize,
    /// Records of RINEX files that were skipped.
    pub skipped: Skipped,
    /// Number of refused ephemerides of each satellite: with a value that no satellite sends, or an
    /// orbit that its system does not have.
    pub refused_orbits: BTreeMap<String, u32>,
    /// Counters of the module at the end, without those that are zero.
    pub counters: BTreeMap<String, u32>,
}

impl Summary {
    /// Summarises a run; `has_truth` is true if the position of the antenna is known.
    pub fn of(track: &Track, faults: &[Fault], has_truth: bool) -> Self {
        let mut running = RunningSummary::new(faults, has_truth);
        for moment in track {
            running.count(moment);
        }
        running.summary()
    }
}

/// Summary that grows epoch by epoch. Its memory does not grow with the run, except for the
/// quantiles up to their bound.
#[derive(Clone, Debug)]
pub struct RunningSummary {
    summary: Summary,
    outcomes: Outcomes,
    has_truth: bool,
    horizontal: Quantiles,
    vertical: Quantiles,
    hpl: Quantiles,
    vpl: Quantiles,
    /// Sum and number of SSE/dof of protected epochs.
    ratios: (f64, usize),
    faults: Vec<Fault>,
    /// Sum of the vertical errors of protected epochs, m.
    up_m: f64,
    /// Height of the geoid above the ellipsoid where the first of them was, m.
    geoid_m: Option<f64>,
}

impl RunningSummary {
    /// Returns the summary of no epoch; `has_truth` is true if the position of the antenna is
    /// known.
    pub fn new(faults: &[Fault], has_truth: bool) -> Self {
        let injected = faults.iter().map(Injected::of).collect();
        Self {
            summary: Summary { injected, ..Summary::default() },
            outcomes: Outcomes::default(),
            has_truth,
            horizontal: Quantiles::default(),
            vertical: Quantiles::default(),
            hpl: Quantiles::default(),
            vpl: Quantiles::default(),
            ratios: (0.0, 0),
            faults: faults.to_vec(),
            up_m: 0.0,
            geoid_m: None,
        }
    }

    /// Counts an epoch.
    pub fn count(&mut self, moment: &Moment) {
        self.summary.count(moment);
        if let Some(outcome) = outcome(moment) {
            self.outcomes.add(outcome);
        }
        for (injected, fault) in self.summary.injected.iter_mut().zip(&self.faults) {
            if fault.is_active(moment.elapsed_s) {
                injected.count(fault, &self.faults, moment);
            }
        }
        if let Some(error) = protected_error(moment) {
            self.horizontal.count(error.horizontal());
            self.vertical.count(error.up.abs());
            self.up_m += error.up;
            let place = moment.output.as_ref().and_then(|output| output.position);
            self.geoid_m = self.geoid_m.or_else(|| Some(Altitude::of(&place?).separation_m));
        }
        let Some(state) = moment.output.as_ref().map(|output| &output.state) else { return };
        state.hpl_m.into_iter().for_each(|hpl_m| self.hpl.count(hpl_m));
        state.vpl_m.into_iter().for_each(|vpl_m| self.vpl.count(vpl_m));
        if let Some(ratio) = moment.variance_ratio.filter(|_| state.is_protected()) {
            self.ratios = (self.ratios.0 + ratio, self.ratios.1 + 1);
        }
    }

    /// Takes the view of an epoch, so many seconds after the first: what became of faulty satellites.
    pub(super) fn look(&mut self, view: &View, elapsed_s: f64) {
        for (injected, fault) in self.summary.injected.iter_mut().zip(&self.faults) {
            if fault.is_active(elapsed_s) {
                injected.look(fault, view);
            }
        }
    }

    /// Returns true if the mean vertical error is the height of the geoid to a third, that height
    /// exceeds what positions are off by, and the horizontal errors are small beside it.
    fn looks_above_sea(&self, geoid_m: f64) -> bool {
        const LEAST_M: f64 = 10.0;
        let count = self.vertical.len();
        let mean_m = self.up_m / count.max(1) as f64;
        let horizontal_m = self.horizontal.rms().unwrap_or(f64::INFINITY);
        geoid_m.abs() >= LEAST_M
            && (mean_m - geoid_m).abs() < geoid_m.abs() / 3.0
            && horizontal_m < geoid_m.abs() / 2.0
    }

    /// Returns the number of epochs counted so far.
    pub fn epochs(&self) -> usize {
        self.summary.epochs
    }

    /// Returns the summary of the epochs.
    pub fn summary(&self) -> Summary {
        let Self { horizontal, vertical, hpl, vpl, .. } = self;
        let Outcomes { promised, alerts, unavailable, misleading, hazardous } = self.outcomes;
        Summary {
            protected: promised,
            alerts,
            unavailable,
            misleading: self.has_truth.then_some(misleading),
            hazardous: self.has_truth.then_some(hazardous),
            horizontal_rms_m: horizontal.rms(),
            vertical_rms_m: vertical.rms(),
            horizontal_p95_m: horizontal.quantile(0.95),
            vertical_p95_m: vertical.quantile(0.95),
            horizontal_max_m: horizontal.most(),
            vertical_max_m: vertical.most(),
            hpl_median_m: hpl.quantile(0.5),
            vpl_median_m: vpl.quantile(0.5),
            hpl_max_m: hpl.most(),
            vpl_max_m: vpl.most(),
            sigma_check_pct: (self.ratios.1 > 0).then(|| 100.0 * self.ratios.0 / self.ratios.1 as f64),
            with_truth: horizontal.len(),
            truth_looks_above_sea_m: self.geoid_m.filter(|geoid_m| self.looks_above_sea(*geoid_m)),
            ..self.summary.clone()
        }
    }
}

impl Summary {
    fn count(&mut self, moment: &Moment) {
        self.epochs += 1;
        self.stale += usize::from(moment.stale_s.is_some());
        let Some(output) = &moment.output else { return };
        let state = &output.state;
        self.fixes += usize::from(output.position.is_some());
        *self.by_reason.entry(state.reason.clone()).or_default() += 1;
        if let Some(authentication) = &output.authentication {
            *self.osnma_by_state.entry(authentication.state.clone()).or_default() += 1;
            self.osnma_most_false = self.osnma_most_false.max(authentication.wrong);
            self.osnma_last = Some(authentication.clone());
        }
        for excluded in &output.excluded {
            *self.excluded.entry(excluded.satellite.to_string()).or_default() += 1;
        }
    }
}

/// Returns the outcome of an epoch; `None` without a report. Without an error no promise is broken.
fn outcome(moment: &Moment) -> Option<Outcome> {
    let state = &moment.output.as_ref()?.state;
    Some(match state.state {
        'P' => {
            let error_m = moment.error.map(|error| [error.horizontal(), error.up.abs()]);
            Outcome::Promised {
                is_misleading: error_m.is_some_and(|error_m| state.is_misleading(error_m)),
                is_hazardous: error_m.is_some_and(|error_m| state.is_hazardous(error_m)),
            }
        }
        'A' => Outcome::Alert,
        _ => Outcome::Unavailable,
    })
}

/// Returns the error of a protected position.
fn protected_error(moment: &Moment) -> Option<Enu> {
    moment.error.filter(|_| moment.output.as_ref().is_some_and(|output| output.state.is_protected()))
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
                if let Some(geoid_m) = self.truth_looks_above_sea_m {
                    writeln!(
                        formatter,
                        "note: the vertical error is about the height of the geoid here, {geoid_m:.1} m: the truth seems to have \
                         altitudes above sea level, and heights above the ellipsoid are needed"
                    )?;
                }
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
        if let Some(Authentication { state, proved, unproved, wrong, oldest_proof_s }) = &self.osnma_last {
            let age = oldest_proof_s.map_or(String::new(), |age_s| format!(", oldest proof {age_s} s"));
            writeln!(
                formatter,
                "OSNMA at the end   {state}: ephemerides of {proved} proved, {unproved} not, {wrong} false{age}"
            )?;
        }
        let refused =
            list(&mut self.refused_orbits.iter().map(|(satellite, count)| format!("{satellite} {count}")));
        if !refused.is_empty() {
            writeln!(formatter, "refused orbits     {refused}")?;
        }
        if !self.skipped.is_empty() {
            writeln!(formatter, "records skipped    {}", self.skipped)?;
        }
        self.injected.iter().try_for_each(|fault| writeln!(formatter, "{fault}"))
    }
}
