//! One run: its receiver, its sky, and its scenes from the first to the quiet ones at the end.
//!
//! A run has one format, one set of systems and bands, and one time between epochs. The oracle
//! learns the content, time and place of each epoch before the module receives it.

use raim::signal::encode::ubx;

use super::oracle::{Finding, Oracle, Sent};
use super::scenes::{Break, Line, Scene, Wrong};
use crate::attack::prelude::*;
use crate::soak::noise::frames;

/// Number of scenes of a run.
const SCENES: std::ops::RangeInclusive<usize> = 6..=14;

/// Time between the epochs of a slow receiver, s: below the time to alert, and above it.
const SLOW_S: [f64; 2] = [5.0, 30.0];

/// Healthy epochs at the end: more than the 130 s for which rates must agree after a contradiction.
const QUIET_EPOCHS: u32 = 250;

/// Seconds of agreement after a leap of the clock.
const AGREEMENT_S: f64 = 30.0;

/// Largest distance between two fixes of one place, m. Scenes at different places are at least 100 m apart.
const SAME_PLACE_M: f64 = 50.0;

/// Healthy epochs after `FORGET`: each scene has a clock of its own, which may leap, and 130 s must
/// agree after that.
const FORGOTTEN_EPOCHS: u32 = 150;

/// Leap seconds: time tags are in GPS time, sentences in UTC.
const GPS_MINUS_UTC_S: f64 = 18.0;

/// Length of a day, s.
const DAY_S: f64 = 86_400.0;

/// Time of day around which runs start, s: far enough from midnight for all leaps.
const NOON_S: f64 = 43_200.0;

/// Wire format of the receiver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Rtcm,
    Ubx,
}

/// One run.
pub(super) struct Run {
    chance: ChaCha8Rng,
    format: Format,
    selection: Selection,
    /// Simulated sky, of which each scene is a part.
    sky: Simulation,
    /// Time of day at which the module started, s, and lead of the tags over it, s.
    start_s: f64,
    ahead_s: f64,
    victim: Victim,
    oracle: Oracle,
    /// True once tags have been ahead. Right tags are then late until `FORGET`, like a replayed
    /// recording.
    was_ahead: bool,
    /// Places of the scenes so far, degrees. After a silence a place must agree for as long as the
    /// way to it takes at `VMAX`.
    places_deg: Vec<(f64, f64)>,
    /// Second half of an epoch that the line holds back.
    kept: Vec<u8>,
    is_told: bool,
}

impl Run {
    /// Returns the run of a seed. If `is_told` is set, the run prints its events.
    ///
    /// # Errors
    /// If the module cannot start.
    pub(super) fn of(seed: u64, is_told: bool) -> Result<Self> {
        let mut chance = ChaCha8Rng::seed_from_u64(seed);
        let (letters, fleets) = [GPS, GPS_BEIDOU, GPS_GALILEO][chance.random_range(0..3)];
        let frequency = if chance.random_bool(0.7) { Frequency::Dual } else { Frequency::Single };
        let sky = Simulation {
            satellites: satellites(fleets),
            has_range_rates: chance.random(),
            step_s: if chance.random_bool(0.85) { 1.0 } else { SLOW_S[chance.random_range(0..SLOW_S.len())] },
            ..Simulation::above_xian(NOON_S, 1, seed)
        };
        let format = if chance.random() { Format::Rtcm } else { Format::Ubx };
        let victim = Victim::new(&[], sky.step_s)?;
        Ok(Self {
            format,
            selection: Selection::new(letters, frequency)?,
            // Each run has its own hour, because skies differ.
            start_s: NOON_S + 600.0 * f64::from(chance.random_range(-18..18_i32)),
            ahead_s: 0.0,
            chance,
            sky,
            victim,
            oracle: Oracle::new(seed),
            was_ahead: false,
            places_deg: vec![(0.0, 0.0)],
            kept: Vec::new(),
            is_told,
        })
    }

