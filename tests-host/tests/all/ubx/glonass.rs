//! GLONASS: strings compared with RTCM, and positions with it compared with positions without.

use raim::sentence;
use raim::signal::encode::{self, Frequency, Selection, ubx};
use raim::signal::measurement::{Ephemeris, TimedEphemeris};
use raim::signal::recording::Recording;
use raim_core::frame::Ecef;
use raim_core::satellite::{Constellation, SatelliteId};
use raim_firmware::ephemeris::Ephemeris as Read;
use raim_firmware::input::{Event, Input};
use raim_firmware::navigator::Navigator;
use raim_firmware::settings::{Configuration, Frequencies, Systems};
use raim_firmware::time::GpsTime;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use rig::document;
use rig::laboratory::{self, Bench, Scalar, Stage};
use rig::stations::{ESBC, STATIC_BASE};
use rtcm_rs::msg::Msg1020T;
use rtcm_rs::{Message, MessageBuilder};

use super::NOON;

/// Draws a sign and a magnitude with `width` bits together, in units of `2^exponent`.
fn magnitude(random: &mut ChaCha8Rng, width: u32, exponent: i32) -> f64 {
    let most = (1_i64 << (width - 1)) - 1;
    random.random_range(-most..=most) as f64 * 2f64.powi(exponent)
}

/// Returns position and velocity on an orbit of GLONASS, km and km/s, in the steps of the message.
fn state(random: &mut ChaCha8Rng) -> ([f64; 3], [f64; 3]) {
    const MU_KM3_S2: f64 = 398_600.441_8;
    const EARTH_RATE_RAD_S: f64 = 7.292_115e-5;
    let axis_km: f64 = random.random_range(25_410.0..25_610.0);
    let inclination = random.random_range(60.5_f64..69.5).to_radians();
    let mut angle = || random.random_range(0.0..std::f64::consts::TAU);
    let (node, place) = (angle(), angle());
    let in_space = |along: f64, across: f64| {
        [
            node.cos() * along - node.sin() * inclination.cos() * across,
            node.sin() * along + node.cos() * inclination.cos() * across,
            inclination.sin() * across,
        ]
    };
    let speed_km_s = (MU_KM3_S2 / axis_km).sqrt();
    let [x, y, z] = in_space(axis_km * place.cos(), axis_km * place.sin());
    let [vx, vy, vz] = in_space(-speed_km_s * place.sin(), speed_km_s * place.cos());
    let rotating = [vx + EARTH_RATE_RAD_S * y, vy - EARTH_RATE_RAD_S * x, vz];
    let in_steps = |value: f64, exponent: i32| (value / 2f64.powi(exponent)).round() * 2f64.powi(exponent);
    ([x, y, z].map(|value| in_steps(value, -11)), rotating.map(|value| in_steps(value, -20)))
}

/// Returns a message of random content on an orbit of GLONASS, with a reference time within half a
/// day of noon.
fn broadcast(random: &mut ChaCha8Rng) -> TimedEphemeris {
    let number = random.random_range(1..=24);
    let ([x, y, z], [vx, vy, vz]) = state(random);
    let [ax, ay, az] = [(); 3].map(|()| magnitude(random, 5, -30) as f32);
    let message = Msg1020T {
        glo_satellite_id: number,
        glo_satellite_freq_chan_number: random.random_range(-7..=6),
        glo_eph_health_flag: u8::from(random.random_bool(0.2)),
        glo_m_3str_ln_flag: u8::from(random.random_bool(0.2)),
        tb_min: 15 * random.random_range(0..96),
        xn_km: x,
        yn_km: y,
        zn_km: z,
        xn_first_deriv_km_s: vx,
        yn_first_deriv_km_s: vy,
        zn_first_deriv_km_s: vz,
        xn_second_deriv_km_s2: ax,
        yn_second_deriv_km_s2: ay,
        zn_second_deriv_km_s2: az,
        tau_n_s: magnitude(random, 22, -30),
        gamma_n: magnitude(random, 11, -40) as f32,
        glo_m_delta_tau_n_s: magnitude(random, 5, -30) as f32,
        glo_m_ft_ind: random.random_range(0..16),
        glo_m_n4_year: 2020,
        ..Msg1020T::default()
    };
    let satellite = SatelliteId::new(Constellation::Glonass, number).unwrap();
    TimedEphemeris { satellite, toe: NOON, sent: NOON, message: Ephemeris::Glonass(message) }
}

