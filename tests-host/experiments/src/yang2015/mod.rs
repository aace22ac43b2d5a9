//! [Yang2015]: the threshold of least total risk, `T_OP`, beside the classic one, `T1`.
//!
//! | content | module |
//! |---|---|
//! | thresholds in metres (eq. 5) | here |
//! | table 1, by expectation | [`expected`] |
//! | table 1, by simulation of every second | [`simulated`] |
//! | figure 5, by latitude | [`table`] |
//! | figure 6, a day above Xi'an | [`xian`] |
//!
//! The printed set-up does not give the printed results. Both are computed: the results as printed,
//! and those with the probability and the alert limits that do give them.

mod case;
mod expected;
mod grid;
mod simulated;
mod table;
mod xian;

use anyhow::Context as _;
use indicatif::ProgressBar;
use oracle::tables::{self, GoldComparison, Lookup};
use oracle::vectors;
use raim_core::internals::integrity::raim::detection::threshold::Thresholds;
use raim_core::internals::integrity::raim::detection::threshold::policy::range_threshold_m;
use raim_core::internals::numeric::probability::Probability;

use super::{Effort, Experiment, Finding, Judgement, Outcome, Row, Section};

/// Entry for the command line.
pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "yang2015",
    about: "thresholds of least risk: false alarms, misses, availability",
    run,
};

/// Capacity in rows; at most 21 satellites are in view.
const ROWS: usize = 24;
/// Standard deviation of a range, m.
const SIGMA_M: f64 = 6.0;
/// Elevation mask, degrees.
const MASK_DEG: f64 = 5.0;
/// Probability of a false alarm per epoch, as printed.
const FALSE_ALARM: f64 = 3.33e-7;
/// Probability of a missed detection.
const MISSED_DETECTION: f64 = 1e-3;
/// Used share of the alert limit, `f HAL`, as printed, m.
const LIMIT_M: f64 = 0.95 * 556.0;

fn thresholds(false_alarm: f64) -> anyhow::Result<Thresholds<'static>> {
    let probability = |tail| Probability::new(tail).context("a probability");
    Ok(Thresholds::from_tables(probability(false_alarm)?, probability(MISSED_DETECTION)?)?)
}

fn run(effort: Effort, bar: &ProgressBar) -> anyhow::Result<Outcome> {
    let stride_s = effort.pick(40, 1);
    bar.set_length(simulated::seconds(stride_s) as u64);
    let mut sections = vec![threshold_section()?, gold_section()?];
    let (table_sections, table_pictures) = table::table_1(stride_s, bar)?;
    let (xian_sections, xian_pictures) = xian::figure_6()?;
    sections.extend(table_sections);
    sections.extend(xian_sections);
    let setup = format!(
        "Phases of both constellations by us (t = 0 unless said); sigma {SIGMA_M} m, mask {MASK_DEG} deg, \
         P_md {MISSED_DETECTION:e}, f 0.95, HAL 556 m. Table 1: BeiDou global, 35 satellites, {} cells, one day, 100 m \
         on one satellite in view from 7200 to 10800 s, drawn anew each second; {} samples simulated, seed {}. Figure 6: \
         Xi'an, one epoch a minute.",
        grid::CELLS,
        simulated::seconds(stride_s) * grid::CELLS,
        simulated::SEED,
    );
    let title = "Yang 2015: thresholds of least total risk".to_owned();
    let pictures = [table_pictures, xian_pictures].concat();
    Ok(Outcome { name: EXPERIMENT.name, title, setup, sections, pictures })
}

/// Classic thresholds, m, from an independent program with fifty digits.
const THRESHOLDS_M: [(usize, f64); 4] =
    [(4, 17.925_711), (8, 14.266_398), (12, 12.671_085), (16, 11.730_971)];

fn threshold_section() -> anyhow::Result<Section> {
    let classic = thresholds(FALSE_ALARM)?;
    let row = |(dof, want_m): (usize, f64)| {
        let have_m = classic.tau1(dof).map_or(f64::NAN, |tau| range_threshold_m(tau, dof, SIGMA_M));
        Row::new(
            format!("T1 with {dof} degrees of freedom, m"),
            "",
            Finding::exact(have_m, 6),
            Judgement::Ours,
        )
        .held_to(2, want_m, 1e-6)
    };
    Ok(Section { title: "Thresholds (eq. 5)".into(), rows: THRESHOLDS_M.map(row).into() })
}

/// Compares the committed tables with fifty digits.
fn gold_section() -> anyhow::Result<Section> {
    let quantity = "committed tau1 and lambda, worst relative error";
    let row = |ours: String| Row::new(quantity, "", Finding::Words(ours), Judgement::Ours);
    let comparison = tables::compare_with_gold(&vectors::path("gold"), &committed())?;
    let GoldComparison { values, worst_relative } = comparison;
    let holds = worst_relative <= tables::TOLERANCE;
    let row = row(format!("{worst_relative:.0e} of {values} values")).held_if(1, "within 1e-12", holds);
    Ok(Section { title: "Reference values with fifty digits".into(), rows: vec![row] })
}

/// Returns the values of the committed tables.
fn committed() -> impl Lookup {
    |dof: usize, alarm: f64, missed: Option<f64>| {
        let missed_detection = Probability::new(missed.unwrap_or(MISSED_DETECTION))?;
        let rows = Thresholds::from_tables(Probability::new(alarm)?, missed_detection).ok()?;
        if missed.is_some() { rows.lambda(dof) } else { rows.tau1(dof) }
    }
}