    /// Plays the run to its end.
    ///
    /// # Errors
    /// If an epoch cannot be encoded or a sentence cannot be read.
    pub(super) fn play(mut self) -> Result<Oracle> {
        self.scene(&Scene::quiet((0.0, 0.0), 15))?;
        let mut place_deg = (0.0, 0.0);
        for _ in 0..self.chance.random_range(SCENES) {
            let scene = Scene::by_chance(place_deg, &mut self.chance);
            place_deg = scene.place_deg;
            self.places_deg.push(place_deg);
            self.scene(&scene)?;
        }
        self.scene(&Scene { before: Break::Right, ..Scene::quiet(place_deg, QUIET_EPOCHS) })?;
        self.expect_promise("in the end", false);
        let forget = Scene { command: Some("FORGET"), ..Scene::quiet(place_deg, FORGOTTEN_EPOCHS) };
        self.scene(&forget)?;
        self.expect_promise("after FORGET", true);
        Ok(self.oracle)
    }

    /// Checks that healthy epochs are promised, unless the levels or the satellites do not meet the
    /// settings, or the receiver has leapt: what is not its usual place stays an alert for an hour.
    fn expect_promise(&mut self, when: &str, is_forgotten: bool) {
        const EXCUSES: [&str; 7] = ["HPL", "VPL", "EMT", "ACCURACY", "RISK", "REDUNDANCY", "GEOMETRY"];
        let last = self.oracle.last_reason.clone();
        let quiet_s = f64::from(QUIET_EPOCHS) * self.sky.step_s;
        let last_deg = self.places_deg.last().copied().unwrap_or_default();
        let longest_m = self.places_deg.iter().map(|place| way_m(*place, last_deg)).fold(0.0, f64::max);
        let is_on_its_way = longest_m > self.oracle.max_speed_m_s * (quiet_s - AGREEMENT_S);
        let is_excused = EXCUSES.contains(&last.as_str())
            || !is_forgotten
                && (self.was_ahead
                    || last == "JUMP"
                    || longest_m > SAME_PLACE_M && last == "TRACK"
                    || is_on_its_way && last == "RECOVERING");
        if !self.oracle.has_promised_last && !is_excused {
            self.oracle.find(Finding::Lost, self.victim.now_s(), &format!("{last} {when}"));
        }
    }

    fn scene(&mut self, scene: &Scene) -> Result<()> {
        if self.is_told {
            println!("{:8.1} s  {scene:?}", self.victim.now_s());
        }
        self.command(scene)?;
        self.begin(scene)?;
        self.oracle.begin();
        let stretch = Simulation {
            site: scene.site(),
            start_s: self.start_s + self.victim.now_s() + self.ahead_s,
            epochs: scene.epochs,
            seed: self.chance.random(),
            ..self.sky.clone()
        };
        let recording = stretch.record();
        let reported: &[TimedEphemeris] = if scene.says_ephemerides { &recording.ephemerides } else { &[] };
        let mut encode = encoder(self.format, reported, self.selection.clone());
        let mut wrong = scene.wrong_of(recording.epochs.first(), &mut self.chance);
        for mut epoch in recording.epochs {
            epoch.satellites.truncate(scene.most_satellites);
            if scene.wrong == Wrong::All {
                wrong = scene.wrong_of(Some(&epoch), &mut self.chance);
            }
            for &(satellite, by_m) in &wrong {
                epoch.lengthen(satellite, by_m);
            }
            self.oracle.offer(Sent {
                time_of_day_s: utc_of_day_s(epoch.time),
                own_s: self.victim.now_s(),
                place: stretch.site.position,
                wrong: wrong.len(),
            });
            self.send(encode(&epoch)?, scene.line, stretch.site.position)?;
        }
        Ok(())
    }

    fn command(&mut self, scene: &Scene) -> Result<()> {
        let Some(command) = scene.command else { return Ok(()) };
        if self.victim.obey(command)?.contains(",OK") {
            self.oracle.command(command);
        }
        Ok(())
    }