/// Returns the ephemerides that a module reads if it knows the time and the leap seconds.
fn read(bytes: &[u8]) -> Vec<Read> {
    let mut input = Input::new();
    let mut dated = (f64::from(NOON.tow_ms) * 1e-3).to_le_bytes().to_vec();
    dated.extend_from_slice(&NOON.week.to_le_bytes());
    dated.extend_from_slice(&[18, 0, 1, 1, 0, 0]);
    input.feed(&ubx::frame([0x02, 0x15], &dated), 0, |_| ());
    let mut ephemerides = Vec::new();
    input.feed(bytes, 0, |event| {
        if let Event::Ephemeris(ephemeris) = event {
            ephemerides.push(ephemeris);
        }
    });
    ephemerides
}

#[test]
fn every_bit_of_the_strings_is_as_rtcm_says_it() {
    let mut random = ChaCha8Rng::seed_from_u64(20);
    let mut taken = 0;
    for _ in 0..500 {
        let ephemeris = broadcast(&mut random);
        let Ephemeris::Glonass(message) = &ephemeris.message else { unreachable!("of GLONASS") };
        let mut builder = MessageBuilder::new();
        let want = read(builder.build_message(&Message::Msg1020(message.clone())).unwrap());
        let have = read(&ubx::pages(&ephemeris, NOON).unwrap());
        // Compared as text, because an unstated accuracy is NaN, which does not equal itself.
        let have = format!("{have:?}").replace("origin: Bits", "origin: Relayed");
        assert_eq!(have, format!("{want:?}"), "{message:?}");
        taken += want.len();
    }
    assert_eq!(taken, 500);
}

/// A module, from input to positions.
struct Module {
    input: Input,
    navigator: Navigator,
    configuration: Configuration,
    squares_m2: [f64; 2],
    fixes: u32,
    used: usize,
    /// Time of the last epoch.
    now: Option<GpsTime>,
}

impl Module {
    fn new(systems: &str) -> Self {
        let mut configuration = Configuration::at_start();
        configuration.systems = Systems::of(systems).unwrap();
        // The choice between one frequency and two may differ with another system.
        configuration.frequencies = Frequencies::Dual;
        let navigator = Navigator::new(configuration.requirements()).unwrap();
        Self {
            input: Input::new(),
            navigator,
            configuration,
            squares_m2: [0.0; 2],
            fixes: 0,
            used: 0,
            now: None,
        }
    }

    fn receive(&mut self, bytes: &[u8], truth: Ecef) {
        let Self { input, navigator, configuration, squares_m2, fixes, used, now } = self;
        input.feed(bytes, 0, |event| match event {
            Event::Ephemeris(ephemeris) => drop(navigator.learn(ephemeris, *now)),
            Event::Epoch(raw, came_ms) => {
                *now = Some(raw.time);
                let report = navigator.judge(raw, came_ms, configuration);
                let of_glonass =
                    |satellite: &&SatelliteId| satellite.constellation() == Constellation::Glonass;
                *used += report.used.iter().filter(of_glonass).count();
                if let Some(solution) = &report.solution {
                    let error = raim_core::frame::LocalFrame::at(truth).rotate(solution.position - truth);
                    squares_m2[0] += error.east.powi(2) + error.north.powi(2);
                    squares_m2[1] += error.up.powi(2);
                    *fixes += 1;
                }
            }
            _ => {}
        });
    }

    /// Returns the rms of the horizontal and of the vertical error, m.
    fn errors_m(&self) -> [f64; 2] {
        self.squares_m2.map(|squares_m2| (squares_m2 / f64::from(self.fixes)).sqrt())
    }
}

/// Returns page 18, the only source of the leap seconds.
fn reported(recording: &Recording) -> ubx::IonosphereAndUtc {
    ubx::IonosphereAndUtc { klobuchar: recording.klobuchar.unwrap(), leap_s: (18, 18), change: (1929, 7) }
}

/// Largest ratio of errors with GLONASS to those without.
const LARGER: f64 = 1.1;

