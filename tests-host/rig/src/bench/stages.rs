//! Measured stages, each with its sky and its target.
//!
//! The targets apply to 20 satellites of two constellations in `f32`. Other sizes are measured for
//! comparison.

use anyhow::{Context, Result};
use raim_core::frame::Ecef;

use super::figure::{self, Figure};
use super::workload::{Stream, Wrong, epoch, site, start};
use crate::board::Machine;
use crate::laboratory::cycles::Cycles;
use crate::laboratory::profile::Profile;
use crate::laboratory::{Answer, Bench, Scalar, Stage, epoch_bytes, point_bytes};

/// A stage with its input.
#[derive(Clone)]
struct Case {
    name: String,
    stage: Stage,
    scalar: Scalar,
    input: Vec<u8>,
    target: Option<u64>,
    /// Number of epochs in the input, of which the last is measured.
    epochs: usize,
}

/// Numbers of satellites.
const SIZES: [usize; 5] = [8, 12, 20, 30, 40];
/// Names of the methods, in the order of their numbers in a request.
pub const METHODS: [&str; 8] =
    ["BAARDA", "SIMULTANEOUS", "SEQUENTIAL", "HYBRID", "GROUPING", "RANSAC", "SEPARATION", "AUTO"];

/// Returns the name of a method's figure: an epoch of 20 satellites with `faults` faulty ones,
/// after one like it.
pub fn of_method(method: &str, faults: usize) -> String {
    format!("epoch judged by {method}, faulty {faults} of 20 satellites, f32")
}

/// Measures every stage.
///
/// # Errors
/// If the measuring image does not finish.
pub fn measure() -> Result<Vec<Figure>> {
    let cases = cases()?;
    let answers = run(&cases, Machine::Stm32f405)?;
    let figures = cases.into_iter().zip(answers);
    Ok(figures
        .map(|(case, answer)| Figure { name: case.name, value: answer.instructions, target: case.target })
        .collect())
}

/// Measures the stages of one epoch on the second board, whose processor has doubles.
///
/// # Errors
/// As [`measure`].
pub fn measure_second_board() -> Result<Vec<Figure>> {
    let cases = [linear_tests()?, judgements()?, wire()?].concat();
    let answers = run(&cases, Machine::Mps2An500)?;
    let name = |case: Case| figure::on_second_board(&case.name);
    let figures = cases.into_iter().zip(answers);
    Ok(figures
        .map(|(case, answer)| Figure { name: name(case), value: answer.instructions, target: None })
        .collect())
}

/// Returns the tests of 20 satellites in single and in double precision.
fn linear_tests() -> Result<Vec<Case>> {
    Ok([tests(20, 2, Scalar::Single)?, tests(20, 2, Scalar::Double)?].concat())
}

/// Profiles the first stage whose name contains `words`.
///
/// # Errors
/// As [`measure`]; also if no stage has such a name, in which case the message lists the names.
pub fn profile(words: &str) -> Result<(String, Profile)> {
    let cases = cases()?;
    let names = || cases.iter().map(|case| case.name.as_str()).collect::<Vec<_>>().join("\n  ");
    let case = cases.iter().find(|case| case.name.contains(words));
    let case =
        case.with_context(|| format!("no stage has `{words}` in its name; the stages are\n  {}", names()))?;
    let mut bench = Bench::default();
    bench.request(case.stage, case.scalar, &case.input);
    Ok((case.name.clone(), bench.profile(case.epochs - 1)?))
}

/// Name of the usual epoch, without its number of satellites.
const WHOLE: &str = "whole epoch, bytes in to bytes out";

/// Bounds the cycles of the usual epoch.
///
/// # Errors
/// As [`measure`].
pub fn cycles() -> Result<(String, Cycles)> {
    let cases = wire()?;
    let whole = cases.iter().find(|case| case.name.starts_with(WHOLE)).context("no whole epoch")?;
    let mut bench = Bench::default();
    bench.request(whole.stage, whole.scalar, &whole.input);
    Ok((whole.name.clone(), bench.cycles(0)?))
}

fn cases() -> Result<Vec<Case>> {
    let mut cases = authentication()?;
    for constellations in [1, 2] {
        for count in SIZES {
            cases.extend(tests(count, constellations, Scalar::Single)?);
        }
    }
    for count in [20, 40] {
        cases.extend(tests(count, 2, Scalar::Double)?);
        cases.extend(searches(count)?);
    }
    cases.extend(separations()?);
    cases.extend(judgements()?);
    cases.extend(methods()?);
    cases.extend(thresholds_and_clock()?);
    cases.extend(wire()?);
    cases.extend(wire_of_ubx()?);
    Ok(cases)
}

fn run(cases: &[Case], machine: Machine) -> Result<Vec<Answer>> {
    let mut bench = Bench::default();
    for case in cases {
        bench.request(case.stage, case.scalar, &case.input);
    }
    let mut answers = bench.run_on(machine)?.into_iter();
    let last =
        |case: &Case| answers.nth(case.epochs - 1).with_context(|| format!("{}: no answer", case.name));
    let measured = cases.iter().map(last).collect::<Result<_>>()?;
    anyhow::ensure!(answers.next().is_none(), "more answers than epochs");
    Ok(measured)
}

