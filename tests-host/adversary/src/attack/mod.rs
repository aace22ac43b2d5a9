//! The adversary: every attempt to make the pin high on a wrong position, kept and repeated on
//! every change.
//!
//! ```text
//! sky ─► fault, forgery ─► RTCM, commands ─► module in process ─► sentences, pin ─► tally ─► figures with bounds
//! ```
//!
//! Each attack has a file. It builds the input, sends it to the module as bytes ([`victim`]),
//! compares the sentences with the truth ([`tally`]) and returns [`Figure`]s. The module withstands
//! an attack if every figure is within its bound. The bounds are the promises of the product: no
//! protected epoch has an error above its level (or no more often than the probability of missed
//! detection allows), and no healthy epoch is lost to harmless input.
//!
//! | module | attack |
//! |---|---|
//! | [`false_tracking`] | signals lost and tracked falsely: ranges that agree by chance |
//! | [`leap`] | a counterfeit sky elsewhere, and a time tag that leaps with it |
//! | [`single_fault`] | one satellite wrong by a step or a ramp of any size, or by milliseconds, every method, policy and aid |
//! | [`faulty_orbit`] | a satellite that is not where it broadcasts |
//! | [`clock_ramp`] | too few satellites, and a clock forecast that follows the fault |
//! | [`several_faults`] | two to four satellites wrong at once |
//! | [`reflections`] | all low satellites of one side late |
//! | [`shifted_system`] | all satellites of a system wrong at once, in agreement |
//! | [`two_truths`] | counterfeit signals of one system beside genuine ones of another |
//! | [`broken_system`] | more satellites of one system wrong than an exclusion may take |
//! | [`poor_ranges`] | all ranges noisier than their sigmas, beside wrong orbits, or rounded |
//! | [`early_ephemeris`] | ephemerides that are hours early, and crowds of absent satellites |
//! | [`false_orbits`] | false sets of orbits and clocks, one by one in small steps, or before all others |
//! | [`ionosphere`] | one frequency under a dense ionosphere; forged coefficients |
//! | [`one_frequency`] | one frequency: a step of 60 m on each satellite in turn, and the levels without it |
//! | [`health`] | signals that one message calls healthy and another out of service |
//! | [`held_back`] | epochs that a line delays more and more; a recording that is replayed |
//! | [`false_rates`] | range rates with the wrong sign, and random range rates |
//! | [`rates_apart`] | ranges that move while their rates do not; a counterfeit sky after a silence |
//! | [`walks`] | places that walk off for 20 minutes, leap or swing, with true, missing and contradicting rates |
//! | [`repeater`] | all ranges longer by one delay, without range rates |
//! | [`odd_ranges`] | messages of ranges that are empty, ahead, apart, or of another week |
//! | [`forged_frames`] | frames with another time, week or place, or other leap seconds |
//! | [`week_edge`] | a receiver that starts shortly before a week ends, and dates sets with it; the end of a cycle of weeks |
//! | [`two_stations`] | ranges of a reference station on the receiver's line; a receiver in a tunnel; a receiver that sends everything twice |
//! | [`namesakes`] | two receivers with one station number, from the start, or one after the other |
//! | [`half_epochs`] | one system tagged wrong by tens of milliseconds: one instant as two epochs |
//! | [`doubled_satellite`] | one satellite under two numbers |
//! | [`second_frequency`] | the second frequency of some satellites wrong |
//! | [`settings`] | a time to alert that hides a silence; restarts that lose settings; a setting that rules out faults |
//! | [`after_quiet`] | a ramp of one satellite, and a street, after quiet minutes; a suspicion that was true once |
//! | [`learned_sigmas`] | sigmas learned in quiet minutes, used for ranges these do not describe |
//! | [`wrong_tags`] | time tags wrong by milliseconds, every method and policy, and sigmas that learn from them |
//! | [`suspicions`] | a receiver that detects counterfeit signals, and messages that could cancel its warning |
//! | [`alike_strengths`] | signals of one strength, as one antenna sends them |
//! | [`wrong_height`] | a height of the host that is wrong or drifts, and a sky that rises away from it |
//! | [`unsaid_delays`] | group delays that the navigation message does not carry |
//! | [`unsaid_strength`] | noisy signals whose strength the receiver does not report |
//! | [`upheaval`] | leaps of place and time, a failing line, wrong ranges and commands, all at random |
//! | [`sky`] | a signed sky: jammed, then forged, relayed, pulled off, poisoned or signed by another key |
//! | [`streets`] | real recordings between walls that block low satellites or reflect them late |
//! | [`gaps`] | nature: receivers of any rate that fall silent again and again |
//! | [`recordings`] | nature: real receivers, in the open and between tall buildings |

