//! Calls of the C interface.
#![no_main]

libfuzzer_sys::fuzz_target!(|input: &[u8]| tests_host::fuzzing::capi::run(input));
