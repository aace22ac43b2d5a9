//! Fields of an ephemeris.
#![no_main]

libfuzzer_sys::fuzz_target!(|input: &[u8]| tests_host::fuzzing::ephemeris::run(input));
