//! `cargo xtask soak`: hours on the emulated board under faults, resets and a bad line.

use std::path::PathBuf;
use std::time::Instant;

use adversary::soak::{self, Outcome, Plan, page::page, table::table};
use anyhow::ensure;
use indicatif::{ProgressBar, ProgressStyle};
use rig::image;

/// Arguments of the command.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Board time, h, from 0.0167 to 24, for a simulated sky and for the recording `esbc` in
    /// parallel
    #[arg(long, default_value_t = 1.0, value_parser = hours)]
    hours: f64,
    /// Seed of all random choices
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Folder for the page
    #[arg(long, value_name = "FOLDER", default_value = "target/soak")]
    report: PathBuf,
}

/// Parses hours from a minute to the length of the recording.
fn hours(text: &str) -> Result<f64, String> {
    let hours = text.parse().ok().filter(|hours| (1.0 / 60.0..=24.0).contains(hours));
    hours.ok_or_else(|| "hours must be within 0.0167 (a minute) to 24".to_owned())
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let image = image::build()?;
    let mut plans = vec![Plan::sky(arguments.hours, arguments.seed)];
    plans.extend(Plan::recording(arguments.hours, arguments.seed));
    let bar = progress(&plans);
    let epochs_of: Vec<u64> = plans.iter().map(|plan| u64::from(plan.epochs)).collect();
    let start = Instant::now();
    // Both take the same time on the board; the bar shows the slower one.
    let slowest = std::sync::Mutex::new(vec![0.0; plans.len()]);
    let outcomes = soak::run_all(&image, plans, |plan, epochs| {
        if let Ok(mut shares) = slowest.lock() {
            shares[plan] = epochs as f64 / epochs_of[plan] as f64;
            bar.set_position((shares.iter().copied().fold(1.0, f64::min) * 1000.0) as u64);
        }
    })?;
    bar.finish_and_clear();
    print!("{}", table(&outcomes));
    println!("seed {}, in {:.0} s", arguments.seed, start.elapsed().as_secs_f64());
    let index = arguments.report.join("index.html");
    page(&outcomes)?.write(&index)?;
    eprintln!("report: {}", index.display());
    let broken: Vec<String> = outcomes.iter().flat_map(Outcome::broken).collect();
    ensure!(broken.is_empty(), "counts that must be zero are not:\n{}", broken.join("\n"));
    Ok(())
}

/// Returns a progress bar in thousandths of the whole.
fn progress(plans: &[Plan]) -> ProgressBar {
    let style = ProgressStyle::with_template("{prefix} {bar:40} {percent:>3} % ({eta} to go)");
    let names: Vec<&str> = plans.iter().map(|plan| plan.name).collect();
    let bar = ProgressBar::new(1000).with_prefix(names.join(", "));
    match style {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}
