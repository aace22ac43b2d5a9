//! A stream with the ephemerides of more satellites than the store holds, such as a caster's or a
//! merged file's. Satellites in view keep their sets, in whatever order the systems come, and no
//! system makes levels worse.

use std::collections::BTreeMap;

use adversary::attack::victim::{Seen, Victim};
use raim::signal::encode::{Encoder, Frequency, Selection};
use raim::signal::measurement::{Ephemeris, MeasuredEpoch, TimedEphemeris};
use raim::signal::recording::Recording;
use raim::signal::sky::Fleet;
use raim::signal::sky::raw::Simulation;
use raim_core::satellite::SatelliteId;
use raim_firmware::ephemeris::CAPACITY;
use raim_firmware::time::GpsTime;
use rig::stations::{ESBC, Station, TLSE};

/// Distribution of a caster's sets over the time until they come again.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Pace {
    /// Even over the time.
    Even,
    /// All at once, before the ranges of an epoch.
    Burst,
}

/// Caster that sends the newest set of every satellite of the world, system by system, repeatedly.
struct Caster {
    /// Time and message of each set, by satellite, in the order of the systems.
    satellites: Vec<Vec<(GpsTime, Vec<u8>)>>,
    period_s: usize,
    pace: Pace,
}

impl Caster {
    fn new(ephemerides: &[TimedEphemeris], order: &str, period_s: usize, pace: Pace) -> Self {
        let mut by_satellite: BTreeMap<SatelliteId, Vec<(GpsTime, Vec<u8>)>> = BTreeMap::new();
        let no_fnav = |set: &&TimedEphemeris| !matches!(set.message, Ephemeris::GalileoFnav(_));
        for set in ephemerides.iter().filter(no_fnav) {
            by_satellite.entry(set.satellite).or_default().push((set.sent, message(set)));
        }
        for sets in by_satellite.values_mut() {
            sets.sort_by_key(|(sent, _)| *sent);
        }
        let of_system = |letter| by_satellite.iter().filter(move |(id, _)| id.name().0 == letter);
        let satellites = order.chars().flat_map(of_system).map(|(_, sets)| sets.clone()).collect();
        Self { satellites, period_s, pace }
    }

    /// Returns the sets that are due in a second, of a number of seconds.
    fn due(&self, second: usize, seconds: usize, now: GpsTime) -> Vec<u8> {
        let many = self.satellites.len();
        let (from, due) = match self.pace {
            Pace::Burst if second.is_multiple_of(self.period_s) => (0, many),
            Pace::Burst => (0, 0),
            Pace::Even => {
                let due = (many * seconds).div_ceil(self.period_s).min(many);
                (second % self.period_s * many / self.period_s, due)
            }
        };
        let newest = |sets: &[(GpsTime, Vec<u8>)]| {
            let sent = sets.partition_point(|(sent, _)| *sent <= now);
            sets.get(sent.checked_sub(1)?).map(|(_, bytes)| bytes.clone())
        };
        (from..from + due).filter_map(|index| newest(&self.satellites[index % many])).flatten().collect()
    }
}

/// Returns the message of one set.
fn message(set: &TimedEphemeris) -> Vec<u8> {
    let letter = set.satellite.name().0.to_string();
    let selection = Selection::new(&letter, Frequency::Dual).unwrap();
    let nothing = MeasuredEpoch { time: set.sent, satellites: Vec::new() };
    let bytes = Encoder::new(std::slice::from_ref(set), selection).epoch(&nothing).unwrap();
    let length = 6 + (usize::from(bytes[1]) << 8 | usize::from(bytes[2]));
    bytes[..length].to_vec()
}

/// Output of the module for each epoch: levels, and the number of satellites without an ephemeris.
#[derive(Debug, Default)]
struct Outcome {
    seen: Vec<Seen>,
    /// Number of satellites without an ephemeris, epoch by epoch.
    missing: Vec<u32>,
    displaced: u32,
}

