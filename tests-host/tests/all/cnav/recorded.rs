//! Frames that receivers sent.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::process::Command;

use raim::signal::encode::{Encoder, Frequency, Selection, sbf};
use raim::signal::measurement::{Ephemeris, MeasuredEpoch};
use raim::signal::pieces::{Kind, pieces};
use raim::signal::sky::raw::Simulation;
use raim_core::epoch::Epoch;
use raim_core::frame::Ecef;
use raim_core::satellite::SatelliteId;
use raim_firmware::correction::{CAPACITY, Site, Sky, Tally, ionosphere_free, locate};
use raim_firmware::ephemeris::{CnavContent, Store};
use raim_firmware::input::{Event, Input};
use raim_firmware::raw::{Band, RawEpoch, RawSignal};
use raim_firmware::settings::Systems;
use raim_firmware::time::GpsTime;
use rig::{shared, skip};

use super::{delays, gps, heard, unpacked};

/// A u-blox X20P on foot, with ranges and bits of one device.
const WALK: &str = "data/real/x20p_walk.ubx.gz";

/// An hour of frames of L2C and L5 of a Septentrio receiver: week, time of week, satellite, signal,
/// bytes and the 300 bits in hexadecimal digits.
const HOUR: &str = "data/cnav/046r_gpscnav.txt.gz";

/// Where the walk began.
const PLACE: Ecef = Ecef::new(-1_276_963.492, -4_717_218.433, 4_087_222.466);

#[test]
fn a_walking_receiver_sends_148_frames_and_seven_satellites_call_l5_unhealthy() {
    let Some(bytes) = unpacked(WALK) else { return };
    let is_cnav = |frame: &[u8]| frame.get(6) == Some(&0) && matches!(frame.get(8), Some(3 | 4 | 6 | 7));
    let sent = pieces(&bytes).filter(|piece| piece.kind == Kind::SFRBX && is_cnav(piece.bytes)).count();
    let (frames, counters) = heard(&bytes);
    println!("{} of {sent} frames; {counters:?}", frames.len());
    assert_eq!((sent, frames.len()), (148, 148));
    assert_eq!([counters.subframes_malformed, counters.subframes_parity], [0; 2]);
    assert!(frames.iter().all(|frame| !frame.is_alert));
    let health = |frame: &raim_firmware::ephemeris::CnavFrame| match frame.content {
        CnavContent::Health { out } => Some((frame.satellite, out)),
        _ => None,
    };
    let health: Vec<_> = frames.iter().filter_map(health).collect();
    let satellites: BTreeSet<SatelliteId> = health.iter().map(|(satellite, _)| *satellite).collect();
    println!("L5 out of service: {} messages of {} satellites", health.len(), satellites.len());
    assert_eq!(satellites.len(), 7);
    assert!(health.iter().all(|(_, out)| *out == [false, false, true]), "{health:?}");
}

/// Returns the epoch with two bands of GPS alone, of satellites whose three bands are strong enough.
fn with(raw: &RawEpoch, bands: [Band; 2], mask_dbhz: f32) -> RawEpoch {
    let mut raw = raw.clone();
    raw.satellites.retain(|satellite| {
        let is_strong = |signal: &RawSignal| signal.cn0_dbhz().is_some_and(|cn0_dbhz| cn0_dbhz >= mask_dbhz);
        satellite.signals.len() == 3 && satellite.signals.iter().all(is_strong)
    });
    for satellite in &mut raw.satellites {
        satellite.signals.retain(|signal| bands.contains(&signal.carrier.band));
    }
    raw.satellites.retain(|satellite| satellite.signals.len() == 2);
    raw
}

/// Returns the ranges of an epoch as the module corrects them.
fn corrected(raw: &RawEpoch, store: &Store) -> BTreeMap<SatelliteId, f64> {
    let (mut sky, mut tally, mut epoch) = (Sky::new(), Tally::default(), Epoch::<CAPACITY>::new(0.0));
    locate(raw, store, 0.0, Systems::AT_START, &mut tally, &mut sky);
    Site::new(PLACE, raw.time, -1.5, None).correct(&sky, &mut tally, &mut epoch);
    epoch.observations().iter().map(|seen| (seen.satellite, seen.range_m)).collect()
}

/// Returns the ranges of an epoch free of the ionosphere, without any correction.
fn uncorrected(raw: &RawEpoch) -> BTreeMap<SatelliteId, f64> {
    let range = |satellite: &raim_firmware::raw::RawSatellite| {
        let (one, two) = (satellite.signals[0], satellite.signals[1]);
        let (first, second) = ionosphere_free(one.carrier.band, two.carrier.band);
        first * one.range_m + second * two.range_m
    };
    raw.satellites.iter().map(|satellite| (satellite.satellite, range(satellite))).collect()
}

