//! [Lin2016]: least-squares RAIM on the regional `BeiDou` system, for a day with one epoch per
//! minute.
//!
//! | content | module |
//! |---|---|
//! | figure 3, one fault of 80 m | [`single`] |
//! | figures 4 and 5, rates against the bias | [`rates`] |
//! | thresholds, availability by the change of HDOP (eq. 13, 22–26) | here |
//! | identities of the algorithms | [`identities`] |
//!
//! The paper does not give the place of its receiver. Here it is Nanjing, where two of its authors
//! work.

mod identities;
mod rates;
mod single;

use anyhow::Context as _;
use indicatif::ProgressBar;
use raim::page::canvas::{BLUE, Mark, ORANGE};
use raim::page::chart::{Axis, LineChart, Series};
use raim::signal::sky::linear::{self, Sigma, equations};
use raim::signal::sky::{Fleet, Noise, Sight, Site, sights};
use raim_core::internals::integrity::raim::detection::threshold::Thresholds;
use raim_core::internals::integrity::raim::detection::threshold::policy::range_threshold_m;
use raim_core::internals::integrity::raim::levels::{hdop_change_limit, largest_hdop_change, largest_slopes};
use raim_core::internals::least_squares::Workspace;
use raim_core::internals::numeric::probability::Probability;
use raim_core::internals::numeric::real::Real;
use raim_core::satellite::Constellation;

use super::{Effort, Experiment, Finding, Judgement, Outcome, Picture, Row, Section};

/// Entry for the command line.
pub(super) const EXPERIMENT: Experiment =
    Experiment { name: "lin2016", about: "a fault of 80 m, rates of detection and identification", run };

/// Capacity in rows; at most 14 satellites are in view.
const ROWS: usize = 16;
/// Standard deviation of a range, m.
const SIGMA_M: f64 = 6.0;
/// Elevation mask, degrees.
const MASK_DEG: f64 = 10.0;
/// Number of epochs of the day, both midnights included.
const EPOCHS: usize = 1441;
/// Time between epochs, s.
const STEP_S: f64 = 60.0;
/// Horizontal alert limit of a non-precision approach, m.
const HAL_M: f64 = 556.0;
/// Probability of a false alarm per epoch.
const FALSE_ALARM: f64 = 1e-4;
/// Probability of a missed detection.
const MISSED_DETECTION: f64 = 1e-6;
/// Seed of all random choices.
const SEED: u64 = 2016;

/// Sky of the day, with the thresholds of its tests.
struct Day {
    views: Vec<Vec<Sight>>,
    thresholds: Thresholds<'static>,
    noise: Noise,
}

impl Day {
    fn above(site: &Site) -> anyhow::Result<Self> {
        let satellites = Fleet::BeidouRegional.satellites();
        let view = |epoch| sights(&satellites, site, epoch as f64 * STEP_S, MASK_DEG.to_radians());
        let probability = |tail| Probability::new(tail).context("a probability");
        let thresholds = Thresholds::from_tables(probability(FALSE_ALARM)?, probability(MISSED_DETECTION)?)?;
        Ok(Self { views: (0..EPOCHS).map(view).collect(), thresholds, noise: Noise::new(SEED) })
    }

    /// Returns the rows of one epoch; each trial has its own noise.
    fn rows(&self, epoch: usize, trial: usize) -> Vec<linear::Row> {
        let number = trial * EPOCHS + epoch;
        let clocks_m = [0.0; Constellation::COUNT];
        linear::rows(&self.views[epoch], Sigma::Constant(SIGMA_M), clocks_m, &self.noise, number as u64)
    }

    /// Returns every epoch of the day in double precision, ready to be solved.
    fn workspaces(&self) -> impl Iterator<Item = anyhow::Result<Workspace<f64, ROWS>>> {
        (0..EPOCHS).map(|epoch| pose(&self.rows(epoch, 0)))
    }
}

/// Returns the equations of rows, ready to be solved.
fn pose<T: Real>(rows: &[linear::Row]) -> anyhow::Result<Workspace<T, ROWS>> {
    Ok(Workspace::of(equations(rows)?))
}

/// Returns the same rows with a bias on one of them.
fn faulty(rows: &[linear::Row], index: usize, bias_m: f64) -> Vec<linear::Row> {
    let mut rows = rows.to_vec();
    rows[index].y_m += bias_m;
    rows
}

