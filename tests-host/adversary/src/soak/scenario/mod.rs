//! Scenario: the epochs with their incidents, and the mishaps of cable, module and host.
//!
//! | mishap | effect |
//! |---|---|
//! | unplugged | the cable is pulled in the middle of an epoch and plugged in again in the middle of another; meanwhile the line is silent or picks up noise |
//! | power-on | the module is reset in the middle of an epoch |
//! | rewind | the receiver's time goes back by some epochs and continues; its epochs are then late unless the host sends `FORGET`, as it does two times in three |
//! | unread | the host port is not read for some epochs |
//! | early ephemeris | before an epoch comes an ephemeris that a satellite in view will broadcast hours later |
//! | setting | the host sets another horizontal alert limit, another method, or the clock aiding |
//!
//! The receiver sends an ephemeris as soon as it knows it, and repeats a few in each epoch in turn.
//! A module that was reset has them again within a minute.

mod diary;
mod sending;

use anyhow::Result;
use raim::signal::encode::Selection;
use raim::signal::measurement::{MeasuredEpoch, TimedEphemeris};
use raim::signal::recording::Recording;
use raim_core::frame::Ecef;
use raim_core::satellite::SatelliteId;
use raim_firmware::time::GpsTime;
use rand::rngs::ChaCha8Rng;
use rand::seq::IndexedRandom;
use rand::{RngExt, SeedableRng};

use super::early;
use super::incident::{Falsified, Incidents};
use diary::{Diary, Recurring};
use sending::Sending;

/// Settings that the host changes in turn besides alert limits: every method, and the clock
/// forecast.
const SETTINGS: [&str; 10] = [
    "METHOD,BAARDA",
    "METHOD,SIMULTANEOUS",
    "METHOD,SEQUENTIAL",
    "METHOD,HYBRID",
    "METHOD,GROUPING",
    "METHOD,RANSAC",
    "METHOD,SEPARATION",
    "METHOD,AUTO",
    "CLOCKAID,ON",
    "CLOCKAID,OFF",
];

/// Largest number of noise bytes on an open line in the time of an epoch.
const OPEN_LINE_BYTES: usize = 400;

/// Number of epochs by which the receiver's time goes back: enough for the module to accept it in
/// the end.
const REWIND_EPOCHS: std::ops::RangeInclusive<usize> = 8..=20;

/// Pace of the epochs, and rate of incidents.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tempo {
    /// Time between two epochs by their time tags, s.
    pub step_s: f64,
    /// Time between two epochs on the board, ms.
    pub interval_ms: u64,
    /// Time to alert that the host sets, s.
    pub time_to_alert_s: f64,
    /// Horizontal alert limits that the host sets in turn, m, the lowest just above the protection
    /// levels. It starts with the first, which is so low that false ranges matter.
    pub alert_limits_m: [u32; 4],
    /// Mean number of epochs between two mishaps of one kind.
    pub calm_epochs: u32,
    /// Probability of each kind of disturbance of an epoch's bytes.
    pub disturbance: f64,
    /// Number of ephemerides that are repeated with each epoch.
    pub repeated_ephemerides: usize,
}

/// A stretch of epochs with everything needed to send them.
#[derive(Clone, Debug)]
pub struct Passage {
    /// Epochs and ephemerides.
    pub recording: Recording,
    /// Ephemerides that may come hours early.
    pub early: Vec<TimedEphemeris>,
    /// Signals to send.
    pub selection: Selection,
    /// Place of the antenna.
    pub truth: Ecef,
}

/// Known facts about an epoch that was sent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Offer {
    /// Time tag.
    pub time: GpsTime,
    /// Place of the antenna.
    pub truth: Ecef,
    /// Satellites with false ranges.
    pub falsified: Falsified,
    /// Horizontal error of a position from all satellites, on a good line, m.
    pub accepted_error_m: Option<f64>,
    /// Satellite whose early ephemeris precedes the epoch.
    pub early: Option<SatelliteId>,
    /// True if the whole epoch was sent, with a later time than all before.
    pub is_due: bool,
}

/// Mishap while an epoch is sent.
#[derive(Clone, Debug, PartialEq)]
pub enum Mishap {
    /// The module is reset after the first byte.
    PowerOn {
        /// Delay in board time, ms.
        after_ms: u64,
    },
    /// The host port is not read.
    Unread {
        /// Number of epochs.
        epochs: u32,
    },
    /// The host changes a setting: key and value of the command.
    Setting(String),
    /// The host requests all counters repeatedly.
    Questions {
        /// Number of commands.
        count: u32,
    },
}

/// Turn of one epoch.
#[derive(Clone, Debug, PartialEq)]
pub struct Turn {
    /// Facts about the epoch.
    pub offer: Offer,
    /// Bytes that reach the line, or noise that the open line picks up instead.
    pub bytes: Vec<u8>,
    /// Mishap during the epoch.
    pub mishap: Option<Mishap>,
}

