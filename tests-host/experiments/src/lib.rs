//! The papers' tables and figures, computed again by the core itself.
//!
//! Each paper has a file, which runs its experiments and returns an [`Outcome`]: rows and figures.
//! A row compares a printed value with ours, with a 95 % confidence interval if chance is involved,
//! a verdict and its reason.
//!
//! ```text
//! sky, fault ──► rai-core (the same types as on the target) ──► outcome ──► terminal, JSON, SVG, HTML
//! ```
//!
//! Nothing here is a second implementation of a method. Methods for comparison only (all minimal
//! subsets, exact tails, other clock predictors) are in [`raim::second_opinion`] and
//! [`raim::signal::clock_models`].
//!
//! Seeds are fixed: the same build gives the same numbers.
//!
//! # References
//!
//! Those of [`raim_core`], and:
//!
//! | tag | source |
//! |---|---|
//! | `Garwood1936` | F. Garwood, *Fiducial limits for the Poisson distribution*, Biometrika 28(3/4), 1936 |
//! | `Wilson1927` | E. B. Wilson, *Probable inference, the law of succession, and statistical inference*, J. Am. Stat. Assoc. 22, 1927 |

mod araim;
mod chen2009;
mod draw;
mod interval;
mod lin2016;
mod methods;
mod outcome;
mod parity;
mod probabilities;
pub mod record;
mod row;
mod tian2024;
mod yang2015;

pub use interval::Interval;
pub use outcome::{Outcome, Picture, Section, page};
pub use row::{Acceptance, Finding, Judgement, Row};

use indicatif::ProgressBar;

/// Amount of computation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// A reduction that still shows every effect: all papers together in under two minutes on two
    /// cores.
    Quick,
    /// The papers' own sample counts.
    Full,
}

impl Effort {
    /// Returns one of two numbers: that of the reduction, or that of the paper.
    pub fn pick<T>(self, quick: T, full: T) -> T {
        match self {
            Self::Quick => quick,
            Self::Full => full,
        }
    }
}

/// All experiments.
pub const EXPERIMENTS: &[Experiment] = &[
    yang2015::EXPERIMENT,
    lin2016::EXPERIMENT,
    parity::EXPERIMENT,
    chen2009::EXPERIMENT,
    tian2024::EXPERIMENT,
    methods::EXPERIMENT,
    probabilities::EXPERIMENT,
    probabilities::edge::EXPERIMENT,
    probabilities::noise::EXPERIMENT,
    araim::EXPERIMENT,
];

/// One paper's experiments.
#[derive(Clone, Copy, Debug)]
pub struct Experiment {
    /// Name on the command line.
    pub name: &'static str,
    /// Description of the experiment, one line.
    pub about: &'static str,
    /// Function that runs the experiment. It sets the length of the bar and advances it.
    pub run: fn(Effort, &ProgressBar) -> anyhow::Result<Outcome>,
}
