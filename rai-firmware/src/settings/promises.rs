//! Integrity parameters of the satellites as a value: a preset, and overrides for single systems.
//!
//! The module receives no integrity support message. A host that receives one, or that trusts a
//! system less than the preset does, sends five values:
//!
//! | value | field | range | unit |
//! |---|---|---|---|
//! | URA | [`IsmParameters::ura_m`] | 0.01 to 100 | m |
//! | URE | [`IsmParameters::ure_m`] | 0.01 to the URA | m |
//! | `b_nom` | [`IsmParameters::bias_m`] | 0 to 100 | m |
//! | `P_sat` | [`IsmParameters::satellite_fault`] | 0, or 1e-12 to 0.1 | – |
//! | `P_const` | [`IsmParameters::constellation_fault`] | the same | – |

use raim_core::internals::weighting::{Ism, IsmParameters};
use raim_core::satellite::Constellation;

use super::Refusal;
use super::number::{plain, signed_scientific};
use super::read::{Values, next, next_number, number};
use super::value::{Commands, Ranges, Spelled, Take, Value, range};
use super::word::Word;

/// Number of systems whose values a command can override: none in a build without ARAIM.
const OVERRIDES: usize = if cfg!(feature = "araim") { Constellation::COUNT } else { 0 };

/// Number of values for a system.
const VALUES: usize = 5;

/// Range of sigmas, m.
const SIGMA_M: (f64, f64) = (0.01, 100.0);

/// Range of biases, m.
const BIAS_M: (f64, f64) = (0.0, 100.0);

/// Range of fault probabilities other than 0. Products of two of them stay within single precision.
const FAULT: (f64, f64) = (1e-12, 0.1);

/// Prior of a satellite fault below which four satellites together stay below 8e-8, the probability
/// that ARAIM may leave unmonitored ([Blanch2015]).
///
/// [Blanch2015]: crate#references
const LEAST_WATCHED: f64 = 2e-8;

/// Preset of the integrity parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Preset {
    /// [`Ism::ICAO`].
    Icao,
    /// [`Ism::RESEARCH`].
    Research,
    /// [`Ism::ICAO_AIRBORNE`].
    IcaoAirborne,
    /// [`Ism::RESEARCH_AIRBORNE`].
    ResearchAirborne,
}

impl Preset {
    /// Returns the values for all systems.
    pub const fn ism(self) -> Ism {
        match self {
            Self::Icao => Ism::ICAO,
            Self::Research => Ism::RESEARCH,
            Self::IcaoAirborne => Ism::ICAO_AIRBORNE,
            Self::ResearchAirborne => Ism::RESEARCH_AIRBORNE,
        }
    }
}

/// A preset, and the overrides for single systems.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Promises {
    preset: Preset,
    own: [Option<IsmParameters>; OVERRIDES],
}

impl Promises {
    /// Ranges of the five values of a system.
    pub(super) const RANGES: [(f64, f64); VALUES] = [SIGMA_M, SIGMA_M, BIAS_M, FAULT, FAULT];

    /// Returns a preset without overrides.
    pub const fn preset(preset: Preset) -> Self {
        Self { preset, own: [None; OVERRIDES] }
    }

    /// Returns true for the presets of ICAO, whatever a command has overridden.
    #[cfg(all(feature = "araim", feature = "cnav"))]
    pub(super) const fn is_of_icao(&self) -> bool {
        matches!(self.preset, Preset::Icao | Preset::IcaoAirborne)
    }

    /// Returns the integrity parameters for the core.
    pub fn ism(&self) -> Ism {
        let mut ism = self.preset.ism();
        for (support, own) in ism.constellations.iter_mut().zip(self.own) {
            *support = own.unwrap_or(*support);
        }
        ism
    }

    /// Returns true if the satellite fault prior of an overridden system is so small that ARAIM
    /// does not monitor these faults. Its levels then cover noise alone.
    pub(super) fn leaves_faults_unwatched(&self) -> bool {
        self.own.iter().flatten().any(|own| own.satellite_fault < LEAST_WATCHED)
    }
}

impl Spelled for Promises {
    const RANGES: usize = VALUES;
    const WORDS: &'static [&'static str] = <Preset as Word>::WORDS;
}

impl Value for Promises {
    fn change(&mut self, values: Values<'_, '_>, ranges: &Ranges) -> Result<(), Refusal> {
        if !cfg!(feature = "araim") {
            return Err(Refusal::NotInBuild);
        }
        let value = next(values)?;
        if let Some(constellation) = system(value) {
            let support = support(values, ranges)?;
            if let Some(own) = self.own.get_mut(constellation as usize) {
                *own = Some(support);
            }
        } else {
            let mut preset = self.preset;
            preset.change(&mut core::iter::once(value), ranges)?;
            *self = Self::preset(preset);
        }
        Ok(())
    }

    fn say(&self, take: Take<'_>) {
        take(self.preset.word());
        for own in &self.own {
            match own {
                Some(support) => say(support, take),
                None => (0..VALUES).for_each(|_| take("")),
            }
        }
        (OVERRIDES * VALUES..Constellation::COUNT * VALUES).for_each(|_| take(""));
    }

    fn tell(&self, take: Take<'_>) -> bool {
        take(self.preset.word());
        for (constellation, own) in Constellation::ALL.into_iter().zip(&self.own) {
            let Some(support) = own else { continue };
            take(constellation.letter().encode_utf8(&mut [0; 4]));
            say(support, take);
        }
        true
    }

    fn commands(&self) -> Commands {
        Commands::Several(1, 1 + VALUES)
    }
}

/// Returns the system that a value names by its letter, as in `SYSTEMS`.
fn system(value: &str) -> Option<Constellation> {
    let &[letter] = value.as_bytes() else { return None };
    Constellation::from_letter(char::from(letter))
}

/// Reads the five values of a system.
fn support(values: Values<'_, '_>, ranges: &Ranges) -> Result<IsmParameters, Refusal> {
    let support = IsmParameters {
        ura_m: next_number(values, range(ranges, 0))?,
        ure_m: next_number(values, range(ranges, 1))?,
        bias_m: next_number(values, range(ranges, 2))?,
        satellite_fault: fault(values, range(ranges, 3))?,
        constellation_fault: fault(values, range(ranges, 4))?,
    };
    if support.is_valid() { Ok(support) } else { Err(Refusal::OutOfRange) }
}

#[inline(never)]
fn fault(values: Values<'_, '_>, range: (f64, f64)) -> Result<f64, Refusal> {
    let value = next(values)?;
    number(value, (0.0, 0.0)).or_else(|_| number(value, range))
}

/// Reports the five values of a system.
fn say(support: &IsmParameters, take: Take<'_>) {
    for metres in [support.ura_m, support.ure_m, support.bias_m] {
        take(&plain(metres));
    }
    for probability in [support.satellite_fault, support.constellation_fault] {
        take(&signed_scientific(probability));
    }
}