pub mod module;
pub mod record;
pub mod seen;
pub mod sky;
pub mod small;
pub mod tally;
pub mod victim;

mod after_quiet;
mod alike_strengths;
mod broken_system;
mod clock_ramp;
mod doubled_satellite;
mod early_ephemeris;
mod false_orbits;
mod false_rates;
mod false_signs;
mod false_tracking;
mod faulty_orbit;
mod forged_frames;
mod forgery;
mod gaps;
mod gross_pairs;
mod half_epochs;
mod health;
mod held_back;
mod ionosphere;
mod leap;
mod learned_sigmas;
mod namesakes;
mod odd_ranges;
mod one_frequency;
mod poor_ranges;
mod rates_apart;
mod recordings;
mod reflections;
mod repeater;
mod second_frequency;
mod settings;
pub mod several_faults;
pub mod several_record;
mod shifted_system;
mod single_fault;
mod streets;
mod suspicions;
mod two_stations;
mod two_truths;
mod unsaid_delays;
mod unsaid_strength;
mod upheaval;
mod walks;
mod week_edge;
mod wrong_height;
mod wrong_tags;

use anyhow::Result;
use serde::Serialize;

/// Amount of work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// Seconds of work, as the tests run it.
    Quick,
    /// Many more epochs and geometries.
    Long,
}

impl Effort {
    /// Both forms.
    pub const ALL: [Self; 2] = [Self::Quick, Self::Long];

    /// Returns the word of this form.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Quick => "quick",
            Self::Long => "long",
        }
    }

    /// Returns the form of a word.
    pub fn of(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|effort| effort.word() == word)
    }

    /// Returns the number for this effort.
    pub fn pick<T>(self, quick: T, long: T) -> T {
        match self {
            Self::Quick => quick,
            Self::Long => long,
        }
    }
}

/// An attempt to make the pin high on a wrong position.
#[derive(Clone, Copy, Debug)]
pub struct Attack {
    /// Name on the command line.
    pub name: &'static str,
    /// Description of the attack, one line.
    pub about: &'static str,
    /// Function that runs the attack.
    pub run: fn(Effort) -> Result<Vec<Figure>>,
}

/// All attacks.
pub const ATTACKS: &[&Attack] = &[
    &false_tracking::ATTACK,
    &false_tracking::AFTERWARDS,
    &leap::ATTACK,
    &leap::WITH_TIME,
    &single_fault::STEPS,
    &single_fault::RAMPS,
    &single_fault::GROSS,
    &gross_pairs::ATTACK,
    &faulty_orbit::ATTACK,
    &clock_ramp::ATTACK,
    &several_faults::PAIRS,
    &several_faults::CHOSEN,
    &reflections::ATTACK,
    &shifted_system::WHOLE,
    &shifted_system::FEW,
    &two_truths::ATTACK,
    &broken_system::ATTACK,
    &poor_ranges::NOISE,
    &poor_ranges::ORBITS,
    &poor_ranges::ROUNDED,
    &early_ephemeris::EARLY,
    &early_ephemeris::ABSENT,
    &early_ephemeris::CROWD,
    &false_orbits::TURNED,
    &false_orbits::CLOCKS,
    &false_orbits::LEAP,
    &false_orbits::FIRST,
    &false_orbits::ONE,
    &ionosphere::EVEN,
    &ionosphere::SLOPED,
    &ionosphere::ZEROS,
    &ionosphere::FORGED,
    &one_frequency::RECORDED,
    &one_frequency::SIMULATED,
    &health::ATTACK,
    &odd_ranges::AHEAD,
    &odd_ranges::NEXT,
    &held_back::ATTACK,
    &held_back::AGAIN,
    &held_back::WEEK_OLD,
    &false_rates::NEGATED,
    &false_rates::RANDOM,
    &rates_apart::WALK,
    &rates_apart::DRAG,
    &rates_apart::SILENCE,
    &walks::LONG,
    &walks::LEAPS,
    &repeater::ATTACK,
    &odd_ranges::APART,
    &odd_ranges::WEEK,
    &forged_frames::MOVED,
    &forged_frames::NEAR,
    &forged_frames::LATER,
    &forged_frames::CYCLE,
    &forged_frames::OUTVOTED,
    &week_edge::ATTACK,
    &week_edge::CYCLE,
    &forged_frames::FIRST,
    &forged_frames::LEAP_SECONDS,
    &two_stations::ATTACK,
    &two_stations::TUNNEL,
    &two_stations::NAMESAKE,
    &two_stations::TWICE,
    &namesakes::JOINED,
    &namesakes::IN_TURN,
    &namesakes::TAKEN_OVER,
    &half_epochs::ATTACK,
    &doubled_satellite::ATTACK,
    &second_frequency::ATTACK,
    &settings::TIME_TO_ALERT,
    &settings::RESTARTS,
    &settings::NEVER,
    &learned_sigmas::ATTACK,
    &after_quiet::RAMP,
    &after_quiet::STREET,
    &after_quiet::SUSPICION,
    &wrong_tags::BRIEFLY,
    &wrong_tags::LEARNED,
    &suspicions::ATTACK,
    &alike_strengths::ATTACK,
    &wrong_height::WRONG,
    &wrong_height::RISING,
    &wrong_height::RAMPS,
    &unsaid_delays::ATTACK,
    &unsaid_strength::ATTACK,
    &upheaval::ATTACK,
    &recordings::NOMINAL,
    &recordings::URBAN,
    &false_signs::ATTACK,
    &gaps::ATTACK,
    &streets::ATTACK,
    &sky::ATTACK,
];

