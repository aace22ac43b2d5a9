//! The sample for Zephyr on a board of the host: Zephyr's functions are stubs, so that the sample's
//! own lines are tested, and Zephyr and the devicetree are not.

use std::io::Write as _;
use std::process::{Command, Stdio};

use raim::replay::{self, Window};
use raim::signal::encode::{Frequency, Selection};
use raim::signal::sky::raw::Simulation;
use rig::capi::{Kind, WHOLE, folder, library, run};
use rig::skip;

/// Time to alert at start, ms, and the longest delay of the sample: one tick, and the rest of one.
const TIME_TO_ALERT_MS: u64 = 10_000;
const DELAY_MS: u64 = 200;

#[test]
fn pin_of_the_zephyr_sample_rises_with_the_sky_and_falls_in_a_silence() {
    if run(Command::new("gcc").arg("--version")).is_err() {
        skip::say("gcc");
        return;
    }
    let out = tempfile::tempdir().expect("a folder");
    let program = out.path().join("sample");
    let stub = folder().join("tests/zephyr");
    let mut compile = Command::new("gcc");
    compile.args(["-std=c99", "-Wall", "-Wextra", "-Werror", "-o"]).arg(&program);
    compile.arg("-I").arg(stub.join("include")).arg("-I").arg(folder().join("include"));
    compile.arg(folder().join("../../zephyr/samples/pin/src/main.c")).arg(stub.join("board.c"));
    compile.arg(library(Kind::Static, WHOLE).expect("the library builds"));
    run(compile.args(["-lm", "-lpthread", "-ldl"])).expect("the sample compiles");

    let recording = Simulation::above_xian(7200.0, 40, 3).record();
    let selection = Selection::new("GC", Frequency::Dual).expect("two systems");
    let lumps = replay::encode(&recording, &selection, &[], &Window::ALL).expect("a recording");
    let bytes: Vec<u8> = lumps.into_iter().flat_map(|lump| lump.bytes).collect();
    let mut board = Command::new(program)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("it was compiled a moment ago");
    board.stdin.take().expect("a pipe").write_all(&bytes).expect("it reads");
    let reported = board.wait_with_output().expect("it ends").stdout;
    let reported = String::from_utf8(reported).expect("text");
    let lines: Vec<Vec<&str>> = reported.lines().map(|line| line.split(' ').collect()).collect();
    let end_ms = bytes.len() as u64 * 10 * 1000 / 115_200;
    let [at_start, rise, fall, host] = lines.as_slice() else { panic!("{reported}") };
    assert_eq!(*at_start, ["pin", "0", "at", "0"], "{reported}");
    let time_ms = |line: &[&str]| line[3].parse::<u64>().expect("a time");
    assert!(rise[1] == "1" && time_ms(rise) < end_ms, "{reported}");
    assert!(fall[1] == "0" && time_ms(fall) <= end_ms + TIME_TO_ALERT_MS + DELAY_MS, "{reported}");
    assert!(host[1].parse::<u64>().expect("a number") > 40 * 300, "the host gets the sentences: {reported}");
}
