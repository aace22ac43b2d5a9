//! Bytes of the GNSS port, from a Septentrio receiver.
#![no_main]

libfuzzer_sys::fuzz_target!(|input: &[u8]| adversary::fuzzing::sbf::run(input));