/// Means of the difference of two ranges of each satellite.
#[derive(Default)]
struct Difference(BTreeMap<SatelliteId, (f64, usize)>);

impl Difference {
    fn add(&mut self, one_m: &BTreeMap<SatelliteId, f64>, other_m: &BTreeMap<SatelliteId, f64>) {
        for (satellite, one_m) in one_m {
            if let Some(other_m) = other_m.get(satellite) {
                let (sum_m, count) = self.0.entry(*satellite).or_default();
                (*sum_m, *count) = (*sum_m + one_m - other_m, *count + 1);
            }
        }
    }

    /// Returns the standard deviation over the satellites, m.
    fn spread_m(&self, satellites: &BTreeSet<SatelliteId>) -> f64 {
        let means_m: Vec<f64> = (self.0.iter())
            .filter(|(satellite, _)| satellites.contains(satellite))
            .map(|(_, (sum_m, count))| sum_m / *count as f64)
            .collect();
        let mean_m = means_m.iter().sum::<f64>() / means_m.len() as f64;
        let squares_m2 = means_m.iter().map(|one_m| (one_m - mean_m).powi(2)).sum::<f64>();
        (squares_m2 / means_m.len() as f64).sqrt()
    }
}

/// L1/L2C and L1/L5 of one satellite differ by its delays alone. Its orbit cancels: those of a
/// simulation, without group delays, serve all satellites.
#[test]
fn the_corrections_of_a_walking_receiver_join_its_ranges_of_l2_and_l5() {
    let Some(bytes) = unpacked(WALK) else { return };
    let (mut input, mut plain, mut epochs) = (Input::new(), Store::new(), Vec::new());
    input.feed(&bytes, 0, |event| {
        if let Event::Epoch(raw, _) = event {
            epochs.push(raw.clone());
        }
    });
    let origin = GpsTime { week: epochs[0].time.week, tow_ms: epochs[0].time.tow_ms / 16_000 * 16_000 };
    let mut orbits = Simulation { origin, ..Simulation::above_xian(0.0, 1, 1) }.ephemerides();
    // The simulation has 31 satellites, the walk one more.
    let mut more = orbits.iter().find(|one| one.satellite == gps(31)).expect("G31").clone();
    if let Ephemeris::Gps(message) = &mut more.message {
        (more.satellite, message.gps_satellite_id) = (gps(32), 32);
    }
    orbits.push(more);
    let sets = Encoder::new(&orbits, Selection::new("G", Frequency::Dual).unwrap())
        .epoch(&MeasuredEpoch { time: origin, satellites: Vec::new() })
        .unwrap();
    Input::new().feed(&sets, 0, |event| {
        if let Event::Ephemeris(ephemeris) = event {
            plain.insert(ephemeris, None);
        }
    });
    plain.redate(epochs[0].time);
    let (frames, mut told) = (heard(&bytes).0, plain.clone());
    for frame in &frames {
        told.hear_cnav(frame, 0);
    }
    let all: BTreeSet<SatelliteId> = delays(&frames).into_keys().collect();
    // The setting at start, and strong signals alone, which reflections on foot disturb less.
    for (mask_dbhz, want_m) in [(28.0, 0.6), (35.0, 0.5)] {
        let [mut raw_m, mut before_m, mut after_m] = [(); 3].map(|()| Difference::default());
        for raw in &epochs {
            let two = [Band::L2, Band::L5].map(|second| with(raw, [Band::L1, second], mask_dbhz));
            let [l2, l5] = &two;
            raw_m.add(&uncorrected(l2), &uncorrected(l5));
            before_m.add(&corrected(l2, &plain), &corrected(l5, &plain));
            after_m.add(&corrected(l2, &told), &corrected(l5, &told));
        }
        let [raw, before, after] = [&raw_m, &before_m, &after_m].map(|of| of.spread_m(&all));
        println!(
            "L1/L2C less L1/L5 of {} satellites from {mask_dbhz} dB-Hz on: {raw:.2} m as measured, \
             {before:.2} → {after:.2} m",
            after_m.0.len()
        );
        assert_eq!((all.len(), after_m.0.len()), (7, 7));
        assert!((raw - before).abs() < 1e-3, "without delays the ranges are those of the receiver");
        assert!((3.1..3.3).contains(&before) && after <= want_m, "{before} → {after}");
    }
}

/// A frame of the hour: satellite, block of its signal, source of SBF, bits as bytes.
struct Line {
    time: GpsTime,
    satellite: u8,
    source: u8,
    bytes: Vec<u8>,
}

