//! Bytes of the GNSS port.
#![no_main]

libfuzzer_sys::fuzz_target!(|input: &[u8]| adversary::fuzzing::stream::run(input));
