//! The core against the published vectors: epochs with 1 to 4 constellations and 0 to 3 faults, and
//! edge cases.
//!
//! `want` was computed elsewhere, with a full-column solution in double precision. Tolerances are
//! those of the specification; fields without an absolute tolerance there receive one if a value
//! may be nearly zero.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};

use flate2::read::GzDecoder;
use oracle::vectors::path;
use raim::evaluate::{self, Part, Scalar};
use serde_json::Value;

/// Tolerance of a field.
#[derive(Clone, Copy)]
struct Tolerance {
    relative: f64,
    absolute: f64,
}

const fn within(relative: f64, absolute: f64) -> Tolerance {
    Tolerance { relative, absolute }
}

/// Numeric fields, with their tolerance in double and in single precision.
#[rustfmt::skip]
const TOLERANCES: [(&str, [Tolerance; 2]); 24] = [
    ("x",        [within(0.0, 1e-6), within(1e-6, 0.05)]),
    ("v",        [within(0.0, 1e-6), within(1e-3, 0.05)]),
    ("sse",      [within(1e-9, 1e-7), within(1e-3, 1e-3)]),
    ("hdop",     [within(1e-9, 1e-9), within(1e-3, 0.0)]),
    ("vdop",     [within(1e-9, 1e-9), within(1e-3, 0.0)]),
    ("tau1",     [within(1e-10, 0.0), within(2e-5, 0.0)]),
    ("lam",      [within(1e-10, 0.0), within(2e-5, 0.0)]),
    ("test",     [within(1e-9, 1e-7), within(1e-3, 1e-3)]),
    ("T1n",      [within(1e-10, 0.0), within(2e-5, 0.0)]),
    ("w",        [within(1e-9, 1e-9), within(1e-3, 1e-2)]),
    ("Td",       [within(1e-10, 0.0), within(2e-5, 0.0)]),
    ("Sii",      [within(1e-9, 1e-9), within(1e-3, 1e-4)]),
    ("slope_h",  [within(1e-9, 1e-9), within(3e-3, 1e-3)]),
    ("slope_v",  [within(1e-9, 1e-9), within(3e-3, 1e-3)]),
    ("hpl",      [within(1e-9, 1e-9), within(1e-3, 0.0)]),
    ("vpl",      [within(1e-9, 1e-9), within(1e-3, 0.0)]),
    ("hdop_i",   [within(1e-9, 1e-9), within(1e-3, 0.0)]),
    ("delta",    [within(1e-9, 0.0), within(2e-3, 0.0)]),
    ("sse_after",[within(1e-9, 1e-7), within(1e-3, 1e-2)]),
    ("x_after",  [within(0.0, 1e-6), within(1e-6, 0.05)]),
    ("n",        [within(0.0, 0.0), within(0.0, 0.0)]),
    ("m",        [within(0.0, 0.0), within(0.0, 0.0)]),
    ("dof",      [within(0.0, 0.0), within(0.0, 0.0)]),
    ("dof_after",[within(0.0, 0.0), within(0.0, 0.0)]),
];

/// Fields that are decisions.
const DECISIONS: [&str; 7] =
    ["status", "detected", "raim_available", "ident", "ident_reason", "excluded", "fde_status"];

/// Distance from a threshold below which single precision may decide otherwise.
const F32_MARGIN: f64 = 1e-3;

/// Smallest singular value of the geometry for which the single-precision tolerances hold.
const F32_SINGULAR_VALUE: f64 = 0.05;

fn vectors(name: &str) -> Vec<Value> {
    let file = File::open(path(name)).expect("a readable file");
    let lines = BufReader::new(GzDecoder::new(file)).lines();
    lines.map(|line| serde_json::from_str(&line.expect("text")).expect("JSON")).collect()
}

fn evaluated(name: &str, scalar: Scalar) -> Vec<Value> {
    evaluated_as(Part::Epochs, name, scalar)
}

fn evaluated_as(part: Part, name: &str, scalar: Scalar) -> Vec<Value> {
    let file = BufReader::new(File::open(path(name)).expect("a readable file"));
    let mut output = Vec::new();
    let summary =
        evaluate::run_part(part, file, &mut output, Some(scalar)).expect("a run without I/O errors");
    assert_eq!(summary.errors, 0);
    output.lines().map(|line| serde_json::from_str(&line.expect("text")).expect("JSON")).collect()
}

