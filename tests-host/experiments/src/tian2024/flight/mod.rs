//! Tables 6 to 9: a flight with three, two, one and no fault, and the cost of judging it.
//!
//! The flight goes from Beijing (ZBAA) to Shanghai (ZSSS) along the great circle, with climb and
//! descent, and with 10.5 m of noise on every range. There are two skies: all satellites in view,
//! and 22 of them (nine of GPS, the highest, and 13 of `BeiDou`, drawn anew in every epoch), whose
//! fault-free error is near the printed one.

mod tables;

use anyhow::{Context as _, Result};
use indicatif::ProgressBar;
use raim::in_order::Together as _;
use raim::second_opinion::ransac_traditional::combination_count;
use raim::signal::sky::linear::{Sigma, equations, rows};
use raim::signal::sky::{Noise, Satellite, Sight, Site, sights};
use raim_core::internals::integrity::raim::isolation::parity;
use raim_core::internals::integrity::raim::isolation::ransac::{MAX_WORK, Selection};
use raim_core::internals::least_squares::{Snapshot, Workspace};

use super::super::draw::{distinct, generator};
use super::super::{Effort, Picture, Section};
use super::method::{Answer, Limits, Method, ROWS, Traditional};
use super::{BIAS_M, CLOCKS_M, MASK_RAD, Sky, fleets, most_subsets};

const SECONDS: u64 = 7080;
const SIGMA_M: f64 = 10.5;
const SEED: u64 = 0xF117;

/// Latitude and longitude of the airports, degrees, and their heights, m.
const BEIJING: [f64; 3] = [40.0 + 4.4 / 60.0, 116.0 + 35.9 / 60.0, 35.3];
const SHANGHAI: [f64; 3] = [31.0 + 11.8 / 60.0, 121.0 + 20.1 / 60.0, 3.0];
/// Height of the cruise, m, and durations of climb and descent, s.
const CRUISE_M: f64 = 10_000.0;
const CLIMB_S: f64 = 1200.0;
const DESCENT_S: f64 = 1500.0;

/// A stretch of the flight: its last second and the faults in it.
#[derive(Clone, Copy, Debug)]
struct Segment {
    end_s: u64,
    faults: usize,
}

const SEGMENTS: [Segment; 4] = [
    Segment { end_s: 2000, faults: 3 },
    Segment { end_s: 4000, faults: 2 },
    Segment { end_s: 6000, faults: 1 },
    Segment { end_s: SECONDS, faults: 0 },
];

/// Satellites that the receiver uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum View {
    All,
    Thinned,
}

const VIEWS: [View; 2] = [View::All, View::Thinned];
const THINNED_GPS: usize = 9;
const THINNED_BEIDOU: usize = 13;

/// Judges of an epoch. The first accepts every satellite.
const JUDGES: [&str; 5] =
    ["all in view", "parity, sequential", "traditional, consensus", "traditional, as printed", "improved"];
const PRINTED_CRITERION: usize = 3;
const IMPROVED: usize = 4;

/// Opinion of one judge about one epoch.
#[derive(Clone, Debug)]
struct Opinion {
    answer: Answer,
    horizontal_m: f64,
    up_m: f64,
}

/// One epoch in one view.
#[derive(Clone, Debug)]
struct Sample {
    second: u64,
    faulty: Vec<usize>,
    /// Opinions by judge; `None` for a judge that did not run.
    opinions: [Option<Opinion>; JUDGES.len()],
    work: Work,
}

/// Work of judging an epoch, in units independent of the machine.
#[derive(Clone, Copy, Debug)]
struct Work {
    satellites: usize,
    /// Number of sets that sequential isolation examines.
    sets: usize,
    /// Number of triangles and tetrahedra in the choice of subsets.
    tetrahedra: usize,
    /// Number of subsets that are solved.
    chosen: usize,
    /// Number of subsets that the traditional method solves.
    minimal: f64,
}

/// Returns the time between epochs, s.
fn step_s(effort: Effort) -> u64 {
    effort.pick(20, 1)
}

/// Returns the time between epochs in which the traditional method runs too, s.
fn stride_s(effort: Effort) -> u64 {
    effort.pick(120, 40)
}

/// Returns the number of epochs of the flight.
pub(super) fn epochs(effort: Effort) -> u64 {
    SECONDS / step_s(effort)
}

/// Returns the place of the aircraft.
fn site(second: u64) -> Site {
    let share = second as f64 / SECONDS as f64;
    let unit = |[latitude_deg, longitude_deg, _]: [f64; 3]| {
        let (sin, cos) = libm::sincos(latitude_deg.to_radians());
        let (sin_longitude, cos_longitude) = libm::sincos(longitude_deg.to_radians());
        nalgebra::Vector3::new(cos * cos_longitude, cos * sin_longitude, sin)
    };
    let point = unit(BEIJING).slerp(&unit(SHANGHAI), share);
    let latitude_deg = libm::asin(point.z).to_degrees();
    let longitude_deg = libm::atan2(point.y, point.x).to_degrees();
    let climbed = (second as f64 / CLIMB_S).min((SECONDS - second) as f64 / DESCENT_S).min(1.0);
    let ground_m = BEIJING[2] + share * (SHANGHAI[2] - BEIJING[2]);
    Site::geodetic(latitude_deg, longitude_deg, ground_m + climbed * (CRUISE_M - ground_m))
}

