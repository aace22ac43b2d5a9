//! The board's log: frames of the log port, read with the table in the image.

use std::io::Read;
use std::net::TcpStream;
use std::sync::mpsc::{Receiver, Sender, channel};

use anyhow::Context;
use defmt_decoder::{DecodeError, Frame, Table};

/// One line of the log.
#[derive(Clone, Debug, PartialEq)]
pub struct LogLine {
    /// Seconds since the board's start.
    pub time_s: f64,
    /// `info`, `warn`, `error`…
    pub level: String,
    /// The message.
    pub text: String,
}

impl LogLine {
    fn of(frame: &Frame<'_>) -> Self {
        Self {
            time_s: frame
                .display_timestamp()
                .and_then(|time| time.to_string().parse().ok())
                .unwrap_or(f64::NAN),
            level: frame.level().map_or("", |level| level.as_str()).to_owned(),
            text: frame.display_message().to_string(),
        }
    }

    /// The level that this line tells of the integrity pin. A start tells of a low pin: start-up drives it so.
    pub fn pin_level(&self) -> Option<bool> {
        match self.text.as_str() {
            "integrity pin high" => Some(true),
            "integrity pin low" => Some(false),
            text if text.starts_with("start:") => Some(false),
            _ => None,
        }
    }

    /// The ticks of the core clock that this line tells for an epoch.
    pub fn epoch_ticks(&self) -> Option<u64> {
        let (_, ticks) = self.text.strip_prefix("epoch ")?.strip_suffix(" ticks")?.split_once(" took ")?;
        ticks.parse().ok()
    }

    /// The bytes that this line tells the stack has reached.
    pub fn stack_bytes(&self) -> Option<u64> {
        self.text.strip_prefix("stack high water ")?.strip_suffix(" bytes")?.parse().ok()
    }
}

/// The table that turns the image's frames into text.
pub(super) fn table(elf: &[u8]) -> anyhow::Result<Table> {
    Table::parse(elf).context("the image's log table cannot be read")?.context("the image has no log table")
}

/// Reads the log in a thread that ends with the port.
pub(super) fn follow(port: TcpStream, table: Table) -> Receiver<LogLine> {
    let (sender, lines) = channel();
    std::thread::spawn(move || read(port, &table, &sender));
    lines
}

fn read(mut port: TcpStream, table: &Table, sender: &Sender<LogLine>) {
    let mut decoder = table.new_stream_decoder();
    let mut chunk = [0; 1024];
    while let Ok(count @ 1..) = port.read(&mut chunk) {
        decoder.received(chunk.get(..count).unwrap_or_default());
        loop {
            match decoder.decode() {
                Ok(frame) if sender.send(LogLine::of(&frame)).is_err() => return,
                // A frame that a reset has cut off is skipped; the next one starts after its end mark.
                Ok(_) | Err(DecodeError::Malformed) => {}
                Err(DecodeError::UnexpectedEof) => break,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(text: &str) -> LogLine {
        LogLine { time_s: 0.0, level: "info".into(), text: text.into() }
    }

    #[test]
    fn pin_and_epoch_are_read_from_the_text() {
        assert_eq!(line("integrity pin high").pin_level(), Some(true));
        assert_eq!(line("start: reset cause PIN, clock Crystal").pin_level(), Some(false));
        assert_eq!(line("epoch 7 took 670123 ticks").epoch_ticks(), Some(670_123));
        assert_eq!(line("epoch 7 took long").epoch_ticks(), None);
        assert_eq!(line("stack high water 5120 bytes").stack_bytes(), Some(5120));
    }
}
