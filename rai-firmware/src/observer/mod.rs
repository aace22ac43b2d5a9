//! Observation of the module: an account of each judged epoch, satellite by satellite.
//!
//! The sentences carry verdicts. A program on a computer that shows or stores more gives the
//! receiver an [`Observer`] (`Receiver::observed`, feature `observer`). The receiver calls it once
//! for each verdict, after the pin is set and the sentences are written. Nothing is computed a
//! second time: ranges, sigmas, w-tests and reasons are those of the judgement. Only directions are
//! computed for the observer, from the positions of the judgement.
//!
//! ```text
//! w_i = r_i / (σ_i √(1 − h_i))     used          h_i = g_iᵀ (GᵀWG)⁻¹ g_i / σ_i²
//! w_i = r_i / (σ_i √(1 + h_i))     not used
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `r` | `Account::residual_m`: range minus distance and receiver clock | m |
//! | `σ` | `Account::sigma_m` | m |
//! | `w` | `Account::w_test` | 1 |
//! | `g`, `G` | row of the geometry: direction, and 1 for the clock of the system; of all used | 1 |
//! | `W` | diagonal of `1/σ²` | m⁻² |
//!
//! The default observer `()` does nothing, and without the feature the module keeps no reasons, so
//! that a chip spends neither time nor memory on them.
//!
//! Numbers that sentences carry too are given as reported, and rounded as the sentences round them
//! (`Figures`), so that a table beside the sentences has the same digits.
//!
//! References: W. Baarda, *A testing procedure for use in geodetic networks*, 1968 (w-test).

#[cfg(feature = "observer")]
mod account;
#[cfg(feature = "observer")]
mod figures;

use raim_core::report::{Report, Verdict};

#[cfg(feature = "observer")]
pub use self::account::Account;
use crate::correction::CAPACITY;
pub use crate::correction::Fate;
use crate::navigator::Navigator;
use crate::output::Statement;
#[cfg(all(feature = "observer", feature = "osnma"))]
use crate::output::nmea::AuthenticationReport;
#[cfg(feature = "observer")]
pub use crate::output::nmea::Figures;
use crate::raw::RawEpoch;
use crate::settings::Configuration;
use crate::time::GpsTime;

/// Takes what the module does, verdict by verdict.
pub trait Observer {
    /// Takes an epoch that has just been judged.
    fn epoch(&mut self, judged: &Judged<'_>);

    /// Takes a verdict without an epoch: of a silence, or of a change of settings.
    fn without_epoch(&mut self, judged: &WithoutEpoch<'_>);
}

/// The observer that does nothing.
impl Observer for () {
    fn epoch(&mut self, _: &Judged<'_>) {}

    fn without_epoch(&mut self, _: &WithoutEpoch<'_>) {}
}

/// An epoch that has just been judged.
#[derive(Clone, Copy, Debug)]
pub struct Judged<'e> {
    pub(crate) raw: &'e RawEpoch,
    pub(crate) navigator: &'e Navigator,
    #[cfg_attr(not(feature = "observer"), expect(dead_code, reason = "only an observer reads it"))]
    pub(crate) statement: &'e Statement<'e, CAPACITY>,
    #[cfg(feature = "observer")]
    pub(crate) came_ms: u64,
    /// What is known of Galileo's ephemerides; `None` without a key.
    #[cfg(all(feature = "observer", feature = "osnma"))]
    pub(crate) authentication: Option<AuthenticationReport>,
}

/// A verdict without an epoch: of a silence, or of a change of settings.
#[derive(Clone, Copy, Debug)]
pub struct WithoutEpoch<'e> {
    /// Verdict with its reason.
    pub verdict: Verdict,
    /// Time tag of the last epoch; `None` before the first.
    pub last: Option<GpsTime>,
    /// GPS time minus UTC, s.
    pub gps_minus_utc_s: u8,
    /// Settings in force.
    pub configuration: &'e Configuration,
}

impl<'e> Judged<'e> {
    /// Returns the time tag of the epoch.
    pub const fn time(&self) -> GpsTime {
        self.raw.time
    }

    /// Returns when the first byte of its ranges came, ms of the clock of
    /// [`Receiver::gnss`](crate::receiver::Receiver::gnss).
    #[cfg(feature = "observer")]
    pub const fn came_ms(&self) -> u64 {
        self.came_ms
    }

    /// Returns the report.
    pub fn report(&self) -> &'e Report<CAPACITY> {
        self.navigator.report()
    }
}