fn number(value: &Value) -> f64 {
    match value {
        Value::String(word) => word.parse().expect("a number in words"),
        value => value.as_f64().unwrap_or(f64::NAN),
    }
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().map_or_else(|| vec![number(value)], |list| list.iter().map(number).collect())
}

fn close(have: f64, want: f64, tolerance: Tolerance) -> bool {
    if want.is_finite() {
        (have - want).abs() <= tolerance.absolute + tolerance.relative * want.abs()
    } else {
        // Infinities of one sign, and NaN, have an order among all doubles.
        have.total_cmp(&want).is_eq()
    }
}

/// Compares the values of one answer and returns their number; panics at the first that is not
/// close.
fn compare_numbers(id: &Value, have: &Value, want: &Value, scalar: Scalar) -> usize {
    let mut compared = 0;
    for (field, [double, single]) in TOLERANCES {
        let Some(want) = want.get(field) else { continue };
        let tolerance = if scalar == Scalar::F64 { double } else { single };
        let (have, want) = (numbers(&have[field]), numbers(want));
        assert_eq!(have.len(), want.len(), "epoch {id} {field}");
        for (&have, &want) in have.iter().zip(&want) {
            assert!(
                close(have, want, tolerance),
                "epoch {id} {field} {scalar:?}: have {have:e}, want {want:e}"
            );
            compared += 1;
        }
    }
    compared
}

fn compare_decisions(id: &Value, have: &Value, want: &Value) {
    for field in DECISIONS {
        if let Some(want) = want.get(field) {
            assert_eq!(&have[field], want, "epoch {id} {field}");
        }
    }
}

fn epochs_agree(scalar: Scalar) {
    let file = "epochs.jsonl.gz";
    let wanted = vectors(file);
    let had = evaluated(file, scalar);
    assert_eq!(had.len(), wanted.len());
    let (mut compared, mut decided) = (0, 0);
    for (have, want) in had.iter().zip(&wanted) {
        let id = &want["id"];
        assert_eq!(&have["id"], id);
        let (have, out) = (&have["out"]["lsr"], &want["out"]);
        let tame = out.get("min_sv").map_or(f64::INFINITY, number) >= F32_SINGULAR_VALUE;
        let decisive = want.get("margin").map_or(f64::INFINITY, number) > F32_MARGIN;
        if scalar == Scalar::F64 || tame && decisive {
            compare_decisions(id, have, &out["lsr"]);
            decided += 1;
        }
        if scalar == Scalar::F64 || tame && (decisive || have["excluded"] == out["lsr"]["excluded"]) {
            compared += compare_numbers(id, have, &out["lsr"], scalar);
        }
    }
    println!("{scalar:?}: {compared} values, decisions of {decided} epochs");
    assert!(compared > 10_000 && decided > 90, "{compared} values, decisions of {decided} epochs");
    let passage = match scalar {
        Scalar::F64 => {
            let thousands = format!("{},{:03}", compared / 1000, compared % 1000);
            format!("{decided} epochs with {thousands} values: every decision agrees in `f64`")
        }
        Scalar::F32 => format!("in `f32` in the {decided} epochs that are neither"),
    };
    rig::document::must_say("results/integrity.md", &passage);
}

/// Lists of rows, whose order has no meaning.
const SETS: [(&str, &[&str]); 2] =
    [("iso", &["A", "seq", "B", "C", "D"]), ("ransac", &["fault", "fault_refined"])];

/// Words, and the subsets of every minimal subset's vote, which always uses double precision.
const EQUAL: [(&str, &[&str]); 2] =
    [("ransac", &["status", "status_refined"]), ("ransac_trad", &["K", "n_out", "f", "tot", "fault"])];

fn sorted(value: &Value) -> Value {
    let Value::Array(list) = value else { return value.clone() };
    let mut list: Vec<Value> = list.iter().map(sorted).collect();
    list.sort_by_key(Value::as_u64);
    Value::Array(list)
}

/// Compares the decisions of parity space and range consensus and returns their number.
fn isolation_agrees(have: &Value, want: &Value, id: &Value) -> usize {
    let mut compared = 0;
    let compare = |part: &str, field: &str, have: Value, want: Value| {
        assert_eq!(have, want, "epoch {id} {part} {field}");
    };
    for (part, fields) in SETS {
        for field in fields.iter().filter(|_| want.get(part).is_some()) {
            compare(part, field, sorted(&have[part][field]), sorted(&want[part][field]));
            compared += 1;
        }
    }
    for (part, fields) in EQUAL {
        for field in fields.iter().filter(|_| want.get(part).is_some()) {
            compare(part, field, have[part][field].clone(), want[part][field].clone());
            compared += 1;
        }
    }
    if want.get("ransac").is_some() {
        compare("ransac", "subsets", sorted(&have["ransac"]["subsets"]), sorted(&want["ransac"]["subsets"]));
    }
    compared
}

