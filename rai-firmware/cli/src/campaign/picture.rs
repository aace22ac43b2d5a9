//! Cases of a table: one sky, mask, error model, fault and judge over all places.

use super::map::{Panel, Scale, Tile};
use super::table::{Row, Table};

/// Rows of one case, in the order of the places.
#[derive(Clone, Debug)]
pub struct Case<'t> {
    /// Method and sky, with everything that distinguishes the case from the others.
    pub title: String,
    /// Faults whose effect its levels bound.
    pub promise: Promise,
    /// One row per place.
    pub rows: Vec<&'t Row>,
}

/// Faults whose effect the levels of a method bound. Levels of different promises do not compare: a
/// level that bounds less is smaller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Promise {
    /// Several satellites at once and whole systems, by the integrity support message.
    Several,
    /// One satellite, together with the noise.
    One,
    /// One satellite, without the noise.
    OneWithoutNoise,
}

impl Promise {
    fn of(row: &Row) -> Self {
        match (row.text("method"), row.text("levels")) {
            ("SEPARATION" | "ARAIM", _) => Self::Several,
            (_, "SLOPE") => Self::OneWithoutNoise,
            _ => Self::One,
        }
    }

    /// Returns the promise in words.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Several => "several satellites and whole systems at once",
            Self::One => "one satellite and the noise",
            Self::OneWithoutNoise => "one satellite without the noise",
        }
    }

    /// Returns the promise in as few words as a title of a map has room for.
    const fn short(self) -> &'static str {
        match self {
            Self::Several => "bounds several faults",
            Self::One => "bounds one fault",
            Self::OneWithoutNoise => "bounds one fault, no noise",
        }
    }
}

/// Returns true if the cases make different promises.
pub fn promises_differ(cases: &[Case<'_>]) -> bool {
    cases.windows(2).any(|pair| pair[0].promise != pair[1].promise)
}

/// Columns in which cases differ.
const PARTS: [&str; 7] = ["method", "policy", "levels", "sky", "mask_deg", "errors", "fault"];

/// Returns the cases of a table in the order of their first rows.
pub fn cases(table: &Table) -> Vec<Case<'_>> {
    let key = |row: &Row| PARTS.map(|part| row.text(part).to_owned());
    let mut cases: Vec<([String; 7], Vec<&Row>)> = Vec::new();
    for row in &table.rows {
        let key = key(row);
        match cases.iter_mut().find(|(known, _)| *known == key) {
            Some((_, rows)) => rows.push(row),
            None => cases.push((key, vec![row])),
        }
    }
    let differs: Vec<bool> =
        (0..PARTS.len()).map(|part| cases.iter().any(|(key, _)| key[part] != cases[0].0[part])).collect();
    let title = |key: &[String; 7]| {
        let words = key.iter().zip(PARTS).zip(&differs);
        let reported =
            words.filter(|((word, part), differs)| *word != "-" && (*part == "method" || **differs));
        let reported = reported
            .map(|((word, part), _)| if part == "mask_deg" { format!("mask {word}°") } else { word.clone() });
        reported.collect::<Vec<_>>().join(", ")
    };
    let titled: Vec<_> = cases.iter().map(|(key, _)| title(key)).collect();
    let mut cases: Vec<Case<'_>> = cases
        .into_iter()
        .zip(titled)
        .map(|((_, rows), title)| {
            let promise = rows.first().map_or(Promise::One, |row| Promise::of(row));
            Case { title, promise, rows }
        })
        .collect();
    if promises_differ(&cases) {
        for case in &mut cases {
            case.title = format!("{} ({})", case.title, case.promise.short());
        }
    }
    cases
}

/// Returns the size of the boxes, degrees, if the places are a grid over the globe.
pub fn grid_step_deg(case: &Case<'_>) -> Option<f64> {
    let mut latitudes: Vec<f64> = case.rows.iter().map(|row| row.number("lat_deg")).collect();
    latitudes.sort_by(f64::total_cmp);
    latitudes.dedup();
    let step_deg = 180.0 / latitudes.len() as f64;
    let boxes = latitudes.len() * 2 * latitudes.len();
    let is_even = latitudes.windows(2).all(|pair| (pair[1] - pair[0] - step_deg).abs() < 1e-6);
    (latitudes.len() > 1 && is_even && case.rows.len() == boxes).then_some(step_deg)
}

/// Returns a case as a map of a quantity.
pub fn panel(case: &Case<'_>, column: &str, scale: &Scale) -> Panel {
    let tile = |row: &&Row| Tile {
        latitude_deg: row.number("lat_deg"),
        longitude_deg: row.number("lon_deg"),
        value: row.number(column) * scale.factor.signum(),
    };
    Panel { title: case.title.clone(), tiles: case.rows.iter().map(tile).collect() }
}

/// Returns the share of the globe in which a condition holds, boxes weighted by their area.
pub fn share_of_globe(case: &Case<'_>, holds: impl Fn(&Row) -> bool) -> f64 {
    mean_over_globe(case, |row| if holds(row) { 1.0 } else { 0.0 })
}

/// Returns the mean of a quantity over the globe, boxes weighted by their area.
pub fn mean_over_globe(case: &Case<'_>, quantity: impl Fn(&Row) -> f64) -> f64 {
    let weight = |row: &Row| row.number("lat_deg").to_radians().cos();
    let total: f64 = case.rows.iter().map(|row| weight(row)).sum();
    case.rows.iter().map(|row| weight(row) * quantity(row)).sum::<f64>() / total
}
