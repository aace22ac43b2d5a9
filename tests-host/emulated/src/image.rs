//! The image of the firmware, built by cargo.

use std::fmt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context as _, ensure};

use crate::board::Machine;

/// Goal of an image's optimisation. Its results are the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CompiledFor {
    /// Few instructions in the core, as in the shipped image.
    Speed,
    /// Few bytes of flash.
    Size,
}

impl CompiledFor {
    /// Both goals.
    pub const ALL: [Self; 2] = [Self::Speed, Self::Size];

    /// Returns cargo's profile.
    pub fn profile(self) -> &'static str {
        match self {
            Self::Speed => "firmware",
            Self::Size => "firmware-for-size",
        }
    }

    /// Returns the alias of cargo that builds such an image.
    pub fn command(self) -> &'static str {
        match self {
            Self::Speed => "image",
            Self::Size => "image-for-size",
        }
    }
}

impl fmt::Display for CompiledFor {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Speed => "compiled for speed",
            Self::Size => "compiled for size",
        })
    }
}

/// Builds the shipped image and returns its path.
///
/// # Errors
/// If cargo cannot be run or the build fails; cargo has then printed the reason.
pub fn build() -> anyhow::Result<PathBuf> {
    built(cargo().arg("image"))
}

/// Makes cargo write its results to a folder without files of the same names. Intermediate files
/// are shared with other builds: a library with the same features and flags is compiled once.
pub fn apart<'c>(cargo: &'c mut Command, folder: &Path) -> &'c mut Command {
    cargo.arg("--target-dir").arg(folder).env("CARGO_BUILD_BUILD_DIR", "target")
}

/// Returns cargo's command at the project's root.
pub fn cargo() -> Command {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("../.."));
    cargo
}

/// Runs a build and returns the path of its program.
///
/// # Errors
/// As [`build`].
pub fn built(cargo: &mut Command) -> anyhow::Result<PathBuf> {
    let output = cargo
        .args(["--quiet", "--message-format=json-render-diagnostics"])
        .stderr(Stdio::inherit())
        .output()
        .context("cargo cannot be run")?;
    ensure!(output.status.success(), "the image does not build (`cargo image` prints the reason)");
    executable(&String::from_utf8_lossy(&output.stdout)).context("cargo built no image")
}

/// Builds the program of the module with the parts of the image `small`, for this system, and
/// returns its path. It is built by itself, because a build of several packages joins their
/// features.
///
/// # Errors
/// As [`build`].
pub fn build_small_module() -> anyhow::Result<PathBuf> {
    let mut cargo = cargo();
    cargo.args(["build", "--package", "small-module", "--bin", "small-module"]);
    built(apart(&mut cargo, Path::new("target/small-module")))
}

/// Builds the program `rai` as it is installed, and returns its path.
///
/// # Errors
/// As [`build`].
pub fn build_rai() -> anyhow::Result<PathBuf> {
    built(cargo().args(["build", "--release", "--locked", "--package", "raim", "--bin", "rai"]))
}

/// Compiler flags for the second board's processor.
pub const SECOND_BOARD_FLAGS: &str =
    "-C target-cpu=cortex-m7 -C link-arg=-Tlink.x -C link-arg=-Tdefmt.x -C link-arg=--nmagic";

/// Builds the shipped image for a board, and returns its path. Each board has its own folder.
///
/// # Errors
/// As [`build`].
pub fn build_for(machine: Machine) -> anyhow::Result<PathBuf> {
    match machine {
        Machine::Stm32f405 => build(),
        Machine::Mps2An500 => built(for_board(machine).args(["--package", "raim-mps2-an500"])),
    }
}

/// Builds the measuring image for a board, compiled like the shipped one, and returns its path.
///
/// # Errors
/// As [`build`].
pub fn build_laboratory(machine: Machine) -> anyhow::Result<PathBuf> {
    let mut cargo = for_board(machine);
    cargo.args(["--package", "instruments", "--bin", "laboratory"]);
    if machine == Machine::Stm32f405 {
        cargo.args(["--features", "stm32f405"]);
    }
    built(&mut cargo)
}

/// Returns cargo's command that builds for a board as its image ships.
fn for_board(machine: Machine) -> Command {
    let mut cargo = cargo();
    cargo.args(["build", "--profile", "firmware", "--target", "thumbv7em-none-eabihf"]);
    if machine == Machine::Mps2An500 {
        // These flags replace those of the project's own configuration, so they repeat all of them.
        cargo.env("RUSTFLAGS", SECOND_BOARD_FLAGS);
        apart(&mut cargo, Path::new("target/mps2_an500"));
    }
    cargo
}

/// Returns the program that cargo's messages name.
pub fn executable(messages: &str) -> Option<PathBuf> {
    messages
        .lines()
        .filter_map(|line| serde_json::from_str::<serde_json::Value>(line).ok())
        .filter_map(|message| message.get("executable")?.as_str().map(PathBuf::from))
        .next_back()
}
