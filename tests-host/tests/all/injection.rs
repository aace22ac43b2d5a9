//! A day of a real station with a fault injected into each satellite in turn.
//!
//! The windows have ten epochs with one fault of +100 m each, and are spread over the day. A
//! satellite counts as testable if its smallest detectable bias, `σ √(λ/S_ii)` of the fault-free
//! epoch, is below 100 m; `S_ii` comes from the dense oracle and not from the core.

use raim::replay::{self, Lump, Moment, Pace, Summary, Track, Truth, Window};
use raim::second_opinion::dense::{self, Range};
use raim::signal::encode::{Frequency, Selection};
use raim::signal::fault::Fault;
use raim::signal::recording::Recording;
use raim_core::frame::{Ecef, Enu, LocalFrame};
use raim_core::internals::integrity::raim::detection::threshold::Thresholds;
use raim_core::internals::numeric::probability::Probability;
use raim_core::satellite::SatelliteId;
use rig::document;
use rig::stations::ESBC;

const TRUTH: Ecef = ESBC.truth;
const BIAS_M: f64 = 100.0;
const MASK_RAD: f64 = 10.0 * std::f64::consts::PI / 180.0;

/// Time between epochs, s.
const STEP_S: f64 = 30.0;
/// Number of epochs of a window, and from one window to the next.
const FAULTY_EPOCHS: usize = 10;
const STRIDE_EPOCHS: usize = 12;

fn selection() -> Selection {
    Selection::new("GCE", Frequency::Dual).unwrap()
}

fn run(recording: &Recording, faults: &[Fault], window: &Window) -> (Vec<Lump>, Track) {
    let lumps = replay::encode(recording, &selection(), faults, window).unwrap();
    let run = replay::on_host(&lumps, &[], Pace::Recorded, |_| {}).unwrap();
    let track = replay::track(&lumps, &run, Some(&Truth::Fixed(TRUTH)));
    (lumps, track)
}

/// Returns the satellites of each epoch with their smallest detectable biases, m.
fn detectable_biases(lumps: &[Lump]) -> Vec<Vec<(SatelliteId, f64)>> {
    let epochs = replay::corrected(lumps, TRUTH, MASK_RAD, None);
    epochs.iter().map(|epoch| biases_of(epoch.observations())).collect()
}

fn biases_of(observations: &[raim_core::epoch::Observation]) -> Vec<(SatelliteId, f64)> {
    let frame = LocalFrame::at(TRUTH);
    let range = |observation: &raim_core::epoch::Observation| {
        let difference = observation.position - TRUTH;
        let Enu { east, north, up } = frame.rotate(difference);
        let line_of_sight = [east, north, up].map(|component| component / difference.radius_m());
        let constellation = observation.satellite.constellation();
        Range { line_of_sight, constellation, residual_m: 0.0, sigma_m: observation.sigma_m }
    };
    let ranges: Vec<Range> = observations.iter().map(range).collect();
    let Some(dense) = dense::solve(&ranges).filter(|dense| dense.dof > 0) else { return Vec::new() };
    let thresholds =
        Thresholds::from_tables(Probability::new(3.33e-7).unwrap(), Probability::new(1e-3).unwrap()).unwrap();
    let lambda: f64 = thresholds.lambda(dense.dof).unwrap();
    let smallest = |(index, observation): (usize, &raim_core::epoch::Observation)| {
        let redundancy = dense.projection[(index, index)].max(1e-12);
        (observation.satellite, observation.sigma_m * (lambda / redundancy).sqrt())
    };
    observations.iter().enumerate().map(smallest).collect()
}

/// Returns one fault per window, the satellites in turn among those in view through the whole
/// window.
fn faults(biases: &[Vec<(SatelliteId, f64)>]) -> Vec<Fault> {
    let mut times_chosen = std::collections::BTreeMap::<SatelliteId, usize>::new();
    let mut faults = Vec::new();
    for start in (1..biases.len() - FAULTY_EPOCHS).step_by(STRIDE_EPOCHS) {
        let seen_in = |epoch: usize, satellite| biases[epoch].iter().any(|(seen, _)| *seen == satellite);
        let through = |satellite| (start..start + FAULTY_EPOCHS).all(|epoch| seen_in(epoch, satellite));
        let candidates = biases[start].iter().map(|(satellite, _)| *satellite).filter(|&s| through(s));
        let Some(next) = candidates.min_by_key(|s| (times_chosen.get(s).copied().unwrap_or(0), *s)) else {
            continue;
        };
        *times_chosen.entry(next).or_default() += 1;
        let (start_s, end_s) = (start as f64 * STEP_S - 1.0, (start + FAULTY_EPOCHS) as f64 * STEP_S - 1.0);
        faults.push(Fault::parse_inject(&format!("{next}:+{BIAS_M}@{start_s}..{end_s}")).unwrap());
    }
    faults
}

fn excludes(moment: &Moment, wanted: impl Fn(SatelliteId) -> bool) -> bool {
    moment.output.as_ref().is_some_and(|output| output.excluded.iter().any(|e| wanted(e.satellite)))
}

fn reason(moment: &Moment) -> &str {
    moment.output.as_ref().map_or("", |output| output.state.reason.as_str())
}