fn segment(second: u64) -> usize {
    SEGMENTS.iter().position(|segment| second <= segment.end_s).unwrap_or(SEGMENTS.len() - 1)
}

/// A flight with its satellites, noise and limits.
struct Flight {
    effort: Effort,
    satellites: Vec<Satellite>,
    noise: Noise,
    limits: Limits,
}

impl Flight {
    fn sample(&self, view: View, second: u64) -> Result<Sample> {
        let all = sights(&self.satellites, &site(second), second as f64, MASK_RAD);
        let sights = match view {
            View::All => all,
            View::Thinned => thinned(&all, second),
        };
        let faults = SEGMENTS[segment(second)].faults;
        let faulty = distinct(&mut generator(SEED, second), faults, sights.len());
        let mut rows = rows(&sights, Sigma::Constant(SIGMA_M), CLOCKS_M, &self.noise, second);
        for &row in &faulty {
            rows[row].y_m += BIAS_M;
        }
        let posed = Workspace::of(equations(&rows)?);
        let mut workspace = posed.clone();
        let snapshot = workspace.solve().context("an aircraft without a position")?;
        let selection = Selection::choose(snapshot.equations(), 2 * MAX_WORK);
        let sets = parity::sequential(&snapshot, &self.limits.thresholds, &self.limits.parity).sets;
        let minimal = combination_count(sights.len(), sights.len() - snapshot.dof());
        let work = Work {
            satellites: sights.len(),
            sets,
            tetrahedra: selection.work(),
            chosen: selection.subsets(),
            minimal,
        };
        let opinions = self.opinions(second, &posed, &snapshot, &selection)?;
        Ok(Sample { second, faulty, opinions, work })
    }

    fn opinions(
        &self,
        second: u64,
        posed: &Workspace<f32, ROWS>,
        snapshot: &Snapshot<'_, f32, ROWS>,
        selection: &Selection<ROWS>,
    ) -> Result<[Option<Opinion>; JUDGES.len()]> {
        let by = |method: Method| {
            let mut workspace = posed.clone();
            let mut solution = workspace.solve().ok()?;
            let answer = Answer::of(&method.exclude(&mut solution, selection, &self.limits));
            Some(Opinion::at(answer, &solution))
        };
        let all_subsets = |traditional: Traditional| {
            if !second.is_multiple_of(stride_s(self.effort)) {
                return Ok(None);
            }
            let mut subsets = generator(SEED + 16, second);
            let most = most_subsets(self.effort);
            let answer = traditional.judge(snapshot.equations(), &self.limits, most, &mut subsets)?;
            anyhow::Ok(Some(Opinion::without(answer, posed)?))
        };
        Ok([
            Some(Opinion::at(Answer::Nothing, snapshot)),
            by(Method::Parity(parity::Isolation::Sequential)),
            all_subsets(Traditional::Consensus)?,
            all_subsets(Traditional::printed(Sky::Both))?,
            by(Method::Improved),
        ])
    }
}

impl Opinion {
    /// Returns an opinion with the position of a solution. The linearisation point is the truth, so
    /// the correction is the error.
    fn at(answer: Answer, solution: &Snapshot<'_, f32, ROWS>) -> Self {
        let error = solution.correction().map(f64::from);
        Self { answer, horizontal_m: error.x.hypot(error.y), up_m: error.z }
    }

    /// Returns an opinion with the position without the named rows, as far as there is one.
    fn without(answer: Answer, posed: &Workspace<f32, ROWS>) -> Result<Self> {
        let mut workspace = posed.clone();
        let mut solution = workspace.solve()?;
        if let Answer::Rows(rows) = &answer {
            for &row in rows {
                // A row that cannot be left out stays.
                let _ = solution.leave_out(row);
            }
        }
        Ok(Self::at(answer, &solution))
    }
}

/// Returns the highest satellites of GPS and some of `BeiDou`, in the order of the sky.
fn thinned(all: &[Sight], second: u64) -> Vec<Sight> {
    let of = |sky: Sky| all.iter().copied().filter(move |sight| sky.has(sight.satellite));
    let mut gps: Vec<Sight> = of(Sky::Gps).collect();
    gps.sort_by(|a, b| b.line_of_sight.up.total_cmp(&a.line_of_sight.up));
    gps.truncate(THINNED_GPS);
    let beidou: Vec<Sight> = of(Sky::Beidou).collect();
    let drawn = distinct(&mut generator(SEED + 32, second), THINNED_BEIDOU, beidou.len());
    gps.sort_by_key(|sight| sight.satellite);
    gps.into_iter().chain(drawn.into_iter().map(|index| beidou[index])).collect()
}

/// Returns the flight's sections and its picture.
pub(super) fn flight(effort: Effort, bar: &ProgressBar) -> Result<(Vec<Section>, Vec<Picture>)> {
    let flight =
        Flight { effort, satellites: fleets(), noise: Noise::new(SEED), limits: Limits::published()? };
    let of = |index: u64| {
        let second = (index + 1) * step_s(effort);
        let samples = VIEWS.map(|view| flight.sample(view, second));
        bar.inc(1);
        let [all, thinned] = samples;
        Ok([all?, thinned?])
    };
    let samples: Vec<[Sample; 2]> = (0..epochs(effort)).together(of).collect::<Result<_>>()?;
    let mut sections = tables::sections(&samples);
    if effort == Effort::Full {
        sections.extend(tables::times(&flight)?);
    }
    Ok((sections, vec![tables::figure_6(&samples)?]))
}
