//! A real mosaic: twelve epochs of 45 satellites, with all its raw and decoded blocks.

use std::collections::BTreeMap;

use raim::signal::encode::sbf;
use raim::signal::pieces::{Kind, Piece, pieces};
use raim_core::frame::{Ecef, Geodetic, LocalFrame};
use raim_core::satellite::SatelliteId;
use raim_firmware::ephemeris::{Ephemeris, EphemerisError, Insertion, Store};
use raim_firmware::input::{Event, Input, ReceiverLevels, SelfReport, Suspicion};
use raim_firmware::navigator::Navigator;
use raim_firmware::raw::Band;
use raim_firmware::settings::{Configuration, Systems};
use raim_firmware::time::GpsTime;

use super::{reported, unpacked};
use crate::consumers::printed;

const RECORDING: &str = "sbf/mosaic_12s.sbf.gz";

/// Navigation bits.
const BITS: [u16; 5] = [4017, 4022, 4023, 4026, 4047];

/// Decoded ephemerides, and coefficients of the ionosphere.
const DECODED: [u16; 6] = [5891, 4002, 4081, 4004, 5893, 4120];

/// Returns the blocks with these numbers, in order.
fn only(bytes: &[u8], numbers: &[u16]) -> Vec<u8> {
    let is_wanted = |piece: &Piece<'_>| matches!(piece.kind, Kind::Sbf(number) if numbers.contains(&number));
    pieces(bytes).filter(is_wanted).flat_map(|piece| piece.bytes).copied().collect()
}

/// A range of `pysbf2`.
struct Row {
    range_m: f64,
    doppler_hz: Option<f64>,
    cn0_dbhz: f64,
}

/// Returns the satellite and the band of a row; `None` for a band that is not used.
fn place(svid: u32, signal: u32) -> Option<(SatelliteId, Band)> {
    let (letter, number) = match svid {
        1..=32 => ('G', svid),
        38..=61 => ('R', svid - 37),
        71..=106 => ('E', svid - 70),
        141..=180 => ('C', svid - 140),
        223..=245 => ('C', svid - 182),
        _ => panic!("satellite {svid}"),
    };
    let band = match signal {
        0 => Band::L1,
        2 | 3 => Band::L2,
        8 => Band::G1,
        11 => Band::G2,
        17 => Band::E1,
        21 => Band::E5b,
        28 => Band::B1I,
        29 => Band::B2I,
        _ => panic!("signal {signal}"),
    };
    Some((SatelliteId::from_name(letter, number as u8)?, band))
}

/// Returns the rows of `pysbf2`, by time of week and place, if it is installed. Where a band has two codes, the module
/// uses the first one in the block.
fn rows(bytes: &[u8]) -> Option<BTreeMap<(u32, SatelliteId, u8), Row>> {
    let text = printed("pysbf2", include_str!("measurements.py"), bytes)?;
    let text = String::from_utf8(text).unwrap();
    let mut rows = BTreeMap::new();
    for line in text.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let [tow_ms, svid, signal, _, range_m, doppler_hz, cn0_dbhz] = cells[..] else { panic!("{line}") };
        // A satellite of GLONASS whose slot the receiver does not know.
        if svid == "62" {
            continue;
        }
        let (satellite, band) = place(svid.parse().unwrap(), signal.parse().unwrap()).unwrap();
        let row = Row {
            range_m: range_m.parse().unwrap(),
            doppler_hz: doppler_hz.parse().ok(),
            // The strength of P(Y) has no meaning.
            cn0_dbhz: if signal == "2" { f64::NAN } else { cn0_dbhz.parse().unwrap() },
        };
        rows.entry((tow_ms.parse().unwrap(), satellite, band as u8)).or_insert(row);
    }
    Some(rows)
}

