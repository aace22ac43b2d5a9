//! True position of the antenna.

use std::path::Path;

use anyhow::{Context, Result, bail, ensure};
use raim_core::frame::Ecef;
use raim_firmware::time::GpsTime;

use super::tracks;

/// Largest difference between the time tag of a point and the receiver's, ms. Receivers' tags are
/// some ms off the second, and a car moves a metre in this time.
const NEAREST_MS: i64 = 50;

/// True position of the antenna.
#[derive(Clone, Debug, PartialEq)]
pub enum Truth {
    /// A fixed point.
    Fixed(Ecef),
    /// A point for each instant, in the order of time.
    Moving(Vec<(GpsTime, Ecef)>),
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
        let is_geodetic = a.abs() <= 90.0 && b.abs() <= 360.0 && tracks::HEIGHTS_M.contains(&c);
        let point = if is_geodetic { tracks::geodetic(a, b, c) } else { Ecef::new(a, b, c) };
        // A thousand kilometres from the centre there is no antenna.
        let is_no_point = numbers.iter().all(|number| number.abs() < 1e6);
        let hint =
            if is_no_point { ": is no X,Y,Z in metres, and of angles the latitude stands first" } else { "" };
        tracks::near_ground(point).with_context(|| format!("{text:?}{hint}")).map(Self::Fixed)
    }

    /// Reads `X,Y,Z` as [`Self::parse`] does, or the name of a file with positions over time.
    ///
    /// # Errors
    /// The text has neither form, or the file is unreadable.
    pub fn of(text: &str) -> Result<Self> {
        if Path::new(text).is_file() { Self::from_file(Path::new(text)) } else { Self::parse(text) }
    }

    /// Reads positions over time: a table, NMEA, or a solution of RTKLIB. A table has a heading that
    /// names `week` and `tow`, and `x_m`, `y_m`, `z_m` or `lat_deg`, `lon_deg`, `height_m` (above the
    /// ellipsoid). Other columns are skipped.
    ///
    /// # Errors
    /// The file or a line is unreadable.
    pub fn from_file(path: &Path) -> Result<Self> {
        let text = std::fs::read(path).with_context(|| format!("truth file {}", path.display()))?;
        let text = String::from_utf8_lossy(&text);
        let mut points = tracks::read(&text).with_context(|| path.display().to_string())?;
        ensure!(!points.is_empty(), "{} holds no position", path.display());
        points.sort_by_key(|(time, _)| *time);
        Ok(Self::Moving(points))
    }

    /// Returns `X,Y,Z`, or latitude, longitude and height, in the order and with the signs in which it
    /// is nearest to a position, with the distance, m.
    fn nearest(text: &str, position: Ecef) -> Option<(String, f64)> {
        let parts: Vec<&str> = text.split(',').map(str::trim).collect();
        let &[a, b, c] = parts.as_slice() else { return None };
        let orders = [[a, b, c], [a, c, b], [b, a, c], [b, c, a], [c, a, b], [c, b, a]];
        let signs = |part: &str| {
            let other = part.strip_prefix('-').map_or_else(|| format!("-{part}"), str::to_owned);
            [part.to_owned(), other]
        };
        let texts = orders.iter().flat_map(|[a, b, c]| {
            let (second, third) = (signs(b), signs(c));
            let pairs = second.into_iter().flat_map(move |b| third.clone().map(|c| [b.clone(), c]));
            let firsts = signs(a);
            pairs.flat_map(move |[b, c]| firsts.clone().map(|a| format!("{a},{b},{c}")))
        });
        let distance = |text: String| match Self::parse(&text).ok()? {
            Self::Fixed(point) => Some((text, point.distance_m(position))),
            Self::Moving(_) => None,
        };
        texts.filter_map(distance).min_by(|one, other| one.1.total_cmp(&other.1))
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

/// Positions that are all so far from the truth that it cannot be that of the recording.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Far {
    /// Distance of the nearest position, m.
    pub(super) least_m: f64,
    /// That position.
    pub(super) position: Ecef,
}

impl Far {
    /// Distance beyond which no position of a receiver is wrong by itself, m.
    const LEAST_M: f64 = 100e3;

    /// Takes a further position.
    pub(super) fn nearer(far: Option<Self>, position: Ecef, distance_m: f64) -> Self {
        match far {
            Some(far) if far.least_m <= distance_m => far,
            _ => Self { least_m: distance_m, position },
        }
    }

    /// Returns true if the truth must be that of another place.
    pub(super) fn is_elsewhere(&self) -> bool {
        self.least_m > Self::LEAST_M
    }

    /// Asks whether the numbers of the truth, as they were given, stand in another order.
    pub(super) fn words(&self, given: Option<&str>) -> String {
        let kilometres = |metres: f64| (metres * 1e-3).round();
        let far = format!("the truth is {} km or more from every position", kilometres(self.least_m));
        let given = given.filter(|text| !Path::new(text).is_file());
        let Some(given) = given else {
            return format!("{far}: are its columns in another order, or is it that of another recording?");
        };
        let form = "X,Y,Z in metres, or latitude,longitude,height in degrees and metres";
        match Truth::nearest(given, self.position).filter(|(_, metres)| *metres < Self::LEAST_M) {
            Some((text, metres)) => format!(
                "{far}: are its numbers in another order? {text} is {} km away; it takes {form}",
                kilometres(metres)
            ),
            None => format!("{far}: is it that of another recording? It takes {form}"),
        }
    }
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
        Truth::from_file(file.path())
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
    fn truth_in_another_order_or_with_another_sign_is_asked_for() {
        let position = point(ESBJERG);
        let far = |given: Option<&str>| Far { least_m: 5_525_130.0, position }.words(given);
        for (given, want) in [
            ("8.457,55.49,59.6", "in another order? 55.49,8.457,59.6 is 0 km away"),
            ("55.49,-8.457,59.6", "in another order? 55.49,8.457,59.6 is 0 km away"),
            ("532590.24,3582104.93,5232755.27", "? 3582104.93,532590.24,5232755.27 is 0 km away"),
            ("-33.9,18.4,20", "is it that of another recording?"),
        ] {
            let have = far(Some(given));
            assert!(have.starts_with("the truth is 5525 km or more") && have.contains(want), "{have}");
        }
        assert!(far(None).contains("columns in another order"));
        let near = Far::nearer(Some(Far { least_m: 2e5, position }), position, 9e4);
        assert!(!near.is_elsewhere() && Far::nearer(None, position, 1.1e5).is_elsewhere());
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
            ("week,tow,x_m,y_m,z_m\n2051,10,55.5,8.4,60\n", "line 2"),
            ("week,tow,x_m,y_m,z_m\n2051,10,6378137,0\n", "column 5 is missing"),
            ("week,tow,x_m,y_m,z_m\n", "holds no position"),
        ] {
            let error = format!("{:#}", csv(text).unwrap_err());
            assert!(error.contains(want), "{text}: {error}");
        }
    }
}
