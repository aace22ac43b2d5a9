//! Epochs of the core.
#![no_main]

libfuzzer_sys::fuzz_target!(|input: &[u8]| adversary::fuzzing::epoch::run(input));
