//! The library for C: its exports, and a check that no panic is reachable from them.
//!
//! A program without an operating system needs a panic handler, so the library contains one, and no
//! symbol can be left undefined as in the image of all public functions. Instead the linker
//! discards unreferenced sections:
//!
//! | link | roots | shows |
//! |---|---|---|
//! | of the whole archive | everything | the exports, and that [`HANDLER`] is present |
//! | of a program | every export | [`HANDLER`] remains only if a panic is reachable |

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, ensure};
use object::{Object, ObjectSymbol};

use super::callers::{self, Offence};
use crate::board::Machine;
use crate::capi::{library_for, run};

/// Function that ends the library's panic handler. A C program may replace it.
pub const HANDLER: &str = "rai_panic";

/// Prefix of the names of the library.
const PREFIX: &str = "rai_";

/// The library of the chip, as it ships.
pub struct StaticLibrary {
    archive: PathBuf,
    linker: PathBuf,
    exports: BTreeSet<String>,
}

impl StaticLibrary {
    /// Builds it with the compiler, the profile and the target of the shipped image.
    ///
    /// # Errors
    /// If it does not build or link, or has no handler, because then nothing would be proved.
    pub fn build() -> anyhow::Result<Self> {
        let archive = library_for(Machine::Stm32f405)?;
        let mut library = Self { archive, linker: linker()?, exports: BTreeSet::new() };
        let mut exports = symbols(&library.link(&["--whole-archive", "--no-gc-sections"])?)?;
        ensure!(exports.remove(HANDLER), "the library has no {HANDLER}, so nothing can be proved");
        library.exports = exports;
        Ok(library)
    }

    /// Returns the functions that a C program can call.
    pub fn exports(&self) -> &BTreeSet<String> {
        &self.exports
    }

    /// Returns the places from which a panic is reachable in a program that calls every export and
    /// the functions `others`.
    ///
    /// # Errors
    /// If the library does not link, or the place of a reachable panic is unknown.
    pub fn offences(&self, others: &[&str]) -> anyhow::Result<Vec<Offence>> {
        let names = self.exports.iter().map(String::as_str).chain(others.iter().copied());
        let roots: Vec<String> = names.map(|name| format!("--undefined={name}")).collect();
        let mut arguments = vec!["--gc-sections", "--emit-relocs"];
        arguments.extend(roots.iter().map(String::as_str));
        let program = self.link(&arguments)?;
        let left = symbols(&program)?;
        ensure!(left.is_superset(&self.exports), "the linker has lost an export");
        if !left.contains(HANDLER) {
            return Ok(Vec::new());
        }
        let unknown = "a panic is reachable from the library for C, and its callers do not show where";
        let places = callers::of_panics(&program).context(unknown)?;
        ensure!(!places.is_empty(), unknown);
        Ok(places)
    }

    fn link(&self, arguments: &[&str]) -> anyhow::Result<Vec<u8>> {
        // The entry point does not matter: the program is linked to standard output, and never
        // runs.
        let mut linker = Command::new(&self.linker);
        linker.args(["-flavor", "gnu", "--no-warnings", "--entry=0", "-o", "-"]).args(arguments);
        run(linker.arg(&self.archive))
    }
}

/// Returns the linker that comes with the compiler and links the images.
pub(crate) fn linker() -> anyhow::Result<PathBuf> {
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let reported = String::from_utf8(run(Command::new(rustc).args(["--print", "target-libdir"]))?)?;
    let folder = Path::new(reported.trim()).parent().context("the folder of the compiler is unknown")?;
    Ok(folder.join("bin/rust-lld"))
}

/// Returns the library's functions that a linked image contains and exports.
fn symbols(image: &[u8]) -> anyhow::Result<BTreeSet<String>> {
    let elf = object::File::parse(image)?;
    let defined = elf.symbols().filter(|symbol| symbol.is_global() && symbol.is_definition());
    let names = defined.filter_map(|symbol| symbol.name().ok().map(str::to_owned));
    Ok(names.filter(|name| name.starts_with(PREFIX)).collect())
}
