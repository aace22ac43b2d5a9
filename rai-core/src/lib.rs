//! Receiver autonomous integrity monitoring (RAIM) for microcontrollers: from ranges and satellite
//! positions to a verdict on the position. The crate needs no heap, no clock and no I/O, and cannot
//! panic.
//!
//! A receiver can be confidently wrong: if one satellite's range is off by 100 m, the position
//! moves with it. Redundant satellites detect the fault, identify the satellite, and bound the
//! remaining error. One epoch passes through the modules in this order:
//!
//! | stage | module | question |
//! |---|---|---|
//! | 1 | [`epoch`] | Are these ranges valid? |
//! | 2 | [`least_squares::fix`] | Where is the receiver? |
//! | 3 | [`least_squares`] | How well do the ranges agree? |
//! | 4 | [`integrity::raim::detection`] | Is a range faulty? |
//! | 5 | [`integrity::raim::isolation`], [`integrity::raim::hypotheses`] | Which satellite is faulty? |
//! | 6 | [`integrity::raim::levels`] | How large can the undetected error be? |
//! | 4–6 | [`integrity::araim`] | The same for several faults and whole constellations, with the risk accounted for |
//! | 7 | [`monitor`] → [`report`] | May the position be used? |
//!
//! The ten types at the root and the six modules [`epoch`], [`frame`], [`monitor`], [`report`],
//! [`requirements`] and [`satellite`] are the interface of the crate. Everything else is hidden from
//! this documentation, and may change in any version.
//!
//! Further modules: [`least_squares::downdate`] (the solution without any set of satellites),
//! [`weighting`] (the error model), [`clock`] (a forecast of the receiver clock as one more row),
//! [`continuity`] (recovery, jumps, and comparison of the motion with the measured velocity and
//! drift), [`velocity`] and [`frame`] (WGS 84).
//!
//! # Example
//!
//! Seven satellites agree on a position, and the monitor protects it:
//!
//! ```
//! use raim_core::{Ecef, Epoch, Monitor, Observation, Requirements, SatelliteId, Verdict};
//!
//! let receiver = Ecef::new(6_378_137.0, 0.0, 0.0); // on the equator and the prime meridian
//! let clock_m = 150.0; // the receiver clock, which every range contains
//! let sky = [
//!     ("G01", 20.2e6, 16.9e6, 0.0),
//!     ("G02", 20.2e6, -16.9e6, 0.0),
//!     ("G03", 20.2e6, 0.0, 16.9e6),
//!     ("G04", 20.2e6, 0.0, -16.9e6),
//!     ("G05", 26.4e6, 1.0e6, 1.0e6),
//!     ("G06", 15.3e6, 15.3e6, 15.3e6),
//!     ("G07", 15.3e6, -15.3e6, -15.3e6),
//! ];
//! let mut epoch = Epoch::new(0.0);
//! for (name, x_m, y_m, z_m) in sky {
//!     let position = Ecef::new(x_m, y_m, z_m);
//!     // While the signal travels, the earth turns.
//!     let turning_m = 7.292_115e-5 / 299_792_458.0 * (x_m * receiver.y_m - y_m * receiver.x_m);
//!     let range_m = position.distance_m(receiver) + turning_m + clock_m;
//!     let satellite: SatelliteId = name.parse()?;
//!     epoch.push(Observation { satellite, position, range_m, sigma_m: 3.0 })?;
//! }
//! let mut monitor = Monitor::<f32, 16>::new(Requirements::en_route())?;
//! let report = monitor.process(&epoch);
//! assert!(matches!(report.verdict, Verdict::Protected(_)));
//! let levels = report.protection.ok_or("seven satellites are redundant")?;
//! assert!(levels.hpl_m < 3_704.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Capacity
//!
//! `Epoch<N>` holds at most `N` satellites, and `Monitor<T, N>` judges it. `N` is 4 to 64. `N`
//! determines all memory, including the stack of the searches. One program may use several `N`.
//!
//! # Features
//!
//! A feature only adds. If another crate of the program enables a feature, no type changes.
//!
//! | feature | default | effect |
//! |---|---|---|
//! | `araim` | yes | builds [`Method::Araim`], solution separation over all monitored fault modes |
//! | `searches` | yes | builds [`Method::Parity`] and [`Method::Ransac`] |
//! | `tables` | yes | thresholds of all committed probabilities; without it only those of the phases of flight |
//! | `policies` | yes | `Policy::T2` and `Policy::TOp`; without it both return the error that there is no threshold |
//! | `past` | yes | compares an epoch with earlier ones: residuals with sigmas, position with velocity, clock with drift, satellites with recent exclusions |
//! | `hypotheses` | yes | tests explanations beyond single satellites: a wrong time tag, or a system that is shifted or broken as a whole |
//! | `aiding` | yes | rows that are no satellites (forecast of the receiver clock, known height), and sigmas scaled by residuals; without it an epoch has no room for such rows |
//! | `double-tables` | yes | thresholds in double precision; without it in single precision |
//! | `authentication` | no | reasons of firmware that authenticates navigation data |
//! | `defmt` | no | `defmt::Format` on public types |
//!
//! # Stability
//!
//! A breaking change of the interface is a new minor version, and the changelog marks it. Reports,
//! reasons, errors, constellations and settings are `#[non_exhaustive]`, so that a new field or
//! variant does not break a program: a `match` on them needs an arm `_`. Only [`Verdict`] has three
//! states for good. Hidden items may change in any version.
//!
//! ```
//! # use raim_core::report::Protected;
//! fn text(reason: Protected) -> &'static str {
//!     match reason {
//!         Protected::Ok => "all satellites agree",
//!         Protected::Excluded => "those left agree",
//!         _ => "protected", // without this arm it does not compile
//!     }
//! }
//! ```
//!
//! # Minimum supported Rust version
//!
//! Rust 1.95. A newer minimum counts as a breaking change and therefore needs a new minor version;
//! the changelog names it.
//!
//! # Symbols
//!
//! | symbol | meaning |
//! |---|---|
//! | `n`, `C`, `dof = n − 3 − C` | ranges, constellations, degrees of freedom |
//! | `LOS` | unit vector receiver → satellite |
//! | `σ`, `w = 1/σ²` | standard deviation and weight of a range |
//! | `v`, `u = √w v`, `SSE = Σ w v²` | residual, normalised residual, sum of squares |
//! | `S`, `r = S_ii` | projection of normalised ranges on normalised residuals, redundancy number |
//! | `τ`, `λ` | threshold on SSE, non-centrality |
//! | `P_fa`, `P_md` | probabilities of false alarm and of missed detection |
//!
//! Units are metres, seconds and radians throughout, and are part of the names.
//!
//! # Numeric rule
//!
//! Absolute values are `f64` or 64-bit integers; linearised values are generic over
//! [`Real`](numeric::real::Real). The Cortex-M4F computes the latter in `f32`; tests compare the
//! results in `f32` and in `f64` with the same reference. All transcendental functions are libm's,
//! so that the same epochs give the same reports on every machine, bit for bit.
//!
//! # Limits
//!
//! This crate does not decode messages, compute orbits or know the time of day: the crate
//! `raim-firmware` does. It does not smooth or filter positions and uses no carrier phase. The
//! protection levels of [`integrity::raim`] bound the effect of a single undetected fault. Those of
//! [`integrity::araim`] also cover several faults and the fault of a whole constellation, as far as
//! the integrity support message describes them. Neither covers an error that all ranges share,
//! unless the epoch declares it ([`Epoch::push_sharing`]).
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
//! | Chang2021 | H. Chang et al., *Ionospheric spatial decorrelation assessment for GBAS daytime operations in Brazil*, Navigation 68(2) (2021) 391–404 |
//! | Chen2009 | Chen Xiaoping et al., receiver-clock aided RAIM, J. Astronautics 30(1) (2009) 271–275 |
//! | Cody1969 | W. J. Cody, *Rational Chebyshev approximations for the error function*, Math. Comp. 23(107) (1969) 631–637 |
//! | DLMF | *NIST digital library of mathematical functions*, <https://dlmf.nist.gov> |
//! | DO-229 | RTCA DO-229, *Minimum operational performance standards for global positioning system/wide area augmentation system airborne equipment* |
//! | ED-259A | EUROCAE ED-259A, *Minimum operational performance standard for dual-frequency multi-constellation satellite-based augmentation system airborne equipment*; its noise model as MAAST has it |
//! | Eissfeller2007 | B. Eissfeller et al., multipath of GPS and Galileo signals by a channel model, as table 1 of *J. Space Weather Space Clim.* (2013) swsc120015 gives it |
//! | ICAO-A10 | ICAO, Annex 10 to the Convention on International Civil Aviation, *Aeronautical telecommunications*, Volume I, *Radio navigation aids*, table 3.7.2.4-1 |
//! | IS-GPS-200 | *NAVSTAR GPS space segment/navigation user segment interfaces*, interface specification of the US Space Force |
//! | Kiefer1960 | J. Kiefer, J. Wolfowitz, *The equivalence of two extremum problems*, Canadian J. Math. 12 (1960) 363–366 |
//! | Klobuchar1987 | J. A. Klobuchar, *Ionospheric time-delay algorithm for single-frequency GPS users*, IEEE Trans. AES 23(3) (1987) 325–331 |
//! | Lin2016 | Lin Xueyuan et al., `BeiDou` RAIM, J. Naval Aeronautical Univ. 31(6) (2016) 619–624 |
//! | MAAST | Stanford University GPS Laboratory, *MATLAB algorithm availability simulation tool*, version for ARAIM |
//! | Marini2021 | L. Marini-Pereira et al., *Reexamining low-latitude ionospheric error bounds: an SBAS approach for Brazil*, IEEE Trans. AES 57(1) (2021) |
//! | Montenbruck2018 | O. Montenbruck, P. Steigenberger, A. Hauschild, *Multi-GNSS signal-in-space range error assessment: methodology and results*, Adv. Space Res. 61(12) (2018) 3020–3038 |
//! | Parity | `BeiDou` RAIM by parity vectors with isolation by grouping (print without title page) |
//! | Sankaran1963 | M. Sankaran, *Approximations to the non-central chi-square distribution*, Biometrika 50(1–2) (1963) 199–204 |
//! | Schroth2008 | G. Schroth et al., *Failure detection and exclusion via range consensus*, European Navigation Conference ENC-GNSS, Toulouse 2008 |
//! | Tian2024 | Tian Binpeng et al., improved RANSAC RAIM, Navigation Positioning & Timing 11(3) (2024) 101–108 |
//! | TSO-C129a | FAA, TSO-C129a, *Airborne Supplemental Navigation Equipment Using the Global Positioning System*, 1996 |
//! | Ulrych1976 | T. J. Ulrych, R. W. Clayton, *Time series modelling and maximum entropy*, Phys. Earth Planet. Inter. 12(2–3) (1976) 188–200 |
//! | Wang1994 | J. Wang, Y. Chen, *On the reliability measure of observations*, Acta Geodaet. Cartograph. Sinica, English edition (1994) 42–51 |
//! | WGS84 | NGA.STND.0036, *Department of Defense World Geodetic System 1984*, version 1.0.0, 2014 |
//! | Wichura1988 | M. J. Wichura, *Algorithm AS 241: the percentage points of the normal distribution*, Appl. Statist. 37(3) (1988) 477–484 |
//! | Yang2015 | Yang Lin et al., RAIM threshold optimisation, Electronics Optics & Control 22(7) (2015) 38–42 |
#![no_std]
#![forbid(unsafe_code)]
#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]
#![warn(clippy::missing_panics_doc)]
#![cfg_attr(docsrs, feature(doc_cfg))]

