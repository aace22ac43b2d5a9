//! Picture of the dashboard at common sizes: an alert, a satellite left out, and no input yet.

use raim::monitor::heaven::Body;
use raim::monitor::{Dashboard, draw};
use raim::signal::checksum::nmea_line;
use raim_core::satellite::{Constellation, SatelliteId};
use ratatui::Terminal;
use ratatui::backend::TestBackend;

const SIZES: [(u16, u16); 2] = [(80, 24), (120, 40)];

/// Returns twenty epochs: sound ones, one with a satellite left out, and an alert at the end.
fn story() -> Dashboard {
    let mut dashboard = Dashboard::of("a test");
    dashboard.hear(&nmea_line("PRAIV,0.1.0,1a2b3c4,POWER-ON,PASS"));
    let mut said = Vec::new();
    raim_firmware::settings::Configuration::at_start().write(&mut said).expect("a vector takes all");
    for line in String::from_utf8(said).expect("ASCII").lines() {
        dashboard.hear(line);
    }
    for second in 0..20 {
        let time = format!("1200{second:02}.00");
        dashboard.hear(&nmea_line(&format!(
            "GNGNS,{time},5529.6227407,N,00827.4073407,E,A,18,0.80,59.874,0.0,,,S"
        )));
        let state = match second {
            0..10 => "P,OK,19,18,12,0.912,1.873,12.3,18.2,556.0,",
            10..15 => "P,EXCLUDED,19,17,11,0.912,1.873,13.4,19.7,556.0,",
            _ => "A,FAULT,19,18,12,7.034,1.873,,,556.0,",
        };
        dashboard.hear(&nmea_line(&format!("PRAIS,{time},{state}")));
        if (10..15).contains(&second) {
            dashboard.hear(&nmea_line(&format!("PRAIX,{time},1,C12,-23.400,81.2")));
        }
        dashboard
            .hear(&nmea_line(&format!("PRAIN,{time},0123ABCD,{},1,0", if second < 15 { 10 } else { 0 })));
    }
    dashboard.hear(&nmea_line("PRAIL,0,0,3,1"));
    dashboard.see_pin(false);
    dashboard.heaven = [(Constellation::Gps, 5, 0.6, 0.9), (Constellation::Beidou, 12, 1.2, -2.0)]
        .into_iter()
        .filter_map(|(system, number, elevation_rad, azimuth_rad)| {
            Some(Body { satellite: SatelliteId::new(system, number)?, elevation_rad, azimuth_rad })
        })
        .collect();
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
    let mut dashboard = story();
    dashboard.hear(&nmea_line("PRAIS,120020.00,P,EXCLUDED,19,17,11,0.912,1.873,13.4,19.7,556.0,"));
    dashboard.hear(&nmea_line("PRAIX,120020.00,1,C12,-23.400,81.2"));
    let have = picture(&dashboard, SIZES[0]);
    assert!(have.contains("C12!") && !have.contains("G05!"), "{have}");
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
