//! The proprietary sentences: verdict, exclusions, version, answers.
//!
//! | sentence | fields |
//! |---|---|
//! | `PRAIS` | time, state, reason, satellites tracked, used, degrees of freedom, statistic, threshold, HPL, VPL, HAL, VAL |
//! | `PRAIX` | time, how many are excluded, satellite, w-test, bias |
//! | `PRAIV` | version, git, reset cause, self-test |
//! | `PRAIA` | key, values, `OK`; or key, `ERR`, why |
//!
//! `PRAIS` gives the statistic and its threshold to 3 decimals and metres to 1. Where extreme values would make it
//! longer than 82 characters, both drop to 1 and 0.

use embedded_io::Write;
use rai_core::report::{Alert, Protected, Report, Unavailable, Verdict};
use rai_core::requirements::Requirements;

use super::TimeOfDay;
use super::sentence::{Sentence, write_sentence};

/// The largest statistic that is written.
const MAX_STATISTIC: f64 = 99_999.0;

/// Names and counts that one `PRAIA,STATS` carries.
const COUNTERS_PER_ANSWER: usize = 2;

/// Longest text that a field of `PRAIV` or the name of a counter has: four of them fit into a sentence.
const TEXT_WIDTH: usize = 16;

/// How many decimals `PRAIS` affords.
#[derive(Clone, Copy)]
struct Precision {
    ratio_decimals: usize,
    ratio_width: usize,
    metre_decimals: usize,
    metre_width: usize,
}

/// What the interface promises.
const FULL: Precision = Precision { ratio_decimals: 3, ratio_width: 9, metre_decimals: 1, metre_width: 9 };

/// What fits whatever the values are.
const COARSE: Precision = Precision { ratio_decimals: 1, ratio_width: 5, metre_decimals: 0, metre_width: 6 };

/// State and reason of `PRAIS`.
const fn words(verdict: Verdict) -> (&'static str, &'static str) {
    match verdict {
        Verdict::Protected(Protected::Ok) => ("P", "OK"),
        Verdict::Protected(Protected::Excluded) => ("P", "EXCLUDED"),
        Verdict::Alert(Alert::Fault) => ("A", "FAULT"),
        Verdict::Alert(Alert::Ambiguous) => ("A", "AMBIGUOUS"),
        Verdict::Alert(Alert::Stale) => ("A", "STALE"),
        Verdict::Unavailable(Unavailable::NoFix) => ("U", "NOFIX"),
        Verdict::Unavailable(Unavailable::Redundancy) => ("U", "REDUNDANCY"),
        Verdict::Unavailable(Unavailable::Geometry) => ("U", "GEOMETRY"),
        Verdict::Unavailable(Unavailable::Risk) => ("U", "RISK"),
        Verdict::Unavailable(Unavailable::Hpl) => ("U", "HPL"),
        Verdict::Unavailable(Unavailable::Vpl) => ("U", "VPL"),
        Verdict::Unavailable(Unavailable::Budget) => ("U", "BUDGET"),
        Verdict::Unavailable(Unavailable::Input) => ("U", "INPUT"),
    }
}

/// `PRAIS`: the verdict and the numbers behind it.
pub(super) fn write_state<W: Write, const N: usize>(
    report: &Report<N>,
    time: TimeOfDay,
    requirements: &Requirements,
    out: &mut W,
) -> Result<(), W::Error> {
    let mut sentence = state(report, time, requirements, FULL);
    if !sentence.fits() {
        sentence = state(report, time, requirements, COARSE);
    }
    write_sentence(&sentence, out)
}

fn state<const N: usize>(
    report: &Report<N>,
    time: TimeOfDay,
    requirements: &Requirements,
    precision: Precision,
) -> Sentence {
    let Precision { ratio_decimals, ratio_width, metre_decimals, metre_width } = precision;
    let statistic = report.test.map(|test| test.statistic.min(MAX_STATISTIC));
    let threshold = report.test.map(|test| test.threshold.min(MAX_STATISTIC));
    let hpl_m = report.protection.map(|levels| levels.hpl_m);
    let vpl_m = report.protection.map(|levels| levels.vpl_m);
    let mut sentence = heading(Some(time), report.verdict);
    sentence.integer(u32::from(report.tracked.min(99)), 1).integer(report.used.len().min(99) as u32, 1);
    match report.test {
        Some(test) => sentence.integer(u32::from(test.dof.min(99)), 1),
        None => sentence.empty(),
    };
    for ratio in [statistic, threshold] {
        sentence.optional(ratio, ratio_decimals, ratio_width);
    }
    for metres in [hpl_m, vpl_m, Some(requirements.hal_m), requirements.val_m] {
        sentence.optional(metres, metre_decimals, metre_width);
    }
    sentence
}

