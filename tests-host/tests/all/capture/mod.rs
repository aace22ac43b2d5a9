//! Captures of a receiver through the module: the epochs of an independent program's streams. Here
//! is what the tests share, and the epochs as they are, whole and in part.

mod damage;
mod date;
mod injection;
mod orders;
mod refused;
mod ways_in;

use std::fs::File;
use std::io::Read as _;
use std::path::PathBuf;

use flate2::read::GzDecoder;
use raim::replay::{self, Lump, Moment, Pace, Summary, Track, Truth, Window};
use raim::signal::capture::Capture;
use raim::signal::encode::{Frequency, Selection, ubx};
use raim::signal::fault::Fault;
use raim::signal::measurement::MeasuredEpoch;
use raim::signal::pieces::{Kind, pieces};
use raim::signal::recording::Recording;
use raim_firmware::time::GpsTime;
use rig::shared;

/// A stream of the reference folder, its sources, and the place of the antenna.
struct Stream {
    name: &'static str,
    observations: &'static str,
    navigation: &'static [&'static str],
    truth: &'static str,
    /// Signals that the stream was given, of those that a u-blox receiver measures: system, and
    /// bands as RINEX numbers them; empty for all.
    signals: &'static [(char, &'static [u8])],
}

const STREAMS: [Stream; 5] = [
    Stream {
        name: "esbc_4h",
        observations: "esbc/ESBC00DNK_R_20201770000_01D_30S_MO.crx.gz",
        navigation: &["esbc/ESBC00DNK_R_20201770000_01D_MN.rnx.gz"],
        truth: "3582104.9254,532590.2381,5232755.2669",
        signals: &[],
    },
    Stream {
        name: "static1hz_base",
        observations: "static1hz/base.obs.gz",
        navigation: &["static1hz/base.nav.gz"],
        truth: "-3817681.1213,3562839.4311,3650159.1593",
        signals: &[],
    },
    Stream {
        name: "static1hz_rover_f9p_noise",
        observations: "static1hz/rover.obs.gz",
        navigation: &["static1hz/base.nav.gz"],
        truth: "-3817681.3807,3562839.9785,3650158.3760",
        signals: &[('G', &[1, 2]), ('E', &[1, 7]), ('C', &[2, 7])],
    },
    Stream {
        name: "tlse_x20p_fnav",
        observations: "tlse/TLSE00FRA_R_20240011200_15M_01S_MO.crx.gz",
        navigation: &["tlse/BRDC00IGS_R_20240010000_01D_MN.rnx.gz"],
        truth: "4627852.50,119640.22,4372995.28",
        signals: &[('G', &[1, 2, 5]), ('E', &[1, 5]), ('C', &[1, 2, 5, 6])],
    },
    Stream {
        name: "urban_m8t",
        observations: "urban/car.obs.gz",
        navigation: &["urban/gps.nav.gz", "urban/beidou.nav.gz"],
        truth: "urban/truth.csv",
        signals: &[('G', &[1]), ('C', &[2])],
    },
];

fn path(name: &str) -> PathBuf {
    shared::path(&format!("data/{name}")).unwrap()
}

impl Stream {
    fn bytes(&self) -> Option<Vec<u8>> {
        let path = shared::path_or_skip(&format!("data/ubx/{}.ubx.gz", self.name))?;
        let mut bytes = Vec::new();
        GzDecoder::new(File::open(path).unwrap()).read_to_end(&mut bytes).unwrap();
        Some(bytes)
    }

    fn recording(&self) -> Recording {
        Recording::load(&[path(self.observations)], &self.navigation()).unwrap()
    }

    fn navigation(&self) -> Vec<PathBuf> {
        self.navigation.iter().map(|name| path(name)).collect()
    }

