//! True position of the antenna.

use std::ops::RangeInclusive;
use std::path::Path;

use anyhow::{Context, Result, bail, ensure};
use raim_core::frame::{Ecef, Geodetic, LocalFrame};
use raim_firmware::time::GpsTime;

/// Largest difference between the time tag of a point and the receiver's, ms. Receivers' tags are
/// some ms off the second, and a car moves a metre in this time.
const NEAREST_MS: i64 = 50;

/// Heights above the ellipsoid that a truth may have, m: those of the setting `HEIGHT`, which a
/// receiver on an orbit needs, and a margin below. A position beyond was written in another form.
const HEIGHTS_M: RangeInclusive<f64> = -1e5..=2e6;

/// True position of the antenna.
#[derive(Clone, Debug, PartialEq)]
pub enum Truth {
    /// A fixed point.
    Fixed(Ecef),
    /// A point for each instant, in the order of time.
    Moving(Vec<(GpsTime, Ecef)>),
}

/// Columns of a point in a table, with the form of its coordinates.
#[derive(Clone, Copy, Debug)]
enum Form {
    Cartesian([usize; 3]),
    Geodetic([usize; 3]),
}

impl Truth {
    /// Reads `X,Y,Z` in metres, or latitude and longitude in degrees and height above the ellipsoid
    /// in metres. No position at such a height is valid in both forms.
    ///
    /// # Errors
    /// The text has another form; the message has an example.
    pub fn parse(text: &str) -> Result<Self> {
        let numbers: Vec<f64> =
            text.split(',').map(|part| part.trim().parse()).collect::<Result<_, _>>().with_context(|| {
                format!(
                    "{text:?} is neither X,Y,Z in metres, as in 3582104.9,532590.2,5232755.3, nor latitude,longitude,\
                     height in degrees and metres, as in 55.49,8.457,59.6"
                )
            })?;
        let &[a, b, c] = numbers.as_slice() else {
            bail!("{text:?} has {} numbers, not 3: X,Y,Z, or latitude,longitude,height", numbers.len());
        };
        ensure!(
            numbers.iter().any(|number| *number != 0.0),
            "{text:?} is where a position that was never set is"
        );
        let is_geodetic = a.abs() <= 90.0 && b.abs() <= 360.0 && HEIGHTS_M.contains(&c);
        let point = if is_geodetic { geodetic(a, b, c) } else { Ecef::new(a, b, c) };
        near_ground(point).with_context(|| format!("{text:?}")).map(Self::Fixed)
    }

    /// Reads a table with a heading that names `week` and `tow`, and `x_m`, `y_m`, `z_m` or
    /// `lat_deg`, `lon_deg`, `height_m` (above the ellipsoid). Other columns are skipped.
    ///
    /// # Errors
    /// The file or a line is unreadable.
    pub fn from_csv(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path).with_context(|| format!("truth file {}", path.display()))?;
        ensure!(!text.trim().is_empty(), "{} holds no position", path.display());
        let mut lines = text.lines();
        let heading: Vec<String> =
            lines.next().unwrap_or("").split(',').map(|name| name.trim().to_lowercase()).collect();
        let (time, form) = columns(&heading).with_context(|| path.display().to_string())?;
        let mut points = Vec::new();
        for (index, line) in lines.enumerate().filter(|(_, line)| !line.trim().is_empty()) {
            let row = row(line, time, form);
            points.push(row.with_context(|| format!("{}:{}: {line:?}", path.display(), index + 2))?);
        }
        ensure!(!points.is_empty(), "{} holds no position", path.display());
        points.sort_by_key(|(time, _)| *time);
        Ok(Self::Moving(points))
    }

    /// Returns the position of the antenna at a time; `None` if none is known within 50 ms.
    pub fn at(&self, time: GpsTime) -> Option<Ecef> {
        let points = match self {
            Self::Fixed(point) => return Some(*point),
            Self::Moving(points) => points,
        };
        let after = points.partition_point(|(at, _)| *at < time);
        let neighbours = points.get(after.saturating_sub(1)..).unwrap_or(&[]).iter().take(2);
        let distance_ms = |at: &GpsTime| at.since_ms(time).abs();
        let (at, point) = neighbours.min_by_key(|(at, _)| distance_ms(at))?;
        (distance_ms(at) <= NEAREST_MS).then_some(*point)
    }
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

