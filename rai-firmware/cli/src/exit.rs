//! Exit code of a command, and its error on standard error.

use std::process::ExitCode;

use clap::Parser;
use clap::error::ErrorKind;

/// Returns the arguments of this process. If they are wrong, it ends the process after one line
/// about them; if help was requested, after the help.
pub fn arguments<A: Parser>() -> A {
    A::try_parse().unwrap_or_else(|error| std::process::exit(refuse(&error)))
}

/// Prints the help or the error, and returns the exit code.
fn refuse(error: &clap::Error) -> i32 {
    let is_help = error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand;
    if is_help || !error.use_stderr() {
        // If standard output is closed, there is nobody left to inform.
        let _ = error.print();
        return i32::from(is_help);
    }
    // The error stands before the first blank line; usage and hints follow.
    let text = error.to_string();
    let lines = text.lines().map(str::trim).take_while(|line| !line.is_empty());
    eprintln!("{}", lines.collect::<Vec<_>>().join(" "));
    1
}

/// Runs a command, prints its error, and returns the exit code. A closed output, as by `head`, is
/// the reader's choice and no error.
pub fn code_of(command: impl FnOnce() -> anyhow::Result<()> + std::panic::UnwindSafe) -> ExitCode {
    quiet_where_nobody_reads();
    match std::panic::catch_unwind(command) {
        Ok(Ok(())) => ExitCode::SUCCESS,
        Ok(Err(error)) if is_closed_pipe(&error) => ExitCode::SUCCESS,
        Ok(Err(error)) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
        Err(panic) if says_closed_pipe(panic.as_ref()) => ExitCode::SUCCESS,
        Err(panic) => std::panic::resume_unwind(panic),
    }
}

/// Suppresses the panic message if the reader of our output has closed it, as `head` does.
fn quiet_where_nobody_reads() {
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        if !says_closed_pipe(panic.payload()) {
            usual(panic);
        }
    }));
}

/// Returns true for the panic of `println!` on a closed pipe, which is its only way to report one.
fn says_closed_pipe(panic: &(dyn std::any::Any + Send)) -> bool {
    panic
        .downcast_ref::<String>()
        .is_some_and(|words| words.starts_with("failed printing to stdout") && words.contains("Broken pipe"))
}

fn is_closed_pipe(error: &anyhow::Error) -> bool {
    let is_pipe = |error: &std::io::Error| error.kind() == std::io::ErrorKind::BrokenPipe;
    error.chain().any(|cause| cause.downcast_ref().is_some_and(is_pipe))
}