    /// Returns the part of an epoch that the stream was given.
    fn given(&self, epoch: &MeasuredEpoch) -> MeasuredEpoch {
        let mut given = ubx::measurable(epoch);
        for satellite in &mut given.satellites {
            let letter = satellite.satellite.constellation().letter();
            let of_system = self.signals.iter().find(|(system, _)| *system == letter);
            let bands = of_system.map_or(&[][..], |(_, bands)| bands);
            satellite.signals.retain(|signal| self.signals.is_empty() || bands.contains(&signal.band));
        }
        given.satellites.retain(|satellite| !satellite.signals.is_empty());
        given
    }

    fn truth(&self) -> Truth {
        if self.truth.contains("truth.csv") {
            Truth::from_file(&path(self.truth)).unwrap()
        } else {
            Truth::parse(self.truth).unwrap()
        }
    }
}

/// Runs a capture's epochs through the module with the settings at start.
fn judged(bytes: &[u8], faults: &[Fault]) -> Track {
    let capture = Capture::of(bytes.to_vec(), None).unwrap();
    run(&capture.lumps(faults, &Window::ALL).unwrap().lumps, None)
}

fn run(lumps: &[Lump], truth: Option<&Truth>) -> Track {
    run_with(lumps, truth, &[])
}

fn run_with(lumps: &[Lump], truth: Option<&Truth>, setup: &[String]) -> Track {
    let reported = replay::on_host(lumps, setup, Pace::Recorded, |_| ()).unwrap();
    replay::track(lumps, &reported, truth)
}

fn times(track: &Track) -> Vec<GpsTime> {
    track.iter().map(|moment| moment.time).collect()
}

fn is_protected(moment: &Moment) -> bool {
    moment.output.as_ref().is_some_and(|output| output.state.is_protected())
}

/// Returns the first epochs of a stream.
fn first(stream: &Stream, epochs: usize) -> Option<Vec<u8>> {
    let bytes = stream.bytes()?;
    let mut left = epochs;
    let within = pieces(&bytes).take_while(|piece| {
        let is_wanted = left > 0;
        left -= usize::from(is_wanted && piece.kind == Kind::RAWX);
        is_wanted
    });
    Some(within.flat_map(|piece| piece.bytes).copied().collect())
}

/// Returns the first epochs of the stream that most tests use.
fn epochs(many: usize) -> Option<Vec<u8>> {
    first(&STREAMS[1], many)
}

#[test]
fn streams_are_judged_as_the_recordings_that_they_were_made_of() {
    /// Largest difference of the errors: pages take half a minute, and the module chooses among
    /// more bands.
    const RMS: f64 = 0.1;
    for stream in STREAMS {
        let Some(bytes) = stream.bytes() else { return };
        let truth = stream.truth();
        let capture = Capture::of(bytes, None).unwrap();
        assert_eq!(capture.advice(), None, "{}", stream.name);
        // The choice between one frequency and two may fall on another epoch.
        let mut setup = vec!["FREQ,DUAL".to_owned()];
        let have = run_with(&capture.lumps(&[], &Window::ALL).unwrap().lumps, Some(&truth), &setup);

        let mut recording = stream.recording();
        let (first, last) = (have[0].time, have[have.len() - 1].time);
        recording.epochs.retain(|epoch| (first..=last).contains(&epoch.time));
        let recorded: Vec<GpsTime> = recording.epochs.iter().map(|epoch| epoch.time).collect();
        assert_eq!(times(&have), recorded, "{}", stream.name);
        for epoch in &mut recording.epochs {
            *epoch = stream.given(epoch);
        }
        let selection = Selection::new("GCE", Frequency::Dual).unwrap();
        let lumps = replay::encode(&recording, &selection, &[], &Window::ALL).unwrap();
        let ionosphere = recording.klobuchar.map(|values| values.map(|value| format!("{value:e}")).join(","));
        setup.extend(ionosphere.iter().map(|values| format!("IONO,{values}")));
        let want = run_with(&lumps, Some(&truth), &setup);

        let whole = Summary::of(&have, &[], true);
        let both = |track: &Track, other: &Track| {
            let pairs = track.iter().zip(other);
            let kept = pairs.filter(|(one, other)| is_protected(one) && is_protected(other));
            Summary::of(&kept.map(|(moment, _)| moment.clone()).collect(), &[], true)
        };
        let (of_stream, of_recording) = (both(&have, &want), both(&want, &have));
        let rms = |summary: &Summary| [summary.horizontal_rms_m, summary.vertical_rms_m].map(Option::unwrap);
        println!(
            "{}: {} epochs, {} protected; of {} in both {:.3?} m against {:.3?} m",
            stream.name,
            whole.epochs,
            whole.protected,
            of_stream.with_truth,
            rms(&of_stream),
            rms(&of_recording)
        );
        for (have, want) in rms(&of_stream).into_iter().zip(rms(&of_recording)) {
            assert!((have / want - 1.0).abs() < RMS, "{}: {have} m, not {want} m", stream.name);
        }
        assert_eq!((whole.misleading, whole.hazardous), (Some(0), Some(0)), "{}", stream.name);
        assert!(10 * whole.protected > 9 * of_recording.epochs, "{}", stream.name);
    }
}

