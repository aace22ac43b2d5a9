//! Streams that an independent program made of the recordings: the same epochs, the same
//! ephemerides.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read;
use std::path::PathBuf;

use flate2::read::GzDecoder;
use raim::signal::measurement::MeasuredEpoch;
use raim::signal::pieces::{Kind, Piece, pieces};
use raim::signal::recording::Recording;
use raim_core::satellite::{Constellation, SatelliteId};
use raim_firmware::ephemeris::Ephemeris;
use raim_firmware::input::{Counters, Event, Input};
use raim_firmware::navigator::Navigator;
use raim_firmware::raw::{Band, RawEpoch};
use raim_firmware::settings::{Configuration, Frequencies, Systems};
use rig::shared;

use super::{Reported, by_rtcm};

/// A stream, and its source files.
pub(super) struct Stream {
    pub(super) name: &'static str,
    pub(super) observations: &'static str,
    pub(super) navigation: &'static [&'static str],
}

pub(super) const STREAMS: [Stream; 5] = [
    Stream {
        name: "esbc_4h",
        observations: "esbc/ESBC00DNK_R_20201770000_01D_30S_MO.crx.gz",
        navigation: &["esbc/ESBC00DNK_R_20201770000_01D_MN.rnx.gz"],
    },
    Stream {
        name: "static1hz_base",
        observations: "static1hz/base.obs.gz",
        navigation: &["static1hz/base.nav.gz"],
    },
    Stream {
        name: "static1hz_rover_f9p_noise",
        observations: "static1hz/rover.obs.gz",
        navigation: &["static1hz/base.nav.gz"],
    },
    Stream {
        name: "tlse_x20p_fnav",
        observations: "tlse/TLSE00FRA_R_20240011200_15M_01S_MO.crx.gz",
        navigation: &["tlse/BRDC00IGS_R_20240010000_01D_MN.rnx.gz"],
    },
    Stream {
        name: "urban_m8t",
        observations: "urban/car.obs.gz",
        navigation: &["urban/gps.nav.gz", "urban/beidou.nav.gz"],
    },
];

impl Stream {
    /// Returns the bytes; reports a skip if they are missing.
    pub(super) fn bytes(&self) -> Option<Vec<u8>> {
        let path = shared::path_or_skip(&format!("data/ubx/{}.ubx.gz", self.name))?;
        let mut bytes = Vec::new();
        GzDecoder::new(File::open(path).unwrap()).read_to_end(&mut bytes).unwrap();
        Some(bytes)
    }

    pub(super) fn recording(&self) -> Recording {
        let path = |name: &&str| -> PathBuf { shared::path(&format!("data/{name}")).unwrap() };
        let navigation: Vec<PathBuf> = self.navigation.iter().map(path).collect();
        Recording::load(&[path(&self.observations)], &navigation).unwrap()
    }
}

/// Sends a stream in lumps that end with an epoch's ranges, a lump a second of the clock.
fn receive(bytes: &[u8]) -> (Reported, Counters, Input) {
    let (mut input, mut reported, mut epochs) = (Input::new(), Reported::default(), 0);
    for lump in bytes.chunks(200) {
        input.feed(lump, 1000 * epochs, |event| reported.receive(&event));
        epochs = reported.epochs.len() as u64;
    }
    let counters = *input.counters();
    (reported, counters, input)
}

/// Returns the band of a satellite's RINEX signal, if both sides have a name for it.
fn band(constellation: Constellation, number: u8, attribute: char) -> Option<Band> {
    Some(match (constellation, number, attribute) {
        (Constellation::Gps, 1, 'C') => Band::L1,
        (Constellation::Gps, 2, 'L' | 'S' | 'X') => Band::L2,
        (Constellation::Gps, 5, 'I' | 'Q' | 'X') => Band::L5,
        (Constellation::Galileo, 1, _) => Band::E1,
        (Constellation::Galileo, 5, _) => Band::E5a,
        (Constellation::Galileo, 7, _) => Band::E5b,
        (Constellation::Beidou, 2, _) => Band::B1I,
        (Constellation::Beidou, 7, 'I') => Band::B2I,
        (Constellation::Beidou, 6, _) => Band::B3I,
        (Constellation::Beidou, 1, _) => Band::B1C,
        (Constellation::Beidou, 5, _) => Band::B2a,
        (Constellation::Glonass, 1, 'C') => Band::G1,
        (Constellation::Glonass, 2, 'C') => Band::G2,
        _ => return None,
    })
}