/// Time, state and reason.
fn heading(time: Option<TimeOfDay>, verdict: Verdict) -> Sentence {
    let (state, reason) = words(verdict);
    let mut sentence = Sentence::new("PRAIS");
    sentence.time(time).text(state).text(reason);
    sentence
}

/// `PRAIS` where no epoch came: nothing is tracked, nothing is tested.
pub(super) fn write_staleness<W: Write>(
    last: Option<TimeOfDay>,
    requirements: &Requirements,
    out: &mut W,
) -> Result<(), W::Error> {
    let mut sentence = heading(last, Verdict::Alert(Alert::Stale));
    sentence.integer(0, 1).integer(0, 1).empty().empty().empty().empty().empty();
    for metres in [Some(requirements.hal_m), requirements.val_m] {
        sentence.optional(metres, FULL.metre_decimals, FULL.metre_width);
    }
    write_sentence(&sentence, out)
}

/// `PRAIX`: what was left out, in the order of exclusion.
pub(super) fn write_exclusions<W: Write, const N: usize>(
    report: &Report<N>,
    time: TimeOfDay,
    out: &mut W,
) -> Result<(), W::Error> {
    let count = report.excluded.len() as u32;
    report.excluded.iter().try_for_each(|excluded| {
        let mut sentence = Sentence::new("PRAIX");
        sentence
            .time(Some(time))
            .integer(count, 1)
            .satellite(excluded.satellite)
            .number(excluded.w_test, 3, 14)
            .number(excluded.bias_m, 1, 14);
        write_sentence(&sentence, out)
    })
}

/// `PRAIV`: what runs here and why it started. Texts are cut to 16 characters.
///
/// # Errors
/// The writer's own.
pub fn write_version<W: Write>(
    version: &str,
    git: &str,
    reset_cause: &str,
    selftest: &str,
    out: &mut W,
) -> Result<(), W::Error> {
    let mut sentence = Sentence::new("PRAIV");
    for text in [version, git, reset_cause, selftest] {
        sentence.clipped(text, TEXT_WIDTH);
    }
    write_sentence(&sentence, out)
}

/// `PRAIA,key,value…,OK`. Values that would make the answer longer than 82 characters are left out together.
///
/// # Errors
/// The writer's own.
pub fn write_answer<'v, W: Write>(
    key: &str,
    values: impl Iterator<Item = &'v str>,
    out: &mut W,
) -> Result<(), W::Error> {
    let mut sentence = Sentence::new("PRAIA");
    values.fold(sentence.text(key), |sentence, value| sentence.text(value)).text("OK");
    if !sentence.fits() {
        sentence = Sentence::new("PRAIA");
        sentence.text(key).text("OK");
    }
    write_sentence(&sentence, out)
}

/// `PRAIA,key,ERR,why`.
///
/// # Errors
/// The writer's own.
pub fn write_refusal<W: Write>(key: &str, why: &str, out: &mut W) -> Result<(), W::Error> {
    write_sentence(Sentence::new("PRAIA").text(key).text("ERR").text(why), out)
}

/// `PRAIA,STATS,name,value,name,value,OK`: as many answers as the counters need, two to each.
///
/// # Errors
/// The writer's own.
pub fn write_counters<W: Write>(
    mut counters: impl Iterator<Item = (&'static str, u32)>,
    out: &mut W,
) -> Result<(), W::Error> {
    let mut next = counters.next();
    while next.is_some() {
        let mut sentence = Sentence::new("PRAIA");
        sentence.text("STATS");
        for _ in 0..COUNTERS_PER_ANSWER {
            let Some((name, count)) = next else { break };
            sentence.clipped(name, TEXT_WIDTH).integer(count, 1);
            next = counters.next();
        }
        write_sentence(sentence.text("OK"), out)?;
    }
    Ok(())
}
