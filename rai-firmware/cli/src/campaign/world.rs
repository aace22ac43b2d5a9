//! Outline of the land: enough to recognise places on a map.
//!
//! The data are Natural Earth's land polygons of 1:110 million, version 4.1, which are in the
//! public domain (naturalearthdata.com), with a tolerance of 0.6° and without islands below three
//! square degrees. Each line is one polygon, its corners as `longitude latitude` in degrees.

const LAND: &str = include_str!("land.txt");

/// Returns closed lines of longitude and latitude, degrees.
pub(super) fn land() -> Vec<Vec<(f64, f64)>> {
    let corner = |text: &str| {
        let (longitude, latitude) = text.split_once(' ')?;
        Some((longitude.parse().ok()?, latitude.parse().ok()?))
    };
    LAND.lines().map(|line| line.split(',').filter_map(corner).collect()).collect()
}

/// Returns the outline without the seams at which the polygons are cut: the 180th meridian and the
/// south pole.
pub(super) fn shore() -> Vec<Vec<(f64, f64)>> {
    let is_seam = |(x0, y0): (f64, f64), (x1, y1): (f64, f64)| {
        let along_meridian = x0.abs() > 179.0 && x1.abs() > 179.0;
        let along_pole = y0 < -89.0 && y1 < -89.0;
        along_meridian || along_pole || (x0 - x1).abs() > 180.0
    };
    let rings = land();
    let runs = rings.iter().flat_map(|ring| ring.chunk_by(|a, b| !is_seam(*a, *b)));
    runs.filter(|run| run.len() > 1).map(<[_]>::to_vec).collect()
}

#[cfg(test)]
mod tests {
    use super::land;

    /// Returns true if a point is inside, by the number of lines that a ray to the east crosses.
    fn is_land(longitude: f64, latitude: f64) -> bool {
        let crosses = |pair: &[(f64, f64)]| {
            let [(x0, y0), (x1, y1)] = [pair[0], pair[1]];
            (y0 > latitude) != (y1 > latitude) && longitude < x0 + (latitude - y0) / (y1 - y0) * (x1 - x0)
        };
        let crossings: usize =
            land().iter().map(|ring| ring.windows(2).filter(|pair| crosses(pair)).count()).sum();
        crossings % 2 == 1
    }

    #[test]
    fn towns_are_on_land_and_oceans_are_not() {
        for (longitude, latitude) in
            [(11.6, 48.1), (108.9, 34.3), (-100.0, 40.0), (25.0, 0.0), (134.0, -25.0)]
        {
            assert!(is_land(longitude, latitude), "{longitude} {latitude}");
        }
        for (longitude, latitude) in [(-30.0, 30.0), (-150.0, 0.0), (80.0, -20.0), (-20.0, -30.0)] {
            assert!(!is_land(longitude, latitude), "{longitude} {latitude}");
        }
        assert!(land().iter().all(|ring| ring.len() >= 4 && ring.first() == ring.last()));
    }
}
