//! Cost of the same epochs in other programs: libswiftnav and RTKLIB on the processors that ours is
//! measured on.
//!
//! ```text
//! workload ──epochs as a C table──► board.c ──► libswiftnav: calc_PVT        ──┐
//!        │                               └────► RTKLIB: estpos, raim_fde     ──┼──► instructions, answer ──► table
//!        └──────────requests─────────► measuring image: fix and integrity    ──┘
//! ```
//!
//! All receive the positions of 20 satellites and corrected ranges with standard deviations of 2 m.
//! There is no fault, or 120 m on G03, or that and −95 m on G06. Work before or after (orbits,
//! atmosphere, velocity) is not counted; everything in between is. Each cost stands beside its
//! answer, because a refusal is cheap.
//!
//! [`SETTINGS`] lists the settings and the compilation of each program; it ends the comparison.
//!
//! The peers' sources are fetched ([`sources`]) and compiled ([`program`]), never kept here.
//!
//! Limits: the system timer of the boards AN386 and AN500 ticks every 40 instructions, so their
//! figures are accurate to 40. Ours differ by up to 0.3 % from those of [`stages`](super::stages),
//! where other stages ran before.

mod ours;
mod program;
pub mod sources;

use std::fmt::{self, Write as _};

use anyhow::Result;
use raim_core::epoch::Epoch;
use raim_core::frame::Ecef;
use raim_firmware::correction::CAPACITY;

use super::workload;
use crate::board::Machine;
use sources::Sources;

/// Settings of each program.
const SETTINGS: &str = "\
All: 20 satellites of GPS and BeiDou, their positions at transmission, corrected ranges with a sigma of 2 m; one fault is
120 m on G03, two faults are that and -95 m on G06. Orbits, atmosphere and velocity are neither needed nor counted.

RAI: the method BAARDA with the requirements of a non-precision approach, thresholds from its tables; up to three exclusions;
HPL and VPL of the remaining satellites. Each epoch is the first of its monitor. Compiled as shipped, the core at opt-level 2.

libswiftnav, of swiftnav-sys 0.10.0: calc_PVT, RAIM on, velocity off, all constellations, no mask; its log and its assertions off.
The signal strength is chosen so that its noise model gives a sigma of 2 m, with all satellites at the zenith. A fault is an rms of the residuals above 2.5
sigma; up to two exclusions. Every solution starts from the earth's centre; no other start is possible.

RTKLIB 2.4.3 b34: estpos, and raim_fde if that refuses, as pntpos calls them, with the clocks of five constellations as always; no mask,
GDOP up to 30. Its options for the atmosphere are EST and ZTD, for which these functions have neither a model nor a variance; its error
factors are 0, and the satellites' variances give the sigma of 2 m. A fault is a sum of squares above the 99.9 % quantile; one
exclusion, that with the smallest rms. Calls of trace do nothing, but their arguments are computed, among them times as text: it is
measured with these calls and without them. A compiler flag zeroes the variables that its first pass reads uninitialised.";

/// Number of satellites of an epoch.
const SATELLITES: usize = 20;
/// Number of their constellations: GPS and `BeiDou`.
const CONSTELLATIONS: usize = 2;
/// Name of our rows.
pub const OURS: &str = "RAI";
/// Numbers of faulty satellites.
const FAULTS: [usize; 3] = [0, 1, 2];

/// Processor of a measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Core {
    /// Cortex-M4F, with single precision in hardware.
    M4,
    /// Cortex-M7, with doubles as well.
    M7,
}

impl Core {
    /// Both processors.
    pub const ALL: [Self; 2] = [Self::M4, Self::M7];

    /// Returns the board that ours is measured on.
    const fn machine(self) -> Machine {
        match self {
            Self::M4 => Machine::Stm32f405,
            Self::M7 => Machine::Mps2An500,
        }
    }
}

impl fmt::Display for Core {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::M4 => "Cortex-M4F",
            Self::M7 => "Cortex-M7, doubles in hardware",
        })
    }
}

/// Starting point of a solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// A point 1 km from the antenna.
    Near,
    /// The centre of the earth.
    Centre,
}

impl Start {
    const ALL: [Self; 2] = [Self::Near, Self::Centre];

