//! What the page serves: HTML, JSON, and metrics in the text format of Prometheus.

use std::fmt::Write as _;

use super::digest;
use crate::page::live::{self, State};
use crate::run::share::Back;

/// The script: the pictures, and the events that they show.
const SCRIPT: &str = concat!(include_str!("../../page/live/live.js"), include_str!("events.js"));
/// What the page has below its pictures, because a server is behind it.
const FOOT: &str = include_str!("foot.html");

/// The page, and the policy that allows its style and its script and nothing else.
#[derive(Debug)]
pub(super) struct Html {
    pub(super) page: String,
    pub(super) policy: String,
}

impl Html {
    pub(super) fn new() -> Self {
        let style = live::style();
        let policy = format!(
            "default-src 'none'; script-src {}; style-src {}; connect-src 'self'; base-uri 'none'; form-action 'none'; \
             frame-ancestors 'none'",
            digest::source(SCRIPT),
            digest::source(&style)
        );
        let page = format!(
            "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>RAI</title>\n\
             <style>{style}</style>\n</head>\n<body>\n<main>\n<h1>Receiver integrity</h1>\n{}{FOOT}</main>\n<script>{SCRIPT}</script>\n</body>\n</html>\n",
            live::BODY
        );
        Self { page, policy }
    }
}

/// Returns the metrics, in the text format of Prometheus, version 0.0.4.
pub(super) fn metrics(state: &State, back: Option<&Back>) -> String {
    let mut text = String::new();
    let mut gauge = |name: &str, help: &str, value: Option<f64>| {
        if let Some(value) = value {
            let _ = write!(text, "# HELP {name} {help}\n# TYPE {name} gauge\n{name} {value}\n");
        }
    };
    let reported = state.reported.as_ref().map(|reported| &reported.state);
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
    gauge(
        "rai_satellites_tracked",
        "Satellites tracked.",
        reported.map(|reported| f64::from(reported.tracked)),
    );
    gauge("rai_satellites_used", "Satellites used.", reported.map(|reported| f64::from(reported.used)));
    gauge("rai_test_statistic", "Square root of SSE/dof.", reported.and_then(|reported| reported.statistic));
    gauge(
        "rai_test_threshold",
        "Threshold of the statistic.",
        reported.and_then(|reported| reported.threshold),
    );
    gauge("rai_hpl_meters", "Horizontal protection level.", reported.and_then(|reported| reported.hpl_m));
    gauge("rai_vpl_meters", "Vertical protection level.", reported.and_then(|reported| reported.vpl_m));
    gauge("rai_hal_meters", "Horizontal alert limit.", reported.and_then(|reported| reported.hal_m));
    gauge("rai_val_meters", "Vertical alert limit.", reported.and_then(|reported| reported.val_m));
    text.push_str("# HELP rai_reason_info Reason of the state.\n# TYPE rai_reason_info gauge\n");
    let _ = writeln!(text, "rai_reason_info{{reason=\"{}\"}} 1", state.reason());
    text.push_str(
        "# HELP rai_events_total Counters of the module, by name.\n# TYPE rai_events_total counter\n",
    );
    for (name, count) in &state.counters {
        let _ = writeln!(text, "rai_events_total{{name=\"{name}\"}} {count}");
    }
    if let Some([passed, refused]) = back.map(Back::counts) {
        text.push_str(
            "# HELP rai_share_bytes_total Bytes of other programs for the receiver.\n\
             # TYPE rai_share_bytes_total counter\n",
        );
        let _ = writeln!(text, "rai_share_bytes_total{{fate=\"passed\"}} {passed}");
        let _ = writeln!(text, "rai_share_bytes_total{{fate=\"refused\"}} {refused}");
    }
    text
}
