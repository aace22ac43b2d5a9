//! Where the sentences come from.
//!
//! Each source is a thread that sends what it sees, and ends with a word about why. What a module said is recorded as it
//! came; a recording is a source again.

use std::fs::File;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread;
use std::time::Duration;

use anyhow::{Context, Result, ensure};
use rai_core::frame::Ecef;
use rai_firmware::receiver::{self, Boot};

use super::heaven::{Body, Heaven};
use crate::board::EmulatedBoard;
use crate::demo::Plan;
use crate::encode::{Encoder, Frequency, Selection};
use crate::fault::Injector;
use crate::image;
use crate::pin::Pin;
use crate::sentence::{self, Sentence};

/// How fast a recording and the emulated board are shown: ten epochs a second.
const PACE: Duration = Duration::from_millis(100);

/// How long the emulated board may take for an epoch.
const PATIENCE: Duration = Duration::from_secs(20);

/// Bytes of a capture that are looked at together.
const CHUNK: usize = 256;

/// Something that was seen.
#[derive(Clone, Debug, PartialEq)]
pub enum News {
    /// A line of the host port, with its line end.
    Line(String),
    /// The level of the pin.
    PinLevel(bool),
    /// Where satellites stand.
    Heaven(Vec<Body>),
    /// There is nothing more to come, and why.
    End(String),
}

/// What is to be watched.
#[derive(Clone, Debug)]
pub enum Choice {
    /// A serial port.
    Port(PathBuf),
    /// A TCP server that passes on the host port.
    Tcp(String),
    /// A recording of sentences, or a capture of what a receiver sent, told apart by content.
    File(PathBuf),
    /// A simulated sky on the emulated board.
    Demo(Plan),
}

/// A source that is running.
pub struct Source {
    /// What it has seen.
    pub news: Receiver<News>,
    /// Where commands go, if anywhere.
    pub commands: Option<Box<dyn Write + Send>>,
    /// Its name, for the footer.
    pub name: String,
}

/// Opens a source.
///
/// # Errors
/// What cannot be opened, by name.
pub fn open(choice: &Choice) -> Result<Source> {
    let (sender, news) = sync_channel(256);
    let (name, commands): (String, Option<Box<dyn Write + Send>>) = match choice {
        Choice::Port(path) => {
            let port = serial(path)?;
            // Without leave to write it can still be watched.
            let commands = File::options().append(true).open(path).ok();
            spawn_lines(BufReader::new(port), sender, Duration::ZERO);
            (path.display().to_string(), commands.map(|file| Box::new(file) as Box<dyn Write + Send>))
        }
        Choice::Tcp(address) => {
            let stream = TcpStream::connect(address).with_context(|| format!("{address} does not answer"))?;
            let commands = stream.try_clone()?;
            spawn_lines(BufReader::new(stream), sender, Duration::ZERO);
            (address.clone(), Some(Box::new(commands)))
        }
        Choice::File(path) => {
            let mut bytes = Vec::new();
            let read = File::open(path).and_then(|mut file| file.read_to_end(&mut bytes));
            read.with_context(|| format!("{} cannot be read", path.display()))?;
            if is_text(&bytes) {
                spawn_lines(std::io::Cursor::new(bytes), sender, PACE);
            } else {
                spawn_capture(bytes, sender);
            }
            (path.display().to_string(), None)
        }
        Choice::Demo(plan) => {
            let plan = *plan;
            thread::spawn(move || {
                let ended = demo(&plan, &sender)
                    .map_or_else(|error| format!("{error:#}"), |()| "the demonstration is over".to_owned());
                let _ = sender.send(News::End(ended));
            });
            (format!("{} of a simulated sky drifts off on the emulated board", plan.satellite), None)
        }
    };
    Ok(Source { news, commands, name })
}

/// Sentences are text and begin with a `$` somewhere early; a capture is not text.
fn is_text(bytes: &[u8]) -> bool {
    let start = bytes.get(..bytes.len().min(512)).unwrap_or_default();
    start.contains(&b'$') && start.iter().all(|byte| byte.is_ascii_graphic() || b" \r\n".contains(byte))
}

/// A terminal is set to the module's rate and left alone otherwise; a pipe or a file is read as it is.
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

/// Sends lines as they come; with a pause behind each verdict where they come from a file.
fn spawn_lines(mut reader: impl BufRead + Send + 'static, sender: SyncSender<News>, pause: Duration) {
    thread::spawn(move || {
        let mut line = Vec::new();
        let ended = loop {
            line.clear();
            match reader.read_until(b'\n', &mut line) {
                Ok(0) => break "the end".to_owned(),
                Ok(_) => {}
                Err(error) => break format!("{error}"),
            }
            let text = String::from_utf8_lossy(&line).into_owned();
            let is_verdict = text.starts_with("$PRAIS");
            if sender.send(News::Line(text)).is_err() {
                return;
            }
            if is_verdict {
                thread::sleep(pause);
            }
        };
        let _ = sender.send(News::End(ended));
    });
}