/// State of a disconnected cable.
#[derive(Clone, Copy, Debug)]
struct Unplugged {
    epochs_left: u32,
    is_noisy: bool,
}

/// Source of the turns of a run.
pub struct Scenario {
    tempo: Tempo,
    rng: ChaCha8Rng,
    incidents: Incidents,
    diary: Diary,
    early: Recurring,
    early_rng: ChaCha8Rng,
    unplugged: Option<Unplugged>,
    turn: u32,
    latest: Option<GpsTime>,
    rewinds: u32,
    /// True if the host knows that time has gone back and will send `FORGET`.
    is_to_forget: bool,
}

impl Scenario {
    /// Returns a scenario whose random choices all follow from `seed`.
    pub fn new(tempo: Tempo, seed: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let calm = tempo.calm_epochs;
        let diary = Diary::new(calm, &mut rng);
        // Early ephemerides have their own generator, so that they change nothing else in a run.
        let mut early_rng = ChaCha8Rng::seed_from_u64(seed ^ 0xEA71);
        let early = Recurring::new(calm * 2, &mut early_rng);
        let incidents = Incidents::new(tempo.step_s, seed ^ 0x5EED);
        Self {
            tempo,
            rng,
            incidents,
            diary,
            early,
            early_rng,
            unplugged: None,
            turn: 0,
            latest: None,
            rewinds: 0,
            is_to_forget: false,
        }
    }

    /// Plays a passage. `play` receives each turn.
    ///
    /// # Errors
    /// If `play` fails, or an epoch cannot be encoded.
    pub fn perform(&mut self, passage: &Passage, mut play: impl FnMut(Turn) -> Result<()>) -> Result<()> {
        let mut sending = Sending::new(passage);
        let mut cursor = 0;
        while let Some(epoch) = passage.recording.epochs.get(cursor) {
            play(self.turn(epoch.clone(), &mut sending)?)?;
            cursor += 1;
            let back = self.rng.random_range(REWIND_EPOCHS);
            if cursor > back && self.diary.rewind.is_due(self.turn, &mut self.rng) {
                cursor -= back;
                self.rewinds += 1;
                self.is_to_forget = !self.rewinds.is_multiple_of(3);
            }
        }
        Ok(())
    }

    fn turn(&mut self, mut epoch: MeasuredEpoch, sending: &mut Sending<'_>) -> Result<Turn> {
        let falsified = self.incidents.befall(&mut epoch, f64::from(self.turn) * self.tempo.step_s);
        let sent = sending.bytes(&epoch, self.tempo.repeated_ephemerides)?;
        let (early, first) = self.early(&epoch, sending)?.unzip();
        let whole = [first.unwrap_or_default(), sent.clone()].concat();
        self.turn += 1;
        let is_later = self.latest.is_none_or(|latest| epoch.time > latest);
        self.latest = self.latest.max(Some(epoch.time));
        let bytes = self.through_the_cable(&whole);
        let is_due = is_later && bytes == whole;
        let mishap = if self.unplugged.is_none() { self.mishap() } else { None };
        let accepted = sending.accepter.receive(&sent, epoch.time.to_s(), &sending.site);
        let accepted_error_m = accepted.map(|accepted| accepted.horizontal_error_m);
        let truth = sending.passage.truth;
        let offer = Offer { time: epoch.time, truth, falsified, accepted_error_m, early, is_due };
        Ok(Turn { offer, bytes, mishap })
    }

    /// Returns an early ephemeris and its satellite, if one is due.
    fn early(
        &mut self,
        epoch: &MeasuredEpoch,
        sending: &Sending<'_>,
    ) -> Result<Option<(SatelliteId, Vec<u8>)>> {
        let sets = early::at(epoch, &sending.passage.early);
        if sets.is_empty() || !self.early.is_due(self.turn, &mut self.early_rng) {
            return Ok(None);
        }
        let set = sets.choose(&mut self.early_rng);
        set.map(|set| Ok((set.satellite, sending.frames(epoch, std::slice::from_ref(set))?))).transpose()
    }

    /// Cuts off the bytes sent while the cable is unplugged.
    fn through_the_cable(&mut self, whole: &[u8]) -> Vec<u8> {
        let at = self.rng.random_range(0..=whole.len());
        match self.unplugged {
            Some(Unplugged { epochs_left: 0, .. }) => {
                self.unplugged = None;
                whole[at..].to_vec()
            }
            Some(Unplugged { epochs_left, is_noisy }) => {
                self.unplugged = Some(Unplugged { epochs_left: epochs_left - 1, is_noisy });
                let length = if is_noisy { self.rng.random_range(0..OPEN_LINE_BYTES) } else { 0 };
                (0..length).map(|_| self.rng.random()).collect()
            }
            None if self.diary.unplug.is_due(self.turn, &mut self.rng) => {
                // The cable stays unplugged for half the time to alert up to three times as long.
                let limit = self.tempo.time_to_alert_s * 1e3 / self.tempo.interval_ms as f64;
                let epochs_left = (limit * self.rng.random_range(0.5..3.0)) as u32;
                self.unplugged = Some(Unplugged { epochs_left, is_noisy: self.rng.random() });
                whole[..at].to_vec()
            }
            None => whole.to_vec(),
        }
    }

