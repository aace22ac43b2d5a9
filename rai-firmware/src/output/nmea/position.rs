//! Position and velocity: `RMC`, `GGA`, `GNS`, `VTG`.
//!
//! | sentence | in an alert | unavailable, with a position |
//! |---|---|---|
//! | `RMC` | status `V`, mode `N`, no position | status `A`, mode `A` |
//! | `GGA` | quality 0, no position | quality 1 |
//! | `GNS` | mode `N`, no position | mode `A` |
//! | `VTG` | mode `N`, no velocity | mode `A` |
//!
//! `RMC` and `GNS` end with the navigational status. Some readers ignore status and mode, so that
//! no sentence has a position that must not be used.
//!
//! `GGA` and `GNS` have the altitude above mean sea level and the geoid separation of
//! [`crate::output::geoid`]. The altitude gets the room that the other fields leave, and loses
//! decimals if they are long.
//!
//! Position, separation and time are formatted once for several sentences.

use embedded_io::Write;
use raim_core::report::{Solution, Verdict};

use super::{Sentence, TimeOfDay, write_sentence};
use crate::output::geoid::Altitude;
use crate::output::schedule::{Due, Item};
use crate::output::{Motion, Statement};

/// Largest dilution of precision that is written. Readers take it for "unusable".
const MAX_DOP: f64 = 99.99;

/// Speed below which noise determines the course, m/s.
const COURSE_FROM_M_S: f32 = 0.3;

/// Knots, and kilometres per hour, in a metre per second.
const KNOTS: f32 = 3600.0 / 1852.0;
const KILOMETRES_AN_HOUR: f32 = 3.6;

/// Converts radians to degrees.
pub(super) fn degrees(angle_rad: f64) -> f64 {
    angle_rad * (180.0 / core::f64::consts::PI)
}

/// Returns a dilution of precision that fits into five characters.
pub(super) fn dilution(value: f64) -> f64 {
    if value < MAX_DOP { value } else { MAX_DOP }
}

/// Writes `RMC`, `GGA` and `GNS`, as far as they are due.
pub(super) fn write_position<W: Write, const N: usize>(
    statement: &Statement<'_, N>,
    time: TimeOfDay,
    due: Due,
    out: &mut W,
) -> Result<(), W::Error> {
    let solution = statement.usable_solution();
    let mut place = Sentence::new("");
    if let Some(solution) = solution {
        place.angle(degrees(solution.geodetic.latitude_rad), 2, ["N", "S"]).angle(
            degrees(solution.geodetic.longitude_rad),
            3,
            ["E", "W"],
        );
    }
    let altitude = solution.map(|solution| Altitude::of(&solution.geodetic));
    let mut separation = Sentence::new("");
    separation.optional(altitude.map(|altitude| altitude.separation_m), 1, 6);
    let told = Told {
        time,
        status: navigational_status(statement.report.verdict, solution.is_some()),
        place: if solution.is_some() { place.fields() } else { b",,," },
        solution,
        above_sea_m: altitude.map(|altitude| altitude.above_sea_m),
        separation: separation.fields(),
        used: statement.report.used.len().min(99) as u32,
        motion: statement.usable_motion(),
    };
    if due.has(Item::Rmc) {
        write_sentence(&mut told.rmc(), out)?;
    }
    if due.has(Item::Gga) {
        write_sentence(&mut told.gga(), out)?;
    }
    if due.has(Item::Gns) {
        write_sentence(&mut told.gns(), out)?;
    }
    Ok(())
}

/// Writes `VTG`, which needs no position.
pub(super) fn write_velocity<W: Write, const N: usize>(
    statement: &Statement<'_, N>,
    out: &mut W,
) -> Result<(), W::Error> {
    let mut sentence = Sentence::new("GNVTG");
    let motion = statement.usable_motion();
    course(&mut sentence, motion.as_ref()).ready(b"T").empty().ready(b"M");
    speed(&mut sentence, motion.as_ref(), KNOTS).ready(b"N");
    speed(&mut sentence, motion.as_ref(), KILOMETRES_AN_HOUR).ready(b"K");
    write_sentence(sentence.ready(if motion.is_some() { b"A" } else { b"N" }), out)
}

