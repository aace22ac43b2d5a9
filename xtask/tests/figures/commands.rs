//! Commands that documents name: their verbs, options and tests exist.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use adversary::attack::ATTACKS;
use experiments::EXPERIMENTS;
use rig::document;
use rig::image::NAMED;

/// Returns what is wrong with a command, or `None`.
pub(crate) fn defect(command: &str) -> Option<String> {
    let words: Vec<&str> = command.split_whitespace().collect();
    match words[..] {
        ["cargo", "xtask", verb, ref rest @ ..] => defect_of_xtask(verb, rest),
        ["cargo", "test", ref rest @ ..] | ["…", ref rest @ ..] => defect_of_test(rest),
        ["cargo", alias, ..] => {
            let is_alias = document::text(".cargo/config.toml")
                .lines()
                .any(|line| line.starts_with(&format!("{alias} = ")));
            (!is_alias).then(|| format!("{alias} is no alias"))
        }
        _ => Some("it is neither `cargo xtask` nor `cargo test`".into()),
    }
}

fn defect_of_xtask(verb: &str, rest: &[&str]) -> Option<String> {
    let help = Command::new(env!("CARGO_BIN_EXE_xtask")).args(["help", verb]).output().expect("help");
    if !help.status.success() {
        return Some(format!("{verb} is no command"));
    }
    let help = String::from_utf8_lossy(&help.stdout).into_owned();
    let own =
        || rest.iter().take_while(|word| **word != "--").map(|word| word.split('=').next().unwrap_or(word));
    let known = |option: &str| {
        help.split(|letter: char| letter.is_whitespace() || letter == ',').any(|word| word == option)
    };
    if let Some(option) = own().find(|word| word.starts_with("--") && !known(word)) {
        return Some(format!("{verb} has no option {option}"));
    }
    let mut names = own().filter(|word| word.starts_with(|first: char| first.is_ascii_lowercase()));
    names.find(|name| !is_argument(verb, name)).map(|name| format!("{name} is no argument of {verb}"))
}

/// Returns true for an argument that a verb accepts; arguments of other verbs are not compared.
fn is_argument(verb: &str, name: &str) -> bool {
    match verb {
        "attack" => name == "all" || ATTACKS.iter().any(|attack| attack.name == name),
        "reproduce" => name == "evidence" || EXPERIMENTS.iter().any(|experiment| experiment.name == name),
        "image" => NAMED.iter().any(|named| named.name == name),
        "campaign" => root().join(name).exists(),
        _ => true,
    }
}

fn defect_of_test(rest: &[&str]) -> Option<String> {
    const VALUED: [&str; 4] = ["-p", "--package", "--test", "--step"];
    let after = |option: &str| rest.iter().position(|word| *word == option).and_then(|at| rest.get(at + 1));
    let package = after("-p").or_else(|| after("--package")).unwrap_or(&"tests-host");
    let Some(folder) = folder_of(package) else { return Some(format!("{package} is no package")) };
    let tests = tests_below(&folder);
    let is_value = |at: usize| at > 0 && VALUED.contains(&rest[at - 1]);
    let mut filters = (0..rest.len()).filter(|at| !is_value(*at)).map(|at| rest[at]);
    filters
        .find(|word| {
            !word.starts_with(['-', '…']) && *word != "all" && !tests.iter().any(|test| test.contains(word))
        })
        .map(|word| format!("no test of {package} has {word} in its name"))
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Returns the folder of a package.
fn folder_of(package: &str) -> Option<PathBuf> {
    let manifest = document::text("Cargo.toml");
    let members = manifest.split_once("members = [")?.1.split(']').next()?;
    let folders = members.split('"').skip(1).step_by(2).map(|folder| root().join(folder));
    let name = format!("name = \"{package}\"");
    folders.into_iter().find(|folder| {
        fs::read_to_string(folder.join("Cargo.toml")).is_ok_and(|text| text.lines().any(|line| line == name))
    })
}

/// Returns the paths of the functions in files with tests, as the test runner names them.
fn tests_below(folder: &Path) -> Vec<String> {
    let mut tests = Vec::new();
    for part in ["src", "tests"] {
        collect(&folder.join(part), "", &mut tests);
    }
    tests
}

fn collect(folder: &Path, module: &str, tests: &mut Vec<String>) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let (path, name) = (entry.path(), entry.file_name().to_string_lossy().into_owned());
        if path.is_dir() {
            collect(&path, &format!("{module}{name}::"), tests);
        } else if let Some(name) = name.strip_suffix(".rs") {
            let text = fs::read_to_string(&path).unwrap_or_default();
            let functions = text.split("fn ").skip(1).filter_map(|rest| rest.split(['(', '<']).next());
            let named = |function: &str| format!("{module}{name}::{function}");
            tests.extend(functions.filter(|_| text.contains("#[test]")).map(named));
        }
    }
}

#[test]
fn commands_that_do_not_exist_are_named() {
    for (command, want) in [
        ("cargo xtask atack", "atack is no command"),
        ("cargo xtask attack --longer", "attack has no option --longer"),
        ("cargo xtask attack step gone", "gone is no argument of attack"),
        ("cargo test -p tests-host --test all -- nosuchtest", "no test of tests-host has nosuchtest"),
        ("… --test all nosuchtest …", "no test of tests-host has nosuchtest"),
        ("cargo test -p nowhere a", "nowhere is no package"),
        ("cargo ship", "ship is no alias"),
    ] {
        assert!(
            defect(command).is_some_and(|have| have.starts_with(want)),
            "{command}: {:?}",
            defect(command)
        );
    }
    let right =
        ["cargo xtask attack --several 1000", "cargo test -p tests-host --test all -- accuracy --nocapture"];
    assert_eq!(right.map(defect), [None, None]);
}
