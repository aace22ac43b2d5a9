//! Reasons of verdicts in words, as `INTERFACES.md` explains them.

/// Reasons, each with its explanation.
const REASONS: &[(&str, &str)] = &[
    ("OK", "all satellites agree"),
    ("EXCLUDED", "the remaining satellites agree after an exclusion"),
    ("COVERED", "several satellites may be the faulty one, and the levels hold for each of them"),
    ("SYSTEM", "systems contradict each other, and Galileo, whose ephemerides are proved, has decided"),
    ("FAULT", "a fault was detected and not isolated"),
    ("AMBIGUOUS", "several exclusions explain the data, or a range came twice with another value"),
    ("TIME", "a wrong time tag of all ranges explains the data, and no exclusion explains it better"),
    ("STALE", "no epoch was judged within the time to alert"),
    ("SOURCE", "no epoch of the receiver in use came, but epochs of another station or format"),
    ("JUMP", "the position moved farther than VMAX allows"),
    ("CLOCK", "the receiver clock moved otherwise than its measured drift"),
    ("TRACK", "the position moved otherwise than its measured velocity"),
    ("SPOOFED", "the receiver is sure that signals are counterfeit"),
    ("AUTH", "satellites sent navigation data that their system did not make"),
    ("REPLAY", "the time of the signals is not that of TRUST"),
    ("NOFIX", "too few satellites for a position, or no convergence"),
    ("REDUNDANCY", "the position has no redundancy that could test it"),
    ("GEOMETRY", "the geometry is singular, or a satellite that moves the position cannot be tested"),
    ("RISK", "no threshold meets both probabilities"),
    ("HPL", "the horizontal protection level is beyond 95 % of its limit"),
    ("VPL", "the vertical protection level is beyond 95 % of its limit"),
    ("EMT", "ARAIM: the effective monitor threshold is beyond 15 m"),
    ("ACCURACY", "ARAIM: the vertical accuracy is beyond 1.87 m"),
    ("BUDGET", "the search was cut"),
    ("INPUT", "the input was refused as a whole"),
    ("RECOVERING", "the satellites agree again after an alert, but not yet for as long as RECOVER asks"),
    ("PLACE", "a height or place where no receiver can be"),
    (
        "SIGMAS",
        "the residuals of the last minute contradict the sigmas, or the satellites left after an exclusion hardly agree",
    ),
    ("UNPROVED", "fewer than four satellites with proved ephemerides, which AUTH,ONLY demands"),
    ("EPHEMERIS", "ranges arrived without orbits"),
    ("SELFTEST", "the self-test computed a wrong result"),
    ("SETTINGS", "settings were lost by a restart, or a command has changed one that a promise rests on"),
    ("", "no reason was reported"),
];

/// Returns the explanation of a reason; `None` for an unknown one.
pub fn explanation(reason: &str) -> Option<&'static str> {
    REASONS.iter().find(|(word, _)| *word == reason).map(|(_, words)| *words)
}

#[cfg(test)]
mod tests {
    use raim_core::Verdict;

    use super::REASONS;

    #[test]
    fn each_reason_of_the_module_is_explained_and_no_other() {
        let of_module: Vec<&str> = Verdict::all().map(Verdict::word).chain([""]).collect();
        for word in &of_module {
            assert!(REASONS.iter().any(|(explained, _)| explained == word), "{word} is not explained");
        }
        for (explained, _) in REASONS {
            assert!(of_module.contains(explained), "the module has no reason {explained}");
        }
    }
}
