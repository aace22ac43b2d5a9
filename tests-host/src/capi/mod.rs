//! The C interface: its header, and C programs that use it.
//!
//! | step | with |
//! |---|---|
//! | header from the sources | cbindgen |
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

/// What to do where the committed header is not that of the sources.
pub const STALE_HEADER: &str = "the C interface has changed and its header has not: run `cargo xtask header`, and raise \
                                RAI_ABI_VERSION if a program compiled against the old header would misunderstand the new library";

/// Where the package of the C interface lies.
pub fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../rai-firmware/capi")
}

/// Where the committed header lies.
pub fn header_path() -> PathBuf {
    folder().join("include/rai.h")
}

/// The header as the sources say it is.
///
/// # Errors
/// Where a source cannot be read as Rust.
pub fn header() -> anyhow::Result<String> {
    let config = cbindgen::Config::from_file(folder().join("cbindgen.toml")).map_err(anyhow::Error::msg)?;
    // From the root on, since the modules are in the order of a reader there.
    let builder = cbindgen::Builder::new().with_config(config).with_src(folder().join("src/lib.rs"));
    let mut header = Vec::new();
    builder.generate().context("the sources of the C interface make no header")?.write(&mut header);
    Ok(String::from_utf8(header)?)
}

/// The boards' instruction set.
const TARGET: &str = "thumbv7em-none-eabihf";

/// What kind of library.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// What a C program is linked with.
    Static,
    /// What a program of another language loads.
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

/// Builds the library of the host, with debug assertions, and gives its path.
///
/// # Errors
/// Where it does not build; the message is cargo's.
pub fn library(kind: Kind, features: &str) -> anyhow::Result<PathBuf> {
    let (crate_type, name) = kind.words();
    let folder = root().join("target/capi");
    let mut cargo = rustc(crate_type, features, &folder);
    kept(&mut cargo, &folder, &Path::new("debug").join(name), features)
}

/// Builds the library of a board's processor, as it ships, and gives its path.
///
/// # Errors
/// As [`library`].
pub fn library_for(machine: Machine, features: &str) -> anyhow::Result<PathBuf> {
    let folder = root().join(match machine {
        Machine::Stm32f405 => "target/capi",
        Machine::Mps2An500 => "target/mps2_an500",
    });
    let mut cargo = rustc("staticlib", features, &folder);
    cargo.args(["--profile", "firmware", "--target", TARGET]);
    if machine == Machine::Mps2An500 {
        // The flags of the second board's image: one folder holds what is built with them.
        cargo.env("RUSTFLAGS", image::SECOND_BOARD_FLAGS);
    }
    kept(&mut cargo, &folder, &shipped(), features)
}

/// What a library is compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Optimised {
    /// The integrity core for speed, as in the shipped image, and the rest for size.
    Speed,
    /// All of it for size.
    Size,
}

/// What processor a library is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Processor {
    /// That of the boards, a Cortex-M4F.
    OfBoards,
    /// The smallest, without a unit for numbers with a point: Cortex-M0+.
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

/// Builds the library of a chip with only these features and gives its path.
///
/// # Errors
/// As [`library`].
pub fn library_of(features: &str, optimised: Optimised, processor: Processor) -> anyhow::Result<PathBuf> {
    let folder = root().join("target/capi");
    let features = format!("panic-handler,{features}");
    let mut cargo = rustc("staticlib", &features, &folder);
    cargo.args(["--profile", "firmware", "--target", processor.target()]);
    if optimised == Optimised::Size {
        cargo.args(["--config", "profile.firmware.package.rai-core.opt-level='s'"]);
    }
    let built = Path::new(processor.target()).join("firmware/librai.a");
    kept(&mut cargo, &folder, &built, &format!("{features}-{optimised:?}"))
}

/// Where a library of the chip lies in its folder.
fn shipped() -> PathBuf {
    Path::new(TARGET).join("firmware/librai.a")
}

/// Builds a library and puts it aside under a name of its own: another one, with other features, is built to the same place,
/// and may be at any moment, by another process too.
fn kept(cargo: &mut Command, folder: &Path, built: &Path, name: &str) -> anyhow::Result<PathBuf> {
    std::fs::create_dir_all(folder)?;
    let lock = File::create(folder.join("building"))?;
    lock.lock()?;
    run(cargo)?;
    let place = folder.join("kept").join(name).join(built);
    std::fs::create_dir_all(place.parent().context("a folder")?)?;
    // Whoever uses the one that is there goes on with it.
    let fresh = place.with_extension("fresh");
    std::fs::copy(folder.join(built), &fresh)?;
    std::fs::rename(&fresh, &place)?;
    Ok(place)
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn rustc(crate_type: &str, features: &str, target_folder: &Path) -> Command {
    let mut cargo = image::cargo();
    cargo.args(["rustc", "--quiet", "--package=rai-capi", "--lib", "--crate-type", crate_type]);
    cargo.args(["--no-default-features", "--features", features]);
    image::apart(&mut cargo, target_folder);
    cargo
}

/// Runs a command and gives what it wrote to standard output.
///
/// # Errors
/// With what it wrote to standard error, where it fails.
pub fn run(command: &mut Command) -> anyhow::Result<Vec<u8>> {
    let output =
        command.output().with_context(|| format!("{} cannot be run", command.get_program().display()))?;
    let said = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success(), "{} failed:\n{said}", command.get_program().display());
    Ok(output.stdout)
}
