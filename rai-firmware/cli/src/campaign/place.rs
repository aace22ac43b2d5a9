//! Places of a campaign: points, a track, a grid over the globe.

use std::path::Path;

use anyhow::{Context as _, Result, ensure};

use super::spec::PlacesSpec;
use crate::signal::sky::Site;

/// A place, with its instant if it is part of a track.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// Name in tables.
    pub name: String,
    /// Geodetic latitude, degrees.
    pub latitude_deg: f64,
    /// Longitude, degrees.
    pub longitude_deg: f64,
    /// Height above the ellipsoid, m.
    pub height_m: f64,
    /// The only instant at which the antenna is there, s; `None` for every instant.
    pub time_s: Option<f64>,
}

impl Place {
    /// Returns the site of the antenna.
    pub fn site(&self) -> Site {
        Site::geodetic(self.latitude_deg, self.longitude_deg, self.height_m)
    }
}

/// Returns all places. Files are relative to the specification.
///
/// # Errors
/// If a track cannot be read; the error names the line and the expected form.
pub fn all(spec: &PlacesSpec, folder: &Path) -> Result<Vec<Place>> {
    if let Some(step_deg) = spec.grid_deg {
        return Ok(grid(step_deg, spec.height_m));
    }
    if let Some(file) = &spec.track {
        let path = folder.join(file);
        let text =
            std::fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))?;
        return track(&text).with_context(|| path.display().to_string());
    }
    let points = spec.points.iter().flatten();
    let place = |point: &super::spec::PointSpec| Place {
        name: point.name.clone(),
        latitude_deg: point.lat_deg,
        longitude_deg: point.lon_deg,
        height_m: point.height_m,
        time_s: None,
    };
    Ok(points.map(place).collect())
}

/// Returns the centres of boxes of this size, from south to north and from west to east.
fn grid(step_deg: f64, height_m: f64) -> Vec<Place> {
    let (rows, columns) = ((180.0 / step_deg).round() as u32, (360.0 / step_deg).round() as u32);
    let place = |row: u32, column: u32| {
        let latitude_deg = -90.0 + step_deg * (f64::from(row) + 0.5);
        let longitude_deg = -180.0 + step_deg * (f64::from(column) + 0.5);
        let name = format!("{latitude_deg:+} {longitude_deg:+}");
        Place { name, latitude_deg, longitude_deg, height_m, time_s: None }
    };
    (0..rows).flat_map(|row| (0..columns).map(move |column| place(row, column))).collect()
}

/// Reads lines `time_s,lat_deg,lon_deg,height_m` below a heading of these names.
fn track(text: &str) -> Result<Vec<Place>> {
    const HEADING: &str = "time_s,lat_deg,lon_deg,height_m";
    let mut lines = text.lines().enumerate();
    let heading = lines.next().map(|(_, line)| line.trim());
    ensure!(heading == Some(HEADING), "the first line must be {HEADING}");
    let mut places = Vec::new();
    for (index, line) in lines.filter(|(_, line)| !line.trim().is_empty()) {
        let numbers: Vec<f64> = line.split(',').filter_map(|field| field.trim().parse().ok()).collect();
        let ranges = [0.0..=1e9, -90.0..=90.0, -360.0..=360.0, -1e3..=2e5];
        let is_sound = numbers.len() == 4
            && line.split(',').count() == 4
            && numbers.iter().zip(ranges).all(|(number, range)| range.contains(number));
        ensure!(is_sound, "line {}: `{line}` is not {HEADING} with numbers of a place", index + 1);
        places.push(Place {
            name: format!("{} s", numbers[0]),
            latitude_deg: numbers[1],
            longitude_deg: numbers[2],
            height_m: numbers[3],
            time_s: Some(numbers[0]),
        });
    }
    ensure!(!places.is_empty(), "there must be at least one place below the heading");
    Ok(places)
}

#[cfg(test)]
mod tests {
    use super::{grid, track};

    #[test]
    fn a_grid_covers_the_globe_once() {
        let places = grid(10.0, 0.0);
        assert_eq!(places.len(), 18 * 36);
        assert_eq!((places[0].latitude_deg, places[0].longitude_deg), (-85.0, -175.0));
        // Boxes weighted by the cosine of their latitude add up to the sphere.
        let share: f64 = places.iter().map(|place| place.latitude_deg.to_radians().cos()).sum();
        assert!((share / (2.0 / 10f64.to_radians().powi(2) * std::f64::consts::TAU) - 1.0).abs() < 2e-3);
    }

    #[test]
    fn a_track_says_which_line_is_wrong() {
        let good = "time_s,lat_deg,lon_deg,height_m\n0,48,11,500\n10, 48.1, 11, 600\n";
        assert_eq!(track(good).unwrap()[1].time_s, Some(10.0));
        for (text, want) in [
            ("", "the first line"),
            ("time_s,lat_deg,lon_deg,height_m\n", "at least one place"),
            ("time_s,lat_deg,lon_deg,height_m\n0,48,11\n", "line 2"),
            ("time_s,lat_deg,lon_deg,height_m\n0,48,11,5\n0,98,11,5\n", "line 3"),
            ("time_s,lat_deg,lon_deg,height_m\n0,nan,11,5\n", "line 2"),
        ] {
            let have = track(text).unwrap_err().to_string();
            assert!(have.contains(want), "have {have}, want {want}");
        }
    }
}
