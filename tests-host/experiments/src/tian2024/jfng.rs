//! Tables 2 and 3: a day at JFNG, 150 m on one, two or three satellites, drawn anew in every epoch.

use anyhow::{Context as _, Result};
use indicatif::ProgressBar;
use raim::in_order::Together as _;
use raim::page::bars::BarChart;
use raim::page::canvas::{Mark, SERIES};
use raim::page::chart::{Axis, LineChart, Series};
use raim::signal::sky::linear::{Sigma, equations, rows};
use raim::signal::sky::{Noise, Satellite, Sight, Site, sights};
use raim_core::internals::integrity::raim::isolation::parity;
use raim_core::internals::integrity::raim::isolation::ransac::{MAX_WORK, Selection};
use raim_core::internals::least_squares::Workspace;
use raim_core::internals::least_squares::equations::Row as Equation;

use super::super::draw::{distinct, generator};
use super::super::{Effort, Finding, Judgement, Picture, Row, Section};
use super::method::{Answer, Limits, Method, ROWS, Score, Traditional};
use super::{BIAS_M, CLOCKS_M, MASK_RAD, Sky, faults_in_words, fleets, most_subsets};

const DAY_S: f64 = 86_400.0;
const SEED: u64 = 0x71A2;
/// Values of `σ₀` in `σ₀ / sin(elevation)`, m; the paper does not print it.
const ZENITH_M: [f64; 2] = [1.0, 2.0];

/// Printed results of a method: epochs missed, wrong, and accuracy in percent.
struct Printed {
    missed: u32,
    wrong: u32,
    accuracy: f64,
}

const fn printed(missed: u32, wrong: u32, accuracy: f64) -> Printed {
    Printed { missed, wrong, accuracy }
}

/// One experiment of tables 2 and 3, with the printed results of parity, traditional and improved
/// method.
struct Case {
    sky: Sky,
    faults: usize,
    printed: [Printed; 3],
}

const CASES: [Case; 5] = [
    Case {
        sky: Sky::Gps,
        faults: 1,
        printed: [printed(0, 0, 100.0), printed(0, 27, 99.06), printed(0, 0, 100.0)],
    },
    Case {
        sky: Sky::Beidou,
        faults: 1,
        printed: [printed(0, 0, 100.0), printed(0, 12, 99.6), printed(0, 0, 100.0)],
    },
    Case {
        sky: Sky::Both,
        faults: 1,
        printed: [printed(0, 0, 100.0), printed(0, 9, 99.69), printed(0, 0, 100.0)],
    },
    Case {
        sky: Sky::Both,
        faults: 2,
        printed: [printed(0, 21, 99.27), printed(26, 49, 97.40), printed(6, 10, 99.44)],
    },
    Case {
        sky: Sky::Both,
        faults: 3,
        printed: [printed(0, 101, 96.49), printed(31, 108, 95.17), printed(13, 38, 98.23)],
    },
];

/// Cases of table 2, with one system, and of table 3, with both.
const SINGLE: std::ops::Range<usize> = 0..2;
const DOUBLE: std::ops::Range<usize> = 2..5;

/// Columns of a tally, and the printed method that each corresponds to.
const COLUMNS: [(&str, usize); 4] = [
    ("parity, sequential", 0),
    ("traditional, consensus", 1),
    ("traditional, as printed", 1),
    ("improved", 2),
];
const PARITY: usize = 0;
const CONSENSUS: usize = 1;
const IMPROVED: usize = 3;

/// Scores by case, sigma and column.
type Scores = [[[Score; COLUMNS.len()]; ZENITH_M.len()]; CASES.len()];

/// Results of one epoch, and the number of satellites of each sky in it.
struct Sample {
    tally: Scores,
    seen: [usize; Sky::ALL.len()],
}

/// Returns the number of epochs of the day.
pub(super) fn epochs(effort: Effort) -> u64 {
    effort.pick(144, 2880)
}

/// Returns the interval in epochs at which the traditional method runs too. GPS alone has so few
/// subsets that it always does.
fn stride(effort: Effort) -> u64 {
    effort.pick(8, 40)
}

/// The day, with ranges free of faults.
struct Day {
    effort: Effort,
    satellites: Vec<Satellite>,
    site: Site,
    noise: Noise,
    limits: Limits,
}

impl Day {
    fn new(effort: Effort) -> Result<Self> {
        Ok(Self {
            effort,
            satellites: fleets(),
            site: Site::geodetic(30.5156, 114.4910, 71.0),
            noise: Noise::new(SEED),
            limits: Limits::published()?,
        })
    }