    fn position(self) -> Ecef {
        match self {
            Self::Near => workload::start(),
            Self::Centre => Ecef::CENTRE,
        }
    }
}

impl fmt::Display for Start {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Near => "from 1 km",
            Self::Centre => "from the earth's centre",
        })
    }
}

/// Result of one epoch.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Cost in instructions.
    pub instructions: u64,
    /// Distance from the truth, m, if a position was reported as valid.
    pub error_m: Option<f64>,
    /// Satellites left out, by name.
    pub left_out: Vec<String>,
}

impl fmt::Display for Outcome {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(error_m) = self.error_m else { return formatter.write_str("refused") };
        match self.left_out.as_slice() {
            [] => write!(formatter, "{error_m:.1} m"),
            names => write!(formatter, "{error_m:.1} m without {}", names.join(", ")),
        }
    }
}

/// Results of a program in one setting, for the epochs of [`FAULTS`].
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Name of the program.
    pub program: &'static str,
    /// Setting of the program.
    pub setting: &'static str,
    /// Processor of the measurement.
    pub core: Core,
    /// Starting point of the solution.
    pub start: Start,
    /// Results with no fault, one, and two.
    pub outcomes: Vec<Outcome>,
}

/// Comparison of all programs.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// Rows, by processor.
    pub rows: Vec<Row>,
    /// Compiler of the peers, with its version.
    pub compiler: String,
}

impl Comparison {
    /// Measures ours and the peers', in some seconds once all is compiled, and reports its
    /// progress.
    ///
    /// # Errors
    /// If a program does not compile, or does not finish in the emulator.
    pub fn take(sources: &Sources, mut progress: impl FnMut(&str)) -> Result<Self> {
        let mut rows = Vec::new();
        for core in Core::ALL {
            rows.extend(Self::take_on(core, sources, &mut progress)?.rows);
        }
        Ok(Self { rows, compiler: program::compiler()? })
    }

    /// Measures the same on one processor.
    ///
    /// # Errors
    /// As [`Self::take`].
    pub fn take_on(core: Core, sources: &Sources, mut progress: impl FnMut(&str)) -> Result<Self> {
        progress(&format!("our fix and integrity, {core}"));
        let mut rows = ours::measure(core)?;
        for peer in program::PEERS {
            progress(&format!("{}, {}, {core}", peer.name, peer.setting));
            rows.extend(program::measure(&peer, sources, core)?);
        }
        Ok(Self { rows, compiler: program::compiler()? })
    }
}

impl fmt::Display for Comparison {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        for core in Core::ALL {
            writeln!(formatter, "{core}: instructions, and the error of the position\n")?;
            writeln!(formatter, "| program | setting | no fault | one fault | two faults | answers |")?;
            writeln!(formatter, "|---|---|---|---|---|---|")?;
            for row in self.rows.iter().filter(|row| row.core == core) {
                writeln!(formatter, "{row}")?;
            }
            writeln!(formatter)?;
        }
        write!(formatter, "{SETTINGS}\n\nThe peers are compiled by {} -O2, with newlib.", self.compiler)
    }
}

impl fmt::Display for Row {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "| {} | {}, {} |", self.program, self.setting, self.start)?;
        for outcome in &self.outcomes {
            write!(formatter, " {} |", in_thousands(outcome.instructions))?;
        }
        let answers: Vec<String> = self.outcomes.iter().map(ToString::to_string).collect();
        write!(formatter, " {} |", answers.join(" / "))
    }
}

/// Formats a number with thousands separators.
fn in_thousands(value: u64) -> String {
    let digits = value.to_string();
    digits.char_indices().fold(String::new(), |mut text, (index, digit)| {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(',');
        }
        let _ = text.write_char(digit);
        text
    })
}

fn epoch(faults: usize) -> Result<Epoch<CAPACITY>> {
    workload::epoch(SATELLITES, CONSTELLATIONS, faults)
}

/// Returns the distance of a position from the antenna, m.
fn error_m(position: Ecef) -> f64 {
    (position - workload::site().position).radius_m()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_written_with_commas() {
        for (value, want) in [(0, "0"), (999, "999"), (1_000, "1,000"), (12_345_678, "12,345,678")] {
            assert_eq!(in_thousands(value), want);
        }
    }
}
