//! What the page serves: HTML, JSON, and metrics in the text format of Prometheus.

use std::fmt::Write as _;

use serde_json::{Value, json};

use super::digest;
use super::state::State;
use crate::page::palette;

const SCRIPT: &str = include_str!("live.js");
const BODY: &str = include_str!("live.html");

/// Returns the style: that of every page, the colours, and that of this one.
fn style() -> String {
    [include_str!("../../page/page.css"), &palette::style(), include_str!("live.css")].concat()
}

/// The page, and the policy that allows its style and its script and nothing else.
#[derive(Debug)]
pub(super) struct Html {
    pub(super) page: String,
    pub(super) policy: String,
}

impl Html {
    pub(super) fn new() -> Self {
        let style = style();
        let policy = format!(
            "default-src 'none'; script-src {}; style-src {}; connect-src 'self'; base-uri 'none'; form-action 'none'; \
             frame-ancestors 'none'",
            digest::source(SCRIPT),
            digest::source(&style)
        );
        let page = format!(
            "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>RAI</title>\n\
             <style>{style}</style>\n</head>\n<body>\n{BODY}<script>{SCRIPT}</script>\n</body>\n</html>\n"
        );
        Self { page, policy }
    }
}

/// Returns the state as the page and `/state.json` have it.
pub(super) fn state(state: &State) -> Value {
    let said = state.said.as_ref();
    let level = |of: fn(&crate::sentence::State) -> Option<f64>| said.and_then(|said| of(&said.state));
    let position = said.and_then(|said| said.position);
    let satellites: Vec<Value> = state.satellites.iter().map(satellite).collect();
    json!({
        "state": state.word(),
        "reason": state.reason(),
        "explanation": state.explanation(),
        "pin": state.pin_is_high,
        "has_ranges": !state.lacks_ranges,
        "verdicts": state.verdicts,
        "utc_s": said.and_then(|said| said.state.time_s),
        "age_s": state.age().map(|age| rounded(age.as_secs_f64(), 3)),
        "tracked": said.map(|said| said.state.tracked),
        "used": said.map(|said| said.state.used),
        "dof": said.and_then(|said| said.state.dof),
        "statistic": level(|said| said.statistic),
        "threshold": level(|said| said.threshold),
        "hpl_m": level(|said| said.hpl_m),
        "vpl_m": level(|said| said.vpl_m),
        "hal_m": level(|said| said.hal_m),
        "val_m": level(|said| said.val_m),
        "latitude_deg": position.map(|place| rounded(place.latitude_rad.to_degrees(), 7)),
        "longitude_deg": position.map(|place| rounded(place.longitude_rad.to_degrees(), 7)),
        "height_m": position.map(|place| rounded(place.height_m, 1)),
        "excluded": said.map(|said| {
            said.excluded.iter().map(|excluded| excluded.satellite.to_string()).collect::<Vec<_>>()
        }),
        "satellites": satellites,
        "input": state.input,
        "settings": state.settings,
        "version": env!("CARGO_PKG_VERSION"),
    })
}

fn satellite(seen: &crate::satellites::Seen) -> Value {
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

/// Returns the metrics, in the text format of Prometheus, version 0.0.4.
pub(super) fn metrics(state: &State) -> String {
    let mut text = String::new();
    let mut gauge = |name: &str, help: &str, value: Option<f64>| {
        if let Some(value) = value {
            let _ = write!(text, "# HELP {name} {help}\n# TYPE {name} gauge\n{name} {value}\n");
        }
    };
    let said = state.said.as_ref().map(|said| &said.state);
    let is = |yes: bool| Some(f64::from(u8::from(yes)));
    gauge("rai_protected", "1 while the position may be used.", is(state.word() == "protected"));
    gauge("rai_alert", "1 while the position must not be used.", is(state.word() == "alert"));
    gauge("rai_pin_high", "Level of the integrity pin.", is(state.pin_is_high));
    gauge(
        "rai_receiver_ranges",
        "0 while the receiver sends messages and no ranges any more.",
        is(!state.lacks_ranges),
    );
    gauge(
        "rai_verdict_age_seconds",
        "Time since the last verdict.",
        state.age().map(|age| age.as_secs_f64()),
    );
    gauge("rai_satellites_tracked", "Satellites tracked.", said.map(|said| f64::from(said.tracked)));
    gauge("rai_satellites_used", "Satellites used.", said.map(|said| f64::from(said.used)));
    gauge("rai_test_statistic", "Square root of SSE/dof.", said.and_then(|said| said.statistic));
    gauge("rai_test_threshold", "Threshold of the statistic.", said.and_then(|said| said.threshold));
    gauge("rai_hpl_meters", "Horizontal protection level.", said.and_then(|said| said.hpl_m));
    gauge("rai_vpl_meters", "Vertical protection level.", said.and_then(|said| said.vpl_m));
    gauge("rai_hal_meters", "Horizontal alert limit.", said.and_then(|said| said.hal_m));
    gauge("rai_val_meters", "Vertical alert limit.", said.and_then(|said| said.val_m));
    text.push_str("# HELP rai_reason_info Reason of the state.\n# TYPE rai_reason_info gauge\n");
    let _ = writeln!(text, "rai_reason_info{{reason=\"{}\"}} 1", state.reason());
    text.push_str(
        "# HELP rai_events_total Counters of the module, by name.\n# TYPE rai_events_total counter\n",
    );
    for (name, count) in &state.counters {
        let _ = writeln!(text, "rai_events_total{{name=\"{name}\"}} {count}");
    }
    if let Some([passed, refused]) = state.back.as_ref().map(|back| back.counts()) {
        text.push_str(
            "# HELP rai_share_bytes_total Bytes of other programs for the receiver.\n\
             # TYPE rai_share_bytes_total counter\n",
        );
        let _ = writeln!(text, "rai_share_bytes_total{{fate=\"passed\"}} {passed}");
        let _ = writeln!(text, "rai_share_bytes_total{{fate=\"refused\"}} {refused}");
    }
    text
}
