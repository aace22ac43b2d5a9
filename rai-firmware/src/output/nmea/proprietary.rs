//! Proprietary sentences: verdict, exclusions, version, answers.
//!
//! | sentence | fields |
//! |---|---|
//! | `PRAIS` | time, state, reason, satellites tracked, used, degrees of freedom, statistic, threshold, HPL, VPL, HAL, VAL |
//! | `PRAIX` | time, number of exclusions, satellite, w-test, bias |
//! | `PRAIM` | time, monitored modes, probability of unmonitored faults, EMT, σ of the height (URE instead of URA), mode that dominates the vertical level, share of the risk |
//! | `PRAIH` | time, use of the known height, known height minus that of the satellites alone |
//! | `PRAIE` | time, authenticated signals, frame of the receiver's levels, its three levels, coefficient and power of ten of its risk; then, if there are any, the number of satellites whose unhealthy L5 is in use |
//! | `PRAIN` | time, hash of the settings, NIC, jamming, spoofing |
//! | `PRAIL` | bytes lost at the GNSS port and at the host port, frames refused, epochs late; since start |
//! | `PRAIV` | version, git, reset cause, self-test |
//! | `PRAIA` | key, values, `OK`; or key, `ERR`, reason |
//!
//! In an alert `PRAIS` has no protection level, and `PRAIN` has NIC 0, as in every case without a
//! valid level. Statistic and threshold are those of the epoch's test, and empty without an epoch
//! or a test. An alert like `JUMP` can come with a test that passed. [`crate::settings`] writes
//! `PRAIQ`.
//!
//! A fault mode is named by the satellites that it excludes: `E` a whole system, `G05` a satellite,
//! `EG05` both. The name is empty if the noise of all satellites, without a fault, dominates the
//! level.
//!
//! In `PRAIS`, statistic and threshold have 3 decimals, and metres have 1. If the sentence would
//! exceed 82 characters, statistic and threshold have 1 decimal, and metres have none.

use embedded_io::Write;
use heapless::String;
use raim_core::report::{AraimReport, DominantMode, HeightReport, Report, Unavailable, Verdict};
use raim_core::requirements::Requirements;
use raim_core::satellite::Constellation;

use super::{Sentence, TimeOfDay, write_sentence};
use crate::input::ReceiverLevels;
use crate::output::{Interference, Statement, nic};

/// Largest statistic that is written.
pub(super) const MAX_STATISTIC: f64 = 99_999.0;

/// Longest text in a field of `PRAIV`, characters: four of them fit into a sentence.
const TEXT_WIDTH: usize = 16;

/// Decimals and widths of the numbers in `PRAIS`.
#[derive(Clone, Copy)]
pub(super) struct Precision {
    pub(super) ratio_decimals: usize,
    pub(super) ratio_width: usize,
    pub(super) metre_decimals: usize,
    pub(super) metre_width: usize,
}

/// Usual precision.
pub(super) const FULL: Precision =
    Precision { ratio_decimals: 3, ratio_width: 9, metre_decimals: 1, metre_width: 9 };

/// Precision for extreme values, which always fits.
const COARSE: Precision = Precision { ratio_decimals: 1, ratio_width: 5, metre_decimals: 0, metre_width: 6 };

/// Returns the precision of the numbers in the `PRAIS` of an epoch.
#[cfg(feature = "observer")]
pub(super) fn precision<const N: usize>(statement: &Statement<'_, N>, time: TimeOfDay) -> Precision {
    if state(statement, time, FULL).fits() { FULL } else { COARSE }
}

/// Writes `PRAIS`: the verdict and its numbers.
pub(super) fn write_state<W: Write, const N: usize>(
    statement: &Statement<'_, N>,
    time: TimeOfDay,
    out: &mut W,
) -> Result<(), W::Error> {
    let mut sentence = state(statement, time, FULL);
    if !sentence.fits() {
        sentence = state(statement, time, COARSE);
    }
    write_sentence(&mut sentence, out)
}

fn state<const N: usize>(statement: &Statement<'_, N>, time: TimeOfDay, precision: Precision) -> Sentence {
    let Precision { ratio_decimals, ratio_width, metre_decimals, metre_width } = precision;
    let (report, required) = (statement.report, statement.requirements);
    let statistic = report.test.map(|test| test.statistic.min(MAX_STATISTIC));
    let threshold = report.test.map(|test| test.threshold.min(MAX_STATISTIC));
    let (hpl_m, vpl_m) = statement.levels_m();
    let mut sentence = heading(Some(time), report.verdict);
    sentence.integer(u32::from(report.tracked.min(99)), 1).integer(report.used.len().min(99) as u32, 1);
    match report.test {
        Some(test) => sentence.integer(u32::from(test.dof.min(99)), 1),
        None => sentence.empty(),
    };
    for ratio in [statistic, threshold] {
        sentence.optional(ratio, ratio_decimals, ratio_width);
    }
    for metres in [hpl_m, vpl_m, Some(required.hal_m), required.val_m] {
        sentence.optional(metres, metre_decimals, metre_width);
    }
    sentence
}

