//! Input that is refused, or lacks orbits, with a word about what to do.

use raim::replay::{self, Window};
use raim::signal::capture::{Capture, Orbits};
use raim::signal::encode::{Frequency, Selection, sbf, ubx};
use raim::signal::fault::Fault;
use raim::signal::measurement::Ephemeris;
use raim::signal::pieces::{Kind, pieces};
use raim_firmware::time::GpsTime;

use super::{STREAMS, epochs, is_protected, path, run};

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
    let missing = capture.advice().unwrap();
    assert!(missing.contains("RXM-SFRBX") && missing.contains("--nav"), "{missing}");

    let capture = Capture::of(ranges, Some(orbits())).unwrap();
    assert_eq!(capture.advice(), None);
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
    let noon = GpsTime { week: 2111, tow_ms: 388_800_000 };
    let compressed = sbf::block(4109, noon, &[0; 20]).repeat(3);
    let undated = sbf::block(4027, GpsTime { week: u16::MAX, ..noon }, &[0, 20, 12, 0, 0, 0]);
    for (bytes, want) in [
        (Vec::new(), "is empty"),
        (nmea.into_bytes(), "holds 9 lines of NMEA. missing: ranges and orbits: RXM-RAWX"),
        (b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR".to_vec(), "a picture"),
        (b"%PDF-1.7 etc".to_vec(), "a PDF"),
        (b"week,tow,x_m,y_m,z_m\n".to_vec(), "text"),
        (vec![0; 9999], "no frame of UBX, SBF or RTCM 3"),
        (rinex("OBSERVATION DATA").into_bytes(), "RINEX observation file: give it with --obs"),
        (rinex("NAVIGATION DATA").into_bytes(), "RINEX navigation file: give it with --nav"),
        (position, "holds 3 NAV-PVT. missing: ranges and orbits: RXM-RAWX"),
        (without_week, "in none of the RXM-RAWX the receiver knows it"),
        (compressed, "holds 3 Meas3Ranges. not read: 3 Meas3Ranges: compressed ranges, add MeasEpoch"),
        (undated, "in none of the MeasEpoch the receiver knows it"),
    ] {
        let error = Capture::of(bytes, None).err().map(|error| format!("{error:#}")).unwrap();
        assert!(error.contains(want), "{want}: {error}");
    }
}

/// An inclination in semicircles that is read as radians is a third of what it should be.
#[test]
fn refused_orbits_are_named() {
    let stream = &STREAMS[1];
    if epochs(6).is_none() {
        return;
    }
    let mut recording = stream.recording();
    let mut wrong = std::collections::BTreeSet::new();
    for set in &mut recording.ephemerides {
        if let Ephemeris::Beidou(message) = &mut set.message
            && message.i0_sc > 0.2
        {
            message.i0_sc /= std::f64::consts::PI;
            wrong.insert(set.satellite);
        }
    }
    let selection = Selection::new("GCE", Frequency::Dual).unwrap();
    let window = Window { to_s: 5.0, ..Window::ALL };
    let lumps = replay::encode(&recording, &selection, &[], &window).unwrap();
    let capture = Capture::of(lumps.into_iter().flat_map(|lump| lump.bytes).collect(), None).unwrap();
    let refused = capture.content().refused();
    assert!(refused.len() >= 5 && refused.keys().all(|satellite| wrong.contains(satellite)), "{refused:?}");
    let advice = capture.advice().unwrap();
    let (first, _) = refused.first_key_value().unwrap();
    assert!(advice.contains("every ephemeris of") && advice.contains(&first.to_string()), "{advice}");
}
