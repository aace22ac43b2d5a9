//! Check that every function of the documented interface is part of the proof.
//!
//! The sources are read as text, as rustfmt formats them: an item begins in the first column, a
//! method in the fifth. From the root of a library its public modules are followed. What is hidden
//! from the documentation promises nothing to anybody: it is proved where an image runs it. Each
//! public function gives the name that a list must contain:
//!
//! | in the sources | in the list |
//! |---|---|
//! | `pub fn solve` in `impl Snapshot` | `Snapshot::solve` |
//! | `pub fn slopes` in the module `levels` | `levels::slopes`, or by the module above |
//! | `fn fmt` in `impl Display for RowError` | `<RowError as Display>::fmt` |
//!
//! Generic arguments do not count. A name that several types share must occur as often. Functions
//! of a trait cannot be called from outside if the trait or the type is nowhere public, and need
//! not be listed. Functions that a derive or a macro makes are not seen. Implementations that only a host has are on no chip.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use anyhow::Context;

/// Returns the public functions of a library that a list lacks, by the name that it should contain.
///
/// # Errors
/// If a source file cannot be read.
pub fn missing(library: &Path, list: &str) -> anyhow::Result<Vec<String>> {
    let mut found = Found::default();
    let folder = library.parent().context("the library has no folder")?;
    for module in modules(&read(library)?).filter(|module| module.is_public) {
        follow(module.name, folder, "crate", &mut found)?;
    }
    Ok(not_in(list, &found.functions()))
}

/// Items found in the sources so far.
#[derive(Default)]
struct Found {
    functions: Vec<Function>,
    public_types: BTreeSet<String>,
    private_types: BTreeSet<String>,
}

/// A public function, or a trait's, with the type that implements the trait and with the trait.
struct Function {
    names: Names,
    trait_of: Option<[String; 2]>,
}

impl Found {
    /// Returns the functions that can be called from outside.
    fn functions(self) -> Vec<Names> {
        let Self { functions, public_types, private_types } = self;
        let is_hidden = |name: &String| private_types.contains(name) && !public_types.contains(name);
        let outside =
            functions.into_iter().filter(|function| !function.trait_of.iter().flatten().any(is_hidden));
        outside.map(|function| function.names).collect()
    }

    fn read(&mut self, text: &str, module: &str) {
        let code = text.split("#[cfg(test)]\nmod tests").next().unwrap_or_default();
        for line in code.lines() {
            if let Some(name) = line.strip_prefix("pub ").and_then(type_declared) {
                self.public_types.insert(name.to_owned());
            } else if let Some(name) = type_declared(without_visibility(line)) {
                self.private_types.insert(name.to_owned());
            }
        }
        self.functions.extend(functions_of(code, module));
    }
}

/// Returns the name of the type or trait that a line declares.
fn type_declared(line: &str) -> Option<&str> {
    let rest = ["struct ", "enum ", "union ", "trait "].iter().find_map(|word| line.strip_prefix(word))?;
    rest.split(|character| !is_in_name(character)).next()
}

/// Returns the line without a visibility that is limited to this library.
fn without_visibility(line: &str) -> &str {
    let rest = line.strip_prefix("pub(").and_then(|rest| rest.split_once(") "));
    rest.map_or(line, |(_, rest)| rest)
}

/// Attribute before an implementation that only a host has.
const OF_HOST: &str = "#[cfg(not(target_os = \"none\"))]";

/// Attributes before what the documentation does not show, and before what no chip has.
const LEFT_OUT: [&str; 2] = ["#[doc(hidden)]", "#[cfg(feature = \"observer\")]"];

/// Names under which a list may contain a public function.
type Names = Vec<String>;

fn not_in(list: &str, functions: &[Names]) -> Vec<String> {
    let list = without_generics(list);
    let held = |names: &Names| names.iter().map(|name| occurrences(&list, name)).sum::<usize>();
    let wanted = |names: &Names| functions.iter().filter(|others| *others == names).count();
    let missing = functions.iter().filter(|names| held(names) < wanted(names));
    missing.filter_map(|names| names.first().cloned()).collect()
}

