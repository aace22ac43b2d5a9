//! Counterfeit signals of one system beside genuine ones of another: two groups of satellites, each
//! of which agrees on its own place.
//!
//! ```text
//! GPS      eight satellites as an antenna 400 km away receives them
//! Galileo  two to six satellites as the antenna receives them
//! ```
//!
//! The counterfeit group has more satellites, and its residuals vanish once the genuine group is
//! left out. Without a third system nothing tells which group is genuine, so that no position may
//! be promised, whatever the sizes of the groups. A single genuine satellite would contradict
//! nothing, so that all of them are well above the elevation mask.

use crate::attack::prelude::*;

pub(super) const ATTACK: Attack = Attack {
    name: "two-truths",
    about: "eight counterfeit GPS satellites agree on a place 400 km away, two to six genuine Galileo satellites on the true one, SEPARATION and AUTO",
    branch: Branch::Counterfeit,
    before: "`SEPARATION` promised there with three and more, up to 85 % of the epochs",
    note: "",
    run,
};

/// Number of counterfeit satellites.
const COUNTERFEIT: usize = 8;

/// Numbers of genuine satellites.
const GENUINE: std::ops::RangeInclusive<usize> = 2..=6;

/// Distance to the north, degrees: 400 km.
const NORTH_DEG: f64 = 3.6;

/// Least elevation of a genuine satellite, rad: 15°, above the mask of the module.
const GENUINE_RAD: f64 = 0.26;

/// Epochs of a run.
const EPOCHS: u32 = 20;

fn run(effort: Effort) -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    for method in ["ARAIM", "AUTO"] {
        for genuine in GENUINE {
            let runs = (0..effort.pick(6, 60)).together(|seed| attempt(method, genuine, seed));
            let all: Tally = runs.collect::<Result<_>>()?;
            figures.push(Figure::plain(format!("{method}, {genuine} genuine: epochs"), all.epochs()));
            figures.push(Figure::at_most("promised", all.promised(), 0.0));
            figures.push(Figure::plain("AMBIGUOUS", all.of_reason("AMBIGUOUS") as f64));
        }
    }
    Ok(figures)
}

/// Sends the two groups to a module with this method.
fn attempt(method: &str, genuine: usize, seed: u64) -> Result<Tally> {
    let start_s = 600.0 + 3600.0 * (seed % 24) as f64;
    let simulation =
        Simulation { satellites: satellites(GPS_GALILEO.1), ..Simulation::above_xian(start_s, EPOCHS, seed) };
    let away = elsewhere(&simulation, NORTH_DEG).record();
    let sky = Sky::with(&simulation, "GE", Frequency::Dual)?;
    let mut counterfeit = of_system(&away.epochs[0], Constellation::Gps);
    counterfeit.truncate(COUNTERFEIT);
    let sights = simulation.sights_at(0);
    let is_high = |id: &SatelliteId| {
        sights.iter().any(|sight| sight.satellite == *id && sight.elevation_rad() > GENUINE_RAD)
    };
    let mut kept = of_system(&sky.recording.epochs[0], Constellation::Galileo);
    kept.retain(is_high);
    kept.truncate(genuine);
    if kept.len() < genuine {
        return Ok(Tally::default());
    }
    let bytes = sky.bytes(|index, epoch| {
        epoch.satellites.retain(|raw| kept.contains(&raw.satellite));
        let forged = away.epochs[index].satellites.iter();
        epoch.satellites.extend(forged.filter(|raw| counterfeit.contains(&raw.satellite)).cloned());
    })?;
    Victim::new(&[&format!("METHOD,{method}")], 1.0)?.judge(&bytes, sky.truth)
}