/// Compares every range of an epoch with the recording's; returns their number.
fn compare(have: &RawEpoch, want: &MeasuredEpoch) -> usize {
    /// Distance that light travels in a microsecond, m.
    const MOST_MOVED_M: f64 = 300.0;
    let (mut compared, mut moved_m) = (0, None);
    for satellite in &have.satellites {
        // Recordings are read without QZSS.
        if satellite.satellite.is_qzss() {
            continue;
        }
        let constellation = satellite.satellite.constellation();
        let measured = want.satellites.iter().find(|measured| measured.satellite == satellite.satellite);
        let measured = measured.unwrap_or_else(|| panic!("{}: not recorded", satellite.satellite));
        for signal in &satellite.signals {
            let ranges = measured.signals.iter().filter(|recorded| {
                band(constellation, recorded.band, recorded.attribute) == Some(signal.carrier.band)
            });
            // A tag that is not a whole millisecond moves all ranges equally; the recording's
            // reader rounds it.
            let differences = ranges.clone().map(|recorded| signal.range_m - recorded.pseudorange_m);
            let moved_m = *moved_m.get_or_insert(differences.clone().next().unwrap_or(f64::NAN));
            assert!(moved_m.abs() < MOST_MOVED_M, "{}: {moved_m} m", satellite.satellite);
            let found = differences.clone().any(|difference_m| (difference_m - moved_m).abs() < 1e-6);
            assert!(found, "{} {:?}: {} of {:?}", satellite.satellite, signal, { signal.range_m }, measured);
            compared += 1;
        }
    }
    compared
}

#[test]
fn streams_of_an_independent_program_hold_the_epochs_and_ephemerides_of_their_recordings() {
    for stream in STREAMS {
        let Some(bytes) = stream.bytes() else { return };
        let recording = stream.recording();
        let mut want: BTreeMap<SatelliteId, Vec<Ephemeris>> = BTreeMap::new();
        for ephemeris in &recording.ephemerides {
            want.entry(ephemeris.satellite).or_default().extend(by_rtcm(ephemeris));
        }
        let (reported, counters, input) = receive(&bytes);
        let of_kepler = reported.ephemerides.iter().filter(|ephemeris| {
            let satellite = ephemeris.satellite();
            satellite.constellation() != Constellation::Glonass && !satellite.is_qzss()
        });
        let mut ephemerides = 0;
        for have in of_kepler {
            let known = want.get(&have.satellite()).is_some_and(|known| known.contains(have));
            assert!(known, "{}: not broadcast: {have:?}", stream.name);
            ephemerides += 1;
        }
        let mut ranges = 0;
        for have in &reported.epochs {
            let recorded = recording.epochs.iter().find(|epoch| epoch.time == have.time);
            ranges += compare(have, recorded.unwrap_or_else(|| panic!("{:?} is no epoch", have.time)));
        }
        println!(
            "{}: {} epochs with {ranges} ranges, {ephemerides} ephemerides, leap second {:?}",
            stream.name,
            reported.epochs.len(),
            input.leap_second()
        );
        let nonzero: Vec<_> = counters.iter().filter(|(_, count)| *count > 0).collect();
        println!("    {nonzero:?}");
        assert!(ephemerides > 400 && ranges > 9_000, "{}", stream.name);
        // The bits of CNAV are random there, so that its CRC is wrong.
        let is_cnav = |frame: &[u8]| {
            let [system, _, signal, _, words, ..] = frame[6..] else { return false };
            words == 10 && matches!((system, signal), (0, 3 | 4 | 6 | 7) | (5, 4 | 5 | 8 | 9))
        };
        let cnav = pieces(&bytes).filter(|piece| piece.kind == Kind::SFRBX && is_cnav(piece.bytes)).count();
        let refused = [counters.subframes_parity, counters.subframes_surplus];
        assert_eq!(refused, [cnav as u32, 0], "{}", stream.name);
        assert_eq!(input.leap_second().map(|leap| leap.seconds), Some(18), "{}", stream.name);
    }
}

