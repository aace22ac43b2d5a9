//! Cost of the module on the chip, stage by stage, beside its budgets.
//!
//! The emulated core counts instructions exactly and reproducibly ([`crate::laboratory`]). Bytes
//! are those of the shipped image. Each figure stands beside a committed one ([`budget`]), beyond
//! which it may not grow, and beside the target of its stage. The stages of an epoch also run on
//! the second board, which shows the gain of a processor with doubles.
//!
//! A count of instructions is no time. For the usual epoch and the worst ones, a model of the
//! processor and its flash bounds the cycles from below and from above
//! ([`crate::laboratory::cycles`]); [`time`] turns them into milliseconds.

pub mod budget;
mod figure;
pub mod host;
pub mod library;
pub mod memory;
pub mod stages;
pub mod time;
pub mod workload;
pub mod worst;

pub use figure::Figure;
use worst::{Found, Place};

use std::fmt;

use anyhow::Result;

use crate::laboratory::profile::Profile;

/// Profiles the first stage whose name contains `words`.
///
/// # Errors
/// If no stage has such a name, or the measuring image does not finish.
pub fn profile(words: &str) -> Result<(String, Profile)> {
    match worst::profile(words)? {
        Some(found) => Ok(found),
        None => stages::profile(words),
    }
}

/// Amount of measuring.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scope {
    /// Everything.
    All,
    /// Everything but the libraries for C that no test links. They link the same functions again,
    /// with other features.
    Tested,
    /// The instructions of the stages on the first board, with one image to link.
    Stages,
}

/// All figures of one state of the program.
#[derive(Clone, Debug)]
pub struct Measurement {
    /// Amount of measuring.
    pub scope: Scope,
    /// Figures with their names.
    pub figures: Vec<Figure>,
    /// Circumstances of the worst-case epochs.
    pub worst: Vec<String>,
    /// Times of the usual epoch and of the worst-case ones.
    pub times: Vec<String>,
}

impl Measurement {
    /// Measures, in two minutes once the images are linked, and reports its progress.
    ///
    /// # Errors
    /// If an image does not build, or does not finish in the emulator.
    pub fn take(scope: Scope, mut progress: impl FnMut(&str)) -> Result<Self> {
        progress("stages on the emulated core");
        let mut figures = stages::measure()?;
        if scope == Scope::Stages {
            return Ok(Self { scope, figures, worst: Vec::new(), times: Vec::new() });
        }
        progress("stages of an epoch on the second board");
        figures.extend(stages::measure_second_board()?);
        progress("the worst-case epoch");
        let worst = [worst::search(Place::Later)?, worst::search(Place::First)?];
        let targets = [2_500_000, 3_000_000];
        figures.extend(worst.iter().zip(targets).map(|(found, target)| found.figure(target)));
        progress("cycles of the usual and the worst-case epochs");
        let cycles = [stages::cycles()?, worst[0].cycles()?, worst[1].cycles()?];
        figures.extend(cycles.iter().flat_map(|(name, cycles)| time::figures(name, cycles)));
        let times = cycles.iter().map(|(name, cycles)| time::text(name, cycles)).collect();
        progress("memory of the shipped image");
        figures.extend(memory::measure()?);
        progress("flash and objects of the library for C");
        figures.extend(library::measure(scope)?);
        Ok(Self { scope, figures, worst: worst.iter().map(Found::circumstances).collect(), times })
    }

    /// Returns the figures that exceed their budget.
    ///
    /// # Errors
    /// If the committed figures cannot be read.
    pub fn check(&self) -> Result<Vec<String>> {
        let mut committed = budget::committed()?;
        let is_measured = |name: &String| self.figures.iter().any(|figure| figure.name == *name);
        committed.retain(|name, _| match self.scope {
            // What is gone shows in the other scopes.
            Scope::Stages => is_measured(name),
            Scope::All | Scope::Tested => library::is_measured(name, self.scope),
        });
        Ok(budget::findings(&self.figures, &committed))
    }
}

impl fmt::Display for Measurement {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let committed = budget::committed().unwrap_or_default();
        writeln!(
            formatter,
            "{:>10} {:>10} {:>10} {:>10}  instructions, unless said",
            "now", "committed", "target", "Cortex-M7"
        )?;
        for figure in self.figures.iter().filter(|figure| !figure.is_of_second_board()) {
            let second = figure::on_second_board(&figure.name);
            let second = self.figures.iter().find(|figure| figure.name == second);
            let second = second.map_or("-".to_owned(), |figure| figure.value.to_string());
            let budget = committed.get(&figure.name).map_or("-".to_owned(), ToString::to_string);
            let target = figure.target.map_or("-".to_owned(), |target| target.to_string());
            let mark = if figure.target.is_some_and(|target| figure.value > target) {
                "  (above the target)"
            } else {
                ""
            };
            writeln!(
                formatter,
                "{:>10} {budget:>10} {target:>10} {second:>10}  {}{mark}",
                figure.value, figure.name
            )?;
        }
        self.worst.iter().chain(&self.times).try_for_each(|found| writeln!(formatter, "{found}"))
    }
}
