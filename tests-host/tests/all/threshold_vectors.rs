//! `evaluate --thresholds` against the published vectors.

use std::fs::File;
use std::io::{BufReader, Read};

use flate2::read::GzDecoder;
use oracle::vectors;
use raim::evaluate::{Part, Scalar, run_part};
use serde_json::Value;

/// Tolerances of the specification: `tau1` and `lambda` 1e-10, values solved for a geometry 1e-7.
const FIELDS: [(&str, f64); 5] =
    [("tau1", 1e-10), ("lam", 1e-10), ("tau2", 1e-7), ("tau_op_raw", 1e-7), ("tau_op", 1e-7)];

#[test]
fn policies_agree_in_value_and_status() {
    let path = vectors::path("thresholds.jsonl.gz");
    let mut text = String::new();
    GzDecoder::new(File::open(&path).unwrap()).read_to_string(&mut text).unwrap();
    let mut answers = Vec::new();
    let input = BufReader::new(File::open(&path).unwrap());
    let summary = run_part(Part::Thresholds, input, &mut answers, Some(Scalar::F64)).unwrap();
    assert_eq!((summary.lines, summary.errors), (60, 0));
    let answers = String::from_utf8(answers).unwrap();
    for (want, have) in text.lines().zip(answers.lines()) {
        let [want, have]: [Value; 2] = [want, have].map(|line| serde_json::from_str(line).unwrap());
        assert_eq!(have["status"], want["status"], "{want}");
        for (field, tolerance) in FIELDS {
            match (have[field].as_f64(), want[field].as_f64()) {
                (Some(have), Some(want)) => {
                    assert!(
                        (have - want).abs() <= tolerance * want.abs(),
                        "{field}: have {have}, want {want}"
                    );
                }
                (have, want) => assert_eq!(have, want, "{field}"),
            }
        }
    }
}
