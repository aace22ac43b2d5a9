//! Stages of the module on the emulated processor: their cost, to the instruction, and their
//! result, to the bit.
//!
//! A [`Bench`] collects requests and runs them all in one run of the measuring image, which reads
//! them from a file of the host and writes its answers to another.
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | instructions | [`Answer::instructions`] | 1; one takes one nanosecond of the emulator's time |
//!
//! Reference: the image's own modules, `rai-firmware/instruments/src/laboratory/`, define the request and
//! answer formats.

use std::path::{Path, PathBuf};
use std::process::{ChildStderr, Command, Stdio};

use anyhow::{Context, Result, ensure};
use raim_core::epoch::Epoch;
use raim_core::frame::Ecef;

use crate::board::Machine;
use crate::image;

pub mod cycles;
pub mod profile;

use cycles::{Code, Cycles, Model};
use profile::Profile;

/// A stage that the image can run. The number is the request's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Snapshot, global test, w-tests, slopes, protection levels.
    Test = 0,
    /// The same with the worst satellite left out and the rest tested again.
    TestWithoutWorst = 1,
    /// Grouping up to a number of satellites.
    Group = 2,
    /// Range consensus with the selection kept.
    Vote = 3,
    /// Range consensus with a new selection.
    Select = 4,
    /// Clock aiding: update and forecast.
    Coast = 5,
    /// Threshold of a policy for a new geometry.
    Policy = 6,
    /// Fix and complete integrity, from satellite positions and ranges.
    Judge = 7,
    /// Bytes of a receiver to raw epoch.
    Decode = 8,
    /// Orbits and clocks.
    Locate = 9,
    /// Atmosphere and sigmas.
    Correct = 10,
    /// Sentences.
    Speak = 11,
    /// Bytes in to bytes out.
    Whole = 12,
    /// ARAIM on a snapshot: tests and levels.
    Separate = 13,
    /// Copies, fills and comparisons of memory, beside plain loops.
    Memory = 14,
    /// Roots by the processor's instruction, beside those of libm.
    Roots = 15,
    /// Fix and complete integrity of 16 satellites on the stack of a thread; the last answer has
    /// the bytes.
    JudgeSixteenInAThread = 16,
    /// The same for as many satellites as the image holds.
    JudgeInAThread = 17,
    /// Slices of the authentication over the pages of a signed sky.
    Authenticate = 18,
    /// Places of single systems.
    Compare = 19,
}

/// Scalar type of the core.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scalar {
    /// `f32`, as on the chip.
    Single = 0,
    /// `f64`.
    Double = 1,
}

/// Answer to a request.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Answer {
    /// Cost in instructions.
    pub instructions: u64,
    /// Result as `Debug` formats it: doubles to their last bit.
    pub result: String,
}

/// Requests to be run together.
#[derive(Clone, Debug, Default)]
pub struct Bench {
    requests: Vec<u8>,
}

impl Bench {
    /// Adds a request with its input.
    pub fn request(&mut self, stage: Stage, scalar: Scalar, input: &[u8]) {
        let length = input.len() as u32 + 2;
        self.requests.extend(length.to_le_bytes());
        self.requests.extend([stage as u8, scalar as u8]);
        self.requests.extend(input);
    }

    /// Runs all requests; returns the answers in their order. A stage over several epochs gives one
    /// answer per epoch.
    ///
    /// # Errors
    /// If the emulator is missing or the image does not finish, because of a panic or an invalid
    /// request.
    pub fn run(&self) -> Result<Vec<Answer>> {
        self.run_on(Machine::Stm32f405)
    }

