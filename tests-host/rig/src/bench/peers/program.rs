//! A peer as a program for the emulated boards: compiled with newlib and run over the epochs; its
//! answers are read back.
//!
//! | part | place |
//! |---|---|
//! | start-up, stopwatch, answers | `tests-host/peers/board.c`, `board.ld` |
//! | the call of the peer | `tests-host/peers/libswiftnav.c`, `rtklib.c` |
//! | epochs and starts | `epochs.h`, generated |
//! | instructions of a tick | 40: one each nanosecond, 25 MHz |

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};
use raim_core::frame::Ecef;

use super::sources::Sources;
use super::{Core, FAULTS, Outcome, Row, SATELLITES, Start, epoch, error_m};
use crate::capi::program::ARM;
use crate::capi::run;

/// Instructions of a tick of the boards' system timer: a nanosecond each, at 25 MHz.
const INSTRUCTIONS_OF_TICK: u64 = 40;

/// Compiler flags of every file. The peers' own warnings are ignored.
const FLAGS: [&str; 8] = [
    "-O2",
    "-mthumb",
    "-mfloat-abi=hard",
    "-ffunction-sections",
    "-fdata-sections",
    "-DNDEBUG",
    "-w",
    "-nostartfiles",
];

/// A peer, and how it is built.
pub(super) struct Peer {
    pub(super) name: &'static str,
    pub(super) setting: &'static str,
    /// File that calls the peer.
    shim: &'static str,
    /// Further arguments of the compiler.
    flags: &'static [&'static str],
    /// Sources of the peer that are compiled separately.
    files: &'static [&'static str],
    /// Starting points that the peer accepts.
    starts: &'static [Start],
    folder: fn(&Sources) -> &Path,
}

/// Adds `BeiDou` to the constellations that RTKLIB is compiled with.
const BEIDOU: &str = "-DENACMP";
/// Initialises variables to zero. The first pass of RTKLIB's `rescode` reads delays and variances
/// of the atmosphere that were never set. With zeros it does what was intended, at a cost of less
/// than 1 %; otherwise its answer depends on the compiler. GCC has this flag since version 12.
const UNSET_IS_ZERO: &str = "-ftrivial-auto-var-init=zero";

const RTKLIB: Peer = Peer {
    name: "RTKLIB 2.4.3 b34",
    setting: "double precision, without its calls of `trace`",
    shim: "rtklib.c",
    flags: &[BEIDOU, UNSET_IS_ZERO],
    files: &["src/rtkcmn.c"],
    starts: &Start::ALL,
    folder: |sources| &sources.rtklib,
};

/// All peers.
pub(super) const PEERS: [Peer; 3] = [
    Peer {
        name: "libswiftnav",
        setting: "double precision",
        shim: "libswiftnav.c",
        flags: &[],
        files: &[
            "src/single_epoch_solver.c",
            "src/linear_algebra.c",
            "src/coord_system.c",
            "src/sid_set.c",
            "src/signal.c",
            "src/gnss_time.c",
            "src/nav_meas.c",
            "src/bits.c",
            "src/glo_map.c",
            "src/logging.c",
            "src/logging_common.c",
        ],
        starts: &[Start::Centre],
        folder: |sources| &sources.libswiftnav,
    },
    RTKLIB,
    Peer {
        setting: "double precision, as it comes",
        flags: &[BEIDOU, UNSET_IS_ZERO, "-DWITH_TRACE_CALLS"],
        ..RTKLIB
    },
];

/// Returns the compiler and its version.
pub(super) fn compiler() -> Result<String> {
    let version = run(Command::new(ARM).arg("-dumpfullversion"))?;
    Ok(format!("{ARM} {}", String::from_utf8_lossy(&version).trim()))
}

/// Compiles and runs a peer.
///
/// # Errors
/// If it does not compile, or does not finish.
pub(super) fn measure(peer: &Peer, sources: &Sources, core: Core) -> Result<Vec<Row>> {
    let folder = tempfile::tempdir()?;
    std::fs::write(folder.path().join("epochs.h"), epochs()?)?;
    // libswiftnav's build would generate this from a template.
    std::fs::write(folder.path().join("max_channels.h"), "#define MAX_CHANNELS 63\n")?;
    let answers = emulate(&compile(peer, sources, core, folder.path())?, core, folder.path())?;
    let outcomes = answers.lines().map(outcome).collect::<Result<Vec<_>>>().context(peer.name)?;
    ensure!(outcomes.len() == FAULTS.len() * Start::ALL.len(), "{}: {} answers", peer.name, outcomes.len());
    let row = |(start, outcomes): (Start, &[Outcome])| Row {
        program: peer.name,
        setting: peer.setting,
        core,
        start,
        outcomes: outcomes.to_vec(),
    };
    let rows = Start::ALL.into_iter().zip(outcomes.chunks(FAULTS.len()));
    Ok(rows.filter(|(start, _)| peer.starts.contains(start)).map(row).collect())
}

