//! Memory of the C library, by the features built into it.
//!
//! A program that calls one level of the interface is linked without everything else. The flash of
//! the library is that of this program. The library states the memory of an object itself, as a
//! symbol for linker scripts.
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | code and constants | `flash` | bytes |
//! | `rai_monitor_size()`, `rai_receiver_size()` | `object` | bytes |

use std::path::Path;
use std::process::Command;

use anyhow::{Context as _, Result};
use object::{Object as _, ObjectSection as _, ObjectSymbol as _, SectionFlags, SectionKind};

use super::Scope;
use super::figure::Figure;
use crate::capi::{Optimised, Processor, library_of, run};
use crate::no_panic::static_library::linker;

/// Largest flash of a program with classic RAIM, bytes.
const CLASSIC_BYTES: u64 = 64 * 1024;

/// Level of the interface that a program calls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Level {
    Monitor,
    Receiver,
}

impl Level {
    const fn name(self) -> &'static str {
        match self {
            Self::Monitor => "monitor",
            Self::Receiver => "receiver",
        }
    }

    const fn calls(self) -> &'static [&'static str] {
        match self {
            Self::Monitor => &["rai_settings_preset", "rai_monitor_init", "rai_monitor_judge"],
            Self::Receiver => &[
                "rai_receiver_init",
                "rai_receiver_gnss",
                "rai_receiver_tick",
                "rai_receiver_command",
                "rai_receiver_pin",
                "rai_receiver_report",
            ],
        }
    }
}

/// Build: description, level, features, optimisation and processor, and largest flash, bytes.
type Build = (&'static str, Level, &'static str, (Optimised, Processor), Option<u64>);

/// Most builds are compiled for size on the boards' processor.
const SMALL: (Optimised, Processor) = (Optimised::Size, Processor::OfBoards);

/// All builds; the first [`TESTED`] are those of [`crate::capi::program::classic_on_board`].
const BUILDS: [Build; 12] = [
    ("classic, 16 satellites", Level::Monitor, "", SMALL, Some(CLASSIC_BYTES)),
    ("classic, 32 satellites", Level::Monitor, "satellites-32", SMALL, Some(CLASSIC_BYTES)),
    ("classic, 48 satellites", Level::Monitor, "satellites-48", SMALL, Some(CLASSIC_BYTES)),
    (
        "classic, 48 satellites, for speed",
        Level::Monitor,
        "satellites-48",
        (Optimised::Speed, Processor::OfBoards),
        None,
    ),
    (
        "classic, 48 satellites, Cortex-M0+",
        Level::Monitor,
        "satellites-48",
        (Optimised::Size, Processor::Smallest),
        None,
    ),
    ("all tables and searches, 48 satellites", Level::Monitor, "satellites-48,searches", SMALL, None),
    ("all and ARAIM, 48 satellites", Level::Monitor, "satellites-48,searches,araim", SMALL, None),
    ("RTCM and classic, 16 satellites", Level::Receiver, "receiver", SMALL, None),
    ("RTCM and classic, 48 satellites", Level::Receiver, "receiver,satellites-48", SMALL, None),
    ("16 satellites", Level::Receiver, "whole", SMALL, None),
    ("32 satellites", Level::Receiver, "whole,satellites-32", SMALL, None),
    ("48 satellites", Level::Receiver, "whole,satellites-48", SMALL, None),
];

/// Number of builds, from the first, that the tests of the C interface link anyway.
const TESTED: usize = 3;

/// Returns the builds that a measurement includes.
fn builds(scope: Scope) -> &'static [Build] {
    match scope {
        Scope::All => &BUILDS,
        Scope::Tested => &BUILDS[..TESTED],
        Scope::Stages => &[],
    }
}

/// Returns true if a measurement includes the figure of that name, which need not be of a library.
pub fn is_measured(name: &str, scope: Scope) -> bool {
    let is_of = |(words, level, ..): &Build| {
        ["flash", "object"].iter().any(|quantity| figure_name(*level, words, quantity) == name)
    };
    builds(scope).iter().any(is_of) || !BUILDS.iter().any(is_of)
}

fn figure_name(level: Level, words: &str, quantity: &str) -> String {
    format!("C library, {}, {words}: {quantity}, bytes", level.name())
}

/// Measures flash and object of the builds.
///
/// # Errors
/// If one does not build or link.
pub fn measure(scope: Scope) -> Result<Vec<Figure>> {
    let linker = linker()?;
    let mut figures = Vec::new();
    for &(words, level, features, (optimised, processor), most) in builds(scope) {
        let archive = library_of(features, optimised, processor)?;
        let (flash, object) =
            sizes(&linker, &archive, level).with_context(|| format!("{}, {words}", level.name()))?;
        let figure =
            |quantity, value, target| Figure { name: figure_name(level, words, quantity), value, target };
        figures.extend([figure("flash", flash, most), figure("object", object, None)]);
    }
    Ok(figures)
}

/// Returns the flash of a program that calls a level, and the memory of its object, bytes.
fn sizes(linker: &Path, archive: &Path, level: Level) -> Result<(u64, u64)> {
    let size = format!("__rai_{}_bytes", level.name());
    let mut command = Command::new(linker);
    command.args(["-flavor", "gnu", "--gc-sections", "--no-warnings", "--entry=0", "-o", "-"]);
    command.args(level.calls().iter().chain([&size.as_str()]).map(|name| format!("--undefined={name}")));
    let program = run(command.arg(archive))?;
    let elf = object::File::parse(&*program)?;
    let object = elf
        .symbols()
        .find(|symbol| symbol.name() == Ok(&size))
        .context("the library does not state its size")?;
    let loaded = elf.sections().filter(is_loaded);
    Ok((loaded.map(|section| section.size()).sum(), object.address()))
}

/// Returns true if a section is part of flash.
fn is_loaded<'a>(section: &impl object::ObjectSection<'a>) -> bool {
    let allocated = u64::from(object::elf::SHF_ALLOC);
    matches!(section.flags(), SectionFlags::Elf { sh_flags } if sh_flags & allocated != 0)
        && section.kind() != SectionKind::UninitializedData
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::budget;

    #[test]
    fn tested_scope_leaves_out_the_other_libraries_and_nothing_else() {
        let committed = budget::committed().expect("the committed figures");
        let of = |scope| committed.keys().filter(move |name| is_measured(name, scope));
        assert_eq!(of(Scope::All).count(), committed.len());
        let left_out: Vec<_> = committed.keys().filter(|name| !is_measured(name, Scope::Tested)).collect();
        assert_eq!(left_out.len(), 2 * (BUILDS.len() - TESTED), "{left_out:?}");
        assert!(left_out.iter().all(|name| name.starts_with("C library, ")), "{left_out:?}");
    }
}
