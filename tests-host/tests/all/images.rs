//! The named images in the documents: their limits, their chips, and the committed figures.

use std::fmt::Write as _;
use std::path::Path;
use std::{env, fs};

use rig::bench::budget;
use rig::bench::memory::{QUANTITIES, figure_name};
use rig::image::{Chip, NAMED};

const MARK: &str = "<!-- generated: images -->\n";
const END: &str = "<!-- end -->";

/// Returns the table of the named images, with the figures of `tests-host/budgets.txt`.
fn table_of_images() -> String {
    let mut table = "| image | content | satellites | flash, KiB | statics, KiB | deepest stack, KiB | limits, flash / \
                     RAM with stack, KiB | other chips with the memory, flash/RAM, KiB |\n|---|---|---|---|---|---|---|---|\n"
        .to_owned();
    let committed = budget::committed().expect("budgets");
    for named in &NAMED {
        let figures = QUANTITIES.map(|quantity| {
            let bytes = committed.get(&figure_name(named, quantity));
            format!("{:.1}", *bytes.expect("a committed figure") as f64 / 1024.0)
        });
        let [_, others] = named.carriers();
        let memory = |chip: &Chip| format!("{} {}/{}", chip.name, chip.flash_kib, chip.ram_kib);
        let others: Vec<String> = others.iter().map(memory).collect();
        let _ = writeln!(
            table,
            "| `{}` | {}, {} | {} | {} | {} / {} | {} |",
            named.name,
            named.content,
            named.compiled_for,
            named.satellites,
            figures.join(" | "),
            named.flash_kib,
            named.ram_kib,
            others.join(", ")
        );
    }
    table
}

/// `RAI_BLESS=1` writes the table into the document.
#[test]
fn results_have_the_table_of_the_named_images() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../results/cost.md");
    let document = fs::read_to_string(&path).expect("the results");
    let (before, rest) = document.split_once(MARK).expect("a mark before the table");
    let (have, after) = rest.split_once(END).expect("a mark behind the table");
    let want = table_of_images();
    if env::var_os("RAI_BLESS").is_some() {
        fs::write(&path, [before, MARK, &want, END, after].concat()).expect("the results can be written");
        return;
    }
    assert!(
        have == want,
        "the table of images in results/cost.md differs (RAI_BLESS=1 writes it); want\n{want}"
    );
}
