//! `cargo xtask attack`: all attacks that try to raise the pin on a wrong position, with their
//! results.

use std::time::Instant;

use adversary::attack::ranges::{several_faults, several_record};
use adversary::attack::record::{Entry, Record};
use adversary::attack::{Attack, Effort, Outcome, attacks};
use anyhow::{Context as _, ensure};

/// Arguments of the command.
#[derive(clap::Args)]
#[allow(clippy::struct_excessive_bools, reason = "each is another thing to do")]
pub(crate) struct Arguments {
    /// Names of the attacks to run (default: all)
    attacks: Vec<String>,
    /// Run many more epochs and geometries
    #[arg(long)]
    long: bool,
    /// Record the figures, with the version, in `tests-host/adversary/records`, with which the
    /// documents are compared
    #[arg(long)]
    record: bool,
    /// Print one JSON object per attack
    #[arg(long)]
    json: bool,
    /// Print rows of a Markdown table
    #[arg(long, conflicts_with = "json")]
    markdown: bool,
    /// Attack the module with the parts of the image `small`, and print what it withstands
    #[arg(long, conflicts_with_all = ["json", "markdown", "several"])]
    small: bool,
    /// Print only the rate at which two to four faults pass undetected, from this many epochs of
    /// each kind
    #[arg(long, value_name = "EPOCHS")]
    several: Option<u64>,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let attacks = chosen(&arguments.attacks)?;
    if let Some(epochs) = arguments.several {
        return several(epochs, arguments.record);
    }
    let effort = if arguments.long { Effort::Long } else { Effort::Quick };
    if arguments.small {
        return crate::attack_small::run(&attacks, effort, arguments.record);
    }
    let mut lost = Vec::new();
    let mut outcomes = Vec::new();
    for attack in &attacks {
        let start = Instant::now();
        let outcome = attack.attempt(effort).with_context(|| format!("attack {}", attack.name))?;
        let word = if outcome.is_held() { "held" } else { "NOT HELD" };
        if arguments.json {
            println!("{}", serde_json::to_string(&outcome)?);
        } else if arguments.markdown {
            println!("| `{}` | {} | {word} | {} |", outcome.name, outcome.about, outcome.words());
        } else {
            println!("{word:<8}  {:<18} {}\n          {}", outcome.name, outcome.about, outcome.words());
        }
        eprintln!("          {:.1} s", start.elapsed().as_secs_f64());
        if !outcome.is_held() {
            lost.push(outcome.name);
        }
        outcomes.push(outcome);
    }
    if arguments.record {
        record(&outcomes, effort)?;
    }
    ensure!(
        lost.is_empty(),
        "the module failed {} of {} attacks: {}",
        lost.len(),
        attacks.len(),
        lost.join(", ")
    );
    Ok(())
}

fn chosen(names: &[String]) -> anyhow::Result<Vec<&'static Attack>> {
    if names.is_empty() || names.iter().any(|name| name == "all") {
        return Ok(attacks());
    }
    names.iter().map(|name| named(name)).collect()
}

fn named(name: &str) -> anyhow::Result<&'static Attack> {
    let known = || attacks().iter().map(|attack| attack.name).collect::<Vec<_>>().join(", ");
    let found = attacks().into_iter().find(|attack| attack.name == name);
    found.with_context(|| format!("`{name}` is not an attack; the attacks are {}, or all", known()))
}

/// Measures how often several faults pass, and prints or also records the table.
fn several(epochs: u64, is_recorded: bool) -> anyhow::Result<()> {
    let cells = several_faults::table(epochs)?;
    print!("{}", several_record::markdown(&cells));
    if is_recorded {
        eprintln!("recorded: {}", several_record::write(&cells, &rig::document::version()?)?.display());
    }
    Ok(())
}

/// Replaces the entries of these attacks in the record.
fn record(outcomes: &[Outcome], effort: Effort) -> anyhow::Result<()> {
    let (mut record, version) = (Record::committed()?, rig::document::version()?);
    for outcome in outcomes {
        record.put(Entry::of(outcome, effort, &version));
    }
    eprintln!("recorded: {}", record.write()?.display());
    Ok(())
}
