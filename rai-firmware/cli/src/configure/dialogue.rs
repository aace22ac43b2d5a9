//! Commands and their answers, among everything else that a receiver sends.

use std::io::{ErrorKind, Read, Write};
use std::time::{Duration, Instant};

use anyhow::{Context as _, Result};

use super::receivers::{Command, Receiver, Step};
use super::ubx::{self, ACK_ACK, ACK_NAK, Identity, MON_VER};

/// Longest wait for an answer. A receiver answers within a second, behind what it is sending.
const PATIENCE: Duration = Duration::from_secs(2);

/// Most bytes that wait for the rest of an answer.
const MOST: usize = 16 * 1024;

/// Answer to a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Answer {
    Accepted,
    Refused,
    /// No answer came.
    Missing,
}

impl Answer {
    pub(super) const fn word(self) -> &'static str {
        match self {
            Self::Accepted => "accepted",
            Self::Refused => "REFUSED",
            Self::Missing => "no answer",
        }
    }
}

/// Sends a command and waits for its answer.
///
/// # Errors
/// If the port fails.
pub(super) fn ask(port: &mut (impl Read + Write), step: &Step) -> Result<Answer> {
    send(port, &step.bytes())?;
    let answer = match &step.command {
        Command::Ubx(identity, _) => wait(port, |bytes| acknowledged(bytes, *identity))?,
        Command::Line(_) => wait(port, |bytes| replied(bytes))?,
    };
    Ok(answer.unwrap_or(Answer::Missing))
}

/// Asks a u-blox receiver for its generation.
///
/// # Errors
/// If the port fails, nothing answers, or the receiver is not known.
pub(super) fn identify(port: &mut (impl Read + Write)) -> Result<Receiver> {
    send(port, &ubx::frame(MON_VER, &[]))?;
    let version = wait(port, |bytes| {
        std::iter::from_fn(|| ubx::take(bytes)).find(|(identity, _)| *identity == MON_VER)
    })?;
    let (_, payload) = version.context(
        "the receiver does not answer UBX-MON-VER: check the port and its rate, or name it by --receiver",
    )?;
    let text = String::from_utf8_lossy(&payload).replace('\0', " ");
    generation(&payload)
        .with_context(|| format!("the receiver must be named by --receiver; it calls itself {}", text.trim()))
}

/// Returns the receiver that a version describes: 30 bytes of software, 10 of hardware, and
/// extensions of 30 bytes.
fn generation(payload: &[u8]) -> Option<Receiver> {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).trim_end_matches('\0').to_owned();
    let extensions = payload.get(40..).unwrap_or_default();
    if extensions.chunks(30).map(text).any(|line| line.starts_with("MOD=") && line.contains("X20")) {
        return Some(Receiver::X20);
    }
    match text(payload.get(30..40)?).as_str() {
        "00080000" => Some(Receiver::Ublox8),
        "00190000" => Some(Receiver::Ublox9),
        "000A0000" => Some(Receiver::Ublox10),
        _ => None,
    }
}

fn send(port: &mut (impl Read + Write), bytes: &[u8]) -> Result<()> {
    port.write_all(bytes).context("the receiver does not take the command")?;
    port.flush().context("the receiver does not take the command")
}

/// Reads until `find` finds its answer or the patience ends.
fn wait<A>(
    port: &mut (impl Read + Write),
    mut find: impl FnMut(&mut Vec<u8>) -> Option<A>,
) -> Result<Option<A>> {
    let start = Instant::now();
    let (mut bytes, mut chunk) = (Vec::new(), [0; 1024]);
    while start.elapsed() < PATIENCE {
        match port.read(&mut chunk) {
            Ok(0) => return Ok(None),
            Ok(count) => {
                bytes.extend(chunk.get(..count).unwrap_or_default());
                if let Some(answer) = find(&mut bytes) {
                    return Ok(Some(answer));
                }
                if bytes.len() > MOST {
                    bytes.drain(..bytes.len() - MOST);
                }
            }
            Err(error) if is_timeout(error.kind()) => {}
            Err(error) => return Err(error).context("the port fails"),
        }
    }
    Ok(None)
}

const fn is_timeout(kind: ErrorKind) -> bool {
    matches!(kind, ErrorKind::TimedOut | ErrorKind::WouldBlock | ErrorKind::Interrupted)
}

/// Finds the acknowledgement of a command. Those of other commands are passed over.
fn acknowledged(bytes: &mut Vec<u8>, command: Identity) -> Option<Answer> {
    std::iter::from_fn(|| ubx::take(bytes)).find_map(|(identity, payload)| {
        let answer = match identity {
            ACK_ACK => Answer::Accepted,
            ACK_NAK => Answer::Refused,
            _ => return None,
        };
        (payload == [command.0, command.1]).then_some(answer)
    })
}

/// Finds the reply of a mosaic: `$R:` repeats an accepted command, `$R?` begins the reason of a
/// refusal.
fn replied(bytes: &[u8]) -> Option<Answer> {
    bytes.windows(3).find_map(|window| match window {
        b"$R:" => Some(Answer::Accepted),
        b"$R?" => Some(Answer::Refused),
        _ => None,
    })
}
