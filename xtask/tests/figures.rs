//! Figures in the documents agree with their sources.
//!
//! [`compared`] lists passages whose figures are computed here from constants of the code and from
//! the budgets, which `cargo xtask bench --check` compares with the program. [`MEASURED`] lists
//! passages whose figures a named command prints, and [`GIVEN`] those that describe an input or
//! the hardware. In README.md and RESULTS.md every number with a unit belongs to a passage of one
//! of the lists.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use raim_core::requirements::Requirements;
use rig::bench::budget;
use rig::bench::time::{FULL_HZ, INTERNAL_HZ};
use rig::image::{Chip, Named};

/// Documents in which every number with a unit needs a passage.
const COMPLETE: [&str; 2] = ["README.md", "RESULTS.md"];

/// Passages whose figures a command prints: document, passage, command.
const MEASURED: &[(&str, &str, &str)] = &[
    ("README.md", "drifts off by 200 m. A receiver that accepts every satellite goes 75 m astray", "demo"),
    ("README.md", "its position stays within 6 m", "demo"),
    ("README.md", "drifts off by 200 m. After 3 s the module excludes G15", "demo"),
    (
        "README.md",
        "(blue) stays within 6 m of the true one. It also stays *protected*, which means that it may be used. A \
         receiver that accepts every satellite is 75 m off",
        "demo",
    ),
    ("README.md", "A time tag up to 20 ms off may stay undetected", "attack wrong-tags"),
    ("README.md", "A drift within 1 m/s of the measured velocity may stay", "attack walk-off"),
    ("README.md", "`tests-host/campaigns/lpv200.toml` describes takes 3 s", "campaign tests-host/campaigns/lpv200.toml"),
    ("README.md", "errors of 0.52 m horizontally and 0.86 m vertically", "test accuracy"),
    ("RESULTS.md", "0.52 / 0.86 m, 2880 of 2880 epochs protected", "test accuracy"),
    (
        "RESULTS.md",
        "by a table of 1.9 kB | 2.0 m rms, 3.9 m over 95 % of the Earth, 22.5 m at most",
        "tables --check",
    ),
    ("RESULTS.md", "1400 values, worst 2e-15", "tables --check"),
    ("RESULTS.md", "100 epochs | `… --test all vectors …`", "test vectors"),
    (
        "RESULTS.md",
        "GPS and Galileo: mean availability | 99.92 % |",
        "campaign tests-host/campaigns/lpv200.toml",
    ),
    ("RESULTS.md", "0 to 0.6 % of all epochs are protected beyond their level", "attack --several 1000"),
    ("RESULTS.md", "/ 2.0 / 2.5 M instructions | `cargo xtask bench --peers`", "bench --peers"),
    (
        "RESULTS.md",
        "21 satellites, on a server core | 6 µs; sidereon-core, levels alone: 408 µs",
        "bench --sidereon",
    ),
    (
        "RESULTS.md",
        "59 cuts of its line, 12 kills and 360 dead clients | no epoch lost, 10.2 MB of memory, 0.24 % of",
        "cargo xtask endure",
    ),
    ("RESULTS.md", "the pin is set within 30 ms by the same model", "test pin_in_time"),
];

/// Passages whose figures are inputs or facts of the hardware: document, passage.
const GIVEN: &[(&str, &str)] = &[
    ("README.md", "30 epochs of a ZED-F9R"),
    ("README.md", "here the range to G06 is 80 m too long from 20 s to 40 s"),
    ("README.md", "A pull-down of 10 kΩ or less is required"),
    ("README.md", "8 MHz crystal on PH0, PH1"),
    ("README.md", "is wrong by 80 m (this block is a test)"),
    ("RESULTS.md", "100 m on each satellite in turn"),
];

/// Passages with the figures that they must have: document, passage.
fn compared() -> Vec<(&'static str, String)> {
    let budgets = Budgets(budget::committed().expect("the committed figures"));
    [
        limits(),
        board(),
        cost(&budgets),
        stages(&budgets),
        second_board(&budgets),
        memory(&budgets),
        libraries(&budgets),
        arithmetic(),
    ]
    .concat()
}

