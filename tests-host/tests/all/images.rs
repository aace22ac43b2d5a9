//! The named images in the documents: their limits, their chips, and the committed figures.

use std::fmt::Write as _;

use rig::bench::budget;
use rig::bench::memory::{QUANTITIES, figure_name};
use rig::document;
use rig::image::{Chip, NAMED};

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

#[test]
fn results_have_the_table_of_the_named_images() {
    document::must_have("results/cost.md", "images", &table_of_images());
}
