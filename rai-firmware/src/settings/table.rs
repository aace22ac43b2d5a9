//! Table of the settings: one row for each, from which everything else follows.
//!
//! | column | content |
//! |---|---|
//! | `"KEY" Setting` | the key on the wire, and its name here |
//! | `field: type = value` | the field of [`Configuration`], its type, and its value at start |
//! | `ranges` | lowest and highest value of each number, in the order in which a command has them |
//! | `unit` | unit of the numbers |
//! | `fields` | fields in `PRAIQ` |
//! | `promise` | true if a change withdraws a verdict of protected, which depends on it |
//! | `phase` | [`PhaseEffect`] |
//! | `warning` | text behind `OK,WARN` if the command is obeyed but unwise |
//! | `example` | values of a command that changes the setting from its start value |
//! | `text` | one line for INTERFACES.md, which a test compares |
//!
//! The order of the rows is that of `PRAIQ` and of the sealed commands. A phase therefore stands
//! before the settings that it changes.
//!
//! References: [IS-GPS-200] table 20-X for the range of the ionospheric coefficients.
//!
//! [IS-GPS-200]: crate#references

use raim_core::internals::integrity::raim::detection::threshold::policy::Policy;
use raim_core::internals::numeric::probability::Probability;
use raim_core::monitor::Method;
use raim_core::requirements::Requirements;

use super::ionosphere;
#[cfg(feature = "osnma")]
use super::keys::{Authentication, PublicKey, TreeRoot};
use super::kinds::{Baud, Frequencies, Heights, Levels, Noise, Recovery, SpoofFlag, Systems};
#[cfg(feature = "cnav")]
use super::l5::L5;
use super::place::{HEIGHT_M, PLACE_SIGMA_M, Place};
use super::promises::{Preset, Promises};
use super::row::settings;
use super::value::{Spelled, Value};
use super::{Phase, Refusal};
use crate::output::schedule::Schedule;

/// Row of a setting, as far as the image needs it.
#[non_exhaustive]
pub struct Row {
    /// Key on the wire.
    pub key: &'static str,
    /// Lowest and highest value of each number.
    pub ranges: &'static [(f64, f64)],
    /// True if a change withdraws a verdict of protected.
    pub bears_on_promise: bool,
    /// Effect on the phase, and of the phase.
    pub phase: PhaseEffect,
    /// Warning behind the answer to a change.
    pub(super) warning: fn(&Configuration) -> Option<&'static str>,
}

/// Text of a setting for its readers.
#[non_exhaustive]
pub struct Documentation {
    /// One line of INTERFACES.md.
    pub text: &'static str,
    /// Unit of the numbers.
    pub unit: &'static str,
    /// Fields in `PRAIQ`.
    pub fields: &'static str,
    /// Values of a command that changes the setting from its start value.
    pub example: &'static str,
    /// Words that a value may be.
    pub words: &'static [&'static str],
}

/// Effect of a setting on the phase, and of the phase on a setting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PhaseEffect {
    /// No effect.
    Apart,
    /// The setting is the phase: the numbers of a named one come with it.
    Enters,
    /// The number belongs to a phase: set by itself, it makes the phase `CUSTOM`.
    Leaves,
    /// The phase bounds the number.
    Bounded,
}

/// Requirements at start.
const NPA: Requirements = Requirements::non_precision_approach();

/// Alert limits, m: `PRAIS` has room for five digits before the point.
const LIMIT_M: (f64, f64) = (0.1, 99_999.9);

const fn nothing(_: &Configuration) -> Option<&'static str> {
    None
}