    /// Runs all requests on a board. A tick of the second one is 40 instructions long, so its
    /// figures are accurate to 40.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn run_on(&self, machine: Machine) -> Result<Vec<Answer>> {
        let folder = Folder::new()?;
        let output =
            self.emulator(&folder, machine, &image::build_laboratory(machine)?)?.output().context(MISSING)?;
        let bytes = std::fs::read(folder.0.join("answers.bin")).unwrap_or_default();
        let answers = answers(&bytes, machine);
        ensure!(
            output.status.success(),
            "the measuring image stopped after {} answers: {}",
            answers.len(),
            String::from_utf8_lossy(&output.stderr).trim()
        );
        Ok(answers)
    }

    /// Profiles the instructions of the `number`th of all epochs in the requests, counted from 0.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn profile(&self, number: usize) -> Result<Profile> {
        self.logged(|image, log| Profile::read(image, log, number))
    }

    /// Bounds the cycles of the `number`th of all epochs in the requests, counted from 0.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn cycles(&self, number: usize) -> Result<Cycles> {
        self.logged(|image, log| {
            let bytes = std::fs::read(image)?;
            let elf = object::File::parse(bytes.as_slice())?;
            let code = Code::of(&elf)?;
            let mut model = Model::new(&code);
            profile::executed(&profile::Map::of(&elf)?, log, number, |address| model.execute(address))?;
            ensure!(model.cycles().instructions > 0, "the stage was never reached");
            Ok(model.cycles())
        })
    }

    /// Runs the requests with a log of every instruction, which `read` takes as far as it wants.
    fn logged<R>(&self, read: impl FnOnce(&Path, ChildStderr) -> Result<R>) -> Result<R> {
        let folder = Folder::new()?;
        let image = image::build_laboratory(Machine::Stm32f405)?;
        let mut emulator = self
            .emulator(&folder, Machine::Stm32f405, &image)?
            .args(["-singlestep", "-d", "exec,nochain"])
            .stderr(Stdio::piped())
            .spawn()
            .context(MISSING)?;
        let log = emulator.stderr.take().context("the emulator has no log")?;
        let have = read(&image, log);
        // The rest of the run is not needed.
        emulator.kill()?;
        emulator.wait()?;
        have
    }

    /// Returns the emulator's command, with the measuring image and the requests in its folder.
    fn emulator(&self, folder: &Folder, machine: Machine, image: &Path) -> Result<Command> {
        std::fs::write(folder.0.join("requests.bin"), &self.requests)?;
        let mut emulator = crate::setup::emulator::command();
        emulator
            .current_dir(&folder.0)
            .args(machine.arguments())
            .args(["-display", "none", "-monitor", "none", "-serial", "none"])
            .args(["-icount", "shift=0", "-semihosting-config", "enable=on,target=native", "-kernel"])
            .arg(image)
            .stdin(Stdio::null());
        Ok(emulator)
    }
}

/// Message if the emulator does not start.
const MISSING: &str = "qemu-system-arm cannot be run (`cargo xtask setup` installs it)";

fn answers(bytes: &[u8], machine: Machine) -> Vec<Answer> {
    let mut rest = bytes;
    let mut answers = Vec::new();
    while let Some((head, tail)) = rest.split_first_chunk::<8>() {
        let [t0, t1, t2, t3, l0, l1, l2, l3] = *head;
        let length = u32::from_le_bytes([l0, l1, l2, l3]) as usize;
        let Some((result, tail)) = tail.split_at_checked(length) else { break };
        answers.push(Answer {
            instructions: machine.instructions(u64::from(u32::from_le_bytes([t0, t1, t2, t3]))),
            result: String::from_utf8_lossy(result).into_owned(),
        });
        rest = tail;
    }
    answers
}

/// Encodes a point for the image.
pub fn point_bytes(point: Ecef) -> Vec<u8> {
    [point.x_m, point.y_m, point.z_m].iter().flat_map(|value| value.to_le_bytes()).collect()
}

/// Encodes an epoch for the image.
pub fn epoch_bytes<const N: usize>(epoch: &Epoch<N>) -> Vec<u8> {
    let mut bytes = epoch.time_s().to_le_bytes().to_vec();
    bytes.push(epoch.observations().len() as u8);
    for observation in epoch.observations() {
        bytes.extend([observation.satellite.constellation() as u8, observation.satellite.number()]);
        bytes.extend(point_bytes(observation.position));
        bytes.extend(observation.range_m.to_le_bytes());
        bytes.extend(observation.sigma_m.to_le_bytes());
    }
    bytes
}

/// A folder that is deleted with the value.
struct Folder(PathBuf);

impl Folder {
    fn new() -> Result<Self> {
        use std::sync::atomic::{AtomicU32, Ordering};
        static NEXT: AtomicU32 = AtomicU32::new(0);
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("rai-laboratory-{}-{number}", std::process::id()));
        std::fs::create_dir_all(&path).with_context(|| format!("cannot create {}", path.display()))?;
        Ok(Self(path))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // If this fails, the folder is where leftovers are deleted anyway.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Returns true if the emulator is installed; otherwise prints that the caller is skipped.
pub use crate::board::is_installed;
