//! Requirements of a machine beside the Rust toolchain, and their installation.
//!
//! [`Machine::look`] collects facts, [`plan`] turns facts into steps, [`ensure()`] takes them. If
//! this process may not take a step, it prints the exact command for the user. If nothing is
//! missing the look takes some milliseconds, so every command can afford it.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, bail, ensure};

/// Processors that the libraries are compiled for, by the compiler's names; the first is the
/// chip's.
pub const TARGETS: [&str; 4] = [
    "thumbv7em-none-eabihf",
    "thumbv6m-none-eabi",
    "thumbv8m.main-none-eabihf",
    "riscv32imac-unknown-none-elf",
];

/// Requirement of the commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Need {
    /// The compiler's library for the chip and for other processors.
    Target,
    /// clippy and rustfmt.
    Components,
    /// The emulator.
    Emulator,
    /// The C compiler for the chip, which the tests of the C library need.
    CCompiler,
}

/// Facts about this machine.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Machine {
    /// Missing requirements.
    pub lacks: Vec<Need>,
    /// True if rustup manages the toolchain.
    pub rustup: bool,
    /// Package manager of the system.
    pub packages: Packages,
}

/// Package manager of a system, with this process's rights.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Packages {
    /// apt, and this process may run it.
    Apt,
    /// apt, after `sudo`, which asks for no password.
    AptSudo,
    /// apt, but only the user may run it.
    AptAsk,
    /// Homebrew, which asks the user nothing.
    Brew,
    /// Another package manager.
    Unknown,
}

/// One step of the set-up.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Step {
    /// A command to run.
    Run(Vec<&'static str>),
    /// An action that only the user can take: a command to type, or words.
    Ask(&'static str),
}

/// Returns the steps that a machine needs; none if nothing is missing.
pub fn plan(machine: &Machine) -> Vec<Step> {
    machine.lacks.iter().flat_map(|&need| remedy(need, machine)).collect()
}

fn remedy(need: Need, machine: &Machine) -> Vec<Step> {
    let toolchain = |command: &[&'static str], words| {
        vec![if machine.rustup { Step::Run(command.to_vec()) } else { Step::Ask(words) }]
    };
    match need {
        Need::Target => toolchain(
            &["rustup", "target", "add", TARGETS[0], TARGETS[1], TARGETS[2], TARGETS[3]],
            "install the standard libraries that rust-toolchain.toml lists, or Rust from https://rustup.rs",
        ),
        Need::Components => toolchain(
            &["rustup", "component", "add", "clippy", "rustfmt"],
            "install clippy and rustfmt, or Rust from https://rustup.rs",
        ),
        Need::Emulator => install(&EMULATOR, machine.packages),
        Need::CCompiler => install(&C_COMPILER, machine.packages),
    }
}

/// Packages that are installed together, by their Debian names, and alternatives.
struct Package {
    debian: &'static [&'static str],
    brew: Option<&'static str>,
    /// Command to type if only the user may run it, and words for systems other than Debian.
    command: &'static str,
    words: &'static str,
}

const EMULATOR: Package = Package {
    debian: &["qemu-system-arm"],
    brew: Some("qemu"),
    command: "sudo apt-get update && sudo apt-get install --no-install-recommends qemu-system-arm",
    words: "install QEMU so that qemu-system-arm is on the path",
};

const C_COMPILER: Package = Package {
    debian: &["gcc-arm-none-eabi"],
    brew: Some("arm-none-eabi-gcc"),
    command: "sudo apt-get update && sudo apt-get install --no-install-recommends gcc-arm-none-eabi",
    words: "install GCC for bare Arm so that arm-none-eabi-gcc is on the path",
};

const CONSUMERS: Package = Package {
    debian: &["gpsd", "rtklib", "python3-venv"],
    brew: None,
    command: "sudo apt-get update && sudo apt-get install --no-install-recommends gpsd rtklib python3-venv",
    words: "install gpsd, RTKLIB (for convbin) and Python with venv",
};

const PEERS: Package = Package {
    debian: &["gcc-arm-none-eabi", "libnewlib-arm-none-eabi", "python3"],
    // Homebrew's GCC has no C library.
    brew: None,
    command: "sudo apt-get update && sudo apt-get install --no-install-recommends gcc-arm-none-eabi \
              libnewlib-arm-none-eabi python3",
    words: "install GCC for bare Arm with newlib (arm-none-eabi-gcc on the path), and Python 3",
};

