//! The corpus of fuzzing, and random changes of it, on the stable toolchain.

use adversary::fuzzing::{TARGETS, replay};

/// Number of changed inputs for each target; the seeds make them the same each time.
const MUTATIONS: usize = 2000;

/// Defines a test for each row, which changes the inputs of a target.
macro_rules! mutations {
    ($($test:ident: $target:literal,)*) => {
        $(#[test]
        fn $test() {
            let target = TARGETS.iter().find(|target| target.name == $target).expect("a target");
            replay::mutate(target, MUTATIONS, 1).unwrap();
        })*
    };
}

#[test]
fn every_input_of_the_corpus_passes() {
    for target in &TARGETS {
        for input in replay::corpus(target).unwrap() {
            (target.run)(&input);
        }
    }
}

#[test]
fn corpus_is_small() {
    let of_target = |target| replay::corpus(target).unwrap().iter().map(Vec::len).sum::<usize>();
    let bytes: usize = TARGETS.iter().map(of_target).sum();
    assert!(bytes <= replay::CORPUS_BYTES, "{bytes} bytes");
}

#[test]
fn nothing_and_a_single_byte_are_inputs_too() {
    for target in &TARGETS {
        (target.run)(&[]);
        (0..=u8::MAX).for_each(|byte| (target.run)(&[byte]));
    }
}

mutations! {
    mutations_of_the_gnss_port_pass: "stream",
    mutations_of_the_gnss_port_of_a_u_blox_receiver_pass: "ubx",
    mutations_of_the_gnss_port_of_a_septentrio_receiver_pass: "sbf",
    mutations_of_navigation_bits_pass: "navigation_bits",
    mutations_of_ephemerides_pass: "ephemeris",
    mutations_of_epochs_pass: "epoch",
    mutations_of_calls_from_c_pass: "capi",
    mutations_of_linearised_epochs_pass: "separation",
    mutations_of_the_host_port_pass: "command",
}
