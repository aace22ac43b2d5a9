//! Picture of the dashboard at common sizes: an alert, a satellite left out, and no input yet.

use std::collections::BTreeSet;

use raim::monitor::keys::Key;
use raim::monitor::source::{self, Choice, Message, News};
use raim::monitor::speed::{Control, Speed};
use raim::monitor::{Dashboard, draw};
use raim::satellites::{Account, Fate};
use raim::signal::checksum::nmea_line;
use raim::signal::encode::{Encoder, Frequency, Selection};
use raim::signal::fault::{Injector, satellite};
use raim_core::satellite::{Constellation, SatelliteId};
use ratatui::Terminal;
use ratatui::backend::TestBackend;
use rig::demo::Plan;

const SIZES: [(u16, u16); 2] = [(80, 24), (120, 40)];

fn receive(dashboard: &mut Dashboard, line: &str) {
    dashboard.take(&Message { lines: vec![line.to_owned()], ..Message::default() });
}

/// Returns twenty epochs: sound ones, one with a satellite left out, and an alert at the end.
fn story() -> Dashboard {
    let mut dashboard = Dashboard::of("a test");
    receive(&mut dashboard, &nmea_line("PRAIV,0.1.0,1a2b3c4,POWER-ON,PASS"));
    let mut reported = Vec::new();
    raim_firmware::settings::Configuration::at_start().write(&mut reported).expect("a vector takes all");
    for line in String::from_utf8(reported).expect("ASCII").lines() {
        receive(&mut dashboard, line);
    }
    for second in 0..20 {
        let time = format!("1200{second:02}.00");
        receive(
            &mut dashboard,
            &nmea_line(&format!("GNGNS,{time},5529.6227407,N,00827.4073407,E,A,18,0.80,59.874,0.0,,,S")),
        );
        let state = match second {
            0..10 => "P,OK,19,18,12,0.912,1.873,12.3,18.2,556.0,",
            10..15 => "P,EXCLUDED,19,17,11,0.912,1.873,13.4,19.7,556.0,",
            _ => "A,FAULT,19,18,12,7.034,1.873,,,556.0,",
        };
        receive(&mut dashboard, &nmea_line(&format!("PRAIS,{time},{state}")));
        if (10..15).contains(&second) {
            receive(&mut dashboard, &nmea_line(&format!("PRAIX,{time},1,C12,-23.400,81.2")));
        }
        receive(
            &mut dashboard,
            &nmea_line(&format!("PRAIN,{time},0123ABCD,{},1,0", if second < 15 { 10 } else { 0 })),
        );
    }
    receive(&mut dashboard, &nmea_line("PRAIL,0,0,3,1"));
    let satellites = [(Constellation::Gps, 5, 0.6, 0.9), (Constellation::Beidou, 12, 1.2, -2.0)]
        .into_iter()
        .filter_map(|(system, number, elevation_rad, azimuth_rad)| {
            let is_excluded = system == Constellation::Beidou;
            let mut account = Account::of(
                SatelliteId::new(system, number)?,
                if is_excluded { Fate::Excluded } else { Fate::Used },
            );
            account.azimuth_rad = Some(azimuth_rad);
            account.elevation_rad = Some(elevation_rad);
            account.cn0_dbhz = Some(44.5);
            account.residual_m = Some(if is_excluded { 81.2 } else { -0.7 });
            account.sigma_m = Some(2.0);
            account.w_test = Some(0.1);
            Some(account)
        })
        .collect();
    dashboard.take(&Message { lines: Vec::new(), pin: Some(false), satellites: Some(satellites) });
    dashboard
}

fn picture(dashboard: &Dashboard, (width, height): (u16, u16)) -> String {
    let mut terminal = Terminal::new(TestBackend::new(width, height)).expect("a terminal in memory");
    terminal.draw(|frame| draw::draw(frame, dashboard)).expect("drawn");
    terminal.backend().to_string()
}

#[test]
fn an_alert_is_seen_at_a_glance_at_every_size() {
    let dashboard = story();
    for size in SIZES {
        let have = picture(&dashboard, size);
        for word in [
            "ALERT",
            "FAULT",
            "pin LOW",
            "12:00:19",
            "18 of 19",
            "55.4937123",
            "test 7.03/1.87",
            "C12    5 epochs",
            "PHASE NPA",
            "0123ABCD",
            "refused 3, late 1",
            "G05",
            "epochs 20",
            "q quit",
        ] {
            assert!(have.contains(word), "{word} is missing at {size:?}:\n{have}");
        }
    }
}

