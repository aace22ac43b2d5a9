//! Calls of the C interface.
#![no_main]

libfuzzer_sys::fuzz_target!(|input: &[u8]| adversary::fuzzing::capi::run(input));