/// Collects the public functions of a module and of those below it.
fn follow(name: &str, folder: &Path, above: &str, found: &mut Found) -> anyhow::Result<()> {
    let flat = folder.join(format!("{name}.rs"));
    let below = folder.join(name);
    let text = read(&if flat.exists() { flat } else { below.join("mod.rs") })?;
    let path = format!("{above}::{name}");
    found.read(&text, &path);
    // A module may be declared twice, once for each setting of a feature.
    let names: BTreeSet<&str> = modules(&text).map(|module| module.name).collect();
    names.into_iter().try_for_each(|name| follow(name, &below, &path, found))
}

fn read(file: &Path) -> anyhow::Result<String> {
    fs::read_to_string(file).with_context(|| format!("{} cannot be read", file.display()))
}

/// A module that a file declares and that the documentation shows.
struct Module<'a> {
    name: &'a str,
    is_public: bool,
}

fn modules(text: &str) -> impl Iterator<Item = Module<'_>> {
    let attributes = std::iter::once("").chain(text.lines());
    text.lines().zip(attributes).filter(|&(_, before)| !LEFT_OUT.contains(&before)).filter_map(|(line, _)| {
        let declared = line.strip_prefix("pub ");
        let name = declared.unwrap_or(line).strip_prefix("mod ")?.strip_suffix(';')?;
        Some(Module { name, is_public: declared.is_some() })
    })
}

fn functions_of(code: &str, module: &str) -> Vec<Function> {
    let mut functions = Vec::new();
    let (mut owner, mut is_of_host) = (None, false);
    let mut attribute = "";
    for line in code.lines() {
        if line.starts_with("impl") {
            owner = Owner::of(line);
            is_of_host = attribute == OF_HOST;
        } else if line == "}" {
            (owner, is_of_host) = (None, false);
        }
        let is_hidden = LEFT_OUT.contains(&attribute.trim_start());
        attribute = line;
        if is_of_host || is_hidden {
            continue;
        }
        let names = match &owner {
            Some(owner) => line.strip_prefix("    ").and_then(|line| owner.function(line)),
            None => public_function(line)
                .map(|name| module.rsplit("::").take(2).map(|module| format!("{module}::{name}")).collect()),
        };
        let trait_of = owner.as_ref().and_then(|owner| owner.trait_of.clone());
        functions.extend(names.map(|names| Function { names, trait_of }));
    }
    functions
}

/// Owner of the functions that follow: a type, or a trait's implementation.
struct Owner {
    path: String,
    trait_of: Option<[String; 2]>,
}

impl Owner {
    /// Parses the first line of an implementation; `None` if no function follows.
    fn of(line: &str) -> Option<Self> {
        let header = without_generics(line.strip_suffix('{')?);
        let header = header.strip_prefix("impl")?.trim();
        let last = |path: &str| path.rsplit("::").next().unwrap_or_default().trim().to_owned();
        Some(match header.split_once(" for ") {
            Some((of, name)) => Self {
                path: format!("<{} as {}>", last(name), last(of)),
                trait_of: Some([last(name), last(of)]),
            },
            None => Self { path: last(header), trait_of: None },
        })
    }

    fn function(&self, line: &str) -> Option<Names> {
        let name = if self.trait_of.is_some() { function(line) } else { public_function(line) };
        Some(vec![format!("{}::{}", self.path, name?)])
    }
}

fn public_function(line: &str) -> Option<&str> {
    function(line.strip_prefix("pub ")?)
}

fn function(line: &str) -> Option<&str> {
    let rest = line.strip_prefix("const ").unwrap_or(line).strip_prefix("fn ")?;
    rest.split(|character| !is_in_name(character)).next()
}

fn is_in_name(character: char) -> bool {
    character.is_alphanumeric() || character == '_'
}

/// Returns the text without lists of generic parameters or arguments; the brackets of
/// `<Type as Trait>` stay.
fn without_generics(text: &str) -> String {
    let (mut bare, mut depth) = (String::new(), 0);
    let mut before = ' ';
    for character in text.chars() {
        match character {
            '<' if depth > 0 || is_in_name(before) || bare.ends_with("::") => {
                if depth == 0 && bare.ends_with("::") {
                    bare.truncate(bare.len() - 2);
                }
                depth += 1;
            }
            '>' if depth > 0 && before != '-' => depth -= 1,
            _ if depth == 0 => bare.push(character),
            _ => {}
        }
        before = character;
    }
    bare
}

