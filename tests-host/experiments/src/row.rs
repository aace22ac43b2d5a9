//! One line of a table: the paper's value beside ours.

use serde::Serialize;

use super::Interval;

/// Comparison with a printed number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Judgement {
    /// Equal within rounding and chance.
    Reproduced,
    /// Same order and shape, with similar numbers.
    InTrend,
    /// Not reproducible; the reason is given.
    NotReproducible,
    /// Printed in no paper.
    Ours,
}

impl Judgement {
    /// Returns lower-case words.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Reproduced => "reproduced",
            Self::InTrend => "in trend",
            Self::NotReproducible => "not reproducible",
            Self::Ours => "ours",
        }
    }
}

/// Value that we found.
#[derive(Clone, Debug, PartialEq)]
pub enum Finding {
    /// A number with its significant decimals and its uncertainty.
    Number {
        /// The number.
        value: f64,
        /// Decimals to print.
        decimals: usize,
        /// Its 95 % confidence interval; `None` if it is exact.
        interval: Option<Interval>,
    },
    /// A text instead of a number.
    Words(String),
}

impl Finding {
    /// Returns a number without chance in it.
    pub const fn exact(value: f64, decimals: usize) -> Self {
        Self::Number { value, decimals, interval: None }
    }

    /// Returns a rate with its interval.
    pub fn rate(hits: usize, trials: usize, decimals: usize) -> Self {
        let value = if trials == 0 { f64::NAN } else { hits as f64 / trials as f64 };
        Self::Number { value, decimals, interval: Some(Interval::of_rate(hits, trials)) }
    }

    /// Returns a count of rare events, with the interval of its expectation.
    pub fn count(count: usize) -> Self {
        Self::Number { value: count as f64, decimals: 0, interval: Some(Interval::of_count(count)) }
    }

    /// Returns the number, if it is one.
    pub fn value(&self) -> Option<f64> {
        match self {
            Self::Number { value, .. } => Some(*value),
            Self::Words(_) => None,
        }
    }

    /// Returns the value as text.
    pub fn text(&self) -> String {
        match self {
            Self::Number { value, decimals, .. } => format!("{value:.decimals$}"),
            Self::Words(words) => words.clone(),
        }
    }

    /// Returns the interval as text, with one decimal more than the value; empty if there is none.
    pub fn interval_text(&self) -> String {
        match self {
            Self::Number { interval: Some(Interval { low, high }), decimals, .. } => {
                format!("{low:.0$} … {high:.0$}", decimals + 1)
            }
            _ => String::new(),
        }
    }
}

/// Value that the product must reach.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Acceptance {
    /// Row of the table of acceptance; `None` for requirements beyond it.
    pub number: Option<u8>,
    /// Requirement, in words.
    pub want: String,
    /// True if the requirement is met.
    pub holds: bool,
}

/// One quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Name of the quantity, with its unit.
    pub quantity: String,
    /// Value printed in the paper; empty if there is none.
    pub paper: String,
    /// Value that we found.
    pub ours: Finding,
    /// Comparison of the two.
    pub judgement: Judgement,
    /// Reason for the comparison, one line.
    pub reason: String,
    /// Acceptance value, if any.
    pub acceptance: Option<Acceptance>,
}

impl Row {
    /// Returns a row without a reason and without an acceptance value.
    pub fn new(
        quantity: impl Into<String>,
        paper: impl Into<String>,
        ours: Finding,
        judgement: Judgement,
    ) -> Self {
        Self {
            quantity: quantity.into(),
            paper: paper.into(),
            ours,
            judgement,
            reason: String::new(),
            acceptance: None,
        }
    }

    /// Adds a reason.
    #[must_use]
    pub fn because(mut self, reason: impl Into<String>) -> Self {
        self.reason = reason.into();
        self
    }

    /// Adds an acceptance value with a tolerance.
    #[must_use]
    pub fn held_to(mut self, number: u8, want: f64, tolerance: f64) -> Self {
        // NaN meets no requirement.
        let holds = self.ours.value().is_some_and(|value| (value - want).abs() <= tolerance);
        self.acceptance =
            Some(Acceptance { number: Some(number), want: format!("{want} ± {tolerance}"), holds });
        self
    }

    /// Adds an acceptance statement.
    #[must_use]
    pub fn held_if(mut self, number: u8, want: impl Into<String>, holds: bool) -> Self {
        self.acceptance = Some(Acceptance { number: Some(number), want: want.into(), holds });
        self
    }

    /// Adds an acceptance statement that is in no table of acceptance.
    #[must_use]
    pub fn holding(mut self, want: impl Into<String>, holds: bool) -> Self {
        self.acceptance = Some(Acceptance { number: None, want: want.into(), holds });
        self
    }
}
