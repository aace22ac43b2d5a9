//! The program `rai`: an archive and a Debian package for this system, and static programs.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, Result, ensure};

use super::deb::{Control, maintainer, package};
use super::elf;
use super::files::{Entry, name, tar_gz};
use super::{Built, VERSION};
use crate::cargo::{command, root, spawn};

/// Builds the program for this system, its archive and its Debian package.
///
/// # Errors
/// If it does not build, or does not print its version.
pub(super) fn build(out: &Path) -> Result<Vec<PathBuf>> {
    let program = compile(None)?;
    check_version(&program)?;
    let mut files = vec![archive(&program, &format!("{}-linux", std::env::consts::ARCH), out)?];
    if cfg!(target_os = "linux") {
        files.push(debian(&program, out)?);
    }
    Ok(files)
}

/// Builds the program for this system.
///
/// # Errors
/// If it does not build.
pub(crate) fn program() -> Result<PathBuf> {
    compile(None)
}

/// Builds a program that needs no library of its system: with musl if the compiler has it,
/// otherwise with the GNU C library linked into the program.
///
/// # Errors
/// If it does not build, or is not static.
pub(super) fn statically(architecture: &str, out: &Path) -> Result<Built> {
    let [musl, gnu] = ["musl", "gnu"].map(|library| format!("{architecture}-unknown-linux-{library}"));
    let is_own = architecture == std::env::consts::ARCH && cfg!(all(target_os = "linux", target_env = "gnu"));
    let target = match (is_installed(&musl)?, is_own) {
        (true, _) => musl,
        (false, true) => gnu,
        (false, false) => {
            return Ok(Built::Missing(format!("needs the target: rustup target add {musl}")));
        }
    };
    let program = compile(Some(&target))?;
    let wants = elf::wants(&fs::read(&program)?).context("the program is no ELF file of 64 bits")?;
    ensure!(wants.is_empty(), "{} needs {}", program.display(), wants.join(", "));
    if architecture == std::env::consts::ARCH {
        check_version(&program)?;
    }
    Ok(Built::Files(vec![archive(&program, &format!("{architecture}-linux-static"), out)?]))
}

/// Returns true if the compiler has the standard library of a target.
fn is_installed(target: &str) -> Result<bool> {
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let output = Command::new(rustc)
        .current_dir(root())
        .args(["--print", "target-libdir", "--target", target])
        .output()?;
    Ok(output.status.success() && Path::new(String::from_utf8_lossy(&output.stdout).trim()).exists())
}

fn compile(target: Option<&str>) -> Result<PathBuf> {
    let mut cargo = command(&["build", "--release", "--locked", "--package", "raim", "--bin", "rai"]);
    let mut folder = root().join("target");
    if let Some(target) = target {
        cargo.args(["--target", target]);
        let variable = target.to_uppercase().replace('-', "_");
        if target.ends_with("gnu") {
            cargo.env(format!("CARGO_TARGET_{variable}_RUSTFLAGS"), "-C target-feature=+crt-static");
        } else {
            // The compiler's own linker, because a system rarely has one for another processor.
            cargo.env(format!("CARGO_TARGET_{variable}_LINKER"), "rust-lld");
        }
        folder = folder.join(target);
    }
    // Without the places of the builder's files, and without symbols, a third of the size.
    cargo.args(["--config", "profile.release.strip=true", "--config", "profile.release.debug=0"]);
    spawn(&mut cargo)?;
    Ok(folder.join("release/rai"))
}

fn check_version(program: &Path) -> Result<()> {
    let output = Command::new(program).arg("--version").output()?;
    let said = String::from_utf8_lossy(&output.stdout);
    ensure!(said.trim() == format!("rai {VERSION}"), "{} prints {said:?}", program.display());
    Ok(())
}

