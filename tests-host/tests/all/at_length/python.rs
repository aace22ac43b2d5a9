//! The package for Python: its own tests and its notebook, with the library of this tree and the
//! recording of a simulated sky.

use std::path::{Path, PathBuf};
use std::process::Command;

use raim::replay::{self, Lump, Window};
use raim::satellites::{HEADING, Views, row};
use raim::signal::encode::{Frequency, Selection};
use raim::signal::osnma::Secret;
use raim::signal::sky::raw::Simulation;
use raim_firmware::pin::MemoryPin;
use raim_firmware::receiver::{Boot, Receiver};
use rig::capi::{Kind, WHOLE, folder, library, run};
use rig::{setup, skip};
use serde_json::Value;

use crate::pin_in_time::signed_lumps;

/// Epochs of the recording.
const EPOCHS: usize = 20;

/// Returns a Python with these modules, that of the consumers first; reports a skip if there is
/// none.
fn python_with(modules: &str) -> Option<PathBuf> {
    let has_all =
        |python: &PathBuf| run(Command::new(python).args(["-c", &format!("import {modules}")])).is_ok();
    let found = [setup::python(), "python3".into()].into_iter().find(has_all);
    if found.is_none() {
        skip::say(&format!("python3 with {modules} (cargo xtask setup --consumers)"));
    }
    found
}

/// Returns Python with the package and the recording of a simulated sky.
fn with_recording(python: &Path, out: &Path) -> Command {
    let capture = out.join("capture.rtcm3");
    let selection = Selection::new("G", Frequency::Dual).expect("a system");
    let recording = Simulation::above_xian(7200.0, EPOCHS as u32, 3).record();
    let lumps = replay::encode(&recording, &selection, &[], &Window::ALL).expect("a recording");
    let table = out.join("satellites.csv");
    std::fs::write(&table, satellites(&lumps)).expect("a file");
    let bytes: Vec<u8> = lumps.into_iter().flat_map(|lump| lump.bytes).collect();
    std::fs::write(&capture, bytes).expect("a file");
    // No release takes the key of the tests, and this library is one.
    let signed = signed_lumps(Secret::of(b"another"), 8, Some(3));
    let sky = out.join("signed.rtcm3");
    std::fs::write(&sky, signed.lumps.concat()).expect("a file");
    let mut python = Command::new(python);
    python.env("RAIM_SIGNED", sky).env("RAIM_KEY", signed.key.trim_start_matches("KEY,"));
    python.env("PYTHONPATH", package()).env("PYTHONDONTWRITEBYTECODE", "1");
    let features = format!("{WHOLE},watcher");
    python.env("RAI_LIBRARY", library(Kind::Shared, &features).expect("the library builds"));
    python.env("RAIM_SATELLITES", table);
    python.env("RAIM_CAPTURE", capture).env("RAIM_EPOCHS", EPOCHS.to_string());
    python
}

/// Returns the table of satellites that `rai replay --satellites` writes for a recording, with a
/// mask that leaves some out.
fn satellites(lumps: &[Lump]) -> String {
    let (pin, boot) = (MemoryPin::default(), Boot::on_host("test"));
    let mut receiver = Receiver::observed(pin, Views::new(true), boot).expect("a module");
    receiver.set("MASK", Some("25"), &mut Vec::new()).expect("a setting");
    let mut table = format!("{HEADING}\n");
    for lump in lumps {
        let now_ms = lump.elapsed_ms();
        receiver.gnss(&lump.bytes, now_ms, &mut Vec::new());
        for view in receiver.observer_mut().take().into_iter().filter_map(|seen| seen.view) {
            let time = view.time.expect("an epoch");
            view.satellites.iter().for_each(|account| table += &(row(account, time) + "\n"));
        }
    }
    table
}

fn package() -> PathBuf {
    folder().join("../python")
}

#[test]
fn package_for_python_passes_its_own_tests() {
    let Some(python) = python_with("numpy, pandas") else { return };
    let out = tempfile::tempdir().expect("a folder");
    let mut python = with_recording(&python, out.path());
    python.args(["-m", "unittest", "discover", "-s"]).arg(package().join("tests"));
    let output = python.output().expect("python3");
    let reported = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{reported}");
    assert!(!reported.contains("skipped"), "{reported}");
}

/// A cell that raises ends the run. The last table must have the satellites of the recording.
#[test]
fn notebook_runs_from_top_to_bottom() {
    let Some(python) = python_with("numpy, pandas, nbconvert, ipykernel") else { return };
    let out = tempfile::tempdir().expect("a folder");
    let notebook = package().join("notebooks/integrity.ipynb");
    let mut python = with_recording(&python, out.path());
    python.args(["-m", "nbconvert", "--to", "notebook", "--execute", "--output", "ran", "--output-dir"]);
    let output = python.arg(out.path()).arg(&notebook).output().expect("python3");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let ran = std::fs::read(out.path().join("ran.ipynb")).expect("the notebook that has run");
    let ran: Value = serde_json::from_slice(&ran).expect("JSON");
    let table =
        ran["cells"].as_array().and_then(|cells| cells.last()).expect("a cell")["outputs"].to_string();
    let named = (1..=32).filter(|number| table.contains(&format!("G{number:02}"))).count();
    assert!(named >= 6, "{table}");
    let committed: Value = serde_json::from_slice(&std::fs::read(notebook).expect("it")).expect("JSON");
    let has_output = |cell: &Value| cell["outputs"].as_array().is_some_and(|outputs| !outputs.is_empty());
    assert!(!committed["cells"].as_array().expect("cells").iter().any(has_output), "it is committed unrun");
}
