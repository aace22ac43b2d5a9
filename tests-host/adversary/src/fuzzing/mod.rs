//! Fuzzing: invariants that must hold for any input bytes.
//!
//! A target takes any bytes and panics if an invariant does not hold. The same targets run in two
//! ways: under cargo-fuzz, which extends its inputs by the code they reach (`cargo xtask fuzz`),
//! and under plain cargo, which replays the committed corpus of cargo-fuzz and seeded mutations of
//! it ([`replay`]).
//!
//! | target | bytes are | invariant |
//! |---|---|---|
//! | [`stream`] | the GNSS port: RTCM 3, UBX | [`overheard`]; counters add up |
//! | [`ubx`] | the GNSS port of a u-blox receiver: UBX | the same |
//! | [`sbf`] | the GNSS port of a Septentrio receiver: SBF | the same |
//! | [`navigation_bits`] | pages of all navigation messages, each with its own parities | one outcome per page; orbits at plausible radii |
//! | [`command`] | the host port: `$PRAIC` lines, then a sky | [`overheard`]; a refused line changes nothing |
//! | [`ephemeris`] | an ephemeris' fields and instants | radius, speed and clock within the limits of Kepler's laws and of the fields |
//! | [`epoch`] | requirements, strategies, epochs with any values | the promises of a report |
//! | [`capi`] | calls of the C interface with arguments of every kind | a refusal changes nothing; nothing is written beyond the memory handed in |
//! | [`separation`] | linearised epochs, priors and allocations with any values | all results are numbers; an outcome agrees with the tests |
//!
//! The folder `fuzz` holds the corpus, a few hundred small files per target, and the crate that
//! cargo-fuzz builds. Its seeds come from simulated skies ([`seeds`]); no recording is among them.

mod broadcasts;
pub mod capi;
pub mod command;
pub mod ephemeris;
pub mod epoch;
mod module;
mod mutation;
pub mod navigation_bits;
pub mod overheard;
pub mod replay;
pub mod sbf;
mod sealing;
pub mod seeds;
pub mod separation;
pub mod stream;
mod tape;
pub mod ubx;

/// An input path of the module.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    /// Name of the target and of the folder of its corpus.
    pub name: &'static str,
    /// Function that takes any bytes and panics if an invariant does not hold.
    pub run: fn(&[u8]),
}

/// All targets.
pub const TARGETS: [Target; 9] = [
    Target { name: "stream", run: stream::run },
    Target { name: "ubx", run: ubx::run },
    Target { name: "sbf", run: sbf::run },
    Target { name: "navigation_bits", run: navigation_bits::run },
    Target { name: "command", run: command::run },
    Target { name: "ephemeris", run: ephemeris::run },
    Target { name: "epoch", run: epoch::run },
    Target { name: "separation", run: separation::run },
    Target { name: "capi", run: capi::run },
];
