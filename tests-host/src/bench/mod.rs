//! What the module costs on the chip, stage by stage, beside what it may cost.
//!
//! Instructions are counted by the emulated core, to the instruction and the same every time ([`crate::laboratory`]);
//! bytes are those of the shipped image. Each figure stands beside a committed one ([`budget`]), beyond which it may not
//! grow, and beside the target that the stage was given. The stages of an epoch are run on the second board too: what a
//! processor with doubles saves.
//!
//! Cost is never time: a second on one machine is two on another, an instruction is an instruction. On the chip one takes
//! a cycle or a few, and at 168 MHz a million of them about 7 ms.

pub mod budget;
mod figure;
pub mod library;
pub mod memory;
pub mod peers;
pub mod stages;
pub mod workload;
pub mod worst;

pub use figure::Figure;
use worst::{Found, Place};

use std::fmt;

use anyhow::Result;

use crate::laboratory::profile::Profile;

/// Where the instructions of a stage go, which a part of its name chooses: the first that has it.
///
/// # Errors
/// Where no stage has such a name, or the measuring image does not come to its end.
pub fn profile(words: &str) -> Result<(String, Profile)> {
    match worst::profile(words)? {
        Some(found) => Ok(found),
        None => stages::profile(words),
    }
}

/// All figures of one state of the program.
#[derive(Clone, Debug)]
pub struct Measurement {
    /// Each with its name.
    pub figures: Vec<Figure>,
    /// What the worst-case epochs were.
    pub worst: Vec<String>,
}

impl Measurement {
    /// Measures everything, in two minutes; says what it is at.
    ///
    /// # Errors
    /// Where an image does not build, or the emulator does not run it to its end.
    pub fn take(mut progress: impl FnMut(&str)) -> Result<Self> {
        progress("stages on the emulated core");
        let mut figures = stages::measure()?;
        progress("stages of an epoch on the second board");
        figures.extend(stages::measure_second_board()?);
        progress("the worst-case epoch");
        let worst = [worst::search(Place::Later)?, worst::search(Place::First)?];
        let targets = [2_500_000, 3_000_000];
        figures.extend(worst.iter().zip(targets).map(|(found, target)| found.figure(target)));
        progress("memory of the shipped image");
        figures.extend(memory::measure()?);
        progress("flash and objects of the library for C");
        figures.extend(library::measure()?);
        Ok(Self { figures, worst: worst.iter().map(Found::circumstances).collect() })
    }

    /// What has grown beyond its budget.
    ///
    /// # Errors
    /// Where the committed figures cannot be read.
    pub fn check(&self) -> Result<Vec<String>> {
        Ok(budget::findings(&self.figures, &budget::committed()?))
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
        self.worst.iter().try_for_each(|found| writeln!(formatter, "{found}"))
    }
}