/// Writes `PRAIM`: the results of ARAIM except its levels.
pub(super) fn write_separation<W: Write>(
    separation: &AraimReport,
    time: TimeOfDay,
    out: &mut W,
) -> Result<(), W::Error> {
    let mut sentence = Sentence::new("PRAIM");
    sentence
        .time(Some(time))
        .integer(u32::from(separation.modes), 1)
        .probability(separation.unmonitored_probability)
        .number(separation.effective_monitor_threshold_m, 2, 9)
        .number(separation.accuracy_m, 2, 9)
        .text(&named(separation.vertical))
        .number(separation.share, 4, 9);
    write_sentence(&mut sentence, out)
}

/// Returns the name of a fault mode: the systems and satellites that it excludes.
fn named(mode: DominantMode) -> String<16> {
    let mut name = String::new();
    let lost = Constellation::ALL.into_iter().filter(|system| mode.constellations >> *system as u8 & 1 != 0);
    for system in lost {
        // Four letters and three satellites fit.
        let _ = name.push(system.letter());
    }
    for satellite in mode.satellites.iter().flatten() {
        let digit = |value: u8| char::from(b'0' + value % 10);
        let (letter, number) = satellite.name();
        for character in [letter, digit(number / 10), digit(number)] {
            let _ = name.push(character);
        }
    }
    name
}

/// Writes `PRAIN`: hash of the settings, category of the level, and the interference that the
/// receiver reports.
pub(super) fn write_settings_and_interference<W: Write, const N: usize>(
    statement: &Statement<'_, N>,
    time: TimeOfDay,
    out: &mut W,
) -> Result<(), W::Error> {
    // A level above its limit is still a valid bound. With any other reason against protection it
    // is not.
    let bounds = matches!(
        statement.report.verdict,
        Verdict::Protected(_)
            | Verdict::Unavailable(
                Unavailable::Hpl | Unavailable::Vpl | Unavailable::Emt | Unavailable::Accuracy
            )
    );
    let mut sentence = Sentence::new("PRAIN");
    sentence
        .time(Some(time))
        .hexadecimal(statement.settings_hash)
        .integer(u32::from(nic::category(statement.levels_m().0.filter(|_| bounds))), 1)
        .integer(u32::from(statement.interference.jamming), 1)
        .integer(u32::from(statement.interference.spoofing), 1);
    write_sentence(&mut sentence, out)
}

/// Writes `PRAIH`: the use of a known height, and its difference from the height by satellites
/// alone.
pub(super) fn write_height<W: Write>(
    height: &HeightReport,
    time: TimeOfDay,
    out: &mut W,
) -> Result<(), W::Error> {
    let usage = match height {
        HeightReport { is_used: false, .. } => "X",
        HeightReport { is_needed: true, .. } => "N",
        HeightReport { .. } => "U",
    };
    let mut sentence = Sentence::new("PRAIH");
    sentence.time(Some(time)).text(usage).number(height.difference_m, 1, 9);
    write_sentence(&mut sentence, out)
}

/// Writes `PRAIE`: the number of authenticated signals and the protection levels that the receiver
/// reports, and the number of satellites whose unhealthy L5 is in use. Nothing is written if there is
/// none of it.
pub(super) fn write_evidence<W: Write>(
    interference: &Interference,
    unhealthy_l5: u8,
    time: TimeOfDay,
    out: &mut W,
) -> Result<(), W::Error> {
    let Interference { authenticated, levels, .. } = *interference;
    if authenticated.is_none() && levels.is_none() && unhealthy_l5 == 0 {
        return Ok(());
    }
    let mut sentence = Sentence::new("PRAIE");
    sentence.time(Some(time)).optional(authenticated.map(f64::from), 0, 3);
    match levels {
        Some(ReceiverLevels { frame, axes_mm, risk: (coefficient, exponent) }) => {
            sentence.integer(frame.into(), 1);
            for level_mm in axes_mm {
                sentence.number(f64::from(level_mm) * 1e-3, 3, 11);
            }
            sentence.integer(coefficient.into(), 1).number(exponent.into(), 0, 4);
        }
        None => {
            for _ in 0..6 {
                sentence.empty();
            }
        }
    }
    if unhealthy_l5 > 0 {
        sentence.integer(unhealthy_l5.into(), 1);
    }
    write_sentence(&mut sentence, out)
}

