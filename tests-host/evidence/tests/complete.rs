//! The evidence is complete: every attack is a leaf, every file exists, and every command names
//! something that can be run.

use std::collections::BTreeSet;
use std::path::Path;

use adversary::attack::attacks;
use evidence::fault_tree::HAZARD;
use evidence::requirement::REQUIREMENTS;
use experiments::EXPERIMENTS;

fn top() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

#[test]
fn every_attack_is_one_leaf_of_the_tree() {
    let leaves = HAZARD.attacks();
    let known: BTreeSet<&str> = attacks().iter().map(|attack| attack.name).collect();
    let named: BTreeSet<&str> = leaves.iter().copied().collect();
    assert_eq!(named, known, "the tree lacks a branch");
    assert_eq!(leaves.len(), named.len(), "the tree has a branch twice: {leaves:?}");
}

#[test]
fn every_module_of_the_trace_table_exists() {
    for row in REQUIREMENTS.iter().filter(|row| !row.module.is_empty()) {
        assert!(top().join(row.module).is_file(), "{} of `{}`", row.module, row.text);
    }
}

#[test]
fn every_requirement_has_a_test_or_a_reason() {
    for row in REQUIREMENTS {
        assert!(!row.command.is_empty() || !row.standing.reason().is_empty(), "{}", row.text);
        assert_eq!(row.module.is_empty(), row.command.is_empty(), "{}", row.text);
    }
}

#[test]
fn every_command_names_something_that_can_be_run() {
    let verbs = std::fs::read_to_string(top().join("xtask/src/verb.rs")).expect("the list of commands");
    let verbs: String = verbs.split_whitespace().collect();
    let commands = HAZARD.commands().into_iter().chain(REQUIREMENTS.iter().map(|row| row.command));
    for command in commands.filter(|command| !command.is_empty()) {
        let words: Vec<&str> = command.split(' ').collect();
        let can_be_run = match words[..] {
            ["cargo", "xtask", "reproduce", name] => EXPERIMENTS.iter().any(|known| known.name == name),
            ["cargo", "xtask", "attack", name] => attacks().iter().any(|known| known.name == name),
            ["cargo", "xtask", "campaign", file] => top().join(file).is_file(),
            ["cargo", "xtask", verb, ..] => verbs.contains(&format!("verb(\"{verb}\",")),
            ["cargo", "test", "-p", package, "--test", program, "--", module, ..] => {
                is_test(package, program, module)
            }
            _ => false,
        };
        assert!(can_be_run, "`{command}` names nothing that can be run");
    }
}

/// Returns true if a test program of a package has a module of that name.
fn is_test(package: &str, program: &str, module: &str) -> bool {
    let folder = match package {
        "raim-core" => "rai-core",
        "rig" => "tests-host/rig",
        package => package,
    };
    let program = top().join(folder).join("tests").join(program);
    let is_in = |folder: &Path| {
        folder.join(format!("{module}.rs")).is_file() || folder.join(module).join("mod.rs").is_file()
    };
    is_in(&program) || is_in(&program.join("at_length"))
}