fn compare(name: &str, without: &Module, with: &Module, least: usize) {
    let ([have_h, have_v], [want_h, want_v]) = (with.errors_m(), without.errors_m());
    println!(
        "{name}: {want_h:.3} m and {want_v:.3} m without, {have_h:.3} m and {have_v:.3} m with GLONASS, \
         {} times a satellite of it in {} epochs",
        with.used, with.fixes
    );
    assert!(with.used > least && with.fixes >= without.fixes, "{name}: {} used", with.used);
    assert!(have_h < LARGER * want_h && have_v < LARGER * want_v, "{name}");
}

/// Returns the errors as the results have them.
fn cell([horizontal_m, vertical_m]: [f64; 2]) -> String {
    format!("{horizontal_m:.2} / {vertical_m:.2}")
}

/// Delays of the ionosphere-free ranges of `static1hz` to GLONASS satellites against their mean
/// about the surveyed antenna, over its five minutes: satellite, channel, m. Another program, which
/// integrates in steps of 30 s, computed them from the RINEX files.
const DELAYS_M: [(u8, i8, f64); 8] = [
    (1, 1, -1.10),
    (2, -4, -2.14),
    (3, 5, 8.76),
    (11, 0, 0.87),
    (12, -1, -3.86),
    (17, 4, 2.10),
    (18, -3, -3.33),
    (24, 2, -1.30),
];

/// Part of a delay that is proportional to the channel, m per channel.
const SLOPE_M: f64 = 1.01;

/// Returns a recording with each GLONASS range shortened by `by_m`.
fn shortened(recording: &Recording, by_m: impl Fn(i8, f64) -> f64) -> Recording {
    let mut recording = recording.clone();
    for satellite in recording.epochs.iter_mut().flat_map(|epoch| &mut epoch.satellites) {
        let is_it = |(number, ..): &&(u8, i8, f64)| {
            SatelliteId::new(Constellation::Glonass, *number) == Some(satellite.satellite)
        };
        let Some(&(_, channel, delay_m)) = DELAYS_M.iter().find(is_it) else { continue };
        let by_m = by_m(channel, delay_m);
        satellite.signals.iter_mut().for_each(|signal| signal.pseudorange_m -= by_m);
    }
    recording
}

/// Five minutes of this receiver are worse with GLONASS because its ranges are delayed by 3.8 m
/// rms, the same for all five minutes, with 0.6 to 1.4 m of noise on them. Such delays do not
/// average out. Without them GLONASS makes nothing worse. Two thirds of their variance are
/// proportional to the channel, and a second receiver of the model has the same within 2 m; the
/// header of the file says that no correction has been made.
#[test]
fn a_receiver_that_delays_channels_differently_is_worse_with_it() {
    let Some(recording) = STATIC_BASE.load() else { return };
    let play = |recording: &Recording, systems: &str| {
        let selection = Selection::new(systems, Frequency::Dual).unwrap();
        let mut module = Module::new(systems);
        let encoder = ubx::Encoder::new(&recording.ephemerides, selection, Some(reported(recording)));
        let mut encoder = encoder.as_receiver();
        for epoch in &recording.epochs {
            module.receive(&encoder.epoch(epoch).unwrap(), STATIC_BASE.truth);
        }
        println!("{systems}: {} times a satellite of GLONASS in {} epochs", module.used, module.fixes);
        module.errors_m()
    };
    let without = play(&recording, "GCE");
    let with = play(&recording, "GCER");
    let of_slope = play(&shortened(&recording, |channel, _| SLOPE_M * f64::from(channel)), "GCER");
    let of_delays = play(&shortened(&recording, |_, delay_m| delay_m), "GCER");
    println!(
        "static1hz by UBX, m: {without:.3?} without GLONASS, {with:.3?} with it, {of_slope:.3?} less what goes with the \
         channel, {of_delays:.3?} less the delays"
    );
    assert!(with[0] > LARGER * without[0], "no longer worse: {with:?} m, {without:?} m without");
    let is_as_without = of_delays.iter().zip(without).all(|(have, want)| *have < LARGER * want);
    assert!(is_as_without && of_delays[0] < with[0], "{of_delays:?} m less the delays");
    for passage in [
        format!("worse, from {} to {} m", cell(without), cell(with)),
        format!("Without these eight delays the error is {} m", cell(of_delays)),
        format!("proportional to the channel it is {} m", cell(of_slope)),
    ] {
        document::must_say("results/receivers.md", &passage);
    }
}

