//! ARAIM against vectors of dense least squares, mode by mode, and against a published run of MAAST
//! for ARAIM 2.
//!
//! `want` was computed elsewhere, in double precision. Tolerances are those of the specification:
//! levels in double precision may be above the reference by 1 mm and never below it; in single
//! precision they are within 5 mm or 1e-4.

use std::fs::File;
use std::io::{BufRead, BufReader};

use flate2::read::GzDecoder;
use nalgebra::Vector3;
use oracle::vectors;
use raim::evaluate::{self, Part, Scalar};
use raim_core::internals::integrity::araim::{Allocation, AraimOutcome, Prior, Priors, ROWS, judge};
use raim_core::internals::least_squares::Workspace;
use raim_core::internals::least_squares::equations::LinearEpoch;
use raim_core::satellite::Constellation;
use serde_json::Value;

const VECTORS: &str = "araim.jsonl.gz";

/// Distance from a threshold below which single precision may decide otherwise.
const F32_MARGIN: f64 = 1e-3;

fn wanted() -> Vec<Value> {
    let file = File::open(vectors::path(VECTORS)).expect("a readable file");
    let lines = BufReader::new(GzDecoder::new(file)).lines();
    lines.map(|line| serde_json::from_str(&line.expect("text")).expect("JSON")).collect()
}

fn evaluated(scalar: Scalar) -> Vec<Value> {
    let file = File::open(vectors::path(VECTORS)).expect("a readable file");
    let mut output = Vec::new();
    let summary = evaluate::run_part(Part::Araim, BufReader::new(file), &mut output, Some(scalar))
        .expect("a run without I/O errors");
    assert_eq!(summary.errors, 0);
    output.lines().map(|line| serde_json::from_str(&line.expect("text")).expect("JSON")).collect()
}

fn number(value: &Value) -> f64 {
    match value {
        Value::String(word) => word.parse().expect("a number in words"),
        value => value.as_f64().unwrap_or(f64::NAN),
    }
}

/// One allocation's answer beside the wanted one, and the number of compared values.
struct Comparison<'v> {
    name: String,
    have: &'v Value,
    want: &'v Value,
    scalar: Scalar,
    values: usize,
}

impl Comparison<'_> {
    fn same(&mut self, field: &str) {
        assert_eq!(self.have[field], self.want[field], "{} {field}", self.name);
        self.values += 1;
    }

    fn close(&mut self, field: &str, have: &Value, want: &Value, relative: f64) {
        let (have, want) = (number(have), number(want));
        let within = (have - want).abs() <= relative * want.abs();
        assert!(within, "{} {field}: have {have:e}, want {want:e}", self.name);
        self.values += 1;
    }

    fn level(&mut self, field: &str, have: &Value, want: &Value) {
        let (have, want) = (number(have), number(want));
        let (below, above) = match self.scalar {
            Scalar::F64 => (1e-6, 1e-3),
            Scalar::F32 => (f64::max(5e-3, 1e-4 * want), f64::max(5e-3, 1e-4 * want)),
        };
        let within = have >= want - below && have <= want + above;
        let both_infinite = have.is_infinite() && want.is_infinite();
        assert!(within || both_infinite, "{} {field}: have {have}, want {want}", self.name);
        self.values += 1;
    }

    fn levels(&mut self, fields: &[&str]) {
        for field in fields {
            self.level(field, &self.have[*field], &self.want[*field]);
        }
    }

    fn compare(&mut self) {
        let (have, want) = (self.have, self.want);
        for field in ["status", "n_options", "n_modes"] {
            self.same(field);
        }
        let of_double = self.scalar == Scalar::F64;
        self.close("p_nm", &have["p_nm"], &want["p_nm"], if of_double { 1e-9 } else { 1e-4 });
        for axis in 0..3 {
            let within = if of_double { 1e-9 } else { 1e-5 };
            self.close("K_fa", &have["K_fa"][axis], &want["K_fa"][axis], within);
            self.level("pl", &have["pl"][axis], &want["pl"][axis]);
        }
        for field in ["emt", "sigma_v_acc"] {
            self.close(field, &have[field], &want[field], if of_double { 1e-9 } else { 1e-3 });
        }
        self.levels(&["hpl", "vpl"]);
        if of_double || number(&want["margin"]) > F32_MARGIN {
            self.same("detected");
            if want["detected"] == true {
                self.same("excl");
                if !want["excl"].is_null() {
                    self.levels(&["hpl_excl", "vpl_excl"]);
                    self.close(
                        "p_nm_excl",
                        &have["p_nm_excl"],
                        &want["p_nm_excl"],
                        if of_double { 1e-9 } else { 1e-4 },
                    );
                }
            }
        }
    }
}

