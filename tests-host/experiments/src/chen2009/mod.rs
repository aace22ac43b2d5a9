//! X. Chen et al. 2009: a forecast of the receiver clock as one more range.
//!
//! | content | module | chance |
//! |---|---|---|
//! | figures 1–4: the clock, its difference, autocorrelations | [`series`] | one clock |
//! | "U-C is the most accurate estimator" | [`estimators`] | synthetic processes |
//! | table 1 and figure 5: ten epochs forecast | [`forecast`] | simulated clocks |
//! | figure 6: size of a detected bias | [`detection`] | none: the exact distribution |
//! | 4 satellites detect, 5 identify, a jump is the clock's | [`vectors`] | none: reference epochs |
//!
//! Run `r` of a table draws from stream `r`, so its numbers do not depend on the number of threads.
//!
//! References: [Chen2009]; [`raim_core::internals::clock`] lists the module's departures from it.
//!
//! [Chen2009]: raim#references

mod detection;
mod estimators;
mod forecast;
mod series;
mod vectors;

use anyhow::Result;
use indicatif::ProgressBar;
use raim::signal::sky::Oscillator;

use super::{Effort, Experiment, Outcome};

/// Entry for the command line.
pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "chen2009",
    about: "a receiver clock that is forecast: its accuracy, and what it adds to the test",
    run,
};

fn run(effort: Effort, bar: &ProgressBar) -> Result<Outcome> {
    let runs = effort.pick(100, RUNS);
    let processes = effort.pick(1_000, 10_000);
    let moments = effort.pick(24, 96);
    bar.set_length((CLOCKS.len() * runs + processes + detection::SIGMAS_M.len() * moments) as u64);

    let mut sections = vec![series::section(), estimators::section(processes, bar)];
    sections.extend(forecast::sections(runs, bar));
    sections.extend(detection::sections(moments, bar));
    sections.push(vectors::section()?);
    let mut pictures = series::pictures()?;
    pictures.push(forecast::picture()?);
    pictures.push(detection::picture(moments)?);
    Ok(Outcome {
        name: EXPERIMENT.name,
        title: "Chen, Teng, Xu 2009: a receiver clock that is forecast aids RAIM".into(),
        setup: format!(
            "Clocks: oscillators with white, flicker and random-walk frequency noise, frequency offset 1e-7, read once a \
             second with {NOISE_M} m of solution noise; windows of {WINDOW} values, {runs} runs. Estimators: {processes} \
             synthetic processes. Detection: GPS of 24 satellites above Chengdu, mask 10°, false alarms 1e-3, every \
             satellite faulty in turn, {moments} instants of one day. Seeds are fixed."
        ),
        sections,
        pictures,
    })
}

/// Number of runs of table 1.
const RUNS: usize = 200;

/// Number of values before a forecast; the paper gives none.
const WINDOW: usize = raim_core::internals::clock::WINDOW;

/// Number of epochs forecast ([Chen2009] §3.1).
///
/// [Chen2009]: raim#references
const AHEAD: usize = 10;

/// Standard deviation of a solved clock about the true one, m, of a good receiver in the open.
const NOISE_M: f64 = 0.3;

/// An oscillator with its name in tables.
struct Clock {
    name: &'static str,
    oscillator: Oscillator,
}

/// The clock of table 1, then a noisier and a quieter one.
const CLOCKS: [Clock; 3] = [
    Clock { name: "good crystal", oscillator: Oscillator::oven_controlled() },
    Clock { name: "TCXO", oscillator: Oscillator::temperature_compensated() },
    Clock { name: "OCXO", oscillator: OVEN_OF_BROWN },
];

/// The oven-controlled crystal of [Brown1997] table 10.2.
///
/// [Brown1997]: raim#references
const OVEN_OF_BROWN: Oscillator =
    Oscillator { white_s: 8e-20, flicker: 2e-21, walk_hz: 4e-23, frequency_offset: 1e-7 };
