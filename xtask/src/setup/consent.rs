//! Consent: no command changes the toolchain or the system before its user has said yes.

use std::io::{BufRead, IsTerminal, Write, stderr, stdin};
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::{bail, ensure};

static YES: AtomicBool = AtomicBool::new(false);

/// Variable by which the programs of the commands learn that every question is answered with yes.
pub(crate) const VARIABLE: &str = "RAI_YES";

/// Takes every question of this process as answered with yes: `--yes` on the command line.
pub fn assume_yes() {
    YES.store(true, Ordering::Relaxed);
}

/// Returns true if every question is answered with yes, on the command line or because nobody is
/// there to ask: continuous integration sets CI.
pub fn is_yes_assumed() -> bool {
    let is = |variable, wanted: &str| std::env::var_os(variable).is_some_and(|value| value == wanted);
    YES.load(Ordering::Relaxed) || is(VARIABLE, "1") || is("CI", "true")
}

/// Announces the commands, and returns once the user has agreed to them.
///
/// # Errors
/// If the user refuses, or if there is no terminal to ask on and neither `--yes` nor `CI` stands
/// for a yes.
pub fn ask(commands: &[String]) -> anyhow::Result<()> {
    let list = commands.join("\n    ");
    eprintln!("The set-up installs what is missing:\n\n    {list}\n");
    if is_yes_assumed() {
        return Ok(());
    }
    if !stdin().is_terminal() {
        bail!("there is no terminal to ask on: type these commands, or add --yes:\n\n    {list}\n");
    }
    eprint!("Run these commands? [y/N] ");
    stderr().flush()?;
    let mut answer = String::new();
    stdin().lock().read_line(&mut answer)?;
    ensure!(
        is_yes(&answer),
        "nothing was installed; type these commands when you want them:\n\n    {list}\n"
    );
    Ok(())
}

fn is_yes(answer: &str) -> bool {
    matches!(answer.trim().to_ascii_lowercase().as_str(), "y" | "yes")
}

#[cfg(test)]
mod tests {
    use super::is_yes;

    #[test]
    fn only_a_yes_is_a_yes() {
        let have = ["y\n", "Yes\n", "", "\n", "n\n", "yesterday\n"].map(is_yes);
        assert_eq!(have, [true, true, false, false, false, false]);
    }
}