/// Bound of a figure.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Bound {
    /// The figure must not exceed this value.
    AtMost(f64),
    /// The figure must not fall below this value.
    AtLeast(f64),
    /// The figure has no bound and is only printed.
    Anywhere,
}

/// A figure that an attack measures.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Figure {
    /// Name of the quantity, with its unit.
    pub quantity: String,
    /// Measured value.
    pub value: f64,
    /// Bound of the value.
    pub bound: Bound,
}

impl Figure {
    /// Returns a figure that must not exceed `bound`.
    pub fn at_most(quantity: impl Into<String>, value: f64, bound: f64) -> Self {
        Self { quantity: quantity.into(), value, bound: Bound::AtMost(bound) }
    }

    /// Returns a figure that must not fall below `bound`.
    pub fn at_least(quantity: impl Into<String>, value: f64, bound: f64) -> Self {
        Self { quantity: quantity.into(), value, bound: Bound::AtLeast(bound) }
    }

    /// Returns a figure without a bound.
    pub fn plain(quantity: impl Into<String>, value: f64) -> Self {
        Self { quantity: quantity.into(), value, bound: Bound::Anywhere }
    }

    /// Returns true if the value is within its bound. NaN is within no bound that is a number.
    pub fn holds(&self) -> bool {
        match self.bound {
            Bound::AtMost(bound) => self.value <= bound,
            Bound::AtLeast(bound) => self.value >= bound,
            Bound::Anywhere => true,
        }
    }
}

/// Result of an attack.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Outcome {
    /// Name of the attack.
    pub name: &'static str,
    /// Description of the attack.
    pub about: &'static str,
    /// Figures that the attack measured.
    pub figures: Vec<Figure>,
}

impl Outcome {
    /// Returns true if every figure is within its bound.
    pub fn is_held(&self) -> bool {
        self.figures.iter().all(Figure::holds)
    }

    /// Formats the figures in one line, and adds the bound to each one that exceeds it.
    pub fn words(&self) -> String {
        let word = |figure: &Figure| {
            let mark = match figure.bound {
                Bound::AtMost(bound) if !figure.holds() => format!(" (not ≤ {})", rounded(bound)),
                Bound::AtLeast(bound) if !figure.holds() => format!(" (not ≥ {})", rounded(bound)),
                _ => String::new(),
            };
            format!("{} {}{mark}", figure.quantity, rounded(figure.value))
        };
        self.figures.iter().map(word).collect::<Vec<_>>().join(", ")
    }
}

impl Attack {
    /// Runs the attack.
    ///
    /// # Errors
    /// If the attack cannot be run.
    pub fn attempt(&self, effort: Effort) -> Result<Outcome> {
        Ok(Outcome { name: self.name, about: self.about, figures: (self.run)(effort)? })
    }
}

/// Formats a value with its significant digits.
fn rounded(value: f64) -> String {
    match value.abs() {
        0.0 => "0".into(),
        size if size < 0.01 => format!("{value:.1e}"),
        size if size < 10.0 && value.fract() != 0.0 => format!("{value:.2}"),
        _ => format!("{value:.0}"),
    }
}