fn row(line: &str, time: [usize; 2], form: Form) -> Result<(GpsTime, Ecef)> {
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

fn geodetic(latitude_deg: f64, longitude_deg: f64, height_m: f64) -> Ecef {
    let (latitude_rad, longitude_rad) = (latitude_deg.to_radians(), longitude_deg.to_radians());
    Geodetic { latitude_rad, longitude_rad, height_m }.to_ecef()
}

fn near_ground(point: Ecef) -> Result<Ecef> {
    let height_m = LocalFrame::at(point).height_m();
    ensure!(
        point.is_finite() && HEIGHTS_M.contains(&height_m),
        "must be -100 to 2000 km above the ellipsoid, not {:.0} km",
        height_m * 1e-3
    );
    Ok(point)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Esbjerg in both forms of its station log; the angles are rounded to 0.1".
    const ESBJERG: &str = "3582104.93,532590.24,5232755.27";

    fn point(text: &str) -> Ecef {
        match Truth::parse(text).unwrap() {
            Truth::Fixed(point) => point,
            Truth::Moving(_) => panic!("one point is no path"),
        }
    }

    fn csv(text: &str) -> Result<Truth> {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), text).unwrap();
        Truth::from_csv(file.path())
    }

    fn time(tow_ms: u32) -> GpsTime {
        GpsTime { week: 2051, tow_ms }
    }

    #[test]
    fn latitude_and_longitude_are_not_taken_for_metres() {
        // On the equator at the meridian, the ellipsoid is 6,378,137 m from the centre.
        assert!(point("0,0,100").distance_m(Ecef::new(6_378_237.0, 0.0, 0.0)) < 1e-6);
        assert!(point("90, 0, 0").distance_m(Ecef::new(0.0, 0.0, 6_356_752.314_2)) < 1e-3);
        assert!(point(ESBJERG).distance_m(Ecef::new(3_582_104.93, 532_590.24, 5_232_755.27)) < 1e-6);
    }

    #[test]
    fn what_is_no_position_is_refused_with_the_reason() {
        for (text, want) in
            [("55.5,8.4", "2 numbers"), ("5e6,8,9e6", "-100 to 2000 km above"), ("a,b,c", "nor latitude")]
        {
            let error = format!("{:#}", Truth::parse(text).unwrap_err());
            assert!(error.contains(want), "{text}: {error}");
        }
    }

    /// 500 km above the equator: the radius of the ellipsoid there is 6,378,137 m.
    #[test]
    fn a_truth_may_be_on_an_orbit() {
        let want = Ecef::new(6_878_137.0, 0.0, 0.0);
        assert!(point("6878137,0,0").distance_m(want) < 1e-6);
        assert!(point("0,0,500000").distance_m(want) < 1e-6);
        let table = csv("week,tow,x_m,y_m,z_m\n2051,10,6878137,0,0\n").unwrap();
        assert_eq!(table.at(time(10_000)), Some(want));
        for (text, is_accepted) in [("0,0,2000000", true), ("0,0,2000001", false), ("0,0,-100001", false)] {
            assert_eq!(Truth::parse(text).is_ok(), is_accepted, "{text}");
        }
    }

    #[test]
    fn a_truth_is_found_by_the_nearest_time_within_fifty_milliseconds() {
        let truth = csv("week,tow,x_m,y_m,z_m\n2051,10.000,6378137,0,0\n2051,11.000,6378138,0,0\n").unwrap();
        let x = |tow_ms| truth.at(time(tow_ms)).map(|point| point.x_m);
        for (tow_ms, want) in [
            (10_000, Some(6_378_137.0)),
            (9_997, Some(6_378_137.0)),
            (10_050, Some(6_378_137.0)),
            (10_051, None),
            (10_996, Some(6_378_138.0)),
            (11_004, Some(6_378_138.0)),
            (12_000, None),
        ] {
            assert_eq!(x(tow_ms), want, "{tow_ms}");
        }
    }

    #[test]
    fn a_table_says_by_its_heading_what_it_holds() {
        let geodetic = csv("tow,week,lat_deg,lon_deg,height_m,quality\n10,2051,0,90,5,fix\n").unwrap();
        assert!(geodetic.at(time(10_000)).unwrap().distance_m(Ecef::new(0.0, 6_378_142.0, 0.0)) < 1e-6);
        for (text, want) in [
            ("2051,10,6378137,0,0\n", "does not name"),
            ("week,tow,lat,lon\n2051,10,1,2\n", "does not name"),
            ("week,tow,x_m,y_m,z_m\n2051,10,55.5,8.4,60\n", ":2"),
            ("week,tow,x_m,y_m,z_m\n2051,10,6378137,0\n", "column 5 is missing"),
            ("week,tow,x_m,y_m,z_m\n", "holds no position"),
        ] {
            let error = format!("{:#}", csv(text).unwrap_err());
            assert!(error.contains(want), "{text}: {error}");
        }
    }
}
