//! Result of the demonstration: a summary in words, a page, and the picture of the module catching
//! a fault.

use std::fmt;

use anyhow::Result;
use raim::page::canvas::{GREY, Ground, Mark};
use raim::page::chart::Series;
use raim::page::html::Page;
use raim::page::report::{self, Facts, Journal, command_line, settings_of};
use raim::page::timeline::{self, Incident};
use raim::page::{Moment, Verdict};
use raim::signal::sky::raw::Simulation;
use raim_core::satellite::SatelliteId;
use raim_firmware::settings::Configuration;

use super::{EPOCHS, FAULT_END_S, FAULT_START_S, Ordinary, Plan, SILENCE_S};

/// Width of the picture, pixels.
const WIDTH_PX: u32 = 960;

/// A demonstration that has run.
#[derive(Clone, Debug)]
pub struct Story {
    /// Parameters of the demonstration.
    pub plan: Plan,
    /// Sky of the demonstration.
    pub simulation: Simulation,
    /// Reports of the module, epoch by epoch.
    pub moments: Vec<Moment>,
    /// The same for the report.
    pub journal: Journal,
    /// Settings in force.
    pub settings: Configuration,
    /// Results of an ordinary receiver.
    pub ordinary: Vec<Ordinary>,
    /// Level of the integrity pin before the first epoch.
    pub pin_at_boot: bool,
    /// Instructions of the target for each epoch.
    pub instructions: Vec<u64>,
}

impl Story {
    /// Returns the first epoch with an alert, or without the satellite.
    pub fn detection(&self) -> Option<&Moment> {
        let during = self.moments.iter().filter(|moment| self.plan.fault().is_active(moment.time_s));
        during
            .into_iter()
            .find(|moment| moment.verdict == Verdict::Alert || moment.excluded.contains(&self.plan.satellite))
    }

    /// Returns the number of protected epochs with an error above their protection level.
    pub fn misleading(&self) -> usize {
        let is_misleading = |moment: &&Moment| {
            moment.verdict == Verdict::Protected
                && moment.horizontal_error_m.zip(moment.hpl_m).is_some_and(|(error_m, hpl_m)| error_m > hpl_m)
        };
        self.moments.iter().filter(is_misleading).count()
    }

    /// Returns the largest horizontal error of a protected epoch, m.
    pub fn largest_protected_error_m(&self) -> f64 {
        let protected = self.moments.iter().filter(|moment| moment.verdict == Verdict::Protected);
        protected.filter_map(|moment| moment.horizontal_error_m).fold(0.0, f64::max)
    }

    /// Returns the largest horizontal error of the receiver that accepts every satellite, m.
    pub fn largest_accepted_error_m(&self) -> f64 {
        self.ordinary.iter().map(|reported| reported.horizontal_error_m).fold(0.0, f64::max)
    }

    /// Returns all satellites that were ever left out, with the number of epochs.
    pub fn excluded(&self) -> Vec<(SatelliteId, usize)> {
        let mut all: Vec<SatelliteId> =
            self.moments.iter().flat_map(|moment| moment.excluded.iter().copied()).collect();
        all.sort_unstable();
        let of = |run: &[SatelliteId]| run.first().map(|&satellite| (satellite, run.len()));
        all.chunk_by(|a, b| a == b).filter_map(of).collect()
    }

    /// Returns the first report on the silent line.
    pub fn silence(&self) -> Option<&Moment> {
        self.moments.iter().find(|moment| moment.time_s > f64::from(EPOCHS - 1))
    }

    fn incidents(&self) -> [Incident; 2] {
        let name = format!("{} drifts off, to {:+} m", self.plan.satellite, self.plan.bias_m);
        // Without an end: the silence lasts to the edge of a picture.
        let silence_s = f64::from(EPOCHS - 1)..f64::INFINITY;
        [
            Incident { name, range_s: FAULT_START_S..FAULT_END_S },
            Incident { name: "the line is silent".to_owned(), range_s: silence_s },
        ]
    }

    /// Returns the result in sentences, each with its subject.
    pub fn figures(&self) -> Vec<(String, String)> {
        let mut figures = vec![
            ("the fault".to_owned(), self.told_fault()),
            ("the position".to_owned(), self.told_position()),
            ("the promise".to_owned(), self.told_promise()),
            ("the pin".to_owned(), self.told_pin()),
        ];
        if let Some(most) = self.instructions.iter().max() {
            let millions = *most as f64 * 1e-6;
            let cost =
                format!("The most expensive epoch took {millions:.2} million instructions on the board");
            figures.push(("the cost".to_owned(), cost));
        }
        figures
    }

