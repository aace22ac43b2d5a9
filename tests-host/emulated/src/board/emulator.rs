//! Process of the emulator, with its three sockets.

use std::io::Read;
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use anyhow::{Context, bail};

use xtask::setup::emulator::{self, PROGRAM};
use xtask::setup::on_path;

/// Time within which the emulator must connect its ports.
const START_PATIENCE: Duration = Duration::from_secs(20);

/// Pace of the board's time while its core sleeps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pace {
    /// The host's pace: if the host computes for a second, a second passes.
    #[default]
    Wall,
    /// Time jumps to the next timer, so minutes of silence pass at once. It suits only tests of
    /// silence, because a host that feeds the board would always be too late.
    Leap,
}

/// Emulated board.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Machine {
    /// The STM32F405, a Cortex-M4F.
    #[default]
    Stm32f405,
    /// The MPS2 board with AN500, a Cortex-M7 with doubles in hardware.
    Mps2An500,
}

impl Machine {
    /// Returns the emulator's arguments for the board.
    pub const fn arguments(self) -> &'static [&'static str] {
        match self {
            Self::Stm32f405 => &["-machine", "netduinoplus2"],
            Self::Mps2An500 => &["-machine", "mps2-an500", "-cpu", "cortex-m7"],
        }
    }

    /// Returns the frequency of the ticks that its image logs, Hz.
    pub const fn tick_hz(self) -> u64 {
        match self {
            Self::Stm32f405 => 168_000_000,
            Self::Mps2An500 => 25_000_000,
        }
    }

    /// Returns the instructions that pass in `ticks`: one each nanosecond.
    pub const fn instructions(self, ticks: u64) -> u64 {
        ticks * (1_000_000_000 / 1_000_000) / (self.tick_hz() / 1_000_000)
    }
}

/// Settings of the emulator.
#[derive(Clone, Debug, Default)]
pub struct Settings {
    /// Emulated board.
    pub machine: Machine,
    /// Pace of its time.
    pub pace: Pace,
    /// Further arguments of the emulator, such as a debugger's socket.
    pub arguments: Vec<String>,
}

/// Returns true if the emulator is there; otherwise counts the calling test as skipped.
pub fn is_installed() -> bool {
    let found = emulator::is_there();
    if !found {
        crate::skip::say(&format!("{PROGRAM} (`cargo xtask setup` installs it)"));
    }
    found
}

/// A running emulator; ends with the value.
pub(super) struct Emulator {
    end: Option<Sender<()>>,
    keeper: Option<JoinHandle<anyhow::Result<()>>>,
    complaint: Receiver<String>,
    process_id: u32,
}

impl Emulator {
    /// Starts the emulator and waits until its ports USART1, 2, 3 are connected.
    pub(super) fn start(image: &Path, settings: &Settings) -> anyhow::Result<(Self, [TcpStream; 3])> {
        let listeners = [listen()?, listen()?, listen()?];
        let command = command(image, settings, &listeners)?;
        let (started, starting) = channel();
        let (end, ending) = channel();
        let (complain, complaint) = channel();
        let keeper = std::thread::spawn(move || keep(command, &started, &ending, &complain));
        let process_id = starting.recv().context("the emulator's keeper has ended")??;
        let emulator = Self { end: Some(end), keeper: Some(keeper), complaint, process_id };
        let deadline = Instant::now() + START_PATIENCE;
        let mut ports = Vec::new();
        for listener in &listeners {
            ports.push(accept(listener, deadline, &emulator)?);
        }
        let ports = ports.try_into().ok().context("three ports must be connected")?;
        Ok((emulator, ports))
    }

    /// Returns the emulator's message to its user, if it has ended.
    pub(super) fn complaint(&self) -> String {
        self.complaint.recv_timeout(Duration::from_secs(1)).unwrap_or_else(|_| "without a message".into())
    }

    pub(super) fn process_id(&self) -> u32 {
        self.process_id
    }

    /// Ends the emulator; returns an error if it had ended by itself.
    pub(super) fn stop(mut self) -> anyhow::Result<()> {
        self.end()
    }

