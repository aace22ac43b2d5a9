//! The adversary: everything that was tried to make the pin lie, kept, and tried again on every change.
//!
//! ```text
//! sky ─► fault, forgery ─► RTCM, commands ─► module in process ─► sentences, pin ─► tally ─► figures with bounds
//! ```
//!
//! An attack has a file. It builds what the module hears, gives it to the module as bytes ([`victim`]), holds what the
//! module says against the truth ([`tally`]), and gives back [`Figure`]s. It is held where every figure is within its
//! bound. Bounds are what is promised: no protected epoch beyond its level, or not more often than the probability of
//! missed detection allows, and no healthy epoch lost to what should not matter.
//!
//! | module | what is tried |
//! |---|---|
//! | [`false_tracking`] | signals lost and tracked falsely: ranges that agree by chance |
//! | [`leap`] | a counterfeit sky elsewhere, and a time tag that leaps with it |
//! | [`single_fault`] | one satellite wrong by a step or a ramp of any size, or by milliseconds, every method, policy and aid |
//! | [`faulty_orbit`] | a satellite that is not where it says |
//! | [`clock_ramp`] | too few satellites, and a clock forecast that follows the fault |
//! | [`several_faults`] | two to four satellites wrong at once |
//! | [`reflections`] | all low satellites of one side late |
//! | [`shifted_system`] | all satellites of a system wrong at once, in agreement |
//! | [`early_ephemeris`] | ephemerides for later that come first, and crowds of absent satellites |
//! | [`ionosphere`] | one frequency under a dense ionosphere; coefficients that nobody sent |
//! | [`health`] | signals that one message calls healthy and another out of service |
//! | [`held_back`] | epochs that a line holds back, longer and longer; a recording that is sent again |
//! | [`false_rates`] | range rates with the wrong sign, and such that mean nothing |
//! | [`odd_ranges`] | messages of ranges that are empty, ahead, apart, or of another week |
//! | [`forged_frames`] | frames that say another time, week or place, or other leap seconds |
//! | [`week_edge`] | a receiver that starts shortly before a week ends, and dates sets with it; the end of a cycle of weeks |
//! | [`two_stations`] | the ranges of a reference station on the receiver's line; a receiver in a tunnel; one that says everything twice |
//! | [`settings`] | a time to alert that hides a silence; restarts that make settings nobody's; a promise that nothing fails |
//! | [`learned_sigmas`] | sigmas that quiet minutes made small, used for what these say nothing of |
//! | [`wrong_tags`] | time tags wrong by milliseconds, every method and policy, and sigmas that learn from them |
//! | [`suspicions`] | a receiver that is sure of counterfeit signals, and messages that would talk it out of it |
//! | [`unsaid_delays`] | group delays that the navigation message does not carry |
//! | [`unsaid_strength`] | noisy signals of which the receiver does not say how strong they are |
//! | [`upheaval`] | place and time that leap, a line that fails, wrong ranges and commands, all by chance |
//! | [`recordings`] | nature: real receivers, in the open and between tall buildings |

pub mod tally;
pub mod victim;

mod clock_ramp;
mod early_ephemeris;
mod false_rates;
mod false_tracking;
mod faulty_orbit;
mod forged_frames;
mod forgery;
mod health;
mod held_back;
mod ionosphere;
mod leap;
mod learned_sigmas;
mod odd_ranges;
mod recordings;
mod reflections;
mod settings;
pub mod several_faults;
mod shifted_system;
mod single_fault;
mod suspicions;
mod two_stations;
mod unsaid_delays;
mod unsaid_strength;
mod upheaval;
mod week_edge;
mod wrong_tags;

use anyhow::Result;
use serde::Serialize;

/// How much is tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// Some seconds: what the tests run.
    Quick,
    /// Many more epochs and geometries.
    Long,
}

impl Effort {
    /// One of two numbers.
    pub fn pick<T>(self, quick: T, long: T) -> T {
        match self {
            Self::Quick => quick,
            Self::Long => long,
        }
    }
}

