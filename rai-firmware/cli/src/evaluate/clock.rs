//! Windows of receiver clocks: the core's process and its forecasts, and other estimators for
//! comparison.

use raim_core::internals::clock::{Autoregression, CoastingClock, MIN_VALUES, Observed};
use raim_core::internals::numeric::real::Real;
use serde::Serialize;
use serde_json::{Map, Value};

use super::line::{array, numbers};
use super::number::Number;
use crate::signal::clock_models::{Levels, Process, burg, centred_differences, polynomial, yule_walker};

/// Number of steps forecast from each window.
const STEPS: usize = 10;

/// Largest number of values in a line.
const MAX_VALUES: usize = 240;

/// Forecasts of a window, with the names of the published vectors.
#[derive(Serialize)]
pub(super) struct Forecasts {
    uc: Entry,
    burg: Entry,
    yw: Option<Entry>,
    sigma2: Variances,
    poly1: Option<Entry>,
    poly2: Option<Entry>,
}

#[derive(Serialize)]
struct Entry {
    #[serde(skip_serializing_if = "Option::is_none")]
    a: Option<Vec<Number>>,
    forecast: Vec<Number>,
    sigma_predict: Vec<Number>,
}

#[derive(Serialize)]
struct Variances {
    uc: Number,
    burg: Number,
    yw: Option<Number>,
}

/// Forecasts from one line: `Z`, oldest first, one step apart, m.
pub(super) fn evaluate<T: Real>(object: &Map<String, Value>) -> Result<Forecasts, String> {
    let levels_m = numbers(array(object, "Z")?, "Z")?;
    if !(MIN_VALUES..=MAX_VALUES).contains(&levels_m.len()) {
        return Err(format!("Z: {} values, must be {MIN_VALUES} to {MAX_VALUES}", levels_m.len()));
    }
    let clock = observed::<T>(&levels_m)?;
    let (differences, mean_m) = centred_differences(&levels_m);
    let last_m = levels_m.last().copied().unwrap_or_default();
    let other = |process: &Process| {
        let levels = process.levels(last_m, &differences, mean_m, STEPS);
        Entry { a: Some(process.coefficients.map(Number).to_vec()), ..levels.into() }
    };
    let (burg, yule_walker) = (burg(&differences), yule_walker(&differences));
    Ok(Forecasts {
        uc: coasted(&clock, levels_m.len())?,
        burg: other(&burg),
        yw: yule_walker.as_ref().map(other),
        sigma2: Variances {
            uc: Number(clock.process().variance().widen()),
            burg: Number(burg.variance),
            yw: yule_walker.map(|process| Number(process.variance)),
        },
        poly1: polynomial(&levels_m, 1, STEPS).map(Entry::from),
        poly2: polynomial(&levels_m, 2, STEPS).map(Entry::from),
    })
}

/// Returns a clock that has observed the values one second apart.
fn observed<T: Real>(levels_m: &[f64]) -> Result<CoastingClock<T, MAX_VALUES>, String> {
    let mut clock = CoastingClock::new();
    for (index, &level_m) in levels_m.iter().enumerate() {
        // The sigma of a value does not enter the process. A large one accepts any step between
        // values.
        let uptake = clock.observe(index as f64, level_m, SIGMA_M);
        let wanted = if index == 0 { Observed::Restarted } else { Observed::Continued };
        if uptake != wanted {
            return Err(format!("Z[{index}]: {level_m} does not continue the window"));
        }
    }
    Ok(clock)
}

/// Standard deviation of the values, m.
const SIGMA_M: f64 = 100.0;

fn coasted<T: Real>(clock: &CoastingClock<T, MAX_VALUES>, count: usize) -> Result<Entry, String> {
    let process: &Autoregression<T> = clock.process();
    let ahead: Option<Vec<_>> = (0..STEPS).map(|step| clock.forecast((count + step) as f64)).collect();
    let ahead = ahead.ok_or("Z: no forecast from this window")?;
    Ok(Entry {
        a: Some(process.coefficients().map(|a| Number(a.widen())).to_vec()),
        forecast: ahead.iter().map(|forecast| Number(forecast.value_m)).collect(),
        sigma_predict: ahead.iter().map(|forecast| Number(forecast.sigma_predict_m)).collect(),
    })
}

impl From<Levels> for Entry {
    fn from(levels: Levels) -> Self {
        let numbers = |values: Vec<f64>| values.into_iter().map(Number).collect();
        Self { a: None, forecast: numbers(levels.forecast), sigma_predict: numbers(levels.sigma_predict) }
    }
}
