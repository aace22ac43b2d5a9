//! The receivers, and the commands that make each of them send what the module reads.

use std::fmt;

use anyhow::Result;

use super::checked;
use super::ubx::{self, CFG_CFG, CFG_MSG, CFG_VALSET, Identity};

/// Kind of receiver.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum Receiver {
    /// u-blox generation 8: M8T
    Ublox8,
    /// u-blox generation 9: F9P, F9R, F9T; M9 has no raw ranges
    Ublox9,
    /// u-blox generation 10: M10 has no raw ranges
    Ublox10,
    /// u-blox X20
    X20,
    /// Septentrio mosaic, by RTCM 3
    Mosaic,
    /// Septentrio mosaic, by SBF: with navigation bits and its reports of interference
    MosaicSbf,
}

impl fmt::Display for Receiver {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Ublox8 => "u-blox generation 8",
            Self::Ublox9 => "u-blox generation 9",
            Self::Ublox10 => "u-blox generation 10",
            Self::X20 => "u-blox X20",
            Self::Mosaic => "Septentrio mosaic",
            Self::MosaicSbf => "Septentrio mosaic by SBF",
        })
    }
}

/// Need of the module for a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Need {
    /// Without it there are no ranges or no orbits.
    Ranges,
    /// Without it the module works, with less.
    Extra,
}

/// A command, as bytes, with the form of its answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Command {
    /// UBX, answered by ACK-ACK or ACK-NAK with its identity.
    Ubx(Identity, Vec<u8>),
    /// A line of a mosaic, answered by `$R:` or `$R?`.
    Line(String),
}

/// One command with its meaning.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Step {
    pub(super) name: String,
    pub(super) purpose: &'static str,
    pub(super) need: Need,
    pub(super) command: Command,
}

impl Step {
    /// Returns the bytes of the command.
    pub(super) fn bytes(&self) -> Vec<u8> {
        match &self.command {
            Command::Ubx(identity, payload) => ubx::frame(*identity, payload),
            Command::Line(line) => format!("{line}\r\n").into_bytes(),
        }
    }

    /// Returns the command as a person types it: a line, or a setting with its frame.
    pub(super) fn typed(&self) -> String {
        match &self.command {
            Command::Line(line) => line.clone(),
            Command::Ubx(..) => {
                let bytes: Vec<_> = self.bytes().iter().map(|byte| format!("{byte:02X}")).collect();
                format!("{}\n    {}\n   ", self.name, bytes.join(" "))
            }
        }
    }
}

/// Messages of a u-blox receiver: name, identity, the key of the rate on UART1, purpose and need.
/// The keys of UART2 and USB follow that of UART1.
const MESSAGES: [(&str, Identity, u32, &str, Need); 4] = [
    ("RXM_RAWX", (0x02, 0x15), 0x2091_02A5, "ranges of every epoch", Need::Ranges),
    ("RXM_SFRBX", (0x02, 0x13), 0x2091_0232, "navigation bits: ephemerides", Need::Ranges),
    ("NAV_STATUS", (0x01, 0x03), 0x2091_001B, "the receiver's word on spoofing", Need::Extra),
    ("SEC_SIG", (0x27, 0x09), 0x2091_0635, "the receiver's word on jamming and spoofing", Need::Extra),
];

/// Ports of a u-blox receiver: name, distance of its keys from those of UART1, and the key of UBX
/// on its output.
const WIRES: [(&str, u32, u32); 3] =
    [("UART1", 0, 0x1074_0001), ("UART2", 1, 0x1076_0001), ("USB", 2, 0x1078_0001)];

/// Ports of a mosaic.
const MOSAIC_WIRES: [&str; 6] = ["COM1", "COM2", "COM3", "COM4", "USB1", "USB2"];

/// Layers of UBX-CFG-VALSET: in force now, and kept in battery-backed memory and in flash.
const NOW: u8 = 1;
const KEPT: u8 = 7;

/// Sections of UBX-CFG-CFG that are kept: ports and messages.
const PORTS_AND_MESSAGES: u8 = 3;

impl Receiver {
    /// Returns the commands for one port of the receiver.
    ///
    /// # Errors
    /// If the receiver has no port of this name.
    pub(super) fn steps(self, wire: &str, keep: bool) -> Result<Vec<Step>> {
        match self {
            Self::Ublox8 => {
                checked(wire, &WIRES.map(|(name, ..)| name))?;
                Ok(by_message(keep))
            }
            Self::Ublox9 | Self::Ublox10 | Self::X20 => {
                let name = checked(wire, &WIRES.map(|(name, ..)| name))?;
                Ok(by_key(name, if keep { KEPT } else { NOW }))
            }
            Self::Mosaic => Ok(kept(by_line(checked(wire, &MOSAIC_WIRES)?), keep)),
            Self::MosaicSbf => Ok(kept(by_block(checked(wire, &MOSAIC_WIRES)?), keep)),
        }
    }
}