fn run(effort: Effort, bar: &ProgressBar) -> anyhow::Result<Outcome> {
    bar.set_length(4);
    let day = Day::above(&Site::geodetic(32.06, 118.79, 0.0))?;
    let trials = effort.pick(2, 50);
    let (single, single_picture) = single::figure_3(&day)?;
    bar.inc(1);
    let (rates, rates_pictures) = rates::figures_4_and_5(&day, trials)?;
    bar.inc(1);
    let (availability, availability_picture) = availability(&day)?;
    bar.inc(1);
    let identities = identities::section(&day)?;
    bar.inc(1);
    let sections = [vec![thresholds(&day), single], rates, vec![availability, identities]].concat();
    let pictures = [vec![single_picture], rates_pictures, vec![availability_picture]].concat();
    let setup = format!(
        "BeiDou regional system, 14 satellites, phases by us; Nanjing (32.06 N 118.79 E, by us), mask {MASK_DEG} deg, \
         sigma {SIGMA_M} m, P_fa {FALSE_ALARM:e}, P_md {MISSED_DETECTION:e}, {EPOCHS} epochs of {STEP_S} s; \
         rates of {} trials a bias; seed {SEED}.",
        trials * EPOCHS
    );
    let title = "Lin 2016: BeiDou receiver autonomous integrity monitoring, and what it performs";
    Ok(Outcome { name: EXPERIMENT.name, title: title.into(), setup, sections, pictures })
}

/// Thresholds, m, from an independent program with fifty digits.
const THRESHOLDS_M: [(usize, f64); 7] = [
    (4, 14.546_982),
    (5, 13.614_800),
    (6, 12.928_188),
    (7, 12.395_795),
    (8, 11.967_637),
    (9, 11.613_776),
    (10, 11.315_054),
];

fn thresholds(day: &Day) -> Section {
    let row = |(dof, want_m): (usize, f64)| {
        let have_m = day.thresholds.tau1(dof).map_or(f64::NAN, |tau| range_threshold_m(tau, dof, SIGMA_M));
        let quantity = format!("threshold with {dof} degrees of freedom, m");
        Row::new(quantity, "", Finding::exact(have_m, 6), Judgement::Ours).held_to(3, want_m, 1e-6)
    };
    Section { title: "Thresholds (eq. 13)".into(), rows: THRESHOLDS_M.map(row).into() }
}

/// Protection in one epoch.
struct Protection {
    hpl_m: f64,
    hdop_change: f64,
    hdop_change_limit: f64,
}

fn availability(day: &Day) -> anyhow::Result<(Section, Picture)> {
    let protection = |workspace: anyhow::Result<Workspace<f64, ROWS>>| {
        let mut workspace = workspace?;
        let snapshot = workspace.solve()?;
        let lambda = day.thresholds.lambda(snapshot.dof()).context("beyond the tables")?;
        Ok(Protection {
            hpl_m: largest_slopes(&snapshot).protect(lambda).hpl_m,
            hdop_change: largest_hdop_change(&snapshot),
            hdop_change_limit: hdop_change_limit(HAL_M, SIGMA_M, lambda),
        })
    };
    let protections: Vec<Protection> = day.workspaces().map(protection).collect::<anyhow::Result<_>>()?;
    let count = |available: fn(&Protection) -> bool| {
        let count = protections.iter().filter(|&protection| available(protection)).count();
        Finding::Words(format!("{count} of {EPOCHS}"))
    };
    let levels_m = || protections.iter().map(|protection| protection.hpl_m);
    let (low_m, high_m) = (levels_m().fold(f64::INFINITY, f64::min), levels_m().fold(0.0, f64::max));
    let by_level = |protection: &Protection| protection.hpl_m < HAL_M;
    let by_change = |protection: &Protection| protection.hdop_change < protection.hdop_change_limit;
    let reference = "an independent program on the same sky has 34 to 115 m";
    let rows = vec![
        Row::new("smallest HPL, m", "", Finding::exact(low_m, 1), Judgement::Ours).because(reference),
        Row::new("largest HPL, m", "below 556", Finding::exact(high_m, 1), Judgement::Reproduced),
        Row::new("epochs available by HPL", "", count(by_level), Judgement::Ours),
        Row::new(
            "epochs available by the change of HDOP",
            "the same",
            count(by_change),
            Judgement::Reproduced,
        ),
    ];
    let title = format!("Availability with an alert limit of {HAL_M} m (eq. 22–26)");
    Ok((Section { title, rows }, picture_of_availability(&protections)?))
}

fn picture_of_availability(protections: &[Protection]) -> anyhow::Result<Picture> {
    let series = |name: &str, colour, mark, value: fn(&Protection) -> f64| Series {
        name: name.to_owned(),
        colour,
        mark,
        points: (0..).zip(protections).map(|(epoch, point)| (f64::from(epoch), value(point))).collect(),
    };
    let chart = LineChart {
        title: "Availability: the change of HDOP stays far below its limit".into(),
        x: Axis::linear("time / min").over(0.0..1440.0),
        y: Axis::linear("change of HDOP").over(0.0..12.0),
        series: vec![
            series("largest of all satellites", BLUE, Mark::Line, |point| point.hdop_change),
            series("limit for 556 m", ORANGE, Mark::Dashed, |point| point.hdop_change_limit),
        ],
        spans: Vec::new(),
    };
    let caption = "The largest change of HDOP that leaving out one satellite brings, and the change at which the \
                   protection level would reach the alert limit.";
    Picture::draw("lin2016-availability", caption, |ground| chart.svg((900, 340), ground))
}
