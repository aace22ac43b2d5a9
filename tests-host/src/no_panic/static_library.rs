//! The library for C: what its exports reach, and whether a panic is in it.
//!
//! A program without an operating system needs a panic handler, so the library brings one, and no symbol can be left
//! undefined as in the image of all public functions. The linker is asked another way, with sections that nobody refers
//! to thrown out:
//!
//! | link | roots | tells |
//! |---|---|---|
//! | of the whole archive | everything | what is exported, and that [`HANDLER`] is there to be found |
//! | of a program | every export | [`HANDLER`] is left only where a panic is reachable |

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, ensure};
use object::{Object, ObjectSymbol};

use super::callers::{self, Offence};
use crate::board::Machine;
use crate::capi::{library_for, run};

/// Where the library's panic handler ends: the function that a C program may replace.
pub const HANDLER: &str = "rai_panic";

/// What the names of the library begin with.
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
    /// Where it does not build or link, or holds no handler: nothing would be proved of it then.
    pub fn build() -> anyhow::Result<Self> {
        let archive = library_for(Machine::Stm32f405, "whole,panic-handler")?;
        let mut library = Self { archive, linker: linker()?, exports: BTreeSet::new() };
        let mut exports = symbols(&library.link(&["--whole-archive", "--no-gc-sections"])?)?;
        ensure!(exports.remove(HANDLER), "the library holds no {HANDLER}: nothing could be found in it");
        library.exports = exports;
        Ok(library)
    }

    /// The functions that a C program can call.
    pub fn exports(&self) -> &BTreeSet<String> {
        &self.exports
    }

    /// The places from which a panic is reachable in a program that calls every export, and these functions.
    ///
    /// # Errors
    /// Where the library does not link, or a panic is reachable from nobody knows where.
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
        // Where a program begins is no matter: it is linked to standard output, and never run.
        let mut linker = Command::new(&self.linker);
        linker.args(["-flavor", "gnu", "--no-warnings", "--entry=0", "-o", "-"]).args(arguments);
        run(linker.arg(&self.archive))
    }
}

/// The linker that comes with the compiler, which is what links the images.
pub(crate) fn linker() -> anyhow::Result<PathBuf> {
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let said = String::from_utf8(run(Command::new(rustc).args(["--print", "target-libdir"]))?)?;
    let folder = Path::new(said.trim()).parent().context("the compiler lies nowhere")?;
    Ok(folder.join("bin/rust-lld"))
}

/// The library's functions that a linked image holds and shows.
fn symbols(image: &[u8]) -> anyhow::Result<BTreeSet<String>> {
    let elf = object::File::parse(image)?;
    let defined = elf.symbols().filter(|symbol| symbol.is_global() && symbol.is_definition());
    let names = defined.filter_map(|symbol| symbol.name().ok().map(str::to_owned));
    Ok(names.filter(|name| name.starts_with(PREFIX)).collect())
}