/// The module in process, fed with a capture.
fn spawn_capture(bytes: Vec<u8>, sender: SyncSender<News>) {
    thread::spawn(move || {
        let ended =
            capture(&bytes, &sender).map_or_else(|error| format!("{error:#}"), |()| "the end".to_owned());
        let _ = sender.send(News::End(ended));
    });
}

fn capture(bytes: &[u8], sender: &SyncSender<News>) -> Result<()> {
    let boot = Boot::on_host("host");
    let mut module = receiver::Receiver::new(Pin::default(), boot).context("the module cannot start")?;
    let mut heaven = Heaven::new();
    let (mut place, mut now_ms) = (Ecef::CENTRE, 0);
    let mut said = Vec::new();
    module.greet(&mut said);
    module.tick(0, &mut said);
    for chunk in bytes.chunks(CHUNK) {
        module.gnss(chunk, now_ms, &mut said);
        let text = String::from_utf8_lossy(&std::mem::take(&mut said)).into_owned();
        let judged = text.contains("$PRAIS");
        tell(&text, &mut place, sender)?;
        if let Some(bodies) = heaven.hear(chunk, now_ms, place) {
            sender.send(News::Heaven(bodies))?;
        }
        if judged {
            sender.send(News::PinLevel(module.pin().high))?;
            // A capture has no times of its own; a second an epoch is what most have.
            now_ms += 1000;
            thread::sleep(PACE);
        }
    }
    Ok(())
}

/// Sends sentences, and keeps the place that they tell.
fn tell(text: &str, place: &mut Ecef, sender: &SyncSender<News>) -> Result<()> {
    for line in text.split_inclusive('\n') {
        if let Ok(Sentence::Position(Some(position))) = sentence::parse(line) {
            *place = position.to_ecef();
        }
        sender.send(News::Line(line.to_owned()))?;
    }
    Ok(())
}

/// The sky of the demonstration, on the emulated board.
fn demo(plan: &Plan, sender: &SyncSender<News>) -> Result<()> {
    let simulation = plan.simulation()?;
    let recording = simulation.record();
    let mut encoder = Encoder::new(&recording.ephemerides, Selection::new("GC", Frequency::Dual)?);
    let mut board = EmulatedBoard::start(&image::build()?)?;
    let mut heaven = Heaven::new();
    let mut place = simulation.site.position;
    tell(&board.read_through("$PRAIV", PATIENCE)?.concat(), &mut place, sender)?;
    for (index, epoch) in (0_u64..).zip(Injector::new(recording.epochs.into_iter(), vec![plan.fault()])) {
        let bytes = encoder.epoch(&epoch)?;
        board.feed(&bytes)?;
        tell(&board.read_through("$PRAIN", PATIENCE)?.concat(), &mut place, sender)?;
        board.log_with(&format!("epoch {} took", index + 1), 0, PATIENCE)?;
        sender.send(News::PinLevel(board.pin_is_high()))?;
        if let Some(bodies) = heaven.hear(&bytes, index * 1000, place) {
            sender.send(News::Heaven(bodies))?;
        }
        thread::sleep(PACE);
    }
    board.stop()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(source: &Source) -> Vec<News> {
        let mut news = Vec::new();
        while let Ok(one) = source.news.recv_timeout(Duration::from_secs(20)) {
            let is_end = matches!(one, News::End(_));
            news.push(one);
            if is_end {
                break;
            }
        }
        news
    }

    #[test]
    fn a_recording_is_told_from_a_capture() {
        assert!(is_text(b"$PRAIV,0.1.0,abc,POWER,PASS*00\r\n"));
        assert!(!is_text(&[0xD3, 0x00, 0x13, b'$', 0x3E]));
        assert!(!is_text(b""));
    }

    #[test]
    fn a_recording_gives_its_lines_and_ends() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("said.nmea");
        std::fs::write(&path, "$PRAIS,a*00\r\n$PRAIN,b*00\r\n").expect("written");
        let source = open(&Choice::File(path)).expect("opened");
        let line = |text: &str| News::Line(text.to_owned());
        let want = [line("$PRAIS,a*00\r\n"), line("$PRAIN,b*00\r\n"), News::End("the end".to_owned())];
        assert_eq!(all(&source), want);
    }

    #[test]
    fn what_cannot_be_opened_is_named() {
        for choice in [Choice::File("/nowhere/at/all".into()), Choice::Port("/nowhere/at/all".into())] {
            let error = open(&choice).err().map(|error| format!("{error:#}")).unwrap_or_default();
            assert!(error.contains("/nowhere/at/all"), "{error}");
        }
    }
}
