//! Sources of sentences.
//!
//! Each source is a thread that sends its news, and ends with the reason for its end. The sentences
//! of a module are recorded as they come; a recording is a source again. Captures are read as
//! `replay` reads them, and time passes by the tags.

use std::fs::File;
use std::io::{BufRead, BufReader, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread;

use anyhow::{Context, Result, ensure};
use raim_core::frame::Ecef;

use super::heaven::{Body, Heaven};
use super::speed::Control;
use crate::replay::{Pace, Playback, Window};
use crate::sentence::{self, Sentence};
use crate::signal::capture::{Bytes, Lumps, has_frames};

/// Longest pause in a file of sentences that is waited for, s. In a longer one the module was off.
const LONGEST_PAUSE_S: f64 = 60.0;

/// Seconds of a day, at whose end the time of sentences restarts.
const DAY_S: f64 = 86_400.0;

/// News of a source.
#[derive(Clone, Debug, PartialEq)]
pub enum News {
    /// A line of the host port, with its line end.
    Line(String),
    /// The level of the pin.
    PinLevel(bool),
    /// Directions of the satellites.
    Heaven(Vec<Body>),
    /// The source has ended, with the reason.
    End(String),
    /// The source has failed, with the reason.
    Failed(String),
}

/// Choice of a source.
#[derive(Clone, Debug)]
pub enum Choice {
    /// A serial port.
    Port(PathBuf),
    /// A TCP server that passes on the host port.
    Tcp(String),
    /// A recording of sentences, or a capture of a receiver, identified by content; and the speed
    /// at which it is shown.
    File(PathBuf, Control),
}

/// Running source.
pub struct Source {
    /// News of the source.
    pub news: Receiver<News>,
    /// Writer of commands, if the source takes any.
    pub commands: Option<Box<dyn Write + Send>>,
    /// Name for the footer.
    pub name: String,
}

/// Opens a source.
///
/// # Errors
/// The source cannot be opened; the message names it.
pub fn open(choice: &Choice) -> Result<Source> {
    let (sender, news) = sync_channel(256);
    let (name, commands): (String, Option<Box<dyn Write + Send>>) = match choice {
        Choice::Port(path) => {
            let port = serial(path)?;
            // Without permission to write, the port can still be read.
            let commands = File::options().append(true).open(path).ok();
            spawn(sender, |sender| lines(BufReader::new(port), sender, None));
            (path.display().to_string(), commands.map(|file| Box::new(file) as Box<dyn Write + Send>))
        }
        Choice::Tcp(address) => {
            let stream = TcpStream::connect(address).with_context(|| format!("{address} does not answer"))?;
            let commands = stream.try_clone()?;
            spawn(sender, |sender| lines(BufReader::new(stream), sender, None));
            (address.clone(), Some(Box::new(commands)))
        }
        Choice::File(path, control) => {
            let name = path.display().to_string();
            let bytes = Bytes::open(&name, f64::INFINITY).with_context(|| name.clone())?;
            let (control, file) = (control.clone(), name.clone());
            spawn(sender, move |sender| {
                let shown = if holds_sentences(bytes.head()) {
                    lines(BufReader::new(bytes), sender, Some(&control))
                } else {
                    capture(bytes, sender, &control)
                };
                shown.context(file)
            });
            (name, None)
        }
    };
    Ok(Source { news, commands, name })
}

/// Runs another source, which sends its news and returns the reason for its end.
pub fn run(
    name: String,
    source: impl FnOnce(&SyncSender<News>) -> Result<&'static str> + Send + 'static,
) -> Source {
    let (sender, news) = sync_channel(256);
    spawn(sender, source);
    Source { news, commands: None, name }
}

/// Runs a source in a separate thread; its result is the last news.
fn spawn(
    sender: SyncSender<News>,
    source: impl FnOnce(&SyncSender<News>) -> Result<&'static str> + Send + 'static,
) {
    thread::spawn(move || {
        let end = source(&sender)
            .map_or_else(|error| News::Failed(format!("{error:#}")), |why| News::End(why.to_owned()));
        // Sending fails only if the receiver has ended, so that the error has no reader.
        let _ = sender.send(end);
    });
}

/// Returns true if a file begins with sentences of a module, and not with the bytes of a receiver.
fn holds_sentences(head: &[u8]) -> bool {
    let is_said = |line: &[u8]| line.starts_with(b"$PRAI") || line.starts_with(b"$GNGNS");
    !has_frames(head) && head.split(|byte| *byte == b'\n').any(is_said)
}

/// Opens a port. A terminal is set to the module's rate and otherwise left alone; a pipe or a file
/// is read as it is.
fn serial(path: &Path) -> Result<File> {
    use std::os::unix::fs::FileTypeExt as _;
    let port = File::open(path).with_context(|| format!("{} cannot be opened", path.display()))?;
    if port.metadata()?.file_type().is_char_device() {
        let status = Command::new("stty")
            .args(["115200", "raw", "-echo", "-crtscts"])
            .stdin(port.try_clone()?)
            .status()
            .context("stty cannot be run")?;
        ensure!(status.success(), "{} is no serial port", path.display());
    }
    Ok(port)
}

/// Sends lines as they come; lines of a file at the pace of the times of the verdicts.
fn lines(
    mut reader: impl BufRead,
    sender: &SyncSender<News>,
    control: Option<&Control>,
) -> Result<&'static str> {
    let (mut line, mut last_s) = (Vec::new(), None);
    while reader.read_until(b'\n', &mut line).context("cannot be read")? > 0 {
        let text = String::from_utf8_lossy(&std::mem::take(&mut line)).into_owned();
        if let (Some(control), Ok(Sentence::State(state))) = (control, sentence::parse(&text)) {
            let passed_s = state.time_s.zip(last_s).map_or(0.0, |(time_s, last_s)| {
                let passed_s: f64 = time_s - last_s;
                passed_s.rem_euclid(DAY_S)
            });
            control.wait(passed_s.min(LONGEST_PAUSE_S));
            control.judged(state.state);
            last_s = state.time_s.or(last_s);
        }
        sender.send(News::Line(text))?;
    }
    Ok("the end")
}

