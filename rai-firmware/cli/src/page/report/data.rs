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
use std::io::{self, Write};

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

/// Writes the values as JSON that may stand in a page.
///
/// # Errors
/// The writer's own.
pub(super) fn json(journal: &Journal, facts: &Facts, out: &mut impl Write) -> io::Result<()> {
    let mut fields = String::new();
    let mut field = |name: &str, value: &serde_json::Value| {
        // Names come from a command line; none of them may end the script.
        let value = value.to_string().replace('<', "\\u003c");
        let _ = write!(fields, "\"{name}\":{value},");
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
    write!(out, "{{{fields}\"col\":{{")?;
    columns(journal, out)?;
    write!(out, "}},\"st\":\"")?;
    satellites(journal, out)?;
    write!(out, "]}}")
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

/// Appends a column with a comma behind it: one value if all are equal, else all of them. The
/// values are read twice and never copied, because a day has many.
fn column<T: PartialEq + Copy, const N: usize>(
    out: &mut impl Write,
    name: &str,
    values: impl Iterator<Item = T> + Clone,
    bytes: impl Fn(T) -> [u8; N],
) -> io::Result<()> {
    let mut others = values.clone();
    let is_one = others.next().is_some_and(|first| others.all(|value| value == first));
    let count = if is_one { 1 } else { usize::MAX };
    write!(out, "\"{name}\":\"")?;
    base64(values.take(count).flat_map(bytes), out)?;
    write!(out, "\",")
}

/// Name and value of a column of bytes.
type Small = (&'static str, fn(&Bucket) -> u8);

fn columns(journal: &Journal, out: &mut impl Write) -> io::Result<()> {
    let (buckets, is_thinned) = (&journal.epochs.buckets, journal.epochs.stretch > 1);
    for (index, name) in CURVES.iter().enumerate() {
        column(out, name, buckets.iter().map(|bucket| bucket.low[index]), i16::to_le_bytes)?;
        if is_thinned {
            let high = journal.epochs.high.iter().map(|codes| codes[index]);
            column(out, &format!("{name}+"), high, i16::to_le_bytes)?;
        }
    }
    for (index, name) in VALUES.iter().enumerate() {
        // Bits, because NaN is not equal to itself.
        let bits = buckets.iter().map(|bucket| bucket.values[index].to_bits());
        column(out, name, bits, u32::to_le_bytes)?;
    }
    let small: [Small; 5] = [
        ("reason", |bucket| bucket.reason),
        ("severity", |bucket| bucket.severity),
        ("pin", |bucket| bucket.pin),
        ("used", |bucket| bucket.used),
        ("excluded", |bucket| bucket.excluded),
    ];
    for (name, pick) in small {
        column(out, name, buckets.iter().map(pick), |byte| [byte])?;
    }
    // Times are never all equal, and end the object without a comma.
    write!(out, "\"t\":\"")?;
    base64(buckets.iter().flat_map(|bucket| bucket.first_ms.to_le_bytes()), out)?;
    write!(out, "\"")
}

/// Appends the times of the satellites' buckets, and the satellites.
fn satellites(journal: &Journal, out: &mut impl Write) -> io::Result<()> {
    base64(journal.satellites.times_ms.iter().flat_map(|time_ms| time_ms.to_le_bytes()), out)?;
    write!(out, "\",\"sats\":[")?;
    for (index, (satellite, known)) in journal.satellites.all.iter().enumerate() {
        write!(out, "{}{{\"n\":\"{satellite}\",\"b\":\"", if index > 0 { "," } else { "" })?;
        base64(packed(known), out)?;
        write!(out, "\"}}")?;
    }
    Ok(())
}

/// Returns the columns of a track one after the other, those of 16 bits first.
fn packed(satellite: &Satellite) -> impl Iterator<Item = u8> {
    const WIDE: [fn(&Spot) -> i16; 7] = [
        |spot| spot.bucket as i16,
        |spot| spot.residual[0],
        |spot| spot.residual[1],
        |spot| spot.sigma,
        |spot| spot.w_test,
        |spot| spot.direction[0],
        |spot| spot.direction[1],
    ];
    const SMALL: [fn(&Spot) -> u8; 3] = [|spot| spot.cn0[0], |spot| spot.cn0[1], |spot| spot.fate];
    let track = &satellite.track;
    let of_wide = WIDE.iter().flat_map(|pick| track.iter().flat_map(move |spot| pick(spot).to_le_bytes()));
    of_wide.chain(SMALL.iter().flat_map(|pick| track.iter().map(pick)))
}
