//! Words of the values, and the meaning of each word.
//!
//! Every meaning has a word, because the macro matches all variants: a variant without a word does
//! not compile. Of the types of the core, which may grow, those without a word cannot be set. A
//! known word that this build lacks has no meaning, so that the answer distinguishes
//! a wrong word from a missing feature.

use raim_core::internals::integrity::raim::detection::threshold::policy::Policy;
use raim_core::internals::integrity::raim::isolation::parity::Isolation;
use raim_core::monitor::Method;

use super::Phase;
use super::kinds::{Baud, Frequencies, Levels, Noise, SpoofFlag};
use super::promises::Preset;
use super::word::Word;

/// Returns `Some` meaning if the feature is built in, else `None`.
macro_rules! with {
    ([$feature:literal] $meaning:expr) => {{
        #[cfg(feature = $feature)]
        let meaning = Some($meaning);
        #[cfg(not(feature = $feature))]
        let meaning = None;
        meaning
    }};
    ([] $meaning:expr) => {
        Some($meaning)
    };
}

/// Gives each meaning of a type its word. A host may also send an alias; the module reports the
/// word.
macro_rules! words {
    ($type:ty {
        $($word:literal = [$($meaning:tt)+] $(if $feature:literal)?,)+
        $(alias $alias:literal = [$($aliased:tt)+] $(if $alias_feature:literal)?,)*
        $(other $other:pat,)?
    }) => {
        impl Word for $type {
            const WORDS: &'static [&'static str] = &[$($word,)+ $($alias,)*];
            const MEANINGS: &'static [Option<Self>] = &[
                $(with!([$($feature)?] $($meaning)+),)+
                $(with!([$($alias_feature)?] $($aliased)+),)*
            ];

            fn word(self) -> &'static str {
                match self {
                    $($($meaning)+ => $word,)+
                    // No command sets these variants.
                    $($other => "",)?
                }
            }
        }
    };
}

words! { Phase {
    "ENROUTE" = [Phase::EnRoute],
    "TERMINAL" = [Phase::Terminal],
    "NPA" = [Phase::NonPrecisionApproach],
    "LPV200" = [Phase::Lpv200],
    "CUSTOM" = [Phase::Custom],
} }

words! { Policy {
    "T1" = [Policy::T1],
    "T2" = [Policy::T2] if "policies",
    "TOP" = [Policy::TOp] if "policies",
    other _,
} }

words! { Method {
    "AUTO" = [Method::Auto],
    "BAARDA" = [Method::Baarda],
    "SIMULTANEOUS" = [Method::Parity(Isolation::Simultaneous)] if "searches",
    "SEQUENTIAL" = [Method::Parity(Isolation::Sequential)] if "searches",
    "HYBRID" = [Method::Parity(Isolation::Hybrid)] if "searches",
    "GROUPING" = [Method::Parity(Isolation::Grouping)] if "searches",
    "RANSAC" = [Method::Ransac] if "searches",
    "SEPARATION" = [Method::Araim] if "araim",
    alias "ARAIM" = [Method::Araim] if "araim",
    // Steps of the hybrid method, which a paper compares with the whole method.
    other _,
} }

words! { Levels {
    "BOUND" = [Levels::Bound],
    "SLOPE" = [Levels::Slope],
    other _,
} }

words! { Frequencies {
    "AUTO" = [Frequencies::Auto],
    "DUAL" = [Frequencies::Dual],
    "SINGLE" = [Frequencies::Single],
} }

words! { Noise {
    "AUTO" = [Noise::Auto],
    "GEODETIC" = [Noise::Geodetic],
    "CONSUMER" = [Noise::Consumer],
    "PHONE" = [Noise::Phone],
    // Of the setting `SIGMA`, which this one replaces.
    alias "ADAPT" = [Noise::Auto],
    alias "FIXED" = [Noise::Geodetic],
    other _,
} }

words! { SpoofFlag {
    "SAY" = [SpoofFlag::Say],
    "HOLD" = [SpoofFlag::Hold],
} }

words! { Preset {
    "ICAO" = [Preset::Icao],
    "RESEARCH" = [Preset::Research],
    "ICAO-AIR" = [Preset::IcaoAirborne],
    "RESEARCH-AIR" = [Preset::ResearchAirborne],
} }

words! { bool {
    "OFF" = [false],
    "ON" = [true] if "aiding",
} }

words! { Baud {
    "AUTO" = [Baud::Auto],
    "9600" = [Baud::B9600],
    "38400" = [Baud::B38400],
    "115200" = [Baud::B115200],
    "230400" = [Baud::B230400],
    "460800" = [Baud::B460800],
    "921600" = [Baud::B921600],
} }
