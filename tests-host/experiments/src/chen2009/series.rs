//! Figures 1 to 4: stationarity of the clock, and order of its difference.
//!
//! ```text
//! W_t = Z_t − mean Z      x_t = W_t − W_{t−1}
//! ρ_k = γ_k / γ_0         γ_k = (1/n) Σ x_j x_{j+k}
//! φ_kk                    last coefficient of the process of order k, by Durbin's recursion
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | `Z` | solved receiver clock times the speed of light | m |
//! | `ρ_k`, `φ_kk` | autocorrelation and partial autocorrelation at lag `k` | – |
//!
//! The paper shows a recording of an unnamed receiver whose clock has no trend; the frequency
//! offset is left out here for the same reason. Estimated values of white noise lie within
//! `±1.96/√n` with a probability of 95 %. References: [Chen2009] §1.1 and §1.2, eq. 1 and 2.
//!
//! [Chen2009]: raim#references

use std::sync::OnceLock;

use anyhow::Result;
use raim::page::canvas::{BLUE, GREY, Mark};
use raim::page::chart::{Axis, LineChart, Series};
use raim::signal::clock_models::centred_differences;
use raim::signal::sky::{Oscillator, ReceiverClock};
use rand_distr::{Distribution, StandardNormal};

use super::super::draw::generator;
use super::super::{Finding, Judgement, Picture, Row, Section};
use super::{CLOCKS, NOISE_M};
use raim_core::frame::SPEED_OF_LIGHT_M_S;

/// Length of the series, s.
const LENGTH: usize = 600;

/// Number of lags shown.
const LAGS: usize = 20;

const SEED: u64 = 0x0C10_C4F1;

/// Returns solved clocks of one receiver, one second apart, m: oscillator and solution noise, all
/// from one seed.
pub(super) fn solved_clock_m(oscillator: Oscillator, seed: u64, length: usize) -> Vec<f64> {
    let mut clock = ReceiverClock::new(oscillator, 1.0, 0.0, seed);
    // The oscillator draws from stream 0 of the same seed.
    let mut noise = generator(seed, 1);
    let mut solved = || {
        let error: f64 = StandardNormal.sample(&mut noise);
        SPEED_OF_LIGHT_M_S * clock.advance() + NOISE_M * error
    };
    (0..length).map(|_| solved()).collect()
}

/// Returns the autocorrelations at lags 0, 1, …
fn autocorrelations(centred: &[f64]) -> Vec<f64> {
    let lagged =
        |lag: usize| -> f64 { centred.iter().zip(centred.iter().skip(lag)).map(|(a, b)| a * b).sum() };
    (0..=LAGS).map(|lag| lagged(lag) / lagged(0)).collect()
}

/// Returns the partial autocorrelations at lags 1, 2, … by Durbin's recursion.
fn partial_autocorrelations(rho: &[f64]) -> Vec<f64> {
    let (mut coefficients, mut partial): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
    for order in 1..rho.len() {
        let known = coefficients.iter().zip(1..);
        let explained: f64 = known.clone().map(|(phi, lag)| phi * rho[order - lag]).sum();
        let scale: f64 = known.map(|(phi, lag)| phi * rho[lag]).sum();
        let last = (rho[order] - explained) / (1.0 - scale);
        let mirrored = coefficients.iter().rev();
        coefficients = coefficients.iter().zip(mirrored).map(|(phi, back)| phi - last * back).collect();
        coefficients.push(last);
        partial.push(last);
    }
    partial
}

/// Content of the figures.
struct Shown {
    level_m: Vec<f64>,
    difference_m: Vec<f64>,
    level_correlations: Vec<f64>,
    correlations: Vec<f64>,
    partial: Vec<f64>,
}

fn shown() -> &'static Shown {
    static SHOWN: OnceLock<Shown> = OnceLock::new();
    SHOWN.get_or_init(|| {
        let steady = Oscillator { frequency_offset: 0.0, ..CLOCKS[0].oscillator };
        let solved_m = solved_clock_m(steady, SEED, LENGTH);
        let mean_m = solved_m.iter().sum::<f64>() / solved_m.len() as f64;
        let level_m: Vec<f64> = solved_m.iter().map(|level| level - mean_m).collect();
        let (difference_m, _) = centred_differences(&level_m);
        let correlations = autocorrelations(&difference_m);
        let partial = partial_autocorrelations(&correlations);
        Shown { level_correlations: autocorrelations(&level_m), level_m, difference_m, correlations, partial }
    })
}

/// Returns the half width of the band of white noise.
fn band() -> f64 {
    1.96 / libm::sqrt((LENGTH - 1) as f64)
}

/// Returns the number of values outside the band, in words.
fn outside(values: &[f64]) -> Finding {
    let count = values.iter().filter(|value| value.abs() > band()).count();
    Finding::Words(format!("{count} of {}", values.len()))
}

