//! The C program that makes calls: compiled strictly, for the host and for the emulated boards, and
//! run.
//!
//! | machine | compiler | library |
//! |---|---|---|
//! | host | gcc, g++, either with sanitisers | of the host, with debug assertions |
//! | STM32F405 | arm-none-eabi-gcc for a Cortex-M4F | of the chip, as it ships |
//! | MPS2 AN500 | the same for a Cortex-M7 with doubles | the same, for that processor |

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, Result, ensure};

use super::calls::{Answer, Calls, answers};
use super::{Kind, Optimised, Processor, WHOLE, folder, library, library_for, library_of, run};
use crate::board::Machine;

/// Warnings that a careful C programmer turns on.
pub const STRICT: [&str; 6] = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror", "-O1"];

/// Libraries of the host's system that the static library needs.
pub const SYSTEM: [&str; 3] = ["-lpthread", "-ldl", "-lm"];

/// Flags that end a program at the first undefined behaviour.
pub const SANITISED: [&str; 3] = ["-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"];

/// Compiler for the boards.
pub const ARM: &str = "arm-none-eabi-gcc";

/// Language of the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Language {
    /// C99.
    C,
    /// C++17.
    Cpp,
}

impl Language {
    const fn flags(self) -> &'static [&'static str] {
        match self {
            Self::C => &["-std=c99", "-x", "c"],
            Self::Cpp => &["-std=c++17", "-x", "c++", "-fno-exceptions", "-fno-rtti"],
        }
    }

    /// Returns the name of a compiler of the language.
    const fn host_compiler(self) -> &'static str {
        match self {
            Self::C => "gcc",
            Self::Cpp => "g++",
        }
    }
}

fn source(name: &str) -> PathBuf {
    folder().join("tests").join(name)
}

fn compiler(name: &str) -> Command {
    let mut command = Command::new(name);
    command.args(STRICT).arg("-I").arg(folder().join("include")).arg("-I").arg(folder().join("tests"));
    command
}

/// Compiles `name` in `language`; returns the object file.
fn object(
    compiler_name: &str,
    language: Language,
    flags: &[&str],
    name: &str,
    out: &Path,
) -> Result<PathBuf> {
    let object = out.join(name).with_extension("o");
    let mut command = compiler(compiler_name);
    command.args(language.flags()).args(flags).arg("-c").arg(source(name)).arg("-o").arg(&object);
    run(&mut command)?;
    Ok(object)
}

/// Makes the calls on the host, in a folder, with the program compiled with further flags.
///
/// # Errors
/// If something does not compile, or the program fails.
pub fn on_host(calls: &Calls, language: Language, flags: &[&str], out: &Path) -> Result<Vec<Answer>> {
    let mut link = Command::new(language.host_compiler());
    link.args(flags).arg("-o").arg(out.join("program"));
    link.arg(object(language.host_compiler(), language, flags, "calls.c", out)?);
    // The machine's own part is C, whatever the language of the program.
    link.arg(object("gcc", Language::C, flags, "host.c", out)?)
        .arg(library(Kind::Static, WHOLE)?)
        .args(SYSTEM);
    run(&mut link)?;
    std::fs::write(out.join("calls.bin"), calls.as_bytes())?;
    run(Command::new(out.join("program")).current_dir(out))?;
    answers(&std::fs::read(out.join("answers.bin"))?)
}

/// Makes the calls on an emulated board, with files in a folder.
///
/// # Errors
/// If something does not compile, the emulator is missing, or the program fails.
pub fn on_board(calls: &Calls, machine: Machine, language: Language, out: &Path) -> Result<Vec<Answer>> {
    run_on(calls, machine, language, &[], &library_for(machine)?, out)
}

/// Makes the calls on the first board, with the smallest library for this many satellites: classic
/// RAIM alone, compiled for size.
///
/// # Errors
/// As [`on_board`].
pub fn classic_on_board(calls: &Calls, satellites: u8, out: &Path) -> Result<Vec<Answer>> {
    let (feature, definition) = match satellites {
        48 => ("satellites-48", "-DRAI_SATELLITES=48"),
        32 => ("satellites-32", "-DRAI_SATELLITES_32"),
        _ => ("", "-DRAI_SATELLITES_16"),
    };
    let library = library_of(feature, Optimised::Size, Processor::OfBoards)?;
    run_on(calls, Machine::Stm32f405, Language::C, &["-DMONITOR_ALONE", definition], &library, out)
}

fn run_on(
    calls: &Calls,
    machine: Machine,
    language: Language,
    definitions: &[&str],
    library: &Path,
    out: &Path,
) -> Result<Vec<Answer>> {
    let (processor, memory) = match machine {
        Machine::Stm32f405 => (["-mcpu=cortex-m4", "-mfpu=fpv4-sp-d16"], "stm32f405"),
        Machine::Mps2An500 => (["-mcpu=cortex-m7", "-mfpu=fpv5-d16"], "mps2_an500"),
    };
    let mut flags = vec!["-mthumb", "-mfloat-abi=hard", "-ffreestanding"];
    flags.extend(processor);
    let mut link = Command::new(ARM);
    link.args(&flags).args(["-nostdlib", "-Wl,--gc-sections", "-o"]).arg(out.join("program"));
    flags.extend(definitions);
    link.arg(object(ARM, language, &flags, "calls.c", out)?);
    link.arg(object(ARM, Language::C, &flags, "board.c", out)?);
    link.arg("-T").arg(source("board.ld"));
    link.arg("-L").arg(folder().join("../.."));
    link.arg("-L").arg(folder().join("../boards").join(memory));
    link.arg(library).arg("-lgcc");
    run(&mut link)?;
    std::fs::write(out.join("calls.bin"), calls.as_bytes())?;
    let mut emulator = crate::setup::emulator::command();
    emulator.current_dir(out).args(machine.arguments());
    emulator.args(["-display", "none", "-monitor", "none", "-serial", "none"]);
    emulator.args(["-semihosting-config", "enable=on,target=native", "-kernel", "program"]);
    run(&mut emulator).context("the program on the board")?;
    let answers = answers(&std::fs::read(out.join("answers.bin"))?)?;
    ensure!(!answers.is_empty(), "the program on the board answered nothing");
    Ok(answers)
}
