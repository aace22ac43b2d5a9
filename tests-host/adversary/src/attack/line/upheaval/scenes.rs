//! Random scenes of a run; [`mod@super::run`] plays them.
//!
//! | part | choices |
//! |---|---|
//! | before a scene | nothing; silence; tags that leap ahead or back; a line that delays everything |
//! | the place | as before, 100 m to 1,000 km away, or back at the start of the run |
//! | ranges | right; one, two or three satellites wrong by 15 m to 2 km; all, anew in each epoch |
//! | satellites | all, or five to eight |
//! | the line | good; cuts an epoch in two and sends the second half with the next; loses bytes; sends everything twice |
//! | the host | nothing, or one command |

use rand::seq::SliceRandom as _;

use crate::attack::prelude::*;

/// Number of epochs of a scene.
const EPOCHS: std::ops::RangeInclusive<u32> = 2..=25;

/// Commands that the host may send.
const COMMANDS: [&str; 30] = [
    "FORGET",
    "FORGET",
    "FORGET",
    "METHOD,AUTO",
    "METHOD,BAARDA",
    "METHOD,SIMULTANEOUS",
    "METHOD,SEQUENTIAL",
    "METHOD,HYBRID",
    "METHOD,GROUPING",
    "METHOD,RANSAC",
    "METHOD,SEPARATION",
    "RECOVER,1,0",
    "RECOVER,3,3",
    "RECOVER,10,20",
    "RECOVER,5,0",
    "TTA,2",
    "TTA,10",
    "MASK,5",
    "MASK,20",
    "MASK,10",
    "FREQ,SINGLE",
    "FREQ,DUAL",
    "FREQ,AUTO",
    "NOISE,AUTO",
    "NOISE,CONSUMER",
    "CLOCKAID,ON",
    "CLOCKAID,OFF",
    "VMAX,30",
    "VMAX,515",
    "POLICY,TOP",
];

/// Event before a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Break {
    Nothing,
    /// The line is silent for this time, s.
    Silence(f64),
    /// Tags are off by this much from now on, s.
    Tags(f64),
    /// The line is silent for this time, s, and what follows is older by as much.
    HeldBack(f64),
    /// Tags are right again, and nothing is delayed.
    Right,
}

/// Error of the ranges.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Wrong {
    Nothing,
    /// This many satellites have a constant error.
    Some(usize),
    /// All satellites have an error, drawn anew in each epoch.
    All,
}

/// Effect of the line on the bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Line {
    Good,
    Halves,
    Lossy,
    Twice,
}

/// A stretch of epochs of one kind.
#[derive(Clone, Debug)]
pub(super) struct Scene {
    pub(super) command: Option<&'static str>,
    pub(super) before: Break,
    /// Place relative to the start: north and east, degrees.
    pub(super) place_deg: (f64, f64),
    pub(super) wrong: Wrong,
    pub(super) most_satellites: usize,
    pub(super) line: Line,
    pub(super) says_ephemerides: bool,
    pub(super) epochs: u32,
}

impl Scene {
    /// Returns a healthy scene.
    pub(super) fn quiet(place_deg: (f64, f64), epochs: u32) -> Self {
        Self {
            command: None,
            before: Break::Nothing,
            place_deg,
            wrong: Wrong::Nothing,
            most_satellites: usize::MAX,
            line: Line::Good,
            says_ephemerides: true,
            epochs,
        }
    }

    pub(super) fn by_chance(place_deg: (f64, f64), chance: &mut ChaCha8Rng) -> Self {
        Self {
            command: if chance.random_bool(0.4) { COMMANDS.choose(chance).copied() } else { None },
            before: Break::by_chance(chance),
            place_deg: next_place_deg(place_deg, chance),
            wrong: match chance.random_range(0..100) {
                0..60 => Wrong::Nothing,
                60..80 => Wrong::Some(1),
                80..87 => Wrong::Some(2),
                87..92 => Wrong::Some(3),
                _ => Wrong::All,
            },
            most_satellites: if chance.random_bool(0.2) { chance.random_range(4..=8) } else { usize::MAX },
            line: match chance.random_range(0..100) {
                0..60 => Line::Good,
                60..75 => Line::Halves,
                75..90 => Line::Lossy,
                _ => Line::Twice,
            },
            says_ephemerides: chance.random_bool(0.7),
            epochs: chance.random_range(EPOCHS),
        }
    }

    pub(super) fn site(&self) -> Site {
        let (north_deg, east_deg) = self.place_deg;
        Site::geodetic(34.17 + north_deg, 108.57 + east_deg, 400.0)
    }

    /// Returns the wrong satellites with their errors, m.
    pub(super) fn wrong_of(
        &self,
        epoch: Option<&MeasuredEpoch>,
        chance: &mut ChaCha8Rng,
    ) -> Vec<(SatelliteId, f64)> {
        let mut satellites = epoch.map_or(Vec::new(), MeasuredEpoch::satellites);
        satellites.truncate(self.most_satellites);
        satellites.shuffle(chance);
        match self.wrong {
            Wrong::Nothing => return Vec::new(),
            Wrong::Some(many) => satellites.truncate(many),
            Wrong::All => {}
        }
        satellites.into_iter().map(|satellite| (satellite, signed_size(15.0..2000.0, chance))).collect()
    }
}

impl Break {
    fn by_chance(chance: &mut ChaCha8Rng) -> Self {
        let whole_s = |chance: &mut ChaCha8Rng, most: f64| chance.random_range(0.0..most.ln()).exp().round();
        match chance.random_range(0..100) {
            0..45 => Self::Nothing,
            45..60 => Self::Silence(whole_s(chance, 1800.0)),
            60..68 => Self::Tags(whole_s(chance, 7200.0)),
            68..76 => Self::Tags(-whole_s(chance, 7200.0)),
            76..84 => Self::HeldBack(whole_s(chance, 100.0)),
            _ => Self::Right,
        }
    }
}

/// Draws the place of the next scene.
fn next_place_deg(place_deg: (f64, f64), chance: &mut ChaCha8Rng) -> (f64, f64) {
    const DEGREES_A_METRE: f64 = 9e-6;
    match chance.random_range(0..100) {
        0..60 => place_deg,
        60..75 => (0.0, 0.0),
        _ => {
            let away_deg = DEGREES_A_METRE * size(100.0..1e6, chance);
            let azimuth = chance.random_range(0.0..std::f64::consts::TAU);
            let (north_deg, east_deg) =
                (place_deg.0 + away_deg * azimuth.cos(), place_deg.1 + away_deg * azimuth.sin());
            (north_deg.clamp(-20.0, 20.0), east_deg.clamp(-20.0, 20.0))
        }
    }
}
