//! The attacks on the module with the parts of the image `small`: the record of what they do, the
//! documents, and a repetition of the shorter ones.
//!
//! `cargo xtask attack --small --record` records all.

use adversary::attack::module::attack_small;
use adversary::attack::small::{self, attempt, committed};
use adversary::attack::{Effort, attacks};
use rig::image::build_small_module;
use rig::{document, shared};

/// Protected epochs above which an attack is repeated by the command alone, because it takes
/// seconds.
const MOST: usize = 6_000;

/// Line of the record: attack, protected epochs, those beyond a level, largest errors, m.
struct Line {
    attack: String,
    protected: usize,
    beyond: usize,
    largest_m: [String; 2],
}

/// Returns the line of an attack that had an opportunity.
fn line(text: &str) -> Option<Line> {
    let cells: Vec<&str> = text.split('\t').collect();
    let &[attack, protected, beyond, horizontal_m, vertical_m] = cells.as_slice() else { return None };
    let number = |cell: &str| cell.parse().expect("a number");
    Some(Line {
        attack: attack.to_owned(),
        protected: number(protected),
        beyond: number(beyond),
        largest_m: [horizontal_m, vertical_m].map(str::to_owned),
    })
}

fn lines() -> Vec<Line> {
    committed().expect("a record").lines().filter_map(line).collect()
}

#[test]
fn the_small_module_withstands_what_its_record_says() {
    attack_small(build_small_module().expect("the program of the small module"));
    let (record, has_recordings) = (committed().expect("a record"), shared::path("data").is_some());
    for attack in attacks() {
        let want = record.lines().find(|text| text.split('\t').next() == Some(attack.name));
        let want = want.unwrap_or_else(|| panic!("{} is not in the record", attack.name));
        let short = line(want).filter(|line| line.protected <= MOST);
        let Some(Line { beyond, .. }) = short else { continue };
        let finding = attempt(attack, Effort::Quick).expect("an attack that can be tried");
        println!("{}: {finding}", attack.name);
        assert!(beyond > 0 || finding.is_held(), "{} misleads the small module: {finding}", attack.name);
        // Without the recordings, some attacks measure less.
        if has_recordings {
            assert_eq!(small::line(attack.name, &finding), want, "`cargo xtask attack --small --record`");
        }
    }
}

#[test]
fn the_documents_say_which_attacks_mislead_the_small_module() {
    let misled: Vec<Line> = lines().into_iter().filter(|line| line.beyond > 0).collect();
    let head =
        "| attack | protected | beyond | largest error, horizontal / vertical, m |\n|---|---|---|---|\n";
    let rows = misled.iter().map(|Line { attack, protected, beyond, largest_m: [horizontal, vertical] }| {
        format!("| `{attack}` | {protected} | {beyond} | {horizontal} / {vertical} |\n")
    });
    document::must_have("results/adversary.md", "small", &[head.to_owned(), rows.collect()].concat());

    let limits = document::text("LIMITS.md");
    let named = |name: &str| limits.split(['`', ' ']).any(|word| word == name);
    let unnamed: Vec<_> =
        misled.iter().filter(|line| !named(&line.attack)).map(|line| &line.attack).collect();
    assert!(unnamed.is_empty(), "LIMITS.md must name {unnamed:?}");
}
