//! A sky whose Galileo satellites sign their navigation data, genuine, then jammed, then attacked.
//!
//! ```text
//! genuine 4 min ─► jammed 1 min ─► attack 5 min        GPS and Galileo, two frequencies, UBX, 1 Hz
//! ```
//!
//! Each attack ([`scenes`]) meets five modules ([`Means`]): one with nothing but its ranges, one with the
//! key, one that was told the time, one whose receiver reports Doppler frequencies, and one with all of
//! it. A module has seen an attack in the first second in which it says something else than under the
//! genuine sky ([`run`]). What is not seen is said as well ([`table`]).

mod run;
mod scenes;
mod signals;
mod table;

use anyhow::ensure;

use self::run::{Course, course};
use self::scenes::SCENES;
use self::signals::Skies;
use super::module::is_small;
use super::victim::NoOpportunity;
use crate::attack::prelude::*;

pub use self::table::{Cell, Row, markdown, summary};

pub(super) const ATTACK: Attack = Attack {
    name: "sky",
    about: "a signed sky, jammed, then forged, relayed, pulled off, poisoned, or signed by another key",
    branch: Branch::Counterfeit,
    before: "not tried",
    note: "quick with `KEY`, `TRUST` and Doppler, at length also without: [the table](#a-signed-sky)",
    run: figures,
};

/// What a module has beside its ranges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Means {
    /// Name in the table.
    pub name: &'static str,
    has_key: bool,
    has_time: bool,
    has_rates: bool,
}

/// All that are compared; the last has everything.
pub const MEANS: [Means; 5] = [
    Means { name: "ranges alone", has_key: false, has_time: false, has_rates: false },
    Means { name: "`KEY`", has_key: true, has_time: false, has_rates: false },
    Means { name: "`TRUST`", has_key: false, has_time: true, has_rates: false },
    Means { name: "Doppler", has_key: false, has_time: false, has_rates: true },
    Means { name: "all", has_key: true, has_time: true, has_rates: true },
];

/// Runs the attacks with these means.
///
/// # Errors
/// If a module cannot be run, or does not promise the genuine sky.
pub fn rows(means: &[Means]) -> Result<Vec<Row>> {
    let skies = Skies::new()?;
    let jobs: Vec<(usize, Means)> =
        means.iter().flat_map(|means| (0..SCENES.len()).map(|scene| (scene, *means))).collect();
    let courses: Vec<Course> = jobs
        .iter()
        .together(|&(scene, means)| course(&skies, &SCENES[scene], means))
        .collect::<Result<_>>()?;
    let of_means: Vec<&[Course]> = courses.chunks(SCENES.len()).collect();
    let row = |(index, scene): (usize, &scenes::Scene)| {
        let start = |scene: &scenes::Scene| (scene.is_cold, scene.is_sudden);
        let is_basis = |basis: &scenes::Scene| basis.is_genuine() && start(basis) == start(scene);
        let basis = SCENES.iter().position(is_basis).unwrap_or_default();
        let cell = |courses: &&[Course]| courses[index].beside(&courses[basis]);
        let cells: Vec<Cell> = of_means.iter().map(cell).collect();
        ensure!(
            !scene.is_genuine() || cells.iter().all(|cell| cell.promised > 0 && cell.beyond == 0),
            "the genuine sky is not promised, or beyond a level: {cells:?}"
        );
        Ok(Row { name: scene.name, short: scene.short, cells })
    };
    let rows: Vec<Row> = SCENES.iter().enumerate().map(row).collect::<Result<_>>()?;
    Ok(rows.into_iter().zip(&SCENES).filter(|(_, scene)| !scene.is_genuine()).map(|(row, _)| row).collect())
}

fn figures(effort: Effort) -> Result<Vec<Figure>> {
    if is_small() {
        return Err(NoOpportunity("it reads neither UBX nor signed data").into());
    }
    let mut figures = Vec::new();
    for Row { short, cells, .. } in rows(effort.pick(&MEANS[4..], &MEANS[..]))? {
        let Some(all) = cells.last() else { continue };
        // A relay and a slow walk are not seen; another signer is, when a key of the chain is due.
        let most = match short {
            "relayed at once" | "relayed 5 s late" | "all ranges pulled off at 0.5 m/s" => f64::INFINITY,
            "all forged, signed by another key" => 90.0,
            _ => 0.0,
        };
        figures.push(Figure::plain(format!("{short}: promised"), all.promised as f64));
        figures.push(Figure::at_most("beyond", all.beyond as f64, most));
    }
    Ok(figures)
}
