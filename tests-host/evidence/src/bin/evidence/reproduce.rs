//! `cargo xtask reproduce`: the papers' tables and figures beside ours.

use std::path::PathBuf;
use std::time::Instant;

use anyhow::{Context as _, ensure};
use experiments::{EXPERIMENTS, Effort, Experiment, Outcome, page, record};
use raim::page::html::write_file;

use crate::progress::progress;

/// Arguments of the command.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Names of the experiments to run (default: all), or `evidence` for the page of requirements,
    /// faults and configuration
    experiments: Vec<String>,
    /// Run a reduced version of everything, in two minutes
    #[arg(long)]
    quick: bool,
    /// Record the outcomes in full, with the version, in `tests-host/experiments/records`, with
    /// which the documents are compared
    #[arg(long, conflicts_with = "quick")]
    record: bool,
    /// Print one JSON object per experiment instead of tables
    #[arg(long)]
    json: bool,
    /// Folder for the page and its pictures
    #[arg(long, value_name = "FOLDER", default_value = "target/reproduce")]
    report: PathBuf,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    if arguments.experiments.iter().any(|name| name == crate::page::NAME) {
        ensure!(arguments.experiments.len() == 1, "`{}` runs alone", crate::page::NAME);
        return crate::page::run(arguments.quick, &arguments.report);
    }
    let experiments = chosen(&arguments.experiments)?;
    let effort = if arguments.quick { Effort::Quick } else { Effort::Full };
    let mut outcomes = Vec::new();
    for experiment in experiments {
        let start = Instant::now();
        let bar = progress(experiment.name);
        let outcome = (experiment.run)(effort, &bar)?;
        bar.finish_and_clear();
        eprintln!("{}: {:.1} s", experiment.name, start.elapsed().as_secs_f64());
        if arguments.json {
            println!("{}", outcome.json());
        } else {
            println!("{outcome}");
        }
        if arguments.record {
            let path = record::write(&outcome, &rig::document::version()?)?;
            eprintln!("recorded: {}", path.display());
        }
        outcomes.push(outcome);
    }
    write(&outcomes, arguments)?;
    let failures: Vec<_> = outcomes.iter().flat_map(Outcome::failures).collect();
    for row in &failures {
        eprintln!("out of bounds: {} is {}", row.quantity, row.ours.text());
    }
    ensure!(failures.is_empty(), "{} values are not within their bounds", failures.len());
    Ok(())
}

fn write(outcomes: &[Outcome], arguments: &Arguments) -> anyhow::Result<()> {
    for picture in outcomes.iter().flat_map(|outcome| &outcome.pictures) {
        write_file(&arguments.report.join(&picture.name).with_extension("svg"), &picture.sheet)?;
    }
    let index = arguments.report.join("index.html");
    page(outcomes).write(&index)?;
    eprintln!("report: {}", index.display());
    Ok(())
}

fn chosen(names: &[String]) -> anyhow::Result<Vec<Experiment>> {
    if names.is_empty() || names.iter().any(|name| name == "all") {
        return Ok(EXPERIMENTS.to_vec());
    }
    names.iter().map(|name| named(name)).collect()
}

fn named(name: &str) -> anyhow::Result<Experiment> {
    let known = || EXPERIMENTS.iter().map(|experiment| experiment.name).collect::<Vec<_>>().join(", ");
    let found = EXPERIMENTS.iter().find(|experiment| experiment.name == name).copied();
    found.with_context(|| {
        format!("`{name}` is not an experiment; the experiments are {}, evidence, or all", known())
    })
}