/// Returns the instructions on the chip of these epochs of GPS and GLONASS, each the fourth that
/// the module receives.
fn instructions(numbers: [usize; 4]) -> Option<Vec<u64>> {
    let (Some(recording), true) = (STATIC_BASE.load(), laboratory::is_installed()) else { return None };
    let command = sentence::command("SYSTEMS,GR");
    let mut bench = Bench::default();
    for number in numbers {
        let selection = Selection::new("GR", Frequency::Dual).unwrap();
        let mut encoder = ubx::Encoder::new(&recording.ephemerides, selection, Some(reported(&recording)));
        let epochs = recording.epochs[number - 3..=number].iter();
        let epochs: Vec<Vec<u8>> = epochs.map(|epoch| encoder.epoch(epoch).unwrap()).collect();
        let (last, before) = epochs.split_last().unwrap();
        let before = before.concat();
        let lengths = ([command.len() as u8], (before.len() as u32).to_le_bytes());
        let input = [&lengths.0, command.as_bytes(), &lengths.1, &before, last];
        bench.request(Stage::Whole, Scalar::Single, &input.concat());
    }
    Some(bench.run().unwrap().into_iter().map(|answer| answer.instructions).collect())
}

/// However far from their reference time, satellites with state vectors are integrated over one
/// step in an epoch, and over one more in the epoch that passes the next node. The recording begins
/// 282 s after the reference time; nodes are 150 s apart.
#[test]
fn an_epoch_with_it_costs_one_step_a_satellite() {
    const SATELLITES: u64 = 8;
    let Some(costs) = instructions([15, 19, 22, 290]) else { return };
    println!("297 s, 301 s, 304 s and 572 s after the reference time: {costs:?} instructions");
    let [before, at_node, behind, far] = costs[..] else { unreachable!("four") };
    let step = at_node.saturating_sub(behind) / SATELLITES;
    println!("a step: {step} instructions a satellite; kept nodes save {} at 572 s", 3 * SATELLITES * step);
    // Half a step per satellite is more than epochs differ by otherwise.
    let same = |a: u64, b: u64| a.abs_diff(b) < SATELLITES * step / 2;
    assert!(step > 2_000 && same(before, behind) && same(far, behind), "{costs:?}");
}

/// Many seconds each.
mod at_length {
    use super::*;

    /// This holds for a geodetic receiver. One with delays of metres that differ between channels is
    /// worse with GLONASS, so the module leaves it out by default.
    #[test]
    fn a_day_with_it_is_no_worse_than_without() {
        let Some(recording) = ESBC.load() else { return };
        for (without, with) in [("G", "GR"), ("GCE", "GCER")] {
            for format in ["RTCM", "UBX"] {
                let play = |systems: &str| {
                    let selection = Selection::new(systems, Frequency::Dual).unwrap();
                    let mut module = Module::new(systems);
                    let reported = reported(&recording);
                    let mut rtcm =
                        encode::Encoder::new(&recording.ephemerides, selection.clone()).as_receiver();
                    let mut ubx =
                        ubx::Encoder::new(&recording.ephemerides, selection, Some(reported)).as_receiver();
                    for epoch in recording.epochs.iter().step_by(4) {
                        let bytes =
                            if format == "UBX" { ubx.epoch(epoch) } else { rtcm.epoch(epoch) }.unwrap();
                        module.receive(&bytes, ESBC.truth);
                    }
                    module
                };
                let (without, with) = ((without, play(without)), (with, play(with)));
                compare(&format!("esbc, {} by {format}", with.0), &without.1, &with.1, 2000);
                let systems = if without.0 == "G" { "GPS" } else { "GPS, Galileo, BeiDou" };
                let (without, with) = (cell(without.1.errors_m()), cell(with.1.errors_m()));
                document::must_say(
                    "results/receivers.md",
                    &format!("| {systems}, {format} | {without} | {with} |"),
                );
            }
        }
    }
}