/// Pages of a sky that a key of the tests has signed, behind that key.
const SIGNED: &[u8] = include_bytes!("../../../vectors/osnma_pages.bin");

/// Returns the slices of the authentication, none of which may exceed 60,000 instructions.
fn authentication() -> Result<Vec<Case>> {
    let case = |number: u8, name: &str, target| Case {
        name: format!("OSNMA: {name}"),
        stage: Stage::Authenticate,
        scalar: Scalar::Single,
        input: [&[number], SIGNED].concat(),
        target: Some(target),
        epochs: 1,
    };
    let contradicting = Wrong { faults: 7, scale: 100.0, from_s: 1.0 };
    let compared = Case {
        stage: Stage::Compare,
        input: Stream::with(2, 40, contradicting)?.epochs.concat(),
        ..case(0, "largest slice with the place of one system", 60_000)
    };
    Ok(vec![
        case(0, "largest slice", 60_000),
        case(1, "largest slice with a tag", 60_000),
        case(2, "largest slice with steps of the chain", 60_000),
        compared,
        case(3, "page", 20_000),
    ])
}

/// Encodes starting point and epoch.
fn linear(count: usize, constellations: usize, faults: usize) -> Result<Vec<u8>> {
    Ok([point_bytes(site().position), epoch_bytes(&epoch(count, constellations, faults)?)].concat())
}

fn words(scalar: Scalar) -> &'static str {
    match scalar {
        Scalar::Single => "f32",
        Scalar::Double => "f64",
    }
}

fn tests(count: usize, constellations: usize, scalar: Scalar) -> Result<Vec<Case>> {
    let systems = if constellations == 1 { "one constellation" } else { "two constellations" };
    let on = format!("{count} satellites, {systems}, {}", words(scalar));
    let target = |at_20: u64, at_40: Option<u64>| match (count, constellations, scalar) {
        (20, 2, Scalar::Single) => Some(at_20),
        (40, 2, Scalar::Single) => at_40,
        _ => None,
    };
    Ok(vec![
        Case {
            name: format!("snapshot and tests, {on}"),
            stage: Stage::Test,
            scalar,
            input: linear(count, constellations, 0)?,
            target: target(3_600, Some(6_600)),
            epochs: 1,
        },
        Case {
            name: format!("the same, one left out and tested again, {on}"),
            stage: Stage::TestWithoutWorst,
            scalar,
            input: linear(count, constellations, 1)?,
            target: target(5_200, None),
            epochs: 1,
        },
    ])
}

/// Returns the searches for faulty satellites. Three are faulty, so that every pair is tried in
/// vain.
fn searches(count: usize) -> Result<Vec<Case>> {
    let on = format!("{count} satellites, two constellations, f32");
    let three = linear(count, 2, 3)?;
    let target = |target| (count == 20).then_some(target);
    let case = |name: &str, stage, input, most| Case {
        name: format!("{name}, {on}"),
        stage,
        scalar: Scalar::Single,
        input,
        target: target(most),
        epochs: 1,
    };
    Ok(vec![
        case("grouping, all pairs", Stage::Group, [vec![2], three.clone()].concat(), 40_000),
        case("grouping, all triples", Stage::Group, [vec![3], three].concat(), 200_000),
        case("RANSAC, selection kept", Stage::Vote, linear(count, 2, 1)?, 30_000),
        case("RANSAC, new selection", Stage::Select, linear(count, 2, 1)?, 300_000),
    ])
}

/// Returns ARAIM over the fix's snapshot, without and with nominal biases.
fn separations() -> Result<Vec<Case>> {
    let mut cases = Vec::new();
    for (count, constellations, targets) in
        [(20, 2, [20_000, 30_000]), (30, 3, [160_000, 350_000]), (40, 4, [400_000, 1_000_000])]
    {
        for ((has_bias, words), target) in [(0, "no biases"), (1, "biases")].into_iter().zip(targets) {
            cases.push(Case {
                name: format!("ARAIM, {count} satellites of {constellations} constellations, {words}, f32"),
                stage: Stage::Separate,
                scalar: Scalar::Single,
                input: [vec![has_bias], linear(count, constellations, 0)?].concat(),
                target: Some(target),
                epochs: 1,
            });
        }
    }
    Ok(cases)
}

/// Encodes a monitor's input: method, policy, clock aiding, start, and an epoch of two
/// constellations for each number of faults.
pub(super) fn judgement(method: usize, start: Ecef, count: usize, faults: &[usize]) -> Result<Vec<u8>> {
    let mut input = vec![method as u8, 0, 0];
    input.extend(point_bytes(start));
    input.push(faults.len() as u8);
    for &faults in faults {
        input.extend(epoch_bytes(&epoch(count, 2, faults)?));
    }
    Ok(input)
}