/// Returns the navigational status of a verdict, with or without a usable position.
const fn navigational_status(verdict: Verdict, has_position: bool) -> &'static [u8] {
    match (verdict, has_position) {
        (Verdict::Protected(_), _) => b"S",
        (Verdict::Alert(_), _) => b"U",
        (Verdict::Unavailable(_), true) => b"C",
        (Verdict::Unavailable(_), false) => b"V",
    }
}

/// Fields of several sentences.
struct Told<'t> {
    time: TimeOfDay,
    status: &'static [u8],
    /// Latitude, hemisphere, longitude, hemisphere; empty without a usable position.
    place: &'t [u8],
    /// Usable solution.
    solution: Option<&'t Solution>,
    /// Altitude above mean sea level, m.
    above_sea_m: Option<f64>,
    /// Geoid separation, m; empty without a usable position.
    separation: &'t [u8],
    used: u32,
    motion: Option<Motion>,
}

impl Told<'_> {
    fn rmc(&self) -> Sentence {
        let mut sentence = Sentence::new("GNRMC");
        sentence.time(Some(self.time)).ready(if self.solution.is_some() { b"A" } else { b"V" });
        sentence.ready(self.place);
        speed(&mut sentence, self.motion.as_ref(), KNOTS);
        course(&mut sentence, self.motion.as_ref());
        let [year, month, day] = self.time.date();
        sentence.integer(day * 10_000 + month * 100 + year % 100, 6);
        sentence.empty().empty().ready(self.mode()).ready(self.status);
        sentence
    }

    fn gga(&self) -> Sentence {
        let mut sentence = Sentence::new("GNGGA");
        sentence.time(Some(self.time)).ready(self.place);
        sentence.ready(if self.solution.is_some() { b"1" } else { b"0" }).integer(self.used, 2);
        self.dilution_and_altitude(&mut sentence, b",M,".len() + b",M,,".len());
        sentence.ready(b"M").ready(self.separation).ready(b"M,,");
        sentence
    }

    fn gns(&self) -> Sentence {
        let mut sentence = Sentence::new("GNGNS");
        sentence.time(Some(self.time)).ready(self.place).ready(self.mode()).integer(self.used, 2);
        self.dilution_and_altitude(&mut sentence, b",".len() + b",,,S".len());
        sentence.ready(self.separation).empty().empty();
        sentence.ready(self.status);
        sentence
    }

    /// Appends the horizontal dilution and the altitude. The altitude has as many decimals as leave
    /// room for the separation and for `around` more characters.
    fn dilution_and_altitude(&self, sentence: &mut Sentence, around: usize) {
        sentence.optional(self.solution.map(|solution| dilution(solution.hdop)), 2, 5);
        let width = sentence.room().saturating_sub(1 + self.separation.len() + around);
        sentence.optional(self.above_sea_m, 3, width);
    }

    fn mode(&self) -> &'static [u8] {
        if self.solution.is_some() { b"A" } else { b"N" }
    }
}

/// Appends the speed over ground, in the unit of which `units` make 1 m/s.
fn speed<'s>(sentence: &'s mut Sentence, motion: Option<&Motion>, units: f32) -> &'s mut Sentence {
    sentence.optional(motion.map(|motion| f64::from(motion.speed_m_s() * units)), 3, 7)
}

/// Appends the course over ground, degrees from true north; empty if the speed is too low to define
/// it.
fn course<'s>(sentence: &'s mut Sentence, motion: Option<&Motion>) -> &'s mut Sentence {
    let moving = motion.filter(|motion| motion.speed_m_s() >= COURSE_FROM_M_S);
    let course_deg = moving.map(|motion| {
        let angle_deg = libm::atan2f(motion.east_m_s, motion.north_m_s) * (180.0 / core::f32::consts::PI);
        let course_deg = if angle_deg < 0.0 { angle_deg + 360.0 } else { angle_deg };
        // A course that would round to 360.00 becomes 0.
        f64::from(if course_deg < 359.995 { course_deg } else { 0.0 })
    });
    sentence.optional(course_deg, 2, 6)
}