pub(super) fn section() -> Section {
    let shown = shown();
    let row =
        |quantity: &str, paper: &str, ours: Finding, judgement| Row::new(quantity, paper, ours, judgement);
    let wanders = "A random walk of frequency lets ∇W wander too, though over minutes: within a window of 60 s it is \
                   nearly steady, and the window slides.";
    let decays = "The noise of the solutions adds a moving average, of which φ decays without an end: AR(3) is an \
                  approximation here.";
    let rows = vec![
        row(
            "ρ at lag 1 of W",
            "not stationary",
            Finding::exact(shown.level_correlations[1], 3),
            Judgement::Reproduced,
        ),
        row(
            "ρ at lag 20 of W",
            "not stationary",
            Finding::exact(shown.level_correlations[LAGS], 3),
            Judgement::Reproduced,
        ),
        row(
            "ρ at lag 20 of ∇W",
            "stationary",
            Finding::exact(shown.correlations[LAGS], 3),
            Judgement::NotReproducible,
        )
        .because(wanders),
        row(
            "ρ of ∇W beyond white noise, lags 1 to 20",
            "tails off",
            outside(&shown.correlations[1..]),
            Judgement::InTrend,
        )
        .because("It tails off, with the random walk of frequency more slowly than in any AR(3)."),
        row(
            "φ of ∇W beyond white noise, lags 4 to 20",
            "breaks off",
            outside(&shown.partial[3..]),
            Judgement::NotReproducible,
        )
        .because(decays),
    ];
    Section { title: format!("Figures 1–4: a clock of {LENGTH} s"), rows }
}

pub(super) fn pictures() -> Result<Vec<Picture>> {
    let shown = shown();
    let seconds = |values: &[f64]| (0..).map(f64::from).zip(values.iter().copied()).collect::<Vec<_>>();
    let lags = |values: &[f64]| (1..).map(f64::from).zip(values.iter().copied()).collect::<Vec<_>>();
    let line = |name: &str, points| Series { name: name.into(), colour: BLUE, mark: Mark::Line, points };
    let lines = [
        (
            "chen2009-figure-1",
            "Figure 1: the clock less its mean",
            "W / m",
            line("solved clock", seconds(&shown.level_m)),
            "A solved receiver clock without frequency offset: it wanders.",
        ),
        (
            "chen2009-figure-2",
            "Figure 2: its first difference",
            "∇W / m",
            line("difference", seconds(&shown.difference_m)),
            "Its first difference is noise about a frequency that wanders far more slowly.",
        ),
    ];
    let mut pictures = Vec::new();
    for (name, title, label, series, caption) in lines {
        let chart = LineChart {
            title: title.into(),
            x: Axis::linear("time / s").over(0.0..LENGTH as f64),
            y: Axis::linear(label),
            series: vec![series],
            spans: Vec::new(),
        };
        pictures.push(Picture::draw(name, caption, |ground| chart.svg(SIZE, ground))?);
    }
    let correlations = [
        (
            "chen2009-figure-3",
            "Figure 3: autocorrelation of the difference",
            "autocorrelation ρ",
            &shown.correlations[1..],
            "Autocorrelation of the difference: solution noise pulls the first lag down, the wandering frequency holds the others up.",
        ),
        (
            "chen2009-figure-4",
            "Figure 4: partial autocorrelation of the difference",
            "partial autocorrelation φ",
            &shown.partial[..],
            "Partial autocorrelation of the difference: it decays over ten lags and does not break off after the third.",
        ),
    ];
    for (name, title, label, values, caption) in correlations {
        let chart = stems(title, label, &lags(values));
        pictures.push(Picture::draw(name, caption, |ground| chart.svg(SIZE, ground))?);
    }
    Ok(pictures)
}

/// Width and height of these pictures, pixels.
const SIZE: (u32, u32) = (760, 320);

/// Draws a stem from zero for each lag, with the band of white noise.
fn stems(title: &str, label: &str, points: &[(f64, f64)]) -> LineChart {
    let stem = |&(lag, value): &(f64, f64)| [(lag, 0.0), (lag, value), (lag, f64::NAN)];
    let stems = points.iter().flat_map(stem).collect();
    let level = |value: f64| vec![(0.0, value), (LAGS as f64 + 1.0, value)];
    let bound = |name: &str, value| Series {
        name: name.into(),
        colour: GREY,
        mark: Mark::Dashed,
        points: level(value),
    };
    LineChart {
        title: title.into(),
        x: Axis::linear("lag / s").over(0.0..LAGS as f64 + 1.0),
        y: Axis::linear(label),
        series: vec![
            bound("95 % of white noise", band()),
            bound("", -band()),
            Series { name: String::new(), colour: BLUE, mark: Mark::Line, points: stems },
            Series { name: "estimated".into(), colour: BLUE, mark: Mark::Dots, points: points.to_vec() },
        ],
        spans: Vec::new(),
    }
}
