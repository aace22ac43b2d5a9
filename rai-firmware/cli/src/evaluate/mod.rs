//! Linearised epochs through the core: JSON lines in, JSON lines out.
//!
//! Each input line is one epoch about a known point; each output line is the result of `rai-core`
//! for it. Everything except the thresholds of unusual probabilities is the core's own code, in
//! `f64` or in `f32`.
//!
//! ```text
//! {"id": 7, "los_enu": [[e, n, u], …], "con": [0, …], "sigma": [6.0, …], "y": [-3.1, …],
//!  "pfa": 1e-5, "pmd": 1e-3, "hal": 556, "f": 0.95}
//! {"id": 7, "out": {"lsr": {"status": "ok", …}}}
//! ```
//!
//! A line that is not such an object gives `{"id": …, "error": "what and where"}`, and the run
//! continues. An object whose numbers do not form an epoch (a sigma of zero, a NaN residual) is
//! answered with the status `invalid_input` and the reason in `why`.

mod araim;
mod bound;
mod clock;
mod clock_raim;
pub mod command;
mod iso;
mod line;
mod lsr;
mod number;
mod ransac;
mod thresholds;

use std::collections::HashMap;
use std::io::{self, BufRead, Read as _, Write};

use anyhow::{Context as _, ensure};
use flate2::bufread::MultiGzDecoder;
use raim_core::internals::integrity::raim::detection::threshold::Thresholds;
use raim_core::internals::integrity::raim::isolation::ransac::ConsensusLimits;
use raim_core::internals::numeric::probability::Probability;
use raim_core::internals::numeric::real::Real;
use serde::Serialize;
use serde_json::Value;

use crate::second_opinion::thresholds::Rows;
use araim::Araim;
use bound::Bound;
use clock::Forecasts;
use clock_raim::ClockRaim;
use iso::Iso;
use line::Line;
use lsr::Lsr;
use ransac::{Ransac, Traditional};

/// Help text of the command: the fields of a line.
pub const HELP: &str = "\
One JSON object per line, in and out. Input fields (unknown ones are ignored):
  id        anything; echoed
  los_enu   [[e, n, u], …] unit vectors receiver → satellite
  con       [0 GPS | 1 BeiDou | 2 Galileo | 3 GLONASS, …]
  sigma     [m, …]     y  [m, …] measured minus predicted range
  pfa, pmd  probabilities of false alarm and of missed detection, in (0, 0.5)
  hal       horizontal alert limit, m, above 0     f  share of it that the protection level may fill, in (0, 1]
  clock     optional {con, value_m, sigma_m}: a predicted receiver clock; takes the row after the satellites
  scalar    optional, \"f64\" (default) or \"f32\": scalar type of the core
  alpha     optional, 0.01: probability that a healthy row's correlation exceeds rho_T
  kmax      optional, 2: rows that isolation may leave out, 1 to 3
  tr_pfa, chi_pfa  optional, 1e-3 and 1e-4: false disagreement and false alarm of the range consensus
Output: {id, out: {lsr: {…}, iso: {…}, ransac: {…}, ransac_trad: {…}}} or {id, error}. Fields of lsr, as far as the status allows:
  status    ok | no_redundancy | insufficient | singular | invalid_input (then also: why)
  n, m, dof rows, unknowns, degrees of freedom
  x, v      position (east, north, up) and clocks (ascending con), m; residuals, m
  sse, hdop, vdop
  tau1, lam, test = sqrt(sse/dof), T1n = sqrt(tau1/dof), detected
  w, Td     w-tests and their threshold     Sii  redundancy numbers
  slope_h, slope_v, hpl, vpl, hdop_i, delta = (f hal / max slope_h)^2, raim_available
  tau2, tau_op_raw, tau_op, op_status       thresholds of the policies    op | op_is_tau1 | op_is_tau2 | unavailable
  ident, ident_reason                       identified row, or -1 and the reason
  excluded, fde_status, sse_after, dof_after, x_after   sequential exclusion of at most 3 rows
Fields of iso, with the status ok: rho, rho_T, and the rows named by the methods
  A simultaneous, seq sequential, B, C hybrid without and with grouping, D grouping: null failed, [] nothing detected
Fields of ransac, with at least two satellites per unknown
  subsets, best (the subset accepted), fault, status    ok | too_few_subsets | no_inlier_subset
  fault_refined, status_refined                         also refine_fail
