//! Trace table: each requirement with the module that implements it, the command that tests it, and
//! its standing.
//!
//! The sources are minimum operational performance standards and technical standard orders. Their
//! texts are not public, so each requirement is described in our words, without its section number.
//! The ramps of TSO-C129a are quoted from its public text, (a)(3)(vii).
//!
//! | source | document |
//! |---|---|
//! | DO-229 | RTCA DO-229, *Minimum operational performance standards for GPS/SBAS airborne equipment* |
//! | DO-316 | RTCA DO-316, *Minimum operational performance standards for GPS airborne equipment*; its integrity requirements are those of DO-229 without SBAS |
//! | TSO-C129a | FAA TSO-C129a, *Airborne supplemental navigation equipment using the global positioning system* |
//! | ICAO | Annex 10, Volume I, table 3.7.2.4-1 |

/// Extent to which a requirement is met.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standing {
    /// The test shows it.
    Met,
    /// A part is shown; the text names the rest.
    Partly(&'static str),
    /// It is not met, for this reason.
    NotMet(&'static str),
    /// It concerns the receiver or the aircraft around the module.
    Outside(&'static str),
}

impl Standing {
    /// Returns the word for a table.
    pub fn word(self) -> &'static str {
        match self {
            Self::Met => "met",
            Self::Partly(_) => "partly",
            Self::NotMet(_) => "not met",
            Self::Outside(_) => "outside",
        }
    }

    /// Returns the rest or the reason; empty if the requirement is met.
    pub fn reason(self) -> &'static str {
        match self {
            Self::Met => "",
            Self::Partly(reason) | Self::NotMet(reason) | Self::Outside(reason) => reason,
        }
    }
}

/// One requirement.
#[derive(Clone, Copy, Debug)]
pub struct Requirement {
    /// Document.
    pub source: &'static str,
    /// Requirement in our words, with its number.
    pub text: &'static str,
    /// File that implements it, from the top of the project; empty if there is none.
    pub module: &'static str,
    /// Command that tests it; empty if there is none.
    pub command: &'static str,
    /// Extent to which it is met.
    pub standing: Standing,
}

use Standing::{Met, NotMet, Outside, Partly};

