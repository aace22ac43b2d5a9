//! What is promised of the satellites (integrity support message): a preset, and what a command gave for single systems.
//!
//! The module receives no such message. Whoever does, or trusts a system less than the preset, gives its five values:
//!
//! | value | field | range | unit |
//! |---|---|---|---|
//! | URA | [`IsmParameters::ura_m`] | 0.01 to 100 | m |
//! | URE | [`IsmParameters::ure_m`] | 0.01 to the URA | m |
//! | `b_nom` | [`IsmParameters::bias_m`] | 0 to 100 | m |
//! | `P_sat` | [`IsmParameters::satellite_fault`] | 0, or 1e-12 to 0.1 | – |
//! | `P_const` | [`IsmParameters::constellation_fault`] | the same | – |

use rai_core::satellite::Constellation;
use rai_core::weighting::{Ism, IsmParameters};

use super::Refusal;
use super::number::{plain, signed_scientific};
use super::value::{Values, next, next_number, number};

/// How many values a system has.
pub(super) const VALUES: usize = 5;

/// Sigmas, m: less is no range's, and more says nothing.
const SIGMA_M: (f64, f64) = (0.01, 100.0);

/// Biases, m.
const BIAS_M: (f64, f64) = (0.0, 100.0);

/// Probabilities other than 0: below, single precision has no pairs; above, nothing is promised.
const FAULT: (f64, f64) = (1e-12, 0.1);

/// Below this, four satellites together are below what ARAIM may leave out of its watch, 8e-8 ([Blanch2015]).
///
/// [Blanch2015]: crate#references
const LEAST_WATCHED: f64 = 2e-8;

/// A preset, and what was given for single systems in its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Promises {
    preset: Ism,
    own: [Option<IsmParameters>; Constellation::COUNT],
}

impl Promises {
    /// A preset and nothing else.
    pub const fn preset(preset: Ism) -> Self {
        Self { preset, own: [None; Constellation::COUNT] }
    }

    /// With the values of one system replaced.
    pub(super) fn with(mut self, constellation: Constellation, support: IsmParameters) -> Self {
        if let Some(own) = self.own.get_mut(constellation as usize) {
            *own = Some(support);
        }
        self
    }

    /// What the core judges by.
    pub fn ism(&self) -> Ism {
        let mut ism = self.preset;
        for (support, own) in ism.constellations.iter_mut().zip(self.own) {
            *support = own.unwrap_or(*support);
        }
        ism
    }

    /// Whether a satellite of a system is promised to fail so seldom that nobody watches whether it does: levels then bound noise alone.
    pub(super) fn leaves_faults_unwatched(&self) -> bool {
        self.own.iter().flatten().any(|own| own.satellite_fault < LEAST_WATCHED)
    }

    /// The preset, whatever else was given.
    pub(super) fn base(&self) -> Ism {
        self.preset
    }

    /// Each system with the values that were given for it.
    pub(super) fn own(&self) -> impl Iterator<Item = (Constellation, Option<IsmParameters>)> + use<> {
        Constellation::ALL.into_iter().zip(self.own)
    }
}

/// The system that a value names by its letter, as in `SYSTEMS`.
pub(super) fn system(value: &str) -> Option<Constellation> {
    let mut letters = value.chars();
    let letter = letters.next().filter(|_| letters.next().is_none())?;
    Constellation::from_letter(letter)
}

/// Reads the five values of a system.
pub(super) fn support(values: Values<'_, '_>) -> Result<IsmParameters, Refusal> {
    let support = IsmParameters {
        ura_m: next_number(values, SIGMA_M)?,
        ure_m: next_number(values, SIGMA_M)?,
        bias_m: next_number(values, BIAS_M)?,
        satellite_fault: fault(values)?,
        constellation_fault: fault(values)?,
    };
    if support.is_valid() { Ok(support) } else { Err(Refusal::OutOfRange) }
}

#[inline(never)]
fn fault(values: Values<'_, '_>) -> Result<f64, Refusal> {
    let value = next(values)?;
    number(value, (0.0, 0.0)).or_else(|_| number(value, FAULT))
}

/// Says the five values of a system.
pub(super) fn say(support: &IsmParameters, take: &mut dyn FnMut(&str)) {
    for metres in [support.ura_m, support.ure_m, support.bias_m] {
        take(&plain(metres));
    }
    for probability in [support.satellite_fault, support.constellation_fault] {
        take(&signed_scientific(probability));
    }
}
