//! Text of a journey.

use std::fmt::Write as _;

use super::terminal::Typed;

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

/// Returns the lines that stay on a terminal: the last state of a line that is printed over itself.
fn printed(output: &str) -> Vec<&str> {
    let lines = output.lines().map(|line| line.trim_end_matches('\r'));
    let last = lines.map(|line| line.rsplit('\r').next().unwrap_or_default());
    last.filter(|line| !line.trim().is_empty()).collect()
}

#[cfg(test)]
mod tests {
    use super::printed;

    #[test]
    fn a_line_that_is_printed_over_itself_counts_once() {
        assert_eq!(printed("tests\n10 %\r50 %\r100 %\n\nend\r\n"), ["tests", "100 %", "end"]);
    }
}
