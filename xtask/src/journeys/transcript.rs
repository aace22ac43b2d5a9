//! Text of a journey: whole, and shortened to one page.

use std::fmt::Write as _;

use console::strip_ansi_codes;

use super::people::Person;
use super::terminal::Typed;

/// Last lines of an output that the page shows.
const SHOWN: usize = 8;

/// Columns of a line of output that the page shows.
const COLUMNS: usize = 120;

/// Returns everything that was typed and printed.
pub(super) fn whole(typed: &[Typed]) -> String {
    let mut text = String::new();
    for entered in typed {
        let _ = writeln!(text, "$ {}", entered.line.typed);
        for line in printed(&entered.output) {
            let _ = writeln!(text, "{line}");
        }
        let _ = writeln!(text, "[{}]\n", entered.summary());
    }
    text
}

/// Returns a journey on one page.
pub(super) fn page(person: &Person, typed: &[Typed]) -> String {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let (system, processor) = (std::env::consts::OS, std::env::consts::ARCH);
    let mut text = format!(
        "# {}\n\n{} Types what README says, in a clone of the last commit and in an empty home\n\
         (`cargo xtask journeys {} --record` writes this page). System: {system}, {processor}, {cores} cores.\n\n\
         | typed | duration |\n|---|---|\n",
        person.title, person.aim, person.name
    );
    for entered in typed {
        let _ = writeln!(text, "| `{}` | {} |", entered.line.typed.replace('|', "\\|"), entered.duration());
    }
    text.push_str("\n```text\n");
    for entered in typed {
        shorten(entered, &mut text);
    }
    text + "```\n"
}

/// Adds a line and the end of its output.
fn shorten(entered: &Typed, text: &mut String) {
    let lines = printed(&entered.output);
    let _ = writeln!(text, "$ {}", entered.line.typed);
    if lines.len() > SHOWN {
        let _ = writeln!(text, "… {} lines", lines.len() - SHOWN);
    }
    for line in lines.iter().skip(lines.len().saturating_sub(SHOWN)) {
        let _ = writeln!(text, "{}", line.chars().take(COLUMNS).collect::<String>().trim_end());
    }
    let _ = writeln!(text, "[{}]", entered.summary());
}

/// Returns the lines that stay on a terminal: without colours, and the last state of a line that is
/// printed over itself.
fn printed(output: &str) -> Vec<String> {
    let plain = strip_ansi_codes(output);
    let last = |line: &str| line.trim_end_matches('\r').rsplit('\r').next().unwrap_or_default().to_owned();
    plain.lines().map(last).filter(|line| !line.trim().is_empty()).collect()
}

#[cfg(test)]
mod tests {
    use super::printed;

    #[test]
    fn a_line_that_is_printed_over_itself_counts_once() {
        let output = "\u{1b}[1mtests\u{1b}[0m\n10 %\r50 %\r100 %\n\nend\r\n";
        assert_eq!(printed(output), ["tests", "100 %", "end"]);
    }
}