#[test]
fn every_range_doppler_and_strength_is_that_of_pysbf2() {
    /// A step of a stored Doppler frequency, and the rounding of its sum in single precision: four
    /// halves of a last place below 8,192 Hz.
    const DOPPLER_HZ: f64 = 1.0 / 1024.0 + 4.0 * 0.5 / 2048.0;
    let Some(bytes) = unpacked(RECORDING) else { return };
    let Some(mut rows) = rows(&bytes) else { return };
    let (reported, counters) = reported(&only(&bytes, &[4027]));
    assert_eq!(reported.epochs.len(), 12);
    let (mut compared, mut farthest_hz) = (0, 0.0_f64);
    for epoch in &reported.epochs {
        assert_eq!(epoch.clock_jumps_ms, Some(252));
        for (satellite, signal) in epoch
            .satellites
            .iter()
            .flat_map(|one| one.signals.iter().map(move |signal| (one.satellite, signal)))
        {
            let key = (epoch.time.tow_ms, satellite, signal.carrier.band as u8);
            let want = rows.remove(&key).unwrap_or_else(|| panic!("{satellite} {signal:?}"));
            assert!((signal.range_m - want.range_m).abs() < 1e-6, "{satellite} {signal:?}: {}", want.range_m);
            let doppler_hz = signal.doppler_hz().map(f64::from);
            assert_eq!(doppler_hz.is_some(), want.doppler_hz.is_some(), "{satellite} {signal:?}");
            if let Some((have_hz, want_hz)) = doppler_hz.zip(want.doppler_hz) {
                farthest_hz = farthest_hz.max((have_hz - want_hz).abs());
            }
            match signal.cn0_dbhz() {
                Some(cn0_dbhz) => {
                    assert!((f64::from(cn0_dbhz) - want.cn0_dbhz).abs() < 1e-9, "{satellite} {signal:?}");
                }
                None => assert!(want.cn0_dbhz.is_nan() && signal.is_codeless(), "{satellite} {signal:?}"),
            }
            compared += 1;
        }
    }
    println!("{compared} ranges, Doppler within {farthest_hz} Hz");
    assert!(farthest_hz <= DOPPLER_HZ, "{farthest_hz} Hz");
    assert!(rows.is_empty(), "not read: {:?}", rows.keys());
    assert!(compared > 800);
    let wrong = counters.ranges_out_of_bounds + counters.satellites_unknown + counters.signals_other;
    assert_eq!(wrong + counters.crc_failures + counters.messages_malformed + counters.bytes_skipped, 0);
}

#[test]
fn every_frame_of_bits_passes_its_check() {
    let Some(bytes) = unpacked(RECORDING) else { return };
    for number in BITS {
        let blocks: Vec<_> =
            pieces(&bytes).filter(|piece| piece.kind == Kind::Sbf(number)).map(|piece| piece.bytes).collect();
        // The receiver itself has found 16 wrong ones, of BeiDou.
        let wrong = blocks.iter().filter(|block| block[15] == 0).count();
        // The slot of a satellite of GLONASS is not known.
        let unknown = blocks.iter().filter(|block| block[14] == 62).count();
        let (_, counters) = reported(&blocks.concat());
        println!("{number}: {} frames, {wrong} marked as wrong", blocks.len());
        assert_eq!(counters.subframes as usize, blocks.len() - wrong - unknown, "{number}: {counters:?}");
        assert_eq!(counters.subframes_parity as usize, wrong, "{number}");
        assert_eq!(wrong, if number == 4047 { 16 } else { 0 });
    }
    // CNAV is not in the recording; SBAS is framed and counted.
    let (_, counters) = reported(&only(&bytes, &[4020]));
    assert_eq!((counters.subframes_other, counters.subframes), (24, 0));
}

/// Decoded sets and bits of a satellite describe one orbit: both come from one receiver, by two
/// ways.
#[test]
fn decoded_sets_are_the_orbits_of_the_bits() {
    let Some(bytes) = unpacked("sbf/osnma_new_config.sbf.gz") else { return };
    let sets = |number| reported(&only(&bytes, &[number])).0.ephemerides;
    let (decoded, bits) = (sets(4002), sets(4023));
    let mut compared = 0;
    for have in &decoded {
        let same = |want: &&Ephemeris| (want.satellite(), want.toe()) == (have.satellite(), have.toe());
        let Some(want) = bits.iter().find(same) else { continue };
        assert_eq!(have, want);
        compared += 1;
    }
    println!("{compared} of {} sets compared", decoded.len());
    assert!(compared >= 2, "{compared} of {}", decoded.len());
}

