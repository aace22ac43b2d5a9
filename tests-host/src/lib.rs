//! Host side of the project: skies, recordings, faults, the emulated board.
//!
//! Data flow in one direction: a source returns raw epochs, faults are injected, and the epochs are
//! encoded as RTCM. The module (in process, or on the emulated board) turns the bytes into
//! sentences, and the sentences are parsed:
//!
//! ```text
//! sky, recording ──► fault ──► encode ──► rai-firmware │ board ──► sentence ──► replay, demo ──► report
//! ```
//!
//! | module | content |
//! |---|---|
//! | [`sky`] | simulated skies: orbits, noise, receiver clock |
//! | [`measurement`] | measurements of a receiver and broadcasts of satellites, before any wire format |
//! | [`recording`], [`sample`] | RINEX 2, 3 and 4; a small real recording for users without one |
//! | [`capture`] | bytes of a receiver: UBX and RTCM 3, cut into epochs |
//! | [`fault`] | steps, ramps, shifts of a constellation, outages, clock jumps, around any source |
//! | [`encode`] | raw epochs and ephemerides to RTCM 3 and UBX |
//! | [`checksum`] | checksums of frames and sentences |
//! | [`image`](mod@image), [`board`] | the firmware's image; the chip in the emulator: start, feed, read, stop |
//! | [`sentence`] | the module's sentences, parsed |
//! | [`pin`] | the integrity pin of a module in process |
//! | [`replay`], [`demo`] | a recording, or the demonstration, from input to report |
//! | [`report`] | pictures and pages of the results |
//! | [`evaluate`] | linearised epochs through the core, without the firmware |
//! | [`campaign`] | availability and integrity over places, times, skies and methods |
//! | [`clock_models`] | clock series with known predictions |
//! | [`oracle`], [`chi_square`], [`ransac_traditional`], [`gpsd`] | second opinions: dense least squares, exact tails, every subset, another program |
//! | [`tables`] | the threshold tables and their check |
//! | [`no_panic`] | the proof that nothing panics, by the linker |
//! | [`bench`](mod@bench), [`laboratory`] | cost of each stage on the chip; single stages on the emulated core |
//! | [`fuzzing`] | fuzzing of the ports, the orbits and the core |
//! | [`attack`] | all attempts to raise the pin on a wrong position |
//! | [`soak`] | hours on the emulated board under faults, resets and a bad line |
//! | [`setup`], [`skip`] | missing requirements of a machine; tests that are skipped without them |
//! | [`vectors`], [`shared`], [`stations`] | reference values; paths of the recordings of real stations |
//!
//! The package `tests-host/experiments` has the papers' tables and figures.
//!
//! The algorithms of the module are in `rai-core` and `rai-firmware`, not here. This crate computes
//! second opinions by other methods.
//!
//! # References
//!
//! | tag | source |
//! |---|---|
//! | `ARMv7-M` | ARM DDI 0403, *ARMv7-M Architecture Reference Manual* |
//! | `BDS-SIS-ICD` | CSNO, *`BeiDou` Signal In Space ICD, Open Service Signal B1I*, version 3.0, 2019 |
//! | `Brown1997` | R. G. Brown, P. Y. C. Hwang, *Introduction to Random Signals and Applied Kalman Filtering*, 3rd ed., 1997 |
//! | `Chen2009`, `Lin2016`, `Parity`, `Tian2024`, `Yang2015`, `DO-229`, `WGS84` | see the crate [`raim_core`] |
//! | `DS8626` | STMicroelectronics, *STM32F405xx STM32F407xx*, data sheet |
//! | `Galileo-OS-SDD` | European Union, *Galileo Open Service: Service Definition Document*, version 1.3, 2023 |
//! | `Galileo-OS-SIS-ICD` | European Union, *Galileo Open Service Signal In Space ICD* |
//! | `Garwood1936` | F. Garwood, *Fiducial limits for the Poisson distribution*, Biometrika 28, 1936 |
//! | `GLONASS-ICD` | *GLONASS Interface Control Document*, edition 5.1, 2008 |
//! | `GPS-SPS` | *GPS Standard Positioning Service Performance Standard*, 5th ed., 2020 |
//! | `Hatanaka2008` | Y. Hatanaka, *A Compression Format and Tools for GNSS Observation Data*, Bulletin of the GSI 55, 2008 |
//! | `Hinnant2013` | H. Hinnant, *chrono-Compatible Low-Level Date Algorithms*, 2013 |
//! | `IS-GPS-200` | *NAVSTAR GPS space segment/navigation user interfaces* |
//! | `Johnson1995` | N. L. Johnson, S. Kotz, N. Balakrishnan, *Continuous Univariate Distributions*, vol. 2, 2nd ed., 1995 |
//! | `Kasdin1995` | N. J. Kasdin, *Discrete simulation of colored noise*, Proc. IEEE 83(5), 1995 |
//! | `Laurent2000` | B. Laurent, P. Massart, *Adaptive estimation of a quadratic functional*, Ann. Statist. 28(5), 2000 |
//! | `Riley2008` | W. J. Riley, *Handbook of Frequency Stability Analysis*, NIST SP 1065, 2008 |
//! | `RINEX-2.11` | W. Gurtner, L. Estey, *RINEX: The Receiver Independent Exchange Format Version 2.11*, 2007 |
//! | `RINEX-3.05` | I. Romero (ed.), *RINEX Version 3.05*, IGS and RTCM SC104, 2020 |
//! | `RINEX-4.01` | F. Gini (ed.), *RINEX Version 4.01*, IGS and RTCM SC104, 2023 |
//! | `RTCM-10403.3` | RTCM SC104, *Differential GNSS Services, Version 3*, with amendments, 2016 |
//! | `Wilson1927` | E. B. Wilson, *Probable inference, the law of succession, and statistical inference*, J. Am. Stat. Assoc. 22, 1927 |

