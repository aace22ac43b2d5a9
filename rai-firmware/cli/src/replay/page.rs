//! The report of a replay.

use std::path::{Path, PathBuf};

use anyhow::Result;
use raim_firmware::settings::Configuration;

use super::host::Reported;
use super::summary::Summary;
use crate::page::report::{self, Facts, Happened, Journal, command_line, settings_of};
use crate::page::timeline;
use crate::signal::fault::{Fault, Kind};

/// Report that is filled epoch by epoch, with room for any number of them.
#[derive(Clone, Debug, Default)]
pub struct Report {
    journal: Journal,
    last_s: f64,
}

/// Facts of a replay that no epoch has.
pub struct About {
    /// Name of the recording, without its folder.
    pub title: String,
    /// Names of the files.
    pub source: String,
    /// Settings in force.
    pub configuration: Configuration,
}

impl Report {
    /// Takes the next epoch, and the silence after it.
    pub fn push(&mut self, moment: &super::track::Moment, reported: &Reported) {
        self.last_s = moment.elapsed_s;
        if let Some(output) = &moment.output {
            self.journal.push(&Happened {
                time_s: moment.elapsed_s,
                output,
                error: moment.error,
                pin_is_high: output.state.is_protected(),
                view: reported.view(),
            });
        }
        if let Some((time_s, seen)) = reported.silence.first() {
            let (time_s, output) = (*time_s, &seen.output);
            self.last_s = time_s;
            self.journal.push(&Happened { time_s, output, error: None, pin_is_high: false, view: None });
        }
    }

    /// Writes the page to a file or into a folder; returns its path.
    ///
    /// # Errors
    /// The report cannot be drawn or written.
    pub fn write(&self, place: &Path, faults: &[Fault], summary: &Summary, about: &About) -> Result<PathBuf> {
        let (settings_hash, settings) = settings_of(&about.configuration);
        let facts = Facts {
            title: about.title.clone(),
            summary: headline(summary),
            figures: figures(summary),
            source: about.source.clone(),
            command: command_line(),
            settings_hash,
            settings,
            mask_deg: about.configuration.mask_rad().to_degrees(),
            incidents: faults.iter().map(|fault| incident(fault, self.last_s)).collect(),
            counters: summary
                .counters
                .iter()
                .map(|(name, count)| (name.clone(), u64::from(*count)))
                .collect(),
            ..Facts::default()
        };
        report::write(&self.journal, &facts, place)
    }
}

fn headline(summary: &Summary) -> String {
    let misleading = summary
        .misleading
        .map_or("error unknown".to_owned(), |misleading| format!("{misleading} misleading"));
    format!(
        "{} epochs: {} protected, {} alerts, {} unavailable; {misleading}.",
        summary.epochs, summary.protected, summary.alerts, summary.unavailable
    )
}

fn figures(summary: &Summary) -> Vec<(String, String)> {
    let metres = |value: Option<f64>| value.map_or("–".to_owned(), |value| format!("{value:.2} m"));
    let protected = 100.0 * summary.protected as f64 / summary.epochs.max(1) as f64;
    let mut figures = vec![("protected".to_owned(), format!("{protected:.2} %"))];
    if summary.misleading.is_some() {
        figures.push(("horizontal error, rms".to_owned(), metres(summary.horizontal_rms_m)));
        figures.push(("vertical error, rms".to_owned(), metres(summary.vertical_rms_m)));
    }
    figures.extend([
        ("HPL, median".to_owned(), metres(summary.hpl_median_m)),
        ("VPL, median".to_owned(), metres(summary.vpl_median_m)),
    ]);
    figures
}

fn incident(fault: &Fault, last_s: f64) -> timeline::Incident {
    timeline::Incident {
        name: match fault.kind {
            Kind::Outage => format!("{} is lost", fault.target),
            _ => format!("fault of {}", fault.target),
        },
        range_s: fault.start_s..fault.end_s.min(last_s),
    }
}