/// Returns the C table of starts and epochs. Doubles have as many digits as they need.
fn epochs() -> Result<String> {
    let mut text = String::from("static const double STARTS_M[][3] = {\n");
    for start in Start::ALL {
        writeln!(text, "    {},", braces(start.position()))?;
    }
    text.push_str("};\nstatic const struct epoch EPOCHS[] = {\n");
    for faults in FAULTS {
        let epoch = epoch(faults)?;
        ensure!(
            epoch.observations().len() == SATELLITES,
            "an epoch of the peers must have {SATELLITES} satellites"
        );
        text.push_str("    {{\n");
        for one in epoch.observations() {
            let (letter, number) = (one.satellite.constellation().letter(), one.satellite.number());
            let (position, range_m, sigma_m) = (braces(one.position), one.range_m, one.sigma_m);
            writeln!(text, "        {{'{letter}', {number}, {position}, {range_m:?}, {sigma_m:?}}},")?;
        }
        text.push_str("    }},\n");
    }
    text.push_str("};\n");
    Ok(text)
}

fn braces(point: Ecef) -> String {
    format!("{{{:?}, {:?}, {:?}}}", point.x_m, point.y_m, point.z_m)
}

fn compile(peer: &Peer, sources: &Sources, core: Core, out: &Path) -> Result<PathBuf> {
    let ours = Path::new(env!("CARGO_MANIFEST_DIR")).join("../peers");
    let theirs = (peer.folder)(sources);
    let image = out.join("peer.elf");
    let mut gcc = Command::new(ARM);
    gcc.args(FLAGS).args(peer.flags).args(match core {
        Core::M4 => ["-mcpu=cortex-m4", "-mfpu=fpv4-sp-d16"],
        Core::M7 => ["-mcpu=cortex-m7", "-mfpu=fpv5-d16"],
    });
    for include in [out, &ours, &ours.join("posix"), &theirs.join("include"), &theirs.join("src")] {
        gcc.arg("-I").arg(include);
    }
    gcc.args([ours.join("board.c"), ours.join(peer.shim)]);
    gcc.args(peer.files.iter().map(|file| theirs.join(file)));
    gcc.arg("-T").arg(ours.join("board.ld"));
    gcc.args(["-Wl,--gc-sections", "--specs=nosys.specs", "-lm", "-o"]).arg(&image);
    run(&mut gcc).with_context(|| format!("{} does not compile", peer.name))?;
    Ok(image)
}

/// Runs the image; returns the text that it wrote to its file.
fn emulate(image: &Path, core: Core, folder: &Path) -> Result<String> {
    let mut emulator = crate::setup::emulator::command();
    emulator.current_dir(folder).args(match core {
        Core::M4 => ["-machine", "mps2-an386", "-cpu", "cortex-m4"],
        Core::M7 => ["-machine", "mps2-an500", "-cpu", "cortex-m7"],
    });
    emulator.args(["-display", "none", "-monitor", "none", "-serial", "none", "-icount", "shift=0"]);
    emulator.args(["-semihosting-config", "enable=on,target=native", "-kernel"]).arg(image);
    run(&mut emulator).context("a peer did not finish in the emulator")?;
    Ok(std::fs::read_to_string(folder.join("answers.txt"))?)
}

/// Parses a line of `board.c`: ticks, the peer's own code, validity of the position, its bits,
/// names.
fn outcome(line: &str) -> Result<Outcome> {
    let mut words = line.split(' ');
    let mut word = || words.next().with_context(|| format!("the answer the answer `{line}` is too short"));
    let ticks: u64 = word()?.parse()?;
    let _code = word()?;
    let is_valid = word()? == "1";
    let mut coordinate = || -> Result<f64> { Ok(f64::from_bits(u64::from_str_radix(word()?, 16)?)) };
    let position = Ecef::new(coordinate()?, coordinate()?, coordinate()?);
    let left_out = words.map(str::to_owned).collect();
    let error_m = is_valid.then(|| error_m(position));
    Ok(Outcome { instructions: ticks * INSTRUCTIONS_OF_TICK, error_m, left_out })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn line_of_the_board_is_an_outcome() {
        let site = super::super::workload::site().position;
        let bits = [site.x_m, site.y_m, site.z_m].map(|value| format!("{:016x}", value.to_bits()));
        let [x, y, z] = bits;
        let have = outcome(&format!("1000 1 1 {x} {y} {z} G03 C12")).expect("a line");
        let left_out = vec!["G03".to_owned(), "C12".to_owned()];
        assert_eq!(have, Outcome { instructions: 40_000, error_m: Some(0.0), left_out });
        let refused = outcome(&format!("7 -4 0 {x} {y} {z}")).expect("a line");
        assert_eq!((refused.error_m, refused.to_string()), (None, "refused".to_owned()));
    }

    #[test]
    fn line_that_ends_too_early_is_named() {
        assert!(format!("{:#}", outcome("12 0 1 00").expect_err("too short")).contains("12 0 1 00"));
    }
}
