//! Linearised epochs under ARAIM.
#![no_main]

libfuzzer_sys::fuzz_target!(|input: &[u8]| adversary::fuzzing::separation::run(input));