impl Outcome {
    fn protected(&self) -> usize {
        self.seen.iter().filter(|seen| seen.reported.state.is_protected()).count()
    }

    fn vpl_m(&self, epoch: usize) -> f64 {
        self.seen[epoch].reported.state.vpl_m.unwrap_or(f64::INFINITY)
    }

    fn hpl_m(&self, epoch: usize) -> f64 {
        self.seen[epoch].reported.state.hpl_m.unwrap_or(f64::INFINITY)
    }

    /// Returns the mean of the vertical level over protected epochs, m.
    fn mean_vpl_m(&self) -> f64 {
        let levels = self
            .seen
            .iter()
            .filter(|seen| seen.reported.state.is_protected())
            .filter_map(|seen| seen.reported.state.vpl_m);
        let levels: Vec<f64> = levels.collect();
        levels.iter().sum::<f64>() / levels.len() as f64
    }
}

/// Feeds the ranges of some systems, with the sets of a caster, or with those that a receiver would
/// send.
fn receive(recording: &Recording, systems: &str, caster: Option<&Caster>, step_s: usize) -> Outcome {
    let selection = Selection::new(systems, Frequency::Dual).unwrap();
    let sets: &[TimedEphemeris] = if caster.is_some() { &[] } else { &recording.ephemerides };
    let mut encoder = Encoder::new(sets, selection).as_receiver();
    let mut victim = Victim::new(&["PHASE,LPV200", "FREQ,DUAL", "NOISE,GEODETIC"], step_s as f64).unwrap();
    let truth = recording.approximate_position.expect("a place");
    let (mut outcome, mut before) = (Outcome::default(), 0);
    for (index, epoch) in recording.epochs.iter().enumerate() {
        let mut bytes =
            caster.map(|caster| caster.due(index * step_s, step_s, epoch.time)).unwrap_or_default();
        bytes.extend(encoder.epoch(epoch).unwrap());
        // An alert for a silent line may follow it.
        outcome.seen.extend(victim.receive(&bytes, truth).unwrap().into_iter().next());
        let missing = victim.counter("ephemeris_missing").expect("an answer");
        outcome.missing.push(missing - std::mem::replace(&mut before, missing));
    }
    outcome.displaced = victim.counter("ephemerides_displaced").expect("an answer");
    outcome
}

/// Returns a sky of 99 satellites.
fn sky(epochs: u32, step_s: f64) -> Recording {
    let fleets = [Fleet::Gps31, Fleet::Galileo24, Fleet::BeidouGlobal];
    let simulation = Simulation {
        satellites: fleets.into_iter().flat_map(Fleet::satellites).collect(),
        step_s,
        ..Simulation::above_xian(3600.0, epochs, 5)
    };
    assert!(simulation.satellites.len() > CAPACITY + 20);
    simulation.record()
}

const PACES: [Pace; 2] = [Pace::Even, Pace::Burst];

const ORDERS: [&str; 6] = ["GEC", "GCE", "EGC", "ECG", "CGE", "CEG"];

#[test]
fn whatever_the_order_of_systems_those_in_view_have_their_ephemerides_from_the_second_time_on() {
    let recording = sky(250, 1.0);
    let alone = ["G", "E", "C"].map(|system| receive(&recording, system, None, 1));
    let want = receive(&recording, "GEC", None, 1);
    for order in ORDERS {
        for (period_s, pace) in [10, 60].into_iter().flat_map(|period_s| PACES.map(|pace| (period_s, pace))) {
            let caster = Caster::new(&recording.ephemerides, order, period_s, pace);
            let have = receive(&recording, "GEC", Some(&caster), 1);
            let case = format!("{order} every {period_s} s, {pace:?}");
            let from = 2 * period_s;
            let missing: u32 = have.missing[from..].iter().sum();
            assert_eq!((missing, have.displaced), (0, 0), "{case}: {:?}", have.missing);
            // Fewer satellites show another noise, which levels remember for a minute.
            for epoch in from + 61..recording.epochs.len() {
                let (hpl_m, vpl_m) = (have.hpl_m(epoch), have.vpl_m(epoch));
                let as_received = (want.hpl_m(epoch), want.vpl_m(epoch));
                assert!(
                    hpl_m <= as_received.0 * 1.001 && vpl_m <= as_received.1 * 1.001,
                    "{case}, epoch {epoch}: {hpl_m} / {vpl_m} m instead of {as_received:?} m"
                );
                let best_m = alone.iter().map(|alone| alone.vpl_m(epoch)).fold(f64::INFINITY, f64::min);
                assert!(vpl_m <= best_m, "{case}, epoch {epoch}: {vpl_m} m, a system alone {best_m} m");
            }
        }
    }
}

