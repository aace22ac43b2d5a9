//! The library for C, for each processor: an archive with header, library and licences.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, Result, ensure};

use super::files::{Entry, copy, tar_gz, time_s};
use super::{Built, VERSION};
use xtask::cargo::{command, root, spawn};

/// A processor: name of the archive, target of Rust, its own flags, and the flags of a C compiler.
struct Processor {
    name: &'static str,
    target: &'static str,
    flags: &'static str,
    c_flags: &'static str,
}

const PROCESSORS: [Processor; 5] = [
    Processor {
        name: "cortex-m0plus",
        target: "thumbv6m-none-eabi",
        flags: "",
        c_flags: "-mcpu=cortex-m0plus -mthumb",
    },
    Processor {
        name: "cortex-m4f",
        target: "thumbv7em-none-eabihf",
        flags: "",
        c_flags: "-mcpu=cortex-m4 -mthumb -mfloat-abi=hard -mfpu=fpv4-sp-d16",
    },
    Processor {
        name: "cortex-m7",
        target: "thumbv7em-none-eabihf",
        flags: "-C target-cpu=cortex-m7",
        c_flags: "-mcpu=cortex-m7 -mthumb -mfloat-abi=hard -mfpu=fpv5-d16",
    },
    Processor {
        name: "cortex-m33",
        target: "thumbv8m.main-none-eabihf",
        flags: "",
        c_flags: "-mcpu=cortex-m33 -mthumb -mfloat-abi=hard -mfpu=fpv5-sp-d16",
    },
    Processor {
        name: "rv32imac",
        target: "riscv32imac-unknown-none-elf",
        flags: "",
        c_flags: "-march=rv32imac -mabi=ilp32",
    },
];

/// Arguments of `cargo xtask archives`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Folder of the archives
    #[arg(long, default_value = "target/archives")]
    out: PathBuf,
    /// Build only this processor: cortex-m0plus, cortex-m4f, cortex-m7, cortex-m33 or rv32imac
    #[arg(long)]
    processor: Option<String>,
}

/// Runs `cargo xtask archives`.
pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let out = root().join(&arguments.out);
    fs::create_dir_all(&out).with_context(|| out.display().to_string())?;
    let is_chosen =
        |processor: &&Processor| arguments.processor.as_deref().is_none_or(|name| name == processor.name);
    let chosen: Vec<_> = PROCESSORS.iter().filter(is_chosen).collect();
    let names = PROCESSORS.map(|processor| processor.name).join(", ");
    ensure!(!chosen.is_empty(), "--processor must be one of {names}");
    for processor in chosen {
        println!("{:<14} {}", processor.name, archive(processor, &out)?.display());
    }
    Ok(())
}

/// Builds every archive and returns the paths.
///
/// # Errors
/// If a library does not build, or lacks a function of the header.
pub(super) fn build(out: &Path) -> Result<Vec<PathBuf>> {
    PROCESSORS.iter().map(|processor| archive(processor, out)).collect()
}

fn archive(processor: &Processor, out: &Path) -> Result<PathBuf> {
    let library = library(processor)?;
    let bytes = fs::read(&library).with_context(|| library.display().to_string())?;
    let missing = missing(&bytes)?;
    ensure!(missing.is_empty(), "the library of {} lacks {}", processor.name, missing.join(", "));
    let folder = format!("rai-{VERSION}-{}/", processor.name);
    let about = format!(
        "RAI {VERSION}, the library for C, for {}.\n\nCompile with {}, -Iinclude, and link lib/librai.a with \
         -Wl,--gc-sections. include/rai.h documents every call.\n",
        processor.name, processor.c_flags
    );
    let mut entries = vec![
        Entry::of(format!("{folder}include/rai.h"), &rig::capi::header_path())?,
        Entry { path: format!("{folder}lib/librai.a"), bytes, is_program: false },
        Entry::text(format!("{folder}README"), about),
    ];
    for licence in ["LICENSE-APACHE", "LICENSE-MIT"] {
        entries.push(Entry::of(format!("{folder}{licence}"), &root().join(licence))?);
    }
    let path = out.join(format!("rai-{VERSION}-{}.tar.gz", processor.name));
    fs::write(&path, tar_gz(&entries, time_s()?)?)?;
    Ok(path)
}

/// Builds the library of a processor, as the image is compiled, and returns its path.
fn library(processor: &Processor) -> Result<PathBuf> {
    let folder = root().join("target/archives/build").join(processor.name);
    let mut cargo = command(&["rustc", "--quiet", "--package=rai-capi", "--lib", "--crate-type=staticlib"]);
    cargo.args(["--profile=firmware", "--target", processor.target, "--target-dir"]).arg(&folder);
    // Libraries of other crates with the same flags are compiled once.
    cargo.env("CARGO_BUILD_BUILD_DIR", root().join("target"));
    if !processor.flags.is_empty() {
        cargo.env("RUSTFLAGS", processor.flags);
    }
    spawn(&mut cargo)?;
    Ok(folder.join(processor.target).join("firmware/librai.a"))
}

/// Returns the functions of the header that a library does not contain by name.
fn missing(library: &[u8]) -> Result<Vec<String>> {
    let header = fs::read_to_string(rig::capi::header_path())?;
    let functions = header.lines().filter_map(|line| {
        let (declared, _) = line.split_once('(')?;
        let is_code =
            line.starts_with(|first: char| first.is_ascii_lowercase()) && !line.starts_with("typedef");
        let name = declared.rsplit([' ', '*']).next().filter(|_| is_code)?;
        Some(name.to_owned())
    });
    let contains = |name: &str| {
        let text = [b"\0", name.as_bytes(), b"\0"].concat();
        library.windows(text.len()).any(|window| window == text)
    };
    Ok(functions.filter(|name| !contains(name)).collect())
}

/// Builds the shared library of this system, with everything that `CMake` installs beside it.
///
/// # Errors
/// If it does not build or install.
pub(super) fn shared(out: &Path) -> Result<Built> {
    if Command::new("cmake").arg("--version").output().is_err() {
        return Ok(Built::Missing("needs the program cmake".into()));
    }
    let (build, prefix) = (root().join("target/archives/host"), root().join("target/archives/prefix"));
    let cmake = |arguments: &[&std::ffi::OsStr]| {
        let status = Command::new("cmake").args(arguments).env_remove("CARGO").status()?;
        ensure!(status.success(), "cmake fails");
        Ok(())
    };
    let source = rig::capi::folder();
    cmake(&[
        "-S".as_ref(),
        source.as_os_str(),
        "-B".as_ref(),
        build.as_os_str(),
        "-DCMAKE_INSTALL_LIBDIR=lib".as_ref(),
    ])?;
    cmake(&["--build".as_ref(), build.as_os_str()])?;
    cmake(&["--install".as_ref(), build.as_os_str(), "--prefix".as_ref(), prefix.as_os_str()])?;
    let name = fs::read_dir(prefix.join("lib"))?.filter_map(Result::ok).map(|entry| entry.file_name());
    let name =
        name.map(|name| name.to_string_lossy().into_owned()).find(|name| name.starts_with("librai.so."));
    let Some(name) = name else {
        return Ok(Built::Missing("a shared library is built on Linux alone".into()));
    };
    let to = out.join(format!("{name}-{VERSION}-{}-linux", std::env::consts::ARCH));
    Ok(Built::of(vec![copy(&prefix.join("lib").join(&name), &to)?]))
}
