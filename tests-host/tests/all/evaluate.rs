//! Lines that are not epochs, and implausible epochs: each receives an answer, and the run
//! continues.

use raim::evaluate::{self, Part, Scalar, Summary};
use serde_json::{Value, json};

/// Returns six satellites of one constellation: two degrees of freedom.
fn epoch() -> Value {
    json!({
        "id": "six",
        "los_enu": [[0.0, 0.0, 1.0], [0.6, 0.0, 0.8], [-0.6, 0.0, 0.8], [0.0, 0.8, 0.6], [0.0, -0.8, 0.6], [0.48, 0.64, 0.6]],
        "con": [0, 0, 0, 0, 0, 0],
        "sigma": [6.0, 6.0, 6.0, 6.0, 6.0, 6.0],
        "y": [1.0, -2.0, 0.5, 3.0, -1.0, 0.0],
        "pfa": 1e-5, "pmd": 1e-3, "hal": 556.0, "f": 0.95,
    })
}

fn with(field: &str, value: Value) -> Value {
    let mut epoch = epoch();
    epoch[field] = value;
    epoch
}

fn run(input: &[u8]) -> (Vec<Value>, Summary) {
    let mut output = Vec::new();
    let summary = evaluate::run(input, &mut output, None).expect("a run without I/O errors");
    let text = String::from_utf8(output).expect("text");
    (text.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect(), summary)
}

fn answer(line: &Value) -> Value {
    let (mut answers, _) = run(line.to_string().as_bytes());
    answers.remove(0)
}

#[test]
fn every_line_that_is_not_such_an_object_says_what_and_where() {
    let missing = {
        let mut epoch = epoch();
        epoch.as_object_mut().expect("an object").remove("sigma");
        epoch
    };
    let cases = [
        (json!([1, 2]), "line 1: not a JSON object"),
        (json!(null), "line 1: not a JSON object"),
        (missing, "line 1: sigma: missing"),
        (with("y", json!("west")), "line 1: y: not an array"),
        (with("y", json!([1, 2, 3, 4, 5, {}])), "line 1: y[5]: not a number"),
        (with("y", json!([1, 2, 3])), "line 1: y: 3 entries, but los_enu has 6"),
        (with("con", json!([0, 0, 0, 0, 4, 0])), "line 1: con[4]: no constellation 4"),
        (with("con", json!([0, 0, 0, 0, -1, 0])), "line 1: con[4]: no constellation -1"),
        (with("los_enu", json!([[0, 1], 1, 1, 1, 1, 1])), "line 1: los_enu[0]: not three numbers"),
        (with("scalar", json!("f16")), "line 1: scalar: `f16` is neither f64 nor f32"),
        (with("clock", json!(3)), "line 1: clock: not an object"),
        (with("clock", json!({"con": 0, "value_m": 1})), "line 1: clock.sigma_m: missing"),
        (with("pfa", json!([])), "line 1: pfa: not a number"),
    ];
    for (line, want) in cases {
        assert_eq!(answer(&line)["error"], want, "{line}");
    }
}

/// Returns any number of satellites, on a spiral up the sky.
fn crowd(count: u32) -> Value {
    let direction = |k: u32| {
        let azimuth_rad = f64::from(k) * 2.4;
        let up = 0.2 + 0.7 * f64::from(k) / 65.0;
        let flat = libm::sqrt(1.0 - up * up);
        json!([flat * libm::sin(azimuth_rad), flat * libm::cos(azimuth_rad), up])
    };
    let mut line = with("los_enu", (0..count).map(direction).collect());
    for (field, value) in [("con", 0), ("sigma", 3), ("y", 0)] {
        line[field] = Value::Array(vec![json!(value); count as usize]);
    }
    line
}

#[test]
fn the_tables_last_degree_of_freedom_is_tested_and_one_more_is_an_error() {
    let full = answer(&crowd(64));
    assert_eq!((&full["out"]["lsr"]["status"], &full["out"]["lsr"]["dof"]), (&json!("ok"), &json!(60)));
    let want = "line 1: los_enu: 65 rows, clock included, but at most 64 fit";
    assert_eq!(answer(&crowd(65))["error"], want);
    let mut aided = crowd(64);
    aided["clock"] = json!({"con": 0, "value_m": 0.0, "sigma_m": 3.0});
    assert_eq!(answer(&aided)["error"], want);
}

