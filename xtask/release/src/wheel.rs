//! The wheel of the Python package, installed and imported once.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, Result, ensure};

use super::files::time_s;
use super::{Built, VERSION};
use xtask::cargo::root;

/// Builds the wheel with a Python environment of its own.
///
/// # Errors
/// If it does not build, or the installed package has another version.
pub(super) fn build(out: &Path) -> Result<Built> {
    let environment = root().join("target/python/environment");
    if run(Command::new("python3").args(["-m", "venv", "--clear"]).arg(&environment)).is_err() {
        return Ok(Built::Missing("needs python3 with venv".into()));
    }
    let python = environment.join("bin/python");
    let mut pip = Command::new(&python);
    pip.args(["-m", "pip", "--quiet", "install", "setuptools>=70", "wheel", "numpy"]);
    if run(&mut pip).is_err() {
        return Ok(Built::Missing("needs setuptools and numpy from a package index".into()));
    }
    let mut pip = Command::new(&python);
    pip.args(["-m", "pip", "--quiet", "wheel", "--no-deps", "--no-build-isolation", "--wheel-dir"]);
    pip.env("SOURCE_DATE_EPOCH", time_s()?.to_string());
    run(pip.arg(out).arg(root().join("rai-firmware/python")))?;
    let wheel = wheel_in(out)?;
    run(Command::new(&python).args(["-m", "pip", "--quiet", "install", "--no-deps"]).arg(&wheel))?;
    let reported =
        run(Command::new(&python).args(["-c", "import raim; print(raim.version())"]).current_dir(out))?;
    ensure!(reported.trim() == VERSION, "the wheel has the version {reported:?}");
    Ok(Built::of(vec![wheel]))
}

fn wheel_in(out: &Path) -> Result<PathBuf> {
    let mut files = fs::read_dir(out)?.filter_map(|entry| Some(entry.ok()?.path()));
    files.find(|path| path.extension().is_some_and(|ending| ending == "whl")).context("pip built no wheel")
}

/// Runs a command and returns its output.
fn run(command: &mut Command) -> Result<String> {
    let output = command.output()?;
    let program = command.get_program().display();
    ensure!(output.status.success(), "{program} fails:\n{}", String::from_utf8_lossy(&output.stderr));
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}
