//! Cases of a table: one sky, mask, error model, fault and judge over all places.

use super::map::{Panel, Scale, Tile};
use super::table::{Row, Table};

/// Rows of one case, in the order of the places.
#[derive(Clone, Debug)]
pub struct Case<'t> {
    /// Method and sky, with everything that distinguishes the case from the others.
    pub title: String,
    /// One row per place.
    pub rows: Vec<&'t Row>,
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
    let titled = |(key, rows): ([String; 7], _)| {
        let words = key.iter().zip(PARTS).zip(&differs);
        let said = words.filter(|((word, part), differs)| *word != "-" && (*part == "method" || **differs));
        let said = said
            .map(|((word, part), _)| if part == "mask_deg" { format!("mask {word}°") } else { word.clone() });
        Case { title: said.collect::<Vec<_>>().join(", "), rows }
    };
    cases.into_iter().map(titled).collect()
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
