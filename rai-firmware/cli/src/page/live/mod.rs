//! The state of a running module as a page shows it live: its values as JSON, and the page's own parts.
//!
//! `rai run --page` serves it, and the page for a browser alone makes it by itself.

mod state;

use serde_json::{Value, json};

pub use state::State;

use super::palette;

/// Script: a function that draws the state, with the past before it.
pub const SCRIPT: &str = include_str!("live.js");

/// Elements that the script fills.
pub const BODY: &str = include_str!("live.html");

/// Style of these elements, beside that of every page.
pub const STYLE: &str = include_str!("live.css");

/// Returns the style of a page: that of every page, the colours, and that of these elements.
pub fn style() -> String {
    [super::html::STYLE, &palette::style(), STYLE].concat()
}

/// Returns the state as the page and `/state.json` have it.
pub fn json(state: &State) -> Value {
    let reported = state.reported.as_ref();
    let level =
        |of: fn(&crate::verdict::State) -> Option<f64>| reported.and_then(|reported| of(&reported.state));
    let position = reported.and_then(|reported| reported.position);
    let satellites: Vec<Value> = state.satellites.iter().map(satellite).collect();
    json!({
        "state": state.word(),
        "reason": state.reason(),
        "explanation": state.explanation(),
        "pin": state.pin_is_high,
        "has_ranges": !state.lacks_ranges,
        "verdicts": state.verdicts,
        "utc_s": reported.and_then(|reported| reported.state.time_s),
        "age_s": state.age().map(|age| rounded(age.as_secs_f64(), 3)),
        "tracked": reported.map(|reported| reported.state.tracked),
        "used": reported.map(|reported| reported.state.used),
        "dof": reported.and_then(|reported| reported.state.dof),
        "statistic": level(|reported| reported.statistic),
        "threshold": level(|reported| reported.threshold),
        "hpl_m": level(|reported| reported.hpl_m),
        "vpl_m": level(|reported| reported.vpl_m),
        "hal_m": level(|reported| reported.hal_m),
        "val_m": level(|reported| reported.val_m),
        "latitude_deg": position.map(|place| rounded(place.latitude_rad.to_degrees(), 7)),
        "longitude_deg": position.map(|place| rounded(place.longitude_rad.to_degrees(), 7)),
        "height_m": position.map(|place| rounded(place.height_m, 1)),
        "excluded": reported.map(|reported| {
            reported.excluded.iter().map(|excluded| excluded.satellite.to_string()).collect::<Vec<_>>()
        }),
        "satellites": satellites,
        "input": state.input,
        "settings": state.settings,
        "version": env!("CARGO_PKG_VERSION"),
    })
}

fn satellite(seen: &crate::satellites::Account) -> Value {
    let degrees = |angle: Option<f64>| angle.map(|angle| rounded(angle.to_degrees(), 1));
    json!({
        "name": seen.satellite.to_string(),
        "azimuth_deg": degrees(seen.azimuth_rad),
        "elevation_deg": degrees(seen.elevation_rad),
        "cn0_dbhz": seen.cn0_dbhz.map(|value| rounded(value, 1)),
        "residual_m": seen.residual_m.map(|value| rounded(value, 2)),
        "sigma_m": seen.sigma_m.map(|value| rounded(value, 2)),
        "fate": seen.fate.words(),
    })
}

fn rounded(value: f64, digits: i32) -> f64 {
    let scale = 10_f64.powi(digits);
    (value * scale).round() / scale
}