#[test]
fn a_step_of_100_m_on_each_satellite_in_turn_is_caught_and_left_out() {
    let Some(recording) = ESBC.load() else { return };
    let (lumps, healthy) = run(&recording, &[], &Window::ALL);
    let biases = detectable_biases(&lumps);
    let faults = faults(&biases);
    assert!(faults.len() >= 200, "{} windows", faults.len());
    let (_, track) = run(&recording, &faults, &Window::ALL);

    let (mut testable, mut caught, mut wrong, mut untestable) = (0, 0, 0, 0);
    let (mut with_fault, mut without_fault) = (Vec::new(), Vec::new());
    for (index, moment) in track.iter().enumerate() {
        let fault = faults.iter().find(|fault| fault.is_active(moment.elapsed_s));
        let is_faulty = |satellite| fault.is_some_and(|fault| fault.target.covers(satellite));
        if excludes(moment, |satellite| !is_faulty(satellite)) && reason(moment) != "AMBIGUOUS" {
            wrong += 1;
        }
        let bias_m = biases[index].iter().find(|(satellite, _)| is_faulty(*satellite)).map(|(_, bias)| *bias);
        match bias_m {
            Some(bias_m) if bias_m < BIAS_M => {
                testable += 1;
                let alarmed = moment.output.as_ref().is_some_and(|output| output.state.state == 'A');
                caught += usize::from(alarmed || excludes(moment, is_faulty));
            }
            Some(_) => untestable += 1,
            None => {}
        }
        if excludes(moment, is_faulty) {
            with_fault.push(moment.clone());
            without_fault.push(healthy[index].clone());
        }
    }
    let rms = |track: &Track| Summary::of(track, &[], true).horizontal_rms_m.unwrap();
    let (after_m, before_m) = (rms(&with_fault), rms(&without_fault));
    println!(
        "{} windows, {testable} testable epochs ({untestable} not), {caught} caught, {wrong} wrong exclusions; \
         horizontal rms after exclusion {after_m:.2} m, fault-free {before_m:.2} m",
        faults.len()
    );
    assert!(caught * 100 >= testable * 98, "{caught} of {testable} caught");
    assert_eq!(wrong, 0, "healthy satellites left out without saying AMBIGUOUS");
    assert!((after_m - before_m).abs() <= 0.3, "have {after_m} m, fault-free {before_m} m");
    let windows = faults.len();
    for (name, passage) in [
        (
            "results/receivers.md",
            format!("| {windows} | {testable} | {caught} | {wrong} | {before_m:.2} → {after_m:.2} m |"),
        ),
        ("results/receivers.md", format!("The other {untestable} epochs are not counted")),
        ("RESULTS.md", format!("{caught} of {testable}, no healthy satellite left out")),
    ] {
        document::must_say(name, &passage);
    }
}

#[test]
fn a_ramp_is_caught_before_the_error_exceeds_the_protection_level() {
    const EPOCHS: usize = 50;
    let Some(recording) = ESBC.load() else { return };
    let (lumps, _) = run(&recording, &[], &Window::ALL);
    let biases = detectable_biases(&lumps);
    let (mut times_s, mut largest_m) = (Vec::new(), 0.0_f64);
    for (turn, start) in (10..biases.len() - EPOCHS).step_by(240).enumerate() {
        let through = |satellite| {
            biases[start..start + EPOCHS]
                .iter()
                .all(|seen| seen.iter().any(|(other, bias_m)| *other == satellite && *bias_m < BIAS_M))
        };
        let candidates: Vec<SatelliteId> =
            biases[start].iter().map(|(satellite, _)| *satellite).filter(|&s| through(s)).collect();
        let satellite = candidates[turn % candidates.len()];
        let (start_s, end_s) = (start as f64 * STEP_S, (start + EPOCHS) as f64 * STEP_S);
        let ramp = Fault::parse_ramp(&format!("{satellite}:0.5@{start_s}..{end_s}")).unwrap();
        let window = Window { from_s: start_s - 300.0, to_s: end_s, every_s: 0.0 };
        let (_, track) = run(&recording, &[ramp], &window);
        let summary = Summary::of(&track, &[ramp], true);
        let worst_m = track.iter().filter_map(|m| m.error.map(Enu::horizontal)).fold(0.0_f64, f64::max);
        let noticed_s = summary.injected[0].first_alert_or_exclusion_s;
        println!("{satellite} from {start_s} s: noticed after {noticed_s:?} s, largest error {worst_m:.1} m");
        assert_eq!(summary.misleading, Some(0), "{satellite}: {summary:?}");
        assert_eq!(summary.injected[0].wrong_exclusions, 0, "{satellite}: {summary:?}");
        assert!(noticed_s.is_some(), "{satellite} was not noticed");
        times_s.extend(noticed_s);
        largest_m = largest_m.max(worst_m);
    }
    assert_eq!(times_s.len(), 12, "the results say twelve");
    times_s.sort_by(f64::total_cmp);
    times_s.dedup();
    let times: Vec<String> = times_s.iter().map(|time_s| format!("{time_s:.0}")).collect();
    let passage = format!("were detected after {} s", times.join(" or "));
    document::must_say("results/receivers.md", &passage);
    document::must_say("results/receivers.md", &format!("the largest was {largest_m:.1} m"));
}
