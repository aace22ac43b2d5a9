//! Sources of sentences.
//!
//! Each source is a thread that sends its news, and ends with the reason for its end. The sentences
//! of a module are recorded as they come; a recording is a source again. Captures are read as
//! `replay` reads them, and time passes by the tags.
//!
//! Everything about one epoch is one message: its sentences, the pin, the satellites. A picture
//! between two messages therefore never shows the verdict of one epoch beside the pin of another.

use std::io::{BufRead, BufReader, Read as _, Write};
use std::path::PathBuf;
use std::sync::mpsc::{self, Receiver, SyncSender, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, ensure};

use super::batch::Batches;
use super::speed::Control;
use crate::replay::{Pace, Playback};
use crate::satellites::Account;
use crate::sentence::{self, Sentence};
use crate::signal::capture::{Bytes, Capture, for_the_module, has_frames};
use crate::source::{Source as Line, listen};

/// Longest pause in a file of sentences that is waited for, s. In a longer one the module was off.
const LONGEST_PAUSE_S: f64 = 60.0;

/// Seconds of a day, at whose end the time of sentences restarts.
const DAY_S: f64 = 86_400.0;

/// Bytes without a sentence of a module after which a port is refused, and the time in which a
/// module has sent one.
const NO_MODULE_BYTES: usize = 16 * 1024;
const NO_MODULE_TIME: Duration = Duration::from_secs(15);

/// Most bytes that are read as one line; no sentence is longer.
const LINE_BYTES: u64 = 1024;

/// Sentences that belong together: all of an epoch, or one between two epochs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Message {
    /// Lines of the host port, with their line ends.
    pub lines: Vec<String>,
    /// The level of the pin after them; `None` if the source does not know it.
    pub pin: Option<bool>,
    /// Satellites of the epoch; `None` if the source does not know them, or without an epoch.
    pub satellites: Option<Vec<Account>>,
}

impl Message {
    /// Returns the lines of a text as a message.
    pub fn of(text: &str, pin: Option<bool>, satellites: Option<Vec<Account>>) -> Self {
        Self { lines: text.split_inclusive('\n').map(str::to_owned).collect(), pin, satellites }
    }
}

/// News of a source.
#[derive(Clone, Debug, PartialEq)]
pub enum News {
    /// Sentences of the module.
    Reported(Message),
    /// The source has ended, with the reason.
    End(String),
    /// The source has failed, with the reason.
    Failed(String),
}

