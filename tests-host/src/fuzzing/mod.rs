//! Hostile input, made by a machine: what must hold whatever bytes come in.
//!
//! A target takes any bytes and panics where an invariant does not hold. The same targets run in two ways: under
//! cargo-fuzz, which grows its inputs by the code they reach (`cargo xtask fuzz`), and under plain cargo, which
//! replays the corpus that cargo-fuzz left behind and seeded mutations of it ([`replay`]).
//!
//! | target | bytes are | what must hold |
//! |---|---|---|
//! | [`stream`] | the GNSS port: RTCM 3, UBX | [`overheard`]; counters add up |
//! | [`ubx`] | the GNSS port of a u-blox receiver: UBX | the same |
//! | [`navigation_bits`] | pages of all navigation messages, each with its own parities | one outcome a page; orbits where orbits are |
//! | [`command`] | the host port: `$PRAIC` lines, then a sky | [`overheard`]; a refused line changes nothing |
//! | [`ephemeris`] | an ephemeris' fields and instants | radius, speed and clock within what Kepler and the fields allow |
//! | [`epoch`] | requirements, strategies, epochs with anything in them | what a report promises |
//! | [`capi`] | calls of the C interface with arguments of every kind | a refusal changes nothing; nothing is written beyond what was handed in |
//! | [`separation`] | linearised epochs, priors and allocations with anything in them | numbers are numbers; an outcome is what the tests say |
//!
//! The folder `fuzz` holds the corpus, a few hundred small files a target, and the crate that cargo-fuzz builds.
//! The seeds behind them are of simulated skies ([`seeds`]); no recording is among them.

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
mod sealing;
pub mod seeds;
pub mod separation;
pub mod stream;
mod tape;
pub mod ubx;

/// One way into the module.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    /// Name of the target and of the folder of its corpus.
    pub name: &'static str,
    /// Takes any bytes; panics where something does not hold.
    pub run: fn(&[u8]),
}

/// All targets.
pub const TARGETS: [Target; 8] = [
    Target { name: "stream", run: stream::run },
    Target { name: "ubx", run: ubx::run },
    Target { name: "navigation_bits", run: navigation_bits::run },
    Target { name: "command", run: command::run },
    Target { name: "ephemeris", run: ephemeris::run },
    Target { name: "epoch", run: epoch::run },
    Target { name: "separation", run: separation::run },
    Target { name: "capi", run: capi::run },
];
