//! Fault tree: from the hazard to the attacks that try to cause it.
//!
//! The hazard is a promise (a high pin, or sentences with a position) while the error exceeds the
//! protection level, without an alert within the time to alert. Every gate is an OR, because each
//! branch alone causes the hazard. A leaf is an attack that is run, a test, or a cause that nothing
//! here covers. Each attack says below which branch it stands.

use adversary::attack::{Branch, attacks};

/// Cause in the tree.
#[derive(Clone, Copy, Debug)]
pub enum Cause {
    /// Any of several causes.
    AnyOf(&'static str, &'static [Cause]),
    /// Causes that the attacks of this branch try.
    Attacks(Branch),
    /// Cause that a command tests.
    Test(&'static str, &'static str),
    /// Cause that nothing here covers.
    Open(&'static str),
}

use Cause::{AnyOf, Attacks, Open, Test};

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
        Attacks(Branch::OneSatellite),
        Test("each satellite in turn by 100 m", "cargo test -p tests-host --test all -- injection"),
        Test("the size that is missed most often", "cargo xtask reproduce fde"),
    ],
);

const SEVERAL: Cause = AnyOf("of several satellites", &[Attacks(Branch::Several)]);

const ALL: Cause = AnyOf("of all satellites", &[Attacks(Branch::All)]);

const SIGMAS: Cause = AnyOf("by more than their sigmas describe", &[Attacks(Branch::Sigmas)]);

const COUNTERFEIT: &[Cause] = &[
    Attacks(Branch::Counterfeit),
    Open("a slow attack from a genuine start that is consistent in code, phase, rates and clock"),
];

const ORBITS: &[Cause] = &[
    Attacks(Branch::Orbits),
    Test("navigation bits as receivers send them", "cargo test -p tests-host --test all -- evidence"),
];

const TIME: &[Cause] = &[Attacks(Branch::Time)];

const LINE: &[Cause] = &[Attacks(Branch::Line), Test("arbitrary bytes", "cargo xtask fuzz")];

const SETTINGS: &[Cause] = &[
    Attacks(Branch::Settings),
    Test("every setting that affects a promise ends it", "cargo test -p tests-host --test all -- settings"),
];

const LATE: &[Cause] = &[
    Attacks(Branch::Late),
    Test("the pin before the sentence, at 1 to 20 Hz", "cargo test -p tests-host --test all -- pin_in_time"),
    Test("silence of the receiver", "cargo test -p tests-host --test all -- service"),
];

const PROCESSOR: &[Cause] = &[
    Test("a panic is reachable", "cargo xtask test --step \"no panic\""),
    Test("the chip and the host differ", "cargo test -p rig --test all -- host_and_target"),
    Test("tables are damaged", "cargo xtask tables --check"),
    Test("faults, resets and noise for hours", "cargo xtask soak"),
    Open("upsets of memory or registers while it runs, except for the sealed settings"),
];

impl Cause {
    /// Returns every attack of the tree, by name, in order.
    pub fn attacks(&self) -> Vec<&'static str> {
        match self {
            Self::AnyOf(_, causes) => causes.iter().flat_map(Self::attacks).collect(),
            Self::Attacks(branch) => of_branch(*branch),
            Self::Test(..) | Self::Open(_) => vec![],
        }
    }

    /// Returns every command of the tree.
    pub fn commands(&self) -> Vec<&'static str> {
        match self {
            Self::AnyOf(_, causes) => causes.iter().flat_map(Self::commands).collect(),
            Self::Test(_, command) => vec![command],
            Self::Attacks(_) | Self::Open(_) => vec![],
        }
    }
}

/// Returns the attacks of a branch, by name.
pub(crate) fn of_branch(branch: Branch) -> Vec<&'static str> {
    attacks().into_iter().filter(|attack| attack.branch == branch).map(|attack| attack.name).collect()
}