    /// Applies the break before a scene.
    fn begin(&mut self, scene: &Scene) -> Result<()> {
        let silent_s = match scene.before {
            Break::Silence(for_s) | Break::HeldBack(for_s) => for_s,
            _ => 0.0,
        };
        match scene.before {
            Break::Nothing | Break::Silence(_) => {}
            Break::Tags(by_s) => self.ahead_s = by_s,
            Break::HeldBack(for_s) => self.ahead_s -= for_s,
            Break::Right => self.ahead_s = 0.0,
        }
        self.was_ahead |= self.ahead_s > 0.0;
        if silent_s > 0.0 {
            let seen = self.victim.silence(silent_s, Ecef::CENTRE)?;
            let own_s = self.victim.now_s();
            for seen in &seen {
                self.oracle.receive(seen, own_s);
            }
        }
        Ok(())
    }

    /// Sends an epoch through the line.
    fn send(&mut self, mut bytes: Vec<u8>, line: Line, place: Ecef) -> Result<()> {
        match line {
            Line::Good => {}
            Line::Halves => {
                let at = self.chance.random_range(0..bytes.len());
                // The cut is between two frames, or within one, which is then lost.
                let mut between = 0;
                for frame in frames(&bytes) {
                    between += if between + frame.len() <= at { frame.len() } else { 0 };
                }
                let second = bytes.split_off(if self.chance.random() { at } else { between });
                bytes.splice(..0, std::mem::replace(&mut self.kept, second));
            }
            Line::Lossy => {
                let from = self.chance.random_range(0..bytes.len());
                let to = (from + self.chance.random_range(1..300)).min(bytes.len());
                if self.chance.random_bool(0.3) {
                    bytes.drain(from..to);
                }
            }
            Line::Twice => bytes.extend_from_within(..),
        }
        if line != Line::Halves && !self.kept.is_empty() {
            bytes.splice(..0, std::mem::take(&mut self.kept));
        }
        let own_s = self.victim.now_s();
        for seen in self.victim.receive(&bytes, place)? {
            if self.is_told {
                let Seen { reported, horizontal_error_m, vertical_error_m, .. } = &seen;
                let state = &reported.state;
                println!(
                    "{own_s:10.1}   {} {} {} of {}, {} left out, levels {:?} {:?}, errors {horizontal_error_m:.1} {vertical_error_m:.1} m",
                    state.state,
                    state.reason,
                    state.used,
                    state.tracked,
                    reported.excluded.len(),
                    state.hpl_m,
                    state.vpl_m,
                );
            }
            self.oracle.receive(&seen, own_s);
        }
        Ok(())
    }
}

/// Returns the time of day of an epoch as a sentence gives it, s.
fn utc_of_day_s(time: GpsTime) -> f64 {
    (time.to_s() - GPS_MINUS_UTC_S).rem_euclid(DAY_S)
}

/// Encodes an epoch.
type Encode = Box<dyn FnMut(&MeasuredEpoch) -> Result<Vec<u8>>>;

/// Returns an encoder of either format.
fn encoder(format: Format, ephemerides: &[TimedEphemeris], selection: Selection) -> Encode {
    match format {
        Format::Rtcm => {
            let mut encoder = Encoder::new(ephemerides, selection);
            Box::new(move |epoch| encoder.epoch(epoch))
        }
        Format::Ubx => {
            let mut encoder = ubx::Encoder::new(ephemerides, selection, None);
            Box::new(move |epoch| encoder.epoch(epoch))
        }
    }
}

/// Returns the length of the way between two places, m.
fn way_m(from_deg: (f64, f64), to_deg: (f64, f64)) -> f64 {
    const M_PER_DEG: f64 = 111_320.0;
    M_PER_DEG * (to_deg.0 - from_deg.0).hypot(to_deg.1 - from_deg.1)
}
