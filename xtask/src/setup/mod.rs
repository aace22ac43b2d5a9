//! Set-up: the programs that a machine needs beside the Rust toolchain, and how it gets them.
//!
//! [`Machine::look`] collects facts, [`plan`] turns facts into steps, and [`ensure()`] takes the
//! steps. If nothing is missing, the look takes milliseconds, so every command can afford it, and
//! asks before it compiles for minutes.
//!
//! | step | changes | asks first |
//! |---|---|---|
//! | [`Step::Unpack`] | the project's `target` folder only | no |
//! | [`Step::Run`] | the toolchain, or the system's packages | yes, unless `--yes` or `CI` is set |
//! | [`Step::Ask`] | nothing: it prints what the user has to do | – |
//!
//! No step removes a package: `apt-get` gets `--no-remove`. Debian's emulator needs no step of the
//! system at all, because [`emulator`] unpacks it below `target`.

mod consent;
pub mod emulator;
mod packages;

use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context, bail, ensure};

use crate::cargo::root;

pub(crate) use consent::VARIABLE;
pub use consent::{ask as agree, assume_yes, is_yes_assumed};
pub use packages::Packages;

use packages::{C_COMPILER, CHRONY, CONSUMERS, EMULATOR, install};

/// Processors that the libraries are compiled for, as the compiler names them; the chip's is first.
pub const TARGETS: [&str; 4] = [
    "thumbv7em-none-eabihf",
    "thumbv6m-none-eabi",
    "thumbv8m.main-none-eabihf",
    "riscv32imac-unknown-none-elf",
];

/// Target of the program of the page for a browser.
pub const PAGE_TARGET: &str = "wasm32-wasip1";

/// A part that the commands need.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Need {
    /// The compiler's libraries for the chip.
    Chip,
    /// The compiler's libraries for the other processors that the module is checked for.
    Processors,
    /// The compiler's library for the program of the page for a browser.
    Page,
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
    /// The parts that are missing.
    pub lacks: Vec<Need>,
    /// True if rustup manages the toolchain.
    pub rustup: bool,
    /// The package manager of the system.
    pub packages: Packages,
}

/// One step of the set-up.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Step {
    /// A command that changes the toolchain or the system.
    Run(Vec<&'static str>),
    /// Debian's packages of the emulator, unpacked below `target`.
    Unpack,
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
        Need::Chip => toolchain(
            &["rustup", "target", "add", TARGETS[0]],
            "install the standard library that rust-toolchain.toml lists, or Rust from https://rustup.rs",
        ),
        Need::Processors => toolchain(
            &["rustup", "target", "add", TARGETS[1], TARGETS[2], TARGETS[3]],
            "install the standard libraries of Cortex-M0+, M33 and RV32, or Rust from https://rustup.rs",
        ),
        Need::Page => toolchain(
            &["rustup", "target", "add", PAGE_TARGET],
            "install the standard library of wasm32-wasip1, or Rust from https://rustup.rs",
        ),
        Need::Components => toolchain(
            &["rustup", "component", "add", "clippy", "rustfmt"],
            "install clippy and rustfmt, or Rust from https://rustup.rs",
        ),
        Need::Emulator if machine.packages.is_debian() => vec![Step::Unpack],
        Need::Emulator => install(&EMULATOR, machine.packages),
        Need::CCompiler => install(&C_COMPILER, machine.packages),
    }
}

impl Machine {
    /// Looks for these parts.
    pub fn look(needs: &[Need]) -> Self {
        // The compiler is only asked if one of its parts is needed.
        let root = needs.iter().any(|need| !matches!(need, Need::Emulator | Need::CCompiler)).then(sysroot);
        let has = |relative: &str| root.iter().flatten().any(|root| root.join(relative).exists());
        let can_compile =
            |targets: &[&str]| targets.iter().all(|name| has(&format!("lib/rustlib/{name}/lib")));
        let is_missing = |need: &&Need| match need {
            Need::Chip => !can_compile(&TARGETS[..1]),
            Need::Processors => !can_compile(&TARGETS[1..]),
            Need::Page => !can_compile(&[PAGE_TARGET]),
            Need::Components => !has("bin/cargo-clippy") || !has("bin/rustfmt"),
            Need::Emulator => !emulator::is_there(),
            Need::CCompiler => !on_path("arm-none-eabi-gcc"),
        };
        Self::lacking(needs.iter().filter(is_missing).copied().collect())
    }

