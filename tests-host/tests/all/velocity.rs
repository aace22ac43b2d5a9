//! Velocity of the module from Doppler frequencies that are computed another way: from the changes
//! of the simulated sky's ranges; and beside the true ways of two cars.

use raim::replay::{Truth, Window};
use raim::signal::capture::{Bytes, Lumps};
use raim::signal::encode::{Encoder, Frequency, Selection};
use raim::signal::measurement::{Ephemeris as Broadcast, TimedEphemeris};
use raim::signal::recording::Recording;
use raim::signal::sky::raw::Simulation;
use raim::signal::sky::sights;
use raim_core::frame::{Enu, LocalFrame, SPEED_OF_LIGHT_M_S};
use raim_core::internals::velocity::Velocity;
use raim_core::requirements::Requirements;
use raim_core::satellite::SatelliteId;
use raim_firmware::correction::{Sky, Tally, locate};
use raim_firmware::ephemeris::{Ephemeris, Store};
use raim_firmware::input::{Event, Input};
use raim_firmware::pin::MemoryPin;
use raim_firmware::rates::Rates;
use raim_firmware::raw::{RawEpoch, RawSatellite};
use raim_firmware::receiver::{Boot, Receiver};
use raim_firmware::settings::Systems;
use raim_firmware::time::GpsTime;
use raim_single::{Monitor, Workspace};
use rig::shared;
use rig::stations::{ESBC, STATIC_BASE, TLSE};

/// Number of epochs of a sky, each a second after the other.
const EPOCHS: u32 = 14;

/// Half of the time over which a range's change is its rate, s: the jerk leaves a micrometre a
/// second.
const HALF_S: f64 = 0.25;

/// A sky with its epochs and orbits as the module receives them.
struct Heard {
    simulation: Simulation,
    store: Store,
    epochs: Vec<RawEpoch>,
    /// Ephemerides that come before an epoch, with its number.
    news: (usize, Vec<Ephemeris>),
}

fn receive() -> Heard {
    let simulation = Simulation::above_xian(0.0, EPOCHS, 7);
    let recording = simulation.record();
    let mut encoder = Encoder::new(&recording.ephemerides, both());
    let (mut input, mut store, mut epochs) = (Input::new(), Store::new(), Vec::new());
    for epoch in &recording.epochs {
        let bytes = encoder.epoch(epoch).expect("bytes");
        input.feed(&bytes, 0, |event| match event {
            Event::Ephemeris(ephemeris) => {
                store.insert(ephemeris, None);
            }
            Event::Epoch(raw, _) => epochs.push(raw.clone()),
            _ => {}
        });
    }
    assert!(epochs.len() >= 3, "{} epochs", epochs.len());
    Heard { simulation, store, epochs, news: (0, Vec::new()) }
}

fn both() -> Selection {
    Selection::new("GC", Frequency::Dual).expect("systems")
}

/// Returns the ephemerides of a recording, each changed, as the module reads them.
fn read(recording: &Recording, change: impl Fn(&mut TimedEphemeris)) -> Vec<Ephemeris> {
    let mut sets = recording.ephemerides.clone();
    sets.iter_mut().for_each(change);
    let bytes = Encoder::new(&sets, both()).epoch(&recording.epochs[0]).expect("bytes");
    let mut read = Vec::new();
    Input::new().feed(&bytes, 0, |event| {
        if let Event::Ephemeris(ephemeris) = event {
            read.push(ephemeris);
        }
    });
    read
}

impl Heard {
    /// Returns the rate of a satellite's range for a receiver at this velocity, m/s, at the time of
    /// an epoch's tag.
    fn rate_m_s(&self, raw: &RawEpoch, satellite: SatelliteId, velocity: Enu) -> Option<f64> {
        let t_s = raw.time.since_ms(self.simulation.origin) as f64 * 1e-3;
        let at = |t_s: f64| {
            let seen = sights(&self.simulation.satellites, &self.simulation.site, t_s, -1.0);
            seen.into_iter().find(|sight| sight.satellite == satellite)
        };
        let (before, now, after) = (at(t_s - HALF_S)?, at(t_s)?, at(t_s + HALF_S)?);
        let toward = now.line_of_sight;
        let own = velocity.east * toward.east + velocity.north * toward.north + velocity.up * toward.up;
        Some((after.range_m - before.range_m) / (2.0 * HALF_S) - own)
    }

