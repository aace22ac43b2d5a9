//! All that tries to make the module raise its pin on a wrong position, or fail.
//!
//! | module | content |
//! |---|---|
//! | [`attack`] | all attempts to raise the pin on a wrong position |
//! | [`soak`] | hours on the emulated board under faults, resets and a bad line |
//! | [`endurance`] | an hour of `rai run` between cuts, kills and dead clients |
//! | [`fuzzing`] | fuzzing of the ports, the orbits and the core |
//!
//! # References
//!
//! | tag | source |
//! |---|---|
//! | `Wilson1927` | E. B. Wilson, *Probable inference, the law of succession, and statistical inference*, J. Am. Stat. Assoc. 22, 1927 |

#[cfg(feature = "commands")]
pub mod attack;
#[cfg(all(feature = "commands", target_os = "linux"))]
pub mod endurance;
pub mod fuzzing;
#[cfg(feature = "commands")]
pub mod soak;
