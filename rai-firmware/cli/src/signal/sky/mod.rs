//! Simulated skies: satellites on published orbits, their directions from a site, and a receiver's
//! measurements.
//!
//! ```text
//! fleet ──► orbit ──► sight ──┬──► linear rows (experiments)
//!                    oscillator, noise, atmosphere ──► raw epochs and ephemerides (RTCM)
//! ```
//!
//! Everything follows from a seed. Not modelled: multipath with memory, eclipses, manoeuvres, orbit
//! errors.
//!
//! References: [IS-GPS-200] and [BDS-SIS-ICD] for the orbits, [GPS-SPS] global positioning system
//! standard positioning service performance standard, 5th edition, [Kasdin1995] discrete simulation
//! of coloured noise, Proc. IEEE 83(5), [Riley2008] handbook of frequency stability analysis, NIST
//! SP 1065, [Brown1997] introduction to random signals and applied Kalman filtering, 3rd edition.
//!
//! [IS-GPS-200]: crate#references
//! [BDS-SIS-ICD]: crate#references
//! [GPS-SPS]: crate#references
//! [Kasdin1995]: crate#references
//! [Riley2008]: crate#references
//! [Brown1997]: crate#references

pub mod atmosphere;
pub mod broadcast;
pub mod fleet;
pub mod linear;
pub mod noise;
pub mod orbit;
pub mod oscillator;
pub mod raw;
pub mod sight;

pub use fleet::{Fleet, Satellite};
pub use noise::Noise;
pub use oscillator::{Oscillator, ReceiverClock};
pub use sight::{Sight, Site, sights};
