//! The commands of developers that need the emulated boards, the images or the C interface.
//! `cargo xtask` builds and calls this program.

mod bench;
mod flash;
mod image;
mod replay;

use std::process::ExitCode;

use anyhow::Result;
use clap::{Parser, Subcommand};
use rig::image::Named;

#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Replays a recording through the module, on the host or on the emulated board.
    Replay(Box<raim::replay::command::Arguments>),
    /// Shows the state of a module on a serial port.
    Monitor(raim::monitor::command::Arguments),
    /// Measures the cost of the module on the chip: instructions by stage, flash, RAM, stack.
    Bench(bench::Arguments),
    /// Proves by the linker that no panic is reachable.
    Prove(Prove),
    /// Builds named images, and compares their memory with their limits.
    Image(image::Arguments),
    /// Writes an image to a chip, or checks that it fits.
    Flash(flash::Arguments),
    /// Fetches real recordings that packages carry.
    Recordings,
}

#[derive(clap::Args)]
struct Prove {
    /// Only in this named image
    #[arg(long, value_name = "NAME")]
    image: Option<String>,
}

fn main() -> ExitCode {
    let Arguments { command } = raim::exit::arguments();
    raim::exit::code_of(|| dispatch(command))
}

fn dispatch(command: Command) -> Result<()> {
    match command {
        Command::Replay(arguments) => replay::run(&arguments),
        Command::Monitor(arguments) => raim::monitor::command::run(&arguments, Some(&rig::watched)),
        Command::Bench(arguments) => bench::run(&arguments),
        Command::Prove(Prove { image: Some(name) }) if name == rig::no_panic::INTERFACE => {
            rig::no_panic::prove_interface()
        }
        Command::Prove(Prove { image: Some(name) }) => rig::no_panic::prove_image(Named::of(&name)?),
        Command::Prove(Prove { image: None }) => rig::no_panic::prove(),
        Command::Image(arguments) => image::run(&arguments),
        Command::Flash(arguments) => flash::run(&arguments),
        Command::Recordings => rig::recordings::fetch(),
    }
}