/// Sends the sentences of the module in process for a capture.
fn capture(bytes: Bytes, sender: &SyncSender<News>, control: &Control) -> Result<&'static str> {
    let mut lumps = Lumps::of(bytes, None, &[], &Window::ALL)?;
    let mut playback = Playback::start(lumps.by_ref(), &[], Pace::Recorded)?;
    let mut heaven = Heaven::new();
    let (mut place, mut now_s) = (Ecef::CENTRE, 0.0);
    tell(&playback.greeting()?, &mut place, sender)?;
    while let Some((lump, said)) = playback.advance()? {
        control.wait(lump.elapsed_s - now_s);
        now_s = lump.elapsed_s;
        if let Some(output) = said.output()? {
            control.judged(output.state.state);
        }
        tell(&said.of_epoch, &mut place, sender)?;
        if let Some(bodies) = heaven.hear(&lump.bytes, lump.elapsed_ms(), place) {
            sender.send(News::Heaven(bodies))?;
        }
        // After a silence the pin is low.
        let is_high = said.output()?.is_some_and(|output| output.state.is_protected());
        sender.send(News::PinLevel(is_high))?;
        if let Some(stale_s) = said.stale_s {
            control.wait(stale_s - now_s);
            now_s = stale_s;
            control.judged('A');
            sender.send(News::PinLevel(false))?;
        }
        tell(&said.of_silence, &mut place, sender)?;
    }
    Ok("the end")
}

/// Sends sentences, and stores the position in them.
///
/// # Errors
/// The receiver of the news has ended.
pub fn tell(text: &str, place: &mut Ecef, sender: &SyncSender<News>) -> Result<()> {
    for line in text.split_inclusive('\n') {
        if let Ok(Sentence::Position(Some(position))) = sentence::parse(line) {
            *place = position.to_ecef();
        }
        sender.send(News::Line(line.to_owned()))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::super::speed::Speed;
    use super::*;

    fn all(source: &Source) -> Vec<News> {
        let mut news = Vec::new();
        while let Ok(one) = source.news.recv_timeout(Duration::from_secs(20)) {
            let is_end = matches!(one, News::End(_) | News::Failed(_));
            news.push(one);
            if is_end {
                break;
            }
        }
        news
    }

    #[test]
    fn a_recording_is_told_from_a_capture() {
        let said = b"\xFFnoise\n$PRAIV,0.1.0,abc,POWER,PASS*00\r\n";
        assert!(holds_sentences(said));
        let frame = crate::signal::encode::ubx::frame([0x02, 0x15], &[0; 16]);
        assert!(!holds_sentences(&[&said[..], &frame].concat()));
        assert!(!holds_sentences(b"$GPGGA,of,a,receiver*00\r\n") && !holds_sentences(b""));
    }

    #[test]
    fn a_recording_gives_its_lines_and_ends() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("said.nmea");
        std::fs::write(&path, "$PRAIS,a*00\r\n$PRAIN,b*00\r\n").expect("written");
        let source = open(&Choice::File(path, Control::new(Speed::Max))).expect("opened");
        let line = |text: &str| News::Line(text.to_owned());
        let want = [line("$PRAIS,a*00\r\n"), line("$PRAIN,b*00\r\n"), News::End("the end".to_owned())];
        assert_eq!(all(&source), want);
    }

    #[test]
    fn what_cannot_be_opened_is_named() {
        let file = Choice::File("/nowhere/at/all".into(), Control::new(Speed::Max));
        for choice in [file, Choice::Port("/nowhere/at/all".into())] {
            let error = open(&choice).err().map(|error| format!("{error:#}")).unwrap_or_default();
            assert!(error.contains("/nowhere/at/all"), "{error}");
        }
    }
}