fn limits() -> Vec<(&'static str, String)> {
    let (npa, lpv) = (Requirements::non_precision_approach(), Requirements::lpv200());
    let val_m = lpv.val_m.expect("a vertical limit");
    vec![
        ("README.md", format!("(HAL {} m), or `LPV200` (HAL {} m, VAL {val_m} m)", npa.hal_m, lpv.hal_m)),
        ("README.md", format!("for the time to alert ({} s in `NPA`)", npa.time_to_alert_s)),
        (
            "README.md",
            format!("darker than the colour of {val_m} m, LPV-200 is unavailable there at least 1 % of"),
        ),
        ("LIMITS.md", format!("UTC is GPS time less {} s", raim_firmware::output::nmea::GPS_MINUS_UTC_S)),
        ("LIMITS.md", format!("{} m beside Hawaii", raim_firmware::output::geoid::LARGEST_ERROR_M)),
    ]
}

fn board() -> Vec<(&'static str, String)> {
    let rates = raim_firmware::bit_rate::RATES;
    let [slowest, fastest] = [rates.iter().min(), rates.iter().max()].map(|rate| rate.expect("a rate"));
    vec![
        ("README.md", format!("8N1, {slowest} to {fastest} baud")),
        ("README.md", format!("commands in, {} baud", rates[0])),
        ("README.md", format!("without it the module runs at {} MHz", INTERNAL_HZ / 1_000_000)),
    ]
}

fn cost(budgets: &Budgets) -> Vec<(&'static str, String)> {
    const USUAL: &str = "whole epoch, bytes in to bytes out, 20 satellites";
    const WORST: &str = "worst-case epoch of a stream";
    let mhz = FULL_HZ / 1_000_000;
    let (usual, worst) = (budgets.millions(USUAL), budgets.millions(WORST));
    let (usual_ms, worst_ms) = (budgets.times_ms(USUAL), budgets.times_ms(WORST));
    let fix = budgets.millions("fix and integrity, from 1 km, 20 satellites, f32");
    vec![
        (
            "README.md",
            format!(
                "A whole epoch of 20 satellites costs {usual} million instructions on a Cortex-M4F, \
                 {usual_ms} at {mhz} MHz"
            ),
        ),
        (
            "RESULTS.md",
            format!(
                "A whole epoch of 20 satellites on the chip | {usual} M instructions, {usual_ms} at {mhz} MHz"
            ),
        ),
        ("RESULTS.md", format!("fix and integrity of it {fix} M |")),
        ("RESULTS.md", format!("no fault | {fix} / 2.0")),
        (
            "RESULTS.md",
            format!("that a search found, 40 satellites | {worst} M instructions, {worst_ms}; the pin"),
        ),
    ]
}

