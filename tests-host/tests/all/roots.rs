//! The square root of the processor, on the emulated core.

use rig::board::is_installed;
use rig::laboratory::{Bench, Scalar, Stage};

#[test]
fn roots_of_the_processor_are_those_of_libm() {
    if !is_installed() {
        return;
    }
    let mut bench = Bench::default();
    bench.request(Stage::Roots, Scalar::Single, &[]);
    let answers = bench.run().expect("the measuring image finishes");
    let have: Vec<&str> = answers.iter().map(|answer| answer.result.as_str()).collect();
    // Every 16,381st of 2³² patterns; eight about each of 256 powers; three for each square.
    let cases = 262_193 + 8 * 256 + 3 * 4_097;
    assert_eq!(have, [format!("({cases}, 0)")]);
}
