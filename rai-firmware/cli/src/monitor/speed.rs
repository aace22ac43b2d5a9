//! Speed at which a file is shown.

use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context as _, ensure};

/// Longest time before a change of speed takes effect.
const SLICE: Duration = Duration::from_millis(50);

/// Factor between two speeds that a key chooses.
const STEP: f64 = 2.0;

/// Speed as a multiple of the recorded one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Speed {
    /// Seconds of the file in a second; positive.
    Times(f64),
    /// The highest speed at which the module can judge.
    Max,
}

impl Speed {
    /// Reads a positive number, or `max`.
    ///
    /// # Errors
    /// The text is neither a positive number nor `max`.
    pub fn parse(text: &str) -> anyhow::Result<Self> {
        if text.eq_ignore_ascii_case("max") {
            return Ok(Self::Max);
        }
        let times: f64 = text.parse().ok().context("must be a number or max")?;
        ensure!(times > 0.0 && times.is_finite(), "must be more than 0");
        Ok(Self::Times(times))
    }
}

impl std::fmt::Display for Speed {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Times(times) => write!(formatter, "{times} ×"),
            Self::Max => formatter.write_str("max"),
        }
    }
}

/// State that keys change while a file is shown; shared by the keys and the file's thread.
#[derive(Clone, Debug)]
pub struct Control(Arc<Mutex<State>>);

#[derive(Debug)]
struct State {
    speed: Speed,
    seeks_alert: bool,
}

impl Control {
    /// Returns the control with a start speed.
    pub fn new(speed: Speed) -> Self {
        Self(Arc::new(Mutex::new(State { speed, seeks_alert: false })))
    }

    fn with<T>(&self, act: impl FnOnce(&mut State) -> T) -> T {
        act(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Returns the speed.
    pub fn speed(&self) -> Speed {
        self.with(|state| state.speed)
    }

    /// Doubles the speed.
    pub fn faster(&self) {
        self.with(|state| {
            if let Speed::Times(times) = &mut state.speed {
                *times *= STEP;
            }
        });
    }

    /// Halves the speed; from the highest it returns to that of the recording.
    pub fn slower(&self) {
        self.with(|state| {
            state.speed = match state.speed {
                Speed::Times(times) => Speed::Times(times / STEP),
                Speed::Max => Speed::Times(1.0),
            };
        });
    }

    /// Skips to the next alert.
    pub fn seek_alert(&self) {
        self.with(|state| state.seeks_alert = true);
    }

    /// Returns true while the next alert is sought.
    pub fn seeks_alert(&self) -> bool {
        self.with(|state| state.seeks_alert)
    }

    /// Takes the state of an epoch; an alert ends the search for one.
    pub fn judged(&self, state: char) {
        if state == 'A' {
            self.with(|known| known.seeks_alert = false);
        }
    }

    /// Lets time of the recording pass. A change of speed takes effect at once.
    pub fn wait(&self, mut left_s: f64) {
        while left_s > 0.0 {
            let speed = self.with(|state| (!state.seeks_alert).then_some(state.speed));
            let Some(Speed::Times(times)) = speed else { return };
            let begun = Instant::now();
            thread::sleep(SLICE.min(Duration::try_from_secs_f64(left_s / times).unwrap_or(SLICE)));
            left_s -= begun.elapsed().as_secs_f64() * times;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speeds_are_positive_numbers_or_max() {
        assert_eq!(Speed::parse("2.5").unwrap(), Speed::Times(2.5));
        assert_eq!(Speed::parse("MAX").unwrap(), Speed::Max);
        for text in ["0", "-1", "NaN", "inf", "fast", ""] {
            assert!(Speed::parse(text).is_err(), "{text}");
        }
    }

    #[test]
    fn time_passes_at_the_speed_and_not_at_all_while_an_alert_is_sought() {
        let control = Control::new(Speed::Times(100.0));
        let begun = Instant::now();
        control.wait(20.0);
        let passed_s = begun.elapsed().as_secs_f64();
        assert!((0.19..2.0).contains(&passed_s), "{passed_s} s");
        control.seek_alert();
        control.wait(1e9);
        control.judged('P');
        assert!(control.seeks_alert());
        control.judged('A');
        assert!(!control.seeks_alert());
        let highest = Control::new(Speed::Max);
        highest.wait(1e9);
        highest.faster();
        highest.slower();
        assert_eq!(highest.speed(), Speed::Times(1.0));
        highest.faster();
        assert_eq!(highest.speed(), Speed::Times(2.0));
    }
}