#[test]
fn a_part_of_a_capture_is_judged_as_within_the_whole() {
    let Some(bytes) = epochs(105) else { return };
    let capture = Capture::of(bytes, None).unwrap();
    let whole = run(&capture.lumps(&[], &Window::ALL).unwrap().lumps, None);
    let window = Window { from_s: 50.0, to_s: 100.0, every_s: 7.0 };
    let prepared = capture.lumps(&[], &window).unwrap();
    // The ionosphere coefficients from before the window come as a command.
    let ionosphere = prepared.klobuchar.map(|values| values.map(|value| format!("{value:e}")).join(","));
    let setup: Vec<String> = ionosphere.iter().map(|values| format!("IONO,{values}")).collect();
    let have = run_with(&prepared.lumps, None, &setup);
    let seconds: Vec<f64> = have.iter().map(|moment| moment.elapsed_s).collect();
    assert_eq!(seconds, [50.0, 57.0, 64.0, 71.0, 78.0, 85.0, 92.0, 99.0]);
    for moment in &have {
        let want = whole.iter().find(|other| other.time == moment.time).unwrap().output.as_ref().unwrap();
        let have = moment.output.as_ref().unwrap();
        assert_eq!((&have.state.reason, have.state.used), (&want.state.reason, want.state.used));
        let apart_m = have.position.unwrap().to_ecef().distance_m(want.position.unwrap().to_ecef());
        // The first fix of the part has no starting point, that of the whole starts from the fix
        // before.
        assert!(apart_m < 0.1, "{apart_m} m");
    }
}

/// The module counts the same for `STATS`, over its last minute.
#[test]
fn sigma_check_is_that_of_the_module_under_every_method() {
    if STREAMS[1].bytes().is_none() {
        return;
    }
    let selection = Selection::new("GCE", Frequency::Dual).unwrap();
    let window = Window { to_s: 30.0, ..Window::ALL };
    let lumps = replay::encode(&STREAMS[1].recording(), &selection, &[], &window).unwrap();
    for method in ["AUTO", "BAARDA", "SEPARATION"] {
        let setup = [format!("METHOD,{method}")];
        let reported = replay::on_host(&lumps, &setup, Pace::Recorded, |_| ()).unwrap();
        let of_module = reported.counters.iter().find(|(name, _)| name == "sigma_check_pct").unwrap().1;
        let summary = Summary::of(&replay::track(&lumps, &reported, None), &[], false);
        assert_eq!(summary.protected, summary.epochs, "{method}");
        let have = summary.sigma_check_pct.unwrap();
        assert!((have - f64::from(of_module)).abs() <= 1.0, "{method}: {have} %, {of_module} %");
    }
}
