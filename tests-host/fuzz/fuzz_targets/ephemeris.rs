//! Fields of an ephemeris.
#![no_main]

libfuzzer_sys::fuzz_target!(|input: &[u8]| adversary::fuzzing::ephemeris::run(input));
