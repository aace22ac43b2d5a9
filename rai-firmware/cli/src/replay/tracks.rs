//! Files of positions over time, which serve as truth.
//!
//! | file | recognised by | heights |
//! |---|---|---|
//! | table | a heading with `week` and `tow` | above the ellipsoid |
//! | NMEA 0183 | lines `$..GGA`; the date comes from `RMC` or `ZDA` | altitude plus geoid separation |
//! | solution of RTKLIB (`.pos`) | lines that begin with `%`, or with a date or a week | as its header says, else above the ellipsoid |
//!
//! Of NMEA and of RTKLIB only fixed positions count if there are any (quality 4, or Q 1).

use std::ops::RangeInclusive;

use anyhow::{Context as _, Result, bail, ensure};
use raim_core::frame::{Ecef, Geodetic, LocalFrame};
use raim_firmware::output::geoid::Altitude;
use raim_firmware::time::GpsTime;

use crate::signal::calendar::date;

/// Heights above the ellipsoid that a truth may have, m: those of the setting `HEIGHT`, which a
/// receiver on an orbit needs, and a margin below. A position beyond was written in another form.
pub(super) const HEIGHTS_M: RangeInclusive<f64> = -1e5..=2e6;

/// A position, and its time.
type Point = (GpsTime, Ecef);

/// Columns of a point in a table, with the form of its coordinates.
#[derive(Clone, Copy, Debug)]
enum Form {
    Cartesian([usize; 3]),
    Geodetic([usize; 3]),
}

/// Reads the positions of a file of any of these forms.
pub(super) fn read(text: &str) -> Result<Vec<Point>> {
    let text = text.trim_start_matches('\u{feff}');
    ensure!(!text.trim().is_empty(), "holds no position");
    let has_heading = |line: &str| {
        let names: Vec<String> = line.split(',').map(|name| name.trim().to_lowercase()).collect();
        ["week", "tow"].iter().all(|wanted| names.iter().any(|name| name == wanted))
    };
    let first = text.lines().next().unwrap_or("");
    let is_gga = |line: &str| line.starts_with('$') && line.get(3..6) == Some("GGA");
    if has_heading(first) {
        table(text)
    } else if text.lines().any(is_gga) {
        nmea(text)
    } else if text.lines().all(|line| line.starts_with('%') || line.trim().is_empty() || is_solution(line)) {
        solution(text)
    } else {
        table(text)
    }
}

fn table(text: &str) -> Result<Vec<Point>> {
    let mut lines = text.lines();
    let heading: Vec<String> =
        lines.next().unwrap_or("").split(',').map(|name| name.trim().to_lowercase()).collect();
    let (time, form) = columns(&heading)?;
    let lines = lines.enumerate().filter(|(_, line)| !line.trim().is_empty());
    lines
        .map(|(index, line)| {
            table_row(line, time, form).with_context(|| format!("line {}: {line:?}", index + 2))
        })
        .collect()
}

/// Returns the columns of the time and of the point.
fn columns(heading: &[String]) -> Result<([usize; 2], Form)> {
    let find = |name: &str| heading.iter().position(|column| column == name);
    let all = |names: [&str; 3]| {
        let [a, b, c] = names.map(find);
        Some([a?, b?, c?])
    };
    let time = find("week").zip(find("tow"));
    let form = all(["x_m", "y_m", "z_m"])
        .map(Form::Cartesian)
        .or_else(|| all(["lat_deg", "lon_deg", "height_m"]).map(Form::Geodetic));
    match (time, form) {
        (Some((week, tow)), Some(form)) => Ok(([week, tow], form)),
        _ => bail!(
            "the heading {:?} does not name week,tow and either x_m,y_m,z_m or lat_deg,lon_deg,height_m",
            heading.join(",")
        ),
    }
}

fn table_row(line: &str, time: [usize; 2], form: Form) -> Result<(GpsTime, Ecef)> {
    let fields: Vec<&str> = line.split(',').map(str::trim).collect();
    let number = |column: usize| -> Result<f64> {
        let field = fields.get(column).with_context(|| format!("column {} is missing", column + 1))?;
        field
            .parse()
            .ok()
            .filter(|value: &f64| value.is_finite())
            .with_context(|| format!("{field:?} is no number"))
    };
    let [week, tow_s] = [number(time[0])?, number(time[1])?];
    ensure!((0.0..65_536.0).contains(&week) && week.fract() == 0.0, "{week} is no GPS week");
    ensure!((0.0..604_800.0).contains(&tow_s), "{tow_s} is no time of week");
    let time = GpsTime { week: week as u16, tow_ms: (tow_s * 1e3).round() as u32 };
    let point = match form {
        Form::Cartesian([x, y, z]) => Ecef::new(number(x)?, number(y)?, number(z)?),
        Form::Geodetic([latitude, longitude, height]) => {
            let (latitude, longitude) = (number(latitude)?, number(longitude)?);
            ensure!(
                latitude.abs() <= 90.0 && longitude.abs() <= 360.0,
                "latitude or longitude is no angle in degrees"
            );
            geodetic(latitude, longitude, number(height)?)
        }
    };
    Ok((time, near_ground(point)?))
}