    fn mishap(&mut self) -> Option<Mishap> {
        if std::mem::take(&mut self.is_to_forget) {
            return Some(Mishap::Setting("FORGET".to_owned()));
        }
        let (turn, rng) = (self.turn, &mut self.rng);
        if self.diary.power_on.is_due(turn, rng) {
            return Some(Mishap::PowerOn { after_ms: rng.random_range(0..self.tempo.interval_ms.min(1000)) });
        }
        if self.diary.unread.is_due(turn, rng) {
            return Some(Mishap::Unread { epochs: rng.random_range(5..=15) });
        }
        if self.diary.questions.is_due(turn, rng) {
            return Some(Mishap::Questions { count: rng.random_range(2..=10) });
        }
        if self.diary.setting.is_due(turn, rng) {
            let limits = self.tempo.alert_limits_m;
            let number = rng.random_range(0..limits.len() + SETTINGS.len());
            let limit = limits.get(number).map(|limit_m| format!("HAL,{limit_m}"));
            let setting = || SETTINGS[number - limits.len()].to_owned();
            return Some(Mishap::Setting(limit.unwrap_or_else(setting)));
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::soak::noise;
    use crate::soak::tally::RENEWAL_EPOCHS;
    use raim::signal::encode::Frequency;
    use raim::signal::sky::raw::Simulation;

    const TEMPO: Tempo = Tempo {
        step_s: 1.0,
        interval_ms: 1000,
        time_to_alert_s: 10.0,
        alert_limits_m: [25, 20, 40, 556],
        calm_epochs: 40,
        disturbance: 0.05,
        repeated_ephemerides: 2,
    };

    fn passage(epochs: u32) -> Passage {
        let simulation = Simulation::above_xian(3600.0, epochs, 2);
        let selection = Selection::new("GC", Frequency::Dual).unwrap();
        let early = early::of_sky(&simulation);
        Passage { recording: simulation.record(), early, selection, truth: simulation.site.position }
    }

    fn turns(passage: &Passage, seed: u64) -> Vec<Turn> {
        let mut turns = Vec::new();
        let mut scenario = Scenario::new(TEMPO, seed);
        scenario
            .perform(passage, |turn| {
                turns.push(turn);
                Ok(())
            })
            .unwrap();
        turns
    }

    #[test]
    fn the_same_seed_is_the_same_run_and_another_is_not() {
        let passage = passage(60);
        assert_eq!(turns(&passage, 1), turns(&passage, 1));
        assert_ne!(turns(&passage, 1), turns(&passage, 2));
    }

    #[test]
    fn every_mishap_comes_and_about_half_of_the_epochs_come_whole() {
        let passage = passage(600);
        let turns = turns(&passage, 1);
        let has =
            |wanted: fn(&Mishap) -> bool| turns.iter().filter_map(|turn| turn.mishap.as_ref()).any(wanted);
        assert!(has(|mishap| matches!(mishap, Mishap::PowerOn { .. })));
        assert!(has(|mishap| matches!(mishap, Mishap::Unread { .. })));
        assert!(has(|mishap| matches!(mishap, Mishap::Setting(_))));
        assert!(has(|mishap| matches!(mishap, Mishap::Questions { .. })));
        assert!(turns.iter().any(|turn| turn.bytes.is_empty()), "a silent line");
        assert!(turns.iter().any(|turn| turn.offer.early.is_some()), "an early ephemeris");
        assert!(turns.len() > passage.recording.epochs.len(), "time goes back, and is lived again");
        let due = turns.iter().filter(|turn| turn.offer.is_due).count();
        // A cable is unplugged for 17 epochs on average after 40 with the plug in, and 14 of 80
        // epochs are repeated.
        assert!(due * 5 > turns.len() * 2, "{due} of {} are due", turns.len());
    }

    #[test]
    fn every_satellite_in_sight_is_told_again_while_an_early_ephemeris_is_excused() {
        let passage = passage(RENEWAL_EPOCHS);
        let mut sending = Sending::new(&passage);
        // The first epoch carries all known ephemerides; the repeats begin with the second.
        let lumps: Vec<Vec<u8>> =
            passage.recording.epochs.iter().map(|epoch| sending.bytes(epoch, 2).unwrap()).collect();
        let seen = passage.recording.epochs[1].satellites.len();
        let mut told: Vec<&[u8]> = lumps[1..].iter().flat_map(|lump| noise::frames(lump)).collect();
        // An ephemeris has 488 or 511 bits, in 61 or 64 bytes with 6 around them.
        told.retain(|frame| frame.len() <= 70);
        told.sort_unstable();
        told.dedup();
        assert!(told.len() >= seen, "{} ephemerides of {seen} satellites", told.len());
    }
}