pub mod checksum;
pub mod encode;
pub mod fault;
pub mod fuzzing;
pub mod measurement;
pub mod pin;
pub mod recording;
pub mod sentence;
pub mod sky;

// Modules that fuzzing does not use and would have to wait for: see the feature.
#[cfg(feature = "commands")]
pub mod attack;
#[cfg(feature = "commands")]
pub mod bench;
#[cfg(feature = "commands")]
pub mod board;
#[cfg(feature = "commands")]
pub mod campaign;
#[cfg(feature = "commands")]
pub mod capi;
#[cfg(feature = "commands")]
pub mod capture;
#[cfg(feature = "commands")]
pub mod chi_square;
#[cfg(feature = "commands")]
pub mod chrony;
#[cfg(feature = "commands")]
pub mod clock_models;
#[cfg(feature = "commands")]
pub mod dashboard;
#[cfg(feature = "commands")]
pub mod demo;
#[cfg(feature = "commands")]
pub mod evaluate;
#[cfg(feature = "commands")]
pub mod gpsd;
#[cfg(feature = "commands")]
pub mod image;
#[cfg(feature = "commands")]
pub mod laboratory;
#[cfg(feature = "commands")]
pub mod no_panic;
#[cfg(feature = "commands")]
pub mod oracle;
#[cfg(feature = "commands")]
pub mod paced;
#[cfg(feature = "commands")]
pub mod ransac_traditional;
#[cfg(feature = "commands")]
pub mod replay;
#[cfg(feature = "commands")]
pub mod report;
#[cfg(feature = "commands")]
pub mod sample;
#[cfg(feature = "commands")]
pub mod setup;
#[cfg(feature = "commands")]
pub mod shared;
#[cfg(feature = "commands")]
pub mod skip;
#[cfg(feature = "commands")]
pub mod soak;
#[cfg(feature = "commands")]
mod source_lines;
#[cfg(feature = "commands")]
pub mod stations;
#[cfg(feature = "commands")]
pub mod tables;
#[cfg(feature = "commands")]
pub mod vectors;

/// Runs the example of the readme as a test.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct Readme;
