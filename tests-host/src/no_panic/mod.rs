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

pub mod callers;
pub mod coverage;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use anyhow::{Context, bail, ensure};

use callers::Offence;

/// What the panic handler of the image calls.
pub const SYMBOL: &str = "rai_a_panic_is_reachable_here";

/// Links the image; succeeds if nothing panics.
///
/// # Errors
/// Names each place from which a panic is reachable; or says why the image does not even compile.
pub fn prove() -> anyhow::Result<()> {
    prove_with("probe")
}

/// As [`prove`], with other features of `rai-firmware`; `reachable-panic` puts a panic there that must be found.
///
/// # Errors
/// As [`prove`].
pub fn prove_with(features: &str) -> anyhow::Result<()> {
    let output = link(features, &[])?;
    if output.status.success() {
        return Ok(());
    }
    let said = String::from_utf8_lossy(&output.stderr);
    ensure!(said.contains(&format!("undefined symbol: {SYMBOL}")), "the image does not build:\n{said}");
    let offences = offences(features)?;
    ensure!(!offences.is_empty(), "the linker found a panic that its callers do not show:\n{said}");
    let list = offences.iter().fold(String::new(), |mut list, offence| {
        let _ = write!(list, "\n  {offence}");
        list
    });
    bail!("a panic is reachable from{list}")
}

/// The places from which a panic is reachable.
fn offences(features: &str) -> anyhow::Result<Vec<Offence>> {
    let output = link(features, &[&format!("link-arg=--defsym={SYMBOL}=0"), "link-arg=--emit-relocs"])?;
    let said = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success(), "the image does not link even with the symbol given:\n{said}");
    let image = crate::image::executable(&String::from_utf8_lossy(&output.stdout));
    let image: PathBuf = image.context("cargo linked no image")?;
    callers::of_panics(&std::fs::read(&image)?)
}

fn link(features: &str, codegen: &[&str]) -> anyhow::Result<Output> {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(".."))
        .args(["rustc", "--profile=firmware", "--target=thumbv7em-none-eabihf"])
        .args(["--package=rai-firmware", "--bin=no_panic", "--features", features])
        .args(["--quiet", "--message-format=json-render-diagnostics", "--"])
        .args(codegen.iter().flat_map(|option| ["-C", option]));
    cargo.output().context("cargo cannot be run")
}
