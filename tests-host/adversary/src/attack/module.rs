//! The module under attack: in process, or with the parts of the image `small` in a program of its
//! own.
//!
//! Cargo joins the features of all packages that it builds together, so that the small module
//! cannot be in this program beside the whole one ([`small_module`]).

use std::io::{BufReader, BufWriter};
use std::path::PathBuf;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::OnceLock;

use anyhow::{Context as _, Result};
use raim_core::internals::velocity::Velocity;
use raim_firmware::input::Suspicion;
use raim_firmware::osnma::Summary;
use raim_firmware::pin::MemoryPin;
use raim_firmware::receiver::{Boot, Receiver};
use raim_firmware::settings::SEALED_BYTES;
use small_module::{Answer, Kind, Request};

/// Program of the small module, if that is attacked.
static SMALL: OnceLock<PathBuf> = OnceLock::new();

/// Attacks the small module from now on, by its program.
pub fn attack_small(program: PathBuf) {
    SMALL.get_or_init(|| program);
}

/// Returns true if the small module is attacked.
pub(super) fn is_small() -> bool {
    SMALL.get().is_some()
}

/// A module that receives bytes and says sentences.
#[allow(clippy::large_enum_variant, reason = "thousands of victims are of the large kind")]
pub(super) enum Module {
    /// The whole module, in process.
    Whole(Receiver<MemoryPin>),
    /// The small module, in a program.
    Small(Small),
}

impl Module {
    /// Returns a module that has received nothing.
    pub(super) fn start() -> Result<Self> {
        match SMALL.get() {
            Some(program) => Ok(Self::Small(Small::start(program)?)),
            None => Ok(Self::Whole(whole()?)),
        }
    }

    /// Sends bytes to the host port and returns what the module says.
    pub(super) fn command(&mut self, bytes: &[u8]) -> Result<Vec<u8>> {
        let mut reported = Vec::new();
        match self {
            Self::Whole(receiver) => receiver.command(bytes, &mut reported),
            Self::Small(small) => return small.ask(Kind::Command, 0, bytes),
        }
        Ok(reported)
    }

    /// Sends bytes to the GNSS port and returns what the module says.
    pub(super) fn gnss(&mut self, bytes: &[u8], now_ms: u64) -> Result<Vec<u8>> {
        let mut reported = Vec::new();
        match self {
            Self::Whole(receiver) => receiver.gnss(bytes, now_ms, &mut reported),
            Self::Small(small) => return small.ask(Kind::Gnss, now_ms, bytes),
        };
        Ok(reported)
    }

    /// Tells the time and returns what the module says.
    pub(super) fn tick(&mut self, now_ms: u64) -> Result<Vec<u8>> {
        let mut reported = Vec::new();
        match self {
            Self::Whole(receiver) => receiver.tick(now_ms, &mut reported),
            Self::Small(small) => return small.ask(Kind::Tick, now_ms, &[]),
        };
        Ok(reported)
    }

    /// Seals the settings in a memory.
    pub(super) fn seal(&mut self, memory: &mut [u8; SEALED_BYTES]) -> Result<()> {
        match self {
            Self::Whole(receiver) => receiver.seal(memory),
            Self::Small(small) => *memory = small.ask_for_memory(Kind::Seal, memory)?,
        }
        Ok(())
    }

    /// Starts anew from a memory, without a power cycle, and then seals the settings as a board
    /// does.
    pub(super) fn restart(&mut self, memory: &mut [u8; SEALED_BYTES]) -> Result<()> {
        match self {
            Self::Whole(receiver) => {
                *receiver = whole()?;
                receiver.restore(memory, false);
                receiver.seal(memory);
            }
            Self::Small(small) => *memory = small.ask_for_memory(Kind::Restart, memory)?,
        }
        Ok(())
    }

    /// Returns the hash of the settings in force.
    pub(super) fn settings_hash(&mut self) -> Result<u32> {
        match self {
            Self::Whole(receiver) => Ok(receiver.configuration().hash()),
            Self::Small(small) => small.ask_for_number(Kind::Hash, &[]),
        }
    }

    /// Returns a counter, or 0 if no counter has this name.
    pub(super) fn counter(&mut self, name: &str) -> Result<u32> {
        match self {
            Self::Whole(receiver) => {
                let found = receiver.statistics().find(|(counter, _)| *counter == name);
                Ok(found.map_or(0, |(_, count)| count))
            }
            Self::Small(small) => small.ask_for_number(Kind::Counter, name.as_bytes()),
        }
    }

    /// Returns true while the pin is high.
    pub(super) fn is_promised(&self) -> bool {
        match self {
            Self::Whole(receiver) => receiver.pin().high,
            Self::Small(small) => small.is_promised,
        }
    }

    /// Returns the current state of spoofing detection. The small module does not read the messages
    /// that report it.
    pub(super) fn spoofing(&self) -> Suspicion {
        match self {
            Self::Whole(receiver) => receiver.interference().1,
            Self::Small(_) => Suspicion::Unknown,
        }
    }

    /// Returns what is known of the authentication. The small module has none.
    pub(super) fn authentication(&self) -> Option<Summary> {
        match self {
            Self::Whole(receiver) => receiver.authentication().copied(),
            Self::Small(_) => None,
        }
    }

    /// Returns the velocity of the last epoch, if there is one. The small module computes none.
    pub(super) fn velocity(&self) -> Option<&Velocity> {
        match self {
            Self::Whole(receiver) => receiver.velocity(),
            Self::Small(_) => None,
        }
    }
}

/// Returns a whole module that has received nothing.
fn whole() -> Result<Receiver<MemoryPin>> {
    Receiver::new(MemoryPin::default(), Boot::on_host("attack")).context("the module cannot start")
}

/// The small module in a program, which ends with it.
pub(super) struct Small {
    program: Child,
    requests: BufWriter<ChildStdin>,
    answers: BufReader<ChildStdout>,
    is_promised: bool,
}

impl Small {
    fn start(path: &PathBuf) -> Result<Self> {
        let mut program = Command::new(path)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .with_context(|| format!("{} cannot be run", path.display()))?;
        let requests = BufWriter::new(program.stdin.take().context("the program has no input")?);
        let answers = BufReader::new(program.stdout.take().context("the program has no output")?);
        Ok(Self { program, requests, answers, is_promised: false })
    }

    fn ask(&mut self, kind: Kind, now_ms: u64, bytes: &[u8]) -> Result<Vec<u8>> {
        let failed = "the program of the small module has ended";
        Request { kind, now_ms, bytes: bytes.to_vec() }.write(&mut self.requests).context(failed)?;
        let answer = Answer::read(&mut self.answers).context(failed)?;
        self.is_promised = answer.is_promised;
        Ok(answer.bytes)
    }

    fn ask_for_number(&mut self, kind: Kind, bytes: &[u8]) -> Result<u32> {
        let answer = self.ask(kind, 0, bytes)?;
        Ok(u32::from_le_bytes(answer.as_slice().try_into().context("the answer is no number")?))
    }

    fn ask_for_memory(&mut self, kind: Kind, memory: &[u8; SEALED_BYTES]) -> Result<[u8; SEALED_BYTES]> {
        let answer = self.ask(kind, 0, memory)?;
        answer.as_slice().try_into().context("the memory has another length")
    }
}

impl Drop for Small {
    fn drop(&mut self) {
        // It waits for requests and holds nothing.
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}
