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

/// Returns the page of all journeys.
pub(super) fn page(outcomes: &[(&Person, Vec<Typed>)]) -> String {
    let mut text = String::from(
        "# Five journeys\n\n\
         `cargo xtask journeys --record` prints this page. Each of five people types what README says, in a clone of the\n\
         last commit and in an empty home. The toolchain is there, because rustup brings it. Crates are fetched anew and\n\
         everything is compiled anew.",
    );
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let system = format!("{} on {}, {cores} cores", std::env::consts::OS, std::env::consts::ARCH);
    let _ = writeln!(text, " System: {system}. Version: {}.", env!("CARGO_PKG_VERSION"));
    for (person, typed) in outcomes {
        let _ = writeln!(text, "\n## {}\n\n{}\n", person.title, person.aim);
        text.push_str("| typed | duration |\n|---|---|\n");
        for entered in typed {
            let _ =
                writeln!(text, "| `{}` | {} |", entered.line.typed.replace('|', "\\|"), entered.duration());
        }
        text.push_str("\n```text\n");
        for entered in typed {
            shorten(entered, &mut text);
        }
        text.push_str("```\n");
    }
    text
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
