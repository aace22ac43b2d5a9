//! Figure 3: a day without faults except 80 m on one satellite in one epoch.

use raim_core::internals::integrity::raim::detection::{Detection, detect};
use raim_core::internals::integrity::raim::isolation::baarda::exclude_sequentially;
use raim_core::internals::integrity::raim::isolation::exclusion::ExclusionOutcome;
use raim_core::internals::least_squares::Snapshot;
use rand::RngExt as _;

use anyhow::Context as _;
use raim::page::canvas::{BLUE, GREY, Mark, ORANGE};
use raim::page::chart::{Axis, LineChart, Series};
use raim::signal::sky::linear;

use super::{Day, EPOCHS, FALSE_ALARM, Finding, Judgement, Picture, ROWS, Row, SEED, SIGMA_M, Section};
use super::{faulty, pose};
use crate::draw::generator;

/// Epoch of the fault: the paper's "30 s", with epochs a minute apart.
const FAULT_EPOCH: usize = 30;
/// Size of the fault, m.
const FAULT_M: f64 = 80.0;

/// One epoch before and after exclusion; statistics in metres.
struct Tested {
    before_m: f64,
    after_m: f64,
    threshold_m: f64,
    fault: bool,
    excluded: Vec<usize>,
    isolated: bool,
}

fn test(day: &Day, rows: &[linear::Row]) -> anyhow::Result<Tested> {
    let mut workspace = pose::<f32>(rows)?;
    let mut snapshot = workspace.solve()?;
    let detect = |snapshot: &Snapshot<'_, f32, ROWS>| -> anyhow::Result<Detection<f32>> {
        detect(snapshot, &day.thresholds).context("beyond the tables")
    };
    let before = detect(&snapshot)?;
    let exclusion = exclude_sequentially(&mut snapshot, &day.thresholds);
    Ok(Tested {
        before_m: SIGMA_M * before.statistic().statistic,
        after_m: SIGMA_M * detect(&snapshot)?.statistic().statistic,
        threshold_m: SIGMA_M * before.statistic().threshold,
        fault: before.fault(),
        excluded: exclusion.rows.iter().map(|excluded| excluded.index).collect(),
        isolated: exclusion.outcome == ExclusionOutcome::Isolated,
    })
}

/// Returns the figure, and the same fault on every other satellite.
pub(super) fn figure_3(day: &Day) -> anyhow::Result<(Section, Picture)> {
    let in_view = day.views[FAULT_EPOCH].len();
    let chosen = generator(SEED, 0).random_range(0..in_view);
    let epoch = |epoch: usize| {
        let rows = day.rows(epoch, 0);
        let rows = if epoch == FAULT_EPOCH { faulty(&rows, chosen, FAULT_M) } else { rows };
        test(day, &rows)
    };
    let tested: Vec<Tested> = (0..EPOCHS).map(epoch).collect::<anyhow::Result<_>>()?;
    let on_each = |index| test(day, &faulty(&day.rows(FAULT_EPOCH, 0), index, FAULT_M));
    let each: Vec<Tested> = (0..in_view).map(on_each).collect::<anyhow::Result<_>>()?;
    let isolated = (0..).zip(&each).filter(|(index, tested)| names_only(tested, *index)).count();

    let at = &tested[FAULT_EPOCH];
    let others = tested.iter().filter(|tested| tested.fault).count() - usize::from(at.fault);
    let satellite = day.views[FAULT_EPOCH][chosen].satellite;
    let named = if names_only(at, chosen) { satellite.to_string() } else { format!("{:?}", at.excluded) };
    let metres = |value| Finding::exact(value, 1);
    let rows = vec![
        Row::new(
            "statistic before exclusion, m",
            "above the threshold",
            metres(at.before_m),
            Judgement::Reproduced,
        )
        .held_if(8, "detected", at.fault),
        Row::new("threshold, m", "", metres(at.threshold_m), Judgement::Ours),
        Row::new("satellite left out", "the faulty one", Finding::Words(named), Judgement::Reproduced)
            .held_if(8, satellite.to_string(), names_only(at, chosen)),
        Row::new(
            "statistic after exclusion, m",
            "as without fault",
            metres(at.after_m),
            Judgement::Reproduced,
        )
        .held_if(8, "below the threshold", at.after_m < at.threshold_m),
        Row::new("alarms in the other epochs", "none", Finding::count(others), judge_alarms(others))
            .because(format!("chance alone is expected to raise {:.2}", FALSE_ALARM * EPOCHS as f64)),
        Row::new(
            "the same fault on each satellite in turn: isolated",
            "",
            Finding::Words(format!("{isolated} of {in_view}")),
            Judgement::Ours,
        ),
    ];
    let title = format!("Figure 3: {FAULT_M} m on {satellite} in epoch {FAULT_EPOCH}");
    Ok((Section { title, rows }, picture(&tested)?))
}

fn names_only(tested: &Tested, index: usize) -> bool {
    tested.isolated && tested.excluded == [index]
}

/// Judges the number of false alarms: none as in the paper, or as many as chance explains. Three
/// would be one case in two thousand.
fn judge_alarms(alarms: usize) -> Judgement {
    match alarms {
        0 => Judgement::Reproduced,
        1 | 2 => Judgement::InTrend,
        _ => Judgement::NotReproducible,
    }
}

fn picture(tested: &[Tested]) -> anyhow::Result<Picture> {
    let series = |name: &str, colour, mark, value: fn(&Tested) -> f64| Series {
        name: name.to_owned(),
        colour,
        mark,
        points: (0..).zip(tested).map(|(epoch, tested)| (f64::from(epoch), value(tested))).collect(),
    };
    let chart = LineChart {
        title: "Figure 3: the statistic before and after exclusion".into(),
        x: Axis::linear("epoch of 60 s").over(0.0..1440.0),
        y: Axis::linear("statistic / m"),
        series: vec![
            series("before", ORANGE, Mark::Line, |tested| tested.before_m),
            series("after", BLUE, Mark::Line, |tested| tested.after_m),
            series("threshold", GREY, Mark::Dashed, |tested| tested.threshold_m),
        ],
        spans: Vec::new(),
    };
    let caption = "One satellite is 80 m off in epoch 30. Before exclusion the statistic passes its threshold there, \
                   after exclusion nowhere; in all other epochs the two are the same.";
    Picture::draw("lin2016-figure-3", caption, |ground| chart.svg((900, 380), ground))
}
