//! Documents of the project, compared with what the code and its tests compute.
//!
//! A document tells a figure in one of two ways. A *passage* is part of its prose or of a table
//! that a person wrote; the test that knows the figure calls [`must_say`]. A *block* lies between
//! `<!-- generated: NAME -->` and `<!-- end -->`; the test that knows it calls [`must_have`], which
//! writes the block if the environment variable `RAI_BLESS` is set.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

use anyhow::Context as _;

/// Mark behind a generated block.
const END: &str = "<!-- end -->";

fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(name)
}

/// Returns the version of the sources, as git describes it, for what is recorded.
///
/// # Errors
/// If git does not describe it.
pub fn version() -> anyhow::Result<String> {
    let git = ["describe", "--always", "--dirty", "--abbrev=12"];
    let output = Command::new("git").args(git).current_dir(path("")).output();
    let output = output.ok().filter(|output| output.status.success());
    let output = output.context("git must describe the version that is recorded")?;
    Ok(String::from_utf8_lossy(&output.stdout).trim().to_owned())
}

/// Returns a document of the project, by its path from the root.
pub fn text(name: &str) -> String {
    fs::read_to_string(path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Joins the words of a text by one space each, so that line breaks do not matter.
pub fn joined(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Fails if a document lacks a passage.
pub fn must_say(name: &str, passage: &str) {
    let passage = joined(passage);
    assert!(joined(&text(name)).contains(&passage), "{name} must say: {passage}");
}

/// Fails if a generated block of a document differs from `want`, or writes it there.
pub fn must_have(name: &str, block: &str, want: &str) {
    let document = text(name);
    let mark = mark(block);
    let parts = document.split_once(&mark).and_then(|(before, rest)| Some((before, rest.split_once(END)?)));
    let (before, (have, after)) = parts.unwrap_or_else(|| panic!("{name} has no block `{mark}` … `{END}`"));
    if have == want {
        return;
    }
    if env::var_os("RAI_BLESS").is_some() {
        let renewed = [before, &mark, want, END, after].concat();
        return fs::write(path(name), renewed).unwrap_or_else(|error| panic!("{name}: {error}"));
    }
    let (have, want) = first_difference(have, want);
    panic!("{name}, block {block}, must say (RAI_BLESS=1 writes it): {want}\ninstead of: {have}");
}

fn mark(block: &str) -> String {
    format!("<!-- generated: {block} -->\n")
}

/// Returns the first lines that differ.
fn first_difference<'t>(have: &'t str, want: &'t str) -> (&'t str, &'t str) {
    let count = have.lines().zip(want.lines()).take_while(|(have, want)| have == want).count();
    let at = |text: &'t str| text.lines().nth(count).unwrap_or("nothing");
    (at(have), at(want))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_different_line_is_found_even_if_one_text_is_shorter() {
        assert_eq!(first_difference("a\nb\n", "a\nc\n"), ("b", "c"));
        assert_eq!(first_difference("a\n", "a\nc\n"), ("nothing", "c"));
    }

    #[test]
    #[should_panic(expected = "README.md must say: no such words, on two lines")]
    fn passage_that_is_not_there_is_named() {
        must_say("README.md", "no such words,\n  on two lines");
    }
}
