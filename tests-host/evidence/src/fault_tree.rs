//! Fault tree: from the hazard to the attacks that try to cause it.
//!
//! The hazard is a promise (a high pin, or sentences with a position) while the error exceeds the
//! protection level, without an alert within the time to alert. Every gate is an OR, because each
//! branch alone causes the hazard. A leaf is an attack that is run, a test, or a cause that nothing
//! here covers.

/// Cause in the tree.
#[derive(Clone, Copy, Debug)]
pub enum Cause {
    /// Any of several causes.
    AnyOf(&'static str, &'static [Cause]),
    /// Cause that an attack tries, by its name.
    Attack(&'static str),
    /// Cause that a command tests.
    Test(&'static str, &'static str),
    /// Cause that nothing here covers.
    Open(&'static str),
}

use Cause::{AnyOf, Attack, Open, Test};

/// The hazard with all its causes.
pub const HAZARD: Cause = AnyOf(
    "A position is promised while its error exceeds the protection level",
    &[
        AnyOf("Ranges are wrong", &[ONE_SATELLITE, SEVERAL, ALL, SIGMAS]),
        AnyOf("Signals are counterfeit", COUNTERFEIT),
        AnyOf("Orbits or clocks are wrong", ORBITS),
        AnyOf("The date or the time tag is wrong", TIME),
        AnyOf("The line carries what the receiver did not send", LINE),
        AnyOf("A command or a setting makes the promise wrong", SETTINGS),
        AnyOf("The promise comes too late or is not taken back", LATE),
        AnyOf("The processor computes wrongly", PROCESSOR),
    ],
);

const ONE_SATELLITE: Cause = AnyOf(
    "of one satellite",
    &[
        Attack("step"),
        Attack("ramp"),
        Attack("gross-fault"),
        Attack("clock-ramp"),
        Attack("altimeter-ramps"),
        Attack("one-frequency-recorded"),
        Attack("one-frequency-simulated"),
        Attack("never-faulty"),
        Test("each satellite in turn by 100 m", "cargo test -p tests-host --test all -- injection"),
        Test("the size that is missed most often", "cargo xtask reproduce fde"),
    ],
);

const SEVERAL: Cause = AnyOf(
    "of several satellites",
    &[
        Attack("two-faults"),
        Attack("chosen-pairs"),
        Attack("gross-pairs"),
        Attack("reflections"),
        Attack("streets"),
        Attack("street-after-quiet"),
        Attack("ramp-after-quiet"),
        Attack("urban"),
        Attack("second-frequency"),
        Attack("doubled-satellite"),
        Attack("shifted-system"),
        Attack("few-shifted"),
        Attack("broken-system"),
        Attack("unsaid-delays"),
    ],
);

const ALL: Cause = AnyOf(
    "of all satellites",
    &[
        Attack("ionosphere"),
        Attack("ionosphere-slope"),
        Attack("ionosphere-zeros"),
        Attack("ionosphere-forged"),
        Attack("nominal-recordings"),
        Attack("drag-off"),
        Attack("steering"),
    ],
);

const SIGMAS: Cause = AnyOf(
    "by more than their sigmas describe",
    &[
        Attack("noise-four-times"),
        Attack("rounded-ranges"),
        Attack("learned-sigmas"),
        Attack("unsaid-strength"),
        Attack("false-tracking"),
        Attack("false-tracking-afterwards"),
        Attack("false-signs"),
        Attack("gaps"),
    ],
);

const COUNTERFEIT: &[Cause] = &[
    Attack("leap"),
    Attack("leap-of-time"),
    Attack("walk-off"),
    Attack("long-walk-off"),
    Attack("leaps-and-waves"),
    Attack("repeater"),
    Attack("after-silence"),
    Attack("two-truths"),
    Attack("suspicion-denied"),
    Attack("suspicion-once"),
    Attack("alike-strengths"),
    Attack("rising-sky"),
    Attack("sky"),
    Attack("negated-rates"),
    Attack("random-rates"),
    Open("a slow attack from a genuine start that is consistent in code, phase, rates and clock"),
];

const ORBITS: &[Cause] = &[
    Attack("orbit"),
    Attack("orbits-astray"),
    Attack("early-ephemeris"),
    Attack("absent-satellites"),
    Attack("crowd"),
    Attack("turned-orbits"),
    Attack("stepping-clocks"),
    Attack("leaping-orbits"),
    Attack("false-first-sets"),
    Attack("one-false-set"),
    Attack("health"),
    Test("navigation bits as receivers send them", "cargo test -p tests-host --test all -- evidence"),
];

const TIME: &[Cause] = &[
    Attack("wrong-tags"),
    Attack("wrong-tags-learned"),
    Attack("half-epochs"),
    Attack("systems-apart"),
    Attack("week-edge"),
    Attack("cycle-edge"),
    Attack("wrong-week"),
    Attack("outvoted-week"),
    Attack("other-cycle"),
    Attack("moved-week"),
    Attack("near-ahead"),
    Attack("once-later"),
    Attack("leap-seconds"),
    Attack("empty-ahead"),
    Attack("empty-next"),
];

const LINE: &[Cause] = &[
    Attack("two-stations"),
    Attack("tunnel"),
    Attack("namesake"),
    Attack("namesake-first"),
    Attack("namesake-between"),
    Attack("namesake-later"),
    Attack("twice"),
    Attack("first-elsewhere"),
    Attack("sent-again"),
    Attack("week-old"),
    Test("arbitrary bytes", "cargo xtask fuzz"),
];

const SETTINGS: &[Cause] = &[
    Attack("time-to-alert"),
    Attack("wrong-height"),
    Attack("restarts"),
    Attack("upheaval"),
    Test("every setting that affects a promise ends it", "cargo test -p tests-host --test all -- settings"),
];

const LATE: &[Cause] = &[
    Attack("held-back"),
    Test("the pin before the sentence, at 1 to 20 Hz", "cargo test -p tests-host --test all -- pin_in_time"),
    Test("silence of the receiver", "cargo test -p tests-host --test all -- service"),
];

const PROCESSOR: &[Cause] = &[
    Test("a panic is reachable", "cargo xtask test --step \"no panic\""),
    Test("the chip and the host differ", "cargo test -p tests-host --test all -- host_and_target"),
    Test("tables are damaged", "cargo xtask tables --check"),
    Test("faults, resets and noise for hours", "cargo xtask soak"),
    Open("upsets of memory or registers while it runs, except for the sealed settings"),
];

impl Cause {
    /// Returns every attack of the tree, by name, in order.
    pub fn attacks(&self) -> Vec<&'static str> {
        match self {
            Self::AnyOf(_, causes) => causes.iter().flat_map(Self::attacks).collect(),
            Self::Attack(name) => vec![name],
            Self::Test(..) | Self::Open(_) => vec![],
        }
    }

    /// Returns every command of the tree.
    pub fn commands(&self) -> Vec<&'static str> {
        match self {
            Self::AnyOf(_, causes) => causes.iter().flat_map(Self::commands).collect(),
            Self::Test(_, command) => vec![command],
            Self::Attack(_) | Self::Open(_) => vec![],
        }
    }
}
