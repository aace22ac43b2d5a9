//! What documents and comments point to is there: files move, and whoever follows a path finds out last.

use std::fs;
use std::path::{Path, PathBuf};

/// Endings of files that are ours to name.
const NAMED: [&str; 3] = [".rs", ".md", ".toml"];

/// What ends so and is no file of ours: a file that a command takes.
const OTHERS: [&str; 1] = ["SPEC.toml"];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// All files below a folder, but for what is built and what tools keep.
fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder that can be read").flatten() {
        let name = entry.file_name();
        if entry.path().is_file() {
            found.push(entry.path());
        } else if name != "target" && name != ".git" {
            files(&entry.path(), found);
        }
    }
}

fn all_files() -> Vec<PathBuf> {
    let mut found = Vec::new();
    files(&root(), &mut found);
    found
}

fn ends_in(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|extension| extension == ending)
}

/// Where the links of a document lead, without what is on the web and the place within the file.
fn links(text: &str) -> impl Iterator<Item = &str> {
    let targets = text.split("](").skip(1).filter_map(|rest| rest.split([')', '#']).next());
    targets.filter(|target| !target.is_empty() && !target.contains("://"))
}

/// Names of files in code type.
fn quoted_files(text: &str) -> impl Iterator<Item = &str> {
    let quoted = text.lines().flat_map(|line| line.split('`').skip(1).step_by(2));
    quoted.filter(|words| {
        NAMED.iter().any(|ending| words.ends_with(ending) && words.len() > ending.len())
            && words.chars().all(|letter| letter.is_ascii_alphanumeric() || "/_-.".contains(letter))
            && !OTHERS.contains(words)
    })
}

/// The comments of a source, which are where it may name another.
fn comments(source: &str) -> String {
    let lines = source.lines().filter_map(|line| line.split_once("//").map(|(_, comment)| comment));
    lines.collect::<Vec<_>>().join("\n")
}

#[test]
fn links_of_documents_lead_to_files() {
    let mut count = 0;
    for document in all_files().iter().filter(|path| ends_in(path, "md")) {
        let text = fs::read_to_string(document).expect("text");
        for target in links(&text) {
            let place = document.parent().expect("a folder").join(target);
            assert!(place.exists(), "{}: {target} is not there", document.display());
            count += 1;
        }
    }
    assert!(count > 20, "{count}");
}

#[test]
fn files_that_documents_and_comments_name_are_there() {
    let all = all_files();
    let mut count = 0;
    for file in &all {
        let text = match file.extension().and_then(|extension| extension.to_str()) {
            Some("md") => fs::read_to_string(file).expect("text"),
            Some("rs") => comments(&fs::read_to_string(file).expect("text")),
            _ => continue,
        };
        for name in quoted_files(&text) {
            // By whole names of folders.
            assert!(all.iter().any(|path| path.ends_with(name)), "{}: {name} is not there", file.display());
            count += 1;
        }
    }
    assert!(count > 100, "{count}");
}
