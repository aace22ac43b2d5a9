//! Files named in documents and comments exist, and the documents explain every name of the
//! interface.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Endings of files of the project.
const NAMED: [&str; 3] = [".rs", ".md", ".toml"];

/// Name with such an ending that is an argument of a command.
const OTHERS: [&str; 1] = ["SPEC.toml"];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Collects all files below a folder, without build products and repository data.
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

/// Returns the targets of a document's links within the repository, without anchors.
fn links(text: &str) -> impl Iterator<Item = &str> {
    let targets = text.split("](").skip(1).filter_map(|rest| rest.split([')', '#']).next());
    targets.filter(|target| !target.is_empty() && !target.contains("://"))
}

/// Returns the names of files in code type.
fn quoted_files(text: &str) -> impl Iterator<Item = &str> {
    let quoted = text.lines().flat_map(|line| line.split('`').skip(1).step_by(2));
    quoted.filter(|words| {
        NAMED.iter().any(|ending| words.ends_with(ending) && words.len() > ending.len())
            && words.chars().all(|letter| letter.is_ascii_alphanumeric() || "/_-.".contains(letter))
            && !OTHERS.contains(words)
    })
}

/// Returns the comments of a source.
fn comments(source: &str) -> String {
    let lines = source.lines().filter_map(|line| line.split_once("//").map(|(_, comment)| comment));
    lines.collect::<Vec<_>>().join("\n")
}

/// Returns the names in the answer to `STATS`: fields in the blocks of `counters!`, and the two
/// kinds that are not such fields.
fn counters(source: &str) -> impl Iterator<Item = &str> {
    let blocks = source.split("\ncounters! {").skip(1).filter_map(|rest| rest.split("\n}").next());
    let lines = blocks.flat_map(str::lines).map(str::trim).filter(|line| !line.starts_with("//"));
    let is_no_field =
        |text: &&str| text.starts_with("cmd_") || ["sigma_check_pct", "ephemerides_displaced"].contains(text);
    // A counter of a feature has that in front: `["osnma"] tags,`.
    let names = lines.filter_map(|line| line.strip_suffix(',')?.split(' ').next_back());
    names.chain(source.split('"').filter(is_no_field))
}

/// Returns the texts with which a command is refused, without those that carry a value.
fn refusals(source: &str) -> impl Iterator<Item = &str> {
    let arms = source.lines().filter_map(|line| line.trim().strip_prefix("Self::")?.split_once(" => \""));
    arms.filter(|(name, _)| !name.contains('{')).filter_map(|(_, text)| text.strip_suffix("\","))
}

/// Returns the names in code type in the first cell of each row in the tables of a section.
fn rows<'t>(document: &'t str, heading: &str) -> BTreeSet<&'t str> {
    let sections =
        document.split("\n#").filter(|section| section.trim_start_matches('#').starts_with(heading));
    let rows = sections.flat_map(str::lines).filter_map(|line| line.strip_prefix("| `"));
    rows.filter_map(|row| row.split(" |").next())
        .flat_map(|cell| cell.split('`').step_by(2))
        .filter(|name| !name.is_empty())
        .collect()
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
            // Paths are compared by whole names of folders.
            assert!(all.iter().any(|path| path.ends_with(name)), "{}: {name} is not there", file.display());
            count += 1;
        }
    }
    assert!(count > 100, "{count}");
}

#[test]
fn interfaces_explain_every_counter_and_every_refusal_and_no_other() {
    let (firmware, mut sources) = (root().join("rai-firmware/src"), Vec::new());
    files(&firmware, &mut sources);
    let read = |path: &Path| fs::read_to_string(path).expect("text");
    let interfaces = read(&root().join("INTERFACES.md"));
    let sources: Vec<_> = sources.iter().filter(|path| ends_in(path, "rs")).map(|path| read(path)).collect();
    let want: BTreeSet<_> = sources.iter().flat_map(|source| counters(source)).collect();
    assert_eq!(rows(&interfaces, " Counters"), want);

    let sources = ["settings/refusal.rs", "selftest.rs"].map(|name| read(&firmware.join(name)));
    let want: BTreeSet<_> = sources.iter().flat_map(|source| refusals(source)).chain(["nearest"]).collect();
    let have = &rows(&interfaces, " Refusals") | &rows(&interfaces, " Self-test");
    assert_eq!(have, want);
}
