//! The values of a report as its script reads them: JSON with columns in base64.
//!
//! | key | content |
//! |---|---|
//! | `t0`, `scale` | Unix time of second 0 in ms, or null; name of the time scale |
//! | `n`, `stretch` | number of buckets; epochs of a bucket |
//! | `col` | columns of the buckets by name: `v` one value for all, or `lo` and perhaps `hi` |
//! | `reasons` | verdict and reason by number |
//! | `st`, `sats` | times of the satellites' buckets; satellites with their columns |
//! | `fates` | treatments of a satellite by number |
//! | `beside` | lines of another receiver: with the statistic, with the horizontal error |
//! | `faults` | injected faults: name, from and to in s |

use std::fmt::Write as _;

use serde_json::json;

use super::code::base64;
use super::epochs::{Bucket, CURVES, VALUES};
use super::facts::Facts;
use super::journal::Journal;
use super::satellites::{Satellite, Spot};
use crate::page::chart::Series;
use crate::satellites::Fate;

/// GPS time 0 in Unix time, ms.
const GPS_EPOCH_MS: i64 = 315_964_800_000;

/// Appends the values as JSON that may stand in a page.
pub(super) fn json(journal: &Journal, facts: &Facts, text: &mut String) {
    text.push('{');
    let mut field = |name: &str, value: &serde_json::Value| {
        // Names come from a command line; none of them may end the script.
        let value = value.to_string().replace('<', "\\u003c");
        let _ = write!(text, "\"{name}\":{value},");
    };
    field("t0", &json!(start_ms(journal)));
    field("scale", &json!(scale(journal)));
    field("n", &json!(journal.epochs.buckets.len()));
    field("stretch", &json!(journal.epochs.stretch));
    field("mask", &json!(facts.mask_deg));
    let reasons = journal.counts.iter().map(|count| json!([count.verdict.word(), count.reason]));
    field("reasons", &reasons.collect());
    field("fates", &Fate::ALL.map(Fate::words).as_slice().into());
    let faults = facts.incidents.iter().map(|one| json!([one.name, one.range_s.start, one.range_s.end]));
    field("faults", &faults.collect());
    let beside = |lines: &[Series]| -> serde_json::Value {
        let line = |line: &Series| {
            let (times, values): (Vec<f64>, Vec<f64>) = line.points.iter().copied().unzip();
            json!({ "name": line.name, "t": times, "v": values })
        };
        lines.iter().map(line).collect()
    };
    field("beside", &facts.beside.iter().map(Vec::as_slice).map(beside).collect());
    columns(journal, text);
    satellites(journal, text);
    text.push('}');
}

/// Returns the Unix time of second 0, ms: UTC, or GPS time if the difference is unknown.
pub(super) fn start_ms(journal: &Journal) -> Option<i64> {
    let start_ms = journal.start?.to_ms().cast_signed();
    Some(start_ms + GPS_EPOCH_MS - 1000 * journal.leap_s.unwrap_or(0))
}

/// Returns the name of the time scale.
pub(super) fn scale(journal: &Journal) -> &'static str {
    match (journal.start, journal.leap_s) {
        (None, _) => "s",
        (Some(_), None) => "GPS time",
        (Some(_), Some(_)) => "UTC",
    }
}

/// Appends a column: one value if all are equal, else all of them.
fn column<T: PartialEq + Copy, const N: usize>(
    text: &mut String,
    name: &str,
    values: &[T],
    bytes: impl Fn(T) -> [u8; N],
) {
    let _ = write!(text, "\"{name}\":\"");
    let is_one = values.first().is_some_and(|first| values.iter().all(|value| value == first));
    let values = if is_one { &values[..1] } else { values };
    let all: Vec<u8> = values.iter().flat_map(|value| bytes(*value)).collect();
    base64(&all, text);
    text.push_str("\",");
}

fn columns(journal: &Journal, text: &mut String) {
    let (buckets, is_thinned) = (&journal.epochs.buckets, journal.epochs.stretch > 1);
    let codes = |pick: &dyn Fn(&Bucket) -> i16| -> Vec<i16> { buckets.iter().map(pick).collect() };
    let small = |pick: fn(&Bucket) -> u8| -> Vec<u8> { buckets.iter().map(pick).collect() };
    text.push_str("\"col\":{");
    let times: Vec<u32> = buckets.iter().map(|bucket| bucket.first_ms).collect();
    column(text, "t", &times, u32::to_le_bytes);
    for (index, name) in CURVES.iter().enumerate() {
        column(text, name, &codes(&|bucket| bucket.low[index]), i16::to_le_bytes);
        if is_thinned {
            column(text, &format!("{name}+"), &codes(&|bucket| bucket.high[index]), i16::to_le_bytes);
        }
    }
    for (index, name) in VALUES.iter().enumerate() {
        // Bits, because NaN is not equal to itself.
        let bits: Vec<u32> = buckets.iter().map(|bucket| bucket.values[index].to_bits()).collect();
        column(text, name, &bits, u32::to_le_bytes);
    }
    column(text, "reason", &small(|bucket| bucket.reason), |byte| [byte]);
    column(text, "severity", &small(|bucket| bucket.severity), |byte| [byte]);
    column(text, "pin", &small(|bucket| bucket.pin), |byte| [byte]);
    column(text, "used", &small(|bucket| bucket.used), |byte| [byte]);
    column(text, "excluded", &small(|bucket| bucket.excluded), |byte| [byte]);
    end(text);
}

fn satellites(journal: &Journal, text: &mut String) {
    text.push_str("\"st\":\"");
    let times: Vec<u8> =
        journal.satellites.times_ms.iter().flat_map(|time_ms| time_ms.to_le_bytes()).collect();
    base64(&times, text);
    text.push_str("\",\"sats\":[");
    for (satellite, known) in &journal.satellites.all {
        let _ = write!(text, "{{\"n\":\"{satellite}\",\"b\":\"");
        base64(&packed(known), text);
        text.push_str("\"},");
    }
    if text.ends_with(',') {
        text.pop();
    }
    text.push(']');
}

/// Returns the columns of a track one after the other, those of 16 bits first.
fn packed(satellite: &Satellite) -> Vec<u8> {
    let track = &satellite.track;
    let wide: [fn(&Spot) -> i16; 7] = [
        |spot| spot.bucket as i16,
        |spot| spot.residual[0],
        |spot| spot.residual[1],
        |spot| spot.sigma,
        |spot| spot.w_test,
        |spot| spot.direction[0],
        |spot| spot.direction[1],
    ];
    let small: [fn(&Spot) -> u8; 3] = [|spot| spot.cn0[0], |spot| spot.cn0[1], |spot| spot.fate];
    let of_wide = wide.iter().flat_map(|pick| track.iter().flat_map(move |spot| pick(spot).to_le_bytes()));
    let of_small = small.iter().flat_map(|pick| track.iter().map(pick));
    of_wide.chain(of_small).collect()
}

/// Ends an object whose last field has a comma behind it.
fn end(text: &mut String) {
    if text.ends_with(',') {
        text.pop();
    }
    text.push_str("},");
}