/// Returns the rows of the table of stages, without the goals.
fn stages(budgets: &Budgets) -> Vec<(&'static str, String)> {
    let of = |name: &str| budgets.rounded(name);
    let test = |count: u8| of(&format!("snapshot and tests, {count} satellites, two constellations, f32"));
    let of_twenty = |what: &str| of(&format!("{what}, 20 satellites, two constellations, f32"));
    let of_forty = |what: &str| of(&format!("{what}, 40 satellites, two constellations, f32"));
    let (kept, new) = ("RANSAC, selection kept", "RANSAC, new selection");
    let araim = |sky: &str| {
        let [without, with] =
            ["no biases", "biases"].map(|biases| of(&format!("ARAIM, {sky}, {biases}, f32")));
        format!("{without} / {with}")
    };
    let fix = |what: &str| of(&format!("fix and integrity, from {what}20 satellites, f32"));
    let rows = [
        format!("w-tests, slopes, HPL, VPL | {} (40 satellites: {}) |", test(20), test(40)),
        format!("one excluded and tested again | {} |", of_twenty("the same, one left out and tested again")),
        format!(
            "all pairs / all triples | {} / {} |",
            of_twenty("grouping, all pairs"),
            of_twenty("grouping, all triples")
        ),
        format!(
            "selection kept / new | {} / {} (40 satellites: {} / {}) |",
            of_twenty(kept),
            of_twenty(new),
            of_forty(kept),
            of_forty(new)
        ),
        format!("without / with nominal biases | {} |", araim("20 satellites of 2 constellations")),
        format!("30 of 3 (375 modes) | {} |", araim("30 satellites of 3 constellations")),
        format!("40 of 4 (770 modes) | {} |", araim("40 satellites of 4 constellations")),
        format!("update and forecast | {} |", of("clock aiding, update and forecast")),
        format!(
            "| T_OP / T2 for a new geometry | {} / {} |",
            of("T_OP for a new geometry"),
            of("T2 for a new geometry")
        ),
        format!("ranges compared with those before | {} |", of("RTCM of one epoch, two MSM7, 20 satellites")),
        format!("places and bands compared | {} |", of("orbits and clocks, 20 satellites")),
        format!("| atmosphere, sigmas | {} |", of("atmosphere and sigmas, 20 satellites")),
        format!(
            "no fault / one / two excluded | {} / {} / {} |",
            fix("1 km, "),
            fix("1 km, one fault, "),
            fix("1 km, two faults, ")
        ),
        format!("the same from the last position | {} |", fix("the last position, ")),
        format!("including `RMC`, `GGA` and `VTG` | {} |", of("sentences, 20 satellites")),
        format!("RXM-RAWX of 40 signals | {} |", of("UBX of one epoch, RAWX of 40 signals, 20 satellites")),
        format!(
            "**whole epoch by UBX**, the same 20 satellites | **{} M** |",
            budgets.millions("whole epoch by UBX, bytes in to bytes out, 20 satellites")
        ),
        format!(
            "the same as the first of a stream | {} M / {} M |",
            budgets.millions("worst-case epoch of a stream"),
            budgets.millions("worst-case first epoch")
        ),
        format!(
            "deepest stack, KiB | {:.0} / {:.1} / {:.1} |",
            budgets.kib("image `fast`: flash, bytes"),
            budgets.kib("image `fast`: static RAM, bytes"),
            budgets.kib("image `fast`: stack high water, bytes")
        ),
    ];
    rows.map(|row| ("results/cost.md", row)).into()
}

/// Returns the rows of the table that compares the boards.
fn second_board(budgets: &Budgets) -> Vec<(&'static str, String)> {
    let both = |row: &str, names: &[&str]| {
        let of_board = |board: &str| {
            names
                .iter()
                .map(|name| budgets.rounded(&format!("{name}{board}")))
                .collect::<Vec<_>>()
                .join(" / ")
        };
        ("results/cost.md", format!("{row} | {} | {} |", of_board(""), of_board(", Cortex-M7")))
    };
    let fix = [
        "fix and integrity, from 1 km, 20 satellites, f32",
        "fix and integrity, from 1 km, one fault, 20 satellites, f32",
        "fix and integrity, from 1 km, two faults, 20 satellites, f32",
    ];
    vec![
        both("| RTCM of one epoch", &["RTCM of one epoch, two MSM7, 20 satellites"]),
        both("| orbits and clocks", &["orbits and clocks, 20 satellites"]),
        both("| atmosphere, sigmas", &["atmosphere and sigmas, 20 satellites"]),
        both("`f32`: no fault / one / two excluded", &fix),
        both("| the same in `f64`, no fault", &["fix and integrity, from 1 km, 20 satellites, f64"]),
        both("| sentences", &["sentences, 20 satellites"]),
        both("| whole epoch", &["whole epoch, bytes in to bytes out, 20 satellites"]),
    ]
}

