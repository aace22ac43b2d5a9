//! The numbers of an epoch as its sentences round them.
//!
//! | number | sentence | rounded to |
//! |---|---|---|
//! | latitude, longitude | `GNS`, `GGA` | 1e-7 minutes |
//! | height | `GNS`, `GGA`: altitude and separation of the geoid | 1 mm |
//! | statistic, threshold | `PRAIS` | 0.001, at most 99,999 |
//! | levels, limits | `PRAIS` | 0.1 m |
//! | w-test, bias | `PRAIX` | 0.001, 0.1 m |
//!
//! `PRAIS` has fewer decimals if the sentence would be too long, and so have the numbers here. An
//! altitude above 10 km can have fewer in its sentence, and not here.

use raim_core::frame::Geodetic;
use raim_core::report::{Solution, Suspect};
use raim_core::requirements::Requirements;

use super::TimeOfDay;
use super::position::degrees;
use super::proprietary::{FULL, MAX_STATISTIC, precision};
use super::sentence::{rounded, rounded_minutes};
use crate::output::Statement;
use crate::output::geoid::Altitude;

/// Position, test, levels and limits. Unknown, unbounded and unusable values are `None`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Figures {
    /// Position above the ellipsoid; `None` in an alert.
    pub position: Option<Geodetic>,
    /// Test statistic `√(SSE/dof)`, dimensionless.
    pub statistic: Option<f64>,
    /// Threshold of the statistic, dimensionless.
    pub threshold: Option<f64>,
    /// Horizontal protection level, m; `None` in an alert.
    pub hpl_m: Option<f64>,
    /// Vertical protection level, m; `None` in an alert.
    pub vpl_m: Option<f64>,
    /// Horizontal alert limit, m.
    pub hal_m: Option<f64>,
    /// Vertical alert limit, m.
    pub val_m: Option<f64>,
}

impl Figures {
    /// Returns the numbers of an epoch.
    pub(crate) fn of<const N: usize>(statement: &Statement<'_, N>) -> Self {
        let precision = precision(statement, TimeOfDay::new(statement.time, statement.gps_minus_utc_s));
        let ratio = |value: Option<f64>| {
            rounded(value?.min(MAX_STATISTIC), precision.ratio_decimals, precision.ratio_width)
        };
        let metres = |value: Option<f64>| rounded(value?, precision.metre_decimals, precision.metre_width);
        let (test, (hpl_m, vpl_m)) = (statement.report.test, statement.levels_m());
        Self {
            position: statement.usable_solution().and_then(position),
            statistic: ratio(test.map(|test| test.statistic)),
            threshold: ratio(test.map(|test| test.threshold)),
            hpl_m: metres(hpl_m),
            vpl_m: metres(vpl_m),
            hal_m: metres(Some(statement.requirements.hal_m)),
            val_m: metres(statement.requirements.val_m),
        }
    }

    /// Returns the limits alone.
    pub(crate) fn without_epoch(requirements: &Requirements) -> Self {
        let metres = |value: Option<f64>| rounded(value?, FULL.metre_decimals, FULL.metre_width);
        Self { hal_m: metres(Some(requirements.hal_m)), val_m: metres(requirements.val_m), ..Self::default() }
    }

    /// Returns w-test and bias of an excluded satellite, m, as `PRAIX` has them; NaN for one without
    /// bounds.
    pub fn of_suspect(suspect: &Suspect) -> [f64; 2] {
        [(suspect.w_test, 3), (suspect.bias_m, 1)]
            .map(|(value, decimals)| rounded(value, decimals, 14).unwrap_or(f64::NAN))
    }
}

/// Returns a position as `GNS` has it.
fn position(solution: &Solution) -> Option<Geodetic> {
    let Geodetic { latitude_rad, longitude_rad, .. } = solution.geodetic;
    let altitude = Altitude::of(&solution.geodetic);
    Some(Geodetic {
        latitude_rad: angle_rad(latitude_rad)?,
        longitude_rad: angle_rad(longitude_rad)?,
        height_m: rounded(altitude.above_sea_m, 3, 12)? + rounded(altitude.separation_m, 1, 6)?,
    })
}

/// Returns an angle as a reader of `dddmm.mmmmmmm` computes it.
fn angle_rad(angle_rad: f64) -> Option<f64> {
    let [whole, field] = rounded_minutes(degrees(angle_rad))?;
    let angle_deg = whole + (field - 100.0 * whole) / 60.0;
    Some(if angle_rad < 0.0 { -angle_deg } else { angle_deg }.to_radians())
}