fn judgements() -> Result<Vec<Case>> {
    let mut cases = Vec::new();
    let mut add = |name: &str, scalar, (from, count, faults): (Ecef, usize, usize), target| -> Result<()> {
        let name = format!("fix and integrity, {name}, {count} satellites, {}", words(scalar));
        let input = judgement(0, from, count, &[faults])?;
        cases.push(Case { name, stage: Stage::Judge, scalar, input, target, epochs: 1 });
        Ok(())
    };
    let single = Scalar::Single;
    add("from 1 km", single, (start(), 20, 0), Some(60_000))?;
    add("from 1 km, one fault", single, (start(), 20, 1), Some(68_000))?;
    add("from 1 km, two faults", single, (start(), 20, 2), Some(75_000))?;
    add("from 1 km, three faults", single, (start(), 20, 3), None)?;
    add("from the last position", single, (site().position, 20, 0), Some(32_000))?;
    add("from the earth's centre", single, (Ecef::CENTRE, 20, 0), Some(600_000))?;
    for count in [8, 12, 30, 40] {
        add("from 1 km", single, (start(), count, 0), None)?;
    }
    add("from 1 km", Scalar::Double, (start(), 20, 0), None)?;
    Ok(cases)
}

/// Returns every method on the same epochs, each after one like it, as in a stream, because RANSAC
/// keeps its selection.
fn methods() -> Result<Vec<Case>> {
    let case = |(method, name): (usize, &str), faults: usize| -> Result<Case> {
        Ok(Case {
            name: of_method(name, faults),
            stage: Stage::Judge,
            scalar: Scalar::Single,
            input: judgement(method, site().position, 20, &[faults, faults])?,
            target: None,
            epochs: 2,
        })
    };
    let each = METHODS.into_iter().enumerate();
    each.flat_map(|method| (0..=3).map(move |faults| (method, faults)))
        .map(|(method, faults)| case(method, faults))
        .collect()
}

fn thresholds_and_clock() -> Result<Vec<Case>> {
    let sky = linear(20, 2, 0)?;
    let case = |name: &str, stage, input, target| Case {
        name: name.to_owned(),
        stage,
        scalar: Scalar::Single,
        input,
        target: Some(target),
        epochs: 1,
    };
    // The clock drifts by 30 m/s and wanders.
    let clock = (0..61_i32).map(|second| f64::from(second * 30 + second * second % 7));
    Ok(vec![
        case(
            "clock aiding, update and forecast",
            Stage::Coast,
            clock.flat_map(f64::to_le_bytes).collect(),
            8_000,
        ),
        case("T_OP for a new geometry", Stage::Policy, [vec![2], sky.clone()].concat(), 10_000),
        case("T2 for a new geometry", Stage::Policy, [vec![1], sky].concat(), 40_000),
    ])
}

fn wire() -> Result<Vec<Case>> {
    let stream = Stream::with(3, 20, Wrong::NOTHING)?;
    let on = format!("{} satellites", stream.satellites);
    let (before, last) = stream.split()?;
    let silent = Stream::without_range_rates(3, 20)?;
    let (before_silent, last_silent) = silent.split()?;
    let all = stream.epochs.concat();
    let case = |name: &str, stage, input, target| Case {
        name: format!("{name}, {on}"),
        stage,
        scalar: Scalar::Single,
        input,
        target,
        epochs: 1,
    };
    let here = point_bytes(site().position);
    Ok(vec![
        case("RTCM of one epoch, two MSM7", Stage::Decode, halves(&before, last), Some(65_000)),
        case("orbits and clocks", Stage::Locate, all.clone(), Some(100_000)),
        case("atmosphere and sigmas", Stage::Correct, [here, all.clone()].concat(), Some(40_000)),
        case("sentences", Stage::Speak, all, Some(45_000)),
        case(WHOLE, Stage::Whole, whole(&[], &before, last), Some(340_000)),
        case(
            "whole epoch without range rates, bytes in to bytes out",
            Stage::Whole,
            whole(&[], &before_silent, last_silent),
            Some(340_000),
        ),
    ])
}

/// Returns the same sky as UBX, with two signals per satellite.
fn wire_of_ubx() -> Result<Vec<Case>> {
    let stream = Stream::of_ubx(3, 20)?;
    let (before, last) = stream.split()?;
    let case = |name: &str, stage, input, target| Case {
        name: format!("{name}, {} satellites", stream.satellites),
        stage,
        scalar: Scalar::Single,
        input,
        target: Some(target),
        epochs: 1,
    };
    Ok(vec![
        case("UBX of one epoch, RAWX of 40 signals", Stage::Decode, halves(&before, last), 40_000),
        case("whole epoch by UBX, bytes in to bytes out", Stage::Whole, whole(&[], &before, last), 1_000_000),
    ])
}

fn halves(before: &[u8], last: &[u8]) -> Vec<u8> {
    [&(before.len() as u32).to_le_bytes(), before, last].concat()
}

/// Encodes commands, the bytes before, and the epoch.
pub(super) fn whole(commands: &[String], before: &[u8], last: &[u8]) -> Vec<u8> {
    let sentences: String = commands.iter().map(|command| raim::sentence::command(command)).collect();
    [vec![sentences.len() as u8], sentences.into_bytes(), halves(before, last)].concat()
}
