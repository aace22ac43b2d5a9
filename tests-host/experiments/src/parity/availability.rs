//! Table 2: share of the time in which the protection level is below the alert limit.
//!
//! `available: HPL = max slope_h √λ < HAL`. Because `slope_h` is proportional to the common sigma,
//! one solution with `σ = 1 m` serves every sigma.

use anyhow::Result;
use indicatif::ProgressBar;
use raim::in_order::Together as _;
use raim::page::canvas::{Mark, SERIES};
use raim::page::chart::{Axis, LineChart, Series};
use raim::signal::sky::{Satellite, Sight, Site, linear, sights};
use raim_core::internals::integrity::raim::detection::threshold::Thresholds;
use raim_core::internals::integrity::raim::levels::largest_slopes;
use raim_core::internals::least_squares::Workspace;

use super::super::{Effort, Finding, Judgement, Picture, Row, Section};
use super::{AVAILABILITY, MASK_RAD, MOST_ROWS, Sky};

const HAL_M: f64 = 500.0;
/// Epochs of one day, evenly from its start.
#[derive(Clone, Copy, Debug)]
struct Window {
    days: u64,
    epochs: u64,
    step_s: f64,
}

/// The paper's 32,400 s, on three days.
const NINE_HOURS: Window = Window { days: 3, epochs: 540, step_s: 60.0 };
/// A week. After it the medium orbits of `BeiDou` repeat, so its result does not depend on the time
/// of the paper's hours.
const WEEK: Window = Window { days: 7, epochs: 144, step_s: 600.0 };
const WINDOWS: [Window; 2] = [NINE_HOURS, WEEK];
const DAY_S: f64 = 86_400.0;
const CORNER_DEG: (f64, f64) = (24.1, 120.6);
const EXTENT_DEG: f64 = 2.0;

/// Masks of the picture, degrees; the table has the first and the third last.
const MASKS_DEG: [f64; 7] = [5.0, 7.5, 10.0, 12.5, 15.0, 17.5, 20.0];
const TABLE_MASKS: [usize; 2] = [0, 4];
const SIGMAS_M: [f64; 3] = [6.0, 20.0, 33.0];

/// Returns the number of points on a side of the grid.
fn side(effort: Effort) -> u32 {
    effort.pick(2, 21)
}

/// Returns the number of points of the grid. The paper's 0.1° give 441, although it states 500.
pub(super) fn points(effort: Effort) -> u32 {
    side(effort) * side(effort)
}

/// Returns the number of steps of the progress bar.
pub(super) fn steps(effort: Effort) -> u64 {
    u64::from(points(effort)) * WINDOWS.iter().map(|window| window.days).sum::<u64>()
}

/// Number of available epochs, by mask, sky and sigma.
#[derive(Clone, Copy, Debug, Default)]
struct Counts {
    epochs: usize,
    available: [[[usize; SIGMAS_M.len()]; Sky::ALL.len()]; MASKS_DEG.len()],
}

impl Counts {
    fn and(mut self, other: &Self) -> Self {
        self.epochs += other.epochs;
        let (own, others) = (self.available.as_flattened_mut(), other.available.as_flattened());
        for (own, other) in own.as_flattened_mut().iter_mut().zip(others.as_flattened()) {
            *own += other;
        }
        self
    }

    /// Returns the share of the epochs, %.
    fn percent(&self, mask: usize, sky: Sky, sigma: usize) -> f64 {
        let sky = Sky::ALL.iter().position(|other| *other == sky).unwrap_or(0);
        100.0 * self.available[mask][sky][sigma] as f64 / self.epochs as f64
    }
}

/// Returns the protection level for a sigma of one metre, m; infinite without redundancy.
fn unit_hpl_m<'s>(seen: impl Iterator<Item = &'s Sight>, thresholds: &Thresholds<'_>) -> Result<f64> {
    let row = |sight: &Sight| linear::Row {
        satellite: sight.satellite,
        line_of_sight: sight.line_of_sight,
        sigma_m: 1.0,
        y_m: 0.0,
    };
    let rows: Vec<linear::Row> = seen.map(row).collect();
    let mut workspace = Workspace::of(linear::equations::<f32, MOST_ROWS>(&rows)?);
    let solved = workspace.solve().ok();
    let hpl_m = solved.and_then(|snapshot| {
        let lambda = thresholds.lambda(snapshot.dof())?;
        Some(largest_slopes(&snapshot).protect(lambda).hpl_m)
    });
    Ok(hpl_m.unwrap_or(f64::INFINITY))
}

fn epoch(satellites: &[Satellite], site: &Site, t_s: f64, counts: &mut Counts) -> Result<()> {
    let thresholds = Thresholds::from_tables(AVAILABILITY, AVAILABILITY)?;
    let seen = sights(satellites, site, t_s, MASK_RAD);
    counts.epochs += 1;
    for (mask_deg, by_sky) in MASKS_DEG.iter().zip(&mut counts.available) {
        let sin_mask = libm::sin(mask_deg.to_radians());
        for (sky, by_sigma) in Sky::ALL.iter().zip(by_sky) {
            let used = seen.iter().filter(|sight| sight.line_of_sight.up >= sin_mask && sky.has(sight));
            let hpl_m = unit_hpl_m(used, &thresholds)?;
            for (sigma_m, available) in SIGMAS_M.iter().zip(by_sigma) {
                *available += usize::from(sigma_m * hpl_m < HAL_M);
            }
        }
    }
    Ok(())
}