/// Returns a point on the ellipsoid or above it.
pub(super) fn geodetic(latitude_deg: f64, longitude_deg: f64, height_m: f64) -> Ecef {
    place(latitude_deg, longitude_deg, height_m).to_ecef()
}

fn place(latitude_deg: f64, longitude_deg: f64, height_m: f64) -> Geodetic {
    let (latitude_rad, longitude_rad) = (latitude_deg.to_radians(), longitude_deg.to_radians());
    Geodetic { latitude_rad, longitude_rad, height_m }
}

/// Returns a point unless no receiver is there.
///
/// # Errors
/// Its height is beyond [`HEIGHTS_M`].
pub(super) fn near_ground(point: Ecef) -> Result<Ecef> {
    let height_m = LocalFrame::at(point).height_m();
    ensure!(
        point.is_finite() && HEIGHTS_M.contains(&height_m),
        "must be -100 to 2000 km above the ellipsoid, not {:.0} km",
        height_m * 1e-3
    );
    Ok(point)
}

/// Returns a point at an altitude above mean sea level, with the module's own geoid.
fn above_sea(latitude_deg: f64, longitude_deg: f64, altitude_m: f64) -> Ecef {
    let sea = place(latitude_deg, longitude_deg, 0.0);
    geodetic(latitude_deg, longitude_deg, altitude_m + Altitude::of(&sea).separation_m)
}

/// Returns the points that are fixed if there are any, else all.
fn best(points: Vec<(Point, bool)>) -> Vec<Point> {
    let has_fixed = points.iter().any(|(_, is_fixed)| *is_fixed);
    points.into_iter().filter(|(_, is_fixed)| *is_fixed || !has_fixed).map(|(point, _)| point).collect()
}

/// Reads NMEA. A date holds until the next one; a position before the first date has that date.
fn nmea(text: &str) -> Result<Vec<Point>> {
    let mut points = Vec::new();
    let mut waiting: Vec<Position> = Vec::new();
    // Date as `year month day`, and the time of day of its sentence.
    let mut day: Option<(String, f64)> = None;
    for line in text.lines() {
        let Some(body) = checked(line) else { continue };
        let fields: Vec<&str> = body.split(',').collect();
        let field = |index: usize| fields.get(index).copied().unwrap_or("");
        let kind = field(0).get(2..).unwrap_or("");
        let date_of = match kind {
            "RMC" => date_of_rmc(field(9)),
            "ZDA" if !field(4).is_empty() => Some(format!("{} {} {}", field(4), field(3), field(2))),
            _ => None,
        };
        if let Some((date_of, second)) = date_of.zip(second_of_day(field(1))) {
            // Those that wait are of this instant, or just before it.
            points.extend(waiting.drain(..).filter_map(|point| dated(&date_of, &point)));
            day = Some((date_of, second));
        }
        if kind == "GGA"
            && let Some(point) = position(&fields)
        {
            match &day {
                // Behind midnight the date of its own instant comes first.
                Some((day, second)) if point.second + 43_200.0 >= *second => {
                    points.extend(dated(day, &point));
                }
                _ => waiting.push(point),
            }
        }
    }
    ensure!(
        !points.is_empty() || waiting.is_empty(),
        "holds GGA without a date: no RMC or ZDA is among the sentences"
    );
    Ok(best(points))
}

/// A position of GGA.
struct Position {
    second: f64,
    point: Ecef,
    is_fixed: bool,
}

/// Returns a position with its day: that of the sentence before it.
fn dated(day: &str, position: &Position) -> Option<(Point, bool)> {
    let [hour, minute] = [3600.0, 60.0].map(|unit| (position.second / unit).floor());
    let text = format!("{day} {hour} {} {:.3}", minute % 60.0, position.second % 60.0);
    Some(((date(&text, Some(0))?, position.point), position.is_fixed))
}

/// Returns the sentence between `$` and `*` if its checksum holds.
fn checked(line: &str) -> Option<&str> {
    let (body, sum) = line.trim_end().strip_prefix('$')?.rsplit_once('*')?;
    let want = body.bytes().fold(0, |sum, byte| sum ^ byte);
    (u8::from_str_radix(sum, 16).ok()? == want).then_some(body)
}

