//! Epochs of one constellation, with a forecast receiver clock as the row after the satellites.

use raim_core::internals::integrity::raim::detection::detect;
use raim_core::internals::integrity::raim::detection::threshold::Thresholds;
use raim_core::internals::integrity::raim::isolation::baarda::identify;
use raim_core::internals::least_squares::equations::LinearEpoch;
use raim_core::internals::least_squares::{Snapshot, Workspace};
use raim_core::internals::numeric::real::Real;
use raim_core::satellite::Constellation;
use serde::Serialize;
use serde_json::{Map, Value};

use super::line::{array, direction_of, number, numbers, probability};
use super::number::Number;
use super::{MAX_ROWS, RowCache};

/// Probability needed only for the tables, which come in pairs. The test does not use missed
/// detection.
const MISSED_DETECTION: f64 = 1e-3;

/// Result of the test of satellites and clock, with the names of the published vectors.
#[derive(Serialize)]
#[allow(non_snake_case, reason = "names of the published vectors")]
pub(super) struct ClockRaim {
    dof: usize,
    sse: Number,
    tau1: Number,
    test_m: Number,
    T_D_m: Number,
    detected: bool,
    /// Squared w-test of each row, the clock last.
    d: Vec<Number>,
    /// Identified row, or −1. The clock is the row after the satellites.
    ident: isize,
    ident_is_clock: bool,
}

/// Tests one line: satellites with one `sigma`, a forecast `T` with `sigma_b`.
pub(super) fn evaluate<T: Real>(
    object: &Map<String, Value>,
    rows: &mut RowCache,
) -> Result<ClockRaim, String> {
    let sigma_m = number(object, "sigma")?;
    let mut workspace = Workspace::of(epoch::<T>(object, sigma_m)?);
    let snapshot = workspace.solve().map_err(|error| error.to_string())?;
    let false_alarm = probability("pfa", number(object, "pfa")?)?;
    let missed_detection = probability("pmd", MISSED_DETECTION)?;
    rows.prepare(false_alarm, missed_detection);
    let thresholds = rows.thresholds(false_alarm, missed_detection);
    judge(&snapshot, sigma_m, &thresholds)
}

fn epoch<T: Real>(object: &Map<String, Value>, sigma_m: f64) -> Result<LinearEpoch<T, MAX_ROWS>, String> {
    let directions = array(object, "los_enu")?;
    let residuals_m = numbers(array(object, "y")?, "y")?;
    if residuals_m.len() != directions.len() {
        return Err(format!("y: {} entries, but los_enu has {}", residuals_m.len(), directions.len()));
    }
    let mut epoch = LinearEpoch::new();
    for (index, (direction, residual_m)) in directions.iter().zip(residuals_m).enumerate() {
        let direction =
            direction_of(direction).ok_or_else(|| format!("los_enu[{index}]: not three numbers"))?;
        epoch
            .satellite(Constellation::Gps, direction, residual_m, sigma_m)
            .map_err(|error| format!("satellite {index}: {error}"))?;
    }
    let (value_m, sigma_b_m) = (number(object, "T")?, number(object, "sigma_b")?);
    epoch.clock(Constellation::Gps, value_m, sigma_b_m).map_err(|error| format!("T: {error}"))?;
    Ok(epoch)
}

fn judge<T: Real>(
    snapshot: &Snapshot<'_, T>,
    sigma_m: f64,
    thresholds: &Thresholds<'_>,
) -> Result<ClockRaim, String> {
    let dof = snapshot.dof();
    let detection =
        detect(snapshot, thresholds).ok_or_else(|| format!("{dof} degrees of freedom: no test"))?;
    let identified = detection.fault().then(|| identify(snapshot, thresholds));
    let named = match identified {
        Some(Ok(index)) => Some(index),
        _ => None,
    };
    let squared = snapshot.rows().map(|(_, fit)| fit.w_test().widen()).map(|w| Number(w * w));
    let statistic = detection.statistic();
    Ok(ClockRaim {
        dof,
        sse: Number(detection.sse.widen()),
        tau1: Number(detection.threshold.widen()),
        test_m: Number(sigma_m * statistic.statistic),
        T_D_m: Number(sigma_m * statistic.threshold),
        detected: detection.fault(),
        d: squared.collect(),
        ident: named.map_or(-1, usize::cast_signed),
        ident_is_clock: named.is_some_and(|index| index + 1 == snapshot.used()),
    })
}
