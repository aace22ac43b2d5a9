//! `rai configure`: switches on the messages that the module reads, in the receiver itself.
//!
//! | receiver | commands |
//! |---|---|
//! | u-blox generation 9 and later | UBX-CFG-VALSET, one key at a time, so that each answer is about one |
//! | u-blox generation 8 | UBX-CFG-MSG for the port that the command arrives at |
//! | Septentrio mosaic | its command line |
//!
//! Each command is answered: ACK or NAK, `$R:` or `$R?`. The report names the refused ones and
//! whether the module can do without them. `--dry-run` prints the commands for people who type
//! themselves.
//!
//! # References
//!
//! - Keys of the configuration: `pyubx2` 1.4.0, `src/pyubx2/ubxtypes_configdb.py`
//!   (`UBX_CONFIG_DATABASE`), and the table `u-blox_config_keys.h` of the `SparkFun` u-blox GNSS
//!   library, version 3, which agree. Both restate u-blox, Interface description ZED-F9P, HPG 1.32.
//! - UBX-CFG-VALSET (06 8A), UBX-CFG-MSG (06 01), UBX-CFG-CFG (06 09), UBX-MON-VER (0A 04),
//!   UBX-ACK-ACK (05 01), UBX-ACK-NAK (05 00): u-blox 8 / M8 Receiver description including
//!   protocol specification; `pyubx2` encodes the frames of the tests.
//! - `setDataInOut`, `setRTCMv3Interval`, `setRTCMv3Output`, `setSBFOutput`: Septentrio, command line reference, as
//!   in the `PolaRx5TR` Reference Guide, firmware 5.5.0.

#[cfg(feature = "commands")]
mod command;
#[cfg(feature = "commands")]
mod dialogue;
mod receivers;
#[cfg_attr(not(feature = "commands"), expect(dead_code, reason = "only the command reads answers"))]
mod ubx;

use anyhow::{Context as _, Result, bail};
use clap::ValueEnum as _;

#[cfg(feature = "commands")]
pub use command::{Arguments, run};

/// Returns the commands that make a receiver send what the module reads: each as a person types it,
/// with its purpose and its bytes. The receiver is named as on the command line, and so is its port
/// that sends.
///
/// # Errors
/// There is no such receiver, or it has no such port.
pub fn steps(receiver: &str, wire: &str) -> Result<Vec<(String, &'static str, Vec<u8>)>> {
    let receiver = receivers::Receiver::from_str(receiver, true).ok().context("there is no such receiver")?;
    let steps = receiver.steps(wire, false)?;
    Ok(steps.iter().map(|step| (step.typed(), step.purpose, step.bytes())).collect())
}

/// Refuses a name of a port that a receiver does not have.
fn checked<'n>(wire: &str, names: &[&'n str]) -> Result<&'n str> {
    match names.iter().find(|name| **name == wire) {
        Some(name) => Ok(name),
        None => bail!("--wire must be one of {}, not {wire}", names.join(", ")),
    }
}