/// Returns the commands of generation 8. SEC-SIG is younger.
fn by_message(keep: bool) -> Vec<Step> {
    let older = MESSAGES.iter().filter(|(name, ..)| *name != "SEC_SIG");
    let mut steps: Vec<_> = older
        .map(|(name, (class, id), _, purpose, need)| Step {
            name: format!("CFG-MSG {name} 1"),
            purpose,
            need: *need,
            command: Command::Ubx(CFG_MSG, vec![*class, *id, 1]),
        })
        .collect();
    if keep {
        // Clear nothing, save, load nothing.
        let masks = vec![0, 0, 0, 0, PORTS_AND_MESSAGES, 0, 0, 0, 0, 0, 0, 0];
        steps.push(Step {
            name: "CFG-CFG save".into(),
            purpose: "keeps the settings without power",
            need: Need::Extra,
            command: Command::Ubx(CFG_CFG, masks),
        });
    }
    steps
}

/// Returns the commands of generation 9 and later.
fn by_key(wire: &str, layers: u8) -> Vec<Step> {
    let Some((_, distance, output)) = WIRES.iter().find(|(name, ..)| *name == wire) else {
        return Vec::new();
    };
    let set = |name: String, key: u32, purpose, need| {
        // Version 0, layers, two reserved bytes, then key and value.
        let mut payload = vec![0, layers, 0, 0];
        payload.extend(key.to_le_bytes());
        payload.push(1);
        Step { name, purpose, need, command: Command::Ubx(CFG_VALSET, payload) }
    };
    let first = set(format!("CFG-{wire}OUTPROT-UBX = 1"), *output, "UBX on the port", Need::Ranges);
    let messages = MESSAGES.iter().map(|(name, _, key, purpose, need)| {
        set(format!("CFG-MSGOUT-UBX_{name}_{wire} = 1"), key + distance, purpose, *need)
    });
    std::iter::once(first).chain(messages).collect()
}

/// Returns a line of a mosaic.
fn line(line: String, purpose: &'static str, need: Need) -> Step {
    Step { name: line.clone(), purpose, need, command: Command::Line(line) }
}

/// Returns the lines of a mosaic for RTCM 3.
fn by_line(wire: &str) -> Vec<Step> {
    const EPHEMERIDES: &str = "RTCM1019+RTCM1020+RTCM1042+RTCM1044+RTCM1045+RTCM1046";
    let line = |words, purpose| line(words, purpose, Need::Ranges);
    vec![
        line(format!("setDataInOut, {wire}, , +RTCMv3"), "RTCM 3 on the port"),
        line("setRTCMv3Interval, MSM7, 1".into(), "ranges every second"),
        line(format!("setRTCMv3Interval, {EPHEMERIDES}, 1"), "one ephemeris every second"),
        line(format!("setRTCMv3Output, {wire}, MSM7+{EPHEMERIDES}"), "ranges and ephemerides"),
    ]
}

/// Returns the lines of a mosaic for SBF. A refused block refuses its whole line, so that blocks of
/// newer firmware have lines of their own.
fn by_block(wire: &str) -> Vec<Step> {
    let stream = |number, blocks, interval, purpose, need| {
        line(format!("setSBFOutput, Stream{number}, {wire}, {blocks}, {interval}"), purpose, need)
    };
    vec![
        line(format!("setDataInOut, {wire}, , +SBF"), "SBF on the port", Need::Ranges),
        stream(1, "MeasEpoch", "sec1", "ranges every second", Need::Ranges),
        stream(
            2,
            "GPSRawCA+GLORawCA+GALRawINAV+GALRawFNAV+BDSRaw+QZSRawL1CA",
            "OnChange",
            "navigation bits: ephemerides",
            Need::Ranges,
        ),
        stream(3, "DOP", "sec1", "the receiver's own protection levels", Need::Extra),
        stream(4, "RFStatus", "sec1", "the receiver's word on jamming and spoofing", Need::Extra),
        stream(5, "GALAuthStatus", "sec1", "the receiver's word on authentic satellites", Need::Extra),
    ]
}

/// Adds the line that keeps the settings of a mosaic without power, if they are to be kept.
fn kept(mut steps: Vec<Step>, keep: bool) -> Vec<Step> {
    if keep {
        steps.push(line("exeCopyConfigFile, Current, Boot".into(), "keeps the settings", Need::Extra));
    }
    steps
}
