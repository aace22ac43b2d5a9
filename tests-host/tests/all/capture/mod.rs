//! Captures of a receiver through the module: the epochs of an independent program's streams, with
//! any defects of the file, and with injected faults.

mod date;
mod injection;

use std::fs::File;
use std::io::{Read as _, Write as _};
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use flate2::Compression;
use flate2::read::GzDecoder;
use flate2::write::GzEncoder;
use raim::replay::{self, Lump, Moment, Pace, Summary, Track, Truth, Window};
use raim::signal::capture::{self, Capture, Orbits};
use raim::signal::encode::{Frequency, Selection, ubx};
use raim::signal::fault::Fault;
use raim::signal::measurement::MeasuredEpoch;
use raim::signal::pieces::{Kind, pieces};
use raim::signal::recording::Recording;
use raim_firmware::time::GpsTime;
use rand::{Rng as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
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
            Truth::from_csv(&path(self.truth)).unwrap()
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
    let said = replay::on_host(lumps, setup, Pace::Recorded, |_| ()).unwrap();
    replay::track(lumps, &said, truth).unwrap()
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
        assert_eq!(capture.missing(), None, "{}", stream.name);
        let have = run(&capture.lumps(&[], &Window::ALL).unwrap().lumps, Some(&truth));

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
        let setup: Vec<String> = ionosphere.iter().map(|values| format!("IONO,{values}")).collect();
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
fn a_capture_that_breaks_off_anywhere_has_the_epochs_before() {
    let Some(bytes) = epochs(12) else { return };
    let whole = judged(&bytes, &[]);
    // Ends of the frames of ranges.
    let mut end = 0;
    let ends: Vec<usize> = pieces(&bytes)
        .filter_map(|piece| {
            end += piece.bytes.len();
            (piece.kind == Kind::RAWX).then_some(end)
        })
        .collect();
    assert_eq!(whole.len(), ends.len());
    for length in (ends[0]..bytes.len()).step_by(97).chain(ends.clone()) {
        let want = ends.partition_point(|end| *end <= length);
        assert_eq!(judged(&bytes[..length], &[]), whole[..want], "the first {length} bytes");
    }
    for start in (1..ends[ends.len() - 3]).step_by(997) {
        let lost = ends.partition_point(|end| *end < start + 1);
        let begins_in_ranges = pieces(&bytes[start..]).next().is_some_and(|piece| piece.kind == Kind::Rest);
        let have = times(&judged(&bytes[start..], &[]));
        let want = times(&whole)[lost..].to_vec();
        assert!(have == want || begins_in_ranges && have == want[1..], "from byte {start}");
    }
}

#[test]
fn noise_between_frames_costs_no_epoch() {
    /// Beginnings of frames that announce more bytes than follow.
    const FALSE: [&[u8]; 5] = [
        &[0xB5, 0x62, 0x02, 0x15, 0xF0, 0x10],
        &[0xB5, 0x62, 0x01, 0x07, 0xFF, 0x03],
        &[0xD3, 0x03, 0xFF],
        b"$GNRMC,120041.00,A*",
        &[0xB5, 0x62, 0xB5],
    ];
    let Some(bytes) = epochs(40) else { return };
    let whole = judged(&bytes, &[]);
    let mut random = ChaCha8Rng::seed_from_u64(7);
    for round in 0..8 {
        let mut noisy = Vec::new();
        for piece in pieces(&bytes) {
            // More of the long ones in a row would be too expensive: the module checks four bytes
            // for each received one.
            if random.random_bool(0.02) {
                noisy.extend_from_slice(FALSE[random.random_range(0..FALSE.len())]);
            }
            if random.random_bool(0.1) {
                noisy.extend((0..random.random_range(1..60)).map(|_| random.random::<u8>()));
            }
            noisy.extend_from_slice(piece.bytes);
        }
        let have = judged(&noisy, &[]);
        assert_eq!(times(&have), times(&whole), "round {round}");
        for (have, want) in have.iter().zip(&whole) {
            assert_eq!(have.output, want.output, "round {round}: {:?}", want.time);
        }
    }
}

#[test]
fn a_frame_of_ranges_that_is_damaged_costs_its_epoch_and_no_other() {
    let Some(bytes) = epochs(24) else { return };
    let whole = times(&judged(&bytes, &[]));
    for hurt in 0..whole.len() {
        let (mut damaged, mut seen) = (Vec::new(), 0);
        for piece in pieces(&bytes) {
            let begin = damaged.len();
            damaged.extend_from_slice(piece.bytes);
            if piece.kind == Kind::RAWX {
                match hurt % 3 {
                    _ if seen != hurt => {}
                    0 => damaged[begin + 100] ^= 4,
                    1 => damaged.truncate(begin + 200),
                    _ => drop(damaged.drain(begin..begin + 50)),
                }
                seen += 1;
            }
        }
        let mut want = whole.clone();
        want.remove(hurt);
        assert_eq!(times(&judged(&damaged, &[])), want, "epoch {hurt}");
    }
}

/// Reads standard input if [`every_way_in_gives_the_same_bytes`] has started it, and reports the
/// result.
#[test]
fn standard_input_of_a_child() {
    let Some(path) = std::env::var_os("RAI_CAPTURE_WANT") else { return };
    assert!(capture::read("-", f64::INFINITY).unwrap() == std::fs::read(path).unwrap(), "other bytes");
    println!("the same bytes");
}

#[test]
fn every_way_in_gives_the_same_bytes() {
    let Some(want) = epochs(6) else { return };
    let folder = tempfile::tempdir().unwrap();
    let (plain, packed) = (folder.path().join("plain"), folder.path().join("packed"));
    std::fs::write(&plain, &want).unwrap();
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(&want).unwrap();
    let gz = encoder.finish().unwrap();
    std::fs::write(&packed, &gz).unwrap();
    let read = |name: &str| capture::read(name, 1.0).unwrap();
    let name = |path: &Path| path.display().to_string();
    assert!(read(&name(&plain)) == want && read(&name(&packed)) == want);
    assert!(read(&format!("serial:{}", name(&plain))) == want);

    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    let served = want.clone();
    let server = std::thread::spawn(move || {
        let (mut stream, _) = listener.accept().unwrap();
        served.chunks(999).for_each(|chunk| stream.write_all(chunk).unwrap());
    });
    assert!(read(&format!("tcp://{address}")) == want);
    server.join().unwrap();

    for sent in [&want, &gz] {
        let mut child = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "capture::standard_input_of_a_child", "--nocapture"])
            .env("RAI_CAPTURE_WANT", &plain)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        child.stdin.take().unwrap().write_all(sent).unwrap();
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success());
        assert!(String::from_utf8_lossy(&output.stdout).contains("the same bytes"));
    }
}

