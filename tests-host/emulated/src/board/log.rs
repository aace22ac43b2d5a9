//! Log of the board: frames of the log port, decoded with the table in the image.

use std::io::Read;
use std::net::TcpStream;
use std::sync::mpsc::{Receiver, Sender, channel};

use anyhow::Context;
use defmt_decoder::{DecodeError, Frame, Table};
use raim::page::Verdict;

/// A verdict in the log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Judgement {
    /// The verdict.
    pub verdict: Verdict,
    /// True if the verdict concerns the silence of the line, not an epoch.
    pub is_stale: bool,
    /// Ticks of the core clock from the last byte of the epoch to the pin, at most; `None` if no
    /// byte caused the verdict.
    pub ticks_to_pin: Option<u64>,
}

/// One line of the log.
#[derive(Clone, Debug, PartialEq)]
pub struct LogLine {
    /// Time since the board's start, s.
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

    /// Returns the level of the integrity pin in this line. A start line means a low pin, because
    /// start-up drives it low.
    pub fn pin_level(&self) -> Option<bool> {
        match self.text.as_str() {
            "integrity pin high" => Some(true),
            "integrity pin low" => Some(false),
            text if text.starts_with("start:") => Some(false),
            _ => None,
        }
    }

    /// Returns the ticks of the core clock that an epoch took, if this line has them.
    pub fn epoch_ticks(&self) -> Option<u64> {
        let (_, ticks) = self.text.strip_prefix("epoch ")?.strip_suffix(" ticks")?.split_once(" took ")?;
        ticks.parse().ok()
    }

    /// Returns the verdict in this line.
    pub fn judgement(&self) -> Option<Judgement> {
        let (verdict, rest) = self.text.strip_prefix("judged Some(")?.split_once("): ")?;
        let (word, reason) = verdict.split_once('(')?;
        let verdict = match word {
            "Protected" => Verdict::Protected,
            "Alert" => Verdict::Alert,
            "Unavailable" => Verdict::Unavailable,
            _ => return None,
        };
        let ticks =
            rest.strip_prefix("pin ").and_then(|rest| rest.strip_suffix(" ticks after the last byte"));
        let ticks_to_pin = ticks.and_then(|ticks| ticks.parse().ok());
        Some(Judgement { verdict, is_stale: reason.starts_with("Stale"), ticks_to_pin })
    }

    /// Returns the largest number of waiting bytes of each ring of the ports, by name, if this line
    /// has them.
    pub fn rings(&self) -> Option<Vec<(String, u64)>> {
        let fields = self.text.strip_prefix("rings high water HighWater { ")?.strip_suffix(" }")?;
        let ring = |field: &str| {
            let (name, bytes) = field.split_once(": ")?;
            Some((name.to_owned(), bytes.parse().ok()?))
        };
        fields.split(", ").map(ring).collect()
    }

    /// Returns the deepest stack, bytes, if this line has it.
    pub fn stack_bytes(&self) -> Option<u64> {
        self.text.strip_prefix("stack high water ")?.strip_suffix(" bytes")?.parse().ok()
    }
}

/// Returns the table that decodes the image's frames.
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
                // A frame that a reset has cut off is skipped; the next one starts after its end
                // mark.
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

    #[test]
    fn verdict_is_read_with_its_time_to_the_pin() {
        let told = line("judged Some(Unavailable(NoFix)): pin 174842 ticks after the last byte").judgement();
        let want = Judgement { verdict: Verdict::Unavailable, is_stale: false, ticks_to_pin: Some(174_842) };
        assert_eq!(told, Some(want));
        let told = line("judged Some(Alert(Stale)): no byte came").judgement();
        let want = Judgement { verdict: Verdict::Alert, is_stale: true, ticks_to_pin: None };
        assert_eq!(told, Some(want));
        assert_eq!(line("judged None: no byte came").judgement(), None);
    }

    #[test]
    fn rings_are_read_by_name() {
        let told = line("rings high water HighWater { gnss_in: 12, host_out: 82 }").rings();
        assert_eq!(told, Some(vec![("gnss_in".to_owned(), 12), ("host_out".to_owned(), 82)]));
    }
}
