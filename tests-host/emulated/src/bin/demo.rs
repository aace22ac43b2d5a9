//! `cargo xtask demo`: one satellite drifts off while the emulated board is watched.

use std::path::Path;
use std::process::ExitCode;

use anyhow::Context;
use clap::Parser;
use emulated::demo::{Live, Plan, View};
use emulated::image;
use raim::page::canvas::Ground;
use raim::page::html::write_file;
use raim::signal::fault;

/// Folder of the report.
const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../target/rai-demo");

#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
enum Command {
    /// Shows the module at work: a simulated sky, a drifting satellite, the emulated board.
    Demo(Arguments),
}

/// Arguments of the command.
#[derive(clap::Args)]
struct Arguments {
    /// Satellite that drifts off
    #[arg(long, default_value = "G15")]
    sat: String,
    /// Final error of its range, m; not zero
    #[arg(long, default_value_t = -200.0, allow_negative_numbers = true)]
    bias: f64,
    /// Print plain lines, even on a terminal
    #[arg(long)]
    headless: bool,
}

fn main() -> ExitCode {
    let Command::Demo(arguments) = raim::exit::arguments();
    raim::exit::code_of(|| run(&arguments))
}

fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let satellite = fault::satellite(&arguments.sat)
        .with_context(|| format!("--sat {} is not a satellite; write a name such as G15", arguments.sat))?;
    let plan = Plan { satellite, bias_m: arguments.bias, seed: 1 };
    plan.simulation().with_context(|| format!("--sat {}", arguments.sat))?;
    println!("building the image for the STM32F405");
    let image = image::build()?;
    println!(
        "streaming two minutes of GPS and BeiDou to the emulated board; {satellite} drifts off to {:+} m from 40 s to 90 s",
        plan.bias_m
    );
    let terminal = console::Term::stdout();
    let is_block = terminal.is_term() && !arguments.headless;
    let view = if is_block { View::Block(usize::from(terminal.size().1)) } else { View::Lines };
    let mut live = Live::new(plan, view, std::io::stdout().lock());
    let mut shown = Ok(());
    let story = plan.run(&image, |moments| {
        if shown.is_ok() {
            shown = live.show(moments);
        }
    })?;
    drop(live);
    shown.context("the terminal cannot be written")?;
    let folder = Path::new(FOLDER);
    story.page()?.write(&folder.join("report.html"))?;
    write_file(&folder.join("picture.svg"), &story.picture(Ground::Sheet)?)?;
    println!("\n{story}");
    println!("report: {}", folder.canonicalize()?.join("report.html").display());
    Ok(())
}