#[test]
fn numbers_that_make_no_epoch_are_invalid_input_and_say_why() {
    let cases = [
        (with("y", json!([1, 2, 3, 4, 5, null])), "satellite 5: residual must be finite"),
        (with("y", json!(["-inf", 2, 3, 4, 5, 6])), "satellite 0: residual must be finite"),
        (with("sigma", json!([6, 6, 0, 6, 6, 6])), "satellite 2: sigma must be finite and positive"),
        (with("sigma", json!([6, 6, 6, 1e200, 6, 6])), "satellite 3: sigma must be finite and positive"),
        (with("pfa", json!(0.5)), "pfa: 0.5 outside (0, 0.5)"),
        (with("pfa", json!(null)), "pfa: NaN outside (0, 0.5)"),
        (with("pmd", json!(0)), "pmd: 0 outside (0, 0.5)"),
        (with("hal", json!(-1)), "hal: -1 not above 0"),
        (with("f", json!(1.5)), "f: 1.5 outside (0, 1]"),
    ];
    for (line, want) in cases {
        let have = &answer(&line)["out"]["lsr"];
        assert_eq!((&have["status"], &have["why"]), (&json!("invalid_input"), &json!(want)), "{line}");
    }
}

#[test]
fn numbers_beyond_single_precision_are_invalid_there_and_not_a_silent_nan() {
    let cases = [
        (with("y", json!([0, 1e300, 0, 0, 0, 0])), "satellite 1: residual must be finite"),
        (with("sigma", json!([1e-30, 6, 6, 6, 6, 6])), "satellite 0: sigma must be finite and positive"),
    ];
    for (mut line, want) in cases {
        assert_eq!(answer(&line)["out"]["lsr"]["status"], "ok", "in double precision: {line}");
        line["scalar"] = json!("f32");
        assert_eq!(answer(&line)["out"]["lsr"]["why"], want);
    }
}

#[test]
fn two_satellites_alone_with_their_clock_are_ambiguous_in_both_precisions() {
    // Their residuals are opposite and equal, whatever else is in the sky.
    let mut line = epoch();
    line["los_enu"]
        .as_array_mut()
        .expect("an array")
        .extend([json!([-0.64, 0.48, 0.6]), json!([0.28, -0.96, 0.0])]);
    for (field, pair) in [("con", [1, 1]), ("sigma", [5, 7]), ("y", [300, 0])] {
        line[field].as_array_mut().expect("an array").extend(pair.map(|value| json!(value)));
    }
    for scalar in ["f64", "f32"] {
        line["scalar"] = json!(scalar);
        let have = &answer(&line)["out"]["lsr"];
        assert_eq!(
            (&have["detected"], &have["ident_reason"]),
            (&json!(true), &json!("ambiguous")),
            "{scalar}"
        );
    }
}

#[test]
fn a_bad_line_does_not_stop_the_run() {
    let good = epoch().to_string();
    let input = [good.as_bytes(), b"\n{\"id\": 7, \"y\n\n\xff\xfe\n{\"id\": 8}\n", good.as_bytes()].concat();
    let (answers, summary) = run(&input);
    assert_eq!((summary.lines, summary.errors), (5, 3));
    assert_eq!(answers[1]["error"], "line 2, column 12: not JSON: EOF while parsing a string");
    assert_eq!(answers[2]["error"], "line 4, column 1: not JSON: expected value");
    assert_eq!(answers[3], json!({"id": 8, "error": "line 5: los_enu: missing"}));
    assert_eq!(answers[4], answers[0]);
}

#[test]
fn no_input_is_no_output() {
    assert_eq!(run(b""), (Vec::new(), Summary::default()));
}

#[test]
fn the_line_chooses_the_scalar_and_the_caller_overrides_it() {
    let double = answer(&epoch());
    let single = answer(&with("scalar", json!("f32")));
    assert_ne!(double, single);
    let mut overridden = Vec::new();
    evaluate::run(epoch().to_string().as_bytes(), &mut overridden, Some(Scalar::F32)).expect("no I/O errors");
    assert_eq!(serde_json::from_slice::<Value>(&overridden).expect("JSON"), single);
}

#[test]
fn probabilities_outside_the_tables_get_their_own_rows() {
    // Two degrees of freedom: χ² is an exponential, tau1 = −2 ln Pfa.
    for pfa in [2e-6, 0.03, 1e-30] {
        let have = answer(&with("pfa", json!(pfa)))["out"]["lsr"]["tau1"].as_f64().expect("a number");
        let want = -2.0 * libm::log(pfa);
        assert!((have / want - 1.0).abs() < 1e-13, "have {have}, want {want}");
    }
}

#[test]
fn a_predicted_clock_adds_a_row_and_a_degree_of_freedom() {
    let unaided = answer(&epoch());
    let aided = answer(&with("clock", json!({"con": 0, "value_m": 0.5, "sigma_m": 1.0})));
    let (unaided, aided) = (&unaided["out"]["lsr"], &aided["out"]["lsr"]);
    assert_eq!((&unaided["n"], &unaided["dof"]), (&json!(6), &json!(2)));
    assert_eq!((&aided["n"], &aided["dof"]), (&json!(7), &json!(3)));
    assert!(aided["hpl"].as_f64() < unaided["hpl"].as_f64(), "more redundancy, smaller slopes");
}

