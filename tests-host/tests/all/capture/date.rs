//! Captures from before the week cycle of 2019, with their own date.

use raim::monitor::source::{self, Choice, News};
use raim::monitor::speed::{Control, Speed};
use raim::replay::host::Playback;
use raim::replay::{self, Pace, Window};
use raim::signal::capture::{self, Capture};
use raim::signal::encode::{Encoder, Frequency, Selection, StatedWeek};
use raim::signal::sky::Fleet;
use raim::signal::sky::raw::Simulation;
use rig::shared;

/// Returns the RTCM 3 stream of these systems, from `before_s` before the end of a week on.
fn bytes(systems: &str, week: u16, before_s: f64, stated: StatedWeek) -> Vec<u8> {
    let fleets = [('G', Fleet::Gps31), ('E', Fleet::Galileo24)];
    let fleets = fleets.into_iter().filter(|(letter, _)| systems.contains(*letter));
    let mut simulation = Simulation {
        satellites: fleets.flat_map(|(_, fleet)| fleet.satellites()).collect(),
        ..Simulation::above_xian(6.0 * 86_400.0 - before_s, 20, 5)
    };
    simulation.origin.week = week;
    let recording = simulation.record();
    let selection = Selection::new(systems, Frequency::Dual).unwrap();
    let mut encoder = Encoder::new(&recording.ephemerides, selection).stating(stated);
    recording.epochs.iter().flat_map(|epoch| encoder.epoch(epoch).unwrap()).collect()
}

/// Returns the dates that the module sends, without repeats.
fn dates(capture: &Capture) -> Vec<String> {
    let prepared = capture.lumps(&[], &Window::ALL).unwrap();
    let setup: Vec<String> = prepared.week.map(|week| format!("WEEK,{week}")).into_iter().collect();
    let run = replay::on_host(&prepared.lumps, &setup, Pace::Recorded, |_| ()).unwrap();
    dates_in(&run.sentences())
}

fn dates_in(sentences: &str) -> Vec<String> {
    let rmc = sentences.lines().filter(|line| line.starts_with("$GNRMC"));
    let mut dates: Vec<String> = rmc.filter_map(|line| line.split(',').nth(9).map(str::to_owned)).collect();
    dates.dedup();
    dates
}

#[test]
fn capture_of_2012_has_its_own_date() {
    // Week 1709 ended with 2012-10-13.
    for systems in ["G", "GE", "EG"] {
        let capture = Capture::of(bytes(systems, 1709, 3600.0, StatedWeek::Transmission), None).unwrap();
        assert_eq!(dates(&capture), ["131012"], "{systems}");
    }
}

#[test]
fn monitor_shows_the_date_of_the_capture() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("capture.rtcm3");
    std::fs::write(&path, bytes("G", 1709, 3600.0, StatedWeek::Transmission)).unwrap();
    let source = source::open(&Choice::File(path, Control::new(Speed::Max))).unwrap();
    let mut sentences = String::new();
    loop {
        match source.news.recv().unwrap() {
            News::Reported(message) => sentences.extend(message.lines),
            News::End(_) => break,
            News::Failed(why) => panic!("{why}"),
        }
    }
    assert_eq!(dates_in(&sentences), ["131012"]);
}

#[test]
fn given_week_is_the_date() {
    // Week 685 ended with 1993-02-27.
    let capture =
        Capture::of_week(bytes("G", 685, 3600.0, StatedWeek::Transmission), None, Some(685)).unwrap();
    assert_eq!(dates(&capture), ["270293"]);
}

/// A service whose `--record` goes on behind what its file has, after three days without its receiver.
/// RTCM has the time within the week, so that more than half a week would count as a time that goes back.
#[test]
fn capture_goes_on_after_days() {
    let days_s = 3.0 * 86_400.0;
    let parts =
        [3600.0 + days_s, 3600.0].map(|before_s| bytes("GE", 2295, before_s, StatedWeek::Transmission));
    let capture = Capture::of(parts.concat(), None).unwrap();
    assert_eq!(dates(&capture), ["030124", "060124"]);
}

#[test]
fn date_of_today_stays_and_the_module_is_told_nothing() {
    let capture = Capture::of(bytes("GE", 2295, 3600.0, StatedWeek::Transmission), None).unwrap();
    assert_eq!(capture.lumps(&[], &Window::ALL).unwrap().week, None);
    // Week 2295 ended with 2024-01-06.
    assert_eq!(dates(&capture), ["060124"]);
}

#[test]
fn real_capture_of_2012_is_dated_2012() {
    let Some(path) = shared::path_or_skip("data/real/gmsd7_2012.rtcm3.gz") else { return };
    let capture = Capture::of(capture::read(path.to_str().unwrap(), f64::INFINITY).unwrap(), None).unwrap();
    // It goes on over midnight.
    assert_eq!(dates(&capture), ["131012", "141012"]);
}

#[test]
fn table_of_satellites_has_the_date_of_the_capture() {
    let capture = Capture::of(bytes("G", 1709, 3600.0, StatedWeek::Transmission), None).unwrap();
    let prepared = capture.lumps(&[], &Window::ALL).unwrap();
    let setup = [format!("WEEK,{}", prepared.week.unwrap())];
    let lumps = prepared.lumps.iter().cloned().map(Ok);
    let mut playback = Playback::start(lumps, &setup, Pace::Recorded).unwrap();
    playback.watch();
    let mut weeks = std::collections::BTreeSet::new();
    while let Some((_, reported)) = playback.advance().unwrap() {
        weeks.extend(reported.view().and_then(|view| view.time).map(|time| time.week));
    }
    assert_eq!(weeks.into_iter().collect::<Vec<_>>(), [1709]);
}

/// Degrees of latitude and longitude of the station GMSD in its site log: 30°33'23" N, 131°0'56" E.
const GMSD_DEG: [f64; 2] = [30.5564, 131.0156];

#[test]
fn station_that_tags_beidou_with_gps_time_gets_its_position() {
    let Some(path) = shared::path_or_skip("data/real/gmsd7_2012.rtcm3.gz") else { return };
    let capture = Capture::of(capture::read(path.to_str().unwrap(), f64::INFINITY).unwrap(), None).unwrap();
    let prepared = capture.lumps(&[], &Window::ALL).unwrap();
    let setup = [format!("WEEK,{}", prepared.week.unwrap())];
    let run = replay::on_host(&prepared.lumps, &setup, Pace::Recorded, |_| ()).unwrap();
    // The last minute has ephemerides of four satellites of GPS.
    let places: Vec<_> = run.reported.iter().filter_map(|reported| reported.output()?.position).collect();
    assert!(places.len() >= 60, "{} positions", places.len());
    for place in places {
        let found = [place.latitude_rad, place.longitude_rad].map(f64::to_degrees);
        let off = [found[0] - GMSD_DEG[0], found[1] - GMSD_DEG[1]].map(f64::abs);
        assert!(off.iter().all(|&off| off < 0.0005), "{found:?}");
    }
}
