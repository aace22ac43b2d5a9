//! The HTML report of a replay.

use std::path::{Path, PathBuf};

use anyhow::Result;

use super::summary::Summary;
use crate::page::canvas::Ground;
use crate::page::html::Page;
use crate::page::thinned::Thinned;
use crate::page::{Moment, stanford, timeline};
use crate::signal::fault::{Fault, Kind};

/// Report that is filled epoch by epoch, with room for any number of them.
#[derive(Clone, Debug, Default)]
pub struct Report {
    epochs: Thinned,
    last_s: f64,
}

impl Report {
    /// Takes the next epoch.
    pub fn push(&mut self, moment: &super::track::Moment) {
        self.last_s = moment.elapsed_s;
        if let Some(said) = &moment.output {
            let is_high = said.state.is_protected();
            self.epochs.push(Moment::of(moment.elapsed_s, said, moment.error, is_high));
        }
    }

    /// Writes `report.html` into a folder; returns its path.
    ///
    /// # Errors
    /// The report cannot be drawn or written.
    pub fn write(&self, folder: &Path, faults: &[Fault], summary: &Summary) -> Result<PathBuf> {
        let incidents: Vec<timeline::Incident> =
            faults.iter().map(|fault| incident(fault, self.last_s)).collect();
        let moments = self.epochs.moments();
        let mut page = Page::new("A recording through the module", &headline(summary));
        page.figures(&figures(summary));
        page.heading("What the module said");
        page.picture(&timeline::picture(&self.epochs, &incidents, Ground::Page)?);
        if (moments.len() as u64) < self.epochs.all() {
            page.paragraph(&format!(
                "The pictures show {} of {} epochs: the extremes of each stretch of time, and the first epoch of each \
                 verdict in it.",
                moments.len(),
                self.epochs.all()
            ));
        }
        if moments.iter().any(|moment| moment.horizontal_error_m.is_some()) {
            page.heading("Error against protection level");
            page.paragraph(
                "Above the diagonal the protection level is larger than the error and bounds it, as it must. A violet dot \
                 below it is misleading: a position that was promised to be better than it was.",
            );
            page.pictures(&[
                stanford::horizontal(&moments, Ground::Page)?,
                stanford::vertical(&moments, Ground::Page)?,
            ]);
        }
        let path = folder.join("report.html");
        page.write(&path)?;
        Ok(path)
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
    vec![
        ("horizontal error, rms".to_owned(), metres(summary.horizontal_rms_m)),
        ("vertical error, rms".to_owned(), metres(summary.vertical_rms_m)),
        ("HPL, median".to_owned(), metres(summary.hpl_median_m)),
        ("VPL, median".to_owned(), metres(summary.vpl_median_m)),
    ]
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
