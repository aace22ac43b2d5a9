//! `cargo xtask tables`: regenerates the threshold tables and the geoid table, or checks the
//! committed ones.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, ensure};
use oracle::geoid::{self, Egm96, Errors};
use oracle::tables;
use oracle::vectors;

/// Arguments of the command.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Write nothing; fail if the committed table differs from its generator, or either from the
    /// gold values
    #[arg(long)]
    pub(crate) check: bool,
    /// Regenerate or check the geoid table too, from this grid of EGM96
    #[arg(long, value_name = "WW15MGH.DAC")]
    pub(crate) geoid: Option<PathBuf>,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let path = tables::committed_path();
    if arguments.check {
        let committed = std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
        tables::check_committed(&committed)?;
        println!("committed table: identical to its generator, byte for byte");
    } else {
        std::fs::write(&path, tables::render()).with_context(|| path.display().to_string())?;
        println!("wrote {}", path.display());
    }
    if let Some(grid) = &arguments.geoid {
        geoid_table(grid, arguments.check)?;
    }
    compare_with_gold()
}

/// Writes or checks the geoid table and its sample, and measures the committed table.
fn geoid_table(grid: &Path, is_check: bool) -> anyhow::Result<()> {
    let source = Egm96::read(grid)?;
    let files =
        [(geoid::committed_path(), source.render_table()), (geoid::sample_path(), source.render_sample())];
    for (path, text) in files {
        if is_check {
            let committed = std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
            ensure!(committed == text, "{} differs from its generator", path.display());
            println!("{}: identical to its generator, byte for byte", path.display());
        } else {
            std::fs::write(&path, text).with_context(|| path.display().to_string())?;
            println!("wrote {}", path.display());
        }
    }
    let corners_m = source.corners_m();
    let Errors { rms_m, most_m, largest_m } = source
        .errors(|latitude_deg, longitude_deg| geoid::interpolated_m(&corners_m, latitude_deg, longitude_deg));
    println!("geoid: error {rms_m:.2} m rms, {most_m:.2} m over 95 % of the Earth, {largest_m:.2} m at most");
    Ok(())
}

fn compare_with_gold() -> anyhow::Result<()> {
    let comparison = tables::compare_with_gold(&vectors::path("gold"), &tables::computed())?;
    let worst = comparison.worst_relative;
    println!("gold values: {} compared, worst relative error {worst:.1e}", comparison.values);
    ensure!(worst <= tables::TOLERANCE, "worst relative error {worst:.1e} exceeds {:.0e}", tables::TOLERANCE);
    Ok(())
}
