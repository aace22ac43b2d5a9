//! Changelog of the Debian package (Debian policy 4.4), from `CHANGELOG.md`: the newest version that
//! has a number, whose earlier ones are in `CHANGELOG.md` beside it.

use anyhow::{Context as _, Result, ensure};
use raim::signal::calendar::readable_unix;

/// Longest line.
const WIDTH: usize = 78;

/// Names of days, beginning with that of 1970-01-01.
const DAYS: [&str; 7] = ["Thu", "Fri", "Sat", "Sun", "Mon", "Tue", "Wed"];

const MONTHS: [&str; 12] =
    ["Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"];

/// Returns the changelog of a package of this version, by this maintainer, at this time.
///
/// # Errors
/// If the newest version in `CHANGELOG.md` is another one.
pub(super) fn debian(changes: &str, version: &str, maintainer: &str, time_s: u64) -> Result<String> {
    let mut versions = changes.split("\n## [").skip(1).filter(|of| !of.starts_with("Unreleased]"));
    let newest = versions.next().context("CHANGELOG.md lists no version")?;
    ensure!(newest.starts_with(&format!("{version}]")), "CHANGELOG.md does not begin with {version}");
    let text: String = blocks(newest)
        .iter()
        .map(|block| match block.strip_prefix("- ") {
            Some(change) => wrapped(change, "  * ", "    "),
            None => format!("\n  [ {} ]\n\n", block.trim_start_matches("### ").trim_end_matches(':')),
        })
        .collect();
    let head = format!("raim ({version}) unstable; urgency=medium\n");
    Ok(format!("{head}{text}\n -- {maintainer}  {}\n", date(time_s)))
}

/// Returns the headings and changes of a version, each on one line. Remarks that are neither are
/// left out.
fn blocks(version: &str) -> Vec<String> {
    let mut blocks: Vec<String> = Vec::new();
    for line in version.lines().skip(1) {
        let is_start = line.starts_with("- ") || line.starts_with("### ") || line.ends_with(':');
        match blocks.last_mut() {
            Some(block) if line.starts_with("  ") => {
                block.push(' ');
                block.push_str(line.trim());
            }
            _ if is_start && !line.starts_with("  ") => blocks.push(line.to_owned()),
            _ => {}
        }
    }
    blocks
        .iter()
        .map(|block| {
            ["**", "<sub>", "</sub>"].iter().fold(block.clone(), |text, mark| text.replace(mark, ""))
        })
        .collect()
}

/// Returns a text in lines of at most [`WIDTH`] characters, with these beginnings.
fn wrapped(text: &str, first: &str, rest: &str) -> String {
    let (mut lines, mut line) = (String::new(), first.to_owned());
    let mut is_empty = true;
    for word in text.split_whitespace() {
        if !is_empty && line.chars().count() + 1 + word.chars().count() > WIDTH {
            lines.push_str(&line);
            lines.push('\n');
            (line, is_empty) = (rest.to_owned(), true);
        }
        if !is_empty {
            line.push(' ');
        }
        line += word;
        is_empty = false;
    }
    format!("{lines}{line}\n")
}

/// Returns a time as RFC 5322 writes it, in UTC.
fn date(time_s: u64) -> String {
    let day = DAYS.get((time_s / 86_400 % 7) as usize).copied().unwrap_or_default();
    let readable = readable_unix(time_s.cast_signed() * 1000);
    let parts: Vec<_> = readable.split(['-', ' ']).collect();
    let [year, month, date, time] = parts[..] else { return readable };
    let month = month.parse().ok().and_then(|month: usize| MONTHS.get(month.wrapping_sub(1)));
    format!("{day}, {date} {} {year} {time} +0000", month.copied().unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use std::process::Command;

    use super::*;

    const CHANGES: &str = "# Changelog\n\n## [Unreleased]\n\n- Later.\n\n## [0.2.0] - unreleased\n\nA remark.\n\n### Added\n\n- One change with \
        **Breaking:** and\n  a second line that is so long that the two of them do not fit.\n\nIntegrity:\n\n- P<sub>fa</sub>.\n\n\
        ## [0.1.0] - 2026-11-21\n\n- Old.\n";

    #[test]
    fn changes_of_the_newest_version_are_wrapped() {
        let have = debian(CHANGES, "0.2.0", "A. Builder <b@example.org>", 0).unwrap();
        let want = "raim (0.2.0) unstable; urgency=medium\n\n  [ Added ]\n\n  * One change with Breaking: and a \
            second line that is so long that the two\n    of them do not fit.\n\n  [ Integrity ]\n\n  * Pfa.\n\n \
            -- A. Builder <b@example.org>  Thu, 01 Jan 1970 00:00:00 +0000\n";
        assert_eq!(have, want);
        assert!(debian(CHANGES, "0.3.0", "", 0).is_err());
    }

    #[test]
    fn dates_are_those_of_the_program_date() {
        for time_s in [0, 951_782_400, 1_700_000_000, 1_795_652_253, 4_102_444_799] {
            let output = Command::new("date")
                .args(["--utc", "--rfc-email", &format!("--date=@{time_s}")])
                .env("LC_ALL", "C")
                .output();
            let Ok(output) = output else {
                rig::skip::say("the program date");
                return;
            };
            assert_eq!(date(time_s), String::from_utf8_lossy(&output.stdout).trim());
        }
    }
}
