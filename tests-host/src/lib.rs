//! Simulated skies, real recordings, experiments and the emulated board, driven from the host.
//!
//! # References of the recordings and their encoding
//!
//! | tag | what |
//! |---|---|
//! | `RINEX-2.11` | W. Gurtner, L. Estey, *RINEX: The Receiver Independent Exchange Format Version 2.11*, 2007 |
//! | `RINEX-3.05` | I. Romero (ed.), *RINEX Version 3.05*, IGS and RTCM SC104, 2020 |
//! | `RINEX-4.01` | F. Gini (ed.), *RINEX Version 4.01*, IGS and RTCM SC104, 2023 |
//! | `Hatanaka2008` | Y. Hatanaka, *A Compression Format and Tools for GNSS Observation Data*, Bulletin of the GSI 55, 2008 |
//! | `Hinnant2013` | H. Hinnant, *chrono-Compatible Low-Level Date Algorithms*, 2013 |
//! | `RTCM-10403.3` | RTCM SC104, *Differential GNSS Services, Version 3*, with amendments, 2016 |

pub mod board;
pub mod chi_square;
pub mod clock_models;
pub mod demo;
pub mod encode;
pub mod evaluate;
pub mod fault;
pub mod gpsd;
pub mod image;
pub mod oracle;
pub mod ransac_traditional;
pub mod recording;
pub mod replay;
pub mod report;
pub mod sample;
pub mod sentence;
pub mod setup;
pub mod shared;
pub mod sky;
pub mod tables;