Fields of ransac_trad, with at most 1500 minimal subsets: K valid and n_out contradicted ones; f, tot for each row; fault
NaN is null, infinity \"inf\". Rows for probabilities outside the committed tables are computed on the host.
The exit code is 1 if a line has an error; the other lines are answered.

With --thresholds each line is {id, nu, pfa, pmd, delta}: degrees of freedom, probabilities, and non-centrality
of the fault that must be detected. Output: the same with tau1, lam, tau2, tau_op_raw, tau_op, status.

With --clock each line is a window of one receiver clock: {id, Z: [m, …]}, 12 to 240 values one step apart, oldest first.
Output: out.uc, the core's third-order process, and for comparison burg, yw (Yule-Walker), poly1, poly2; for each
  a                coefficients of the centred differences, latest first (not for polynomials)
  forecast         the clock 1 … 10 steps ahead, m     sigma_predict  its standard deviation, not inflated, m
and out.sigma2, variances of one step of uc, burg and yw, m2.

With --clock-raim each line is an epoch of one constellation aided by a forecast clock:
{id, los_enu, sigma: m, y: [m, …], T: forecast, m, sigma_b: its standard deviation, m, pfa}
Output: out with dof, sse, tau1, test_m = sigma sqrt(sse/dof), T_D_m = sigma sqrt(tau1/dof), detected,
  d (squared w-tests, the clock last), ident (row or -1), ident_is_clock.

With --araim each line is an epoch with integrity parameters of each satellite:
{id, los_enu, con, sigma: m, for integrity, y: [m, …], sigma_acc: [m, …] for accuracy, b_nom: [m, …], p_sat: [...],
 p_const: {con: probability}}
Output: out.lpv and out.haraim, for the allocations of approaches with vertical guidance and of horizontal flight:
  status           ok | insufficient | singular | invalid_input (then also: why)
  n_options, rho   number of possible exclusions after an alarm, and the share of the risk of each outcome
  n_modes, p_nm    number of monitored modes, probability of the unmonitored ones
  K_fa, x, pl      thresholds in sigmas, position, levels: each east, north, up    hpl, vpl  m
  emt, sigma_v_acc effective monitor threshold, standard deviation of the height for accuracy, m
  detected, max_ratio (largest separation over its threshold), dominant (rows of the mode with the largest share)
  excl, hpl_excl, vpl_excl, x_excl, p_nm_excl   after an alarm: rows left out, or null, and the results without them";

/// Largest number of rows in a line: the end of the tables of w-tests and, with four unknowns, of
/// those of `tau1`.
const MAX_ROWS: usize = raim_core::internals::integrity::raim::detection::threshold::MAX_TESTS;

/// Scalar type of the core.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scalar {
    /// Double precision, as references are.
    F64,
    /// Single precision, as on the target.
    F32,
}

impl std::str::FromStr for Scalar {
    type Err = String;

    fn from_str(word: &str) -> Result<Self, String> {
        match word {
            "f64" => Ok(Self::F64),
            "f32" => Ok(Self::F32),
            other => Err(format!("`{other}` is neither f64 nor f32")),
        }
    }
}

/// Kind of the input lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Linearised epochs.
    Epochs,
    /// Degrees of freedom, probabilities and a non-centrality.
    Thresholds,
    /// Windows of receiver clocks.
    Clock,
    /// Linearised epochs of one constellation, aided by a forecast clock.
    ClockRaim,
    /// Linearised epochs with integrity parameters of each satellite.
    Araim,
}

/// Counts of a run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Summary {
    /// Number of lines that are not blank.
    pub lines: usize,
    /// Number of lines answered by an error.
    pub errors: usize,
    /// The first of these errors.
    pub first_error: Option<String>,
}

/// Most bytes of a line: a hundred times those of the longest epoch. A line without an end must not
/// fill the memory.
const LINE_BYTES: u64 = 4 << 20;

/// One line of output.
#[derive(Serialize)]
#[serde(untagged)]
enum Answer {
    Out { id: Value, out: Box<Out> },
    Thresholds(Box<thresholds::Answered>),
    Clock { id: Value, out: Box<Forecasts> },
    ClockRaim { id: Value, out: Box<ClockRaim> },
    Araim { id: Value, out: Box<Araim> },
    Error { id: Value, error: String },
}

