//! Positions that the module reported, and their errors.
//!
//! The alert of a silent line is stored with the last epoch before the silence.

use std::io::Write;

use raim_core::frame::{Enu, LocalFrame};
use raim_firmware::time::GpsTime;

use super::HostRun;
use super::host::Reported;
use super::truth::Truth;
use crate::signal::lump::Lump;
use crate::verdict::{Authentication, EpochOutput};

/// One epoch of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Moment {
    /// Time tag of the epoch.
    pub time: GpsTime,
    /// Seconds after the first epoch of the recording.
    pub elapsed_s: f64,
    /// Output of the module; `None` if there was none.
    pub output: Option<EpochOutput>,
    /// Position minus truth, east, north, up, m; `None` without a fix or a truth.
    pub error: Option<Enu>,
    /// SSE/dof of the ranges used, under every method; `None` if they did not pass their test.
    pub variance_ratio: Option<f64>,
    /// Time of the alert for a silent line after this epoch, seconds after the first epoch.
    pub stale_s: Option<f64>,
}

/// All epochs of a run.
pub type Track = Vec<Moment>;

impl Moment {
    /// Compares the output for a lump with the truth.
    pub fn of(lump: &Lump, reported: &Reported, truth: Option<&Truth>) -> Self {
        let output = reported.output().cloned();
        let position = output.as_ref().and_then(|output| output.position);
        let error = position
            .zip(truth.and_then(|truth| truth.at(lump.time)))
            .map(|(position, truth)| LocalFrame::at(truth).rotate(position.to_ecef() - truth));
        Self {
            time: lump.time,
            elapsed_s: lump.elapsed_s,
            output,
            error,
            variance_ratio: reported.seen.last().and_then(|seen| seen.variance_ratio),
            stale_s: reported.silence.first().map(|(time_s, _)| *time_s),
        }
    }
}

/// Compares the output for each lump with the truth.
pub fn track(lumps: &[Lump], run: &HostRun, truth: Option<&Truth>) -> Track {
    lumps.iter().zip(&run.reported).map(|(lump, reported)| Moment::of(lump, reported, truth)).collect()
}

/// Columns of the table.
const COLUMNS: [&str; 21] = [
    "week",
    "tow",
    "state",
    "reason",
    "lat_deg",
    "lon_deg",
    "height_m",
    "used",
    "excluded",
    "dof",
    "statistic",
    "threshold",
    "hpl_m",
    "vpl_m",
    "horizontal_error_m",
    "vertical_error_m",
    "osnma_state",
    "osnma_proved",
    "osnma_unproved",
    "osnma_false",
    "osnma_oldest_proof_s",
];

/// Row of the table.
type Row = [String; COLUMNS.len()];

/// Table with one row for each epoch, in the columns of the interface.
pub struct Rows<W>(W);

impl<W: Write> Rows<W> {
    /// Writes the heading.
    ///
    /// # Errors
    /// The writer's own.
    pub fn begin(mut out: W) -> std::io::Result<Self> {
        writeln!(out, "{}", COLUMNS.join(","))?;
        Ok(Self(out))
    }

    /// Writes the row of an epoch, and one for the silence after it.
    ///
    /// # Errors
    /// The writer's own.
    pub fn write(&mut self, moment: &Moment) -> std::io::Result<()> {
        writeln!(self.0, "{}", row(moment).join(","))?;
        if let Some(stale_s) = moment.stale_s {
            writeln!(self.0, "{}", stale_row(moment, stale_s).join(","))?;
        }
        Ok(())
    }

    /// Flushes the writer, because a buffer that is only dropped would not report a full disk.
    ///
    /// # Errors
    /// The writer's own.
    pub fn end(mut self) -> std::io::Result<()> {
        self.0.flush()
    }
}

/// Returns the row of a silent line: it has a time and a reason, and no position.
fn stale_row(moment: &Moment, stale_s: f64) -> Row {
    let time = GpsTime::from_ms(moment.time.to_ms() + ((stale_s - moment.elapsed_s) * 1e3).round() as u64);
    let mut row = Row::default();
    let known = [
        time.week.to_string(),
        format!("{:.3}", f64::from(time.tow_ms) * 1e-3),
        "A".to_owned(),
        "STALE".to_owned(),
    ];
    row[..known.len()].clone_from_slice(&known);
    row
}

fn row(moment: &Moment) -> Row {
    let number = |value: Option<f64>, decimals: usize| {
        value.map_or(String::new(), |value| format!("{value:.decimals$}"))
    };
    let output = moment.output.as_ref();
    let state = output.map(|output| &output.state);
    let position = output.and_then(|output| output.position);
    let excluded: Vec<String> = output
        .into_iter()
        .flat_map(|output| &output.excluded)
        .map(|excluded| excluded.satellite.to_string())
        .collect();
    let authentication = output.and_then(|output| output.authentication.as_ref());
    let satellites = |count: fn(&Authentication) -> u32| {
        authentication.map_or(String::new(), |authentication| count(authentication).to_string())
    };
    [
        moment.time.week.to_string(),
        format!("{:.3}", f64::from(moment.time.tow_ms) * 1e-3),
        state.map_or(String::new(), |state| state.state.to_string()),
        state.map_or(String::new(), |state| state.reason.clone()),
        number(position.map(|position| position.latitude_rad.to_degrees()), 9),
        number(position.map(|position| position.longitude_rad.to_degrees()), 9),
        number(position.map(|position| position.height_m), 3),
        state.map_or(String::new(), |state| state.used.to_string()),
        excluded.join(" "),
        state.and_then(|state| state.dof).map_or(String::new(), |dof| dof.to_string()),
        number(state.and_then(|state| state.statistic), 3),
        number(state.and_then(|state| state.threshold), 3),
        number(state.and_then(|state| state.hpl_m), 1),
        number(state.and_then(|state| state.vpl_m), 1),
        number(moment.error.map(Enu::horizontal), 3),
        number(moment.error.map(|error| error.up.abs()), 3),
        authentication.map_or(String::new(), |authentication| authentication.state.clone()),
        satellites(|authentication| authentication.proved),
        satellites(|authentication| authentication.unproved),
        satellites(|authentication| authentication.wrong),
        authentication
            .and_then(|authentication| authentication.oldest_proof_s)
            .map_or(String::new(), |age_s| age_s.to_string()),
    ]
}
