//! Manual pages of `rai`: one for the command and one for each of its commands.
//!
//! They are generated from the description of the command line that prints `--help`, so that they
//! cannot differ from it.

use anyhow::Result;
use clap_mangen::Man;

use super::VERSION;

/// Files and pages that the page of the command names.
const FILES: &str = ".SH FILES
.TP
/etc/rai.toml
settings of the service: the receiver, the consumers, the pin
.TP
/usr/lib/systemd/system/rai.service
the service; `systemctl enable --now rai` starts it
.TP
/usr/share/doc/raim/INTERFACES.md
messages in, sentences out, commands
";

/// Returns the name of each page and its text, with a date such as `2026-11-26`.
///
/// # Errors
/// If a page cannot be rendered.
pub(super) fn pages(date: &str) -> Result<Vec<(String, String)>> {
    let mut rai = raim::command_line::description().disable_help_subcommand(true);
    rai.build();
    let first = page(&rai, date).map(|(name, text)| (name, text + FILES));
    let others = rai.get_subcommands().map(|command| {
        let (name, text) = page(command, date)?;
        Ok((name, text + ".SH SEE ALSO\nrai(1)\n"))
    });
    std::iter::once(first).chain(others).collect()
}

fn page(command: &clap::Command, date: &str) -> Result<(String, String)> {
    let man = Man::new(command.clone()).date(date).source(format!("rai {VERSION}")).manual("RAI");
    let mut text = Vec::new();
    man.render(&mut text)?;
    Ok((man.get_filename(), String::from_utf8(text)?))
}

#[cfg(test)]
mod tests {
    use std::io::Write as _;
    use std::process::{Command, Stdio};

    use super::*;

    /// Returns a page as `man` prints it, without the breaks of lines; `None` without `man`.
    fn printed(page: &str) -> Option<String> {
        let mut man = Command::new("man");
        man.args(["--warnings=w", "--local-file", "-"]).env("MANWIDTH", "1000").env("LC_ALL", "C.UTF-8");
        man.env("MAN_KEEP_FORMATTING", "")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        let mut child = man.spawn().ok()?;
        child.stdin.take().unwrap().write_all(page.as_bytes()).unwrap();
        let output = child.wait_with_output().unwrap();
        assert!(output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
        Some(one_line(&String::from_utf8(output.stdout).unwrap()))
    }

    fn one_line(text: &str) -> String {
        text.replace('\u{2010}', "-").split_whitespace().collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn the_command_and_each_of_its_commands_have_a_page() {
        let pages = pages("2026-11-26").unwrap();
        let names: Vec<_> = pages.iter().map(|(name, _)| name.as_str()).collect();
        let commands = ["configure", "run", "replay", "monitor", "evaluate", "campaign"];
        let want = commands.map(|command| format!("rai-{command}.1"));
        assert_eq!(names[0], "rai.1");
        assert_eq!(names[1..], want);
        assert!(pages[0].1.contains("rai\\-run(1)") && !pages[0].1.contains("rai\\-help"), "{}", pages[0].1);
    }

    /// The help is what the program prints; the page is what `man` prints.
    #[test]
    fn a_page_has_every_option_and_every_sentence_of_the_help() {
        let mut rai = raim::command_line::description().disable_help_subcommand(true);
        rai.build();
        for ((name, page), command) in pages("").unwrap()[1..].iter().zip(rai.get_subcommands()) {
            let Some(printed) = printed(page) else {
                rig::skip::say("the program man");
                return;
            };
            let mut command = command.clone().term_width(1000);
            let help = command.render_long_help().to_string();
            // Usage and headings are arranged in another way.
            let body = help.lines().skip_while(|line| *line != "Options:" && *line != "Arguments:");
            let mut lines = 0;
            for line in body.filter(|line| line.starts_with("  ")) {
                // Values and defaults stand elsewhere than in the help.
                let sentence = line.split(['[', '<']).next().unwrap_or_default().trim().trim_end_matches(':');
                let is_list = ["Possible values", "- "].iter().any(|start| sentence.starts_with(start));
                if !is_list {
                    assert!(printed.contains(&one_line(sentence)), "{name} lacks `{sentence}`: {printed}");
                    lines += 1;
                }
            }
            assert!(lines > 3, "{name}: {help}");
        }
    }
}
