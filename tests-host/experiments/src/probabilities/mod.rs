//! Counted rates of false alarms and missed detections of the core itself, compared with the
//! required probabilities.
//!
//! | content | module |
//! |---|---|
//! | satellites over a day, simulated and recorded, with simulated noise | [`geometry`] |
//! | rates of rare events, by importance sampling | [`sampling`] |
//! | skies of six to forty satellites | [`skies`] |
//! | risk that a level lets pass, over every size of the fault | [`worst`] |
//! | the same for the whole monitor, by every method | [`every_method`] |
//! | detection and exclusion at the edge of availability | [`edge`], [`exclusion`] |
//! | false alarms there by every setting of the noise | [`noise`] |
//! | a day of positions with errors above their promise | [`day`], [`disc`] |
//!
//! Rates are multiples of the required probability, so 1 is exact. Every interval is one of 95 %,
//! of which one in twenty misses its value by chance. The requirement is therefore that all of them
//! together hold with 95 %, each widened by Bonferroni's inequality.

mod day;
mod disc;
pub(super) mod edge;
mod every_method;
mod exclusion;
mod geometry;
pub(super) mod noise;
mod sampling;
mod skies;
mod worst;

use anyhow::{Context as _, Result};
use indicatif::ProgressBar;
use raim::page::stanford;
use raim::signal::sky::Site;
use raim::signal::sky::linear::Sigma;
use raim_core::internals::integrity::raim::detection::threshold::{
    Thresholds, false_alarms, missed_detections,
};
use raim_core::internals::numeric::probability::Probability;
use raim_core::requirements::Requirements;
use raim_core::satellite::Constellation;
use raim_firmware::correction::CAPACITY;

use super::{Effort, Experiment, Finding, Interval, Judgement, Outcome, Picture, Row, Section};
use day::{Day, DayOutcomes};
use geometry::Geometry;
use sampling::Sample;

/// Entry for the command line.
pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "probabilities",
    about: "false alarms and missed detections, counted against what was asked for",
    run,
};

/// Elevation mask, degrees.
const MASK_DEG: f64 = 10.0;
/// Standard deviation of a range of the simulated sky.
const SIGMA: Sigma = Sigma::Cosecant(ZENITH_M);
/// Standard deviation in the zenith, m.
const ZENITH_M: f64 = 1.5;
/// Receiver clocks times the speed of light by constellation, m.
const CLOCKS_M: [f64; Constellation::COUNT] = [30_000.0, 30_040.0, 30_010.0, 30_090.0];
/// Seed of all random choices.
const SEED: u64 = 1000;
/// The two instantiations of the core.
const SCALARS: [&str; 2] = ["f32", "f64"];
/// Alert limit of the tighter day, m.
const TIGHT_M: f64 = 8.0;
/// Number of kinds of sky whose rates are sampled: simulated and recorded.
const SKIES: usize = 2;
/// Number of required counts of each day: misleading and hazardous.
const HELD_OF_A_DAY: usize = 2;
/// Number of days: each of two alert limits without and with a fault.
const DAYS: usize = 4;

/// Returns the number of required intervals; the recorded ones count even if the recordings are
/// missing.
fn family() -> usize {
    SKIES * SCALARS.len() * (false_alarms().len() + missed_detections().len()) + DAYS * HELD_OF_A_DAY
}

fn run(effort: Effort, bar: &ProgressBar) -> Result<Outcome> {
    bar.set_length((SKIES + DAYS) as u64);
    let draws = effort.pick(10_000, 400_000);
    let site = Site::geodetic(34.17, 108.57, 400.0);
    let mut sections = rates("simulated sky", &geometry::simulated(&site), draws, 0)?;
    bar.inc(1);
    sections.extend(recorded_rates(draws)?);
    bar.inc(1);
    sections.extend(worst::sections(effort, &site)?);
    sections.extend(every_method::sections(effort, &site)?);
    let (days, picture) = days(effort, site, bar)?;
    sections.extend(days);
    Ok(Outcome {
        name: EXPERIMENT.name,
        title: "The probabilities are what they say".into(),
        setup: setup(draws),
        sections,
        pictures: vec![picture],
    })
}

/// Returns the rates of the recordings; only a title if they are missing.
fn recorded_rates(draws: usize) -> Result<Vec<Section>> {
    if let Some(geometries) = geometry::recorded()? {
        return rates("recordings of Esbjerg and Diego Garcia", &geometries, draws, 1);
    }
    let title = "The recordings of Esbjerg and Diego Garcia: skipped, the reference folder is missing";
    Ok(vec![Section { title: title.into(), rows: vec![] }])
}

fn setup(draws: usize) -> String {
    format!(
        "Geometries of every half hour of a day: the simulated sky above Xi'an (GPS alone, and with BeiDou; sigma \
         {ZENITH_M} m / sin of the elevation), and real recordings with the module's own sigmas (Esbjerg with three \
         systems, Diego Garcia with GPS); mask {MASK_DEG} deg. The noise is ours, Gaussian with just these sigmas. \
         Each rate is of {draws} draws by importance sampling, over what was asked for: 1 is what it says. Held: all \
         {} intervals together at 95 % (Bonferroni), and those of the methods as a family of their own. The skies of 6 to \
         40 satellites are above 5 deg. Seeds are fixed.",
        family()
    )
}