fn memory(budgets: &Budgets) -> Vec<(&'static str, String)> {
    let of = |image: &str, quantity: &str| budgets.bytes(&format!("image `{image}`: {quantity}, bytes"));
    let whole = Named::of("whole").expect("an image");
    let [supported, others] = whole.carriers();
    let smallest =
        supported.iter().chain(&others).min_by_key(|chip| (chip.flash_kib, chip.ram_kib)).expect("a chip");
    let Chip { flash_kib, ram_kib, .. } = smallest;
    let kib = |bytes: u64| format!("{:.0} KiB", bytes as f64 / 1024.0);
    let stack = format!("{:.1} KiB", of("whole", "stack high water") as f64 / 1024.0);
    let library = budgets.bytes("C library, monitor, classic, 16 satellites: flash, bytes");
    let small = Named::of("small").expect("an image");
    let small_ram = of("small", "static RAM") + small.stack_bytes;
    vec![
        (
            "RESULTS.md",
            format!(
                "a chip with {flash_kib} KiB of flash and {ram_kib} KiB of RAM, compiled for size, {} satellites | {}, {} and {stack} of stack",
                whole.satellites,
                kib(of("whole", "flash")),
                kib(of("whole", "static RAM"))
            ),
        ),
        ("RESULTS.md", format!("library for C on a Cortex-M4F | {} of flash", kib(library))),
        ("LIMITS.md", format!("needs {} of flash and {} of RAM", kib(of("small", "flash")), kib(small_ram))),
    ]
}

/// Rows of the table of the libraries for C.
fn libraries(budgets: &Budgets) -> Vec<(&'static str, String)> {
    let kib = |build: &str| {
        let bytes = budgets.bytes(&format!("C library, {build}: flash, bytes"));
        format!("{:.0}", bytes as f64 / 1024.0)
    };
    let rows = [
        ("thresholds of the phases of flight", "monitor, classic, 48 satellites"),
        ("which has no floating-point hardware", "monitor, classic, 48 satellites, Cortex-M0+"),
        ("with all tables and the papers' searches", "monitor, all tables and searches, 48 satellites"),
        ("with ARAIM as well", "monitor, all and ARAIM, 48 satellites"),
        ("RTCM and classic RAIM", "receiver, RTCM and classic, 48 satellites"),
        ("`rai_receiver_*`, everything", "receiver, 48 satellites"),
    ];
    rows.map(|(row, build)| ("results/cost.md", format!("{row} | {} KiB |", kib(build)))).to_vec()
}

fn arithmetic() -> Vec<(&'static str, String)> {
    let triples_of_twenty = 20 * 19 * 18 / 6;
    let thousands = format!("{},{:03}", triples_of_twenty / 1000, triples_of_twenty % 1000);
    vec![("DESIGN.md", format!("would take {thousands} solutions for three of twenty"))]
}

/// Committed figures by name.
struct Budgets(BTreeMap<String, u64>);

impl Budgets {
    fn bytes(&self, name: &str) -> u64 {
        *self.0.get(name).unwrap_or_else(|| panic!("{name} is not committed"))
    }

    fn kib(&self, name: &str) -> f64 {
        self.bytes(name) as f64 / 1024.0
    }

    /// Returns instructions in millions, with two decimals.
    fn millions(&self, name: &str) -> String {
        format!("{:.2}", self.bytes(name) as f64 / 1e6)
    }

    /// Returns instructions, rounded to hundreds, and from 100,000 on to thousands.
    fn rounded(&self, name: &str) -> String {
        let count = self.bytes(name);
        let step = if count < 100_000 { 100 } else { 1000 };
        let rounded = (count + step / 2) / step * step;
        format!("{},{:03}", rounded / 1000, rounded % 1000)
    }

    /// Returns the bounds of a time at full speed, ms.
    fn times_ms(&self, name: &str) -> String {
        let ms = |bound: &str| {
            let mhz = FULL_HZ / 1_000_000;
            let cycles = self.bytes(&format!("{name}, cycles at {mhz} MHz, at {bound}"));
            format!("{:.1}", 1e3 * cycles as f64 / FULL_HZ as f64)
        };
        format!("{} to {} ms", ms("least"), ms("most"))
    }
}