/// Of one issue the checked bits stay in use, in either order, and a decoded set that closes the
/// satellite closes it.
#[test]
fn bits_of_an_issue_stay_in_use_beside_its_decoded_set() {
    let Some(bytes) = unpacked("sbf/osnma_new_config.sbf.gz") else { return };
    let at = GpsTime { week: 2277, tow_ms: 72_300_000 };
    let now = Some(at);
    let bits = reported(&only(&bytes, &[4023])).0.ephemerides;
    let (mut compared, mut usable) = (0, 0);
    for block in pieces(&bytes).filter(|piece| piece.kind == Kind::Sbf(4002)) {
        let [decoded] = reported(block.bytes).0.ephemerides[..] else { panic!("one set") };
        let same = |bits: &&Ephemeris| (bits.satellite(), bits.toe()) == (decoded.satellite(), decoded.toe());
        let bits = *bits.iter().find(same).expect("bits of this issue");
        let mut store = Store::new();
        assert_eq!(store.insert(decoded, now), Insertion::Taken);
        assert_eq!(store.insert(bits, now), Insertion::Taken);
        assert_eq!(store.insert(decoded, now), Insertion::Kept);
        let found = store.get(bits.satellite(), at).copied();
        assert_eq!(found, bits.usable_at(at).map(|()| bits));
        usable += usize::from(found.is_ok());
        // The data of E1 without guarantee.
        let mut doubtful = block.bytes.to_vec();
        doubtful[130] |= 0b10;
        let [doubtful] = reported(&sbf::sealed(doubtful)).0.ephemerides[..] else { panic!("one set") };
        assert_eq!(store.insert(doubtful, now), Insertion::Kept);
        assert_eq!(store.get(bits.satellite(), at), Err(EphemerisError::Unhealthy));
        compared += 1;
    }
    println!("{usable} of {compared} usable");
    assert!(compared == 3 && usable > 0, "{usable} of {compared} usable");
}

/// Returns the position in each block of the receiver's own solution, by time of week, ms.
fn own_positions(bytes: &[u8]) -> BTreeMap<u32, Ecef> {
    let of = |block: &[u8]| {
        let number = |at: usize| f64::from_le_bytes(block[at..at + 8].try_into().unwrap());
        let geodetic = Geodetic { latitude_rad: number(16), longitude_rad: number(24), height_m: number(32) };
        (u32::from_le_bytes(block[8..12].try_into().unwrap()), geodetic.to_ecef())
    };
    pieces(bytes).filter(|piece| piece.kind == Kind::Sbf(4007)).map(|piece| of(piece.bytes)).collect()
}

#[test]
fn each_epoch_has_a_position_near_that_of_the_receiver() {
    let Some(bytes) = unpacked(RECORDING) else { return };
    let want = own_positions(&bytes);
    for letters in ["GCE", "GCER"] {
        let mut configuration = Configuration::at_start();
        configuration.systems = Systems::of(letters).unwrap();
        let mut navigator = Navigator::new(configuration.requirements()).unwrap();
        // The receiver sends the first ephemerides behind the first ranges.
        Input::new().feed(&only(&bytes, &DECODED), 0, |event| match event {
            Event::Ephemeris(ephemeris) => drop(navigator.learn(ephemeris, None)),
            Event::Ionosphere(of, coefficients) => navigator.hear_ionosphere(of, coefficients, None),
            _ => {}
        });
        let (mut farthest_m, mut highest_m) = (0.0_f64, 0.0_f64);
        let epochs = reported(&only(&bytes, &[4027])).0.epochs;
        for raw in &epochs {
            let report = navigator.judge(raw, 0, &configuration);
            let have = report.solution.as_ref().unwrap_or_else(|| panic!("{:?}", raw.time)).position;
            let want = want[&raw.time.tow_ms];
            let error = LocalFrame::at(want).rotate(have - want);
            farthest_m = farthest_m.max(error.horizontal());
            highest_m = highest_m.max(error.up.abs());
        }
        println!("{letters}: {} epochs within {farthest_m} m, {highest_m} m vertically", epochs.len());
        assert_eq!(epochs.len(), 12);
        assert!(farthest_m < 3.0 && highest_m < 5.0, "{letters}: {farthest_m} m, {highest_m} m");
    }
}

#[test]
fn the_receiver_reports_as_pysbf2_reads_it() {
    let Some(bytes) = unpacked(RECORDING) else { return };
    let (reported, _) = reported(&only(&bytes, &[4092, 4245, 4001]));
    let levels: Vec<ReceiverLevels> = reported
        .reports
        .iter()
        .filter_map(|report| match report {
            SelfReport::Levels(levels) => *levels,
            _ => None,
        })
        .collect();
    // DOP of the first epoch: HPL 3.630913734436035, VPL 5.65706205368042.
    assert_eq!(levels.len(), 12);
    assert_eq!(levels[0], ReceiverLevels { frame: 10, axes_mm: [3631, 3631, 5657], risk: (0, 0) });
    let quiet = reported.reports.iter().filter(|report| {
        matches!(report, SelfReport::Interference(reported)
            if (reported.jamming, reported.spoofing) == (Some(Suspicion::None), Some(Suspicion::None)))
    });
    assert_eq!(quiet.count(), 12);
    let idle = SelfReport::Authenticity(0, Suspicion::Unknown);
    assert_eq!(reported.reports.iter().filter(|report| **report == idle).count(), 12);
}