fn isolations_agree(scalar: Scalar) {
    let file = "epochs.jsonl.gz";
    let wanted = vectors(file);
    let mut compared = 0;
    for (have, want) in evaluated(file, scalar).iter().zip(&wanted) {
        let tame = want["out"].get("min_sv").map_or(f64::INFINITY, number) >= F32_SINGULAR_VALUE;
        let decisive = want.get("margin").map_or(f64::INFINITY, number) > F32_MARGIN;
        if scalar == Scalar::F64 || tame && decisive {
            compared += isolation_agrees(&have["out"], &want["out"], &want["id"]);
        }
        let Some(want_iso) = want["out"].get("iso").filter(|_| scalar == Scalar::F64 || tame) else {
            continue;
        };
        let tolerance = if scalar == Scalar::F64 { within(1e-9, 1e-9) } else { within(1e-3, 1e-3) };
        let (have_iso, id) = (&have["out"]["iso"], &want["id"]);
        for (have, want) in numbers(&have_iso["rho"]).into_iter().zip(numbers(&want_iso["rho"])) {
            assert!(close(have, want, tolerance), "epoch {id} rho: have {have}, want {want}");
        }
        let (have, want) = (number(&have_iso["rho_T"]), number(&want_iso["rho_T"]));
        let tolerance = within(if scalar == Scalar::F64 { 1e-9 } else { 1e-5 }, 0.0);
        assert!(close(have, want, tolerance), "rho_T: have {have}, want {want}");
    }
    assert!(compared > 600, "{compared} decisions");
}

#[test]
fn isolation_names_the_same_rows_in_double_precision() {
    isolations_agree(Scalar::F64);
}

#[test]
fn isolation_names_the_same_rows_in_single_precision() {
    isolations_agree(Scalar::F32);
}

#[test]
fn epochs_agree_in_double_precision() {
    epochs_agree(Scalar::F64);
}

#[test]
fn epochs_agree_in_single_precision() {
    epochs_agree(Scalar::F32);
}

#[test]
fn edge_cases_get_the_listed_status_in_both_precisions() {
    let file = "edge.jsonl.gz";
    let wanted = vectors(file);
    for scalar in [Scalar::F64, Scalar::F32] {
        for (have, want) in evaluated(file, scalar).iter().zip(&wanted) {
            compare_decisions(&want["name"], &have["out"]["lsr"], &want["out"]);
        }
    }
}

#[test]
fn edge_cases_have_the_listed_numbers() {
    let file = "edge.jsonl.gz";
    let wanted = vectors(file);
    let mut compared = 0;
    for (have, want) in evaluated(file, Scalar::F64).iter().zip(&wanted) {
        // A clock of 2.9e8 m leaves 6e-8 m in the residuals, in the file as well.
        let far_clock = want["name"] == "clock 3e8";
        let nothing_to_compare = want["out"]["status"] == "invalid_input";
        if !far_clock && !nothing_to_compare {
            compared += compare_numbers(&want["name"], &have["out"]["lsr"], &want["out"], Scalar::F64);
        }
    }
    assert!(compared > 500, "{compared} values");
}

#[test]
fn a_receiver_clock_of_one_second_does_not_move_the_statistic() {
    let file = "edge.jsonl.gz";
    let wanted = vectors(file);
    let index = wanted.iter().position(|line| line["name"] == "clock 3e8").expect("the case is in the file");
    let want = number(&wanted[index]["out"]["sse"]);
    for (scalar, relative) in [(Scalar::F64, 1e-6), (Scalar::F32, 1e-3)] {
        let have = number(&evaluated(file, scalar)[index]["out"]["lsr"]["sse"]);
        assert!(close(have, want, within(relative, 0.0)), "{scalar:?}: have {have}, want {want}");
    }
}

#[test]
fn compressed_and_plain_input_give_the_same_answers() {
    let file = "edge.jsonl.gz";
    let mut plain = Vec::new();
    GzDecoder::new(File::open(path(file)).expect("a readable file")).read_to_end(&mut plain).expect("gzip");
    let mut have = Vec::new();
    evaluate::run(plain.as_slice(), &mut have, Some(Scalar::F64)).expect("a run without I/O errors");
    let have: Vec<Value> =
        have.lines().map(|line| serde_json::from_str(&line.expect("text")).expect("JSON")).collect();
    assert_eq!(have, evaluated(file, Scalar::F64));
}