    /// Returns the velocities of all epochs, with rates that `spoil` may change.
    fn velocities(&self, velocity: Enu, spoil: impl Fn(SatelliteId, f64) -> f64) -> (Vec<Velocity>, Rates) {
        let (mut rates, mut workspace) = (Rates::new(), Workspace::new());
        let monitor = Monitor::new(Requirements::non_precision_approach()).expect("in the tables");
        let (mut found, mut store) = (Vec::new(), self.store.clone());
        for (index, raw) in self.epochs.iter().enumerate() {
            for news in self.news.1.iter().filter(|_| index == self.news.0) {
                store.insert(*news, Some(raw.time));
            }
            let mut raw = raw.clone();
            let with_rates = raw.clone();
            for satellite in &mut raw.satellites {
                let Some(rate) = self.rate_m_s(&with_rates, satellite.satellite, velocity) else { continue };
                for signal in &mut satellite.signals {
                    let wavelength_m = SPEED_OF_LIGHT_M_S / signal.carrier.frequency_hz();
                    let doppler_hz = -spoil(satellite.satellite, rate) / wavelength_m;
                    *signal = signal.with_doppler_hz(doppler_hz as f32);
                }
            }
            let mut sky = Sky::new();
            locate(&raw, &store, 0.0, Systems::AT_START, &mut Tally::default(), &mut sky);
            let place = Some(self.simulation.site.position);
            found.extend(rates.velocity(&raw, &sky, place, &monitor, &mut workspace));
        }
        (found, rates)
    }
}

/// The test for a wrong time assumes these rates accurate to a metre a second, of up to 800.
#[test]
fn satellites_move_as_their_ranges_say() {
    let heard = receive();
    let (_, rates) = heard.velocities(REST, |_, rate| rate);
    let last = heard.epochs.last().expect("epochs");
    let alone = |satellite: &RawSatellite, later_ms: u64| {
        let mut raw = RawEpoch::new(GpsTime::from_ms(last.time.to_ms() + later_ms));
        raw.satellites.push(satellite.clone()).expect("room");
        let mut sky = Sky::new();
        locate(&raw, &heard.store, 0.0, Systems::AT_START, &mut Tally::default(), &mut sky);
        (sky.pop().expect("located"), raw)
    };
    for (index, satellite) in last.satellites.iter().enumerate() {
        let (located, raw) = alone(satellite, 2_000);
        let velocity_m_s =
            rates.of_satellite(&located, index, raw.time).expect("seen by the same set").map(f64::from);
        let orbit = heard.store.get(satellite.satellite, raw.time).expect("an orbit");
        let position = orbit.at(raw.time, satellite.signals[0].range_m).expect("a place").position;
        let toward = position - heard.simulation.site.position;
        let away = toward.x_m * velocity_m_s.x + toward.y_m * velocity_m_s.y + toward.z_m * velocity_m_s.z;
        let have_m_s = away / position.distance_m(heard.simulation.site.position);
        let want_m_s = heard.rate_m_s(&raw, satellite.satellite, REST).expect("in the sky");
        assert!((have_m_s - want_m_s).abs() < 1.0, "{}: {have_m_s}, not {want_m_s}", satellite.satellite);
        let (long_after, raw) = alone(satellite, 100_000);
        assert_eq!(rates.of_satellite(&long_after, index, raw.time), None);
    }
}

const REST: Enu = Enu { east: 0.0, north: 0.0, up: 0.0 };

/// Checks that a velocity is near the wanted one. The bars for recordings are 5 cm/s horizontally
/// and 10 cm/s vertically. A sky without noise leaves the error of the method, and the drift of the
/// satellites' clocks, which the geometry does not have.
#[track_caller]
fn assert_near(have: &Velocity, want: Enu) {
    let [east, north, up] = have.east_north_up_m_s;
    let horizontal = (east - want.east).hypot(north - want.north);
    assert!(horizontal < 0.02 && (up - want.up).abs() < 0.03, "have {have:?}, want {want:?}");
}

#[test]
fn a_receiver_at_rest_is_at_rest() {
    let heard = receive();
    let (have, rates) = heard.velocities(REST, |_, rate| rate);
    assert_eq!(have.len(), heard.epochs.len() - 1, "all but the first: {:?}", rates.tally());
    for have in &have {
        assert_near(have, REST);
    }
}

#[test]
fn other_clocks_at_the_same_reference_time_are_no_velocity() {
    const AT: usize = 4;
    const EAST_M: f64 = 25.0;
    let mut heard = receive();
    let Simulation { satellites, site, .. } = &heard.simulation;
    let seen = sights(satellites, site, 0.0, -1.0);
    // The change resembles a motion of the receiver to the east, which contradicts neither the set
    // before nor the others.
    let clock = |set: &mut TimedEphemeris| {
        let Some(seen) = seen.iter().find(|seen| seen.satellite == set.satellite) else { return };
        let other_s = EAST_M * seen.line_of_sight.east / SPEED_OF_LIGHT_M_S;
        match &mut set.message {
            Broadcast::Gps(message) => message.af0_s += other_s,
            Broadcast::Beidou(message) => message.a0_s += other_s,
            _ => unreachable!("GPS and BeiDou"),
        }
    };
    let recording = heard.simulation.record();
    heard.news = (AT, read(&recording, clock));
    assert!(heard.news.1.len() > 10, "{} sets", heard.news.1.len());
    let (have, _) = heard.velocities(REST, |_, rate| rate);
    for have in &have {
        assert_near(have, REST);
    }
    assert_eq!(
        have.len(),
        heard.epochs.len() - 2,
        "none with sets of which one is another than a second ago"
    );
    // The same sets again are not new.
    heard.news = (AT, read(&recording, |_| ()));
    assert_eq!(heard.velocities(REST, |_, rate| rate).0.len(), heard.epochs.len() - 1);
}

