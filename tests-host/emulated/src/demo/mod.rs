//! The demonstration: one satellite of a simulated sky drifts off while the emulated board is
//! watched.
//!
//! ```text
//! sky ──► fault ──► RTCM ──► USART2 of the board ──► USART1, log ──► moments ──► live view, page, picture
//! ```
//!
//! | time / s | event |
//! |---|---|
//! | 0 to 40 | none |
//! | 40 to 70 | the satellite's range error grows linearly to the full bias |
//! | 70 to 90 | it stays there |
//! | 90 to 120 | the satellite is healthy again |
//! | from 120 | the line is silent, until the module reports it and drops the pin |
//!
//! The next epoch is sent when the module has reported the last one, so two minutes pass as fast as
//! the host runs. Beside the module an ordinary receiver processes the same bytes and accepts every
//! satellite above the same mask. The silence passes on the board's own clock. Its time to alert is
//! set to [`SILENCE_S`] before the first epoch, because a new setting takes the promise back and
//! would drop the pin itself.

mod live;
mod ordinary;
mod story;

use std::path::Path;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, ensure};
use raim::page::Moment;
use raim::page::report::{Happened, Journal};
use raim::satellites::Views;
use raim::sentence;
use raim::signal::encode::{Encoder, Frequency, Selection};
use raim::signal::fault::{Fault, Injector, Kind, Target};
use raim::signal::sky::raw::Simulation;
use raim::signal::sky::{Site, sights};
use raim::verdict::EpochOutput;
use raim_core::frame::Enu;
use raim_core::satellite::SatelliteId;
use raim_firmware::pin::MemoryPin;
use raim_firmware::receiver::{Boot, Receiver};

pub use live::{Live, View};
pub use ordinary::{Accepter, Ordinary};
pub use story::Story;

use crate::board::EmulatedBoard;

/// Start of the fault, s.
pub const FAULT_START_S: f64 = 40.0;
/// End of the fault, s.
pub const FAULT_END_S: f64 = 90.0;
/// Time in which the fault grows, s.
const GROWTH_S: f64 = 30.0;
/// Number of epochs of the demonstration, one per second.
const EPOCHS: u32 = 120;
/// Time to alert while the line is silent, s: short, because the demonstration waits for it.
pub const SILENCE_S: f64 = 3.0;
/// Smallest elevation of the satellite at the beginning, degrees.
const ELEVATION_DEG: f64 = 35.0;
/// Elevation mask of the module at start and of the ordinary receiver, degrees.
const MASK_DEG: f64 = 10.0;
/// Time within which the board must report an epoch.
const PATIENCE: Duration = Duration::from_secs(20);

/// Largest delay of the log of the pin after the sentence.
const PIN_PATIENCE: Duration = Duration::from_secs(5);

/// Parameters of a demonstration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// Satellite that drifts off.
    pub satellite: SatelliteId,
    /// Final error of its range, m.
    pub bias_m: f64,
    /// Seed of all random choices.
    pub seed: u64,
}

impl Plan {
    /// Returns the sky at a time when the satellite is high.
    ///
    /// # Errors
    /// If the satellite is not in the sky; the error names those that are.
    pub fn simulation(&self) -> Result<Simulation> {
        let mut simulation = Simulation::above_xian(0.0, EPOCHS, self.seed);
        let known: Vec<SatelliteId> = simulation.satellites.iter().map(|satellite| satellite.id).collect();
        self.fault().check_against(&known)?;
        let own: Vec<_> = simulation
            .satellites
            .iter()
            .filter(|satellite| satellite.id == self.satellite)
            .copied()
            .collect();
        let elevation_deg = |t_s: f64| {
            let seen = sights(&own, &simulation.site, t_s, 0.0);
            seen.first().map_or(-90.0, |sight| sight.elevation_rad().to_degrees())
        };
        let quarters = || (0..96).map(|quarter| f64::from(quarter) * 900.0);
        let highest = quarters().max_by(|a, b| elevation_deg(*a).total_cmp(&elevation_deg(*b)));
        let start_s = quarters().find(|&t_s| elevation_deg(t_s) >= ELEVATION_DEG).or(highest);
        let start_s = start_s.filter(|&t_s| elevation_deg(t_s) > 10.0);
        simulation.start_s =
            start_s.with_context(|| format!("{} never rises over the site", self.satellite))?;
        Ok(simulation)
    }

    /// Returns the drift.
    pub fn fault(&self) -> Fault {
        Fault {
            target: Target::Satellite(self.satellite),
            kind: Kind::Ramp { rate_m_s: self.bias_m / GROWTH_S, limit_m: self.bias_m.abs() },
            start_s: FAULT_START_S,
            end_s: FAULT_END_S,
        }
    }

