//! The command `rai`.

use std::process::ExitCode;

fn main() -> ExitCode {
    raim::exit::code_of(raim::command_line::dispatch)
}
