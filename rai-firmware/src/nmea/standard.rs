//! The standard sentences: position, satellites used, error statistics, satellite fault.
//!
//! | sentence | symbol | meaning | unit |
//! |---|---|---|---|
//! | `GST` | `a`, `b` | semi-axes of the error ellipse, 1 sigma: `a², b² = (N+E)/2 ± √(((N−E)/2)² + C²)` | m |
//! | `GST` | `θ` | its orientation from true north over east: `½ atan2(2C, N−E)` | ° |
//! | `GBS` | | bias of the satellite that fits worst, with its standard deviation | m |
//!
//! `E`, `N`, `C` are the variances of east and north and their covariance. The root mean square of `GST` is that of
//! the residuals.

use embedded_io::Write;
use rai_core::report::{Report, Solution, Suspect, Verdict};
use rai_core::requirements::Requirements;
use rai_core::satellite::{Constellation, SatelliteId};

use super::sentence::{Sentence, write_sentence};
use super::{TimeOfDay, is_alert};

/// Satellites that one `GSA` names.
const PER_GSA: usize = 12;

/// The largest dilution of precision that is written; readers take it for "unusable".
const MAX_DOP: f64 = 99.99;

/// Identifies "all signals" of a system (NMEA 0183 v4.11 table 20): a combination of frequencies is no single signal.
const ALL_SIGNALS: u32 = 0;

/// Radians in degrees.
fn degrees(angle_rad: f64) -> f64 {
    angle_rad * (180.0 / core::f64::consts::PI)
}

/// `GNS`: time, position, satellites used, navigational status.
pub(super) fn write_position<W: Write, const N: usize>(
    report: &Report<N>,
    time: TimeOfDay,
    out: &mut W,
) -> Result<(), W::Error> {
    let mut sentence = Sentence::new("GNGNS");
    sentence.time(Some(time));
    let solution = report.solution.as_ref();
    match solution {
        Some(solution) => position(&mut sentence, solution, report.used.len()),
        None => sentence.empty().empty().empty().empty().text("N").integer(0, 2).empty().empty().empty(),
    };
    let status = navigational_status(report.verdict, solution.is_some());
    write_sentence(sentence.empty().empty().text(status), out)
}

/// Latitude to geoid separation.
fn position<'s>(sentence: &'s mut Sentence, solution: &Solution, used: usize) -> &'s mut Sentence {
    sentence
        .angle(degrees(solution.geodetic.latitude_rad), 2, ["N", "S"])
        .angle(degrees(solution.geodetic.longitude_rad), 3, ["E", "W"])
        .text("A")
        .integer(used.min(99) as u32, 2)
        .number(dilution(solution.hdop), 2, 5)
        .number(solution.geodetic.height_m, 3, 10)
        .number(0.0, 1, 3)
}

const fn navigational_status(verdict: Verdict, has_position: bool) -> &'static str {
    match (verdict, has_position) {
        (Verdict::Protected(_), _) => "S",
        (Verdict::Alert(_), _) => "U",
        (Verdict::Unavailable(_), true) => "C",
        (Verdict::Unavailable(_), false) => "V",
    }
}

/// A dilution of precision that fits into five characters.
fn dilution(value: f64) -> f64 {
    if value < MAX_DOP { value } else { MAX_DOP }
}

/// Talker and system id of a constellation.
const fn system(constellation: Constellation) -> (&'static str, u32) {
    match constellation {
        Constellation::Gps => ("GPGSA", 1),
        Constellation::Glonass => ("GLGSA", 2),
        Constellation::Galileo => ("GAGSA", 3),
        Constellation::Beidou => ("GBGSA", 4),
    }
}

/// `GSA`: the satellites used, by system, and the dilutions of precision of the whole solution.
pub(super) fn write_satellites<W: Write, const N: usize>(
    report: &Report<N>,
    out: &mut W,
) -> Result<(), W::Error> {
    const SYSTEMS: [Constellation; Constellation::COUNT] =
        [Constellation::Gps, Constellation::Glonass, Constellation::Galileo, Constellation::Beidou];
    let Some(solution) = &report.solution else { return Ok(()) };
    let dilutions = [solution.pdop(), solution.hdop, solution.vdop].map(dilution);
    for constellation in SYSTEMS {
        let of_system = || report.used.iter().filter(|used| used.constellation() == constellation);
        for first in (0..of_system().count()).step_by(PER_GSA) {
            let mode = if is_alert(report.verdict) { 1 } else { 3 };
            let satellites = of_system().skip(first).copied();
            write_sentence(&active(constellation, mode, satellites, dilutions), out)?;
        }
    }
    Ok(())
}

