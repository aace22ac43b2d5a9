//! Plain English in comments and documents: no line breaks two rules of CONTRIBUTING.md.
//!
//! 1. No first line of a doc comment, and no line of a document in the root, begins with a relative
//!    clause that has no noun (`What is left`, `Whether it passed`, `Of these, the largest`).
//! 2. No comment line is wider than 100 columns. Tables, fenced code and unbreakable words may be.
//!
//! The test prints every offender, by package.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

/// Words that begin a relative clause.
const RELATIVE: [&str; 19] = [
    "As",
    "By",
    "From",
    "How",
    "Of",
    "That",
    "What",
    "Whatever",
    "When",
    "Where",
    "Wherever",
    "Whether",
    "Which",
    "Whichever",
    "Who",
    "Whoever",
    "Whom",
    "Whose",
    "Why",
];

/// Columns that a comment line may fill, its indentation included.
const WIDTH: usize = 100;

/// One line that breaks a rule.
struct Offender {
    /// Path from the root, and line from 1.
    place: String,
    /// The line without its indentation.
    text: String,
}

/// Offenders of one package, by rule.
#[derive(Default)]
struct Found {
    relative: Vec<Offender>,
    wide: Vec<Offender>,
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize().expect("a workspace")
}

/// Collects the sources below a folder, without build products.
fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder that can be read").flatten() {
        let (path, name) = (entry.path(), entry.file_name());
        if path.is_dir() {
            if name != "target" && name != ".git" {
                sources(&path, found);
            }
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// Returns the folder of the package that holds a source, as a path from the root.
fn package(root: &Path, source: &Path) -> String {
    let folder = source.ancestors().skip(1).find(|folder| folder.join("Cargo.toml").exists());
    let folder = folder.expect("a package above every source");
    folder.strip_prefix(root).expect("a folder below the root").display().to_string()
}

/// Returns true for a line whose first word is one of [`RELATIVE`].
fn opens_relative(text: &str) -> bool {
    let word = text.trim_start().split(|letter: char| !letter.is_alphanumeric()).next();
    word.is_some_and(|word| RELATIVE.contains(&word))
}

/// Splits a comment line into its mark and its text; `None` for code.
fn comment(line: &str) -> Option<(&str, &str)> {
    let line = line.trim_start();
    let mark = ["////", "///", "//!", "//"].into_iter().find(|mark| line.starts_with(mark))?;
    (mark != "////").then(|| line.split_at(mark.len()))
}

/// Returns true for text that a wrap could break: at least two words, and no row of a table.
fn can_wrap(text: &str) -> bool {
    !text.trim_start().starts_with('|') && text.split_whitespace().nth(1).is_some()
}

/// Adds the offenders of one source.
fn examine_source(name: &str, source: &str, found: &mut Found) {
    let (mut before, mut fenced) = ("", false);
    for (number, line) in (1..).zip(source.lines()) {
        let Some((mark, text)) = comment(line) else {
            (before, fenced) = ("", false);
            continue;
        };
        let offender = || Offender { place: format!("{name}:{number}"), text: line.trim().to_owned() };
        if mark != "//" && mark != before && opens_relative(text) {
            found.relative.push(offender());
        }
        fenced ^= text.trim_start().starts_with("```");
        if !fenced && line.chars().count() > WIDTH && can_wrap(text) {
            found.wide.push(offender());
        }
        before = mark;
    }
}

/// Adds the offenders of one document: lines of prose and of lists, headings and code aside.
fn examine_document(name: &str, document: &str, found: &mut Found) {
    let mut fenced = false;
    for (number, line) in (1..).zip(document.lines()) {
        fenced ^= line.trim_start().starts_with("```");
        let prose = line.trim_start().trim_start_matches(['-', '*', ' ']);
        if !fenced && opens_relative(prose) {
            let place = format!("{name}:{number}");
            found.relative.push(Offender { place, text: line.trim().to_owned() });
        }
    }
}

/// Returns the offenders of every package, and those of the documents in the root as `documents`.
fn offenders() -> BTreeMap<String, Found> {
    let (root, mut paths) = (root(), Vec::new());
    sources(&root, &mut paths);
    paths.sort();
    let mut all = BTreeMap::<String, Found>::new();
    for path in &paths {
        let name = path.strip_prefix(&root).expect("a source below the root").display().to_string();
        let text = fs::read_to_string(path).expect("text");
        examine_source(&name, &text, all.entry(package(&root, path)).or_default());
    }
    let documents = fs::read_dir(&root).expect("a folder that can be read").flatten();
    let mut documents: Vec<_> = documents.map(|entry| entry.path()).collect();
    documents.retain(|path| path.extension().is_some_and(|extension| extension == "md"));
    documents.sort();
    for path in &documents {
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        let text = fs::read_to_string(path).expect("text");
        examine_document(&name, &text, all.entry("documents".to_owned()).or_default());
    }
    all
}

/// Returns a heading and one line for each offender; nothing without one.
fn complaint(package: &str, rule: &str, have: &[Offender]) -> String {
    let mut text = String::new();
    if !have.is_empty() {
        writeln!(text, "{package}: have {} {rule}, want 0", have.len()).expect("memory");
        for Offender { place, text: line } in have {
            writeln!(text, "  {place}: {line}").expect("memory");
        }
    }
    text
}

#[test]
fn doc_lines_open_with_a_noun_or_a_verb_and_comments_fit_100_columns() {
    let mut complaints = String::new();
    for (package, found) in offenders() {
        complaints += &complaint(&package, "relative openings", &found.relative);
        complaints += &complaint(&package, "wide comments", &found.wide);
    }
    assert!(complaints.is_empty(), "\n{complaints}");
}

#[test]
fn offenders_are_counted_with_their_lines() {
    let wide = format!("/// {}", "word ".repeat(20));
    let code = format!("/// ```text\n{wide}\n/// ```\n");
    let source = format!(
        "//! Whether it passed.\n//! That is allowed.\n/// Of these, one.\n// What no doc comment says.\n\
         let what = 1;\n/// Whatsoever.\n{wide}\n/// | {wide} |\n/// {}\n{code}",
        "x".repeat(100)
    );
    let mut found = Found::default();
    examine_source("a.rs", &source, &mut found);
    let places = |offenders: &[Offender]| -> Vec<_> {
        offenders.iter().map(|offender| offender.place.clone()).collect()
    };
    assert_eq!(places(&found.relative), ["a.rs:1", "a.rs:3"]);
    assert_eq!(places(&found.wide), ["a.rs:7"]);

    let mut found = Found::default();
    let document = "# What it does\n\n- Who reads this\nwhere it is\n```\nWhich\n```\nWhere it was\n";
    examine_document("b.md", document, &mut found);
    assert_eq!(places(&found.relative), ["b.md:3", "b.md:8"]);
}
