//! No attacker: real receivers and harmless skies, of which no epoch may be lost or mislead.

mod false_signs;
mod gaps;
pub(super) mod recordings;
pub(super) mod streets;

use super::Attack;

/// Attacks of this folder.
pub(super) const ATTACKS: &[&Attack] =
    &[&recordings::NOMINAL, &recordings::URBAN, &false_signs::ATTACK, &gaps::ATTACK, &streets::ATTACK];