#[test]
fn a_flying_receiver_flies() {
    let velocity = Enu { east: 180.0, north: -140.0, up: 12.0 };
    let (have, _) = receive().velocities(velocity, |_, rate| rate);
    assert!(!have.is_empty());
    for have in &have {
        assert_near(have, velocity);
    }
}

#[test]
fn a_receiver_clock_that_drifts_is_no_velocity() {
    let (have, _) = receive().velocities(REST, |_, rate| rate + 250.0);
    for have in &have {
        assert_near(have, REST);
        assert!((have.drift_m_s - 250.0).abs() < 0.05, "{}", have.drift_m_s);
    }
}

#[test]
fn two_metres_a_second_in_one_rate_are_found() {
    let heard = receive();
    let faulty = heard.epochs[0].satellites[2].satellite;
    let (have, rates) =
        heard.velocities(REST, |satellite, rate| rate + if satellite == faulty { 2.0 } else { 0.0 });
    assert!(!have.is_empty(), "{:?}", rates.tally());
    for have in &have {
        assert_eq!(have.excluded.as_slice(), [faulty]);
        assert_near(have, REST);
    }
    assert_eq!(rates.tally().rates_excluded as usize, have.len());
}

/// Reflections come from other directions than their satellites, so that a car sees other rates; on a
/// motorway they are few, and the rates only noisier than at rest.
#[test]
fn velocity_in_motion_is_reported_after_ten_epochs_and_not_compared() {
    let heard = receive();
    let street = (Enu { east: 9.0, north: -6.0, up: 0.0 }, 0.6);
    let motorway = (Enu { east: 34.0, north: -20.0, up: 0.5 }, 0.25);
    for (car, wrong_m_s) in [street, motorway] {
        let spoiled = |satellite: SatelliteId, rate: f64| {
            rate + if satellite.number().is_multiple_of(2) { wrong_m_s } else { -wrong_m_s }
        };
        let (have, rates) = heard.velocities(car, spoiled);
        assert_eq!(have.len(), heard.epochs.len() - 10, "{:?}", rates.tally());
        assert!(rates.refusal().is_some());
        for have in &have {
            let [east, north, up] = have.east_north_up_m_s;
            let (away_m_s, levels_m_s) = ((east - car.east).hypot(north - car.north), have.levels_m_s);
            assert!(away_m_s < 2.0 * wrong_m_s && away_m_s < levels_m_s.hpl_m, "{have:?}");
            assert!((up - car.up).abs() < levels_m_s.vpl_m, "{have:?}");
        }
        let (have, _) = heard.velocities(REST, spoiled);
        assert_eq!(have, [], "at rest they are faults");
    }
}

/// Early firmware of a common receiver sends rates with the wrong sign.
#[test]
fn rates_of_the_wrong_sign_are_named_and_give_no_velocity() {
    let heard = receive();
    let (have, rates) = heard.velocities(REST, |_, rate| -rate);
    assert!(have.is_empty(), "{have:?}");
    assert_eq!(rates.tally().rates_of_wrong_sign as usize, heard.epochs.len() - 1, "{:?}", rates.tally());
}

/// Returns the horizontal and vertical rms errors of the velocity of a receiver at rest, m/s, and
/// the numbers of epochs with a position and with a velocity.
fn at_rest(recording: &Recording, systems: &str) -> (f64, f64, usize, usize) {
    let selection = Selection::new(systems, Frequency::Dual).expect("systems");
    let mut encoder = Encoder::new(&recording.ephemerides, selection);
    let boot = Boot::on_host("test");
    let mut module = Receiver::new(MemoryPin::default(), boot).expect("it starts");
    let (mut horizontal, mut vertical, mut fixes, mut velocities) = (0.0, 0.0, 0, 0);
    for (index, epoch) in (0_u64..).zip(recording.epochs.iter().take(600)) {
        let bytes = encoder.epoch(epoch).expect("bytes");
        let mut reported = Vec::new();
        module.gnss(&bytes, index * 1000, &mut reported);
        fixes += usize::from(String::from_utf8_lossy(&reported).contains("$GNRMC") && !reported.is_empty());
        if let Some(velocity) = module.velocity() {
            let [east, north, up] = velocity.east_north_up_m_s;
            horizontal += east * east + north * north;
            vertical += up * up;
            velocities += 1;
        }
    }
    let mean = |sum: f64| (sum / f64::from(velocities.max(1))).sqrt();
    (mean(horizontal), mean(vertical), fixes, velocities as usize)
}