#[cfg(any(test, doctest))]
extern crate std;

/// Declares a setter for each named field of a type whose fields may grow.
macro_rules! setters {
    ($($setter:ident($field:ident: $type:ty))+) => {
        $(
            #[doc = concat!("Returns the same with another `", stringify!($field), "`.")]
            #[must_use]
            pub const fn $setter(self, $field: $type) -> Self {
                Self { $field, ..self }
            }
        )+
    };
}

mod allocation;
mod bit_set;
mod bounded;
mod clock;
mod continuity;
pub mod epoch;
pub mod frame;
mod integrity;
mod least_squares;
pub mod monitor;
mod numeric;
mod reasons;
pub mod report;
pub mod requirements;
pub mod satellite;
mod velocity;
mod weighting;

/// What the firmware, the tests and the tools use beside the interface. Anything in it may change in
/// any version.
#[doc(hidden)]
pub mod internals {
    macro_rules! open {
        ($($module:ident)+) => {
            $(pub mod $module { pub use crate::$module::*; })+
        };
    }
    open! { allocation clock continuity integrity least_squares numeric velocity weighting }
}

pub use epoch::{Epoch, Observation};
pub use frame::Ecef;
pub use integrity::Method;
pub use monitor::Monitor;
pub use report::{Report, Verdict};
pub use requirements::Requirements;
pub use satellite::{Constellation, SatelliteId};

/// The example of the readme.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
