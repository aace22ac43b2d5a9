//! Checks that the programs measured beside ours give the stated answers, and cost more.

use std::collections::BTreeMap;

use rig::bench::peers::sources::Sources;
use rig::bench::peers::{Comparison, Core, OURS, Outcome, Row};
use rig::board;
use rig::setup;
use rig::skip;

/// Distance from the truth that noise of 2 m on 18 satellites cannot cause, m.
const FAR_M: f64 = 10.0;

/// Returns the sources of an earlier `cargo xtask bench --peers`; a test downloads nothing.
fn sources() -> Option<Sources> {
    if !setup::can_compile_peers() {
        skip::say("arm-none-eabi-gcc with newlib (`cargo xtask bench --peers` installs it)");
        return None;
    }
    let sources = Sources::at_hand();
    if sources.is_none() {
        skip::say("the sources of libswiftnav and RTKLIB (`cargo xtask bench --peers` fetches them)");
    }
    sources.filter(|_| board::is_installed())
}

/// Returns true for a position near the truth without the faulty satellites.
fn is_right(outcome: &Outcome, wrong: &[&str]) -> bool {
    outcome.error_m.is_some_and(|error_m| error_m < FAR_M) && outcome.left_out == wrong
}

/// Returns the epochs of a row that are answered right, and those that are refused.
fn answers(row: &Row) -> Vec<&'static str> {
    let wrong: [&[&str]; 3] = [&[], &["G03"], &["G03", "G06"]];
    let answer = |(outcome, wrong): (&Outcome, &[&str])| match outcome.error_m {
        None => "refused",
        Some(_) if is_right(outcome, wrong) => "right",
        Some(_) => "wrong",
    };
    row.outcomes.iter().zip(wrong).map(answer).collect()
}

#[test]
fn peers_answer_right_or_refuse_and_cost_more_than_ours() {
    let Some(sources) = sources() else { return };
    let comparison = Comparison::take_on(Core::M4, &sources, |_| ()).expect("everything compiles and runs");
    println!("{comparison}");
    let want = BTreeMap::from([
        (OURS, ["right", "right", "right"]),
        ("libswiftnav", ["right", "right", "right"]),
        // Its search leaves out one satellite.
        ("RTKLIB 2.4.3 b34", ["right", "right", "refused"]),
    ]);
    let (ours, theirs): (Vec<&Row>, Vec<&Row>) = comparison.rows.iter().partition(|row| row.program == OURS);
    for row in ours.iter().chain(&theirs) {
        assert_eq!(answers(row), want[row.program], "{row}");
    }
    for (row, ours) in theirs.iter().flat_map(|row| ours.iter().map(move |ours| (row, ours))) {
        for (have, their) in ours.outcomes.iter().zip(&row.outcomes).filter(|_| row.start == ours.start) {
            assert!(have.instructions < their.instructions, "{ours}\n{row}");
        }
    }
}
