//! Open points: subjects that the evidence does not show, with the reasons.

/// A statement, with the reason.
pub const NOT_SHOWN: &[(&str, &str)] = &[
    (
        "Time on silicon",
        "Cycles come from the timing table of the Cortex-M4 and an emulator's trace. No chip was measured.",
    ),
    (
        "Faults of the processor itself",
        "The self-test reads tables and memory at the start. Upsets of memory or registers later are not detected, \
         except for the seals of the settings.",
    ),
    (
        "An attack that is slow and consistent in code, phase, rates and clock from a genuine start",
        "No redundancy of the receiver contradicts it. Only a second truth does: a height, a place, an inertial \
         sensor, or authenticated signals.",
    ),
    (
        "Faults that all satellites share",
        "A level bounds them only if the epoch declares a shared error, as the ionosphere on one frequency.",
    ),
    (
        "Several simultaneous faults with classic RAIM",
        "Its levels bound one undetected fault. Two to four faults can look like fewer; `attack --several` prints \
         the rates. ARAIM bounds those that its integrity support message describes.",
    ),
    (
        "Attacks on the image `small`",
        "The attacks of this page are on the whole module. The image `small` lacks parts that some of them call for; \
         `attack --small` prints which mislead it.",
    ),
    (
        "Distributions other than those assumed",
        "Noise in the experiments is Gaussian with the model's sigma. Recordings have their own noise, but they are \
         hours, not years.",
    ),
    (
        "Independence of the second opinions",
        "Dense least squares, tables and attacks share authors with the module. Reference vectors, gold values and \
         real receivers do not.",
    ),
    (
        "Certification",
        "The page is evidence for an engineer. It is no means of compliance with any standard.",
    ),
];
