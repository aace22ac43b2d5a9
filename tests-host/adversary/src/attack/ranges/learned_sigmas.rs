//! Sigmas that have learned from quiet minutes and are then used for ranges these minutes do not
//! describe.
//!
//! Residuals show how large the errors of these ranges were. They show nothing about the parameters
//! of an integrity support message, other ranges or other systems. There a level must not fall
//! below that of sigmas without learning.

use crate::attack::prelude::*;

pub(super) const ATTACK: Attack = Attack {
    name: "learned-sigmas",
    about: "ten quiet minutes of NOISE,AUTO, then levels of ARAIM, of one frequency, of one system: those of the measured noise, or of the integrity parameters",
    branch: Branch::Sigmas,
    before: "HPL 59 to 76 % of that without",
    note: "",
    run,
};

/// Commands at start, and the command after the quiet minutes.
const CASES: [([&str; 2], &str); 4] = [
    (["METHOD,SEPARATION", "FREQ,DUAL"], "METHOD,SEPARATION"),
    (["METHOD,AUTO", "FREQ,DUAL"], "METHOD,SEPARATION"),
    (["METHOD,AUTO", "FREQ,DUAL"], "FREQ,SINGLE"),
    (["METHOD,AUTO", "FREQ,DUAL"], "SYSTEMS,G"),
];

/// Quiet epochs, and epochs after the change, which are too few to learn from.
const QUIET: u32 = 650;
const AFTER: u32 = 10;

/// Difference of two levels that rounding of the last digit can cause, %.
const ROUNDING: f64 = 1.0;

fn run(effort: Effort) -> Result<Vec<Figure>> {
    let seeds = effort.pick(1, 8);
    let of_case = |(at_start, then): ([&str; 2], &str)| -> Result<[f64; 2]> {
        let shares = (0..seeds).together(|seed| shares(&at_start, then, seed));
        let least = |a: [f64; 2], b: [f64; 2]| [a[0].min(b[0]), a[1].min(b[1])];
        Ok(shares.collect::<Result<Vec<_>>>()?.into_iter().fold([f64::INFINITY; 2], least))
    };
    let mut figures = Vec::new();
    for (at_start, then) in CASES {
        let [before, after] = of_case((at_start, then))?;
        let method = at_start[0];
        if method == "METHOD,AUTO" {
            figures.push(Figure::at_most(format!("% of HPL by {method}, {then} to come"), before, 90.0));
        }
        let quantity = format!("least % of HPL by {then} after {method}");
        figures.push(Figure::at_least(quantity, after, 100.0 - ROUNDING));
    }
    Ok(figures)
}

/// Returns the smallest level of a learning module in percent of the level of one that does not
/// learn, before and after the change.
fn shares(at_start: &[&str], then: &str, seed: u64) -> Result<[f64; 2]> {
    let sky = Sky::quiet(QUIET + AFTER, seed)?;
    let mut learns = Victim::new(at_start, 1.0)?;
    let mut fixed = Victim::new(at_start, 1.0)?;
    learns.obey("NOISE,AUTO")?;
    fixed.obey("NOISE,GEODETIC")?;
    let mut least = [f64::INFINITY; 2];
    for (index, bytes) in (0..).zip(&sky.unchanged()?) {
        if index == QUIET {
            learns.obey(then)?;
            fixed.obey(then)?;
        }
        let level_m = |victim: &mut Victim| -> Result<Option<f64>> {
            Ok(victim.receive(bytes, sky.truth)?.last().and_then(|seen| seen.reported.state.hpl_m))
        };
        let share = level_m(&mut learns)?.zip(level_m(&mut fixed)?).map(|(have_m, want_m)| have_m / want_m);
        let [before, after] = &mut least;
        let least = if index < QUIET { before } else { after };
        *least = share.map_or(*least, |share| least.min(100.0 * share));
    }
    Ok(least)
}
