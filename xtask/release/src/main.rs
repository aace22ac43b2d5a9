//! `cargo xtask release`: builds and checks every artefact of a release that this machine can
//! build, and names the others with the reason.
//!
//! | artefact | check |
//! |---|---|
//! | packages of the libraries | unpacked outside the workspace, compiled, examples run |
//! | header, and an archive for C per processor | header as the sources; every function of it in the archive |
//! | named firmware images | are within their limits and fit the chip |
//! | `rai` as a program and as a Debian package | prints its version; `dpkg-deb` and `lintian` read the package |
//! | `rai`, static | asks for no library and no loader; replays as `rai` does, here or emulated |
//! | `rai.html` | size; names no address; its policy has the hashes of its own parts |
//! | Python wheel | installed into a fresh environment, imported |
//! | bill of materials, `SHA256SUMS` | every file is listed |
//!
//! All files have the time of the sources, so that the same sources give the same bytes. A check
//! that cannot run here is counted as skipped.

mod archives;
mod binary;
mod changelog;
mod checksums;
mod deb;
mod debian;
mod elf;
mod files;
mod header;
mod manual;
mod packages;
mod page;
mod sbom;
mod statics;
mod wheel;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context as _, Result, ensure};
use clap::{Parser, Subcommand};
use rig::image::{Chip, Image, NAMED, Named};
use xtask::cargo::root;

/// Version of every artefact.
const VERSION: &str = env!("CARGO_PKG_VERSION");

#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
struct CommandLine {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Builds and checks every artefact of a release, with checksums and a bill of materials.
    Release(Arguments),
    /// Builds the library for C for every processor: Cortex-M0+, M4F, M7, M33 and RV32.
    Archives(archives::Arguments),
    /// Packs the libraries and the command as users receive them, and compiles the result.
    Packages,
    /// Generates the header of the C interface.
    Header(header::Arguments),
}

/// Arguments of the command.
#[derive(clap::Args)]
struct Arguments {
    /// Folder of the artefacts
    #[arg(long, default_value = "target/release-artefacts")]
    out: PathBuf,
    /// Build only the parts whose name contains this
    #[arg(long, value_name = "NAME")]
    only: Option<String>,
    /// Fail if a part cannot be built or checked here
    #[arg(long)]
    all: bool,
}

/// A part of the release that was not built, with its reason, or the files that were.
enum Built {
    /// Files, and the checks of them that could not run.
    Files {
        paths: Vec<PathBuf>,
        skipped: Vec<String>,
    },
    Missing(String),
}

impl Built {
    /// Returns files of which every check has run.
    fn of(paths: Vec<PathBuf>) -> Self {
        Self::Files { paths, skipped: Vec::new() }
    }

    /// Adds a file.
    fn with(mut self, path: PathBuf) -> Self {
        if let Self::Files { paths, .. } = &mut self {
            paths.push(path);
        }
        self
    }
}

/// A part of the release: its name, and its build into a folder.
type Part = (&'static str, fn(&Path) -> Result<Built>);

const PARTS: [Part; 10] = [
    ("packages", of_packages),
    ("header", header::copy),
    ("C archives", |out| archives::build(out).map(Built::of)),
    ("shared C library", archives::shared),
    ("images", images),
    ("rai and its Debian package", rai),
    ("Python wheel", wheel::build),
    ("rai, static, x86-64", |out| statics::build(&statics::X86_64, out)),
    ("rai, static, aarch64", |out| statics::build(&statics::AARCH64, out)),
    ("page for a browser", page::build),
];

fn main() -> ExitCode {
    let CommandLine { command } = raim::exit::arguments();
    raim::exit::code_of(|| match command {
        Command::Release(arguments) => release(&arguments),
        Command::Archives(arguments) => archives::run(&arguments),
        Command::Packages => packages::verify(),
        Command::Header(arguments) => header::run(&arguments),
    })
}

fn release(arguments: &Arguments) -> Result<()> {
    let out = root().join(&arguments.out);
    // One part beside those that are there, or all anew.
    if arguments.only.is_none() && out.exists() {
        fs::remove_dir_all(&out).with_context(|| out.display().to_string())?;
    }
    fs::create_dir_all(&out).with_context(|| out.display().to_string())?;
    let (mut files, mut missing, mut unchecked) = (Vec::new(), Vec::new(), 0);
    let is_chosen = |name: &str| arguments.only.as_deref().is_none_or(|part| name.contains(part));
    for (name, build) in PARTS.iter().filter(|(name, _)| is_chosen(name)) {
        match build(&out).with_context(|| format!("part `{name}`"))? {
            Built::Files { paths, skipped } => {
                println!("built      {name}: {} files", paths.len());
                for check in &skipped {
                    println!("SKIPPED    {name}: {check}");
                }
                files.extend(paths);
                unchecked += skipped.len();
            }
            Built::Missing(why) => {
                println!("NOT BUILT  {name}: {why}");
                missing.push(*name);
            }
        }
    }
    files.push(sbom::write(&out)?);
    let sums = checksums::write(&out, &files)?;
    let (count, sums) = (files.len(), files::name(&sums)?);
    println!("{count} files in {}, with {sums}", out.display());
    println!("{} parts not built, {unchecked} checks skipped", missing.len());
    let is_asked_for = arguments.all || arguments.only.is_some();
    ensure!(!is_asked_for || missing.is_empty(), "not built: {}", missing.join(", "));
    ensure!(!arguments.all || unchecked == 0, "{unchecked} checks were skipped");
    Ok(())
}

fn of_packages(out: &Path) -> Result<Built> {
    packages::verify()?;
    let copy = |name: &&str| {
        let file = format!("{name}-{VERSION}.crate");
        files::copy(&root().join("target/package").join(&file), &out.join(&file))
    };
    Ok(Built::of(packages::PACKAGES.iter().map(copy).collect::<Result<_>>()?))
}

fn rai(out: &Path) -> Result<Built> {
    let (program, archive) = binary::build(out)?;
    Ok(if cfg!(target_os = "linux") {
        debian::build(&program, out)?.with(archive)
    } else {
        Built::of(vec![archive])
    })
}

/// Builds the named images.
fn images(out: &Path) -> Result<Built> {
    let chip = Chip::named("STM32F405RGTx")?;
    let build = |named: &Named| {
        let path = named.build()?;
        let image = Image::open(&path)?;
        let findings = [named.findings(&image), image.check(&chip)].concat();
        ensure!(findings.is_empty(), "the image does not fit: {}", findings.join("; "));
        files::copy(&path, &out.join(format!("raim-firmware-{VERSION}-stm32f405-{}.elf", named.name)))
    };
    Ok(Built::of(NAMED.iter().map(build).collect::<Result<_>>()?))
}