/// Something that is tried.
#[derive(Clone, Copy, Debug)]
pub struct Attack {
    /// Name on the command line.
    pub name: &'static str,
    /// What is tried, in a line.
    pub about: &'static str,
    /// Tries it.
    pub run: fn(Effort) -> Result<Vec<Figure>>,
}

/// All of them.
pub const ATTACKS: &[&Attack] = &[
    &false_tracking::ATTACK,
    &false_tracking::AFTERWARDS,
    &leap::ATTACK,
    &leap::WITH_TIME,
    &single_fault::STEPS,
    &single_fault::RAMPS,
    &single_fault::GROSS,
    &faulty_orbit::ATTACK,
    &clock_ramp::ATTACK,
    &several_faults::PAIRS,
    &several_faults::CHOSEN,
    &reflections::ATTACK,
    &shifted_system::WHOLE,
    &shifted_system::FEW,
    &early_ephemeris::EARLY,
    &early_ephemeris::ABSENT,
    &early_ephemeris::CROWD,
    &ionosphere::EVEN,
    &ionosphere::SLOPED,
    &ionosphere::ZEROS,
    &ionosphere::FORGED,
    &health::ATTACK,
    &odd_ranges::AHEAD,
    &odd_ranges::NEXT,
    &held_back::ATTACK,
    &held_back::AGAIN,
    &held_back::WEEK_OLD,
    &false_rates::NEGATED,
    &false_rates::RANDOM,
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
    &settings::TIME_TO_ALERT,
    &settings::RESTARTS,
    &settings::NEVER,
    &learned_sigmas::ATTACK,
    &wrong_tags::BRIEFLY,
    &wrong_tags::LEARNED,
    &suspicions::ATTACK,
    &unsaid_delays::ATTACK,
    &unsaid_strength::ATTACK,
    &upheaval::ATTACK,
    &recordings::NOMINAL,
    &recordings::URBAN,
];

/// Where a figure has to be.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Bound {
    /// Not above.
    AtMost(f64),
    /// Not below.
    AtLeast(f64),
    /// Printed only.
    Anywhere,
}

/// A number that came of an attack.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Figure {
    /// What it is, with its unit.
    pub quantity: String,
    /// How much.
    pub value: f64,
    /// Where it has to be.
    pub bound: Bound,
}

impl Figure {
    /// A figure that must not be above a number.
    pub fn at_most(quantity: impl Into<String>, value: f64, bound: f64) -> Self {
        Self { quantity: quantity.into(), value, bound: Bound::AtMost(bound) }
    }

    /// A figure that must not be below a number.
    pub fn at_least(quantity: impl Into<String>, value: f64, bound: f64) -> Self {
        Self { quantity: quantity.into(), value, bound: Bound::AtLeast(bound) }
    }

    /// A figure to be known.
    pub fn plain(quantity: impl Into<String>, value: f64) -> Self {
        Self { quantity: quantity.into(), value, bound: Bound::Anywhere }
    }

    /// Whether it is where it has to be; a number that is none is not.
    pub fn holds(&self) -> bool {
        match self.bound {
            Bound::AtMost(bound) => self.value <= bound,
            Bound::AtLeast(bound) => self.value >= bound,
            Bound::Anywhere => true,
        }
    }
}

/// What came of an attack.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Outcome {
    /// Its name.
    pub name: &'static str,
    /// What was tried.
    pub about: &'static str,
    /// What came of it.
    pub figures: Vec<Figure>,
}

impl Outcome {
    /// Whether the promise held.
    pub fn is_held(&self) -> bool {
        self.figures.iter().all(Figure::holds)
    }

    /// The figures in a line: those that do not hold marked, with their bounds.
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
    /// Tries it.
    ///
    /// # Errors
    /// What could not even be tried.
    pub fn attempt(&self, effort: Effort) -> Result<Outcome> {
        Ok(Outcome { name: self.name, about: self.about, figures: (self.run)(effort)? })
    }
}

/// As many digits as say something.
fn rounded(value: f64) -> String {
    match value.abs() {
        0.0 => "0".into(),
        size if size < 0.01 => format!("{value:.1e}"),
        size if size < 10.0 && value.fract() != 0.0 => format!("{value:.2}"),
        _ => format!("{value:.0}"),
    }
}
