//! The same epochs as RTCM and as UBX through the module: the same verdicts, the same positions.

use raim::signal::encode::{self, Frequency, Selection, ubx};
use raim::signal::recording::Recording;
use raim_core::frame::Ecef;
use raim_core::report::Verdict;
use raim_firmware::input::{Event, Input};
use raim_firmware::navigator::Navigator;
use raim_firmware::settings::Configuration;
use raim_firmware::time::GpsTime;
use rig::shared;

/// A step of a range in MSM7, m: 2⁻²⁹ ms of light.
const MSM7_STEP_M: f64 = 299_792.458 / 536_870_912.0;

/// Largest distance between positions if both formats carry the same range except for the last bits
/// of a double, m. These may fall to either side of a step of the core's grid of lengths, 0.06 mm,
/// and with it the last digit of a sentence, 0.1 mm.
const SAME_RANGE_M: f64 = 1.5e-4;

/// Largest distance between positions if RAWX is finer than MSM7, m. Its rounding error, 0.28 mm at
/// most, is tripled by the combination of two frequencies and amplified by the geometry.
const UNROUNDED_M: f64 = 3e-3;

/// Result of the module for the bytes of an epoch.
type Found = (Verdict, Option<Ecef>, usize);

/// A module from bytes to reports.
struct Module {
    input: Input,
    navigator: Navigator,
    configuration: Configuration,
    /// Time of the last epoch.
    now: Option<GpsTime>,
}

impl Module {
    fn new() -> Self {
        let configuration = Configuration::at_start();
        let navigator = Navigator::new(configuration.requirements()).unwrap();
        Self { input: Input::new(), navigator, configuration, now: None }
    }

    fn receive(&mut self, bytes: &[u8]) -> Option<Found> {
        let Self { input, navigator, configuration, now } = self;
        let mut found = None;
        input.feed(bytes, 0, |event| match event {
            Event::Epoch(raw, came_ms) => {
                *now = Some(raw.time);
                let report = navigator.judge(raw, came_ms, configuration);
                let position = report.solution.as_ref().map(|solution| solution.position);
                found = Some((report.verdict, position, raw.satellites.len()));
            }
            Event::Ephemeris(ephemeris) => drop(navigator.learn(ephemeris, *now)),
            _ => {}
        });
        found
    }
}

/// Compares the measurements of a u-blox receiver in both formats; returns the number of epochs and
/// the largest distance between positions, m.
fn compare(name: &str, recording: &Recording, every: usize, is_rounded: bool) -> (usize, f64) {
    let selection = Selection::new("GCE", Frequency::Dual).unwrap();
    let mut rtcm = (encode::Encoder::new(&recording.ephemerides, selection.clone()), Module::new());
    let mut ubx = (ubx::Encoder::new(&recording.ephemerides, selection, None), Module::new());
    let (mut fixes, mut farthest_m) = (0, 0.0_f64);
    for epoch in recording.epochs.iter().step_by(every) {
        let mut epoch = ubx::measurable(epoch);
        // Both formats can carry these values: whole dB-Hz in RAWX, ranges of 0.56 mm in MSM7.
        for signal in epoch.satellites.iter_mut().flat_map(|satellite| &mut satellite.signals) {
            signal.cn0_dbhz = signal.cn0_dbhz.map(f64::round);
            if is_rounded {
                signal.pseudorange_m = (signal.pseudorange_m / MSM7_STEP_M).round() * MSM7_STEP_M;
            }
        }
        let want = rtcm.1.receive(&rtcm.0.epoch(&epoch).unwrap());
        let have = ubx.1.receive(&ubx.0.epoch(&epoch).unwrap());
        let (Some(want), Some(have)) = (want, have) else {
            panic!("{name}: {:?}: {want:?} {have:?}", epoch.time)
        };
        assert_eq!((have.0, have.2), (want.0, want.2), "{name}: {:?}", epoch.time);
        if let (Some(have), Some(want)) = (have.1, want.1) {
            farthest_m = farthest_m.max(have.distance_m(want));
            fixes += 1;
        }
    }
    println!("{name}, rounded {is_rounded}: {fixes} fixes, at most {:.3} mm apart", farthest_m * 1e3);
    (fixes, farthest_m)
}

#[test]
fn a_simulated_sky_is_judged_the_same_in_both_formats() {
    let recording = raim::signal::sky::raw::Simulation::above_xian(0.0, 60, 3).record();
    let (fixes, farthest_m) = compare("sky", &recording, 1, true);
    assert!(fixes == 60 && farthest_m < 1e-5, "{fixes} fixes, {farthest_m} m");
    let (fixes, farthest_m) = compare("sky", &recording, 1, false);
    assert!(fixes == 60 && farthest_m < UNROUNDED_M, "{fixes} fixes, {farthest_m} m");
}

#[test]
fn recordings_are_judged_the_same_in_both_formats() {
    let sources = [
        ("esbc/ESBC00DNK_R_20201770000_01D_30S_MO.crx.gz", "esbc/ESBC00DNK_R_20201770000_01D_MN.rnx.gz", 6),
        ("static1hz/base.obs.gz", "static1hz/base.nav.gz", 1),
        ("tlse/TLSE00FRA_R_20240011200_15M_01S_MO.crx.gz", "tlse/BRDC00IGS_R_20240010000_01D_MN.rnx.gz", 3),
    ];
    for (observations, navigation, every) in sources {
        let path = |name: &str| shared::path_or_skip(&format!("data/{name}"));
        let (Some(observations_path), Some(navigation)) = (path(observations), path(navigation)) else {
            return;
        };
        let recording = Recording::load(&[observations_path], &[navigation]).unwrap();
        let (fixes, farthest_m) = compare(observations, &recording, every, true);
        assert!(fixes > 290 && farthest_m < SAME_RANGE_M, "{observations}: {fixes} fixes, {farthest_m} m");
        let (fixes, unrounded_m) = compare(observations, &recording, every, false);
        assert!(fixes > 290 && unrounded_m < UNROUNDED_M, "{observations}: {fixes} fixes, {unrounded_m} m");
        let folder = observations.split('/').next().unwrap_or_default();
        let (same_mm, unrounded_mm) = (1e3 * farthest_m, 1e3 * unrounded_m);
        let row = format!("| `{folder}`, {fixes} | {same_mm:.2} mm | {unrounded_mm:.1} mm |");
        rig::document::must_say("results/receivers.md", &row);
    }
}
