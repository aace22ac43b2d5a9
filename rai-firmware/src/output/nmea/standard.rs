//! Satellites used and accuracy of the position: `GSA`, `GST`, `GBS`.
//!
//! | sentence | symbol | meaning | unit |
//! |---|---|---|---|
//! | `GST` | `a`, `b` | semi-axes of the error ellipse, 1 sigma: `a², b² = (N+E)/2 ± √(((N−E)/2)² + C²)` | m |
//! | `GST` | `θ` | its orientation from true north over east: `½ atan2(C, (N−E)/2)` | ° |
//! | `GBS` | | bias of the satellite that fits worst, with its standard deviation | m |
//!
//! `E`, `N`, `C` are the variances of east and north and their covariance. The root mean square in
//! `GST` is that of the residuals.

use embedded_io::Write;
use raim_core::internals::numeric::sqrt;
use raim_core::report::{Report, Solution, Suspect};
use raim_core::requirements::Requirements;
use raim_core::satellite::SatelliteId;

use super::position::dilution;
use super::{Sentence, TimeOfDay, write_sentence};
use crate::output::Statement;

/// Number of satellites in one `GSA`.
const PER_GSA: usize = 12;

/// Signal id for "all signals" of a system ([NMEA-0183] v4.11 table 20), because a combination of
/// frequencies is not a single signal.
///
/// [NMEA-0183]: crate#references
const ALL_SIGNALS: u32 = 0;

/// Talker and system id of each system, by the letter of its satellites.
const SYSTEMS: [(char, &str, u32); 5] =
    [('G', "GPGSA", 1), ('R', "GLGSA", 2), ('E', "GAGSA", 3), ('C', "GBGSA", 4), ('J', "GQGSA", 5)];

/// Returns the system id of a satellite.
fn system_id(satellite: SatelliteId) -> u32 {
    let own = SYSTEMS.into_iter().find(|(letter, ..)| *letter == satellite.name().0);
    own.map_or(0, |(.., id)| id)
}

/// Writes `GSA`: the satellites used, by system, and the dilutions of precision of the whole
/// solution.
pub(super) fn write_satellites<W: Write, const N: usize>(
    statement: &Statement<'_, N>,
    out: &mut W,
) -> Result<(), W::Error> {
    let report = statement.report;
    let Some(solution) = &report.solution else { return Ok(()) };
    let mode = if statement.is_alert() { 1 } else { 3 };
    let dilutions = [solution.pdop(), solution.hdop, solution.vdop].map(dilution);
    let of_system = |letter| report.used.iter().filter(move |used| used.name().0 == letter);
    let mut left = SYSTEMS.map(|(letter, ..)| of_system(letter).count().div_ceil(PER_GSA));
    let mut last = None;
    // gpsd forgets what it has heard if two sentences of one talker follow each other. The system
    // with most sentences left therefore comes next, and none twice in a row if there is another.
    while let Some(next) = following(&left, last) {
        let (Some(left), Some((letter, address, id))) = (left.get_mut(next), SYSTEMS.get(next).copied())
        else {
            break;
        };
        let satellites =
            of_system(letter).skip(PER_GSA * (of_system(letter).count().div_ceil(PER_GSA) - *left));
        *left -= 1;
        last = Some(next);
        write_sentence(&mut active((address, id), mode, satellites.copied(), dilutions), out)?;
    }
    Ok(())
}

/// Returns the number of the system with most sentences left, which is the last one only if no
/// other has any; `None` if none has.
fn following(left: &[usize; SYSTEMS.len()], last: Option<usize>) -> Option<usize> {
    let others = left.iter().enumerate().filter(|(number, count)| **count > 0 && Some(*number) != last);
    let most = others.fold(None, |most: Option<(usize, usize)>, (number, count)| match most {
        Some((_, greatest)) if *count <= greatest => most,
        _ => Some((number, *count)),
    });
    let again = last.filter(|number| left.get(*number).is_some_and(|count| *count > 0));
    most.map(|(number, _)| number).or(again)
}

/// Returns one `GSA` with the first 12 of the satellites.
fn active(
    (address, id): (&str, u32),
    mode: u32,
    mut satellites: impl Iterator<Item = SatelliteId>,
    dilutions: [f64; 3],
) -> Sentence {
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

/// Writes `GST`: the standard deviations of the covariance.
pub(super) fn write_errors<W: Write, const N: usize>(
    report: &Report<N>,
    time: TimeOfDay,
    out: &mut W,
) -> Result<(), W::Error> {
    let mut sentence = Sentence::new("GNGST");
    sentence.time(Some(time));
    let Some(solution) = &report.solution else {
        (0..7).for_each(|_| _ = sentence.empty());
        return write_sentence(&mut sentence, out);
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
    write_sentence(&mut sentence, out)
}

/// Returns the standard deviations of latitude, longitude and height, m.
fn standard_deviations(solution: &Solution) -> [f64; 3] {
    let [east, _, _, north, _, up] = solution.covariance_m2;
    [north, east, up].map(|variance| f64::from(sqrt((variance as f32).max(0.0))))
}

/// Ellipse of one standard deviation in the horizontal plane.
///
/// Computed in single precision, which the processor supports and which suffices: some metres to
/// the millimetre need four digits.
struct ErrorEllipse {
    semi_major_m: f64,
    semi_minor_m: f64,
    /// Orientation of the major axis, degrees from true north over east, 0 to 180.
    orientation_deg: f64,
}

impl ErrorEllipse {
    fn new(solution: &Solution) -> Self {
        let [east, covariance, _, north, _, _] = solution.covariance_m2.map(|element| element as f32);
        let (mean, difference) = (0.5 * (north + east), 0.5 * (north - east));
        let spread = sqrt(difference * difference + covariance * covariance);
        let orientation_deg = libm::atan2f(covariance, difference) * (90.0 / core::f32::consts::PI);
        let axis = |variance: f32| f64::from(sqrt(variance.max(0.0)));
        Self {
            semi_major_m: axis(mean + spread),
            semi_minor_m: axis(mean - spread),
            // An axis points both ways, so that its angle is reported from 0 to 180°.
            orientation_deg: f64::from(if orientation_deg < 0.0 {
                orientation_deg + 180.0
            } else {
                orientation_deg
            }),
        }
    }
}

/// Writes `GBS`: the satellite used that fits worst, if there is redundancy.
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

/// Appends the fields from the expected errors to the signal id.
fn fault<'s>(
    sentence: &'s mut Sentence,
    solution: &Solution,
    suspect: &Suspect,
    requirements: &Requirements,
) -> &'s mut Sentence {
    standard_deviations(solution)
        .into_iter()
        .fold(sentence, |sentence, deviation_m| sentence.number(deviation_m, 3, 7))
        .satellite_number(suspect.satellite)
        .probability(requirements.missed_detection.get())
        .number(suspect.bias_m, 3, 8)
        .number(suspect.bias_sigma_m, 3, 8)
        .integer(system_id(suspect.satellite), 1)
        .integer(ALL_SIGNALS, 1)
}

/// Returns `ZDA`: time and date, with UTC as the local zone.
pub(super) fn date_and_time(time: TimeOfDay) -> Sentence {
    let [year, month, day] = time.date();
    let mut sentence = Sentence::new("GNZDA");
    sentence.time(Some(time)).integer(day, 2).integer(month, 2).integer(year, 4).ready(b"00").ready(b"00");
    sentence
}
