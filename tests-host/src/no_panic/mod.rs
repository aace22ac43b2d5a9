//! No panic is reachable: the proof by the linker, and what stands in its way by name.
//!
//! The image `no_panic` of `rai-firmware` holds every public function of `rai-core` and of the firmware's library,
//! compiled for any arguments, and a panic handler that calls a symbol which exists nowhere. It is linked with the
//! compiler, the profile and the target of the shipped image, and the linker only warns of what it lacks, so that one link
//! both decides and shows who calls:
//!
//! | the linker lacks | means |
//! |---|---|
//! | nothing | no panic survived optimisation |
//! | [`SYMBOL`] | some do, and [`callers`] names them |
//! | anything else | this is no image |
//!
//! [`coverage`] holds the lists in that image against the sources, so that the proof stays complete as functions come.
//! The library for C compiles the same functions behind pointers and exports of its own: [`static_library`].
//!
//! The shipped image inlines differently and has the board around the library. Its panic handler must exist, for
//! the sake of what nobody foresaw; who calls it is looked up the same way, and only [`TOLERATED`] may.

pub mod callers;
pub mod coverage;
pub mod static_library;

use std::path::PathBuf;

use anyhow::{Context, ensure};

use callers::Offence;
use object::{Object as _, ObjectSymbol as _};
use static_library::StaticLibrary;

use crate::image::{self, CompiledFor};

/// What the panic handler of the image calls.
pub const SYMBOL: &str = "rai_a_panic_is_reachable_here";

/// Where the shipped image may panic: RTT refuses to be set up twice, and is set up once, at start.
pub const TOLERATED: [&str; 1] = ["rai-firmware/src/board/arm/log.rs"];

/// Holds both images to it, compiled for speed and for size, and the library for C.
///
/// # Errors
/// Names each place from which a panic is reachable; or says why an image does not even compile.
pub fn prove() -> anyhow::Result<()> {
    for compiled_for in CompiledFor::ALL {
        prove_library("probe", compiled_for)?;
        prove_image(compiled_for)?;
    }
    refuse(&StaticLibrary::build()?.offences(&[])?)
}

fn prove_image(compiled_for: CompiledFor) -> anyhow::Result<()> {
    let places = callers::of_panics(&std::fs::read(image::build_compiled_for(compiled_for)?)?)?;
    let tolerated = |place: &Offence| TOLERATED.contains(&place.file.as_str());
    refuse(&places.into_iter().filter(|place| !tolerated(place)).collect::<Vec<_>>())
}

/// Links the image of all public functions, with these features of `rai-firmware`; `reachable-panic` puts a panic
/// there that must be found.
///
/// # Errors
/// As [`prove`].
pub fn prove_library(features: &str, compiled_for: CompiledFor) -> anyhow::Result<()> {
    let linked = std::fs::read(link("no_panic", features, compiled_for)?)?;
    let lacking = undefined(&linked)?;
    if lacking.is_empty() {
        return Ok(());
    }
    ensure!(lacking == [SYMBOL], "the image lacks {}", lacking.join(", "));
    let places = callers::of_panics(&linked)?;
    ensure!(!places.is_empty(), "the linker found a panic that its callers do not show");
    refuse(&places)
}

fn refuse(places: &[Offence]) -> anyhow::Result<()> {
    let list: Vec<String> = places.iter().map(ToString::to_string).collect();
    ensure!(places.is_empty(), "a panic is reachable from\n  {}", list.join("\n  "));
    Ok(())
}

/// Links an image, whatever the linker lacks for it.
fn link(name: &str, features: &str, compiled_for: CompiledFor) -> anyhow::Result<PathBuf> {
    let mut cargo = image::cargo();
    cargo
        .args(["rustc", "--profile", compiled_for.profile(), "--target=thumbv7em-none-eabihf"])
        .args(["--package=rai-firmware", "--bin", name, "--features", features])
        .args(["--quiet", "--message-format=json-render-diagnostics", "--"])
        .args(["-C", "link-arg=--warn-unresolved-symbols"]);
    let output = cargo.output().context("cargo cannot be run")?;
    let said = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success(), "the image does not build:\n{said}");
    image::executable(&String::from_utf8_lossy(&output.stdout)).context("cargo linked no image")
}

/// What an image refers to and does not hold.
fn undefined(image: &[u8]) -> anyhow::Result<Vec<String>> {
    let elf = object::File::parse(image)?;
    let undefined = elf.symbols().filter(|symbol| symbol.is_undefined() && symbol.name() != Ok(""));
    Ok(undefined.map(|symbol| symbol.name().unwrap_or("what has no name").to_owned()).collect())
}