    fn end(&mut self) -> anyhow::Result<()> {
        drop(self.end.take());
        match self.keeper.take().map(JoinHandle::join) {
            Some(Ok(result)) => result,
            Some(Err(_)) => bail!("the emulator's keeper panicked"),
            None => Ok(()),
        }
    }
}

impl Drop for Emulator {
    fn drop(&mut self) {
        // A board that ended early is not reported here, because there is no caller left.
        let _ = self.end();
    }
}

fn listen() -> anyhow::Result<TcpListener> {
    let listener = TcpListener::bind(("127.0.0.1", 0)).context("no local port for the emulator")?;
    listener.set_nonblocking(true)?;
    Ok(listener)
}

fn accept(listener: &TcpListener, deadline: Instant, emulator: &Emulator) -> anyhow::Result<TcpStream> {
    while Instant::now() < deadline {
        if let Ok((port, _)) = listener.accept() {
            port.set_nonblocking(false)?;
            port.set_nodelay(true)?;
            return Ok(port);
        }
        if let Ok(complaint) = emulator.complaint.try_recv() {
            bail!("the emulator did not start: {complaint}");
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    bail!("the emulator did not connect its ports within {START_PATIENCE:?}")
}

/// Returns the command that starts a board.
///
/// If `setpriv` exists, it asks the kernel to end the child with the thread that started it;
/// elsewhere a killed parent would leave the emulator behind.
fn command(image: &Path, settings: &Settings, ports: &[TcpListener; 3]) -> anyhow::Result<Command> {
    let mut command = emulator::command();
    if on_path("setpriv") {
        command = under("setpriv", &["--pdeathsig", "KILL", "--"], &command);
    }
    let icount = match settings.pace {
        Pace::Wall => "shift=0",
        Pace::Leap => "shift=0,sleep=off",
    };
    command.args(settings.machine.arguments());
    command.args(["-display", "none", "-monitor", "none", "-icount", icount, "-kernel"]);
    command.arg(image);
    for (number, listener) in ports.iter().enumerate() {
        let port = listener.local_addr()?.port();
        let socket = format!("socket,id=port{number},host=127.0.0.1,port={port},nodelay=on");
        command.args(["-chardev", &socket, "-serial", &format!("chardev:port{number}")]);
    }
    command.args(&settings.arguments).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped());
    Ok(command)
}

/// Returns the command that lets another program run `command`.
fn under(program: &str, arguments: &[&str], command: &Command) -> Command {
    let mut outer = Command::new(program);
    outer.args(arguments).arg(command.get_program()).args(command.get_args());
    outer.envs(command.get_envs().filter_map(|(name, value)| Some((name, value?))));
    outer
}

/// Owns the process from its start to its end, in a thread that lives as long as the board does.
fn keep(
    mut command: Command,
    started: &Sender<anyhow::Result<u32>>,
    ending: &Receiver<()>,
    complain: &Sender<String>,
) -> anyhow::Result<()> {
    let mut child = match command.spawn() {
        Ok(child) => child,
        Err(error) => {
            let _ = started.send(Err(anyhow::Error::new(error).context(format!("{PROGRAM} cannot be run"))));
            return Ok(());
        }
    };
    let _ = started.send(Ok(child.id()));
    let reported = child.stderr.take().map(collect);
    let ended_early = wait_for_end(&mut child, ending);
    let _ = child.kill();
    child.wait()?;
    if !ended_early {
        return Ok(());
    }
    let text = reported.and_then(|reader| reader.join().ok()).unwrap_or_default();
    let _ = complain.send(text.trim().to_owned());
    bail!("the emulator ended by itself: {}", text.trim())
}

/// Waits until the board is dropped or the process ends; returns true if the process ended.
fn wait_for_end(child: &mut Child, ending: &Receiver<()>) -> bool {
    loop {
        match ending.recv_timeout(Duration::from_millis(50)) {
            Err(std::sync::mpsc::RecvTimeoutError::Timeout) => {}
            _ => return matches!(child.try_wait(), Ok(Some(_))),
        }
        if matches!(child.try_wait(), Ok(Some(_))) {
            return true;
        }
    }
}

fn collect(mut stream: impl Read + Send + 'static) -> JoinHandle<String> {
    std::thread::spawn(move || {
        let mut text = String::new();
        let _ = stream.read_to_string(&mut text);
        text
    })
}
