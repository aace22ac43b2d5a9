//! The processor's own copies, fills and comparisons of memory, on the emulated core.

use rig::board::is_installed;
use rig::laboratory::{Bench, Scalar, Stage};

#[test]
fn copies_fills_and_comparisons_of_memory_equal_plain_loops() {
    if !is_installed() {
        return;
    }
    let mut bench = Bench::default();
    bench.request(Stage::Memory, Scalar::Single, &[]);
    let answers = bench.run().expect("the measuring image finishes");
    let have: Vec<&str> = answers.iter().map(|answer| answer.result.as_str()).collect();
    // 90 lengths: 16 pairs of alignments; 4 alignments at 101 distances; 4 of 4 values; for each
    // pair the equal block, and two values at the first and the last place of the 89 that have one.
    let [copies, moves, fills] = [16 * 90, 4 * 101 * 90, 4 * 4 * 90];
    let comparisons = 16 * (90 + 4 * 89);
    let cases = [("copies", copies), ("moves", moves), ("fills", fills), ("comparisons", comparisons)];
    let each = cases.map(|(name, cases)| format!("({name:?}, Compared {{ cases: {cases}, wrong: 0 }})"));
    let want = format!("[{}]", each.join(", "));
    assert_eq!(have, [want]);
}
