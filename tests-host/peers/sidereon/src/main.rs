//! ARAIM by `sidereon-core` beside ours, on one machine and the same epochs: time of an epoch, and
//! results.
//!
//! The epochs are the committed reference vectors (`tests-host/vectors`) whose own solution raises
//! no alarm, because `sidereon-core` takes no residuals and so neither tests nor excludes. It
//! solves each subset anew in doubles, where ours divides once. It has the same allocation
//! (LPV-200), and at most as many simultaneous faults. Ours tests every mode, too, and is timed
//! from the solved snapshot on.
//!
//! Times depend on the machine as much as on the program, so they have no budget.

use std::hint::black_box;
use std::io::Read as _;
use std::path::Path;
use std::time::Instant;

use anyhow::{Context as _, Result};
use flate2::read::GzDecoder;
use serde::Deserialize;

mod ours;
mod theirs;

/// Duration of the measurement of one figure, s.
const MEASURED_S: f64 = 0.2;

/// A line of the vectors: the input of both programs.
#[derive(Deserialize)]
struct Line {
    con: Vec<usize>,
    los_enu: Vec<[f64; 3]>,
    sigma: Vec<f64>,
    sigma_acc: Vec<f64>,
    b_nom: Vec<f64>,
    p_sat: Vec<f64>,
    p_const: std::collections::BTreeMap<String, f64>,
    y: Vec<f64>,
    out: Outcomes,
}

/// Results of the program that made the vectors.
#[derive(Deserialize)]
struct Outcomes {
    lpv: Outcome,
}

#[derive(Deserialize)]
struct Outcome {
    status: String,
    detected: Option<bool>,
    /// Level, m: a number, or a word for infinity.
    hpl: Option<serde_json::Value>,
    vpl: Option<serde_json::Value>,
}

/// Result of a program for an epoch.
struct Answer {
    modes: usize,
    /// Horizontal and vertical level, m.
    levels_m: [f64; 2],
}

impl Line {
    fn is_calm(&self) -> bool {
        self.out.lpv.status == "ok" && self.out.lpv.detected == Some(false)
    }

    fn constellations(&self) -> usize {
        self.con.iter().collect::<std::collections::BTreeSet<_>>().len()
    }
}

/// Returns the mean time of a call, µs.
fn microseconds<R>(mut call: impl FnMut() -> R) -> f64 {
    black_box(call());
    let (start, mut calls) = (Instant::now(), 0_u32);
    while start.elapsed().as_secs_f64() < MEASURED_S {
        black_box(call());
        calls += 1;
    }
    start.elapsed().as_secs_f64() * 1e6 / f64::from(calls)
}

fn lines() -> Result<Vec<Line>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../vectors/araim.jsonl.gz");
    let file = std::fs::File::open(&path).with_context(|| path.display().to_string())?;
    let mut text = String::new();
    GzDecoder::new(file).read_to_string(&mut text)?;
    text.lines().map(|line| Ok(serde_json::from_str(line)?)).collect()
}

fn main() -> Result<()> {
    println!(
        "satellites  systems | modes: ours  theirs | us: ours f32  ours f64  theirs | HPL, VPL, m: reference  ours f32  theirs"
    );
    let mut lines = lines()?;
    lines.retain(Line::is_calm);
    lines.sort_by_key(|line| (line.constellations(), line.con.len()));
    for line in &lines {
        let single = ours::judge::<f32>(line)?;
        let theirs = theirs::Case::of(line)?;
        let answer = theirs.judge();
        let (f32_us, f64_us) = (ours::microseconds::<f32>(line)?, ours::microseconds::<f64>(line)?);
        let (theirs_us, theirs_modes, theirs_levels) = match &answer {
            Ok(answer) => (
                format!("{:8.1}", microseconds(|| theirs.judge())),
                answer.modes.to_string(),
                format!("{:.2} {:.2}", answer.levels_m[0], answer.levels_m[1]),
            ),
            Err(error) => ("-".to_owned(), "-".to_owned(), error.to_string()),
        };
        println!(
            "{:10}  {:7} | {:11}  {theirs_modes:>6} | {f32_us:12.1}  {f64_us:8.1}  {theirs_us:>6} | {:.2} {:.2}  {:.2} {:.2}  {theirs_levels}",
            line.con.len(),
            line.constellations(),
            single.modes,
            metres(line.out.lpv.hpl.as_ref()),
            metres(line.out.lpv.vpl.as_ref()),
            single.levels_m[0],
            single.levels_m[1],
        );
    }
    Ok(())
}

fn metres(value: Option<&serde_json::Value>) -> f64 {
    value.and_then(serde_json::Value::as_f64).unwrap_or(f64::NAN)
}