/// Losses since start: bytes, frames and late epochs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Losses {
    /// Bytes lost at the GNSS port.
    pub gnss_bytes: u32,
    /// Bytes lost at the host port.
    pub host_bytes: u32,
    /// Frames refused.
    pub frames_refused: u32,
    /// Epochs late.
    pub epochs_late: u32,
}

/// Writes `PRAIL`: the losses.
///
/// # Errors
/// The writer's own.
pub fn write_losses<W: Write>(losses: &Losses, out: &mut W) -> Result<(), W::Error> {
    let Losses { gnss_bytes, host_bytes, frames_refused, epochs_late } = *losses;
    let mut sentence = Sentence::new("PRAIL");
    for count in [gnss_bytes, host_bytes, frames_refused, epochs_late] {
        sentence.integer(count, 1);
    }
    write_sentence(&mut sentence, out)
}

/// Returns a `PRAIS` with time, state and reason.
fn heading(time: Option<TimeOfDay>, verdict: Verdict) -> Sentence {
    let (state, reason) = verdict.words();
    let mut sentence = Sentence::new("PRAIS");
    sentence.time(time).ready(state.as_bytes()).ready(reason.as_bytes());
    sentence
}

/// Writes `PRAIS` without an epoch: no satellite is tracked, and there is no test.
pub(super) fn write_without_epoch<W: Write>(
    verdict: Verdict,
    last: Option<TimeOfDay>,
    requirements: &Requirements,
    out: &mut W,
) -> Result<(), W::Error> {
    let mut sentence = heading(last, verdict);
    sentence.integer(0, 1).integer(0, 1).empty().empty().empty().empty().empty();
    for metres in [Some(requirements.hal_m), requirements.val_m] {
        sentence.optional(metres, FULL.metre_decimals, FULL.metre_width);
    }
    write_sentence(&mut sentence, out)
}

/// Writes `PRAIX`: the exclusions, in their order.
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
        write_sentence(&mut sentence, out)
    })
}

/// Writes `PRAIV`: version, commit, reset cause and self-test. Texts are cut to 16 characters.
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
    write_sentence(&mut sentence, out)
}

/// Writes `PRAIA,key,value…,OK`, followed by `WARN,why` if there is a warning. If the answer would
/// exceed 82 characters, all values are left out.
///
/// # Errors
/// The writer's own.
pub fn write_answer<'v, W: Write>(
    key: &str,
    values: impl Iterator<Item = &'v str>,
    warning: Option<&str>,
    out: &mut W,
) -> Result<(), W::Error> {
    let mut sentence = Sentence::new("PRAIA");
    finish(values.fold(sentence.text(key), |sentence, value| sentence.text(value)), warning);
    if !sentence.fits() {
        sentence = Sentence::new("PRAIA");
        finish(sentence.text(key), warning);
    }
    write_sentence(&mut sentence, out)
}

/// Appends the end of an answer.
fn finish(sentence: &mut Sentence, warning: Option<&str>) {
    sentence.text("OK");
    if let Some(why) = warning {
        sentence.text("WARN").text(why);
    }
}

/// Writes `PRAIA,key,ERR,why`.
///
/// # Errors
/// The writer's own.
pub fn write_refusal<W: Write>(key: &str, why: &str, out: &mut W) -> Result<(), W::Error> {
    write_sentence(Sentence::new("PRAIA").text(key).text("ERR").text(why), out)
}

/// Writes `PRAIA,STATS,name,value…,OK` with as many counters as fit into one answer; returns their
/// number.
///
/// # Errors
/// The writer's own.
pub fn write_counters<W: Write>(
    counters: impl Iterator<Item = (&'static str, u32)>,
    out: &mut W,
) -> Result<usize, W::Error> {
    let mut sentence = Sentence::new("PRAIA");
    sentence.ready(b"STATS");
    let mut reported = 0;
    for (name, count) in counters {
        let mut longer = sentence.clone();
        longer.text(name).integer(count, 1);
        if !longer.clone().ready(b"OK").fits() && reported > 0 {
            break;
        }
        sentence = longer;
        reported += 1;
    }
    if reported > 0 {
        write_sentence(sentence.ready(b"OK"), out)?;
    }
    Ok(reported)
}
