//! Debian package, as `deb(5)` defines it: an `ar` archive of a version, a description and files.

use std::process::Command;

use anyhow::{Context as _, Result, ensure};

use super::files::{Entry, tar_gz};
use xtask::cargo::root;

/// Description of a package.
pub(super) struct Control<'c> {
    pub(super) package: &'c str,
    pub(super) version: &'c str,
    pub(super) architecture: &'c str,
    /// Name and address, `NAME <ADDRESS>`.
    pub(super) maintainer: &'c str,
    pub(super) depends: &'c str,
    pub(super) recommends: &'c str,
    pub(super) summary: &'c str,
    /// Lines of at most 80 characters.
    pub(super) description: &'c [&'c str],
}

impl Control<'_> {
    /// Returns the file `control`; the installed size is in KiB.
    fn text(&self, installed_kib: u64) -> String {
        let lines: Vec<_> = self.description.iter().map(|line| format!(" {line}\n")).collect();
        format!(
            "Package: {}\nVersion: {}\nArchitecture: {}\nMaintainer: {}\n\
             Installed-Size: {installed_kib}\nDepends: {}\nRecommends: {}\nSection: science\nPriority: optional\n\
             Description: {}\n{}",
            self.package,
            self.version,
            self.architecture,
            self.maintainer,
            self.depends,
            self.recommends,
            self.summary,
            lines.concat()
        )
    }
}

/// Returns who maintains a package that is built here: `DEBFULLNAME` and `DEBEMAIL`, as Debian's
/// own programs take them, otherwise who made the last commit. The sources name nobody themselves.
///
/// # Errors
/// If neither is known.
pub(super) fn maintainer() -> Result<String> {
    if let (Ok(name), Ok(address)) = (std::env::var("DEBFULLNAME"), std::env::var("DEBEMAIL")) {
        return checked(&format!("{name} <{address}>"));
    }
    let git = Command::new("git").args(["log", "-1", "--format=%cn <%ce>"]).current_dir(root()).output();
    let reported = git.ok().filter(|output| output.status.success()).map(|output| output.stdout);
    let reported = reported.context(
        "the package names its maintainer, and git knows no commit here: set DEBFULLNAME and DEBEMAIL",
    )?;
    checked(String::from_utf8(reported)?.trim())
}

/// Returns a maintainer that is a name and an address on one line (Debian policy 5.6.2).
fn checked(maintainer: &str) -> Result<String> {
    let parts = maintainer.strip_suffix('>').and_then(|rest| rest.split_once(" <"));
    let is_plain = |text: &str| !text.is_empty() && !text.contains(['<', '>', '\n']);
    let is_address = |text: &str| is_plain(text) && text.contains('@') && !text.contains(' ');
    let is_right = parts.is_some_and(|(name, address)| is_plain(name) && is_address(address));
    ensure!(is_right, "{maintainer:?} is no NAME <ADDRESS>: set DEBFULLNAME and DEBEMAIL");
    Ok(maintainer.to_owned())
}

/// Returns a package with these files. The ones below `etc` keep what an administrator has changed.
///
/// # Errors
/// If a name is longer than an archive allows.
pub(super) fn package(control: &Control<'_>, files: &[Entry], time_s: u64) -> Result<Vec<u8>> {
    let bytes: u64 = files.iter().map(|entry| entry.bytes.len() as u64).sum();
    let settings = files.iter().filter_map(|entry| entry.path.strip_prefix("etc/"));
    let settings: Vec<_> = settings.map(|path| format!("/etc/{path}\n")).collect();
    let about = [
        Entry::text("control", control.text(bytes.div_ceil(1024))),
        Entry::text("conffiles", settings.concat()),
    ];
    archive(&[
        ("debian-binary", b"2.0\n".to_vec()),
        ("control.tar.gz", tar_gz(&about, time_s)?),
        ("data.tar.gz", tar_gz(files, time_s)?),
    ])
}

/// Returns an `ar` archive. Each member begins at an even place.
fn archive(members: &[(&str, Vec<u8>)]) -> Result<Vec<u8>> {
    let mut archive = b"!<arch>\n".to_vec();
    for (name, bytes) in members {
        ensure!(name.len() < 16, "the name of a member must have at most 15 characters, not {name}");
        // Name, time, owner, group, mode, length.
        archive.extend(
            format!("{name:<16}{:<12}{:<6}{:<6}{:<8}{:<10}`\n", 0, 0, 0, 100_644, bytes.len()).bytes(),
        );
        archive.extend(bytes);
        if bytes.len() % 2 == 1 {
            archive.push(b'\n');
        }
    }
    Ok(archive)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example() -> Vec<u8> {
        let entry = |path: &str, bytes: &[u8], is_program| Entry {
            path: path.into(),
            bytes: bytes.to_vec(),
            is_program,
        };
        let files = [entry("usr/bin/rai", b"#!/bin/sh\n", true), entry("etc/rai.toml", b"a = 1\n", false)];
        let control = Control {
            package: "raim",
            version: "0.2.0",
            architecture: "amd64",
            maintainer: "A. Builder <builder@example.org>",
            depends: "libc6 (>= 2.34)",
            recommends: "ca-certificates",
            summary: "integrity",
            description: &["One line."],
        };
        package(&control, &files, 1_000_000_000).unwrap()
    }

    #[test]
    fn same_files_give_the_same_bytes() {
        assert_eq!(example(), example());
        assert!(
            example()
                .starts_with(b"!<arch>\ndebian-binary   0           0     0     100644  4         `\n2.0\n")
        );
    }

    #[test]
    fn a_maintainer_is_a_name_and_an_address() {
        assert_eq!(checked("A. Builder <builder@example.org>").unwrap(), "A. Builder <builder@example.org>");
        for wrong in
            ["", "A. Builder", " <builder@example.org>", "A. Builder <>", "A\nX: y <b@c>", "A <b c@d>"]
        {
            assert!(checked(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn package_is_read_by_dpkg() {
        if Command::new("dpkg-deb").arg("--version").output().is_err() {
            rig::skip::say("the program dpkg-deb");
            return;
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("raim.deb");
        std::fs::write(&path, example()).unwrap();
        let ask = |how: &str| {
            let output = Command::new("dpkg-deb").env("TZ", "UTC").arg(how).arg(&path).output().unwrap();
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
            String::from_utf8(output.stdout).unwrap()
        };
        let about = ask("--info");
        assert!(about.contains("Package: raim") && about.contains("Depends: libc6 (>= 2.34)"), "{about}");
        assert!(about.contains("Maintainer: A. Builder <builder@example.org>"), "{about}");
        let files = ask("--contents");
        assert!(files.contains("-rwxr-xr-x root/root        10 2001-09-09 01:46 usr/bin/rai"), "{files}");
        assert!(files.contains("etc/rai.toml"), "{files}");
    }
}