/// Answer to an epoch, part by part.
#[derive(Serialize)]
struct Out {
    lsr: Lsr,
    #[serde(skip_serializing_if = "Option::is_none")]
    bound: Option<Bound>,
    #[serde(skip_serializing_if = "Option::is_none")]
    iso: Option<Iso>,
    #[serde(skip_serializing_if = "Option::is_none")]
    ransac: Option<Ransac>,
    #[serde(skip_serializing_if = "Option::is_none")]
    ransac_trad: Option<Traditional>,
}

impl From<Lsr> for Out {
    fn from(lsr: Lsr) -> Self {
        Self { lsr, bound: None, iso: None, ransac: None, ransac_trad: None }
    }
}

/// Answers every epoch of `input`, which may be compressed; `scalar` overrides the choice of the
/// lines.
///
/// # Errors
/// If reading or writing fails. A bad line is an answer.
pub fn run(input: impl BufRead, output: impl Write, scalar: Option<Scalar>) -> anyhow::Result<Summary> {
    run_part(Part::Epochs, input, output, scalar)
}

/// Answers every line of `input` as the given kind.
///
/// # Errors
/// As [`run`].
pub fn run_part(
    part: Part,
    input: impl BufRead,
    output: impl Write,
    scalar: Option<Scalar>,
) -> anyhow::Result<Summary> {
    let mut input = decompressed(input)?;
    let mut output = io::BufWriter::new(output);
    let mut rows = RowCache::default();
    let (mut summary, mut bytes, mut number) = (Summary::default(), Vec::new(), 0);
    loop {
        bytes.clear();
        number += 1;
        let mut line = input.by_ref().take(LINE_BYTES);
        let length = line.read_until(b'\n', &mut bytes).with_context(|| format!("reading line {number}"))?;
        if length == 0 {
            break;
        }
        ensure!(
            (length as u64) < LINE_BYTES,
            "line {number} has more than {LINE_BYTES} bytes, and no epoch has"
        );
        let text = bytes.trim_ascii_end();
        if text.is_empty() {
            continue;
        }
        let answer = answer(part, text, number, scalar, &mut rows);
        summary.lines += 1;
        if let Answer::Error { error, .. } = &answer {
            summary.errors += 1;
            summary.first_error.get_or_insert_with(|| error.clone());
        }
        serde_json::to_writer(&mut output, &answer).context("writing an answer")?;
        output.write_all(b"\n").context("writing an answer")?;
    }
    output.flush().context("writing the answers")?;
    Ok(summary)
}

/// Returns the input itself, or the content of a gzip stream, recognised by its first two bytes.
fn decompressed<'a>(mut input: impl BufRead + 'a) -> anyhow::Result<Box<dyn BufRead + 'a>> {
    let compressed = input.fill_buf().context("reading the input")?.starts_with(&[0x1f, 0x8b]);
    Ok(if compressed { Box::new(io::BufReader::new(MultiGzDecoder::new(input))) } else { Box::new(input) })
}

fn answer(part: Part, bytes: &[u8], number: usize, scalar: Option<Scalar>, rows: &mut RowCache) -> Answer {
    let value: Value = match serde_json::from_slice(bytes) {
        Ok(value) => value,
        Err(error) => {
            let (text, column) = (error.to_string(), error.column());
            let what = text.split(" at line").next().unwrap_or_default();
            let error = format!("line {number}, column {column}: not JSON: {what}");
            return Answer::Error { id: Value::Null, error };
        }
    };
    let id = value.get("id").cloned().unwrap_or(Value::Null);
    answer_part(part, &id, &value, scalar, rows)
        .unwrap_or_else(|error| Answer::Error { id, error: format!("line {number}: {error}") })
}

fn answer_part(
    part: Part,
    id: &Value,
    value: &Value,
    scalar: Option<Scalar>,
    rows: &mut RowCache,
) -> Result<Answer, String> {
    let id = id.clone();
    if part == Part::Epochs {
        let line = Line::read(value)?;
        let out = judge(&line, scalar.unwrap_or(line.scalar), rows)?;
        return Ok(Answer::Out { id, out: Box::new(out) });
    }
    let object = value.as_object().ok_or("not a JSON object")?;
    let single = scalar.map_or_else(|| line::scalar(object), Ok)? == Scalar::F32;
    if part == Part::Thresholds {
        let of = if single { thresholds::evaluate::<f32> } else { thresholds::evaluate::<f64> };
        return Ok(Answer::Thresholds(Box::new(of(object, rows)?)));
    }
    if part == Part::Clock {
        let out = if single { clock::evaluate::<f32>(object) } else { clock::evaluate::<f64>(object) };
        return Ok(Answer::Clock { id, out: Box::new(out?) });
    }
    if part == Part::Araim {
        let out = if single { araim::evaluate::<f32>(object) } else { araim::evaluate::<f64>(object) };
        return Ok(Answer::Araim { id, out: Box::new(out?) });
    }
    let out = if single {
        clock_raim::evaluate::<f32>(object, rows)
    } else {
        clock_raim::evaluate::<f64>(object, rows)
    };
    Ok(Answer::ClockRaim { id, out: Box::new(out?) })
}

