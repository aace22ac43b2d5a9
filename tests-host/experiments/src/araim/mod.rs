//! ARAIM: the published example, a published run, levels by the number of constellations, and the
//! measured risk.
//!
//! | content | module |
//! |---|---|
//! | skies with their integrity parameters, and dense least squares of any part of one | [`scene`] |
//! | the worked example of the working group, every intermediate | [`example`] |
//! | a published run of MAAST | [`maast`] |
//! | levels and availability of LPV-200 by the number of constellations | [`constellations`] |
//! | probability of a promised position beyond its level, by importance sampling | [`risk`] |
//! | false alarms, by importance sampling | [`alarms`] |
//!
//! References: [Blanch2015], [MAAST].
//!
//! [Blanch2015]: raim_core#references
//! [MAAST]: raim_core#references

mod alarms;
mod constellations;
mod example;
mod maast;
mod risk;
mod scene;

use anyhow::Result;
use indicatif::ProgressBar;

use super::{Effort, Experiment, Finding, Interval, Judgement, Outcome, Row, Section};

/// Entry for the command line.
pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "araim",
    about: "solution separation: the published example and run, levels by constellations, the risk measured",
    run,
};

fn run(effort: Effort, bar: &ProgressBar) -> Result<Outcome> {
    bar.set_length(5);
    let mut sections = vec![example::section()?];
    bar.inc(1);
    sections.push(maast::section()?);
    bar.inc(1);
    sections.push(constellations::section(effort)?);
    bar.inc(1);
    sections.push(alarms::section(effort)?);
    bar.inc(1);
    sections.extend(risk::sections(effort)?);
    bar.inc(1);
    Ok(Outcome {
        name: EXPERIMENT.name,
        title: "ARAIM: multiple-hypothesis solution separation".into(),
        setup: "The example is that of the working group's algorithm description 3.1, appendix D, in f64; MAAST's run has 24 \
                satellites seen from 60 S 150 W. Skies: GPS of 24 slots, Galileo, BeiDou and GLONASS of 24 medium orbits each, \
                mask 5 deg, ED-259A noise. Risk and alarms are measured of the core in f32 with Gaussian noise of just the \
                sigmas that it is told. Seeds are fixed."
            .into(),
        sections,
        pictures: vec![],
    })
}
