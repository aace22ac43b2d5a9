//! Navigation bits with correct parities.
#![no_main]

libfuzzer_sys::fuzz_target!(|input: &[u8]| adversary::fuzzing::navigation_bits::run(input));