/// Returns the two sections of one kind of sky; the lane separates its draws from the others'.
fn rates(sky: &str, geometries: &[Geometry], draws: usize, lane: u64) -> Result<Vec<Section>> {
    let seed = |number: usize| SEED + 100 * lane + number as u64;
    let (mut alarms, mut misses) = (Vec::new(), Vec::new());
    for (number, &asked) in false_alarms().iter().enumerate() {
        let thresholds = Thresholds::from_tables(asked, missed_detections()[0])?;
        let sample = sampling::false_alarms(geometries, &thresholds, draws, seed(number))?;
        alarms.extend(rows("P_fa", asked, &sample));
    }
    for (number, &asked) in missed_detections().iter().enumerate() {
        let false_alarm = Requirements::non_precision_approach().false_alarm;
        let thresholds = Thresholds::from_tables(false_alarm, asked)?;
        let sample = sampling::missed_detections(geometries, &thresholds, draws, seed(50 + number))?;
        misses.extend(rows("P_md", asked, &sample));
    }
    let dof = || geometries.iter().map(Geometry::dof);
    let (low, high) = (dof().min().unwrap_or(0), dof().max().unwrap_or(0));
    let of = format!("{sky}, {} geometries with {low} to {high} degrees of freedom", geometries.len());
    Ok(vec![
        Section { title: format!("False alarms over P_fa: {of}"), rows: alarms },
        Section {
            title: format!(
                "Missed over P_md, the bias that moves the position by the HPL, P_fa 3.33e-7: {of}"
            ),
            rows: misses,
        },
    ])
}

fn rows(name: &str, asked: Probability, sample: &Sample) -> Vec<Row> {
    let row = |(scalar, scalar_name): (usize, &&str)| {
        let relative: Vec<f64> = sample.weights[scalar].iter().map(|weight| weight / asked.get()).collect();
        let value = relative.iter().sum::<f64>() / relative.len() as f64;
        let interval = Interval::of_mean(&relative);
        let finding = Finding::Number { value, decimals: 3, interval: Some(interval) };
        Row::new(format!("{name} {}, {scalar_name}", in_print(asked)), "", finding, Judgement::Ours)
            .because(format!(
                "{} of {} draws; f32 and f64 differ in {}",
                sample.hits(scalar),
                relative.len(),
                sample.disagreements()
            ))
            .holding("1", interval.as_one_in(family()).contains(1.0))
    };
    SCALARS.iter().enumerate().map(row).collect()
}

/// Formats a probability as required: 1/15000 differs from its rounding.
fn in_print(asked: Probability) -> String {
    let is_fraction = (asked.get() * 15_000.0 - 1.0).abs() < 1e-9;
    if is_fraction { "1/15000".into() } else { format!("{:e}", asked.get()) }
}

fn days(effort: Effort, site: Site, bar: &ProgressBar) -> Result<(Vec<Section>, Picture)> {
    let approach = Requirements::non_precision_approach();
    let tight = approach.with_hal_m(TIGHT_M);
    let (step_s, epochs) = effort.pick((60.0, 1_440), (1.0, 86_400));
    let thresholds = Thresholds::from_tables(approach.false_alarm, approach.missed_detection)?;
    let (mut sections, mut tallies) = (Vec::new(), Vec::new());
    for (is_faulty, requirements) in [(false, approach), (false, tight), (true, approach), (true, tight)] {
        let seed = SEED + 200 + u64::from(is_faulty);
        let day = Day { site, requirements, thresholds, epochs, step_s, is_faulty, seed };
        let tally = day.tally()?;
        sections.push(section(&day, &tally));
        tallies.push(tally);
        bar.inc(1);
    }
    let moments = tallies.pop().context("a day")?.moments;
    let caption = format!(
        "The worst-case bias in every epoch, alert limit {TIGHT_M} m; one epoch a minute, and every misleading one. \
         What is detected and left out stands at the left; a misleading epoch stands to the right of the diagonal."
    );
    let picture = Picture::draw("probabilities-stanford", &caption, |ground| {
        stanford::horizontal(&moments, stanford::WIDTH_PX, ground)
    })?;
    Ok((sections, picture))
}

fn section(day: &Day, tally: &DayOutcomes) -> Section {
    let fault = if day.is_faulty { "the worst-case bias in every epoch" } else { "without a fault" };
    let (low_m, high_m) = tally.levels_m.unwrap_or((f64::NAN, f64::NAN));
    let exact = |count: usize| Finding::exact(count as f64, 0);
    let held = |what: &str, count: usize, expected: f64| {
        let holds = Interval::of_one_count_in(family(), count).contains(expected);
        Row::new(what, "", Finding::count(count), Judgement::Ours)
            .holding(format!("{expected:.3} expected"), holds)
    };
    let spared = format!("expected protected with nobody left out: {:.2}", tally.missed);
    let alerts = format!("{} alerts, {} unavailable", tally.whole.alerts, tally.whole.unavailable);
    let (whole, reduced) = (tally.whole, tally.reduced);
    Section {
        title: format!(
            "A day of {} epochs, {fault}, HAL {} m (HPL {low_m:.1} to {high_m:.1} m)",
            day.epochs, day.requirements.hal_m
        ),
        rows: vec![
            Row::new("protected, nobody left out", "", exact(whole.promised), Judgement::Ours)
                .because(spared),
            held("of these misleading (error > HPL)", whole.misleading, tally.misleading),
            held("of these hazardous (error > HAL)", whole.hazardous, tally.hazardous),
            Row::new("protected, somebody left out", "", exact(reduced.promised), Judgement::Ours)
                .because(alerts),
            Row::new("of these misleading", "", exact(reduced.misleading), Judgement::Ours),
            Row::new("of these hazardous", "", exact(reduced.hazardous), Judgement::Ours),
        ],
    }
}
