//! Proof by the linker that no panic is reachable, and the places that violate it.
//!
//! The image `no_panic` of `rai-firmware` contains the documented interface of `rai-core` and of the
//! firmware's library, compiled for any arguments, and a panic handler that calls an undefined
//! symbol. It is linked with the compiler, the profile and the target of the shipped image. The
//! linker only warns of undefined symbols, so that one link both decides and shows the callers:
//!
//! | undefined | meaning |
//! |---|---|
//! | nothing | no panic survived optimisation |
//! | [`SYMBOL`] | some do, and [`callers`] names them |
//! | anything else | the image is invalid |
//!
//! What [`interface`] finds documented is in that image, so that the proof stays complete as
//! functions are added. The library for C compiles the same functions behind pointers and
//! exports of its own: [`static_library`].
//!
//! The named images inline differently and have the board around the library. They must have a
//! panic handler for unforeseen cases. Its callers are found the same way, and only [`TOLERATED`]
//! may call it.

pub mod callers;
pub mod interface;
pub mod static_library;

use std::path::PathBuf;

use anyhow::{Context, ensure};

use callers::Offence;
use object::{Object as _, ObjectSymbol as _};
use static_library::StaticLibrary;

use crate::image::{self, CompiledFor, NAMED, Named};

/// Symbol that the panic handler of the image calls.
pub const SYMBOL: &str = "rai_a_panic_is_reachable_here";

/// Image of the documented interface of the two libraries.
pub const INTERFACE: &str = "no_panic";

/// Image of one function that panics, which must be found.
pub const ONE_PANIC: &str = "reachable_panic";

/// Places at which a named image may panic: RTT refuses a second initialisation, and is
/// initialised once, at start.
pub const TOLERATED: [&str; 1] = ["rai-firmware/boards/arm/src/log.rs"];

/// Proves it for the library compiled for speed and for size, for the named images, and for the
/// library for C.
///
/// # Errors
/// If a panic is reachable, with each place; or if an image does not compile.
pub fn prove() -> anyhow::Result<()> {
    prove_interface()?;
    NAMED.iter().try_for_each(prove_image)?;
    refuse(&StaticLibrary::build()?.offences(&[])?)
}

/// Proves it for the documented interface, compiled for speed and for size.
///
/// # Errors
/// As [`prove`].
pub fn prove_interface() -> anyhow::Result<()> {
    interface::write()?;
    CompiledFor::ALL.into_iter().try_for_each(|compiled_for| prove_library(INTERFACE, compiled_for))
}

/// Proves it for a named image.
///
/// # Errors
/// As [`prove`].
pub fn prove_image(named: &Named) -> anyhow::Result<()> {
    let places = callers::of_panics(&std::fs::read(named.build()?)?)?;
    let tolerated = |place: &Offence| TOLERATED.contains(&place.file.as_str());
    refuse(&places.into_iter().filter(|place| !tolerated(place)).collect::<Vec<_>>())
        .with_context(|| format!("image `{}`", named.name))
}

/// Links an image whose panic handler calls [`SYMBOL`]: [`INTERFACE`] or [`ONE_PANIC`].
///
/// # Errors
/// As [`prove`].
pub fn prove_library(image: &str, compiled_for: CompiledFor) -> anyhow::Result<()> {
    let linked = std::fs::read(link(image, compiled_for)?)?;
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

/// Links an image, even with undefined symbols.
fn link(name: &str, compiled_for: CompiledFor) -> anyhow::Result<PathBuf> {
    let mut cargo = image::cargo();
    cargo
        .args(["rustc", "--profile", compiled_for.profile(), "--target=thumbv7em-none-eabihf"])
        .args(["--package=instruments", "--bin", name, "--features", "stm32f405"])
        .args(["--quiet", "--message-format=json-render-diagnostics", "--"])
        .args(["-C", "link-arg=--warn-unresolved-symbols"])
        .env("RAI_INTERFACE", interface::FILE);
    let output = cargo.output().context("cargo cannot be run")?;
    let reported = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success(), "the image does not build:\n{reported}");
    image::executable(&String::from_utf8_lossy(&output.stdout)).context("cargo linked no image")
}

/// Returns the undefined symbols of an image.
fn undefined(image: &[u8]) -> anyhow::Result<Vec<String>> {
    let elf = object::File::parse(image)?;
    let undefined = elf.symbols().filter(|symbol| symbol.is_undefined() && symbol.name() != Ok(""));
    Ok(undefined.map(|symbol| symbol.name().unwrap_or("what has no name").to_owned()).collect())
}