    /// Runs the demonstration on the emulated board. `watch` receives all moments so far after each
    /// epoch.
    ///
    /// # Errors
    /// If the satellite is not in the sky, or the board does not start or does not answer in time.
    pub fn run(&self, image: &Path, mut watch: impl FnMut(&[Moment])) -> Result<Story> {
        ensure!(
            self.bias_m.is_finite() && self.bias_m != 0.0,
            "the bias must be finite and not zero, not {} m",
            self.bias_m
        );
        let simulation = self.simulation()?;
        let recording = simulation.record();
        let mut encoder = Encoder::new(&recording.ephemerides, Selection::new("GC", Frequency::Dual)?);
        let mut module = Module::start(image)?;
        let (mut moments, mut ordinary) = (Vec::new(), Vec::new());
        let pin_at_boot = module.board.pin_is_high();
        let setup = format!("TTA,{SILENCE_S}");
        module.set(&setup)?;
        // The same firmware in process: the sentences of the board have no residuals and no
        // directions.
        let mut twin = Receiver::observed(MemoryPin::default(), Views::new(true), Boot::on_host("host"))
            .context("the module cannot start")?;
        let mut sentences = Vec::new();
        twin.command(sentence::command(&setup).as_bytes(), &mut sentences);
        let mut journal = Journal::default();
        let mut accepter = Accepter::new(MASK_DEG.to_radians());
        let epochs = Injector::new(recording.epochs.into_iter(), vec![self.fault()]);
        for (index, epoch) in (0_u32..).zip(epochs) {
            let bytes = encoder.epoch(&epoch)?;
            let reported = module.judge(&bytes).with_context(|| format!("epoch {index}"))?;
            ordinary.extend(accepter.receive(&bytes, f64::from(index), &simulation.site));
            let (time_s, pin_is_high) = (f64::from(index), module.board.pin_is_high());
            twin.gnss(&bytes, u64::from(index) * 1000, &mut sentences);
            let seen = twin.observer_mut().take().pop().context("the module in process judged nothing")?;
            ensure!(seen.output == reported, "board and module in process differ in epoch {index}");
            let view = seen.view.as_ref();
            let error = error(&reported, &simulation.site);
            journal.push(&Happened { time_s, output: &reported, error, pin_is_high, view });
            moments.push(Moment::of(time_s, &reported, error, pin_is_high));
            watch(&moments);
        }
        // The report comes twice, to show that the alarm lasts.
        for times in 1..=2 {
            let (reported, pin_is_high) = module.fall_silent().context("the silent line")?;
            let time_s = f64::from(EPOCHS - 1) + f64::from(times) * SILENCE_S;
            journal.push(&Happened { time_s, output: &reported, error: None, pin_is_high, view: None });
            moments.push(Moment::of(time_s, &reported, error(&reported, &simulation.site), pin_is_high));
            watch(&moments);
        }
        let instructions = module.board.epoch_instructions();
        module.board.stop()?;
        let settings = *twin.configuration();
        Ok(Story { plan: *self, simulation, moments, journal, settings, ordinary, pin_at_boot, instructions })
    }
}

/// The board, and the number of epochs sent to it.
struct Module {
    board: EmulatedBoard,
    epochs: usize,
}

impl Module {
    fn start(image: &Path) -> Result<Self> {
        let mut board = EmulatedBoard::start(image)?;
        board.read_through("$PRAIV", PATIENCE).context("the board does not report its start")?;
        Ok(Self { board, epochs: 0 })
    }

    /// Sends a setting and waits for its answer.
    fn set(&mut self, command: &str) -> Result<()> {
        self.board.command(command)?;
        self.board.read_through("$PRAIA", PATIENCE).map(drop)
    }

    /// Sends nothing until the module reports the silence; returns the report, and the level of the
    /// pin then.
    fn fall_silent(&mut self) -> Result<(EpochOutput, bool)> {
        let lines = self.board.read_through("$PRAIS", PATIENCE)?;
        let reported = lines.last().map_or("", String::as_str);
        let reported = sentence::epochs(reported)?.pop().context("the module did not report the silence")?;
        // The log comes over its own port, slightly later.
        let deadline = Instant::now() + PIN_PATIENCE;
        while self.board.pin_is_high() && Instant::now() < deadline {
            std::thread::sleep(Duration::from_millis(20));
        }
        Ok((reported, self.board.pin_is_high()))
    }

    /// Sends one epoch and reads the module's report on it.
    fn judge(&mut self, bytes: &[u8]) -> Result<EpochOutput> {
        self.board.feed(bytes)?;
        let mut lines = self.board.read_through("$PRAIS", PATIENCE)?;
        if lines.last().is_some_and(|line| line.contains(",EXCLUDED,")) {
            let first = self.board.read_line(PATIENCE)?;
            let count = first.split(',').nth(2).and_then(|count| count.parse().ok()).unwrap_or(1);
            lines.push(first);
            for _ in 1..count {
                lines.push(self.board.read_line(PATIENCE)?);
            }
        }
        // The pin's level is in the log, whose last line of an epoch is the time it took.
        self.epochs += 1;
        self.board.log_with(&format!("epoch {} took", self.epochs), 0, PATIENCE)?;
        sentence::epochs(&lines.concat())?.pop().context("the module did not report the epoch")
    }
}

/// Returns the error of the reported position.
fn error(reported: &EpochOutput, site: &Site) -> Option<Enu> {
    reported.position.map(|geodetic| site.frame.rotate(geodetic.to_ecef() - site.position))
}
