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

use anyhow::{Result, ensure};
use raim::in_order::Together as _;

use self::run::{Course, course};
use self::scenes::SCENES;
use self::signals::Skies;
use super::module::is_small;
use super::victim::NoOpportunity;
use super::{Attack, Effort, Figure};

pub use self::table::{Row, markdown, summary};

/// Attack on a sky that is signed.
pub(super) const ATTACK: Attack = Attack {
    name: "sky",
    about: "a signed sky, jammed, then forged, relayed, pulled off, poisoned, or signed by another key",
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

/// Runs the attacks with these means; the first row is the genuine sky.
///
/// # Errors
/// If a module cannot be run.
pub fn rows(means: &[Means]) -> Result<Vec<Row>> {
    let skies = Skies::new()?;
    let jobs: Vec<(usize, Means)> =
        means.iter().flat_map(|means| (0..SCENES.len()).map(|scene| (scene, *means))).collect();
    let courses: Vec<Course> = jobs
        .iter()
        .together(|&(scene, means)| course(&skies, &SCENES[scene], means))
        .collect::<Result<_>>()?;
    let of_means: Vec<&[Course]> = courses.chunks(SCENES.len()).collect();
    let row = |(index, scene): (usize, &scenes::Scene)| Row {
        name: scene.name,
        short: scene.short,
        cells: of_means.iter().map(|courses| courses[index].beside(&courses[0])).collect(),
    };
    Ok(SCENES.iter().enumerate().map(row).collect())
}

fn figures(effort: Effort) -> Result<Vec<Figure>> {
    if is_small() {
        return Err(NoOpportunity("it reads neither UBX nor signed data").into());
    }
    let rows = rows(effort.pick(&MEANS[4..], &MEANS[..]))?;
    let Some((genuine, attacks)) = rows.split_first() else { return Ok(Vec::new()) };
    ensure!(genuine.cells.iter().all(|cell| cell.promised > 0), "nothing is promised of the genuine sky");
    let mut figures = vec![Figure::at_most(
        "beyond, genuine",
        genuine.cells.iter().map(|cell| cell.beyond).sum::<usize>() as f64,
        0.0,
    )];
    for Row { short, cells, .. } in attacks {
        let Some(all) = cells.last() else { continue };
        figures
            .push(Figure::plain(format!("{short}: seen after, s"), all.seen_s.map_or(f64::NAN, f64::from)));
        figures.push(Figure::plain("beyond", all.beyond as f64));
    }
    Ok(figures)
}
