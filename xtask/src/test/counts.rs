//! Numbers of tests passed, failed and skipped, from the log of a step.

use std::fmt;

/// Numbers of tests or steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Counts {
    pub(super) passed: usize,
    pub(super) failed: usize,
    pub(super) skipped: usize,
}

/// Beginning of the line in which the tests' step prints the number of tests skipped for lack of a
/// recording or a program. The runner counts these as passed.
pub(super) const SKIPPED_TESTS: &str = "tests skipped for lack of a recording or a program: ";

/// Beginning of the closing line of nextest.
const OF_NEXTEST: &str = "Summary [";

/// Beginning of the closing lines of cargo's test runner, one for each program.
const OF_CARGO: &str = "test result:";

impl Counts {
    /// Reads the closing lines of cargo's test runner or of nextest.
    ///
    /// Nextest repeats what a failed test printed, and with it a closing line of cargo's runner for
    /// that test alone. Such lines do not count beside one of nextest.
    pub(super) fn in_log(log: &str) -> Self {
        let runner = if log.lines().any(|line| is_closing(line, OF_NEXTEST)) { OF_NEXTEST } else { OF_CARGO };
        let of_runner = log.lines().filter(|line| is_closing(line, runner));
        let mut counts = of_runner.map(of_line).fold(Self::default(), Self::plus);
        let lacking = log.lines().filter_map(|line| line.strip_prefix(SKIPPED_TESTS)?.parse::<usize>().ok());
        let lacking: usize = lacking.sum();
        counts.passed = counts.passed.saturating_sub(lacking);
        counts.skipped += lacking;
        counts
    }

    /// Returns the sum.
    pub(super) fn plus(self, other: Self) -> Self {
        Self {
            passed: self.passed + other.passed,
            failed: self.failed + other.failed,
            skipped: self.skipped + other.skipped,
        }
    }
}

/// Returns true for a closing line of the runner whose line begins thus.
fn is_closing(line: &str, runner: &str) -> bool {
    line.trim_start().starts_with(runner)
}

/// Returns the counts of a closing line: `test result: ok. 3 passed; 0 failed; 1 ignored; …` of
/// cargo, or `Summary [ 3.1s] 4 tests run: 4 passed (1 slow), 2 skipped` of nextest.
fn of_line(line: &str) -> Counts {
    let words: Vec<_> = line.split([' ', ',', ';', ':']).filter(|word| !word.is_empty()).collect();
    let before = |names: &[&str]| -> usize {
        let pairs = words.windows(2).filter(|pair| names.contains(&pair[1]));
        pairs.filter_map(|pair| pair[0].trim_start_matches('(').parse::<usize>().ok()).sum()
    };
    Counts {
        passed: before(&["passed"]),
        failed: before(&["failed", "timed"]),
        // Those that nextest calls skipped are filtered out, and another share of the tests.
        skipped: before(&["ignored"]),
    }
}

impl fmt::Display for Counts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} passed, {} failed, {} skipped", self.passed, self.failed, self.skipped)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closing_lines_of_cargos_runner_are_added_up() {
        // Printed by cargo 1.95.
        let log = "running 3 tests\n\
            test result: FAILED. 2 passed; 1 failed; 1 ignored; 0 measured; 0 filtered out; finished in 0.02s\n\
            test result: ok. 4 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.01s\n\
            tests skipped for lack of a recording or a program: 3\n";
        assert_eq!(Counts::in_log(log), Counts { passed: 3, failed: 1, skipped: 4 });
    }

    #[test]
    fn failed_test_counts_once_with_nextest() {
        // Printed by nextest 0.9.143.
        let log = "\x20   running 1 test\n\
            \x20   test result: FAILED. 0 passed; 1 failed; 0 ignored; 0 measured; 49 filtered out; finished in 2.36s\n\
            \x20    Summary [   3.117s] 6/9 tests run: 5 passed (1 slow), 1 failed, 2 skipped\n\
            tests skipped for lack of a recording or a program: 3\n";
        assert_eq!(Counts::in_log(log), Counts { passed: 2, failed: 1, skipped: 3 });
    }

    #[test]
    fn closing_line_is_the_one_that_other_tools_read() {
        let counts = Counts { passed: 14, failed: 0, skipped: 1 };
        assert_eq!(counts.to_string(), "14 passed, 0 failed, 1 skipped");
    }
}
