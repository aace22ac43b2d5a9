//! Lines of the host port.
#![no_main]

libfuzzer_sys::fuzz_target!(|input: &[u8]| tests_host::fuzzing::command::run(input));
