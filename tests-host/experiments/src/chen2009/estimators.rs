//! "U-C is the estimator of the highest accuracy": bias and spread of three estimators on short
//! records.
//!
//! `x_t = Σ a_k x_{t−k} + e_t`, `e ~ N(0, 1)`, with known `a`; each estimator receives `n` values,
//! centred.
//!
//! | symbol | meaning |
//! |---|---|
//! | bias | largest of the three `|mean(â_k) − a_k|` |
//! | spread | largest of the three standard deviations of `â_k` |
//!
//! The paper gives neither a process nor a record length. The process here has a pair of poles near
//! the unit circle ([`COEFFICIENTS`]), like a clock with little measurement noise; there the
//! estimators differ most. References: [Chen2009] §1.3.
//!
//! [Chen2009]: raim#references

use indicatif::ProgressBar;
use raim::in_order::Together as _;
use raim::signal::clock_models::{burg, yule_walker};
use raim_core::internals::clock::Autoregression;
use rand_distr::{Distribution, StandardNormal};

use super::super::draw::generator;
use super::super::{Finding, Interval, Judgement, Row, Section};

/// Number of values of one record.
const RECORD: usize = 120;

/// Number of values before the record in which the process forgets its start.
const WARM_UP: usize = 500;

/// Coefficients `a_1, a_2, a_3`.
const COEFFICIENTS: [f64; 3] = [1.4, -0.9, 0.25];

const SEED: u64 = 0x0A_12E5;

/// Coefficients by estimator.
type Estimates = [[f64; 3]; 3];

const NAMES: [&str; 3] = ["Ulrych–Clayton", "Burg", "Yule–Walker"];

fn record(run: u64) -> Vec<f64> {
    let mut generator = generator(SEED, run);
    let mut values = vec![0.0; 3];
    for _ in 0..WARM_UP + RECORD {
        let innovation: f64 = StandardNormal.sample(&mut generator);
        let latest_first = values.iter().rev();
        let next = COEFFICIENTS.iter().zip(latest_first).map(|(a, x)| a * x).sum::<f64>() + innovation;
        values.push(next);
    }
    let record = values.split_off(values.len() - RECORD);
    let mean = record.iter().sum::<f64>() / RECORD as f64;
    record.iter().map(|x| x - mean).collect()
}

fn estimates(run: u64) -> Option<Estimates> {
    let record = record(run);
    // Single precision, as on the target.
    let core = Autoregression::<f32>::fit(record.iter().map(|&x| Some(x as f32)));
    Some([core.coefficients().map(f64::from), burg(&record).coefficients, yule_walker(&record)?.coefficients])
}

/// Errors of one estimator's coefficients.
struct Accuracy {
    bias: f64,
    interval: Interval,
    deviation: f64,
}

impl Accuracy {
    fn of_coefficient(errors: &[f64]) -> Self {
        let count = errors.len() as f64;
        let mean = errors.iter().sum::<f64>() / count;
        let squares: f64 = errors.iter().map(|error| (error - mean).powi(2)).sum();
        let Interval { low, high } = Interval::of_mean(errors);
        let interval = if mean < 0.0 { Interval { low: -high, high: -low } } else { Interval { low, high } };
        Self { bias: mean.abs(), interval, deviation: libm::sqrt(squares / count) }
    }

    /// Returns the larger of each error.
    fn worse(self, other: Self) -> Self {
        let deviation = self.deviation.max(other.deviation);
        Self { deviation, ..if other.bias > self.bias { other } else { self } }
    }

    fn of(all: &[Estimates], estimator: usize) -> Self {
        let errors = |index: usize, want: f64| -> Vec<f64> {
            all.iter().map(|estimates| estimates[estimator][index] - want).collect()
        };
        let each = COEFFICIENTS.iter().enumerate();
        let each = each.map(|(index, &want)| Self::of_coefficient(&errors(index, want)));
        let none = Self { bias: -1.0, interval: Interval { low: 0.0, high: 0.0 }, deviation: 0.0 };
        each.fold(none, Self::worse)
    }
}

pub(super) fn section(records: usize, bar: &ProgressBar) -> Section {
    let estimated = |record: u64| {
        bar.inc(1);
        estimates(record)
    };
    let all: Vec<Estimates> = (0..records as u64).together(estimated).flatten().collect();
    let mut rows = Vec::new();
    for (estimator, name) in NAMES.into_iter().enumerate() {
        let Accuracy { bias, interval, deviation } = Accuracy::of(&all, estimator);
        let bias = Finding::Number { value: bias, decimals: 3, interval: Some(interval) };
        let quantity = format!("{name}: largest bias of a coefficient");
        rows.push(match estimator {
            0 => Row::new(quantity, "highest accuracy", bias, Judgement::InTrend)
                .because("True against Yule–Walker only; Burg's estimate is as good."),
            _ => Row::new(quantity, "", bias, Judgement::Ours),
        });
        let quantity = format!("{name}: largest standard deviation");
        rows.push(Row::new(quantity, "", Finding::exact(deviation, 3), Judgement::Ours));
    }
    Section { title: format!("Estimators of a third-order process from {RECORD} values"), rows }
}