settings! {
    "PHASE" Phase {
        phase: Phase = Phase::NonPrecisionApproach,
        ranges: &[],
        unit: "",
        fields: "word",
        promise: true,
        phase: Enters,
        warning: Configuration::warning,
        example: "LPV200",
        text: "Phase of flight. It sets `HAL`, `VAL`, `PFA`, `PMD`, `PFF` and `TTA`: `ENROUTE` (HAL 3704 m), `TERMINAL` (1852 m), `NPA` (556 m), `LPV200` (HAL 40 m, VAL 35 m). `CUSTOM` keeps the present numbers. In `CUSTOM`, ARAIM spends its risk as in `LPV200` if `VAL` is set, else as in `NPA`. ARAIM's limits of 15 m for the effective monitor threshold and 1.87 m for accuracy hold in `LPV200` alone",
    }
    "HAL" HorizontalAlertLimit {
        hal_m: f64 = NPA.hal_m,
        ranges: &[LIMIT_M],
        unit: "m",
        fields: "m",
        promise: true,
        phase: Leaves,
        warning: Configuration::warning,
        example: "40",
        text: "Horizontal alert limit. Set by itself, it makes the phase `CUSTOM`",
    }
    "VAL" VerticalAlertLimit {
        val_m: Option<f64> = NPA.val_m,
        ranges: &[LIMIT_M],
        unit: "m",
        fields: "m; empty if it is off",
        promise: true,
        phase: Leaves,
        warning: nothing,
        example: "35.5",
        text: "Vertical alert limit; `OFF` if only the horizontal position matters. Set by itself, it makes the phase `CUSTOM`",
    }
    "PFA" FalseAlarm {
        false_alarm: Probability = NPA.false_alarm,
        ranges: &[(0.0, 0.5)],
        unit: "",
        fields: "probability, with exponent: `3.33e-7`",
        promise: true,
        phase: Leaves,
        warning: nothing,
        example: "1e-4",
        text: "Probability of a false alarm: 5e-3, 1e-3, 1e-4, 6.666666667e-5 (1/15000), 1e-5, 3.33e-7, 1e-7 or 1e-8; another one is refused with the nearest. Set by itself, it makes the phase `CUSTOM`",
    }
    "PMD" MissedDetection {
        missed_detection: Probability = NPA.missed_detection,
        ranges: &[(0.0, 0.5)],
        unit: "",
        fields: "the same",
        promise: true,
        phase: Leaves,
        warning: nothing,
        example: "1e-4",
        text: "Probability of a missed detection: 1e-3, 1e-4, 1e-5 or 1e-6; another one is refused with the nearest. Set by itself, it makes the phase `CUSTOM`",
    }
    "PFF" FaultFree {
        fault_free_risk: Probability = NPA.fault_free_risk,
        // Beyond these limits, no sigma is known for the levels, or the levels bound nothing.
        ranges: &[(1e-12, 1e-2)],
        unit: "",
        fields: "the same",
        promise: true,
        phase: Apart,
        warning: nothing,
        example: "1e-6",
        text: "Probability that the error exceeds a protection level of `LEVELS,BOUND` without any fault",
    }
    "TTA" TimeToAlert {
        time_to_alert_s: f64 = NPA.time_to_alert_s,
        ranges: &[(0.1, 3600.0)],
        unit: "s",
        fields: "s",
        promise: true,
        phase: Bounded,
        warning: nothing,
        example: "9.5",
        text: "Time to alert. The phase bounds it: 60 s in `ENROUTE`, 30 s in `TERMINAL`, 10 s in `NPA`, 6 s in `LPV200`, 3600 s in `CUSTOM`",
    }
    "POLICY" Policy {
        policy: Policy = Policy::T1,
        ranges: &[],
        unit: "",
        fields: "word",
        promise: true,
        phase: Apart,
        warning: Configuration::warning,
        example: "T2",
        text: "Threshold of the test: `T1` follows from P<sub>fa</sub>, `T2` from P<sub>md</sub>, `TOP` is the least cost of both. `T2` and `TOP` hardly ever alarm at limits of 556 m and more, which theory predicts; the answer warns of it",
    }
    "METHOD" Method {
        method: Method = Method::Auto,
        ranges: &[],
        unit: "",
        fields: "word",
        promise: true,
        phase: Apart,
        warning: nothing,
        example: "BAARDA",
        text: "Search for faulty satellites. `AUTO` tries every set of up to three satellites if that is within its budget of work, else it takes the largest w-test, which also finds errors of tens of kilometres under every method. `BAARDA` takes the largest w-test. `SIMULTANEOUS`, `SEQUENTIAL`, `HYBRID` and `GROUPING` search in parity space, `RANSAC` by consensus, `SEPARATION`, also called `ARAIM`, by separation of solutions",
    }
    "LEVELS" Levels {
        levels: Levels = Levels::Bound,
        ranges: &[],
        unit: "",
        fields: "word",
        promise: true,
        phase: Apart,
        warning: nothing,
        example: "SLOPE",
        text: "Error that protection levels hold: `BOUND` holds fault and noise together, with the fault-free risk `PFF`; `SLOPE` is the level of the papers",
    }
    "SYSTEMS" Systems {
        systems: Systems = Systems::AT_START,
        ranges: &[],
        unit: "",
        fields: "letters, in the order G, R, E, C, J",
        promise: true,
        phase: Apart,
        warning: nothing,
        example: "GE",
        text: "Letters of the systems that take part, each once: G for GPS, R for GLONASS (ARAIM's levels grow by it), E for Galileo, C for BeiDou, J for QZSS",
    }
    "MASK" Mask {
        // Below 10° the atmosphere's error grows faster than the geometry gains.
        mask_deg: f64 = 10.0,
        // Above 60° no position is left.
        ranges: &[(0.0, 60.0)],
        unit: "°",
        fields: "degrees",
        promise: true,
        phase: Apart,
        warning: nothing,
        example: "5",
        text: "Elevation mask",
    }
    "CLOCKAID" ClockAid {
        clock_aid: bool = false,
        ranges: &[],
        unit: "",
        fields: "word",
        promise: true,
        phase: Apart,
        warning: nothing,
        example: "ON",
        text: "`ON` adds a forecast of the receiver clock as a row to those of the satellites",
    }
    "CN0MASK" SignalMask {
        signal_mask_db_hz: f64 = 20.0,
        // No receiver shows more than this in the open.
        ranges: &[(0.0, 55.0)],
        unit: "dB-Hz",
        fields: "dB-Hz",
        promise: true,
        phase: Apart,
        warning: nothing,
        example: "30",
        text: "Least C/N0 of a signal. A signal without C/N0 counts as being that weak, or as one of 28 dB-Hz, if other signals of the epoch have one",
    }
    "VMAX" GreatestSpeed {
        greatest_speed_m_s: f64 = 515.0,
        // From a walk to an orbit around the earth.
        ranges: &[(1.0, 10_000.0)],
        unit: "m/s",
        fields: "m/s",
        promise: true,
        phase: Apart,
        warning: nothing,
        example: "100",
        text: "Greatest speed of the antenna",
    }
    "HEIGHT" Heights {
        heights: Heights = Heights { least_m: -500.0, greatest_m: 20_000.0 },
        ranges: &[HEIGHT_M, HEIGHT_M],
        unit: "m",
        fields: "least and greatest, m",
        promise: true,
        phase: Apart,
        warning: nothing,
        example: "-499,9000",
        text: "Least and greatest height of the antenna above the ellipsoid; the least is below the greatest",
    }
    "RECOVER" Recovery {
        recovery: Recovery = Recovery { epochs: 3, seconds: 3.0 },
        ranges: &[(1.0, 100.0), (0.0, 600.0)],
        unit: "epochs, s",
        fields: "epochs, s",
        promise: true,
        phase: Apart,
        warning: nothing,
        example: "4,3",
        text: "Epochs and seconds for which satellites must agree after an alert. `STALE` needs none, because nothing spoke against them. Epochs up to 15 minutes apart go on with each other, whatever `TTA`",
    }
    "FREQ" Frequencies {
        frequencies: Frequencies = Frequencies::Auto,
        ranges: &[],
        unit: "",
        fields: "word",
        promise: true,
        phase: Apart,
        warning: nothing,
        example: "DUAL",
        text: "Ranges of satellites with two frequencies: `DUAL` combines them free of the ionosphere, `SINGLE` takes one with a model of the ionosphere, `AUTO` takes the set of ranges with the smaller levels",
    }
    "NOISE" Noise {
        noise: Noise = Noise::Auto,
        ranges: &[],
        unit: "",
        fields: "word",
        promise: true,
        phase: Apart,
        warning: nothing,
        example: "CONSUMER",
        text: "Noise and multipath of the receiver with its antenna, of one frequency at the zenith: `GEODETIC` 0.4 m, `CONSUMER` 1.5 m, `PHONE` 5 m. `AUTO` is `GEODETIC`, and down to a third of it after ten quiet minutes at rest, but not under `METHOD,SEPARATION`. Larger residuals raise it at once, whatever the choice. `SIGMA,ADAPT` and `SIGMA,FIXED`, its old words, are `AUTO` and `GEODETIC`",
    }
    "BAUD" Baud {
        bit_rate: Baud = Baud::Auto,
        ranges: &[],
        unit: "bit/s",
        fields: "bit/s, or `AUTO`",
        promise: false,
        phase: Apart,
        warning: nothing,
        example: "9600",
        text: "Bit rate of the GNSS port; `AUTO` finds it out",
    }
    "IONO" Ionosphere {
        klobuchar: Option<[f64; 8]> = None,
        ranges: &ionosphere::RANGES,
        unit: "as broadcast",
        fields: "α0 to α3 and β0 to β3 as broadcast; or `AUTO` and seven empty fields",
        promise: true,
        phase: Apart,
        warning: nothing,
        example: "1e-8,0,0,0,0,0,0,0",
        text: "Eight Klobuchar coefficients as broadcast, α0 to α3 and β0 to β3, not all zero; `AUTO` takes those that the satellites broadcast",
    }
    "OUTPUT" Output {
        outputs: Schedule = Schedule::AT_START,
        ranges: &[(0.0, 255.0)],
        unit: "epochs",
        fields: "every how many epochs: `RMC`, `GGA`, `GNS`, `VTG`, `ZDA`, `GSA`, `GST`, `GBS`, `GSV`, `HEARTBEAT`, `GPS_INPUT`, `GNSS_INTEGRITY`",
        promise: false,
        phase: Apart,
        warning: nothing,
        example: "GBS,3",
        text: "Sentence or message by its name, and every how many epochs it is sent (0 for never). All of them also go with an epoch whose state is worse than that before",
    }
    "ISM" Support {
        promises: Promises = Promises::preset(Preset::Icao),
        ranges: &Promises::RANGES,
        unit: "m, m, m, –, –",
        fields: "the preset; then URA, URE, b_nom in m, P_sat and P_const of G, C, E and R in this order, empty where the preset's count",
        promise: true,
        phase: Apart,
        warning: Configuration::warning_of_promises,
        example: "G,2.4,2.4,0,1e-5,1e-4",
        text: "Integrity support of the satellites, for `SEPARATION`, by a preset; those that end in `-AIR` have the noise of an airborne antenna. Or that of one system until the next preset: `ISM,G,URA,URE,b_nom,P_sat,P_const` with the letter G, R, E or C, and probabilities of 0 or within the range. A fault so unlikely that nothing watches for it is an alert where the global test sees it",
    }
    "SPOOFFLAG" Spoofing {
        spoof_flag: SpoofFlag = SpoofFlag::Hold,
        ranges: &[],
        unit: "",
        fields: "word",
        promise: true,
        phase: Apart,
        warning: nothing,
        example: "SAY",
        text: "The receiver's own report of spoofing: `HOLD` takes the promise back while the receiver is sure of it and for 10 s after a second of certainty, or, within a minute of the onset of a suspicion, for 10 s after `CLOCK`, `JUMP`, `TIME`, `TRACK`, alike signal strengths, or `AMBIGUOUS` with five or more degrees of freedom; `SAY` only reports it",
    }
    "PLACE" FixedPlace {
        place: Option<Place> = None,
        ranges: &[(-90.0, 90.0), (-180.0, 180.0), HEIGHT_M, PLACE_SIGMA_M],
        unit: "°, °, m, m",
        fields: "latitude, longitude, height and standard deviation; or `OFF` and three empty fields",
        promise: true,
        phase: Apart,
        warning: nothing,
        example: "55.49,8.45,63.2,1",
        text: "Place of a fixed antenna: latitude, longitude, height above the ellipsoid and standard deviation, which counts as at least 3 m. Its height adds a row to those of the satellites, unless `HEIGHTAID` sets one. A position that is farther from the place than its level and 5.33 standard deviations is not promised (`PLACE`). `OFF` for an antenna that may move",
    }
    #[cfg(feature = "cnav")]
    "L5" HealthOfL5 {
        l5: L5 = L5::Tracked,
        ranges: &[],
        unit: "",
        fields: "`L5` and its word; no field at all at start",
        promise: true,
        phase: Apart,
        warning: nothing,
        example: "HEALTHY",
        text: "Use of L5 of GPS and QZSS: `TRACKED` wherever the receiver measures it, `HEALTHY` only where the satellite's own CNAV calls it healthy, which no GPS satellite does yet; GPS then falls back to L1/L2 or L1. `SEPARATION` with a preset `ICAO` or `ICAO-AIR` is always as `HEALTHY`. Alerts of CNAV, and its health of L1 and L2, count always",
    }
    #[cfg(feature = "osnma")]
    "KEY" OwnKey {
        own_key: Option<PublicKey> = None,
        ranges: &[(1.0, 15.0)],
        unit: "",
        fields: "none if it is off; else `KEY`, the number and four bytes behind the first in hexadecimal digits",
        promise: true,
        phase: Apart,
        warning: nothing,
        example: "1,0374A925CFA0FF1805E5C5A58FDBA31BF0145D5B5BE2F062D3F8BB2EE98F0F6DB0",
        text: "Public key of OSNMA: its number (PKID) and the point of P-256 in 33 bytes, compressed, in hexadecimal digits, in one field or several. The GNSS Service Centre publishes it; the module brings none. A command discards all verdicts",
    }
    #[cfg(feature = "osnma")]
    "ROOT" OwnRoot {
        own_root: Option<TreeRoot> = None,
        ranges: &[],
        unit: "",
        fields: "none if it is off; else `ROOT` and the first four bytes",
        promise: true,
        phase: Apart,
        warning: nothing,
        example: "832E15EDE55655EAC6E399A539477B7C034CCE24C3C93FFC904ACD9BF842F04E",
        text: "Root of the Merkle tree of OSNMA, 32 bytes in hexadecimal digits, which proves new keys and the system's alert. Without it a new key takes a new `KEY`",
    }
    #[cfg(feature = "osnma")]
    "AUTH" Authenticated {
        authentication: Authentication = Authentication::Say,
        ranges: &[],
        unit: "",
        fields: "none if it is `SAY`; else `AUTH` and the word",
        promise: true,
        phase: Apart,
        warning: Configuration::warning_of_keys,
        example: "PREFER",
        text: "What follows from OSNMA: `OFF` checks nothing; `SAY` reports (`PRAIO`); `PREFER` leaves out a satellite whose ephemeris is false, and alerts (`AUTH`) if that or a wrong key concerns two satellites within 5 minutes, and lets proved Galileo decide where systems contradict each other (`SYSTEM`); `ONLY` also leaves out each Galileo satellite whose ephemeris is not proved, and promises nothing with fewer than four that are (`UNPROVED`). Proved takes a time by `TRUST`. It authenticates ephemerides, not the position",
    }
    #[cfg(test)]
    "TOY" Toy {
        toy: super::toy::Toy = super::toy::Toy::AT_START,
        ranges: &[(0.0, 9.0)],
        unit: "",
        fields: "digit",
        promise: true,
        phase: Apart,
        warning: nothing,
        example: "7",
        text: "Number of a setting that only unit tests have",
    }
}

impl Setting {
    /// Returns the setting with this key.
    pub fn named(key: &str) -> Option<Self> {
        let key = if key == "SIGMA" { "NOISE" } else { key };
        Self::ALL.iter().copied().find(|setting| setting.row().key == key)
    }

    /// Returns the key on the wire.
    pub const fn key(self) -> &'static str {
        self.row().key
    }
}

impl Configuration {
    /// Returns the settings with one changed by a command of this key and these values.
    ///
    /// # Errors
    /// [`Refusal`] states why there are no such settings.
    pub fn with<'v>(self, key: &str, values: impl Iterator<Item = &'v str>) -> Result<Self, Refusal> {
        let mut values = values;
        let setting = Setting::named(key).ok_or(Refusal::UnknownKey)?;
        self.changed(setting, &mut values)
    }
}
