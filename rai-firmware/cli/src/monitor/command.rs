//! Command `monitor`: a live view of a module.

use std::fs::File;
use std::io::Write as _;
use std::path::PathBuf;
use std::sync::mpsc::RecvTimeoutError;
use std::time::{Duration, Instant};

use super::keys::{Action, Key};
use super::source::{self, Choice, News, Source};
use super::speed::{Control, Speed};
use super::{Dashboard, draw, plain};
use crate::sentence::command;
use crate::source::{BAUD, Source as Line};
use anyhow::{Context as _, anyhow, bail};
use ratatui::crossterm::event::{self, Event, KeyCode, KeyEventKind};

/// Arguments of the command.
#[derive(clap::Args)]
#[command(group = clap::ArgGroup::new("source").required(true))]
pub struct Arguments {
    /// Watch the module whose host port is on this serial port, such as /dev/ttyUSB0, with @BAUD or
    /// without, or on the server tcp://HOST:PORT.
    #[arg(long, group = "source", value_parser = |name: &str| Line::line(name, BAUD))]
    port: Option<Line>,
    /// Watch a module through a server that forwards its host port, HOST:PORT.
    #[arg(long, group = "source")]
    tcp: Option<String>,
    /// Watch a file of --record, or a capture of a receiver, which the module in process then
    /// judges. Both may be gzip.
    #[arg(long, group = "source")]
    file: Option<PathBuf>,
    /// Show --file at a multiple of the recorded speed, or at max. The default is 1, with --plain
    /// max.
    #[arg(long, requires = "file", value_name = "N|max", value_parser = speed)]
    speed: Option<Speed>,
    /// Watch a simulated sky on the emulated board, with one satellite that drifts off.
    #[arg(long, group = "source")]
    demo: bool,
    /// Write the module's sentences to a file, for --file.
    #[arg(long)]
    record: Option<PathBuf>,
    /// Print lines instead of a picture: verdicts and exclusions.
    #[arg(long)]
    plain: bool,
    /// With --plain, print every sentence as it comes.
    #[arg(long, requires = "plain")]
    raw: bool,
}

fn speed(text: &str) -> Result<Speed, String> {
    Speed::parse(text).map_err(|error| error.to_string())
}

/// Longest delay of the picture.
const FRAME: Duration = Duration::from_millis(100);

/// Starts the demonstration on the emulated board, which has its own package.
pub type Demonstration<'a> = &'a dyn Fn() -> anyhow::Result<Source>;

/// Runs the command, with the demonstration if the caller has one.
///
/// # Errors
/// If the source cannot be opened or fails, or if the record cannot be written.
pub fn run(arguments: &Arguments, demonstration: Option<Demonstration>) -> anyhow::Result<()> {
    let choice = arguments.choice();
    let mut source = match (&choice, demonstration) {
        (Some(choice), _) => source::open(choice)?,
        (None, Some(start)) => start()?,
        (None, None) => bail!("--demo needs the emulated board: use cargo xtask monitor"),
    };
    let mut record = arguments
        .record
        .as_ref()
        .map(|path| File::create(path).with_context(|| format!("{} cannot be written", path.display())))
        .transpose()?;
    if arguments.plain {
        print(&source, record.as_mut(), arguments.raw)
    } else {
        let mut dashboard = Dashboard::of(&source.name);
        dashboard.takes_commands = source.commands.is_some();
        if let Some(Choice::File(_, control)) = choice {
            dashboard.control = Some(control);
        }
        watch(&mut source, dashboard, record.as_mut())
    }
}

impl Arguments {
    /// Returns the source that the user named; `None` for the demonstration.
    fn choice(&self) -> Option<Choice> {
        match (&self.port, &self.tcp, &self.file) {
            (Some(line), ..) => Some(Choice::Line(line.clone())),
            (_, Some(address), _) => Some(Choice::Line(Line::Tcp(address.clone()))),
            (.., Some(path)) => {
                let usual = if self.plain { Speed::Max } else { Speed::Times(1.0) };
                Some(Choice::File(path.clone(), Control::new(self.speed.unwrap_or(usual))))
            }
            (None, None, None) => None,
        }
    }
}