/// Returns the frames of navigation bits of `BeiDou` satellites, and all ranges.
fn of_beidou_alone(bytes: &[u8]) -> Vec<u8> {
    let is_kept = |piece: &Piece<'_>| match (piece.kind, piece.bytes.get(6)) {
        (Kind::Ubx([0x02, 0x13]), Some(system)) => *system == 3,
        (kind, _) => kind == Kind::RAWX,
    };
    pieces(bytes).filter(is_kept).flat_map(|piece| piece.bytes).copied().collect()
}

#[test]
fn beidou_says_its_own_coefficients_of_the_ionosphere() {
    // The coefficients of C02 in the header of the navigation file, and those of the file that has
    // no others.
    let toulouse = [3.1665e-8, 9.6858e-8, -1.1325e-6, 1.7285e-6, 1.3107e5, -2.1299e5, 1.3107e5, 5.8982e5];
    let nagoya = [1.8626e-8, 2.2352e-8, -1.1921e-7, -5.9605e-8, 1.2902e5, 1.6384e5, -1.9661e5, -2.6214e5];
    for (stream, want) in [(&STREAMS[3], toulouse), (&STREAMS[1], nagoya)] {
        let Some(bytes) = stream.bytes() else { return };
        let (reported, _, _) = receive(&of_beidou_alone(&bytes));
        assert!(reported.ionosphere.len() > 100, "{}: {}", stream.name, reported.ionosphere.len());
        for (of, have) in reported.ionosphere {
            assert_eq!(of, Constellation::Beidou);
            // The file has five digits.
            let is_same = have.iter().zip(want).all(|(have, want)| (have / want - 1.0).abs() < 1e-4);
            assert!(is_same, "{}: have {have:?}, want {want:?}", stream.name);
        }
    }
}

/// For one frequency of `BeiDou` alone, half of the possible ionosphere is removed once the
/// satellites have sent their coefficients.
#[test]
fn a_receiver_of_beidou_alone_has_a_model_of_the_ionosphere() {
    let Some(bytes) = STREAMS[1].bytes() else { return };
    let bytes = of_beidou_alone(&bytes);
    let last_hpl_m = |hears: bool| {
        let mut configuration = Configuration::at_start();
        configuration.systems = Systems::of("C").unwrap();
        configuration.frequencies = Frequencies::Single;
        let mut navigator = Navigator::new(configuration.requirements()).unwrap();
        let (mut input, mut now, mut hpl_m) = (Input::new(), None, None);
        input.feed(&bytes, 0, |event| match event {
            Event::Ephemeris(ephemeris) => drop(navigator.learn(ephemeris, now)),
            Event::Ionosphere(of, coefficients) if hears => {
                navigator.hear_ionosphere(of, coefficients, now);
            }
            Event::Epoch(raw, came_ms) => {
                now = Some(raw.time);
                let levels = navigator.judge(raw, came_ms, &configuration).protection;
                hpl_m = levels.map(|levels| levels.hpl_m).or(hpl_m);
            }
            _ => {}
        });
        hpl_m.unwrap()
    };
    let (with_m, without_m) = (last_hpl_m(true), last_hpl_m(false));
    println!("HPL {with_m:.1} m with the coefficients of BeiDou, {without_m:.1} m without");
    assert!(with_m < 0.7 * without_m, "{with_m} m with, {without_m} m without");
}
