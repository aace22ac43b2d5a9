//! `cargo xtask reproduce evidence`: requirements, fault tree, configuration and open points on one
//! page, with the figures of this run.

use std::path::Path;

use adversary::attack::{Effort as Form, attacks as all};
use anyhow::{Context as _, ensure};
use evidence::configuration;
use evidence::document::Evidence;
use experiments::{EXPERIMENTS, Effort};

use crate::progress::progress;

/// Name on the command line.
pub(crate) const NAME: &str = "evidence";

/// Runs the command.
pub(crate) fn run(quick: bool, report: &Path) -> anyhow::Result<()> {
    let effort = if quick { Effort::Quick } else { Effort::Full };
    let fde = EXPERIMENTS.iter().find(|experiment| experiment.name == "fde").context("the experiment fde")?;
    let bar = progress(fde.name);
    let rates = (fde.run)(effort, &bar)?;
    bar.finish_and_clear();
    let bar = progress("attacks");
    bar.set_length(all().len() as u64);
    let mut attacks = Vec::new();
    for attack in all() {
        bar.set_message(attack.name);
        let outcome = attack.attempt(Form::Quick);
        attacks.push(outcome.with_context(|| format!("attack {}", attack.name))?);
        bar.inc(1);
    }
    bar.finish_and_clear();
    let image = rig::image::build()?;
    let evidence = Evidence { configuration: configuration::index(Some(&image))?, fde: rates, attacks };
    println!("{}", evidence.text());
    let page = report.join("evidence.html");
    evidence.page().write(&page)?;
    eprintln!("page: {}", page.display());
    ensure!(evidence.is_held(), "a rate is out of its bounds, or an attack was not held; see above");
    Ok(())
}
