//! Faults: their effect on ranges, and the errors for wrong texts.

use raim::signal::fault::{Directions, Fault, Injector, Kind, Measured, Target, satellite};
use raim_core::frame::Enu;
use raim_core::satellite::{Constellation, SatelliteId};

/// The simplest epoch: a range per satellite.
#[derive(Clone, Debug, PartialEq)]
struct Ranges {
    time_s: f64,
    ranges_m: Vec<(SatelliteId, f64)>,
}

impl Measured for Ranges {
    fn time_s(&self) -> f64 {
        self.time_s
    }
    fn satellites(&self) -> Vec<SatelliteId> {
        self.ranges_m.iter().map(|&(satellite, _)| satellite).collect()
    }
    fn lengthen(&mut self, satellite: SatelliteId, by_m: f64) {
        for (known, range_m) in &mut self.ranges_m {
            if *known == satellite {
                *range_m += by_m;
            }
        }
    }
    fn lose(&mut self, satellite: SatelliteId) {
        self.ranges_m.retain(|&(known, _)| known != satellite);
    }
}

/// Ranges of 0 m of G05, G07 and C12, one epoch per second, the first at 1000 s.
fn source() -> impl Iterator<Item = Ranges> {
    let satellites = ["G05", "G07", "C12"].map(|name| (satellite(name).unwrap(), 0.0));
    (0..6).map(move |second| Ranges { time_s: f64::from(1000 + second), ranges_m: satellites.to_vec() })
}

/// Returns the range of a satellite over the six epochs; `None` if it is not received.
fn history(fault: Fault, name: &str) -> Vec<Option<f64>> {
    let satellite = satellite(name).unwrap();
    Injector::new(source(), vec![fault])
        .map(|epoch| epoch.ranges_m.iter().find(|(known, _)| *known == satellite).map(|(_, range)| *range))
        .collect()
}

fn present(values: [f64; 6]) -> Vec<Option<f64>> {
    values.map(Some).to_vec()
}

#[test]
fn step_lasts_from_its_start_to_before_its_end() {
    let fault = Fault::parse_inject("G05:+80@2..4").unwrap();
    assert_eq!(history(fault, "G05"), present([0.0, 0.0, 80.0, 80.0, 0.0, 0.0]));
    assert_eq!(history(fault, "G07"), present([0.0; 6]));
}

#[test]
fn ramp_grows_from_its_start_and_stops_at_its_limit() {
    let fault = Fault::parse_ramp("G05:-0.5@1..").unwrap();
    assert_eq!(history(fault, "G05"), present([0.0, 0.0, -0.5, -1.0, -1.5, -2.0]));
    let limited = Fault { kind: Kind::Ramp { rate_m_s: -0.5, limit_m: 1.0 }, ..fault };
    assert_eq!(history(limited, "G05"), present([0.0, 0.0, -0.5, -1.0, -1.0, -1.0]));
}

#[test]
fn outage_removes_the_satellite_and_only_it() {
    let fault = Fault::parse_inject("c12:lost@..2").unwrap();
    let want = vec![None, None, Some(0.0), Some(0.0), Some(0.0), Some(0.0)];
    assert_eq!(history(fault, "C12"), want);
    assert_eq!(history(fault, "G05"), present([0.0; 6]));
}

#[test]
fn constellation_fault_spares_the_other_systems() {
    let fault = Fault::parse_inject("G:-12@3..").unwrap();
    for (name, want) in [("G05", -12.0), ("G07", -12.0), ("C12", 0.0)] {
        assert_eq!(history(fault, name), present([0.0, 0.0, 0.0, want, want, want]), "{name}");
    }
}

/// With unit vectors to the east and to the zenith, `−LOS · d` is read off directly.
#[test]
fn shift_moves_each_range_of_the_constellation_by_where_it_stands() {
    let fault = Fault::parse_inject("G:shift=60,0,-45@3..5").unwrap();
    assert!((fault.bias_m(3.0) - 75.0).abs() < 1e-12);
    let east = Enu { east: 1.0, north: 0.0, up: 0.0 };
    let zenith = Enu { east: 0.0, north: 0.0, up: 1.0 };
    let seen = [("G05", east), ("G07", zenith)].map(|(name, towards)| (satellite(name).unwrap(), towards));
    let directions = Directions::new((1000..1006).map(|time| (f64::from(time), seen.to_vec())).collect());
    let injector = || Injector::new(source(), vec![fault]).towards(directions.clone());
    let of = |index: usize| injector().map(|epoch| epoch.ranges_m[index].1).collect::<Vec<f64>>();
    assert_eq!(of(0), [0.0, 0.0, 0.0, -60.0, -60.0, 0.0]);
    assert_eq!(of(1), [0.0, 0.0, 0.0, 45.0, 45.0, 0.0]);
    assert_eq!(of(2), [0.0; 6], "another system");
}