/// Choice of a source.
#[derive(Clone, Debug)]
pub enum Choice {
    /// A serial port, or a server that passes on the host port.
    Line(Line),
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
        Choice::Line(line) => {
            let name = line.to_string();
            let (port, commands) = listen(line).with_context(|| name.clone())?;
            spawn(sender, |sender| module(BufReader::new(port), sender));
            (name, commands)
        }
        Choice::File(path, control) => {
            let name = path.display().to_string();
            let bytes = Bytes::open(&name, f64::INFINITY).with_context(|| name.clone())?;
            let (control, file) = (control.clone(), name.clone());
            let (writer, commands) = mpsc::channel();
            let is_said = holds_sentences(bytes.head());
            spawn(sender, move |sender| {
                let shown = if is_said {
                    recorded(BufReader::new(bytes), sender, &control)
                } else {
                    capture(&file, bytes, sender, &control, &commands)
                };
                shown.context(file)
            });
            (name, (!is_said).then(|| Box::new(Commands(writer)) as Box<dyn Write + Send>))
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

/// Commands for a module in process.
struct Commands(mpsc::Sender<Vec<u8>>);

impl Write for Commands {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        // The file has ended if nobody receives; then there is no module to command.
        let _ = self.0.send(bytes.to_vec());
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

/// Sends the sentences of a module behind a port, epoch by epoch. A port of something else is
/// refused, with what `replay` says of its bytes.
fn module(mut reader: impl BufRead, sender: &SyncSender<News>) -> Result<&'static str> {
    let (mut line, mut batches, mut unknown) = (Vec::new(), Batches::default(), Vec::new());
    let mut since = Instant::now();
    // Bytes that are no text have no end of a line.
    while reader.by_ref().take(LINE_BYTES).read_until(b'\n', &mut line).context("cannot be read")? > 0 {
        let text = String::from_utf8_lossy(&line).into_owned();
        if text.starts_with("$PRAI") && sentence::parse(&text).is_ok() {
            unknown.clear();
        } else {
            if unknown.is_empty() {
                since = Instant::now();
            }
            unknown.extend_from_slice(&line);
        }
        ensure!(
            unknown.len() < NO_MODULE_BYTES && (unknown.is_empty() || since.elapsed() < NO_MODULE_TIME),
            "{} bytes came and no sentence of the module ($PRAIS). {}",
            unknown.len(),
            said_of(unknown)
        );
        line.clear();
        for lines in batches.push(text) {
            sender.send(News::Reported(Message { lines, ..Message::default() }))?;
        }
    }
    let lines = batches.end();
    sender.send(News::Reported(Message { lines, ..Message::default() }))?;
    Ok("the end")
}

/// Returns what `replay` says of bytes that are no sentences of a module.
fn said_of(bytes: Vec<u8>) -> String {
    match Capture::of(bytes, None) {
        Ok(_) => "They are those of a receiver: `run` and `replay` read them".to_owned(),
        Err(error) => format!("As a receiver's, what comes {error:#}"),
    }
}

/// Sends recorded sentences at the pace of the times of the verdicts.
fn recorded(mut reader: impl BufRead, sender: &SyncSender<News>, control: &Control) -> Result<&'static str> {
    let (mut line, mut batches, mut last_s) = (Vec::new(), Batches::default(), None);
    while reader.read_until(b'\n', &mut line).context("cannot be read")? > 0 {
        let text = String::from_utf8_lossy(&std::mem::take(&mut line)).into_owned();
        for lines in batches.push(text) {
            pace(&lines, &mut last_s, control);
            sender.send(News::Reported(Message { lines, ..Message::default() }))?;
        }
    }
    let lines = batches.end();
    sender.send(News::Reported(Message { lines, ..Message::default() }))?;
    Ok("the end")
}

/// Lets the time pass between the last verdict and that in some lines.
fn pace(lines: &[String], last_s: &mut Option<f64>, control: &Control) {
    for line in lines {
        let Ok(Sentence::State(state)) = sentence::parse(line) else { continue };
        let passed_s = state.time_s.zip(*last_s).map_or(0.0, |(time_s, last_s)| {
            let passed_s: f64 = time_s - last_s;
            passed_s.rem_euclid(DAY_S)
        });
        control.wait(passed_s.min(LONGEST_PAUSE_S));
        control.judged(state.state);
        *last_s = state.time_s.or(*last_s);
    }
}

/// Sends the sentences of the module in process for a capture, and obeys commands between its
/// epochs.
fn capture(
    name: &str,
    bytes: Bytes,
    sender: &SyncSender<News>,
    control: &Control,
    commands: &mpsc::Receiver<Vec<u8>>,
) -> Result<&'static str> {
    let cut = bytes.cut();
    let (lumps, setup) = for_the_module(name, bytes)?;
    let mut playback = Playback::start(lumps, &setup, Pace::Recorded)?;
    playback.watch();
    let mut now_s = 0.0;
    let reported = |text: &str, pin, satellites| News::Reported(Message::of(text, Some(pin), satellites));
    let greeting = playback.greeting()?;
    sender.send(reported(&greeting, playback.pin_is_high(), None))?;
    while let Some((lump, heard)) = playback.advance()? {
        control.wait(lump.elapsed_s - now_s);
        now_s = lump.elapsed_s;
        let output = heard.output();
        if let Some(output) = output {
            control.judged(output.state.state);
        }
        // The module has lived through the silence behind the epoch already. The pin of the epoch
        // is that of its verdict, with which `Playback` has compared it.
        let is_high = output.is_some_and(|output| output.state.is_protected());
        sender.send(reported(&heard.of_epoch, is_high, heard.view().map(|view| view.satellites.clone())))?;
        if let Some((stale_s, _)) = heard.silence.first() {
            control.wait(stale_s - now_s);
            now_s = *stale_s;
            control.judged('A');
        }
        if !heard.of_silence.is_empty() {
            sender.send(reported(&heard.of_silence, playback.pin_is_high(), None))?;
        }
        while let Ok(command) = commands.try_recv() {
            let answer = playback.command(&command)?;
            sender.send(reported(&answer, playback.pin_is_high(), None))?;
        }
    }
    Ok(if cut.words().is_some() { "the end of a gzip file that is cut off" } else { "the end" })
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
        let reported = b"\xFFnoise\n$PRAIV,0.1.0,abc,POWER,PASS*00\r\n";
        assert!(holds_sentences(reported));
        let frame = crate::signal::encode::ubx::frame([0x02, 0x15], &[0; 16]);
        assert!(!holds_sentences(&[&reported[..], &frame].concat()));
        assert!(!holds_sentences(b"$GPGGA,of,a,receiver*00\r\n") && !holds_sentences(b""));
    }

    #[test]
    fn a_recording_gives_its_lines_and_ends() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("said.nmea");
        std::fs::write(&path, "$PRAIS,a*00\r\n$PRAIN,b*00\r\n").expect("written");
        let source = open(&Choice::File(path, Control::new(Speed::Max))).expect("opened");
        let reported = Message::of("$PRAIS,a*00\r\n$PRAIN,b*00\r\n", None, None);
        let nothing = Message::default();
        let want = [News::Reported(reported), News::Reported(nothing), News::End("the end".to_owned())];
        assert_eq!(all(&source), want);
    }

    #[test]
    fn the_port_of_a_receiver_is_refused() {
        let (sender, news) = sync_channel(256);
        let nmea = b"$GPGLL,4916.45,N,12311.12,W,225444,A,*1D\r\n".repeat(500);
        spawn(sender, move |sender| module(BufReader::new(&nmea[..]), sender));
        let source = Source { news, commands: None, name: String::new() };
        let have = all(&source);
        let Some(News::Failed(why)) = have.last() else { panic!("{have:?}") };
        assert!(why.contains("no sentence of the module"), "{why}");
        assert!(why.contains("lines of NMEA. missing: ranges"), "{why}");
    }

    /// Bytes of another rate have no ends of lines.
    #[test]
    fn a_line_without_an_end_is_refused_and_kept_in_bounded_memory() {
        let (sender, news) = sync_channel(256);
        let noise = [0x80, 0xFF, 0x3F].repeat(NO_MODULE_BYTES);
        spawn(sender, move |sender| module(BufReader::new(std::io::repeat(0x80).take(1 << 30)), sender));
        let source = Source { news, commands: None, name: String::new() };
        let have = all(&source);
        let Some(News::Failed(why)) = have.last() else { panic!("{have:?}") };
        assert!(why.starts_with("16384 bytes came"), "{why}");
        assert!(said_of(noise).contains("no frame of UBX, SBF or RTCM 3"));
    }

    #[test]
    fn what_cannot_be_opened_is_named() {
        let file = Choice::File("/nowhere/at/all".into(), Control::new(Speed::Max));
        for choice in [file, Choice::Line(Line::line("/nowhere/at/all", 9600).unwrap())] {
            let error = open(&choice).err().map(|error| format!("{error:#}")).unwrap_or_default();
            assert!(error.contains("/nowhere/at/all"), "{error}");
        }
    }
}