/// Returns the files that go with a program, below a folder.
fn with_texts(folder: &str, texts: &[&str]) -> Result<Vec<Entry>> {
    texts
        .iter()
        .map(|text| Entry::of(format!("{folder}{}", name(Path::new(text))?), &root().join(text)))
        .collect()
}

fn archive(program: &Path, suffix: &str, out: &Path) -> Result<PathBuf> {
    let folder = format!("rai-{VERSION}-{suffix}/");
    let mut entries = vec![Entry::of(format!("{folder}rai"), program)?.program()];
    let texts = [
        "LICENSE-APACHE",
        "LICENSE-MIT",
        "README.md",
        "rai-firmware/cli/rai.service",
        "rai-firmware/cli/rai.toml",
    ];
    entries.extend(with_texts(&folder, &texts)?);
    let path = out.join(format!("rai-{VERSION}-{suffix}.tar.gz"));
    fs::write(&path, tar_gz(&entries)?)?;
    Ok(path)
}

/// Builds the Debian package. It starts no service, because the settings must name the receiver
/// first.
fn debian(program: &Path, out: &Path) -> Result<PathBuf> {
    let architecture = match std::env::consts::ARCH {
        "x86_64" => "amd64",
        "aarch64" => "arm64",
        other => other,
    };
    let bytes = fs::read(program)?;
    let glibc = newest_glibc(&bytes).context("the program does not name its C library")?;
    let depends = format!("libc6 (>= 2.{glibc}), libgcc-s1");
    let maintainer = maintainer()?;
    let control = Control {
        package: "raim",
        version: VERSION,
        architecture,
        maintainer: &maintainer,
        depends: &depends,
        summary: "integrity of a GNSS receiver on a computer",
        description: &[
            "The command rai reads a GNSS receiver's raw ranges, computes a position of its",
            "own, detects and excludes faulty satellites, and reports whether the position",
            "may be used: as sentences, and as one fail-safe pin. The service is not started",
            "by the installation: /etc/rai.toml must name the receiver's port first.",
        ],
    };
    let mut entries = vec![Entry::of("usr/bin/rai", program)?.program()];
    entries
        .push(Entry::of("usr/lib/systemd/system/rai.service", &root().join("rai-firmware/cli/rai.service"))?);
    entries.push(Entry::of("etc/rai.toml", &root().join("rai-firmware/cli/rai.toml"))?);
    entries.extend(with_texts("usr/share/doc/raim/", &["README.md", "INTERFACES.md", "CHANGELOG.md"])?);
    entries.push(Entry::of("usr/share/doc/raim/copyright", &root().join("LICENSE-MIT"))?);
    let path = out.join(format!("raim_{VERSION}_{architecture}.deb"));
    fs::write(&path, package(&control, &entries)?)?;
    if let Ok(output) = Command::new("dpkg-deb").arg("--info").arg(&path).output() {
        ensure!(output.status.success(), "dpkg-deb: {}", String::from_utf8_lossy(&output.stderr));
    }
    Ok(path)
}

/// Returns the newest minor version of the GNU C library 2 that a program names; `None` if it names
/// none.
fn newest_glibc(program: &[u8]) -> Option<u32> {
    const NAME: &[u8] = b"GLIBC_2.";
    let names = program.windows(NAME.len()).enumerate().filter(|(_, window)| *window == NAME);
    let versions = names.filter_map(|(index, _)| {
        let rest = program.get(index + NAME.len()..)?;
        let digits = rest.iter().take_while(|byte| byte.is_ascii_digit()).copied().collect();
        String::from_utf8(digits).ok()?.parse().ok()
    });
    versions.max()
}

#[cfg(test)]
mod tests {
    use super::newest_glibc;

    #[test]
    fn newest_version_of_the_c_library_counts() {
        assert_eq!(newest_glibc(b"\0GLIBC_2.2.5\0GLIBC_2.34\0GLIBC_2.17\0"), Some(34));
        assert_eq!(newest_glibc(b"\x7fELF"), None);
    }
}
