//! All attacks on the module with the parts of the image `small`, and their record in
//! `records/small.tsv`.
//!
//! The small module lacks what the bounds of many attacks ask for. All protected epochs are
//! therefore counted alike, whatever figures an attack has: those with an error beyond a level, and
//! the largest error. A line of the record has five columns: attack, protected epochs, those beyond
//! a level, largest horizontal and vertical error in m. An attack without
//! an opportunity has the reason in the second column alone.

use std::fmt;
use std::path::PathBuf;

use anyhow::Result;

use super::victim::{NoOpportunity, take_tally};
use super::{Attack, Effort, record};

const FILE: &str = "small.tsv";

/// Result of an attack on the small module.
#[derive(Clone, Debug, PartialEq)]
pub enum Finding {
    /// Protected epochs, those beyond a level, and the largest horizontal and vertical error, m.
    Epochs {
        /// Number of protected epochs.
        protected: usize,
        /// Number of them with an error beyond a level.
        beyond: usize,
        /// Largest horizontal and vertical error of a protected epoch, m.
        largest_m: [f64; 2],
    },
    /// The reason why the attack has no opportunity.
    NoOpportunity(&'static str),
}

impl Finding {
    /// Returns true unless a protected epoch was beyond a level.
    pub const fn is_held(&self) -> bool {
        !matches!(self, Self::Epochs { beyond: 1.., .. })
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Epochs { protected, beyond, largest_m: [horizontal, vertical] } => {
                write!(formatter, "{protected}\t{beyond}\t{horizontal:.1}\t{vertical:.1}")
            }
            Self::NoOpportunity(reason) => formatter.write_str(reason),
        }
    }
}

/// Runs an attack. The program of the small module must have been chosen
/// ([`super::module::attack_small`]).
///
/// # Errors
/// If the attack fails for another reason than no opportunity.
pub fn attempt(attack: &Attack, effort: Effort) -> Result<Finding> {
    let _ = take_tally();
    let outcome = attack.attempt(effort);
    if let Some(NoOpportunity(reason)) = outcome.as_ref().err().and_then(|error| error.downcast_ref()) {
        return Ok(Finding::NoOpportunity(reason));
    }
    outcome?;
    let tally = take_tally();
    Ok(Finding::Epochs {
        protected: tally.outcomes.promised,
        beyond: tally.outcomes.misleading,
        largest_m: [tally.worst_horizontal_m, tally.worst_vertical_m],
    })
}

/// Returns the line of the record for a finding in the quick form.
pub fn line(attack: &str, finding: &Finding) -> String {
    format!("{attack}\t{finding}")
}

/// Reads the committed record.
///
/// # Errors
/// If the file cannot be read.
pub fn committed() -> Result<String> {
    record::read(FILE)
}

/// Writes the record of all attacks.
///
/// # Errors
/// If the file cannot be written.
pub fn write(findings: &[(&str, Finding)]) -> Result<PathBuf> {
    let text: String = findings.iter().map(|(attack, finding)| line(attack, finding) + "\n").collect();
    record::write(FILE, &text)
}