#[test]
fn an_untestable_satellite_that_moves_the_height_gives_an_infinite_level_in_words() {
    // Four satellites on one cone and one overhead: the latter alone fixes the height.
    let line = json!({
        "id": 1,
        "los_enu": [[0.8, 0.0, 0.6], [-0.8, 0.0, 0.6], [0.0, 0.8, 0.6], [0.0, -0.8, 0.6], [0.0, 0.0, 1.0]],
        "con": [0, 0, 0, 0, 0], "sigma": [6, 6, 6, 6, 6], "y": [1, 2, 3, 4, 5],
        "pfa": 1e-5, "pmd": 1e-3, "hal": 556, "f": 1,
    });
    let have = answer(&line);
    assert_eq!(have["out"]["lsr"]["vpl"], "inf", "{have}");
    assert_eq!(have["out"]["lsr"]["status"], "ok");
}

fn answer_as(part: Part, line: &Value) -> Value {
    let mut output = Vec::new();
    evaluate::run_part(part, line.to_string().as_bytes(), &mut output, None)
        .expect("a run without I/O errors");
    serde_json::from_slice(&output).expect("JSON")
}

#[test]
fn every_window_that_is_none_says_what_and_where() {
    let jump: Vec<f64> = (0..12).map(|step| if step < 7 { 0.0 } else { 3e5 }).collect();
    let cases = [
        (json!({"id": 1}), "line 1: Z: missing"),
        (json!({"Z": vec![0.0; 11]}), "line 1: Z: 11 values, must be 12 to 240"),
        (json!({"Z": vec![0.0; 241]}), "line 1: Z: 241 values, must be 12 to 240"),
        (json!({"Z": [1, 2, "x"]}), "line 1: Z[2]: not a number"),
        (json!({"Z": vec![Value::Null; 12]}), "line 1: Z[0]: NaN does not continue the window"),
        (json!({"Z": jump}), "line 1: Z[7]: 300000 does not continue the window"),
    ];
    for (line, want) in cases {
        assert_eq!(answer_as(Part::Clock, &line)["error"], want, "{line}");
    }
}

#[test]
fn a_constant_clock_is_forecast_to_stay_with_no_doubt() {
    let have = &answer_as(Part::Clock, &json!({"id": "still", "Z": vec![7.0; 20]}))["out"]["uc"];
    assert_eq!(have["forecast"], json!(vec![7.0; 10]));
    assert_eq!(have["sigma_predict"], json!(vec![0.0; 10]));
    assert_eq!(have["a"], json!(vec![0.0; 3]));
}

#[test]
fn every_aided_epoch_that_is_none_says_what_and_where() {
    let epoch = || {
        let epoch = epoch();
        json!({"los_enu": epoch["los_enu"], "y": epoch["y"], "sigma": 6.0, "T": 1.0, "sigma_b": 7.0, "pfa": 1e-4})
    };
    let with = |field: &str, value: Value| {
        let mut epoch = epoch();
        epoch[field] = value;
        epoch
    };
    assert_eq!(answer_as(Part::ClockRaim, &epoch())["out"]["dof"], 3);
    let cases = [
        (with("sigma_b", json!(0.0)), "line 1: T: sigma must be finite and positive"),
        (with("T", Value::Null), "line 1: T: residual must be finite"),
        (with("y", json!([1.0])), "line 1: y: 1 entries, but los_enu has 6"),
        (with("pfa", json!(0.7)), "line 1: pfa: 0.7 outside (0, 0.5)"),
        (with("los_enu", json!([[0, 0, 1], [0, 1, 0], 3, 4, 5, 6])), "line 1: los_enu[2]: not three numbers"),
    ];
    for (line, want) in cases {
        assert_eq!(answer_as(Part::ClockRaim, &line)["error"], want, "{line}");
    }
}

#[test]
fn exclusion_level_is_told_or_null() {
    let bound = answer(&epoch())["out"]["bound"].clone();
    let level = |name: &str| bound[name].as_f64().expect("a level");
    assert!(level("hel") > level("hpl") && level("vel") > level("vpl"), "{bound}");
    // With a clock more, one degree of freedom is left, which tells no satellite apart.
    let bound = answer(&with("con", json!([0, 0, 0, 0, 1, 1])))["out"]["bound"].clone();
    assert!(bound["hpl"].is_number() && bound["hel"].is_null() && bound["vel"].is_null(), "{bound}");
}
