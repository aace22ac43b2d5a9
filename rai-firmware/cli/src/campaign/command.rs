//! Command `campaign`: availability and integrity over places, times, skies and methods.

use std::path::{Path, PathBuf};
use std::time::Instant;

use super::page::summary_lines;
use super::picture::cases;
use super::{Campaign, Share, Table, merge, write_report};
use crate::page::html::write_file;
use anyhow::{Context as _, Result, ensure};
use clap::Subcommand;
use indicatif::{ProgressBar, ProgressStyle};

/// Arguments of the command.
#[derive(clap::Args)]
#[command(args_conflicts_with_subcommands = true)]
pub struct Arguments {
    #[command(subcommand)]
    action: Option<Action>,
    /// Specification of the campaign; tests-host/campaigns has examples
    #[arg(value_name = "SPEC.toml")]
    spec: Option<PathBuf>,
    /// Compute only the k-th of n shares; all shares merged are the bytes of a single run
    #[arg(long, value_name = "k/n", value_parser = share)]
    shard: Option<Share>,
    /// Resume an interrupted run
    #[arg(long)]
    resume: bool,
    /// Folder for table, maps, curves and page
    #[arg(long, value_name = "FOLDER", default_value = "target/campaign")]
    out: PathBuf,
    /// Print the value in each box of a map
    #[arg(long)]
    numbers: bool,
}

#[derive(Subcommand)]
enum Action {
    /// Merges the tables of all shares, and draws maps, curves and the page.
    Merge {
        /// CSV files of all shares
        #[arg(required = true)]
        files: Vec<PathBuf>,
        /// Folder for table, maps, curves and page
        #[arg(long, value_name = "FOLDER", default_value = "target/campaign")]
        out: PathBuf,
        /// Print the value in each box of a map
        #[arg(long)]
        numbers: bool,
    },
}

impl Arguments {
    fn load(&self) -> Result<Campaign> {
        let spec = self.spec.as_deref().context(
            "give a specification, such as tests-host/campaigns/lpv200.toml, or `merge` and the tables of all shares",
        )?;
        Campaign::load(spec)
    }
}

/// Runs the command.
///
/// # Errors
/// If the specification or a table is wrong, or if an output cannot be written.
pub fn run(arguments: &Arguments) -> Result<()> {
    if let Some(Action::Merge { files, out, numbers }) = &arguments.action {
        let text = merge(files)?;
        let table = Table::read(&text)?;
        write_file(&out.join(Share::ALL.file_name(&table.identity.name)), &text)?;
        return show(&table, out, *numbers);
    }
    let campaign = arguments.load()?;
    let share = arguments.shard.unwrap_or(Share::ALL);
    let start = Instant::now();
    let path = campaign.work(&arguments.out, share, arguments.resume, progress())?;
    eprintln!("{}: {:.1} s", path.display(), start.elapsed().as_secs_f64());
    if share == Share::ALL { finish(&path, arguments) } else { Ok(()) }
}

fn finish(path: &Path, arguments: &Arguments) -> Result<()> {
    let text = std::fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
    let table = Table::read(&text)?;
    ensure!(table.is_whole(), "{} is incomplete: continue with --resume", path.display());
    show(&table, &arguments.out, arguments.numbers)
}

/// Draws a whole table, and prints a line for each case.
fn show(table: &Table, folder: &Path, numbers: bool) -> Result<()> {
    let page = write_report(table, folder, numbers)?;
    let (columns, lines) = summary_lines(&cases(table), table.identity.noise);
    for line in lines {
        for (column, cell) in columns.iter().zip(line).filter(|(_, cell)| !cell.is_empty()) {
            println!("{column:<28} {cell}");
        }
        println!();
    }
    eprintln!("page: {}", page.display());
    Ok(())
}

fn share(text: &str) -> Result<Share, String> {
    Share::parse(text).map_err(|error| error.to_string())
}

/// Returns a progress bar; without a terminal, as in batch logs, it prints a line every tenth.
fn progress() -> impl FnMut(usize, usize) {
    let bar = ProgressBar::new(1);
    if let Ok(style) = ProgressStyle::with_template("{bar:40} {pos}/{len} cells ({eta} to go)") {
        bar.set_style(style);
    }
    let mut tenth = 0;
    move |done, all| {
        bar.set_length(all as u64);
        bar.set_position(done as u64);
        if bar.is_hidden() && done * 10 / all.max(1) > tenth {
            tenth = done * 10 / all.max(1);
            eprintln!("{done} of {all} cells");
        }
        if done == all {
            bar.finish_and_clear();
        }
    }
}
