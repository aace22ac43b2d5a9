//! `cargo xtask release`: builds and checks every artefact of a release that this machine can
//! build, and names the others with the reason.
//!
//! | artefact | check |
//! |---|---|
//! | packages of the libraries | unpacked outside the workspace, compiled, examples run |
//! | header, and an archive for C per processor | header as the sources; every function of it in the archive |
//! | named firmware images | are within their limits and fit the chip |
//! | `rai` as a program and as a Debian package | prints its version; `dpkg-deb` reads the package |
//! | `rai`, static | asks for no library and no loader; prints its version if this processor runs it |
//! | Python wheel | installed into a fresh environment, imported |
//! | bill of materials, `SHA256SUMS` | every file is listed |
//!
//! Files of a build have no time of their own, so that the same sources give the same bytes.

mod archives;
mod binary;
mod checksums;
mod deb;
mod elf;
mod files;
mod sbom;
mod wheel;

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, ensure};
use rig::image::{Chip, NAMED, Named};

use crate::cargo::root;
pub(crate) use archives::{Arguments as ArchiveArguments, run as build_archives};
pub(crate) use binary::program;

/// Version of every artefact.
const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Arguments of the command.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Folder of the artefacts
    #[arg(long, default_value = "target/release-artefacts")]
    out: PathBuf,
    /// Build only the parts whose name contains this
    #[arg(long, value_name = "NAME")]
    only: Option<String>,
    /// Fail if a part cannot be built here
    #[arg(long)]
    all: bool,
}

/// A part of the release that was not built, with its reason, or the files that were.
enum Built {
    Files(Vec<PathBuf>),
    Missing(String),
}

/// A part of the release: its name, and its build into a folder.
type Part = (&'static str, fn(&Path) -> Result<Built>);

const PARTS: [Part; 9] = [
    ("packages", packages),
    ("header", header),
    ("C archives", |out| archives::build(out).map(Built::Files)),
    ("shared C library", archives::shared),
    ("images", images),
    ("rai and its Debian package", |out| binary::build(out).map(Built::Files)),
    ("Python wheel", wheel::build),
    ("rai, static, x86-64", |out| binary::statically("x86_64", out)),
    ("rai, static, aarch64", |out| binary::statically("aarch64", out)),
];

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let out = root().join(&arguments.out);
    if out.exists() {
        fs::remove_dir_all(&out).with_context(|| out.display().to_string())?;
    }
    fs::create_dir_all(&out).with_context(|| out.display().to_string())?;
    let (mut files, mut missing) = (Vec::new(), Vec::new());
    let is_chosen = |name: &str| arguments.only.as_deref().is_none_or(|part| name.contains(part));
    for (name, build) in PARTS.iter().filter(|(name, _)| is_chosen(name)) {
        match build(&out).with_context(|| format!("part `{name}`"))? {
            Built::Files(built) => {
                println!("built      {name}: {} files", built.len());
                files.extend(built);
            }
            Built::Missing(why) => {
                println!("NOT BUILT  {name}: {why}");
                missing.push(*name);
            }
        }
    }
    files.push(sbom::write(&out)?);
    let sums = checksums::write(&out, &files)?;
    println!("{} files in {}, with {}", files.len(), out.display(), files::name(&sums)?);
    ensure!(!arguments.all || missing.is_empty(), "not built: {}", missing.join(", "));
    Ok(())
}

fn packages(out: &Path) -> Result<Built> {
    crate::packages::verify()?;
    let copy = |name: &&str| {
        let file = format!("{name}-{VERSION}.crate");
        files::copy(&root().join("target/package").join(&file), &out.join(&file))
    };
    Ok(Built::Files(crate::packages::PACKAGES.iter().map(copy).collect::<Result<_>>()?))
}

fn header(out: &Path) -> Result<Built> {
    let (committed, header) = (fs::read_to_string(rig::capi::header_path())?, rig::capi::header()?);
    ensure!(committed == header, "{}", rig::capi::STALE_HEADER);
    Ok(Built::Files(vec![files::copy(&rig::capi::header_path(), &out.join("rai.h"))?]))
}

/// Builds the named images.
fn images(out: &Path) -> Result<Built> {
    let chip = Chip::named("STM32F405RGTx")?;
    let build = |named: &Named| {
        let (path, image) = crate::image::build(named)?;
        let findings = image.check(&chip);
        ensure!(findings.is_empty(), "the image does not fit: {}", findings.join("; "));
        files::copy(&path, &out.join(format!("raim-firmware-{VERSION}-stm32f405-{}.elf", named.name)))
    };
    Ok(Built::Files(NAMED.iter().map(build).collect::<Result<_>>()?))
}