fn lines(text: &str) -> Vec<Line> {
    let parsed = |line: &str| {
        let fields: Vec<&str> = line.split_whitespace().collect();
        let [week, tow_s, satellite, source, _, digits] = fields[..] else { panic!("{line}") };
        let byte = |at: usize| u8::from_str_radix(&digits[2 * at..2 * at + 2], 16).unwrap();
        Line {
            time: GpsTime { week: week.parse().unwrap(), tow_ms: 1000 * tow_s.parse::<u32>().unwrap() },
            satellite: satellite.parse().unwrap(),
            source: source.parse().unwrap(),
            bytes: (0..40).map(byte).collect(),
        }
    };
    text.lines().map(parsed).collect()
}

impl Line {
    /// Returns the block as the receiver sent it.
    fn block(&self) -> Vec<u8> {
        let number = if self.source == 3 { 4018 } else { 4019 };
        let mut body = vec![self.satellite, 1, 0, self.source, 0, 0];
        for word in self.bytes.as_chunks::<4>().0 {
            body.extend(u32::from_be_bytes(*word).to_le_bytes());
        }
        sbf::block(number, self.time, &body)
    }

    /// Returns a field by its place in GNSS-SDR's `GPS_CNAV.h`, which counts from 1.
    fn field(&self, (start, width): (usize, usize)) -> u32 {
        let bit = |at: usize| u32::from(self.bytes[at / 8] >> (7 - at % 8) & 1);
        (start - 1..start - 1 + width).fold(0, |field, at| field << 1 | bit(at))
    }

    fn signed(&self, place: (usize, usize)) -> i16 {
        let unused = 32 - place.1;
        ((self.field(place) << unused).cast_signed() >> unused) as i16
    }
}

#[test]
fn an_hour_of_a_septentrio_is_read_without_a_refusal_and_as_another_program_reads_it() {
    let Some(text) = unpacked(HOUR) else { return };
    let lines = lines(std::str::from_utf8(&text).unwrap());
    let bytes: Vec<u8> = lines.iter().flat_map(Line::block).collect();
    let (frames, counters) = heard(&bytes);
    println!("{} of {} frames", frames.len(), lines.len());
    assert_eq!((frames.len(), counters.subframes), (lines.len(), lines.len() as u32), "{counters:?}");
    let [mut of_health, mut of_delays] = [0; 2];
    for (line, frame) in lines.iter().zip(&frames) {
        assert_eq!(frame.satellite.number(), line.satellite);
        assert_eq!(
            (line.field((9, 6)), frame.is_alert),
            (u32::from(line.satellite), line.field((38, 1)) == 1)
        );
        match (line.field((15, 6)), frame.content) {
            (10, CnavContent::Health { out }) => {
                assert_eq!(out, [52, 53, 54].map(|at| line.field((at, 1)) == 1));
                of_health += 1;
            }
            (30, CnavContent::Delays(delays)) => {
                assert_eq!(delays.steps, [128, 141, 154, 167, 180].map(|at| line.signed((at, 13))));
                of_delays += 1;
            }
            (kind, content) => assert!(kind != 10 && kind != 30, "{kind}: {content:?}"),
        }
    }
    println!("{of_health} of health, {of_delays} of delays");
    assert!(of_health > 1000 && of_delays > 1000);
}

#[test]
fn delays_are_those_of_the_independent_reader() {
    let (Some(text), Some(tool)) = (unpacked(HOUR), shared::path_or_skip("tools/isc.py")) else { return };
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("hour.txt");
    std::fs::write(&file, &text).unwrap();
    let Ok(output) = Command::new("python3").arg(tool).arg(file).output() else {
        return skip::say("python3");
    };
    let lines = lines(std::str::from_utf8(&text).unwrap());
    let (frames, _) = heard(&lines.iter().flat_map(Line::block).collect::<Vec<u8>>());
    let mut have = String::new();
    for (satellite, steps) in delays(&frames) {
        let _ = write!(have, "{satellite}");
        for steps in steps {
            let metres = f64::from(steps) * 2_f64.powi(-35) * 299_792_458.0;
            let _ = if steps == -4096 { write!(have, "   -  ") } else { write!(have, " {metres:5.2}") };
        }
        have.push('\n');
    }
    let reported = String::from_utf8(output.stdout).unwrap();
    let want: Vec<&str> = reported.lines().filter(|line| line.starts_with('G')).collect();
    assert!(want.len() >= 9, "{reported}");
    for (have, want) in have.lines().zip(&want) {
        println!("{have}");
        assert!(want.starts_with(have), "{have}, not {want}");
    }
    assert_eq!(have.lines().count(), want.len());
}
