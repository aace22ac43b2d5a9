//! The C interface, used from C: compiled strictly, sanitised, on the host and on the emulated
//! chip.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use raim::replay::{self, Window};
use raim::signal::encode::{Frequency, Selection};
use raim::signal::sky::raw::Simulation;
use raim_firmware::pin::MemoryPin;
use raim_firmware::receiver::{Boot, Receiver};
use rig::capi::program::{STRICT, SYSTEM};
use rig::capi::{Kind, WHOLE, folder, library, run};
use rig::skip;

fn example(name: &str) -> PathBuf {
    folder().join("examples/c").join(name)
}

/// Compiles a C program against the library and returns its path.
fn compile(compiler: &str, source: &Path, library: &Path, flags: &[&str], out: &Path) -> PathBuf {
    let program = out.join("program");
    let mut command = Command::new(compiler);
    command
        .args(STRICT)
        .args(flags)
        .arg("-I")
        .arg(folder().join("include"))
        .arg("-o")
        .arg(&program)
        .arg(source);
    command.arg("-x").arg("none").arg(library).args(SYSTEM);
    run(&mut command).expect("the example compiles without a warning");
    program
}

/// Returns true if these programs are installed; otherwise reports that the calling test is
/// skipped.
fn has(programs: &[&str]) -> bool {
    let missing = programs.iter().find(|program| run(Command::new(program).arg("--version")).is_err());
    if let Some(program) = missing {
        skip::say(&format!("the program {program}"));
    }
    missing.is_none()
}

#[test]
fn monitor_from_c_names_the_satellite_that_is_wrong() {
    if !has(&["gcc", "g++"]) {
        return;
    }
    let library = library(Kind::Static, WHOLE).expect("the library builds");
    let out = tempfile::tempdir().expect("a folder");
    let modes: [(&str, &[&str]); 3] = [
        ("gcc", &["-std=c99"]),
        ("g++", &["-std=c++17", "-x", "c++"]),
        ("gcc", &["-std=c11", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"]),
    ];
    for (compiler, flags) in modes {
        let program = compile(compiler, &example("monitor.c"), &library, flags, out.path());
        let reported = String::from_utf8(run(&mut Command::new(&program)).expect("protected")).expect("text");
        // The example in the README of `raim-core`, with its numbers: G05 is left out, and nothing else.
        assert!(reported.starts_with("EXCLUDED: 6 of 7 satellites, HPL "), "{reported}");
        assert!(reported.contains("left out: G05, off by 80.0 m"), "{reported}");
    }
}

#[test]
fn receiver_from_c_says_every_byte_that_it_says_from_rust() {
    if !has(&["gcc"]) {
        return;
    }
    let library = library(Kind::Static, WHOLE).expect("the library builds");
    let out = tempfile::tempdir().expect("a folder");
    let flags = ["-std=c11", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"];
    let program = compile("gcc", &example("receiver.c"), &library, &flags, out.path());

    let bytes = stream();
    let mut child =
        Command::new(program).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().expect("it runs");
    child.stdin.take().expect("piped").write_all(&bytes).expect("it reads");
    let output = child.wait_with_output().expect("it ends");
    assert!(output.status.success(), "{}", output.status);
    let want = from_rust(&bytes);
    assert!(want.matches(",P,OK,").count() >= 10, "the comparison is of something:\n{want}");
    assert_eq!(String::from_utf8_lossy(&output.stdout), want);
}

/// Returns the bytes of a receiver of a simulated sky.
fn stream() -> Vec<u8> {
    let selection = Selection::new("G", Frequency::Dual).expect("a system");
    let recording = Simulation::above_xian(7200.0, 20, 3).record();
    let lumps = replay::encode(&recording, &selection, &[], &Window::ALL).expect("a recording");
    lumps.into_iter().flat_map(|lump| lump.bytes).collect()
}

/// Returns the module's output for a stream, called from Rust at the times at which the C program
/// calls it.
fn from_rust(bytes: &[u8]) -> String {
    let boot = Boot::on_host("library");
    let mut receiver = Receiver::new(MemoryPin::default(), boot).expect("in the tables");
    let mut reported = Vec::new();
    receiver.greet(&mut reported);
    for (count, byte) in (1_u64..).zip(bytes) {
        receiver.gnss(&[*byte], count * 1000 / 11520, &mut reported);
    }
    String::from_utf8(reported).expect("ASCII")
}
