//! Receiver autonomous integrity monitoring (RAIM) for microcontrollers: from ranges and satellite positions to a
//! verdict on the position they give. No heap, no panic, no clock of its own, no I/O.
//!
//! A receiver can be confidently wrong: one satellite's range is off by 100 m, and the position walks away with it.
//! Redundant satellites show it, say which one it is, and bound what remains. One epoch walks through the
//! modules in this order:
//!
//! | stage | module | question |
//! |---|---|---|
//! | 1 | [`epoch`] | are these ranges numbers at all? |
//! | 2 | [`fix`] | where are we? |
//! | 3 | [`equations`], [`snapshot`] | what does each range say of the others? |
//! | 4 | [`detection`](integrity::residuals::detection) | is something wrong? |
//! | 5 | [`baarda`](integrity::residuals::baarda), [`parity`](integrity::residuals::parity), [`ransac`](integrity::residuals::ransac) | which satellite is it? |
//! | 6 | [`levels`](integrity::residuals::levels) | how wrong could we be without noticing? |
//! | 7 | [`monitor`] → [`report`] | may the position be used? |
//!
//! beside them [`removal`] (any set of satellites left out by algebra), [`weighting`] (what a sigma is made of),
//! [`clock`] (a forecast of the receiver clock as one more row), [`threshold`](integrity::residuals::threshold) (committed tables), [`frame`]
//! (WGS 84) and [`single`] (all of it as a microcontroller runs it).
//!
//! ```
//! use rai_core::epoch::{Epoch, Observation};
//! use rai_core::frame::Ecef;
//! use rai_core::monitor::Monitor;
//! use rai_core::requirements::Requirements;
//! use rai_core::satellite::{Constellation, SatelliteId};
//!
//! let mut monitor = Monitor::<f32, 40>::new(Requirements::non_precision_approach())?;
//! let mut epoch = Epoch::new(0.0);
//! epoch.push(Observation {
//!     satellite: SatelliteId::new(Constellation::Gps, 5).ok_or("no such satellite")?,
//!     position: Ecef::new(15.6e6, 0.0, 21.6e6),
//!     range_m: 20_850_000.0,
//!     sigma_m: 3.0,
//! })?;
//! let report = monitor.process(&epoch); // one satellite: unavailable, no position
//! assert!(report.solution.is_none());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Symbols
//!
//! `n` ranges, `C` constellations, `dof = n − 3 − C`. `LOS` unit vector receiver → satellite, `σ` standard deviation,
//! `w = 1/σ²`, `v` residual, `r = S_ii` redundancy number, `SSE = Σ w v²`, `τ` threshold on SSE, `λ` non-centrality, `P_fa`
//! and `P_md` probabilities of false alarm and missed detection. Metres, seconds and radians throughout; units are
//! in the names.
//!
//! # Numeric rule
//!
//! What is absolute is `f64`; what is linearised is generic over [`Real`](numeric::real::Real). The Cortex-M4F runs the latter in
//! `f32`; tests hold both to the same reference. All transcendental functions are libm's, so that the same epochs
//! give the same reports on every machine, bit for bit.
//!
//! # What this crate does not do
//!
//! It does not decode messages, compute orbits or know the time of day: `rai-firmware` does. It does not smooth or
//! filter positions, uses no carrier phase, and promises nothing about faults common to all satellites. Its
//! protection levels bound the effect of a single undetected fault; they are not those of ARAIM.
//!
//! # References
//!
//! | tag | source |
//! |---|---|
//! | Abramowitz1964 | M. Abramowitz, I. A. Stegun (eds.), *Handbook of mathematical functions*, NBS Applied Mathematics Series 55, 1964 |
//! | Baarda1968 | W. Baarda, *A testing procedure for use in geodetic networks*, Netherlands Geodetic Commission, Publications on Geodesy 2(5), Delft 1968 |
//! | Blanch2015 | J. Blanch et al., *Baseline advanced RAIM user algorithm and possible improvements*, IEEE Trans. AES 51(1) (2015) 713–732 |
//! | Bowring1985 | B. R. Bowring, *The accuracy of geodetic latitude and height equations*, Survey Review 28(218) (1985) 202–206 |
//! | Brown1992 | R. G. Brown, *A baseline GPS RAIM scheme and a note on the equivalence of three RAIM methods*, Navigation 39(3) (1992) 301–316 |
//! | Chen2009 | Chen Xiaoping et al., receiver-clock aided RAIM, J. Astronautics 30(1) (2009) 271–275 |
//! | Cody1969 | W. J. Cody, *Rational Chebyshev approximations for the error function*, Math. Comp. 23(107) (1969) 631–637 |
//! | DLMF | *NIST digital library of mathematical functions*, <https://dlmf.nist.gov> |
//! | DO-229 | RTCA DO-229, *Minimum operational performance standards for global positioning system/wide area augmentation system airborne equipment* |
//! | ED-259A | EUROCAE ED-259A, *Minimum operational performance standard for dual-frequency multi-constellation satellite-based augmentation system airborne equipment*; its noise model as MAAST has it |
//! | ICAO-A10 | ICAO, Annex 10 to the Convention on International Civil Aviation, *Aeronautical telecommunications*, Volume I, *Radio navigation aids*, table 3.7.2.4-1 |
//! | IS-GPS-200 | *NAVSTAR GPS space segment/navigation user segment interfaces*, interface specification of the US Space Force |
//! | Kiefer1960 | J. Kiefer, J. Wolfowitz, *The equivalence of two extremum problems*, Canadian J. Math. 12 (1960) 363–366 |
//! | Klobuchar1987 | J. A. Klobuchar, *Ionospheric time-delay algorithm for single-frequency GPS users*, IEEE Trans. AES 23(3) (1987) 325–331 |
//! | Lin2016 | Lin Xueyuan et al., `BeiDou` RAIM, J. Naval Aeronautical Univ. 31(6) (2016) 619–624 |
//! | Lomont2003 | C. Lomont, *Fast inverse square root*, Purdue University, 2003 |
//! | MAAST | Stanford University GPS Laboratory, *MATLAB algorithm availability simulation tool*, version for ARAIM |
//! | Montenbruck2018 | O. Montenbruck, P. Steigenberger, A. Hauschild, *Multi-GNSS signal-in-space range error assessment: methodology and results*, Adv. Space Res. 61(12) (2018) 3020–3038 |
//! | Parity | `BeiDou` RAIM by parity vectors with isolation by grouping (print without title page) |
//! | Sankaran1963 | M. Sankaran, *Approximations to the non-central chi-square distribution*, Biometrika 50(1–2) (1963) 199–204 |
//! | Schroth2008 | G. Schroth et al., *Failure detection and exclusion via range consensus*, European Navigation Conference ENC-GNSS, Toulouse 2008 |
//! | Tian2024 | Tian Binpeng et al., improved RANSAC RAIM, Navigation Positioning & Timing 11(3) (2024) 101–108 |
//! | Ulrych1976 | T. J. Ulrych, R. W. Clayton, *Time series modelling and maximum entropy*, Phys. Earth Planet. Inter. 12(2–3) (1976) 188–200 |
//! | Wang1994 | J. Wang, Y. Chen, *On the reliability measure of observations*, Acta Geodaet. Cartograph. Sinica, English edition (1994) 42–51 |
//! | WGS84 | NGA.STND.0036, *Department of Defense World Geodetic System 1984*, version 1.0.0, 2014 |
//! | Wichura1988 | M. J. Wichura, *Algorithm AS 241: the percentage points of the normal distribution*, Appl. Statist. 37(3) (1988) 477–484 |
//! | Yang2015 | Yang Lin et al., RAIM threshold optimisation, Electronics Optics & Control 22(7) (2015) 38–42 |
#![no_std]
#![forbid(unsafe_code)]
#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]
#![warn(clippy::missing_panics_doc)]

#[cfg(any(test, doctest))]
extern crate std;

pub mod allocation;
mod bit_set;
mod bounded;
pub mod clock;
pub mod continuity;
pub mod epoch;
pub mod frame;
pub mod integrity;
pub mod least_squares;
pub mod monitor;
pub mod numeric;
pub mod report;
pub mod requirements;
pub mod satellite;
pub mod single;
pub mod velocity;
pub mod weighting;
