//! The papers' tables and figures, computed again by the core itself.
//!
//! Each paper has a file, which runs its experiments and gives back an [`Outcome`]: rows that hold a printed value
//! against ours, with a 95 % confidence interval where chance has a part in it, a verdict and its reason; and figures.
//!
//! ```text
//! sky, fault ──► rai-core (the same types as on the target) ──► outcome ──► terminal, JSON, SVG, HTML
//! ```
//!
//! Nothing here is a second implementation of a method. What stands beside a method for comparison only (all minimal
//! subsets, other clock predictors, exact tails) is in [`tests_host::ransac_traditional`], [`tests_host::clock_models`] and
//! [`tests_host::chi_square`].
//!
//! Seeds are fixed: the same build gives the same numbers.

mod araim;
mod chen2009;
mod draw;
mod interval;
mod lin2016;
mod methods;
mod outcome;
mod parity;
mod probabilities;
mod row;
mod tian2024;
mod yang2015;

pub use interval::Interval;
pub use outcome::{Outcome, Picture, Section, page};
pub use row::{Acceptance, Finding, Judgement, Row};

use indicatif::ProgressBar;

/// How much is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// A decimation that still shows every effect: all papers together in under two minutes on two cores.
    Quick,
    /// The papers' own sample counts.
    Full,
}

impl Effort {
    /// One of two numbers: of the decimation, or of the paper.
    pub fn pick<T>(self, quick: T, full: T) -> T {
        match self {
            Self::Quick => quick,
            Self::Full => full,
        }
    }
}

/// What can be run, by the name it has on the command line.
pub const EXPERIMENTS: &[Experiment] = &[
    yang2015::EXPERIMENT,
    lin2016::EXPERIMENT,
    parity::EXPERIMENT,
    chen2009::EXPERIMENT,
    tian2024::EXPERIMENT,
    methods::EXPERIMENT,
    probabilities::EXPERIMENT,
    araim::EXPERIMENT,
];

/// One paper's experiments.
#[derive(Clone, Copy, Debug)]
pub struct Experiment {
    /// Name on the command line.
    pub name: &'static str,
    /// What it is about, in a line.
    pub about: &'static str,
    /// Runs it; the bar shows how far it is, and its length is the experiment's to set.
    pub run: fn(Effort, &ProgressBar) -> anyhow::Result<Outcome>,
}
