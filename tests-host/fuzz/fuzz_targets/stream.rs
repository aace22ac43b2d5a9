//! Bytes of the GNSS port.
#![no_main]

libfuzzer_sys::fuzz_target!(|input: &[u8]| tests_host::fuzzing::stream::run(input));