/// Returns a document with one space between its words.
fn document(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(name);
    let text = fs::read_to_string(path).expect("a document");
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Units of figures.
const UNITS: [&str; 33] = [
    "m",
    "km",
    "mm",
    "cm",
    "s",
    "ms",
    "µs",
    "min",
    "h",
    "MHz",
    "Hz",
    "kΩ",
    "KiB",
    "MiB",
    "kB",
    "MB",
    "byte",
    "bytes",
    "baud",
    "%",
    "°",
    "TECU",
    "M",
    "million",
    "instructions",
    "epochs",
    "satellites",
    "attacks",
    "cuts",
    "kills",
    "dead",
    "values",
    "pixels",
];

/// Returns the numbers with a unit outside code, each by its place and its text.
fn figures(text: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    let mut is_code = false;
    let mut start = 0;
    let mut last: Option<(usize, &str)> = None;
    for word in text.split(' ') {
        let ticks = word.matches('`').count();
        let outside = !is_code && ticks == 0;
        is_code ^= ticks % 2 == 1;
        let unit =
            word.trim_matches(|letter: char| "().,;:|*/]".contains(letter)).split('/').next().unwrap_or("");
        if let Some((at, number)) = last.take().filter(|_| outside && UNITS.contains(&unit)) {
            found.push((at, format!("{number} {unit}")));
        }
        let number = word.trim_start_matches(['(', '|', '*', '[']);
        let is_number = number.starts_with(|first: char| first.is_ascii_digit())
            && number.chars().all(|letter| letter.is_ascii_digit() || ".,".contains(letter))
            && number.ends_with(|last: char| last.is_ascii_digit());
        last = (outside && is_number).then_some((start, number));
        start += word.len() + 1;
    }
    found
}

/// Returns a text without blocks of code.
fn without_blocks(name: &str) -> String {
    document(name).split("```").step_by(2).collect::<Vec<_>>().join(" ")
}

#[test]
fn figures_in_the_documents_are_those_of_code_and_budgets() {
    let differing: Vec<String> = compared()
        .into_iter()
        .filter(|(name, passage)| !document(name).contains(passage.as_str()))
        .map(|(name, passage)| format!("{name} must say: {passage}"))
        .collect();
    assert!(differing.is_empty(), "figures differ from their sources:\n{}", differing.join("\n"));
}

#[test]
fn every_number_with_a_unit_is_compared_or_has_a_command() {
    let measured = MEASURED.iter().map(|(name, passage, _)| (*name, (*passage).to_owned()));
    let given = GIVEN.iter().map(|(name, passage)| (*name, (*passage).to_owned()));
    let passages: Vec<_> = compared().into_iter().chain(measured).chain(given).collect();
    for name in COMPLETE {
        let text = without_blocks(name);
        let mut covered = Vec::new();
        for (_, passage) in passages.iter().filter(|(of, _)| *of == name) {
            let at =
                text.find(passage.as_str()).unwrap_or_else(|| panic!("{name} no longer says: {passage}"));
            covered.push(at..at + passage.len());
        }
        let all = figures(&text);
        assert!(all.len() > 20, "{name}: {} figures", all.len());
        let free: Vec<_> =
            all.iter().filter(|(at, _)| !covered.iter().any(|range| range.contains(at))).collect();
        assert!(free.is_empty(), "{name}: no source is listed for {free:?}");
    }
}

#[test]
fn measured_figures_name_a_command() {
    let sources = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    for (name, passage, command) in MEASURED {
        let verb = command.split(' ').next().unwrap_or_default();
        let is_there =
            sources.join(verb).with_extension("rs").exists() || sources.join(verb).join("mod.rs").exists();
        assert!(is_there, "{name}, {passage}: `cargo xtask {command}` is no command");
    }
}

#[test]
fn number_with_a_unit_is_found_in_prose_and_not_in_code() {
    let text = "a fault of 80 m (or 1,140 epochs), `--bias 80 m`, 2.2 to 3.5 ms; version 3 of G06 | 62 KiB |";
    let have: Vec<_> = figures(text).into_iter().map(|(_, figure)| figure).collect();
    assert_eq!(have, ["80 m", "1,140 epochs", "3.5 ms", "62 KiB"]);
}