#[test]
fn satellite_whose_direction_is_unknown_is_lost_to_a_shift() {
    let fault = Fault::parse_inject("G:shift=60,0,0@4..").unwrap();
    let want = [Some(0.0), Some(0.0), Some(0.0), Some(0.0), None, None];
    assert_eq!(history(fault, "G05"), want);
    assert_eq!(history(fault, "C12"), present([0.0; 6]));
}

#[test]
fn shift_that_is_written_wrongly_is_told_what_and_where() {
    for (text, want) in [
        ("E:shift=60", "`60` at character 9 is not three numbers east,north,up"),
        ("E:shift=", "`` at character 9 is not three numbers"),
        ("E:shift=1,2,3,4@0..", "`1,2,3,4` at character 9 is not three numbers"),
        ("E:shift=60,x,0", "`x` at character 12 is not a number of metres"),
        ("E:shift=60,0,inf", "`inf` at character 14 is not a number of metres"),
    ] {
        let have = Fault::parse_inject(text).unwrap_err().to_string();
        assert!(have.contains(want), "{text}: have {have}, want {want}");
        assert!(have.ends_with("write it like E:shift=60,0,-45@600.."), "{text}: have {have}");
    }
}

#[test]
fn clock_jump_moves_every_range() {
    let fault = Fault::parse_inject("*:+300@5..").unwrap();
    for name in ["G05", "G07", "C12"] {
        assert_eq!(history(fault, name), present([0.0, 0.0, 0.0, 0.0, 0.0, 300.0]), "{name}");
    }
}

#[test]
fn two_faults_of_one_satellite_add_up() {
    let faults = ["G05:+80@1..3", "G05:-30@2.."].map(|text| Fault::parse_inject(text).unwrap());
    let have: Vec<f64> = Injector::new(source(), faults.to_vec()).map(|epoch| epoch.ranges_m[0].1).collect();
    assert_eq!(have, [0.0, 80.0, 50.0, -30.0, -30.0, -30.0]);
}

#[test]
fn span_may_lack_its_bounds_or_be_absent() {
    let g05 = Target::Satellite(SatelliteId::new(Constellation::Gps, 5).unwrap());
    for (text, start_s, end_s) in [
        ("G05:+80@600..1200", 600.0, 1200.0),
        ("G05:+80@600..", 600.0, f64::INFINITY),
        ("G5:80@..1200.5", 0.0, 1200.5),
        ("G05:8e1", 0.0, f64::INFINITY),
    ] {
        let want = Fault { target: g05, kind: Kind::Step { bias_m: 80.0 }, start_s, end_s };
        assert_eq!(Fault::parse_inject(text), Ok(want), "{text}");
    }
}

#[test]
fn wrong_text_is_told_what_and_where() {
    for (text, want) in [
        ("", "`` at character 1 is not a satellite and, after a colon, a fault"),
        ("G05", "`G05` at character 1 is not a satellite and, after a colon"),
        ("X05:80", "`X05` at character 1 is not a satellite (G05)"),
        ("G00:80", "`G00` at character 1 is not a satellite"),
        ("G005:80", "`G005` at character 1 is not a satellite"),
        ("G+5:80", "`G+5` at character 1 is not a satellite"),
        ("é5:80", "`é5` at character 1 is not a satellite"),
        ("G05:eighty@600..", "`eighty` at character 5 is not a number of metres, `shift=` or `lost`"),
        ("G05:nan@600..", "`nan` at character 5 is not a number of metres"),
        ("G05:inf", "`inf` at character 5 is not a number of metres"),
        ("G05:+80@600", "`600` at character 9 is not a span of seconds start..end"),
        ("G05:+80@600..x", "`x` at character 14 is not a number of seconds"),
        ("G05:+80@600..600", "`600..600` at character 9 is not a span that ends after it starts"),
    ] {
        let have = Fault::parse_inject(text).unwrap_err().to_string();
        assert!(have.contains(want), "{text}: have {have}, want {want}");
        assert!(have.ends_with("write it like G05:+80@600..1200"), "{text}: have {have}");
    }
    let have = Fault::parse_ramp("G05:lost@0..").unwrap_err().to_string();
    assert!(have.contains("is not a number of metres per second"), "have {have}");
}

#[test]
fn satellite_that_is_never_received_is_an_error_that_names_the_others() {
    let received: Vec<SatelliteId> = source().next().unwrap().satellites();
    let fault = |text| Fault::parse_inject(text).unwrap().check_against(&received);
    assert_eq!(fault("G05:+80"), Ok(()));
    assert_eq!(fault("C:+80"), Ok(()));
    let want = "G33 is never received; the satellites are G05 G07 C12";
    assert_eq!(fault("G33:+80").unwrap_err().to_string(), want);
    assert_eq!(
        fault("E:+80").unwrap_err().to_string(),
        "E is never received; the satellites are G05 G07 C12"
    );
}