fn judge(line: &Line, scalar: Scalar, rows: &mut RowCache) -> Result<Out, String> {
    let (false_alarm, missed_detection) = match line.probabilities() {
        Ok(pair) => pair,
        Err(why) => return Ok(Lsr::invalid(line, why).into()),
    };
    let disagreement = line::probability("tr_pfa", line.isolation.tr_pfa)?;
    let refinement = line::probability("chi_pfa", line.isolation.chi_pfa)?;
    for alarm in [false_alarm, disagreement, refinement] {
        rows.prepare(alarm, missed_detection);
    }
    let thresholds = rows.thresholds(false_alarm, missed_detection);
    let limits = ConsensusLimits {
        consensus: rows.thresholds(disagreement, missed_detection),
        refinement: rows.thresholds(refinement, missed_detection),
    };
    match scalar {
        Scalar::F64 => parts::<f64>(line, &thresholds, &limits),
        Scalar::F32 => parts::<f32>(line, &thresholds, &limits),
    }
}

/// Returns every part of an answer, as far as the status allows.
fn parts<T: Real>(
    line: &Line,
    thresholds: &Thresholds<'_>,
    limits: &ConsensusLimits<'_>,
) -> Result<Out, String> {
    let lsr = lsr::evaluate::<T>(line, thresholds)?;
    let mut workspace = lsr::workspace::<T>(line);
    let snapshot = workspace.as_mut().and_then(|workspace| workspace.solve().ok());
    let Some(mut snapshot) = snapshot.filter(|snapshot| snapshot.dof() > 0) else { return Ok(lsr.into()) };
    Ok(Out {
        lsr,
        iso: Some(iso::evaluate(&line.isolation, &snapshot, thresholds)?),
        ransac: ransac::evaluate(line, &snapshot, limits),
        ransac_trad: ransac::traditional(line, &limits.consensus),
        bound: Some(Bound::of(line, &mut snapshot, thresholds)?),
    })
}

/// Rows for probabilities outside the committed tables, computed once for each pair.
#[derive(Default)]
struct RowCache(HashMap<(u64, u64), Rows>);

impl RowCache {
    fn key(false_alarm: Probability, missed_detection: Probability) -> (u64, u64) {
        (false_alarm.get().to_bits(), missed_detection.get().to_bits())
    }

    /// Computes the rows of a pair if they are missing.
    fn prepare(&mut self, false_alarm: Probability, missed_detection: Probability) {
        if Thresholds::from_tables(false_alarm, missed_detection).is_err() {
            let compute = || Rows::compute(false_alarm.get(), missed_detection.get());
            self.0.entry(Self::key(false_alarm, missed_detection)).or_insert_with(compute);
        }
    }

    /// Returns the rows of a pair; [`Self::prepare`] must come first.
    fn thresholds(&self, false_alarm: Probability, missed_detection: Probability) -> Thresholds<'_> {
        Thresholds::from_tables(false_alarm, missed_detection).unwrap_or_else(|_| {
            let rows = &self.0[&Self::key(false_alarm, missed_detection)];
            Thresholds::from_rows(&rows.tau1, &rows.lambda, &rows.w_test)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn line_without_an_end_is_refused_before_it_fills_the_memory() {
        let endless = io::BufReader::new(io::repeat(b'x').take(100 << 20));
        let error = run(endless, io::sink(), None).unwrap_err().to_string();
        assert!(error.contains("line 1 has more than 4194304 bytes"), "{error}");
    }

    #[test]
    fn first_error_of_a_text_is_kept() {
        let summary = run(&b"$GPGGA,1*00\n$GPGGA,2*00\n"[..], io::sink(), None).unwrap();
        let reason = summary.first_error.unwrap();
        assert_eq!(summary.errors, 2);
        assert!(reason.starts_with("line 1, column 1: not JSON"), "{reason}");
    }
}
