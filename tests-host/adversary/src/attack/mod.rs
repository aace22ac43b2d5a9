//! The adversary: every attempt to make the pin high on a wrong position, kept and repeated on
//! every change.
//!
//! ```text
//! sky ─► fault, forgery ─► RTCM, commands ─► module in process ─► sentences, pin ─► tally ─► figures with bounds
//! ```
//!
//! Each attack has a file. It builds the input, sends it to the module as bytes ([`victim`]),
//! compares the sentences with the truth ([`tally`]) and returns [`Figure`]s. The module withstands
//! an attack if every figure is within its bound. The bounds are the promises of the product: no
//! protected epoch has an error above its level (or no more often than the probability of missed
//! detection allows), and no healthy epoch is lost to harmless input.
//!
//! What nearly every attack uses is in [`prelude`]; [`forgery`] has the skies, and the ways to alter them.
//! The folders hold the attacks, by what is attacked. A row in the folder's `mod.rs` lists an attack
//! and makes its test ([`rows`]).

#[macro_use]
mod rows;

pub mod module;
pub mod ranges;
pub mod record;
pub mod seen;
pub mod sky;
pub mod small;
pub mod tally;
pub mod victim;

mod branch;
#[cfg(test)]
mod document;
mod forgery;
mod line;
mod motion;
mod nature;
mod orbits;
mod prelude;

use anyhow::Result;
use serde::Serialize;

pub use self::branch::Branch;

/// Amount of work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// Seconds of work, as the tests run it.
    Quick,
    /// Many more epochs and geometries.
    Long,
}

impl Effort {
    /// Both forms.
    pub const ALL: [Self; 2] = [Self::Quick, Self::Long];

    /// Returns the word of this form.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Quick => "quick",
            Self::Long => "long",
        }
    }

    /// Returns the form of a word.
    pub fn of(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|effort| effort.word() == word)
    }

    /// Returns the number for this effort.
    pub fn pick<T>(self, quick: T, long: T) -> T {
        match self {
            Self::Quick => quick,
            Self::Long => long,
        }
    }
}

/// An attempt to make the pin high on a wrong position.
#[derive(Clone, Copy, Debug)]
pub struct Attack {
    /// Name on the command line.
    pub name: &'static str,
    /// Description of the attack, one line.
    pub about: &'static str,
    /// Place in the fault tree.
    pub branch: Branch,
    /// What the same attack did before the countermeasures, which no command measures again. Markdown.
    pub before: &'static str,
    /// What its figures do not say, such as a reason. Markdown.
    pub note: &'static str,
    /// Function that runs the attack.
    pub run: fn(Effort) -> Result<Vec<Figure>>,
}

attacks! {
    signed_sky_is_jammed_and_attacked: sky::ATTACK,
}

/// Attacks of all folders, in the order of the documents.
const FOLDERS: [&[&Attack]; 6] =
    [ranges::ATTACKS, motion::ATTACKS, orbits::ATTACKS, line::ATTACKS, nature::ATTACKS, ATTACKS];

/// Returns all attacks.
pub fn attacks() -> Vec<&'static Attack> {
    FOLDERS.concat()
}

/// Bound of a figure.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Bound {
    /// The figure must not exceed this value.
    AtMost(f64),
    /// The figure must not fall below this value.
    AtLeast(f64),
    /// The figure has no bound and is only printed.
    Anywhere,
}

impl Bound {
    /// Returns the words of the bound, none for a figure without one.
    fn words(self) -> String {
        match self {
            Self::AtMost(bound) => format!("≤ {}", precise(bound)),
            Self::AtLeast(bound) => format!("≥ {}", precise(bound)),
            Self::Anywhere => String::new(),
        }
    }
}

/// Formats a bound, which its value may come close to, with four decimals at most.
fn precise(bound: f64) -> String {
    if bound != 0.0 && bound.abs() < 0.001 {
        return format!("{bound:.1e}");
    }
    format!("{bound:.4}").trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// A figure that an attack measures.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Figure {
    /// Name of the quantity, with its unit.
    pub quantity: String,
    /// Measured value.
    pub value: f64,
    /// Bound of the value.
    pub bound: Bound,
}

impl Figure {
    /// Returns a figure that must not exceed `bound`.
    pub fn at_most(quantity: impl Into<String>, value: f64, bound: f64) -> Self {
        Self { quantity: quantity.into(), value, bound: Bound::AtMost(bound) }
    }

    /// Returns a figure that must not fall below `bound`.
    pub fn at_least(quantity: impl Into<String>, value: f64, bound: f64) -> Self {
        Self { quantity: quantity.into(), value, bound: Bound::AtLeast(bound) }
    }

    /// Returns a figure without a bound.
    pub fn plain(quantity: impl Into<String>, value: f64) -> Self {
        Self { quantity: quantity.into(), value, bound: Bound::Anywhere }
    }

    /// Returns true if the value is within its bound. NaN is within no bound that is a number.
    pub fn holds(&self) -> bool {
        match self.bound {
            Bound::AtMost(bound) => self.value <= bound,
            Bound::AtLeast(bound) => self.value >= bound,
            Bound::Anywhere => true,
        }
    }
}

/// Result of an attack.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Outcome {
    /// Name of the attack.
    pub name: &'static str,
    /// Description of the attack.
    pub about: &'static str,
    /// Figures that the attack measured.
    pub figures: Vec<Figure>,
}

impl Outcome {
    /// Returns true if every figure is within its bound.
    pub fn is_held(&self) -> bool {
        self.figures.iter().all(Figure::holds)
    }

    /// Formats the figures in one line, and adds the bound to each one that exceeds it.
    pub fn words(&self) -> String {
        let word = |figure: &Figure| {
            let mark =
                if figure.holds() { String::new() } else { format!(" (not {})", figure.bound.words()) };
            format!("{} {}{mark}", figure.quantity, rounded(figure.value))
        };
        self.figures.iter().map(word).collect::<Vec<_>>().join(", ")
    }
}

impl Attack {
    /// Runs the attack.
    ///
    /// # Errors
    /// If the attack cannot be run.
    pub fn attempt(&self, effort: Effort) -> Result<Outcome> {
        Ok(Outcome { name: self.name, about: self.about, figures: (self.run)(effort)? })
    }
}

/// Formats a value with its significant digits.
fn rounded(value: f64) -> String {
    match value.abs() {
        0.0 => "0".into(),
        size if size < 0.01 => format!("{value:.1e}"),
        size if size < 10.0 && value.fract() != 0.0 => format!("{value:.2}"),
        _ => format!("{value:.0}"),
    }
}