/// All requirements.
pub const REQUIREMENTS: &[Requirement] = &[
    Requirement {
        source: "DO-229, DO-316",
        text: "Missed alert: at most 0.001 for every geometry, whichever satellite fails",
        module: "rai-core/src/integrity/raim/levels.rs",
        command: "cargo xtask reproduce fde",
        standing: Met,
    },
    Requirement {
        source: "DO-229, DO-316",
        text: "False alert: at most 3.33e-7 for each sample",
        module: "rai-core/src/integrity/raim/detection/mod.rs",
        command: "cargo xtask reproduce probabilities",
        standing: Met,
    },
    Requirement {
        source: "DO-229, DO-316",
        text: "Failed exclusion: at most 0.001 for every geometry in which exclusion is available",
        module: "rai-core/src/integrity/raim/exclusion_levels.rs",
        command: "cargo xtask reproduce fde",
        standing: Partly(
            "met on average over the geometries in which the exclusion level is within the limit; near rivals add up, so \
             that single geometries may exceed it; the module itself does not compare the level with the limit",
        ),
    },
    Requirement {
        source: "DO-229, DO-316",
        text: "Wrong exclusion: counted with missed alerts",
        module: "rai-core/src/integrity/raim/hypotheses/mod.rs",
        command: "cargo xtask reproduce fde",
        standing: Met,
    },
    Requirement {
        source: "DO-229, DO-316",
        text: "Off-line tests over geometries at the edge of availability, with confidence limits",
        module: "tests-host/experiments/src/probabilities/edge.rs",
        command: "cargo xtask reproduce fde",
        standing: Partly(
            "the geometries are drawn over the globe and put at their edge by the alert limit; the documents \
             prescribe a grid, a set of geometries and a count of trials, which were not at hand",
        ),
    },
    Requirement {
        source: "DO-229, DO-316",
        text: "Time to alert of a non-precision approach: 10 s (ICAO), from the arrival of a faulty range",
        module: "rai-firmware/src/receiver/mod.rs",
        command: "cargo test -p tests-host --test all -- pin_in_time",
        standing: Partly(
            "the pin answers within 30 ms of the last byte of an epoch by a model of cycles; a slow ramp is seen when \
             the test sees it",
        ),
    },
    Requirement {
        source: "DO-229, DO-316",
        text: "Horizontal protection level by fault detection, in every epoch",
        module: "rai-core/src/integrity/raim/levels.rs",
        command: "cargo xtask reproduce probabilities",
        standing: Met,
    },
    Requirement {
        source: "DO-229, DO-316",
        text: "Horizontal exclusion level and horizontal uncertainty level",
        module: "rai-core/src/integrity/raim/exclusion_levels.rs",
        command: "cargo test -p raim-core --test all -- exclusion_levels",
        standing: Partly(
            "the core computes the exclusion level for whoever asks (`cargo xtask evaluate`); no sentence carries it, and \
             there is no uncertainty level",
        ),
    },
    Requirement {
        source: "DO-229, DO-316",
        text: "Step detector: a step of a pseudorange of a kilometre is found without RAIM",
        module: "rai-core/src/continuity/mod.rs",
        command: "cargo xtask attack gross-fault",
        standing: Partly("steps are found by redundancy and by continuity, not for each range on its own"),
    },
    Requirement {
        source: "DO-229, DO-316",
        text: "Only healthy satellites: health bits, alert flag, user range accuracy, issue of data",
        module: "rai-firmware/src/ephemeris/health.rs",
        command: "cargo xtask attack health",
        standing: Met,
    },
    Requirement {
        source: "DO-229, DO-316",
        text: "Ephemerides are used only within their fit interval",
        module: "rai-firmware/src/ephemeris/store/mod.rs",
        command: "cargo xtask attack early-ephemeris",
        standing: Met,
    },
    Requirement {
        source: "DO-229, DO-316",
        text: "Error model: range accuracy, ionosphere, troposphere, receiver noise and multipath",
        module: "rai-core/src/weighting/mod.rs",
        command: "cargo test -p tests-host --test all -- accuracy --nocapture",
        standing: Partly("no carrier smoothing, so that noise and multipath are those of raw code"),
    },
    Requirement {
        source: "DO-229, DO-316",
        text: "A mask of 5 degrees or less",
        module: "rai-firmware/src/settings/table.rs",
        command: "cargo test -p tests-host --test module -- commands",
        standing: Met,
    },
    Requirement {
        source: "DO-229",
        text: "Corrections and integrity of SBAS",
        module: "",
        command: "",
        standing: NotMet("messages of SBAS are not read"),
    },
    Requirement {
        source: "DO-229, DO-316",
        text: "Interference must not cause misleading information",
        module: "rai-core/src/continuity/mod.rs",
        command: "cargo xtask attack false-tracking",
        standing: Partly("shown for ranges that jamming makes random; no receiver was jammed"),
    },
    Requirement {
        source: "DO-229, DO-316",
        text: "Prediction of availability for a destination and a time",
        module: "rai-firmware/cli/src/campaign/mod.rs",
        command: "cargo xtask campaign tests-host/campaigns/lpv200.toml",
        standing: Partly("on a host, from orbital elements; the module itself predicts nothing"),
    },
    Requirement {
        source: "DO-229, DO-316",
        text: "Environment, software assurance and hardware assurance of airborne equipment",
        module: "",
        command: "",
        standing: Outside("no part of the module was developed to DO-178C, DO-254 or DO-160"),
    },
    Requirement {
        source: "TSO-C129a",
        text: "RAIM in en-route, terminal and non-precision approach, with alert limits of 2.0, 1.0 and 0.3 NM",
        module: "rai-core/src/requirements.rs",
        command: "cargo xtask reproduce probabilities",
        standing: Met,
    },
    Requirement {
        source: "TSO-C129a",
        text: "A pressure altitude may take part in RAIM",
        module: "rai-core/src/monitor/height.rs",
        command: "cargo xtask attack wrong-height",
        standing: Partly("the host states height and sigma; a barometer is not calibrated by GPS"),
    },
    Requirement {
        source: "TSO-C129a",
        text: "Ramps of a satellite (86.2, 135, 26.6, 19 m a minute) and of the altimeter (-275, 200, 50, 37) are found in time",
        module: "rai-core/src/monitor/height.rs",
        command: "cargo xtask attack altimeter-ramps",
        standing: Partly(
            "each ramp is found before the error exceeds the level, and its time to alarm is printed; the windows of the \
             order hold for its own constellation, which is not at hand",
        ),
    },
    Requirement {
        source: "ICAO",
        text: "APV and LPV-200: HAL 40 m, VAL 35 m, time to alert 6 s, integrity 2e-7 for each approach",
        module: "rai-core/src/allocation.rs",
        command: "cargo xtask reproduce araim",
        standing: Partly("as far as the integrity support message of ARAIM describes the satellites"),
    },
];
