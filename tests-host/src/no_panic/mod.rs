//! No panic is reachable: the proof by the linker, and what stands in its way by name.
//!
//! The image `no_panic` of `rai-firmware` holds every public function of `rai-core` and of the firmware's library,
//! compiled for any arguments, and a panic handler that calls a symbol which exists nowhere. It is linked with the
//! compiler, the profile and the target of the shipped image:
//!
//! | link | means |
//! |---|---|
//! | succeeds | no panic survived optimisation |
//! | fails for the lack of [`SYMBOL`] | some do: the image is linked once more with the symbol given, and [`callers`] names them |
//!
//! [`coverage`] holds the lists in that image against the sources, so that the proof stays complete as functions come.
//! The library for C compiles the same functions behind pointers and exports of its own: [`static_library`].
//!
//! The shipped image inlines differently and has the board around the library. Its panic handler must exist, for
//! the sake of what nobody foresaw; who calls it is looked up the same way, and only [`TOLERATED`] may.

pub mod callers;
pub mod coverage;
pub mod static_library;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use anyhow::{Context, ensure};

use callers::Offence;
use static_library::StaticLibrary;

/// What the panic handler of the image calls.
pub const SYMBOL: &str = "rai_a_panic_is_reachable_here";

/// Where the shipped image may panic: RTT refuses to be set up twice, and is set up once, at start.
pub const TOLERATED: [&str; 1] = ["rai-firmware/src/board/arm/log.rs"];

/// Holds both images to it, and the library for C.
///
/// # Errors
/// Names each place from which a panic is reachable; or says why an image does not even compile.
pub fn prove() -> anyhow::Result<()> {
    prove_library("probe")?;
    refuse(&StaticLibrary::build()?.offences(&[])?)?;
    let places = offences("rai-firmware", "stm32f405", &[])?;
    let tolerated = |place: &Offence| TOLERATED.contains(&place.file.as_str());
    refuse(&places.into_iter().filter(|place| !tolerated(place)).collect::<Vec<_>>())
}

/// Links the image of all public functions, with these features of `rai-firmware`; `reachable-panic` puts a panic
/// there that must be found.
///
/// # Errors
/// As [`prove`].
pub fn prove_library(features: &str) -> anyhow::Result<()> {
    let output = link("no_panic", features, &[])?;
    if output.status.success() {
        return Ok(());
    }
    let said = String::from_utf8_lossy(&output.stderr);
    ensure!(said.contains(&format!("undefined symbol: {SYMBOL}")), "the image does not build:\n{said}");
    let places = offences("no_panic", features, &[&format!("link-arg=--defsym={SYMBOL}=0")])?;
    ensure!(!places.is_empty(), "the linker found a panic that its callers do not show:\n{said}");
    refuse(&places)
}

fn refuse(places: &[Offence]) -> anyhow::Result<()> {
    let list: Vec<String> = places.iter().map(ToString::to_string).collect();
    ensure!(places.is_empty(), "a panic is reachable from\n  {}", list.join("\n  "));
    Ok(())
}

/// The places in an image from which a panic is reachable.
fn offences(image: &str, features: &str, codegen: &[&str]) -> anyhow::Result<Vec<Offence>> {
    let output = link(image, features, &[codegen, &["link-arg=--emit-relocs"]].concat())?;
    let said = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success(), "the image does not link:\n{said}");
    let path: Option<PathBuf> = crate::image::executable(&String::from_utf8_lossy(&output.stdout));
    callers::of_panics(&std::fs::read(path.context("cargo linked no image")?)?)
}

fn link(image: &str, features: &str, codegen: &[&str]) -> anyhow::Result<Output> {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(".."))
        .args(["rustc", "--profile=firmware", "--target=thumbv7em-none-eabihf"])
        .args(["--package=rai-firmware", "--bin", image, "--features", features])
        .args(["--quiet", "--message-format=json-render-diagnostics", "--"])
        .args(codegen.iter().flat_map(|option| ["-C", option]));
    cargo.output().context("cargo cannot be run")
}