/// Real receivers at rest have an rms velocity within 5 cm/s horizontally and 10 cm/s vertically.
#[test]
fn real_receivers_at_rest_are_at_rest() {
    for (station, systems) in [(&STATIC_BASE, "GEC"), (&TLSE, "GEC"), (&ESBC, "GEC")] {
        let Some(recording) = station.load() else { return };
        let (horizontal, vertical, fixes, velocities) = at_rest(&recording, systems);
        println!(
            "{}: {horizontal:.3} m/s horizontally, {vertical:.3} m/s vertically, {velocities} of {fixes} epochs",
            station.folder
        );
        assert!(horizontal <= 0.05 && vertical <= 0.10, "{}", station.folder);
        let (horizontal, vertical) = (100.0 * horizontal, 100.0 * vertical);
        let passage = format!("`{}` {horizontal:.1} / {vertical:.1} cm/s", station.folder);
        rig::document::must_say("results/receivers.md", &passage);
        assert!(velocities * 100 >= fixes * 95, "{}: {velocities} of {fixes}", station.folder);
    }
}

/// Between buildings several rates are wrong at once, and some of the rest agree by chance. The true ways are
/// known to 0.1 m, that of `car_shanghai` from the receiver's own carriers. Each is known beside at least so many
/// reported velocities; without sigmas that grow with the speed they are 256, 325 and 83.
#[test]
fn velocities_of_a_car_are_within_their_levels() {
    /// Largest difference of the mean velocity over two seconds to the present one, m/s.
    const UNKNOWN_M_S: f64 = 0.5;
    for (capture, truth, least) in [
        ("ubx/urban_m8t.ubx.gz", "urban/truth.csv", 305),
        ("consumer/car_shanghai.rtcm3.gz", "consumer/car_shanghai_truth.csv", 1080),
        ("real/x20p_walk.ubx.gz", "real/x20p_walk_truth.csv", 255),
    ] {
        let Some(folder) = shared::path_or_skip("data") else { return };
        let bytes = Bytes::open(folder.join(capture).to_str().expect("text"), f64::INFINITY).expect("bytes");
        let truth = Truth::from_file(&folder.join(truth)).expect("positions");
        let mut receiver = Receiver::new(MemoryPin::default(), Boot::on_host("test")).expect("a module");
        let (mut errors_m_s, mut beyond, mut told) = ([Vec::new(), Vec::new()], Vec::new(), 0);
        for lump in Lumps::of(bytes, None, &[], &Window::ALL).expect("epochs") {
            let lump = lump.expect("an epoch");
            receiver.gnss(&lump.bytes, lump.elapsed_ms(), &mut Vec::new());
            told += usize::from(receiver.velocity().is_some());
            let Some((have, want)) = receiver.velocity().zip(mean_velocity(&truth, lump.time)) else {
                continue;
            };
            let [east, north, up] = have.east_north_up_m_s;
            let away_m_s = [(east - want.east).hypot(north - want.north), (up - want.up).abs()];
            let levels_m_s = [have.levels_m_s.hpl_m, have.levels_m_s.vpl_m];
            errors_m_s.iter_mut().zip(away_m_s).for_each(|(errors, away)| errors.push(away));
            if (0..2).any(|part| away_m_s[part] > levels_m_s[part] + UNKNOWN_M_S) {
                beyond.push((lump.time, away_m_s, levels_m_s));
            }
        }
        let known = errors_m_s[0].len();
        let [horizontal, vertical] = errors_m_s.map(|mut errors| {
            errors.sort_by(f64::total_cmp);
            errors[known * 95 / 100]
        });
        println!("{capture}: {told} velocities, 95 % of {known} within {horizontal:.2} / {vertical:.2} m/s");
        assert!(known >= least && beyond.is_empty(), "{capture}: {beyond:?} of {known}");
    }
}

/// Returns the mean velocity from a second before a time to a second after it, m/s.
fn mean_velocity(truth: &Truth, time: GpsTime) -> Option<Enu> {
    let place = |later_ms: i64| truth.at(GpsTime::from_ms(time.to_ms().checked_add_signed(later_ms)?));
    let (before, after) = place(-1000).zip(place(1000))?;
    let way_m = LocalFrame::at(before).rotate(after - before);
    Some(Enu { east: 0.5 * way_m.east, north: 0.5 * way_m.north, up: 0.5 * way_m.up })
}