fn count(window: Window, effort: Effort, bar: &ProgressBar) -> Result<Counts> {
    let (satellites, side) = (Sky::satellites(), side(effort));
    let coordinate_deg =
        |corner_deg: f64, step: u32| corner_deg + EXTENT_DEG * f64::from(step) / f64::from(side - 1);
    let of = |index: u64| {
        let (point, day) = ((index / window.days) as u32, index % window.days);
        let latitude_deg = coordinate_deg(CORNER_DEG.0, point / side);
        let site = Site::geodetic(latitude_deg, coordinate_deg(CORNER_DEG.1, point % side), 0.0);
        let mut counts = Counts::default();
        for step in 0..window.epochs {
            epoch(&satellites, &site, day as f64 * DAY_S + step as f64 * window.step_s, &mut counts)?;
        }
        bar.inc(1);
        Ok(counts)
    };
    let tasks = u64::from(points(effort)) * window.days;
    (0..tasks).together_sum(of, Counts::default(), |sum, counts| sum.and(&counts))
}

/// Returns the table, and availability over the mask.
pub(super) fn table(effort: Effort, bar: &ProgressBar) -> Result<(Section, Picture)> {
    let (nine_hours, week) = (count(NINE_HOURS, effort, bar)?, count(WEEK, effort, bar)?);
    let mut rows = Vec::new();
    for (mask, printed) in TABLE_MASKS.into_iter().zip(PRINTED) {
        rows.extend(mask_rows(&nine_hours, &week, mask, &printed));
    }
    let title = "Table 2, availability in % of the epochs and points".to_owned();
    Ok((Section { title, rows }, picture(&nine_hours, &week)?))
}

/// Printed values for one mask, %, and the acceptance values of the product.
struct Printed {
    gps: f64,
    beidou: f64,
    both: f64,
    accepted_gps: f64,
}

const PRINTED: [Printed; 2] = [
    Printed { gps: 100.0, beidou: 52.78, both: 100.0, accepted_gps: 100.0 },
    Printed { gps: 87.45, beidou: 42.37, both: 100.0, accepted_gps: 87.5 },
];

const FREE_SIGMA: &str = "sigma is not printed: 20 m fits both masks in the first nine hours of the days";
const FREE_SKY: &str =
    "which satellites, and when, is not printed: with the sigma of GPS this state of BeiDou comes near";
const OTHER_SKY: &str = "the regional system of 14 satellites would nearly always be available";

fn mask_rows(nine_hours: &Counts, week: &Counts, mask: usize, printed: &Printed) -> Vec<Row> {
    let mask_deg = MASKS_DEG[mask];
    let row = |counts: &Counts, sky: Sky, sigma: usize, paper: &str, judgement| {
        let span = if std::ptr::eq(counts, week) { ", over a week" } else { "" };
        let quantity = format!("mask {mask_deg}°, {}, sigma {} m{span}", sky.name(), SIGMAS_M[sigma]);
        Row::new(quantity, paper, Finding::exact(counts.percent(mask, sky, sigma), 2), judgement)
    };
    let [gps, beidou, both] = [printed.gps, printed.beidou, printed.both].map(|percent| percent.to_string());
    vec![
        row(nine_hours, Sky::Gps, 1, &gps, Judgement::Reproduced).because(FREE_SIGMA).held_to(
            10,
            printed.accepted_gps,
            1.5,
        ),
        row(nine_hours, Sky::Gps, 0, "", Judgement::Ours),
        row(nine_hours, Sky::Gps, 2, "", Judgement::Ours),
        row(week, Sky::Gps, 1, "", Judgement::Ours),
        row(week, Sky::Early, 1, &beidou, Judgement::InTrend).because(FREE_SKY),
        row(week, Sky::Regional, 1, &beidou, Judgement::NotReproducible).because(OTHER_SKY),
        row(nine_hours, Sky::Both, 1, &both, Judgement::Reproduced),
    ]
}

fn picture(nine_hours: &Counts, week: &Counts) -> Result<Picture> {
    let lines = [(Sky::Gps, nine_hours), (Sky::Early, week), (Sky::Both, week)];
    let line = |(index, (sky, counts)): (usize, (Sky, &Counts))| {
        let points = MASKS_DEG.iter().enumerate();
        Series {
            name: sky.name().to_owned(),
            colour: SERIES[index],
            mark: Mark::Line,
            points: points.map(|(mask, &mask_deg)| (mask_deg, counts.percent(mask, sky, 1))).collect(),
        }
    };
    let printed = |name: &str, colour, value: fn(&Printed) -> f64| Series {
        name: name.to_owned(),
        colour,
        mark: Mark::Dots,
        points: TABLE_MASKS.into_iter().zip(&PRINTED).map(|(mask, p)| (MASKS_DEG[mask], value(p))).collect(),
    };
    let mut series: Vec<Series> = lines.into_iter().enumerate().map(line).collect();
    series.push(printed("paper, GPS", SERIES[0], |printed| printed.gps));
    series.push(printed("paper, BeiDou", SERIES[1], |printed| printed.beidou));
    let chart = LineChart {
        title: "Availability for an alert limit of 500 m, sigma 20 m".to_owned(),
        x: Axis::linear("mask / °").over(4.0..21.0),
        y: Axis::linear("available / %").over(0.0..104.0),
        series,
        spans: vec![],
    };
    let caption = "Table 2: GPS alone is not always enough, two systems are.";
    Picture::draw("parity-table-2", caption, |ground| chart.svg((860, 420), ground))
}
