//! Simulated skies, real recordings, experiments and the emulated board, driven from the host.

pub mod board;
pub mod chi_square;
pub mod encode;
pub mod evaluate;
pub mod fault;
pub mod gpsd;
pub mod image;
pub mod oracle;
pub mod recording;
pub mod replay;
pub mod report;
pub mod sample;
pub mod sentence;
pub mod setup;
pub mod shared;
pub mod sky;
pub mod tables;
