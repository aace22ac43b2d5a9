//! Programs for a computer with a GNSS receiver: the library behind the command `rai`.
//!
//! [`run`] is the module itself as a service. A receiver's bytes come in; sentences and a fail-safe
//! pin go out. It runs the firmware's own [`Receiver`](raim_firmware::receiver::Receiver) in the
//! firmware's own [epoch loop](raim_firmware::epoch_loop), so that it prints what the chip prints.
//! The other commands run the same module on recordings and simulated skies:
//!
//! ```text
//! sky, recording ──► fault ──► encode ──┐
//!                                       ├─► module ──► verdict ──► replay, run ──► page
//! capture ──────────► fault ────────────┘         └──► sentence ─► monitor
//! ```
//!
//! | module | content |
//! |---|---|
//! | [`source`] | inputs of all commands: their names, and how each is opened |
//! | [`signal`] | what the module receives: skies, recordings, captures, faults, encoders |
//! | [`verdict`] | what it reports: verdicts with their numbers, from its observer |
//! | [`sentence`] | what it sends: its sentences, parsed, of a module behind a wire |
//! | [`satellites`] | satellites of an epoch: direction, C/N0, residual, reason for which one is not used |
//! | [`page`] | pictures and pages of the results |
//! | [`run`] | the module as a service |
//! | [`replay`] | a recording or a capture through the module, from input to report |
//! | [`monitor`] | live view of a module |
//! | [`evaluate`] | linearised epochs through the core, without the firmware |
//! | [`campaign`] | availability and integrity over places, times, skies and methods |
//! | [`second_opinion`] | slow and exact methods beside the core's: dense least squares, exact tails, every subset |
//! | [`command_line`] | the command `rai` itself: its commands, and their dispatch |
//! | [`exit`] | exit code of a command |
//! | [`in_order`] | work of many threads, whose results come in order |
//!
//! The algorithms of the module are in `rai-core` and `rai-firmware`, not here. Each command has a
//! module `command` with its arguments and a function that runs it.
//!
//! Without the feature `commands` the library holds only `signal`, `verdict` and `sentence`, which a
//! fuzzer needs, and `satellites`, which the package for Python needs. The feature `replay` adds [`replay`],
//! [`page`] and the commands for receivers ([`configure`]), without threads, ports and terminals: what
//! a browser can run.
//!
//! # References
//!
//! | tag | source |
//! |---|---|
//! | `BDS-SIS-ICD` | CSNO, *`BeiDou` Signal In Space ICD, Open Service Signal B1I*, version 3.0, 2019 |
//! | `Brown1997` | R. G. Brown, P. Y. C. Hwang, *Introduction to Random Signals and Applied Kalman Filtering*, 3rd ed., 1997 |
//! | `Chen2009`, `Lin2016`, `Parity`, `Tian2024`, `Yang2015`, `DO-229`, `WGS84` | see the crate [`raim_core`] |
//! | `Galileo-OS-SDD` | European Union, *Galileo Open Service: Service Definition Document*, version 1.3, 2023 |
//! | `Galileo-OS-SIS-ICD` | European Union, *Galileo Open Service Signal In Space ICD* |
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
//! | `SBF` | see the crate [`raim_firmware`] |
//! | `UBX-F9` | see the crate [`raim_firmware`] |

pub mod outcomes;
pub mod satellites;
pub mod sentence;
pub mod signal;
pub mod verdict;

#[cfg(feature = "commands")]
pub mod campaign;
#[cfg(feature = "commands")]
pub mod command_line;
#[cfg(feature = "replay")]
pub mod configure;
#[cfg(feature = "commands")]
pub mod evaluate;
#[cfg(feature = "page")]
pub mod exit;
#[cfg(feature = "commands")]
pub mod in_order;
#[cfg(feature = "commands")]
pub mod monitor;
#[cfg(feature = "page")]
pub mod page;
#[cfg(feature = "replay")]
pub mod replay;
#[cfg(feature = "commands")]
pub mod run;
#[cfg(feature = "commands")]
pub mod second_opinion;
#[cfg(feature = "replay")]
pub mod source;

/// The example of the readme.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
