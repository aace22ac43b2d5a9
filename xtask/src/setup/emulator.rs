//! The emulator: the one on the path, or Debian's packages of it unpacked below `target`.
//!
//! Unpacking needs no rights and changes nothing outside the project. It also works where the
//! system's own package of the emulator would remove another package. `apt-get` keeps its lists and
//! archives in the same folder, so that a machine that has never fetched any needs no step before.

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, ensure};

use super::on_path;
use crate::cargo::root;

/// The emulator's program, and Debian's name of its package.
pub const PROGRAM: &str = "qemu-system-arm";

/// Returns true if the emulator can be started.
pub fn is_there() -> bool {
    on_path(PROGRAM) || unpacked().is_file()
}

/// Returns the command that starts the emulator, without arguments.
pub fn command() -> Command {
    if on_path(PROGRAM) || !unpacked().is_file() {
        return Command::new(PROGRAM);
    }
    let mut command = Command::new(unpacked());
    command.env("LD_LIBRARY_PATH", libraries()).arg("-L").arg(files().join("usr/share/qemu"));
    command
}

fn folder() -> PathBuf {
    root().join("target/tools/emulator")
}

fn files() -> PathBuf {
    folder().join("files")
}

fn unpacked() -> PathBuf {
    files().join("usr/bin").join(PROGRAM)
}

/// Returns the folders of the unpacked libraries, and those that the caller has named.
fn libraries() -> OsString {
    let triplets = ["x86_64", "aarch64", "i386", "arm"].map(|processor| match processor {
        "arm" => "arm-linux-gnueabihf".to_owned(),
        _ => format!("{processor}-linux-gnu"),
    });
    let ours = triplets.iter().flat_map(|triplet| {
        ["usr/lib", "lib"]
            .map(|prefix| files().join(prefix).join(triplet))
            .into_iter()
            .filter(|path| path.is_dir())
    });
    let theirs = std::env::var_os("LD_LIBRARY_PATH").unwrap_or_default();
    std::env::join_paths(ours.chain(std::env::split_paths(&theirs))).unwrap_or(theirs)
}

/// Fetches Debian's packages of the emulator, and unpacks them below `target`.
///
/// # Errors
/// If a package cannot be fetched or unpacked, or if the unpacked emulator does not start.
pub(super) fn unpack() -> Result<()> {
    let (archives, lists) = (folder().join("archives"), folder().join("lists"));
    for path in [&archives, &lists.join("partial"), &folder().join("cache/archives/partial")] {
        fs::create_dir_all(path).with_context(|| path.display().to_string())?;
    }
    eprintln!("The emulator is missing. Its packages are unpacked in {}.", folder().display());
    apt(&archives, &["update"])?;
    let packages = missing_packages(&archives)?;
    ensure!(!packages.is_empty(), "Debian has no package {PROGRAM}: install QEMU so that it is on the path");
    let names: Vec<&str> = packages.iter().map(String::as_str).collect();
    apt(&archives, &[&["download"], &names[..]].concat())?;
    for archive in fs::read_dir(&archives)?.collect::<Result<Vec<_>, _>>()? {
        let status = Command::new("dpkg-deb").arg("--extract").arg(archive.path()).arg(files()).status();
        ensure!(
            status.is_ok_and(|status| status.success()),
            "{} cannot be unpacked",
            archive.path().display()
        );
    }
    fs::remove_dir_all(&archives)?;
    let version =
        command().arg("--version").stderr(Stdio::inherit()).output().context("the unpacked emulator")?;
    ensure!(version.status.success(), "the unpacked emulator does not start: {}", version.status);
    Ok(())
}

/// Returns the packages that the emulator needs and the system lacks; never the C library, which
/// belongs to the system's own loader.
fn missing_packages(archives: &Path) -> Result<Vec<String>> {
    let arguments = ["install", "--simulate", "--no-install-recommends", PROGRAM];
    let output = apt_command(archives, &arguments).output().context("apt-get cannot be run")?;
    ensure!(
        output.status.success(),
        "apt-get does not find {PROGRAM}: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    Ok(installed_by(&String::from_utf8_lossy(&output.stdout)))
}

/// Returns the names of the packages that a simulation of `apt-get install` would install.
fn installed_by(simulation: &str) -> Vec<String> {
    let names = simulation.lines().filter_map(|line| line.strip_prefix("Inst ")?.split(' ').next());
    names.filter(|name| !name.starts_with("libc6")).map(str::to_owned).collect()
}

fn apt(archives: &Path, arguments: &[&str]) -> Result<()> {
    eprintln!("$ apt-get {}", arguments.join(" "));
    let status = apt_command(archives, arguments).status().context("apt-get cannot be run")?;
    ensure!(status.success(), "`apt-get {}` failed: {status}", arguments.join(" "));
    Ok(())
}

/// Returns `apt-get` with its lists and archives in the project's folder.
fn apt_command(archives: &Path, arguments: &[&str]) -> Command {
    let option = |name: &str, value: &Path| format!("{name}={}", value.display());
    let mut command = Command::new("apt-get");
    command.current_dir(archives).stdin(Stdio::null()).arg("--quiet=2");
    command.arg("-o").arg(option("Dir::State::Lists", &folder().join("lists")));
    command.arg("-o").arg(option("Dir::Cache", &folder().join("cache")));
    // Its own user could not write to a folder of ours.
    command.args(["-o", "APT::Sandbox::User="]).args(arguments);
    command
}

#[cfg(test)]
mod tests {
    use super::installed_by;

    #[test]
    fn simulation_names_what_it_would_install() {
        // A run of `apt-get install --simulate` prints such lines.
        let simulation = "The following packages will be REMOVED:\n  qemu-utils\n\
            Remv qemu-utils [1:10.0.2]\n\
            Inst libfdt1 (1.6.1-4 Debian:12.15/oldstable [amd64])\n\
            Inst libc6 [2.36-1] (2.36-9 Debian:12.15/oldstable [amd64])\n\
            Inst qemu-system-arm (1:7.2 Debian:12.15/oldstable [amd64])\n\
            Conf libfdt1 (1.6.1-4 Debian:12.15/oldstable [amd64])\n";
        assert_eq!(installed_by(simulation), ["libfdt1", "qemu-system-arm"]);
    }
}