/// One `GSA` with the first 12 of the satellites.
fn active(
    constellation: Constellation,
    mode: u32,
    mut satellites: impl Iterator<Item = SatelliteId>,
    dilutions: [f64; 3],
) -> Sentence {
    let (address, id) = system(constellation);
    let mut sentence = Sentence::new(address);
    sentence.text("A").integer(mode, 1);
    for _ in 0..PER_GSA {
        match satellites.next() {
            Some(satellite) => sentence.satellite_number(satellite),
            None => sentence.empty(),
        };
    }
    for value in dilutions {
        sentence.number(value, 2, 5);
    }
    sentence.integer(id, 1);
    sentence
}

/// `GST`: the standard deviations that the covariance promises.
pub(super) fn write_errors<W: Write, const N: usize>(
    report: &Report<N>,
    time: TimeOfDay,
    out: &mut W,
) -> Result<(), W::Error> {
    let mut sentence = Sentence::new("GNGST");
    sentence.time(Some(time));
    let Some(solution) = &report.solution else {
        (0..7).for_each(|_| _ = sentence.empty());
        return write_sentence(&sentence, out);
    };
    let ellipse = ErrorEllipse::new(solution);
    let [latitude_m, longitude_m, height_m] = standard_deviations(solution);
    sentence
        .number(report.residual_rms_m, 3, 8)
        .number(ellipse.semi_major_m, 3, 8)
        .number(ellipse.semi_minor_m, 3, 8)
        .number(ellipse.orientation_deg, 1, 5)
        .number(latitude_m, 3, 8)
        .number(longitude_m, 3, 8)
        .number(height_m, 3, 8);
    write_sentence(&sentence, out)
}

/// Of latitude, longitude and height, m.
fn standard_deviations(solution: &Solution) -> [f64; 3] {
    let [east, _, _, north, _, up] = solution.covariance_m2;
    [north, east, up].map(|variance| libm::sqrt(variance.max(0.0)))
}

/// The ellipse of one standard deviation in the horizontal plane.
struct ErrorEllipse {
    semi_major_m: f64,
    semi_minor_m: f64,
    /// Of the major axis, from true north over east, 0 to 180.
    orientation_deg: f64,
}

impl ErrorEllipse {
    fn new(solution: &Solution) -> Self {
        let [east, covariance, _, north, _, _] = solution.covariance_m2;
        let mean = 0.5 * (north + east);
        let spread = libm::hypot(0.5 * (north - east), covariance);
        let orientation_deg = degrees(0.5 * libm::atan2(2.0 * covariance, north - east));
        Self {
            semi_major_m: libm::sqrt((mean + spread).max(0.0)),
            semi_minor_m: libm::sqrt((mean - spread).max(0.0)),
            // An axis has no sense of direction.
            orientation_deg: if orientation_deg < 0.0 { orientation_deg + 180.0 } else { orientation_deg },
        }
    }
}

/// `GBS`: the satellite used that fits worst, where there is redundancy to tell.
pub(super) fn write_suspect<W: Write, const N: usize>(
    report: &Report<N>,
    time: TimeOfDay,
    requirements: &Requirements,
    out: &mut W,
) -> Result<(), W::Error> {
    match (&report.solution, &report.suspect) {
        (Some(solution), Some(suspect)) => {
            let mut sentence = Sentence::new("GNGBS");
            write_sentence(fault(sentence.time(Some(time)), solution, suspect, requirements), out)
        }
        _ => Ok(()),
    }
}

/// Expected errors to signal id.
fn fault<'s>(
    sentence: &'s mut Sentence,
    solution: &Solution,
    suspect: &Suspect,
    requirements: &Requirements,
) -> &'s mut Sentence {
    let (_, system_id) = system(suspect.satellite.constellation());
    standard_deviations(solution)
        .into_iter()
        .fold(sentence, |sentence, deviation_m| sentence.number(deviation_m, 3, 7))
        .satellite_number(suspect.satellite)
        .probability(requirements.missed_detection.get())
        .number(suspect.bias_m, 3, 8)
        .number(suspect.bias_sigma_m, 3, 8)
        .integer(system_id, 1)
        .integer(ALL_SIGNALS, 1)
}