fn date_of_rmc(text: &str) -> Option<String> {
    let part = |from: usize| text.get(from..from + 2)?.parse::<u16>().ok();
    let (day, month, year) = (part(0)?, part(2)?, part(4)?);
    Some(format!("{} {month} {day}", if year < 80 { 2000 + year } else { 1900 + year }))
}

fn second_of_day(text: &str) -> Option<f64> {
    let hours: f64 = text.get(0..2)?.parse().ok()?;
    let minutes: f64 = text.get(2..4)?.parse().ok()?;
    let seconds: f64 = text.get(4..)?.parse().ok()?;
    Some(hours * 3600.0 + minutes * 60.0 + seconds)
}

/// Returns the position in the fields of GGA; `None` without one.
fn position(fields: &[&str]) -> Option<Position> {
    let field = |index: usize| fields.get(index).copied().unwrap_or("");
    let angle = |text: &str, side: &str| {
        let value: f64 = text.parse().ok()?;
        let degrees = (value / 100.0).floor();
        let angle = degrees + (value - 100.0 * degrees) / 60.0;
        Some(if matches!(side, "S" | "W") { -angle } else { angle })
    };
    let quality: u8 = field(6).parse().ok().filter(|quality| *quality > 0)?;
    let (latitude, longitude) = (angle(field(2), field(3))?, angle(field(4), field(5))?);
    let altitude_m: f64 = field(9).parse().ok()?;
    let point = match field(11).parse::<f64>() {
        Ok(separation_m) => geodetic(latitude, longitude, altitude_m + separation_m),
        Err(_) => above_sea(latitude, longitude, altitude_m),
    };
    let point = near_ground(point).ok()?;
    Some(Position { second: second_of_day(field(1))?, point, is_fixed: quality == 4 })
}

/// Splits a line of a solution, whose columns blanks, commas or semicolons separate.
fn parts(line: &str) -> Vec<&str> {
    line.split([' ', '\t', ',', ';']).filter(|part| !part.is_empty()).collect()
}

/// Returns true if a line begins as a solution does: a date and a time, or a week and a second.
fn is_solution(line: &str) -> bool {
    let parts = parts(line);
    let [first, second, ..] = parts.as_slice() else { return false };
    let is_date = first.split('/').count() == 3 && second.split(':').count() == 3;
    let is_week = first.parse::<u16>().is_ok() && second.parse::<f64>().is_ok() && second.contains('.');
    (is_date || is_week) && parts.len() >= 6
}

/// Reads a solution of RTKLIB ([RTKLIB] manual 2.4.2, appendix B.1).
///
/// [RTKLIB]: https://www.rtklib.com
fn solution(text: &str) -> Result<Vec<Point>> {
    let (mut ahead_of_utc_h, mut is_above_sea) = (None, false);
    let mut points = Vec::new();
    for (index, line) in text.lines().enumerate() {
        if let Some(header) = line.strip_prefix('%') {
            let words = header.trim_start();
            if words.starts_with("UTC") {
                ahead_of_utc_h = Some(0);
            } else if words.starts_with("JST") {
                ahead_of_utc_h = Some(9);
            }
            if header.contains("baseline") && !header.contains("pos mode") {
                bail!(
                    "holds baselines and no positions: set the solution format of RTKLIB to lat/lon/height or XYZ"
                );
            }
            ensure!(!header.contains("(d'\")"), "holds degrees, minutes and seconds: set RTKLIB to degrees");
            is_above_sea |= header.contains("WGS84/geodetic");
        } else if !line.trim().is_empty() {
            let point = solution_row(line, ahead_of_utc_h, is_above_sea);
            points.push(point.with_context(|| format!("line {}: {line:?}", index + 1))?);
        }
    }
    Ok(best(points))
}