fn install(package: &Package, packages: Packages) -> Vec<Step> {
    // A fresh machine has no package lists until they are fetched.
    let update = ["apt-get", "update"];
    let install = [&["apt-get", "install", "--yes", "--no-install-recommends"], package.debian].concat();
    let sudo = |command: &[&'static str]| Step::Run([&["sudo", "-n"], command].concat());
    match (packages, package.brew) {
        (Packages::Apt, _) => vec![Step::Run(update.to_vec()), Step::Run(install)],
        (Packages::AptSudo, _) => vec![sudo(&update), sudo(&install)],
        (Packages::AptAsk, _) => vec![Step::Ask(package.command)],
        (Packages::Brew, Some(name)) => vec![Step::Run(vec!["brew", "install", name])],
        (Packages::Brew | Packages::Unknown, _) => vec![Step::Ask(package.words)],
    }
}

impl Machine {
    /// Checks this machine for the requirements of every command.
    pub fn look() -> Self {
        let sysroot = sysroot();
        let has = |relative: &str| sysroot.as_ref().is_some_and(|root| root.join(relative).exists());
        let needs = [
            (Need::Target, TARGETS.iter().all(|target| has(&format!("lib/rustlib/{target}/lib")))),
            (Need::Components, has("bin/cargo-clippy") && has("bin/rustfmt")),
            (Need::Emulator, on_path("qemu-system-arm")),
        ];
        Self::lacking(needs.into_iter().filter(|(_, there)| !there).map(|(need, _)| need).collect())
    }

    /// Checks also for the requirements of tests that are skipped otherwise.
    pub fn look_for_all() -> Self {
        let Self { mut lacks, .. } = Self::look();
        if !on_path("arm-none-eabi-gcc") {
            lacks.push(Need::CCompiler);
        }
        Self::lacking(lacks)
    }

    fn lacking(lacks: Vec<Need>) -> Self {
        // This is asked only if it matters, because asking `sudo` takes a while.
        let is_packaged = lacks.iter().any(|need| matches!(need, Need::Emulator | Need::CCompiler));
        let packages = if is_packaged { packages() } else { Packages::Unknown };
        Self { lacks, rustup: on_path("rustup"), packages }
    }
}

/// Installs missing requirements; silent if there are none.
///
/// # Errors
/// If a step fails, or only the user can take it; the message is then the command to type.
pub fn ensure() -> anyhow::Result<()> {
    settle(Machine::look)
}

/// Installs also the requirements of tests that are skipped otherwise.
///
/// # Errors
/// As [`ensure()`].
pub fn ensure_all() -> anyhow::Result<()> {
    settle(Machine::look_for_all)
}

fn settle(look: fn() -> Machine) -> anyhow::Result<()> {
    let steps = plan(&look());
    for step in &steps {
        take(step)?;
    }
    let left = if steps.is_empty() { Vec::new() } else { plan(&look()) };
    ensure!(left.is_empty(), "after the set-up this is still missing: {left:?}");
    Ok(())
}

/// Python packages that parse the module's output.
const PYTHON_PACKAGES: [&str; 2] = ["pynmea2", "pymavlink"];

/// Installs the programs that tests compare the module with: gpsd, RTKLIB's `convbin`, and Python
/// packages in their own folder below `target`. Only these tests need them.
///
/// # Errors
/// As [`ensure()`].
pub fn consumers() -> anyhow::Result<()> {
    let python = python_of_consumers();
    let (folder, python) = (root().join("target/consumers"), python.display().to_string());
    let folder = folder.display().to_string();
    if !["gpsd", "convbin", "python3"].into_iter().all(on_path) {
        install(&CONSUMERS, packages()).iter().try_for_each(take)?;
    }
    run(&["python3", "-m", "venv", &folder])?;
    run(&[&[&python, "-m", "pip", "install", "--quiet"], &PYTHON_PACKAGES[..]].concat())
}

/// Installs the tools that fetch and compile the programs measured beside ours.
///
/// # Errors
/// As [`ensure()`].
pub fn peers() -> anyhow::Result<()> {
    if !can_compile_peers() || !on_path("python3") {
        install(&PEERS, packages()).iter().try_for_each(take)?;
    }
    ensure!(can_compile_peers(), "after the set-up newlib for arm-none-eabi-gcc is still missing");
    Ok(())
}

/// Returns true if the C compiler for the chip is installed with a C library.
pub fn can_compile_peers() -> bool {
    // The compiler answers with the bare name if it does not find the file.
    let library = Command::new("arm-none-eabi-gcc").arg("-print-file-name=nosys.specs").output();
    library.is_ok_and(|output| output.stdout.contains(&b'/'))
}

/// Returns the Python with the consumers' packages: the one made by [`consumers`], or else that of
/// the system.
pub fn python() -> PathBuf {
    let made = python_of_consumers();
    if made.is_file() { made } else { PathBuf::from("python3") }
}

fn python_of_consumers() -> PathBuf {
    root().join("target/consumers/bin/python3")
}

fn take(step: &Step) -> anyhow::Result<()> {
    let command = match step {
        Step::Ask(words) => bail!("a requirement is missing that only you can install:\n\n    {words}\n"),
        Step::Run(command) => command,
    };
    run(command)
}

fn run(command: &[&str]) -> anyhow::Result<()> {
    eprintln!("$ {}", command.join(" "));
    let (program, arguments) = command.split_first().context("a step without a program")?;
    let status = Command::new(program)
        .args(arguments)
        .current_dir(root())
        .env("DEBIAN_FRONTEND", "noninteractive")
        .status()
        .with_context(|| format!("{program} cannot be run"))?;
    ensure!(status.success(), "`{}` failed: {status}", command.join(" "));
    Ok(())
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Returns the folder of the toolchain that this project pins.
fn sysroot() -> Option<PathBuf> {
    let rustc = Command::new("rustc").args(["--print", "sysroot"]).current_dir(root()).output().ok()?;
    Some(PathBuf::from(String::from_utf8(rustc.stdout).ok()?.trim()))
}

fn on_path(program: &str) -> bool {
    let path = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&path).any(|folder| folder.join(program).is_file())
}

fn packages() -> Packages {
    if on_path("brew") {
        return Packages::Brew;
    }
    if !on_path("apt-get") {
        return Packages::Unknown;
    }
    let says = |program: &str, arguments: &[&str]| {
        Command::new(program).args(arguments).stdin(Stdio::null()).stderr(Stdio::null()).output().ok()
    };
    if says("id", &["-u"]).is_some_and(|output| output.stdout.trim_ascii() == b"0") {
        return Packages::Apt;
    }
    let sudo = says("sudo", &["-n", "true"]).is_some_and(|output| output.status.success());
    if sudo { Packages::AptSudo } else { Packages::AptAsk }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lacking(lacks: &[Need], packages: Packages) -> Machine {
        Machine { lacks: lacks.to_vec(), rustup: true, packages }
    }

    #[test]
    fn complete_machine_needs_nothing() {
        assert_eq!(plan(&lacking(&[], Packages::Unknown)), []);
    }

    #[test]
    fn fresh_machine_fetches_package_lists_before_it_installs() {
        let fresh = lacking(&[Need::Target, Need::Components, Need::Emulator], Packages::Apt);
        let have: Vec<String> = plan(&fresh)
            .into_iter()
            .map(|step| match step {
                Step::Run(command) => command.join(" "),
                Step::Ask(words) => panic!("asks for {words}"),
            })
            .collect();
        let want = [
            "rustup target add thumbv7em-none-eabihf thumbv6m-none-eabi thumbv8m.main-none-eabihf \
             riscv32imac-unknown-none-elf",
            "rustup component add clippy rustfmt",
            "apt-get update",
            "apt-get install --yes --no-install-recommends qemu-system-arm",
        ];
        assert_eq!(have, want);
    }

    #[test]
    fn compiler_for_the_tests_in_c_is_installed_or_asked_for() {
        let have = plan(&lacking(&[Need::CCompiler], Packages::Apt));
        let Some(Step::Run(command)) = have.last() else { panic!("it must install: {have:?}") };
        assert_eq!(command.last(), Some(&"gcc-arm-none-eabi"));
        for packages in [Packages::AptAsk, Packages::Unknown] {
            let have = plan(&lacking(&[Need::CCompiler], packages));
            let [Step::Ask(words)] = &have[..] else { panic!("it must ask: {have:?}") };
            assert!(words.contains("arm-none-eabi"), "{words}");
        }
    }

    #[test]
    fn who_may_not_install_is_told_the_exact_command() {
        let steps = plan(&lacking(&[Need::Emulator], Packages::AptAsk));
        let [step @ Step::Ask(words)] = &steps[..] else { panic!("it must ask: {steps:?}") };
        assert!(words.contains("sudo apt-get install") && words.contains("qemu-system-arm"), "{words}");
        assert!(take(step).expect_err("asking stops").to_string().contains(words));
    }

    #[test]
    fn toolchain_without_rustup_is_left_to_the_user() {
        let machine = Machine { rustup: false, ..lacking(&[Need::Target], Packages::Unknown) };
        assert!(matches!(plan(&machine)[..], [Step::Ask(_)]));
    }

    #[test]
    fn failed_step_says_which_command() {
        let error = take(&Step::Run(vec!["false", "now"])).expect_err("it fails").to_string();
        assert!(error.contains("`false now` failed"), "{error}");
    }
}
