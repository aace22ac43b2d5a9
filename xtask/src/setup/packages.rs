//! Packages of the system: their names, and the command that installs them without removing any.

use std::process::{Command, Stdio};

use super::{Step, on_path};

/// The package manager of the system, and who may use it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Packages {
    /// Debian's; this process may install.
    Apt,
    /// Debian's; this process may install through `sudo`, which needs no password.
    AptSudo,
    /// Debian's; only the user may install.
    AptAsk,
    /// Homebrew, which needs no rights.
    Brew,
    /// Another one.
    Unknown,
}

/// Packages that are installed together.
pub(super) struct Package {
    /// Names at Debian.
    debian: &'static [&'static str],
    /// Name at Homebrew.
    brew: Option<&'static str>,
    /// The command to type if only the user may install.
    command: &'static str,
    /// The request on another system.
    words: &'static str,
}

pub(super) const EMULATOR: Package = Package {
    debian: &["qemu-system-arm"],
    brew: Some("qemu"),
    command: "sudo apt-get update && sudo apt-get install --no-remove --no-install-recommends qemu-system-arm",
    words: "install QEMU so that qemu-system-arm is on the path",
};

pub(super) const C_COMPILER: Package = Package {
    debian: &["gcc-arm-none-eabi"],
    brew: Some("arm-none-eabi-gcc"),
    command: "sudo apt-get update && sudo apt-get install --no-remove --no-install-recommends gcc-arm-none-eabi",
    words: "install GCC for bare Arm so that arm-none-eabi-gcc is on the path",
};

pub(super) const CONSUMERS: Package = Package {
    debian: &[
        "gpsd",
        "socat",
        "rtklib",
        "cmake",
        "pkg-config",
        "gcc-arm-none-eabi",
        "libnewlib-arm-none-eabi",
        "python3-venv",
        "lintian",
        "man-db",
        "qemu-user",
    ],
    brew: None,
    command: "sudo apt-get update && sudo apt-get install --no-remove --no-install-recommends \
              gpsd socat rtklib cmake pkg-config gcc-arm-none-eabi libnewlib-arm-none-eabi python3-venv \
              lintian man-db qemu-user",
    words: "install gpsd, socat, RTKLIB (for convbin), CMake, pkg-config, GCC for bare Arm with newlib, \
            Python with venv, lintian, man-db and qemu-user",
};

/// It conflicts with every other daemon that sets the clock, and most systems have one.
pub(super) const CHRONY: Package = Package {
    debian: &["chrony"],
    brew: None,
    command: "sudo apt-get update && sudo apt-get install --no-remove --no-install-recommends chrony",
    words: "install chrony",
};

/// Returns the steps that install a package.
pub(super) fn install(package: &Package, packages: Packages) -> Vec<Step> {
    // A fresh machine knows no package before it has fetched its lists.
    let update = ["apt-get", "update"];
    let install =
        [&["apt-get", "install", "--yes", "--no-remove", "--no-install-recommends"], package.debian].concat();
    let sudo = |command: &[&'static str]| Step::Run([&["sudo", "-n"], command].concat());
    match (packages, package.brew) {
        (Packages::Apt, _) => vec![Step::Run(update.to_vec()), Step::Run(install)],
        (Packages::AptSudo, _) => vec![sudo(&update), sudo(&install)],
        (Packages::AptAsk, _) => vec![Step::Ask(package.command)],
        (Packages::Brew, Some(name)) => vec![Step::Run(vec!["brew", "install", name])],
        (Packages::Brew | Packages::Unknown, _) => vec![Step::Ask(package.words)],
    }
}

impl Packages {
    /// Looks at this machine.
    pub(super) fn look() -> Self {
        if on_path("brew") {
            return Self::Brew;
        }
        if !on_path("apt-get") {
            return Self::Unknown;
        }
        let answer = |program: &str, arguments: &[&str]| {
            Command::new(program).args(arguments).stdin(Stdio::null()).stderr(Stdio::null()).output().ok()
        };
        if answer("id", &["-u"]).is_some_and(|output| output.stdout.trim_ascii() == b"0") {
            return Self::Apt;
        }
        let sudo = answer("sudo", &["-n", "true"]).is_some_and(|output| output.status.success());
        if sudo { Self::AptSudo } else { Self::AptAsk }
    }

    /// Returns true if the system's packages are Debian's.
    pub(super) const fn is_debian(self) -> bool {
        matches!(self, Self::Apt | Self::AptSudo | Self::AptAsk)
    }
}