fn solution_row(line: &str, ahead_of_utc_h: Option<u8>, is_above_sea: bool) -> Result<(Point, bool)> {
    let parts = parts(line);
    let &[day, second, a, b, c, ref rest @ ..] = parts.as_slice() else {
        bail!("has fewer than five columns")
    };
    let number = |text: &str| text.parse::<f64>().with_context(|| format!("{text:?} is no number"));
    let time = if day.contains('/') {
        date(&format!("{} {}", day.replace('/', " "), second.replace(':', " ")), ahead_of_utc_h)
    } else {
        let (week, tow_s) = (day.parse::<u16>()?, number(second)?);
        (0.0..604_800.0).contains(&tow_s).then_some(GpsTime { week, tow_ms: (tow_s * 1e3).round() as u32 })
    };
    let time = time.context("has no time after 1980")?;
    let (a, b, c) = (number(a)?, number(b)?, number(c)?);
    // No position near the ground is within both.
    let point = match a.abs() <= 90.0 && b.abs() <= 360.0 {
        true if is_above_sea => above_sea(a, b, c),
        true => geodetic(a, b, c),
        false => Ecef::new(a, b, c),
    };
    Ok(((time, near_ground(point)?), rest.first() == Some(&"1")))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn week_and_second((time, _): &Point) -> (u16, f64) {
        (time.week, f64::from(time.tow_ms) * 1e-3)
    }

    /// The header and the first lines of a file that RTKLIB demo5 b31 wrote (josm.openstreetmap.de,
    /// ticket 17829): 08:03:55.5 of 2019-06-08 is second 547,435.5 of week 2056.
    const POS: &str = "% program   : RTKLIB ver.demo5 b31
% obs start : 2019/06/08 08:03:55.5 GPST (week2056 547435.5s)
% pos mode  : kinematic
% ref pos   : 47.060027749  -1.350495019   84.8600
%
% (lat/lon/height=WGS84/ellipsoidal,Q=1:fix,2:float,3:sbas,4:dgps,5:single,6:ppp,ns=# of satellites)
%  GPST                  latitude(deg) longitude(deg)  height(m)   Q  ns   sdn(m)
2019/06/08 08:03:55.500   47.060027749   -1.350495019    84.8600   2   9   0.5000
2019/06/08 08:03:56.000   47.060027749   -1.350495019    84.8600   1   9   0.0100
";

    #[test]
    fn solutions_of_rtklib_are_read_in_every_form() {
        let points = read(POS).unwrap();
        // Only the fixed one counts.
        assert_eq!(points.iter().map(week_and_second).collect::<Vec<_>>(), [(2056, 547_436.0)]);
        let want = points[0].1;
        assert!((LocalFrame::at(want).height_m() - 84.86).abs() < 1e-4);
        let week = POS
            .replace("2019/06/08 08:03:56.000", "2056 547436.000")
            .replace("2019/06/08 08:03:55.500", "2056 547435.500");
        assert_eq!(read(&week).unwrap(), points);
        let utc = POS.replace("%  GPST", "%  UTC ").replace("08:03:56.000", "08:03:38.000");
        assert_eq!(read(&utc).unwrap(), points);
        let cartesian = format!("2056,547436.000,{:.4},{:.4},{:.4},1,9\n", want.x_m, want.y_m, want.z_m);
        assert!(read(&cartesian).unwrap()[0].1.distance_m(want) < 1e-3);
        let geoid = POS.replace("ellipsoidal", "geodetic");
        let raised_m = LocalFrame::at(read(&geoid).unwrap()[0].1).height_m() - 84.86;
        // EGM96 in the Vendée: 47 m to 49 m.
        assert!((46.0..50.0).contains(&raised_m), "{raised_m}");
        let baseline = "%  GPST  e-baseline(m) n-baseline(m) u-baseline(m) Q\n2056 547436.000 1 2 3 1 9\n";
        assert!(format!("{:#}", read(baseline).unwrap_err()).contains("baselines"));
    }

    fn sentence(body: &str) -> String {
        format!("${body}*{:02X}\r\n", body.bytes().fold(0, |sum, byte| sum ^ byte))
    }

    #[test]
    fn nmea_has_its_date_from_rmc_and_its_height_from_the_geoid_separation() {
        let gga = |time: &str, quality: u8, separation: &str| {
            sentence(&format!(
                "GNGGA,{time},4703.60166,N,00121.02970,W,{quality},12,0.6,37.5,M,{separation},M,,"
            ))
        };
        let rmc = |time: &str, date: &str| {
            sentence(&format!("GNRMC,{time},A,4703.60166,N,00121.02970,W,0.0,,{date},,,A"))
        };
        // Across midnight, with the date behind the position or before it.
        let text = [
            gga("235958.00", 1, "47.4"),
            rmc("235958.00", "070619"),
            gga("235959.50", 1, "47.4"),
            gga("000000.00", 1, "47.4"),
            rmc("000000.00", "080619"),
            rmc("000001.00", "080619"),
            gga("000001.00", 1, ""),
        ]
        .concat();
        let points = read(&text).unwrap();
        let second = 518_400.0 + 18.0;
        let want: Vec<_> = [-2.0, -0.5, 0.0, 1.0].map(|after| (2056, second + after)).into();
        assert_eq!(points.iter().map(week_and_second).collect::<Vec<_>>(), want);
        for (_, point) in &points {
            assert!((LocalFrame::at(*point).height_m() - 84.9).abs() < 1.5, "{point:?}");
        }
        let fixed = text + &gga("000002.00", 4, "47.4");
        assert_eq!(read(&fixed).unwrap().len(), 1);
        let error = format!("{:#}", read(&gga("000002.00", 4, "47.4")).unwrap_err());
        assert!(error.contains("no RMC or ZDA"), "{error}");
    }
}
