//! The words that values are made of, and what each means.
//!
//! A word that is known but not built in stands in its table with `None`, so that an answer can tell a wrong word from a
//! missing feature. The same table reads a word and says it again.

use rai_core::integrity::raim::detection::threshold::policy::Policy;
#[cfg(feature = "searches")]
use rai_core::integrity::raim::isolation::parity::Isolation;
use rai_core::monitor::Method;
use rai_core::weighting::Ism;

use super::setting::{Frequencies, Levels, Sigma};
use super::{Phase, Refusal};

/// A key's words, and what each means in this build.
pub(super) type Words<T> = [(&'static str, Option<T>)];

pub(super) const PHASES: &Words<Phase> = &[
    ("ENROUTE", Some(Phase::EnRoute)),
    ("TERMINAL", Some(Phase::Terminal)),
    ("NPA", Some(Phase::NonPrecisionApproach)),
    ("LPV200", Some(Phase::Lpv200)),
    ("CUSTOM", Some(Phase::Custom)),
];

pub(super) const POLICIES: &Words<Policy> =
    &[("T1", Some(Policy::T1)), ("T2", Some(Policy::T2)), ("TOP", Some(Policy::TOp))];

/// What a word means where a feature is built in, and `None` where it is not.
macro_rules! with {
    ($feature:literal, $meaning:expr) => {{
        #[cfg(feature = $feature)]
        let meaning = Some($meaning);
        #[cfg(not(feature = $feature))]
        let meaning = None;
        meaning
    }};
}

pub(super) const METHODS: &Words<Method> = &[
    ("AUTO", Some(Method::Auto)),
    ("BAARDA", Some(Method::Baarda)),
    ("SIMULTANEOUS", with!("searches", Method::Parity(Isolation::Simultaneous))),
    ("SEQUENTIAL", with!("searches", Method::Parity(Isolation::Sequential))),
    ("HYBRID", with!("searches", Method::Parity(Isolation::Hybrid))),
    ("GROUPING", with!("searches", Method::Parity(Isolation::Grouping))),
    ("RANSAC", with!("searches", Method::Ransac)),
    ("SEPARATION", with!("araim", Method::Araim)),
    ("ARAIM", with!("araim", Method::Araim)),
];

pub(super) const LEVELS: &Words<Levels> = &[("BOUND", Some(Levels::Bound)), ("SLOPE", Some(Levels::Slope))];

pub(super) const FREQUENCIES: &Words<Frequencies> = &[
    ("AUTO", Some(Frequencies::Auto)),
    ("DUAL", Some(Frequencies::Dual)),
    ("SINGLE", Some(Frequencies::Single)),
];

pub(super) const SIGMAS: &Words<Sigma> = &[("FIXED", Some(Sigma::Fixed)), ("ADAPT", Some(Sigma::Adapted))];

/// What is promised of the satellites: the module receives no integrity support message.
pub(super) const SUPPORTS: &Words<Ism> = &[
    ("ICAO", Some(Ism::ICAO)),
    ("RESEARCH", Some(Ism::RESEARCH)),
    ("ICAO-AIR", Some(Ism::ICAO_AIRBORNE)),
    ("RESEARCH-AIR", Some(Ism::RESEARCH_AIRBORNE)),
];

pub(super) const SWITCH: &Words<bool> = &[("OFF", Some(false)), ("ON", Some(true))];

/// Bit rates of the GNSS port; `None` finds out.
pub(super) const BIT_RATES: &Words<Option<u32>> = &[
    ("AUTO", Some(None)),
    ("9600", Some(Some(9600))),
    ("38400", Some(Some(38_400))),
    ("115200", Some(Some(115_200))),
    ("230400", Some(Some(230_400))),
    ("460800", Some(Some(460_800))),
    ("921600", Some(Some(921_600))),
];

/// What a word means.
pub(super) fn meaning<T: Copy>(value: &str, words: &Words<T>) -> Result<T, Refusal> {
    let (_, meaning) = words.iter().find(|(word, _)| *word == value).ok_or(Refusal::UnknownValue)?;
    meaning.ok_or(Refusal::NotInBuild)
}

/// The word that means this.
pub(super) fn word<T: Copy + PartialEq>(wanted: T, words: &Words<T>) -> &'static str {
    words.iter().find(|(_, meaning)| *meaning == Some(wanted)).map_or("", |(word, _)| word)
}