#[test]
fn satellites_that_rise_have_their_ephemerides_within_one_repetition() {
    const STEP_S: usize = 30;
    let recording = sky(360, STEP_S as f64);
    for (period_s, pace) in [30, 60].into_iter().flat_map(|period_s| PACES.map(|pace| (period_s, pace))) {
        let caster = Caster::new(&recording.ephemerides, "GEC", period_s, pace);
        let have = receive(&recording, "GEC", Some(&caster), STEP_S);
        // Each satellite that rises or returns may lack its set until it comes again.
        let rising: usize = recording
            .epochs
            .windows(2)
            .map(|pair| {
                let was_there = |id| pair[0].satellites.iter().any(|seen| seen.satellite == id);
                pair[1].satellites.iter().filter(|seen| !was_there(seen.satellite)).count()
            })
            .sum();
        let missing: u32 = have.missing[2 * period_s / STEP_S..].iter().sum();
        println!(
            "every {period_s} s: {rising} rise, {missing} times without an ephemeris, {} displaced",
            have.displaced
        );
        assert!(missing as usize <= rising * period_s / STEP_S, "{missing} of {rising}");
        assert_eq!(have.displaced, 0);
    }
}

/// Runs the station's day or part of it with the sets of its whole navigation file.
fn real(
    station: &Station,
    systems: &str,
    step_s: usize,
    epochs: usize,
    (period_s, pace): (usize, Pace),
) -> Option<(Outcome, Outcome)> {
    let mut recording = station.load()?;
    recording.approximate_position = Some(station.truth);
    recording.epochs.truncate(epochs);
    let caster = Caster::new(&recording.ephemerides, systems, period_s, pace);
    println!(
        "{}: {} satellites, store of {CAPACITY}, every {period_s} s, {pace:?}",
        station.folder,
        caster.satellites.len()
    );
    let outcomes = [Some(&caster), None].map(|caster| receive(&recording, systems, caster, step_s));
    for (name, outcome) in ["caster", "receiver"].iter().zip(&outcomes) {
        println!(
            "  {name}: {} of {} protected, VPL {:.2} m, {} times without an ephemeris, {} displaced",
            outcome.protected(),
            outcome.seen.len(),
            outcome.mean_vpl_m(),
            outcome.missing.iter().sum::<u32>(),
            outcome.displaced
        );
    }
    let [by_caster, by_receiver] = outcomes;
    Some((by_caster, by_receiver))
}

#[test]
fn a_merged_file_gives_the_levels_of_a_receivers_own_sets() {
    for (station, step_s, epochs) in [(&TLSE, 1, 900), (&ESBC, 30, 2880)] {
        for (period_s, pace) in [(30, Pace::Even), (30, Pace::Burst), (60, Pace::Even), (60, Pace::Burst)] {
            let outcomes = real(station, "GEC", step_s, epochs, (period_s, pace));
            let Some((caster, receiver)) = outcomes else { return };
            assert_eq!(caster.displaced, 0);
            // In the first minutes the sets come.
            assert!(caster.protected() + 130 >= receiver.protected());
            assert!(caster.mean_vpl_m() <= 1.02 * receiver.mean_vpl_m());
        }
    }
}