/// Compares every field of every model: the core's, and the others.
fn clocks_agree(scalar: Scalar, tolerance: Tolerance) {
    let file = "clock.jsonl.gz";
    let wanted = vectors(file);
    let had = evaluated_as(Part::Clock, file, scalar);
    assert_eq!(had.len(), wanted.len());
    for (have, want) in had.iter().zip(&wanted) {
        assert_eq!(have["id"], want["id"]);
        for (model, fields) in want["out"].as_object().expect("models") {
            for (field, want_values) in fields.as_object().expect("fields") {
                let name = format!("window {} {model} {field} {scalar:?}", want["id"]);
                all_close(&name, &have["out"][model][field], want_values, tolerance);
            }
        }
    }
}

fn all_close(name: &str, have: &Value, want: &Value, tolerance: Tolerance) {
    let (have, want) = (numbers(have), numbers(want));
    assert_eq!(have.len(), want.len(), "{name}");
    for (have, want) in have.into_iter().zip(want) {
        assert!(close(have, want, tolerance), "{name}: have {have:e}, want {want:e}");
    }
}

#[test]
fn clock_forecasts_agree_in_double_precision() {
    clocks_agree(Scalar::F64, within(1e-9, 1e-9));
}

#[test]
fn clock_forecasts_agree_in_single_precision() {
    clocks_agree(Scalar::F32, within(1e-3, 1e-4));
}

fn aided_epochs_agree(scalar: Scalar, tolerance: Tolerance) {
    let file = "clock_raim.jsonl.gz";
    let wanted = vectors(file);
    let had = evaluated_as(Part::ClockRaim, file, scalar);
    assert_eq!(had.len(), wanted.len());
    for (have, want) in had.iter().zip(&wanted) {
        let (id, have, want) = (&want["id"], &have["out"], &want["out"]);
        for field in ["dof", "detected", "ident", "ident_is_clock"] {
            assert_eq!(have[field], want[field], "epoch {id} {field}");
        }
        for field in ["sse", "tau1", "test_m", "T_D_m", "d"] {
            all_close(&format!("epoch {id} {field} {scalar:?}"), &have[field], &want[field], tolerance);
        }
    }
}

#[test]
fn clock_aided_epochs_agree_in_double_precision() {
    aided_epochs_agree(Scalar::F64, within(1e-9, 1e-9));
}

#[test]
fn clock_aided_epochs_agree_in_single_precision() {
    aided_epochs_agree(Scalar::F32, within(1e-3, 1e-3));
}

/// Compares the levels of `BOUND`, computed elsewhere for the same epochs; in single precision
/// hardly tested rows are exempt.
fn bounding_levels_agree(scalar: Scalar, tolerance: Tolerance) {
    let (epochs, levels) = (vectors("epochs.jsonl.gz"), vectors("levels.jsonl.gz"));
    let had = evaluated("epochs.jsonl.gz", scalar);
    let mut compared = 0;
    for want in &levels {
        let at = epochs.iter().position(|epoch| epoch["id"] == want["id"]).expect("an epoch of this id");
        let hardly_tested = numbers(&epochs[at]["out"]["lsr"]["Sii"])
            .iter()
            .any(|&redundancy| 0.0 < redundancy && redundancy < 1e-3);
        let tame = epochs[at]["out"].get("min_sv").map_or(f64::INFINITY, number) >= F32_SINGULAR_VALUE;
        if scalar == Scalar::F64 || tame && !hardly_tested {
            for field in ["hpl", "vpl"] {
                let (have, want_m) =
                    (number(&had[at]["out"]["bound"][field]), number(&want["out"]["bound"][field]));
                assert!(
                    close(have, want_m, tolerance),
                    "epoch {} {field} {scalar:?}: have {have:e}, want {want_m:e}",
                    want["id"]
                );
                compared += 1;
            }
        }
    }
    println!("{scalar:?}: {compared} levels");
    assert!(compared > 150, "{compared} levels");
}

#[test]
fn bounding_levels_agree_in_double_precision() {
    bounding_levels_agree(Scalar::F64, within(1e-8, 1e-9));
}

#[test]
fn bounding_levels_agree_in_single_precision() {
    bounding_levels_agree(Scalar::F32, within(3e-3, 1e-9));
}