    fn sample(&self, index: u64) -> Result<Sample> {
        let t_s = DAY_S * index as f64 / epochs(self.effort) as f64;
        let all = sights(&self.satellites, &self.site, t_s, MASK_RAD);
        let mut sample = Sample { tally: Scores::default(), seen: [0; Sky::ALL.len()] };
        for (sky, seen) in Sky::ALL.into_iter().zip(&mut sample.seen) {
            let sights: Vec<Sight> = all.iter().copied().filter(|sight| sky.has(sight.satellite)).collect();
            *seen = sights.len();
            let of_sky = CASES.iter().zip(&mut sample.tally).filter(|(case, _)| case.sky == sky);
            self.judge(index, &sights, of_sky)?;
        }
        Ok(sample)
    }

    /// Judges all cases of one sky in one epoch.
    fn judge<'t>(
        &self,
        index: u64,
        sights: &[Sight],
        cases: impl Iterator<Item = (&'t Case, &'t mut [[Score; COLUMNS.len()]; ZENITH_M.len()])>,
    ) -> Result<()> {
        // The subsets depend on the geometry alone, which is the same for all of them.
        let healthy = self.workspace(index, sights, ZENITH_M[0], &[])?;
        let selection = Selection::choose(healthy.equations().rows(), 2 * MAX_WORK);
        for (case, by_sigma) in cases {
            let mut draw = generator(SEED + case.faults as u64, index);
            let faulty = distinct(&mut draw, case.faults, sights.len());
            for (zenith_m, scores) in ZENITH_M.into_iter().zip(&mut *by_sigma) {
                let posed = self.workspace(index, sights, zenith_m, &faulty)?;
                self.exclude(&posed, &selection, &faulty, scores)?;
            }
            if case.sky == Sky::Gps || index.is_multiple_of(stride(self.effort)) {
                let posed = self.workspace(index, sights, ZENITH_M[0], &faulty)?;
                self.vote(index, case, posed.equations().rows(), &faulty, &mut by_sigma[0])?;
            }
        }
        Ok(())
    }

    fn workspace(
        &self,
        index: u64,
        sights: &[Sight],
        zenith_m: f64,
        faulty: &[usize],
    ) -> Result<Workspace<f32, ROWS>> {
        let mut rows = rows(sights, Sigma::Cosecant(zenith_m), CLOCKS_M, &self.noise, index);
        for &row in faulty {
            rows[row].y_m += BIAS_M;
        }
        Ok(Workspace::of(equations(&rows)?))
    }

    fn exclude(
        &self,
        posed: &Workspace<f32, ROWS>,
        selection: &Selection<ROWS>,
        faulty: &[usize],
        scores: &mut [Score; COLUMNS.len()],
    ) -> Result<()> {
        let methods = [(PARITY, Method::Parity(parity::Isolation::Sequential)), (IMPROVED, Method::Improved)];
        for (column, method) in methods {
            let mut workspace = posed.clone();
            let mut snapshot = workspace.solve().context("a sky without a position")?;
            let exclusion = method.exclude(&mut snapshot, selection, &self.limits);
            scores[column].add(&Answer::of(&exclusion), faulty);
        }
        Ok(())
    }

    fn vote(
        &self,
        index: u64,
        case: &Case,
        rows: &[Equation<f32>],
        faulty: &[usize],
        scores: &mut [Score; COLUMNS.len()],
    ) -> Result<()> {
        let criteria = [Traditional::Consensus, Traditional::printed(case.sky)];
        for (offset, traditional) in criteria.into_iter().enumerate() {
            // Both criteria use the same subsets.
            let mut subsets = generator(SEED + 16 + case.faults as u64, index);
            let most = most_subsets(self.effort);
            let answer = traditional.judge(rows, &self.limits, most, &mut subsets)?;
            scores[CONSENSUS + offset].add(&answer, faulty);
        }
        Ok(())
    }
}

/// Returns the day's sections and pictures.
pub(super) fn day(effort: Effort, bar: &ProgressBar) -> Result<(Vec<Section>, Vec<Picture>)> {
    let day = Day::new(effort)?;
    let of = |index: u64| {
        let sample = day.sample(index);
        bar.inc(1);
        sample
    };
    let samples: Vec<Sample> = (0..epochs(effort)).together(of).collect::<Result<_>>()?;
    let mut tally = Scores::default();
    for sample in &samples {
        let (sums, others) = (tally.as_flattened_mut(), sample.tally.as_flattened());
        for (sum, other) in sums.as_flattened_mut().iter_mut().zip(others.as_flattened()) {
            sum.merge(other);
        }
    }
    let sections = vec![
        visible(&samples),
        table("Table 2", &tally, 0, SINGLE),
        table("Table 3", &tally, 0, DOUBLE),
        table("Tables 2 and 3", &tally, 1, 0..CASES.len()),
    ];
    Ok((sections, vec![figure_2(&samples)?, bars(&tally)?]))
}

fn visible(samples: &[Sample]) -> Section {
    let row = |(index, sky): (usize, Sky)| {
        let counts = || samples.iter().map(|sample| sample.seen[index]);
        let words = format!("{} … {}", counts().min().unwrap_or(0), counts().max().unwrap_or(0));
        Row::new(format!("{}: satellites in sight", sky.name()), "", Finding::Words(words), Judgement::Ours)
    };
    let rows = Sky::ALL.into_iter().enumerate().map(row).collect();
    Section { title: "Figure 2".to_owned(), rows }
}