fn vectors_agree(scalar: Scalar) {
    let wanted = wanted();
    let had = evaluated(scalar);
    assert_eq!(had.len(), wanted.len());
    let mut values = 0;
    for (have, want) in had.iter().zip(&wanted) {
        for allocation in ["lpv", "haraim"] {
            let name = format!("epoch {} {allocation} {scalar:?}", want["id"]);
            let (have, want) = (&have["out"][allocation], &want["out"][allocation]);
            let mut comparison = Comparison { name, have, want, scalar, values: 0 };
            comparison.compare();
            values += comparison.values;
        }
    }
    println!("{scalar:?}: {values} values, 0 differ");
    assert!(values > 1800, "{values} values");
}

#[test]
fn araim_agrees_in_double_precision() {
    vectors_agree(Scalar::F64);
}

#[test]
fn araim_agrees_in_single_precision() {
    vectors_agree(Scalar::F32);
}

/// MAAST reports the upper end of at most ten halvings of its bracket, which is 2.3 m wide here.
#[test]
fn a_published_run_agrees_within_its_bisection() {
    /// `P_nm` of the run, by the rules of the specification in exact fractions.
    const EXACT: f64 = 4.299_530_399_475_412e-8;
    let run: Value =
        serde_json::from_reader(File::open(vectors::path("araim_maast.json")).expect("a readable file"))
            .expect("JSON");
    let constant = |name: &str| number(&run["constants"][name]);
    let mut allocation = Allocation::vertical();
    allocation.integrity_vertical = constant("phmi_v");
    allocation.integrity_horizontal = constant("phmi_h");
    allocation.alarm_vertical = constant("p_fa_v");
    allocation.alarm_horizontal = constant("p_fa_h");
    allocation.unmonitored_probability = constant("p_thres");
    allocation.consolidation = constant("fc_thres");
    allocation.emt_prior = constant("p_emt");
    allocation.exclusion = false;
    let mut epoch = LinearEpoch::<f64, ROWS>::new();
    let sights = run["los_enu"].as_array().expect("directions");
    for (sight, id) in sights.iter().zip(run["con"].as_array().expect("constellations")) {
        let direction = Vector3::new(number(&sight[0]), number(&sight[1]), number(&sight[2]));
        let constellation = Constellation::ALL[id.as_u64().expect("an id") as usize];
        epoch.satellite(constellation, direction, 0.0, number(&run["sigma_int_m"])).expect("a row");
    }
    let prior = Prior {
        accuracy_m: number(&run["sigma_acc_m"]),
        bias_m: number(&run["b_nom_m"]),
        fault: number(&run["p_sat"]),
    };
    let constellations = [0, 1, 2, 3].map(|id| run["p_const"].get(id.to_string()).map_or(0.0, number));
    let mut workspace = Workspace::of(epoch);
    let mut snapshot = workspace.solve().expect("a position");
    let priors = Priors { satellites: &vec![prior; sights.len()], constellations };
    let judged = judge(&mut snapshot, &priors, &allocation).expect("a judgement");
    let (found, published) = (judged.whole, &run["published"]);
    assert_eq!(judged.outcome, AraimOutcome::Passed);
    assert_eq!(Some(found.modes as u64), published["n_modes"].as_u64());
    assert!(
        (found.unmonitored_probability / EXACT - 1.0).abs() < 1e-12,
        "have {:e}",
        found.unmonitored_probability
    );
    // The published run subtracts sums from one, and may lose a rounding of one for each of its 25
    // modes.
    assert!((number(&published["p_nm"]) - EXACT).abs() < 25.0 * f64::EPSILON);
    let cases =
        [(found.effective_monitor_threshold_m, "emt_m", 1e-8), (found.accuracy_m, "sigma_v_acc_m", 1e-7)];
    for (have, field, relative) in cases {
        let want = number(&published[field]);
        assert!((have / want - 1.0).abs() < relative, "{field}: have {have:e}, want {want:e}");
    }
    for (have, field) in [(found.vpl_m(), "vpl_m"), (found.hpl_m(), "hpl_m")] {
        let above = number(&published[field]) - have;
        println!("{field}: {have:.5} m, published {above:.5} m more");
        assert!((-3e-4..=0.0023).contains(&above), "{field}: published {above} m more");
    }
}
