//! Faults put into the messages of a capture.

use raim::replay::{self, Moment, Summary, Track, Window};
use raim::signal::capture::Capture;
use raim::signal::encode::{Frequency, Selection};
use raim::signal::fault::Fault;
use raim_core::satellite::SatelliteId;

use super::{STREAMS, epochs, first, judged, run, run_with};

/// Time at which both streams of the test below are long under way, s after the first epoch.
const INJECTED_S: (f64, f64) = (100.0, 110.0);

/// Returns the satellites that take part in every epoch: without one of them there is one less.
fn used(bytes: &[u8], quiet: &Track) -> Vec<SatelliteId> {
    let (from, to) = INJECTED_S;
    let many = |track: &Track| -> Vec<u32> {
        let during = track.iter().filter(|moment| (from..to).contains(&moment.elapsed_s));
        during.map(|moment| moment.output.as_ref().unwrap().state.used).collect()
    };
    let satellites = Capture::of(bytes.to_vec(), None).unwrap().content().satellites();
    let takes_part = |satellite: &SatelliteId| {
        let lost = Fault::parse_inject(&format!("{satellite}:lost@{from}..{to}")).unwrap();
        let without = many(&judged(bytes, &[lost]));
        many(quiet).iter().zip(&without).all(|(with, without)| *with == without + 1)
    };
    satellites.into_iter().filter(takes_part).collect()
}

#[test]
fn fault_of_a_satellite_of_qzss_is_put_into_the_stream_and_found() {
    let Some(bytes) = epochs(115) else { return };
    let fault = Fault::parse_inject("J03:+100@100..110").unwrap();
    let lumps = Capture::of(bytes, None).unwrap().lumps(&[fault], &Window::ALL).unwrap().lumps;
    let track = run_with(&lumps, None, &["SYSTEMS,GCEJ".to_owned()]);
    let injected = &Summary::of(&track, &[fault], true).injected[0];
    assert_eq!(
        (injected.epochs, injected.excluded_epochs, injected.wrong_exclusions),
        (10, 10, 0),
        "{injected:?}"
    );
}

#[test]
fn a_fault_put_into_messages_is_the_fault_put_into_the_recording() {
    let stream = &STREAMS[1];
    if stream.bytes().is_none() {
        return;
    }
    let (recording, selection) = (stream.recording(), Selection::new("GCE", Frequency::Dual).unwrap());
    let window = Window { to_s: 60.0, ..Window::ALL };
    let clean = replay::encode(&recording, &selection, &[], &window).unwrap();
    let rtcm: Vec<u8> = clean.into_iter().flat_map(|lump| lump.bytes).collect();
    let capture = Capture::of(rtcm, None).unwrap();
    let ramp = Fault::parse_ramp("C08:3.3@10..50").unwrap();
    let injected = ["C08:+100@20..40", "C08:-50000@20..40", "G:lost@20..40", "*:+150@20..40"]
        .map(|text| Fault::parse_inject(text).unwrap());
    for fault in injected.into_iter().chain([ramp]) {
        let recorded = replay::encode(&recording, &selection, &[fault], &window).unwrap();
        let (want, have) =
            (run(&recorded, None), run(&capture.lumps(&[fault], &Window::ALL).unwrap().lumps, None));
        for (have, want) in have.iter().zip(&want) {
            let (have, want) = (have.output.as_ref().unwrap(), want.output.as_ref().unwrap());
            let who = |output: &raim::verdict::EpochOutput| {
                let left_out = output.excluded.iter().map(|excluded| excluded.satellite.to_string());
                (output.state.state, output.state.reason.clone(), left_out.collect::<Vec<_>>())
            };
            assert_eq!(who(have), who(want), "{fault:?}");
            let apart_m = have.position.zip(want.position).map(|(a, b)| a.to_ecef().distance_m(b.to_ecef()));
            // A step of MSM7 is 0.6 mm.
            assert!(apart_m.is_none_or(|apart_m| apart_m < 0.01), "{fault:?}: {apart_m:?} m");
        }
    }
}

/// Many seconds each.
mod at_length {
    use super::*;

    #[test]
    fn a_hundred_metres_on_a_satellite_are_found_and_nothing_where_there_is_no_fault() {
        let selection = Selection::new("GCE", Frequency::Dual).unwrap();
        for stream in [&STREAMS[1], &STREAMS[3]] {
            let Some(ubx) = first(stream, 115) else { return };
            let window = Window { to_s: 115.0, ..Window::ALL };
            let recorded = replay::encode(&stream.recording(), &selection, &[], &window).unwrap();
            let rtcm: Vec<u8> = recorded.into_iter().flat_map(|lump| lump.bytes).collect();
            for (format, bytes) in [("UBX", ubx), ("RTCM", rtcm)] {
                let quiet = judged(&bytes, &[]);
                assert!(quiet.iter().all(|moment| moment.output.as_ref().unwrap().excluded.is_empty()));
                let satellites = used(&bytes, &quiet);
                assert!(satellites.len() > 15, "{} {format}: {satellites:?}", stream.name);
                let mut missed = Vec::new();
                for satellite in &satellites {
                    let text = format!("{satellite}:+100@{}..{}", INJECTED_S.0, INJECTED_S.1);
                    let fault = Fault::parse_inject(&text).unwrap();
                    let capture = Capture::of(bytes.clone(), None).unwrap();
                    let lumps = capture.lumps(&[fault], &Window::ALL).unwrap().lumps;
                    let track = run(&lumps, Some(&stream.truth()));
                    let summary = Summary::of(&track, &[fault], true);
                    let injected = &summary.injected[0];
                    assert!(injected.epochs >= 10, "{} {format} {text}", stream.name);
                    assert_eq!(injected.wrong_exclusions, 0, "{} {format} {text}", stream.name);
                    assert_eq!(summary.misleading, Some(0), "{} {format} {text}", stream.name);
                    let during = |moment: &&Moment| fault.is_active(moment.elapsed_s);
                    let is_caught = |moment: &Moment| {
                        let output = moment.output.as_ref().unwrap();
                        let is_out = output.excluded.iter().any(|excluded| excluded.satellite == *satellite);
                        is_out || output.state.state == 'A'
                    };
                    if !track.iter().filter(during).all(is_caught) {
                        missed.push(satellite.to_string());
                    }
                }
                println!("{} {format}: {} satellites, not caught {missed:?}", stream.name, satellites.len());
                // For a satellite on one band a hundred metres may be within the sigma of the
                // ionosphere; they do not mislead.
                assert!(10 * missed.len() < 2 * satellites.len(), "{} {format}: {missed:?}", stream.name);
            }
        }
    }
}
