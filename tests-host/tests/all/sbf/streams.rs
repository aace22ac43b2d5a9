//! Streams that an independent program wrote as UBX and as SBF: the module says the same of both.

use raim::replay::Window;
use raim::signal::capture::Capture;
use raim::signal::fault::{Fault, Target};
use raim_core::frame::Ecef;
use raim_core::report::Verdict;
use raim_core::satellite::SatelliteId;
use raim_firmware::input::{Event, Input};
use raim_firmware::navigator::Navigator;
use raim_firmware::settings::{Configuration, Systems};
use raim_firmware::time::GpsTime;

use super::unpacked;

/// Largest distance of positions, m: SBF rounds a range to 1 mm, which the combination of two
/// frequencies triples and the geometry amplifies.
const APART_M: f64 = 5e-3;

/// Largest difference of levels, m: SBF rounds C/N0, and with it the sigmas.
const LEVEL_M: f64 = 0.1;

/// What the module says of an epoch.
struct Reported {
    time: GpsTime,
    verdict: Verdict,
    used: Vec<SatelliteId>,
    position: Option<Ecef>,
    levels_m: Option<[f64; 2]>,
}

fn judged(bytes: &[u8], systems: &str) -> Vec<Reported> {
    let mut configuration = Configuration::at_start();
    configuration.systems = Systems::of(systems).unwrap();
    let mut navigator = Navigator::new(configuration.requirements()).unwrap();
    let (mut input, mut now, mut reported) = (Input::new(), None, Vec::new());
    input.feed(bytes, 0, |event| match event {
        Event::Ephemeris(ephemeris) => drop(navigator.learn(ephemeris, now)),
        Event::Ionosphere(of, coefficients) => navigator.hear_ionosphere(of, coefficients, now),
        Event::Epoch(raw, came_ms) => {
            now = Some(raw.time);
            let report = navigator.judge(raw, came_ms, &configuration);
            reported.push(Reported {
                time: raw.time,
                verdict: report.verdict,
                used: report.used.iter().copied().collect(),
                position: report.solution.as_ref().map(|solution| solution.position),
                levels_m: report.protection.map(|levels| [levels.hpl_m, levels.vpl_m].map(f64::from)),
            });
        }
        _ => {}
    });
    reported
}

/// A fault put into a capture of SBF is found as in its UBX, and a lost satellite is lost.
#[test]
fn faults_in_a_capture_of_sbf_are_those_of_its_ubx() {
    let Some(ubx) = unpacked("ubx/static1hz_base.ubx.gz") else { return };
    let Some(sbf) = unpacked("sbf/static1hz_base.sbf.gz") else { return };
    for fault in ["E11:+100@60..120", "G05:lost@60..120", "E12:-250@60..120"] {
        let fault = Fault::parse_inject(fault).unwrap();
        let judged = |bytes: &[u8]| {
            let lumps = Capture::of(bytes.to_vec(), None).unwrap().lumps(&[fault], &Window::ALL).unwrap();
            judged(&lumps.lumps.into_iter().flat_map(|lump| lump.bytes).collect::<Vec<_>>(), "GCE")
        };
        let (want, have) = (judged(&ubx), judged(&sbf));
        assert_eq!(have.len(), want.len());
        for (have, want) in have.iter().zip(&want) {
            assert_eq!((have.verdict, &have.used), (want.verdict, &want.used), "{:?}", want.time);
        }
        let with = |reported: &[Reported]| {
            reported.iter().filter(|reported| reported.used.contains(&fault_of(&fault))).count()
        };
        println!("{} of {} epochs with the satellite", with(&have), have.len());
        assert!(with(&have) < have.len() - 60, "{fault:?}");
    }
}

/// Returns the satellite of a fault.
fn fault_of(fault: &Fault) -> SatelliteId {
    match fault.target {
        Target::Satellite(satellite) => satellite,
        Target::Constellation(_) | Target::Receiver => panic!("{fault:?}"),
    }
}

#[test]
fn streams_as_sbf_are_judged_as_their_ubx() {
    for name in ["static1hz_base", "tlse_x20p_fnav"] {
        let Some(ubx) = unpacked(&format!("ubx/{name}.ubx.gz")) else { return };
        let Some(sbf) = unpacked(&format!("sbf/{name}.sbf.gz")) else { return };
        for systems in ["GCE", "GCERJ"] {
            let (want, have) = (judged(&ubx, systems), judged(&sbf, systems));
            assert_eq!(have.len(), want.len(), "{name}");
            let (mut fixes, mut apart_m, mut level_m) = (0, 0.0_f64, 0.0_f64);
            for (have, want) in have.iter().zip(&want) {
                assert_eq!(have.time, want.time, "{name}");
                assert_eq!(have.verdict, want.verdict, "{name} {systems}: {:?}", want.time);
                assert_eq!(have.used, want.used, "{name} {systems}: {:?}", want.time);
                if let Some((have, want)) = have.position.zip(want.position) {
                    apart_m = apart_m.max(have.distance_m(want));
                    fixes += 1;
                }
                for (have, want) in have.levels_m.iter().flatten().zip(want.levels_m.iter().flatten()) {
                    level_m = level_m.max((have - want).abs());
                }
            }
            println!("{name} {systems}: {fixes} positions within {apart_m} m, levels within {level_m} m");
            assert!(fixes > 250 && apart_m <= APART_M && level_m <= LEVEL_M, "{name} {systems}");
        }
    }
}
