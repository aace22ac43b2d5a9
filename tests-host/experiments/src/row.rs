//! One line of a table: the paper's value beside ours.

use serde::Serialize;

use super::Interval;

/// What became of a printed number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Judgement {
    /// The same within rounding and chance.
    Reproduced,
    /// The same order and shape, numbers near.
    InTrend,
    /// Cannot be reproduced; the reason says why.
    NotReproducible,
    /// No paper has it.
    Ours,
}

impl Judgement {
    /// In lower-case words.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Reproduced => "reproduced",
            Self::InTrend => "in trend",
            Self::NotReproducible => "not reproducible",
            Self::Ours => "ours",
        }
    }
}

/// What we found.
#[derive(Clone, Debug, PartialEq)]
pub enum Finding {
    /// A number, how many decimals of it mean something, and how far chance may have moved it.
    Number {
        /// The number.
        value: f64,
        /// Decimals to print.
        decimals: usize,
        /// Its 95 % confidence interval; `None` where it is exact.
        interval: Option<Interval>,
    },
    /// What is no number.
    Words(String),
}

impl Finding {
    /// A number that chance has no part in.
    pub const fn exact(value: f64, decimals: usize) -> Self {
        Self::Number { value, decimals, interval: None }
    }

    /// A rate with its interval.
    pub fn rate(hits: usize, trials: usize, decimals: usize) -> Self {
        let value = if trials == 0 { f64::NAN } else { hits as f64 / trials as f64 };
        Self::Number { value, decimals, interval: Some(Interval::of_rate(hits, trials)) }
    }

    /// A count of rare events with the interval of its expectation.
    pub fn count(count: usize) -> Self {
        Self::Number { value: count as f64, decimals: 0, interval: Some(Interval::of_count(count)) }
    }

    /// The number, where it is one.
    pub fn value(&self) -> Option<f64> {
        match self {
            Self::Number { value, .. } => Some(*value),
            Self::Words(_) => None,
        }
    }

    /// The value as text.
    pub fn text(&self) -> String {
        match self {
            Self::Number { value, decimals, .. } => format!("{value:.decimals$}"),
            Self::Words(words) => words.clone(),
        }
    }

    /// The interval as text, one decimal more than the value; empty where there is none.
    pub fn interval_text(&self) -> String {
        match self {
            Self::Number { interval: Some(Interval { low, high }), decimals, .. } => {
                format!("{low:.0$} … {high:.0$}", decimals + 1)
            }
            _ => String::new(),
        }
    }
}

/// A value that the product is held to.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Acceptance {
    /// Row of the table of acceptance; `None` for what is asked for beyond it.
    pub number: Option<u8>,
    /// What is asked for, in words.
    pub want: String,
    /// Whether it holds.
    pub holds: bool,
}

/// One quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// What it is, with its unit.
    pub quantity: String,
    /// What the paper prints; empty where it prints nothing.
    pub paper: String,
    /// What we found.
    pub ours: Finding,
    /// How they compare.
    pub judgement: Judgement,
    /// Why, in one line.
    pub reason: String,
    /// What it is held to, if anything.
    pub acceptance: Option<Acceptance>,
}

impl Row {
    /// A row without a reason and without a bound to hold.
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

    /// The same row with its reason.
    #[must_use]
    pub fn because(mut self, reason: impl Into<String>) -> Self {
        self.reason = reason.into();
        self
    }

    /// The same row, held to a value within a tolerance.
    #[must_use]
    pub fn held_to(mut self, number: u8, want: f64, tolerance: f64) -> Self {
        // A value that is not a number holds nothing.
        let holds = self.ours.value().is_some_and(|value| (value - want).abs() <= tolerance);
        self.acceptance =
            Some(Acceptance { number: Some(number), want: format!("{want} ± {tolerance}"), holds });
        self
    }

    /// The same row, held to a statement.
    #[must_use]
    pub fn held_if(mut self, number: u8, want: impl Into<String>, holds: bool) -> Self {
        self.acceptance = Some(Acceptance { number: Some(number), want: want.into(), holds });
        self
    }

    /// The same row, held to a statement that is in no table of acceptance.
    #[must_use]
    pub fn holding(mut self, want: impl Into<String>, holds: bool) -> Self {
        self.acceptance = Some(Acceptance { number: None, want: want.into(), holds });
        self
    }
}