    fn told_fault(&self) -> String {
        let Plan { satellite, .. } = self.plan;
        let noticed = self.detection().map_or_else(
            || "not noticed".to_owned(),
            |moment| {
                let bias_m = self.plan.fault().bias_m(moment.time_s).abs();
                format!("noticed after {:.0} s at {bias_m:.0} m", moment.time_s - FAULT_START_S)
            },
        );
        let excluded = self.excluded();
        let own = excluded.iter().find(|(one, _)| *one == satellite).map_or(0, |(_, epochs)| *epochs);
        let left_out = match own {
            0 => "never left out".to_owned(),
            epochs => format!("left out for {epochs} epochs"),
        };
        let others = excluded.iter().filter(|(one, _)| *one != satellite);
        let mut parts = vec![format!("{satellite} was wrong from {FAULT_START_S} s"), noticed, left_out];
        parts.extend(others.map(|(one, epochs)| format!("{one} left out for {epochs}")));
        parts.join("; ")
    }

    fn told_position(&self) -> String {
        format!(
            "A protected position was at most {:.1} m off; with all satellites accepted it was {:.1} m off",
            self.largest_protected_error_m(),
            self.largest_accepted_error_m()
        )
    }

    fn told_promise(&self) -> String {
        let [protected, alerts, unavailable] = timeline::tally(&self.moments);
        let misleading = match self.misleading() {
            0 => "none of them misleading".to_owned(),
            misleading => format!("{misleading} of them misleading"),
        };
        format!(
            "{protected} epochs were protected, {misleading}; {alerts} were alerts, {unavailable} unavailable"
        )
    }

    fn told_pin(&self) -> String {
        let start = level(self.pin_at_boot);
        let high = self.moments.iter().filter(|moment| moment.pin_is_high == Some(true)).count();
        let silence = self.silence().map_or_else(
            || "the line was never silent".to_owned(),
            |moment| {
                let pin = moment.pin_is_high.map_or("unknown", level);
                format!(
                    "{pin} {SILENCE_S} s after the line fell silent ({} {})",
                    moment.verdict.word(),
                    moment.reason
                )
            },
        );
        format!("It was {start} at start, high in {high} epochs, and {silence}")
    }

    /// Draws the module catching a fault, in one picture.
    ///
    /// # Errors
    /// If it cannot be drawn.
    pub fn picture(&self, ground: Ground) -> Result<String> {
        let incidents = self.incidents();
        let mut statistic = timeline::statistic(&self.moments, &incidents);
        let mut horizontal = timeline::horizontal(&self.moments, &incidents);
        // These lines are behind the others, which are the subject of the picture.
        let [of_statistic, of_horizontal] = self.beside();
        statistic.series.splice(0..0, of_statistic);
        horizontal.series.splice(0..0, of_horizontal);
        timeline::stacked(&[statistic, horizontal], &self.moments, WIDTH_PX, ground)
    }

    /// Returns the lines of the ordinary receiver: statistic, horizontal error.
    fn beside(&self) -> [Vec<Series>; 2] {
        [
            vec![self.accepted("all satellites accepted", |ordinary| ordinary.statistic)],
            vec![self.accepted("error, all accepted", |ordinary| ordinary.horizontal_error_m)],
        ]
    }

    fn accepted(&self, name: &str, value: impl Fn(&Ordinary) -> f64) -> Series {
        let point = |ordinary: &Ordinary| (ordinary.time_s, value(ordinary));
        let points = self.ordinary.iter().map(point).collect();
        Series { name: name.to_owned(), colour: GREY, mark: Mark::Line, points }
    }

    /// Returns everything on one page.
    ///
    /// # Errors
    /// If a picture cannot be drawn.
    pub fn page(&self) -> Result<Page> {
        let summary = format!(
            "Two minutes of a simulated GPS and BeiDou sky over Xi'an, sent as RTCM 3 to the image on the emulated \
             board. From {FAULT_START_S} s to {FAULT_END_S} s the range of {} is wrong, growing to {:+} m; at the end \
             the line falls silent, and after {SILENCE_S} s the pin drops.",
            self.plan.satellite, self.plan.bias_m
        );
        let (settings_hash, settings) = settings_of(&self.settings);
        let facts = Facts {
            title: "RAI: a satellite drifts off, and the module notices".to_owned(),
            summary,
            figures: self.figures(),
            source: format!("a simulated sky over Xi'an, seed {}, and the emulated board", self.plan.seed),
            command: command_line(),
            settings_hash,
            settings,
            mask_deg: self.settings.mask_rad().to_degrees(),
            incidents: self.incidents().to_vec(),
            beside: self.beside(),
            ..Facts::default()
        };
        report::page(&self.journal, &facts)
    }
}

const fn level(is_high: bool) -> &'static str {
    if is_high { "high" } else { "low" }
}

impl fmt::Display for Story {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.figures().iter().try_for_each(|(name, value)| writeln!(formatter, "  {name:<13} {value}"))
    }
}
