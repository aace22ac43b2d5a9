//! The C interface: its libraries, and C programs that use it.
//!
//! | step | with |
//! |---|---|
//! | static and shared library of the host, static library of the chip | cargo |
//! | program, for the host and for the chip | gcc, arm-none-eabi-gcc |

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, ensure};

use crate::board::Machine;
use crate::image;

pub mod calls;
pub mod program;

/// Returns the folder of the C interface's package.
pub fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../rai-firmware/capi")
}

/// Returns the path of the committed header.
pub fn header_path() -> PathBuf {
    folder().join("include/rai.h")
}

/// Target of the boards.
const TARGET: &str = "thumbv7em-none-eabihf";

/// Kind of library.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Static library, linked into a C program.
    Static,
    /// Shared library, loaded by a program of another language.
    Shared,
}

impl Kind {
    const fn words(self) -> (&'static str, &'static str) {
        match self {
            Self::Static => ("staticlib", "librai.a"),
            Self::Shared => ("cdylib", "librai.so"),
        }
    }
}

/// Builds the library of the host, with debug assertions, and returns its path.
///
/// # Errors
/// If it does not build; the message is cargo's.
pub fn library(kind: Kind, features: &str) -> anyhow::Result<PathBuf> {
    let (crate_type, name) = kind.words();
    let folder = root().join("target/capi");
    let mut cargo = rustc(crate_type, features, &folder);
    kept(&mut cargo, &folder, &Path::new("debug").join(name), features)
}

/// Features of the library of a host: all that the module can do.
pub const WHOLE: &str = "whole,cnav,osnma,satellites-48";

/// Builds the library of a board's processor, as it ships, and returns its path.
///
/// # Errors
/// As [`library`].
pub fn library_for(machine: Machine) -> anyhow::Result<PathBuf> {
    let features = &format!("{WHOLE},panic-handler");
    let folder = root().join(match machine {
        Machine::Stm32f405 => "target/capi",
        Machine::Mps2An500 => "target/mps2_an500",
    });
    let mut cargo = rustc("staticlib", features, &folder);
    cargo.args(["--profile", "firmware", "--target", TARGET]);
    if machine == Machine::Mps2An500 {
        // These are the flags of the second board's image, because one folder holds everything
        // built with them.
        cargo.env("RUSTFLAGS", image::SECOND_BOARD_FLAGS);
    }
    kept(&mut cargo, &folder, &shipped(), features)
}

/// Goal of the optimisation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Optimised {
    /// The integrity core for speed, as in the shipped image, and the rest for size.
    Speed,
    /// Everything for size.
    Size,
}

/// Processor of a library.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Processor {
    /// The boards' processor, a Cortex-M4F.
    OfBoards,
    /// The smallest, without a floating-point unit: Cortex-M0+.
    Smallest,
}

impl Processor {
    const fn target(self) -> &'static str {
        match self {
            Self::OfBoards => TARGET,
            Self::Smallest => "thumbv6m-none-eabi",
        }
    }
}

/// Builds the library of a chip with only these features and returns its path.
///
/// # Errors
/// As [`library`].
pub fn library_of(features: &str, optimised: Optimised, processor: Processor) -> anyhow::Result<PathBuf> {
    let folder = root().join("target/capi");
    let features = format!("panic-handler,{features}");
    let mut cargo = rustc("staticlib", &features, &folder);
    cargo.args(["--profile", "firmware", "--target", processor.target()]);
    if optimised == Optimised::Size {
        for package in ["raim-core", "raim-single"] {
            cargo.args(["--config", &format!("profile.firmware.package.{package}.opt-level='s'")]);
        }
    }
    let built = Path::new(processor.target()).join("firmware/librai.a");
    kept(&mut cargo, &folder, &built, &format!("{features}-{optimised:?}"))
}

/// Returns the path of a library of the chip in its folder.
fn shipped() -> PathBuf {
    Path::new(TARGET).join("firmware/librai.a")
}

/// Builds a library and copies it to a name of its own, because another one with other features is
/// built to the same place, at any moment, possibly by another process.
fn kept(cargo: &mut Command, folder: &Path, built: &Path, name: &str) -> anyhow::Result<PathBuf> {
    std::fs::create_dir_all(folder)?;
    let lock = File::create(folder.join("building"))?;
    lock.lock()?;
    run(cargo)?;
    let place = folder.join("kept").join(name).join(built);
    std::fs::create_dir_all(place.parent().context("a folder")?)?;
    // A user of the existing copy keeps it.
    let fresh = place.with_extension("fresh");
    std::fs::copy(folder.join(built), &fresh)?;
    std::fs::rename(&fresh, &place)?;
    Ok(place)
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn rustc(crate_type: &str, features: &str, target_folder: &Path) -> Command {
    let mut cargo = image::cargo();
    cargo.args(["rustc", "--quiet", "--package=rai-capi", "--lib", "--crate-type", crate_type]);
    cargo.args(["--no-default-features", "--features", features]);
    image::apart(&mut cargo, target_folder);
    cargo
}

/// Runs a command and returns its standard output.
///
/// # Errors
/// If it fails, with its standard error.
pub fn run(command: &mut Command) -> anyhow::Result<Vec<u8>> {
    let output =
        command.output().with_context(|| format!("{} cannot be run", command.get_program().display()))?;
    let reported = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success(), "{} failed:\n{reported}", command.get_program().display());
    Ok(output.stdout)
}
