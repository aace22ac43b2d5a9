//! Levels and availability of LPV-200 by the number of constellations, over a grid and a day, from
//! geometry alone.

use std::path::Path;

use anyhow::Result;
use raim::campaign::picture::{cases, mean_over_globe};
use raim::campaign::spec::Spec;
use raim::campaign::{Campaign, Share, Table};

use super::{Effort, Finding, Judgement, Row, Section};

/// Integrity support messages, and their descriptions.
const PROMISES: [(&str, &str); 2] = [
    ("RESEARCH", "URA 1 m, b 0.75 m"),
    ("ICAO", "URA 2.4 m of GPS, 6 m of Galileo and BeiDou, 9 m of GLONASS"),
];

/// Returns the section.
pub(super) fn section(effort: Effort) -> Result<Section> {
    let mut rows = Vec::new();
    for (promise, words) in PROMISES {
        let table = table(effort, promise)?;
        for case in cases(&table) {
            let mean = |column: &str| mean_over_globe(&case, |row| row.number(column));
            let name = case.title.trim_start_matches("SEPARATION, ");
            rows.push(
                Row::new(
                    format!("{promise}, {name}: availability / %"),
                    "",
                    Finding::exact(100.0 * mean("availability"), 2),
                    Judgement::Ours,
                )
                .because(format!(
                    "{words}; median HPL {:.2} m, VPL {:.2} m, 99th percentile {:.1} m",
                    mean("hpl_median_m"),
                    mean("vpl_median_m"),
                    mean("vpl_99_m")
                )),
            );
        }
    }
    Ok(Section {
        title: "LPV-200 over the globe and a day by the number of constellations, mean by area".into(),
        rows,
    })
}

fn table(effort: Effort, promise: &str) -> Result<Table> {
    let (grid_deg, step_s) = effort.pick((30, 10_800), (10, 1800));
    let count = 86_400 / step_s;
    let skies = [
        ("GPS", "\"gps24\""),
        ("GPS + Galileo", "\"gps24\", \"galileo24\""),
        ("GPS + Galileo + BeiDou", "\"gps24\", \"galileo24\", \"bds24\""),
        ("all four", "\"gps24\", \"galileo24\", \"bds24\", \"glonass24\""),
    ]
    .map(|(name, fleets)| format!("[[skies]]\nname = \"{name}\"\nfleets = [{fleets}]\n"))
    .concat();
    let text = format!(
        "name = \"araim\"\nmasks_deg = [5]\n[places]\ngrid_deg = {grid_deg}\n[times]\nstep_s = {step_s}\ncount = \
         {count}\n{skies}[[errors]]\nname = \"airborne\"\nuser = \"airborne\"\n[judgement]\nset = [\"PHASE,LPV200\", \
         \"ISM,{promise}\"]\nmethods = [\"SEPARATION\"]\n"
    );
    let campaign = Campaign::of(Spec::parse(&text)?, Path::new("."))?;
    Table::read(&campaign.text(Share::ALL))
}
