//! Reference epochs with a clock beside the satellites: four detect, five identify, a jump belongs
//! to the clock.
//!
//! `want` was computed elsewhere, with a full-column solution in double precision. References:
//! [Chen2009] §2.
//!
//! [Chen2009]: raim#references

use std::fs::File;
use std::io::{BufRead, BufReader};

use anyhow::{Context as _, Result, ensure};
use flate2::read::MultiGzDecoder;
use oracle::vectors;
use raim::evaluate::{Part, Scalar, run_part};
use serde_json::Value;

use super::super::{Finding, Judgement, Row, Section};

const FILE: &str = "clock_raim.jsonl.gz";

/// Fields that are decisions, which must be equal.
const DECISIONS: [&str; 4] = ["dof", "detected", "ident", "ident_is_clock"];

/// Fields that are numbers, equal to within rounding.
const NUMBERS: [&str; 5] = ["sse", "tau1", "test_m", "T_D_m", "d"];

const ROUNDING: f64 = 1e-9;

pub(super) fn section() -> Result<Section> {
    let title = "Reference epochs aided by a clock".to_owned();
    let path = vectors::path(FILE);
    let open = || File::open(&path).with_context(|| format!("opening {}", path.display()));
    let wanted = lines(BufReader::new(MultiGzDecoder::new(open()?)))?;
    let mut output = Vec::new();
    run_part(Part::ClockRaim, BufReader::new(open()?), &mut output, Some(Scalar::F64))?;
    let had = lines(output.as_slice())?;
    ensure!(had.len() == wanted.len(), "{} answers to {} lines", had.len(), wanted.len());
    let pairs: Vec<_> = had.iter().zip(&wanted).collect();
    Ok(Section { title, rows: rows(&pairs) })
}

const QUANTITY: &str = "epochs with every decision and number of the reference";

fn lines(text: impl BufRead) -> Result<Vec<Value>> {
    text.lines().map(|line| Ok(serde_json::from_str(&line?)?)).collect()
}

fn rows(pairs: &[(&Value, &Value)]) -> Vec<Row> {
    let satellites = |want: &Value| want["los_enu"].as_array().map_or(0, Vec::len);
    let of =
        |quantity: &str, paper: &str, chosen: &dyn Fn(&Value) -> bool, reported: &dyn Fn(&Value) -> bool| {
            let chosen: Vec<_> = pairs.iter().filter(|(_, want)| chosen(want)).collect();
            let hits = chosen.iter().filter(|(have, _)| reported(&have["out"])).count();
            let ours = Finding::Words(format!("{hits} of {}", chosen.len()));
            Row::new(quantity, paper, ours, Judgement::Reproduced)
        };
    let same = pairs.iter().filter(|(have, want)| agree(&have["out"], &want["out"])).count();
    let all = Row::new(QUANTITY, "", Finding::Words(format!("{same} of {}", pairs.len())), Judgement::Ours)
        .held_if(12, "all", same == pairs.len());
    let detected = |out: &Value| out["detected"] == true;
    let named =
        |out: &Value| out["ident"].as_i64().is_some_and(|row| row >= 0) && out["ident_is_clock"] == false;
    let faulty = |want: &Value| want["out"]["detected"] == true;
    vec![
        all,
        of(
            "faults detected with 4 satellites",
            "possible",
            &|want| satellites(want) == 4 && faulty(want),
            &detected,
        ),
        of(
            "satellites named with 5 or more",
            "possible",
            &|want| satellites(want) >= 5 && named(&want["out"]),
            &named,
        ),
        of("clock named", "", &|want| want["out"]["ident_is_clock"] == true, &|out| {
            out["ident_is_clock"] == true
        }),
    ]
}

fn agree(have: &Value, want: &Value) -> bool {
    DECISIONS.iter().all(|field| have[field] == want[field])
        && NUMBERS.iter().all(|field| close(&have[field], &want[field]))
}

fn close(have: &Value, want: &Value) -> bool {
    match (have, want) {
        (Value::Array(have), Value::Array(want)) => {
            have.len() == want.len() && have.iter().zip(want).all(|(have, want)| close(have, want))
        }
        _ => match (have.as_f64(), want.as_f64()) {
            (Some(have), Some(want)) => (have - want).abs() <= ROUNDING * (1.0 + want.abs()),
            _ => false,
        },
    }
}
