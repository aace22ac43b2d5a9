//! The package for Python: its own tests, with the library of this tree and the recording of a
//! simulated sky.

use std::process::Command;

use raim::replay::{self, Window};
use raim::signal::encode::{Frequency, Selection};
use raim::signal::sky::raw::Simulation;
use rig::capi::{Kind, WHOLE, folder, library, run};
use rig::skip;

/// Epochs of the recording.
const EPOCHS: usize = 20;

#[test]
fn package_for_python_passes_its_own_tests() {
    for module in ["numpy", "pandas"] {
        if run(Command::new("python3").args(["-c", &format!("import {module}")])).is_err() {
            skip::say(&format!("python3 with {module}"));
            return;
        }
    }
    let out = tempfile::tempdir().expect("a folder");
    let capture = out.path().join("capture.rtcm3");
    let selection = Selection::new("G", Frequency::Dual).expect("a system");
    let recording = Simulation::above_xian(7200.0, EPOCHS as u32, 3).record();
    let lumps = replay::encode(&recording, &selection, &[], &Window::ALL).expect("a recording");
    let bytes: Vec<u8> = lumps.into_iter().flat_map(|lump| lump.bytes).collect();
    std::fs::write(&capture, bytes).expect("a file");
    let package = folder().join("../python");
    let mut python = Command::new("python3");
    python.args(["-m", "unittest", "discover", "-s"]).arg(package.join("tests"));
    python.env("PYTHONPATH", &package).env("PYTHONDONTWRITEBYTECODE", "1");
    python.env("RAI_LIBRARY", library(Kind::Shared, WHOLE).expect("the library builds"));
    python.env("RAIM_CAPTURE", capture).env("RAIM_EPOCHS", EPOCHS.to_string());
    let output = python.output().expect("python3");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    assert!(!said.contains("skipped"), "{said}");
}