fn note(line: &str, record: &mut Option<&mut File>) -> anyhow::Result<()> {
    record
        .as_mut()
        .map_or(Ok(()), |file| file.write_all(line.as_bytes()))
        .context("the recording cannot go on")
}

/// Prints line by line, until the source ends.
fn print(source: &Source, mut record: Option<&mut File>, is_raw: bool) -> anyhow::Result<()> {
    for news in &source.news {
        match news {
            News::Reported(message) => {
                for line in &message.lines {
                    note(line, &mut record)?;
                    if is_raw {
                        println!("{}", line.trim_end());
                    } else if let Some(words) = plain::words(line.trim_end()) {
                        println!("{words}");
                    }
                }
            }
            News::End(_) => break,
            News::Failed(why) => bail!(why),
        }
    }
    Ok(())
}

/// Shows the picture, until the user quits or the source ends.
fn watch(source: &mut Source, mut dashboard: Dashboard, mut record: Option<&mut File>) -> anyhow::Result<()> {
    let mut terminal = ratatui::try_init().context("this is no terminal: try --plain")?;
    let mut failure = Ok(());
    let seen = loop {
        match receive(source, &mut dashboard, &mut record) {
            Err(error) => break Err(error),
            Ok(Some(why)) => failure = Err(anyhow!(why)),
            Ok(None) => {}
        }
        if let Err(error) = terminal.draw(|frame| draw::draw(frame, &dashboard)) {
            break Err(error.into());
        }
        // A source that is none is reported as `replay` reports it, and not by an empty picture.
        if failure.is_err() && dashboard.epochs == 0 {
            break Ok(());
        }
        match key() {
            Ok(key) => match key.and_then(|key| dashboard.press(key)) {
                Some(Action::Quit) => break Ok(()),
                Some(Action::Send(body)) => send(source, &body),
                None => {}
            },
            Err(error) => break Err(error),
        }
    };
    ratatui::restore();
    seen.and(failure)
}

/// Takes the news, for at most the longest delay of the picture; while it is paused, news waits.
/// Returns the reason if the source has failed.
fn receive(
    source: &Source,
    dashboard: &mut Dashboard,
    record: &mut Option<&mut File>,
) -> anyhow::Result<Option<String>> {
    let begun = Instant::now();
    let is_fast = |control: &Control| control.seeks_alert() || control.speed() != Speed::Times(1.0);
    let mut patience = FRAME;
    while !dashboard.is_paused && begun.elapsed() < FRAME {
        match source.news.recv_timeout(patience) {
            Ok(News::Reported(message)) => {
                message.lines.iter().try_for_each(|line| note(line, record))?;
                dashboard.take(&message);
                // Every epoch of a live source, or of a file at its own speed, is drawn.
                if !dashboard.control.as_ref().is_some_and(is_fast) {
                    break;
                }
            }
            Ok(News::End(why)) => dashboard.ended = Some(why),
            Ok(News::Failed(why)) => {
                dashboard.ended = Some(why.clone());
                return Ok(Some(why));
            }
            Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => break,
        }
        patience = Duration::from_millis(1);
    }
    Ok(None)
}

/// Returns the key that was pressed, if any.
fn key() -> anyhow::Result<Option<Key>> {
    if !event::poll(Duration::from_millis(20))? {
        return Ok(None);
    }
    Ok(match event::read()? {
        Event::Key(key) if key.kind == KeyEventKind::Press => match key.code {
            KeyCode::Esc => Some(Key::Escape),
            KeyCode::Enter => Some(Key::Enter),
            KeyCode::Backspace => Some(Key::Back),
            KeyCode::Char(letter) => Some(Key::Letter(letter)),
            _ => None,
        },
        _ => None,
    })
}

/// Sends a command to the module, unless the source takes none.
fn send(source: &mut Source, body: &str) {
    if let Some(commands) = &mut source.commands {
        // A port that takes no commands can still be watched.
        let _ = commands.write_all(command(body).as_bytes());
    }
}
