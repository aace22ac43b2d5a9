//! Files of the Debian package of `rai`, and the check of the package by `lintian`.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, Result, ensure};
use raim::signal::calendar::readable_unix;

use super::deb::{Control, maintainer, package};
use super::files::{Entry, gz, time_s};
use super::{Built, VERSION, binary, changelog, manual, sbom};
use xtask::cargo::root;

/// Builds the package. It starts no service, because the settings must name the receiver first.
///
/// # Errors
/// If `dpkg-deb` does not read it, or `lintian` reports an error or a warning.
pub(super) fn build(program: &Path, out: &Path) -> Result<Built> {
    let architecture = match std::env::consts::ARCH {
        "x86_64" => "amd64",
        "aarch64" => "arm64",
        other => other,
    };
    let bytes = fs::read(program)?;
    let glibc = newest_glibc(&bytes).context("the program does not name its C library")?;
    let (time_s, maintainer) = (time_s()?, maintainer()?);
    let control = Control {
        package: "raim",
        version: VERSION,
        architecture,
        maintainer: &maintainer,
        depends: &format!("libc6 (>= 2.{glibc}), libgcc-s1"),
        // The authorities that a caster's certificate is compared with.
        recommends: "ca-certificates",
        summary: "integrity of a GNSS receiver on a computer",
        description: &[
            "The command rai reads a GNSS receiver's raw ranges, computes a position of its",
            "own, detects and excludes faulty satellites, and reports whether the position",
            "may be used: as sentences, and as one fail-safe pin. The service is not started",
            "by the installation: /etc/rai.toml must name the receiver's port first.",
        ],
    };
    let mut entries = vec![
        Entry::of("usr/bin/rai", program)?.program(),
        Entry::of("usr/lib/systemd/system/rai.service", &root().join("rai-firmware/cli/rai.service"))?,
        Entry::of("etc/rai.toml", &root().join("rai-firmware/cli/rai.toml"))?,
    ];
    entries.extend(documents(&maintainer, time_s)?);
    let path = out.join(format!("raim_{VERSION}_{architecture}.deb"));
    fs::write(&path, package(&control, &entries, time_s)?)?;
    check(path)
}

/// Returns the documents, as Debian policy 12 places them.
fn documents(maintainer: &str, time_s: u64) -> Result<Vec<Entry>> {
    let folder = "usr/share/doc/raim/";
    let date = readable_unix(time_s.cast_signed() * 1000);
    let changes = fs::read_to_string(root().join("CHANGELOG.md"))?;
    let changes = changelog::debian(&changes, VERSION, maintainer, time_s)?;
    let mut entries =
        binary::with_texts(folder, &["README.md", "INTERFACES.md", "LIMITS.md", "CHANGELOG.md"])?;
    entries.push(Entry::text(format!("{folder}copyright"), copyright(date.get(..4).unwrap_or_default())?));
    entries.push(Entry::text(format!("{folder}rai.cdx.json"), sbom::text()?));
    entries
        .push(Entry { bytes: gz(changes.as_bytes())?, ..Entry::text(format!("{folder}changelog.gz"), "") });
    for (name, page) in manual::pages(date.get(..10).unwrap_or_default())? {
        let path = format!("usr/share/man/man1/{name}.gz");
        entries.push(Entry { bytes: gz(page.as_bytes())?, ..Entry::text(path, "") });
    }
    Ok(entries)
}

/// Returns the file `copyright`, in the form of Debian's `copyright-format/1.0`.
fn copyright(year: &str) -> Result<String> {
    let licence = fs::read_to_string(root().join("LICENSE-MIT"))?;
    let licence: Vec<_> = licence
        .trim()
        .lines()
        .map(|line| if line.is_empty() { " .\n".to_owned() } else { format!(" {line}\n") })
        .collect();
    Ok(format!(
        "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/\n\
         Upstream-Name: RAI\n\
         Comment: The program contains packages of others. rai.cdx.json beside this file\n \
         lists each with its version, its licence and its address.\n\n\
         Files: *\n\
         Copyright: {year} the contributors of RAI\n\
         License: Expat or Apache-2.0\n\n\
         License: Expat\n{}\n\
         License: Apache-2.0\n \
         The text is in /usr/share/common-licenses/Apache-2.0 on Debian systems.\n",
        licence.concat()
    ))
}

/// Checks a package by Debian's own programs, as far as this machine has them.
fn check(path: PathBuf) -> Result<Built> {
    let mut skipped = Vec::new();
    match Command::new("dpkg-deb").arg("--info").arg(&path).output() {
        Ok(output) => {
            ensure!(output.status.success(), "dpkg-deb: {}", String::from_utf8_lossy(&output.stderr));
        }
        Err(_) => skipped.push("the package read by dpkg-deb, which is not installed".to_owned()),
    }
    match Command::new("lintian").arg(&path).output() {
        Ok(output) => {
            let reported = String::from_utf8_lossy(&output.stdout);
            let findings = findings(&reported);
            ensure!(findings.is_empty(), "lintian reports\n{}", findings.join("\n"));
            // Without a finding the program ends well, unless it could not look.
            let why = String::from_utf8_lossy(&output.stderr);
            ensure!(output.status.success(), "lintian fails: {reported}{why}");
        }
        Err(_) => skipped.push("the package read by lintian (apt-get install lintian)".to_owned()),
    }
    Ok(Built::Files { paths: vec![path], skipped })
}

/// Returns the errors and warnings that `lintian` prints.
fn findings(reported: &str) -> Vec<&str> {
    reported.lines().filter(|line| line.starts_with("E: ") || line.starts_with("W: ")).collect()
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
    use super::*;

    #[test]
    fn newest_version_of_the_c_library_counts() {
        assert_eq!(newest_glibc(b"\0GLIBC_2.2.5\0GLIBC_2.34\0GLIBC_2.17\0"), Some(34));
        assert_eq!(newest_glibc(b"\x7fELF"), None);
    }

    #[test]
    fn errors_and_warnings_of_lintian_are_findings() {
        let reported = "E: raim: no-changelog usr/share/doc/raim/changelog.gz\nW: raim: no-manual-page [usr/bin/rai]\n\
            I: raim: no-md5sums-control-file\nN: 1 hint\n";
        assert_eq!(findings(reported).len(), 2);
    }

    mod at_length {
        use super::*;

        /// A package is checked with a program of the system in the place of `rai`.
        #[cfg(target_os = "linux")]
        #[test]
        fn lintian_finds_nothing_in_the_package() {
            let folder = tempfile::tempdir().unwrap();
            let Ok(built) = build(Path::new("/bin/true"), folder.path()) else {
                panic!("{:#}", build(Path::new("/bin/true"), folder.path()).err().unwrap())
            };
            let Built::Files { skipped, .. } = built else { panic!("a package is a file") };
            for check in &skipped {
                rig::skip::say(check);
            }
        }
    }
}