#[test]
fn what_is_left_out_now_is_marked_in_the_sky() {
    let dashboard = story();
    let have = picture(&dashboard, SIZES[0]);
    assert!(have.contains("C12!") && !have.contains("G05!"), "{have}");
}

#[test]
fn satellites_are_listed_with_their_signals_and_residuals() {
    let mut dashboard = story();
    let wide = picture(&dashboard, SIZES[1]);
    dashboard.press(Key::Letter('s'));
    for have in [wide, picture(&dashboard, SIZES[0])] {
        for words in
            ["1 used, 1 excluded, 0 not used", "C12 EXCL    44.5    81.2", "G05 used    44.5    -0.7"]
        {
            assert!(have.contains(words), "{words} is missing:\n{have}");
        }
    }
}

#[test]
fn a_command_is_shown_while_it_is_typed_and_so_is_its_answer() {
    let mut dashboard = story();
    dashboard.takes_commands = true;
    assert!(picture(&dashboard, SIZES[0]).contains("p phase  h HAL  v VAL"));
    for letter in "plpv".chars() {
        dashboard.press(Key::Letter(letter));
    }
    let have = picture(&dashboard, SIZES[0]);
    assert!(have.contains("PHASE (ENROUTE TERMINAL NPA LPV200 CUSTOM): LPV_"), "{have}");
    dashboard.press(Key::Escape);
    receive(&mut dashboard, &nmea_line("PRAIA,PHASE,LPV200,OK"));
    let have = picture(&dashboard, SIZES[1]);
    assert!(have.contains("answer: PHASE LPV200 OK"), "{have}");
}

/// Draws every picture that a user could see of a capture with an alert and a silence.
#[test]
fn no_frame_contradicts_itself() {
    let plan = Plan { satellite: satellite("G15").unwrap(), bias_m: -200.0, seed: 1 };
    let recording = plan.simulation().unwrap().record();
    let mut encoder = Encoder::new(&recording.ephemerides, Selection::new("GC", Frequency::Dual).unwrap());
    let bytes: Vec<u8> = (0..120)
        .zip(Injector::new(recording.epochs.into_iter(), vec![plan.fault()]))
        .map(|(second, epoch)| (second, encoder.epoch(&epoch).unwrap()))
        // Fifteen seconds are longer than the time to alert.
        .filter(|(second, _)| !(95..110).contains(second))
        .flat_map(|(_, bytes)| bytes)
        .collect();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("capture.rtcm3");
    std::fs::write(&path, bytes).unwrap();
    let source = source::open(&Choice::File(path, Control::new(Speed::Max))).unwrap();
    let mut dashboard = Dashboard::of("a capture");
    let (mut seen, mut frames, mut excluded) = (BTreeSet::new(), 0, 0);
    for news in &source.news {
        let News::Reported(message) = news else { break };
        dashboard.take(&message);
        let have = picture(&dashboard, SIZES[1]);
        let Some(state) = ["PROTECTED", "ALERT", "UNAVAILABLE"]
            .into_iter()
            .find(|word| have.contains(&format!(" {word} ")))
        else {
            continue;
        };
        let pin = if state == "PROTECTED" { "pin HIGH" } else { "pin LOW" };
        assert!(have.contains(pin), "{have}");
        // The time of the epoch's own sentences, and the satellites that the verdict counts.
        let used = dashboard.satellites.iter().filter(|seen| seen.fate == Fate::Used).count();
        let last = dashboard.state.as_ref().unwrap();
        assert!(!last.has_epoch() || last.used as usize == used, "{used} used:\n{have}");
        excluded += usize::from(have.contains("EXCL "));
        seen.insert(state);
        frames += 1;
    }
    assert!(frames > 100, "{frames}");
    assert_eq!(seen, BTreeSet::from(["ALERT", "PROTECTED"]));
    assert!(excluded > 0);
}

#[test]
fn nothing_heard_is_said_so() {
    for size in SIZES {
        let have = picture(&Dashboard::of("/dev/ttyUSB0"), size);
        for word in
            ["waiting for the first verdict", "no position", "none so far", "not said yet", "/dev/ttyUSB0"]
        {
            assert!(have.contains(word), "{word} is missing at {size:?}:\n{have}");
        }
    }
}

/// A terminal may have any size, even while it is being resized.
#[test]
fn no_size_is_too_small_to_be_drawn_in() {
    let dashboard = story();
    for size in [(1, 1), (5, 3), (20, 6), (79, 10), (300, 5)] {
        picture(&dashboard, size);
    }
}