/// Returns the number of whole occurrences of a path in a text.
fn occurrences(text: &str, path: &str) -> usize {
    let is_whole = |&(start, _): &(usize, &str)| {
        let (before, after) = (text[..start].chars().next_back(), text[start + path.len()..].chars().next());
        !before.is_some_and(is_in_name) && !after.is_some_and(is_in_name)
    };
    text.match_indices(path).filter(is_whole).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOURCE: &str = "pub fn solve<T: Real>(epoch: &Epoch) {}\n\
                          fn private() {}\n\
                          impl<T: Real, const N: usize> Snapshot<T, N> {\n    pub const fn new() -> Self {}\n    fn hidden() {}\n}\n\
                          impl<T: Real> fmt::Display for Fix<'_, T> {\n    fn fmt(&self) {}\n}\n\
                          impl core::error::Error for Fix {}\n\
                          #[cfg(test)]\nmod tests {\n    pub fn only_here() {}\n}\n";

    fn functions(source: &str, module: &str) -> Vec<Names> {
        let mut found = Found::default();
        found.read(source, module);
        found.functions()
    }

    fn missing_from(list: &str) -> Vec<String> {
        not_in(list, &functions(SOURCE, "core::snapshot"))
    }

    #[test]
    fn whatever_is_public_is_missing_from_an_empty_list() {
        assert_eq!(missing_from(""), ["snapshot::solve", "Snapshot::new", "<Fix as Display>::fmt"]);
    }

    #[test]
    fn what_the_documentation_hides_promises_nothing() {
        let root = "pub mod epoch;\n#[doc(hidden)]\npub mod rates;\nmod median;\n";
        let shown: Vec<(&str, bool)> = modules(root).map(|module| (module.name, module.is_public)).collect();
        assert_eq!(shown, [("epoch", true), ("median", false)]);
        let source =
            "impl Epoch {\n    #[doc(hidden)]\n    pub fn view(&self) {}\n    pub fn push(&mut self) {}\n}\n";
        assert_eq!(not_in("", &functions(source, "crate")), ["Epoch::push"]);
    }

    #[test]
    fn what_only_a_host_has_is_in_no_proof() {
        let source = "#[cfg(not(target_os = \"none\"))]\nimpl Four for Wide {\n    fn join() {}\n}\n\
                      impl Four for Apart {\n    fn join() {}\n}\n";
        assert_eq!(not_in("", &functions(source, "crate")), ["<Apart as Four>::join"]);
    }

    #[test]
    fn generic_arguments_do_not_hide_a_function() {
        let list = "core::solve::<T> as fn(_) -> _, Snapshot::<T, N>::new as fn() -> _,\n\
                    <Fix<'static, T> as Display>::fmt as fn(_, _) -> _,";
        assert_eq!(missing_from(list), Vec::<String>::new());
    }

    #[test]
    fn longer_name_is_another_function() {
        let list = "snapshot::solve_again, OtherSnapshot::new, <Fix as Display>::fmt";
        assert_eq!(missing_from(list), ["snapshot::solve", "Snapshot::new"]);
    }

    #[test]
    fn name_shared_by_two_types_has_to_be_there_twice() {
        let limits = || functions("impl Limits {\n    pub fn published() {}\n}\n", "crate");
        let both = [limits(), limits()].concat();
        assert_eq!(not_in("parity::Limits::published", &both).len(), 2);
        assert_eq!(
            not_in("parity::Limits::published, ransac::Limits::published", &both),
            Vec::<String>::new()
        );
    }

    #[test]
    fn what_a_type_without_an_outside_does_for_a_trait_is_no_public_function() {
        let with = |declaration: &str| {
            let source =
                format!("{declaration} {{\n}}\nimpl From<Refusal> for Unread {{\n    fn from() {{}}\n}}\n");
            functions(&source, "crate").len()
        };
        assert_eq!(with("enum Unread"), 0);
        assert_eq!(with("pub(super) struct Unread<'a>"), 0);
        assert_eq!(with("pub enum Unread"), 1);
        assert_eq!(with("enum Unread {\n}\npub enum Unread"), 1, "either may be meant");
        assert_eq!(with("pub enum Other"), 1, "declared by a macro, or elsewhere");
        assert_eq!(with("pub(super) trait From"), 0, "nobody outside knows the trait");
    }
}