    fn lacking(lacks: Vec<Need>) -> Self {
        // Only looked at if it matters, because the question to `sudo` takes a while.
        let is_packaged = lacks.iter().any(|need| matches!(need, Need::Emulator | Need::CCompiler));
        let packages = if is_packaged { Packages::look() } else { Packages::Unknown };
        Self { lacks, rustup: on_path("rustup"), packages }
    }
}

/// Installs these parts; prints nothing if none is missing.
///
/// # Errors
/// If a step fails, if the user refuses it, or if only the user can take it: the message is then
/// the command to type.
pub fn ensure(needs: &[Need]) -> anyhow::Result<()> {
    let steps = plan(&Machine::look(needs));
    take_all(&steps)?;
    let left = if steps.is_empty() { Vec::new() } else { plan(&Machine::look(needs)) };
    ensure!(left.is_empty(), "the set-up ran, and these steps are still left: {left:?}");
    Ok(())
}

/// Packages of Python that read the module's sentences and messages, run the notebook, and simulate
/// the chip with its clock tree.
const PYTHON_PACKAGES: [&str; 9] = [
    "pynmea2",
    "pymavlink",
    "pyubx2",
    "pysbf2==1.0.7",
    "labwired==0.25.0",
    "numpy",
    "pandas",
    "nbconvert",
    "ipykernel",
];

/// Programs of the system's packages for these tests, as they are called.
const CONSUMER_PROGRAMS: [&str; 8] =
    ["gpsd", "socat", "convbin", "cmake", "pkg-config", "python3", "lintian", "man"];

/// Installs the programs that tests compare the module with or build it by: gpsd, chrony, socat,
/// RTKLIB's `convbin`, `CMake`, the C compiler for the chip with its C library, `lintian` and `man`
/// for the Debian package, the emulator of a processor for the static program, and packages of
/// Python in a folder of their own below `target`. Nothing but tests and `release` needs them.
/// chrony is left out if it would take the place of another package.
///
/// # Errors
/// As [`ensure()`].
pub fn consumers() -> anyhow::Result<()> {
    let python = python_of_consumers();
    let (folder, python) = (root().join("target/consumers"), python.display().to_string());
    let folder = folder.display().to_string();
    let has_emulator = ["qemu-aarch64", "qemu-aarch64-static"].into_iter().any(on_path);
    if !has_emulator || !CONSUMER_PROGRAMS.into_iter().all(on_path) || !has_c_library_of_chip() {
        take_all(&install(&CONSUMERS, Packages::look()))?;
    }
    if !on_path("chronyd")
        && let Err(error) = take_all(&install(&CHRONY, Packages::look()))
    {
        eprintln!("chrony is left out, and tests that need it are skipped: {error:#}");
        eprintln!("If it may replace this machine's own clock daemon: apt-get install chrony");
    }
    run(&["python3", "-m", "venv", &folder])?;
    run(&[&[&python, "-m", "pip", "install", "--quiet"], &PYTHON_PACKAGES[..]].concat())
}

/// Adds the standard library of a target to the toolchain, after a yes, unless it is there.
///
/// # Errors
/// If rustup is missing or fails, or if the user refuses.
pub fn add_target(target: &str) -> anyhow::Result<()> {
    if sysroot().is_some_and(|root| root.join("lib/rustlib").join(target).join("lib").exists()) {
        return Ok(());
    }
    let command = ["rustup", "target", "add", target];
    consent::ask(&[command.join(" ")])?;
    run(&command)
}

/// Returns true if the C compiler for the chip is there with a C library.
fn has_c_library_of_chip() -> bool {
    // The compiler answers with the bare name of a file that it does not find.
    let library = Command::new("arm-none-eabi-gcc").arg("-print-file-name=nosys.specs").output();
    library.is_ok_and(|output| output.stdout.contains(&b'/'))
}