#[test]
fn what_has_no_end_needs_one() {
    for name in ["tcp://127.0.0.1:9", "serial:/dev/ttyS0", "/dev/ptmx"] {
        let error = format!("{:#}", capture::read(name, f64::INFINITY).unwrap_err());
        assert!(error.contains("--to"), "{name}: {error}");
    }
}

#[test]
fn what_no_message_has_room_for_is_refused() {
    let stream = &STREAMS[1];
    let Some(bytes) = epochs(6) else { return };
    let window = Window { to_s: 5.0, ..Window::ALL };
    let selection = Selection::new("G", Frequency::Dual).unwrap();
    let recorded = replay::encode(&stream.recording(), &selection, &[], &window).unwrap();
    let rtcm = Capture::of(recorded.into_iter().flat_map(|lump| lump.bytes).collect(), None).unwrap();
    let ubx = Capture::of(bytes, None).unwrap();
    let satellite = rtcm.content().satellites()[0];
    for (capture, text, want) in [
        (&rtcm, format!("{satellite}:+1e9@2.."), "has no room"),
        (&rtcm, "E31:+100@2..".to_owned(), "E31 is never received; the satellites are"),
        (&ubx, "G99".to_owned() + ":+1@2..", ""),
    ] {
        let Ok(fault) = Fault::parse_inject(&text) else { continue };
        let error = format!("{:#}", capture.lumps(&[fault], &Window::ALL).unwrap_err());
        assert!(error.contains(want), "{text}: {error}");
    }
    let window = Window { from_s: 1e4, ..Window::ALL };
    let error = format!("{:#}", ubx.lumps(&[], &window).unwrap_err());
    assert!(error.contains("no epoch between 10000 s"), "{error}");
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

#[test]
fn ranges_without_orbits_say_what_to_switch_on_and_take_them_from_a_file() {
    let Some(bytes) = epochs(24) else { return };
    let stream = &STREAMS[1];
    let of = |kept: &dyn Fn(Kind) -> bool, bytes: &[u8]| -> Vec<u8> {
        pieces(bytes).filter(|piece| kept(piece.kind)).flat_map(|piece| piece.bytes).copied().collect()
    };
    let orbits =
        || Orbits::load(&stream.navigation(), &Selection::new("GCE", Frequency::Dual).unwrap()).unwrap();
    let ranges = of(&|kind| kind == Kind::RAWX, &bytes);
    let capture = Capture::of(ranges.clone(), None).unwrap();
    let track = run(&capture.lumps(&[], &Window::ALL).unwrap().lumps, None);
    assert!(track.iter().all(|moment| moment.output.as_ref().unwrap().state.reason == "EPHEMERIS"));
    let missing = capture.missing().unwrap();
    assert!(missing.contains("RXM-SFRBX") && missing.contains("--nav"), "{missing}");

    let capture = Capture::of(ranges, Some(orbits())).unwrap();
    assert_eq!(capture.missing(), None);
    let track = run(&capture.lumps(&[], &Window::ALL).unwrap().lumps, None);
    assert!(track.iter().all(is_protected));

    // This RTCM carries neither the orbits nor the week.
    let selection = Selection::new("GCE", Frequency::Dual).unwrap();
    let window = Window { to_s: 20.0, ..Window::ALL };
    let recorded = replay::encode(&stream.recording(), &selection, &[], &window).unwrap();
    let rtcm: Vec<u8> = recorded.iter().flat_map(|lump| lump.bytes.clone()).collect();
    let ranges = of(&|kind| kind.has_ranges(), &rtcm);
    let error = Capture::of(ranges.clone(), None).err().map(|error| format!("{error:#}")).unwrap();
    assert!(error.contains("1019") && error.contains("--nav"), "{error}");
    let capture = Capture::of(ranges, Some(orbits())).unwrap();
    assert_eq!(run(&capture.lumps(&[], &Window::ALL).unwrap().lumps, None), run(&recorded, None));
}

#[test]
fn orbits_of_another_day_are_refused() {
    let Some(bytes) = epochs(24) else { return };
    let other = [path(STREAMS[3].navigation[0])];
    let orbits = Orbits::load(&other, &Selection::new("GCE", Frequency::Dual).unwrap()).unwrap();
    let error = Capture::of(bytes, Some(orbits)).err().map(|error| format!("{error:#}")).unwrap();
    assert!(error.contains("2024-06-24") && error.contains("2024-01-02"), "{error}");
}

#[test]
fn what_is_no_capture_is_refused_by_name() {
    let line = "$GNGGA,120041.00,3520.3592243,N,13931.3304234,E,1,19,0.59,65.560,M,0.0,M,,*4B\r\n";
    let sum = line[1..line.find('*').unwrap()].bytes().fold(0_u8, |sum, byte| sum ^ byte);
    let nmea = line.replace("*4B", &format!("*{sum:02X}")).repeat(9);
    let rinex =
        |kind: &str| format!("     3.04           {kind:<20}M                   RINEX VERSION / TYPE\n");
    let position = ubx::frame([0x01, 0x07], &[0; 92]).repeat(3);
    let without_week = ubx::frame([0x02, 0x15], &[&[0; 13][..], &[1, 0, 0]].concat());
    for (bytes, want) in [
        (Vec::new(), "is empty"),
        (nmea.into_bytes(), "9 lines of NMEA and no ranges"),
        (b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR".to_vec(), "a picture"),
        (b"%PDF-1.7 etc".to_vec(), "a PDF"),
        (b"week,tow,x_m,y_m,z_m\n".to_vec(), "text"),
        (vec![0; 9999], "no frame of UBX or RTCM 3"),
        (rinex("OBSERVATION DATA").into_bytes(), "RINEX observation file: give it with --obs"),
        (rinex("NAVIGATION DATA").into_bytes(), "RINEX navigation file: give it with --nav"),
        (position, "3 NAV-PVT, and no ranges: the module needs"),
        (without_week, "RXM-RAWX: in none of them the receiver knows the week"),
    ] {
        let error = Capture::of(bytes, None).err().map(|error| format!("{error:#}")).unwrap();
        assert!(error.contains(want), "{want}: {error}");
    }
}
