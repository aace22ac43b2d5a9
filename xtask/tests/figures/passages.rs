//! Passages of a document: paragraphs, items of lists and rows of tables, each with the sources of
//! its figures.
//! A comment has a line of its own, or the end of one.
//!
//! | source | written as | covers |
//! |---|---|---|
//! | command | code type: `cargo xtask demo` | its passage; before a table also the table |
//! | attack | code type, a name alone: `walk-off` | its passage |
//! | command | `<!-- measured: COMMAND; COMMAND -->` | all passages back to the comment or heading before |
//! | input, or fact of the hardware | `<!-- given: WORDS -->` | likewise |
//! | block that a test compares | `<!-- generated: NAME -->` … `<!-- end -->` | its rows |

use adversary::attack::ATTACKS;
use rig::document;

/// Source of figures.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Source {
    /// Command that prints them.
    Command(String),
    /// Description of the input.
    Given(String),
    /// Name of the generated block.
    Block(String),
}

/// Paragraph, item of a list, or row of a table.
#[derive(Clone, Debug)]
pub(crate) struct Passage {
    /// Words with one space between them.
    pub(crate) text: String,
    /// Sources of its figures.
    pub(crate) sources: Vec<Source>,
}

impl Passage {
    /// Returns true for the row of a table.
    pub(crate) fn is_row(&self) -> bool {
        self.text.starts_with('|')
    }
}

/// Returns the passages of a document, without blocks of code.
pub(crate) fn of(text: &str) -> Vec<Passage> {
    let mut reader = Reader::default();
    text.lines().for_each(|line| reader.read(line.trim()));
    reader.end_passage();
    reader.passages
}

#[derive(Default)]
struct Reader {
    passages: Vec<Passage>,
    /// Words of the passage so far.
    words: Vec<String>,
    /// Number of passages before the last heading or comment.
    start: usize,
    /// Sources of the table that follows.
    lead: Vec<Source>,
    is_fenced: bool,
    block: Option<String>,
}

impl Reader {
    fn read(&mut self, line: &str) {
        let is_fence = line.starts_with("```");
        self.is_fenced ^= is_fence;
        if is_fence || self.is_fenced || line.is_empty() {
            return self.end_passage();
        }
        if let Some((before, comments)) = line.split_once(" <!-- ") {
            self.read(before);
            return comments
                .split("<!-- ")
                .for_each(|comment| self.read(&format!("<!-- {}", comment.trim())));
        }
        if let Some(comment) = line.strip_prefix("<!-- ").and_then(|rest| rest.strip_suffix(" -->")) {
            self.end_passage();
            return self.read_comment(comment);
        }
        if line.starts_with('#') {
            self.end_passage();
            self.start = self.passages.len();
            self.lead.clear();
            return;
        }
        let is_item =
            line.starts_with("- ") || line.split_once(". ").is_some_and(|(at, _)| at.parse::<u8>().is_ok());
        if is_item || line.starts_with('|') {
            self.end_passage();
        }
        self.words.push(line.to_owned());
        if line.starts_with('|') {
            self.end_passage();
        }
    }

    fn read_comment(&mut self, comment: &str) {
        let (kind, words) = comment.split_once(": ").unwrap_or((comment, ""));
        let sources: Vec<Source> = match kind {
            "generated" => return self.block = Some(words.to_owned()),
            "end" => return self.block = None,
            "measured" => words.split("; ").map(|command| Source::Command(command.to_owned())).collect(),
            "given" => vec![Source::Given(words.to_owned())],
            _ => panic!("`{comment}` must be measured, given, generated or end"),
        };
        for passage in &mut self.passages[self.start..] {
            passage.sources.extend_from_slice(&sources);
        }
        self.start = self.passages.len();
    }

    fn end_passage(&mut self) {
        let text = document::joined(&std::mem::take(&mut self.words).join(" "));
        if text.is_empty() {
            return;
        }
        let mut sources = commands(&text);
        sources.extend(self.block.clone().map(Source::Block));
        if text.starts_with('|') {
            sources.extend_from_slice(&self.lead);
        } else {
            self.lead.clone_from(&sources);
        }
        self.passages.push(Passage { text, sources });
    }
}

/// Returns the commands in code type.
fn commands(text: &str) -> Vec<Source> {
    let spans = text.split('`').skip(1).step_by(2);
    spans.filter_map(command).map(Source::Command).collect()
}

fn command(span: &str) -> Option<String> {
    let is_command = ["cargo xtask ", "cargo test ", "cargo image", "… --test ", "… all "]
        .iter()
        .any(|start| span.starts_with(start));
    let is_attack = |word: &str| word == "--long" || ATTACKS.iter().any(|attack| attack.name == word);
    if is_command {
        Some(span.to_owned())
    } else {
        span.split(' ').all(is_attack).then(|| format!("cargo xtask attack {span}"))
    }
}

#[test]
fn sources_are_those_in_the_text_before_a_table_and_behind_it() {
    let have = of(
        "# A\none 3 m\n\n- two\n  lines (`cargo xtask demo`):\n\n| a |\n|---|\n| 4 |\n<!-- given: by hand -->\n\
                   after `step`\n```\n5 m\n```\n<!-- generated: x -->\n| 6 |\n<!-- end -->\n",
    );
    let texts: Vec<_> = have.iter().map(|passage| passage.text.as_str()).collect();
    assert_eq!(
        texts,
        ["one 3 m", "- two lines (`cargo xtask demo`):", "| a |", "|---|", "| 4 |", "after `step`", "| 6 |"]
    );
    let demo = || Source::Command("cargo xtask demo".into());
    let given = || Source::Given("by hand".into());
    assert_eq!(have[0].sources, [given()]);
    assert_eq!(have[4].sources, [demo(), given()]);
    let step = Source::Command("cargo xtask attack step".into());
    assert_eq!(have[5].sources, std::slice::from_ref(&step));
    assert_eq!(have[6].sources, [Source::Block("x".into()), step]);
}
