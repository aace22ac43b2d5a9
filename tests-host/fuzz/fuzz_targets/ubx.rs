//! Bytes of the GNSS port, from a u-blox receiver.
#![no_main]

libfuzzer_sys::fuzz_target!(|input: &[u8]| adversary::fuzzing::ubx::run(input));