/// Returns the Python that has the consumers' packages: the one that [`consumers`] makes, or the
/// system's.
pub fn python() -> PathBuf {
    let made = python_of_consumers();
    if made.is_file() { made } else { PathBuf::from("python3") }
}

fn python_of_consumers() -> PathBuf {
    root().join("target/consumers/bin/python3")
}

/// Takes the steps, after a yes to those that change the toolchain or the system.
fn take_all(steps: &[Step]) -> anyhow::Result<()> {
    if let Some(words) =
        steps.iter().find_map(|step| if let Step::Ask(words) = step { Some(words) } else { None })
    {
        bail!("a part is missing that only you can install:\n\n    {words}\n");
    }
    let commands =
        steps.iter().filter_map(|step| if let Step::Run(command) = step { Some(command) } else { None });
    let commands: Vec<String> = commands.map(|command| command.join(" ")).collect();
    if !commands.is_empty() {
        consent::ask(&commands)?;
    }
    steps.iter().try_for_each(take)
}

fn take(step: &Step) -> anyhow::Result<()> {
    match step {
        Step::Ask(words) => bail!("a part is missing that only you can install:\n\n    {words}\n"),
        Step::Unpack => emulator::unpack(),
        Step::Run(command) => run(command),
    }
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

/// Returns the folder of the toolchain that this project pins.
fn sysroot() -> Option<PathBuf> {
    let rustc = Command::new("rustc").args(["--print", "sysroot"]).current_dir(root()).output().ok()?;
    Some(PathBuf::from(String::from_utf8(rustc.stdout).ok()?.trim()))
}

/// Returns true if a folder of the path holds the program.
pub fn on_path(program: &str) -> bool {
    let path = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&path).any(|folder| folder.join(program).is_file())
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
    fn fresh_machine_of_debian_installs_no_package_of_the_system() {
        let needs = [Need::Chip, Need::Processors, Need::Page, Need::Components, Need::Emulator];
        let fresh = lacking(&needs, Packages::Apt);
        let [Step::Run(chip), Step::Run(others), Step::Run(page), Step::Run(components), Step::Unpack] =
            &plan(&fresh)[..]
        else {
            panic!("{:?}", plan(&fresh))
        };
        assert_eq!(chip.join(" "), "rustup target add thumbv7em-none-eabihf");
        assert_eq!(others.join(" "), format!("rustup target add {}", TARGETS[1..].join(" ")));
        assert_eq!(page.join(" "), "rustup target add wasm32-wasip1");
        assert_eq!(components.join(" "), "rustup component add clippy rustfmt");
    }

    #[test]
    fn c_compiler_is_installed_without_removals_or_asked_for() {
        let have = plan(&lacking(&[Need::CCompiler], Packages::Apt));
        let Some(Step::Run(command)) = have.last() else { panic!("it must install: {have:?}") };
        assert_eq!(command.last(), Some(&"gcc-arm-none-eabi"));
        assert!(command.contains(&"--no-remove"), "{command:?}");
        for packages in [Packages::AptAsk, Packages::Unknown] {
            let have = plan(&lacking(&[Need::CCompiler], packages));
            let [Step::Ask(words)] = &have[..] else { panic!("it must ask: {have:?}") };
            assert!(words.contains("arm-none-eabi"), "{words}");
        }
    }

    #[test]
    fn user_who_has_to_act_gets_the_exact_command() {
        let steps = plan(&lacking(&[Need::CCompiler], Packages::AptAsk));
        let [Step::Ask(words)] = &steps[..] else { panic!("it must ask: {steps:?}") };
        assert!(words.contains("sudo apt-get install --no-remove"), "{words}");
        assert!(take_all(&steps).expect_err("asking stops").to_string().contains(words));
    }

    #[test]
    fn toolchain_without_rustup_is_left_to_the_user() {
        let machine = Machine { rustup: false, ..lacking(&[Need::Chip], Packages::Unknown) };
        assert!(matches!(plan(&machine)[..], [Step::Ask(_)]));
    }

    #[test]
    fn failed_step_names_its_command() {
        let error = take(&Step::Run(vec!["false", "now"])).expect_err("it fails").to_string();
        assert!(error.contains("`false now` failed"), "{error}");
    }
}