fn table(number: &str, tally: &Scores, level: usize, cases: std::ops::Range<usize>) -> Section {
    let mut rows = Vec::new();
    for index in cases {
        let (case, scores) = (&CASES[index], &tally[index][level]);
        for (column, score) in scores.iter().enumerate().filter(|(_, score)| score.epochs > 0) {
            rows.push(accuracy_row(case, column, score, level));
        }
    }
    Section { title: format!("{number}, accuracy in %, sigma0 {} m", ZENITH_M[level]), rows }
}

fn accuracy_row(case: &Case, column: usize, score: &Score, level: usize) -> Row {
    let (name, method) = COLUMNS[column];
    let Printed { missed, wrong, accuracy } = case.printed[method];
    let quantity = format!("{}, {}, {name}", case.sky.name(), faults_in_words(case.faults));
    let paper = format!("{accuracy} ({missed} missed, {wrong} wrong)");
    let (judgement, why) = match (case.faults, column) {
        (1, PARITY | IMPROVED) if level == 0 => (Judgement::Reproduced, ""),
        (1, PARITY | IMPROVED) => (Judgement::InTrend, ""),
        (_, PARITY) => {
            (Judgement::InTrend, "; the paper's parity method, of which it prints nothing, is weaker")
        }
        (_, IMPROVED) => (Judgement::InTrend, "; the refinement finds what the paper's method leaves"),
        (_, CONSENSUS) => (Judgement::InTrend, "; its criterion is not the printed one"),
        _ => (Judgement::InTrend, "; its limit is not printed"),
    };
    let reason = score.others() + why;
    let row = Row::new(quantity, paper, score.accuracy(), judgement).because(reason);
    if level == 0 { held(row, case, column, score) } else { row }
}

fn held(row: Row, case: &Case, column: usize, score: &Score) -> Row {
    let percent = score.percent();
    match (case.sky, case.faults, column) {
        (Sky::Both, 3, IMPROVED) => row.held_if(14, "98.2 or more", percent >= 98.2),
        (Sky::Both, ..) => row,
        (_, _, PARITY | IMPROVED) => row.held_if(13, "99.5 or more", percent >= 99.5),
        (_, _, CONSENSUS) => row.held_if(13, "98.5 or more", percent >= 98.5),
        _ => row,
    }
}

fn figure_2(samples: &[Sample]) -> Result<Picture> {
    let hours = |index: usize| 24.0 * index as f64 / samples.len() as f64;
    let line = |(index, sky): (usize, Sky)| Series {
        name: sky.name().to_owned(),
        colour: SERIES[index],
        mark: Mark::Line,
        points: samples
            .iter()
            .enumerate()
            .map(|(at, sample)| (hours(at), sample.seen[index] as f64))
            .collect(),
    };
    let chart = LineChart {
        title: "Satellites above 5° at JFNG".to_owned(),
        x: Axis::linear("time / h").over(0.0..24.0),
        y: Axis::linear("satellites").over(0.0..44.0),
        series: Sky::ALL.into_iter().enumerate().map(line).collect(),
        spans: vec![],
    };
    let caption = "Figure 2: satellites in sight at JFNG, 31 of GPS and 44 of BeiDou.";
    Picture::draw("tian2024-figure-2", caption, |ground| chart.svg((860, 380), ground))
}

/// Draws table 3 by its errors, because the rates themselves are all near 100 %.
fn bars(tally: &Scores) -> Result<Picture> {
    let mut bars = Vec::new();
    for (name, column) in [("parity", PARITY), ("improved", IMPROVED)] {
        let printed = |case: &Case| 100.0 - case.printed[COLUMNS[column].1].accuracy;
        bars.push((format!("{name}, paper"), CASES[DOUBLE].iter().map(printed).collect()));
        for (level, zenith_m) in ZENITH_M.iter().enumerate() {
            let errors =
                |scores: &[[Score; COLUMNS.len()]; ZENITH_M.len()]| 100.0 - scores[level][column].percent();
            bars.push((format!("{name}, {zenith_m} m"), tally[DOUBLE].iter().map(errors).collect()));
        }
    }
    let chart = BarChart {
        title: "Epochs at JFNG in which a method errs, GPS and BeiDou, by sigma0".to_owned(),
        y_label: "not correct / %".to_owned(),
        x_label: "faults of 150 m".to_owned(),
        groups: ["one", "two", "three"].map(str::to_owned).to_vec(),
        bars,
    };
    let caption = "Table 3: the more faults and the larger the noise, the more often a method errs.";
    Picture::draw("tian2024-table-3", caption, |ground| chart.svg((860, 400), ground))
}
