//! The date at the end of a week: both meanings of a stated week, every order of systems, lumps and
//! single bytes.
//!
//! In the simulated sky every GPS and Galileo set of the last half hour has its reference time in
//! the next week, and every one of `BeiDou` in this one. Right values follow from the simulation's
//! own time.

use raim::sentence;
use raim::signal::encode::{Encoder, Frequency, Selection, StatedWeek};
use raim::signal::measurement::TimedEphemeris;
use raim::signal::pieces::{Kind, pieces};
use raim::signal::sky::Fleet;
use raim::signal::sky::raw::Simulation;
use raim_core::satellite::Constellation;
use raim_firmware::input::{Event, Input};
use raim_firmware::pin::MemoryPin;
use raim_firmware::receiver::{Boot, Receiver};
use raim_firmware::time::GpsTime;
use rig::shared;

/// The simulation's origin is a day after the week began.
const WEEK_END_S: f64 = 6.0 * 86_400.0;

/// Days from 1970-01-01 to 1980-01-06.
const UNIX_DAYS: i64 = 3657;

/// Epochs of each run: half of them before the week ends.
const EPOCHS: u32 = 50;

/// One second of a stream: sets by system, then ranges.
struct Second {
    time: GpsTime,
    sets: Vec<(char, Vec<u8>)>,
    ranges: Vec<u8>,
}

impl Second {
    /// Returns the bytes with the sets in an order of systems.
    fn bytes(&self, order: &str) -> Vec<u8> {
        let of = |letter| {
            self.sets.iter().filter(move |(of, _)| *of == letter).flat_map(|(_, frame)| frame.clone())
        };
        order.chars().flat_map(of).chain(self.ranges.iter().copied()).collect()
    }
}

/// Returns the seconds of a sky of these systems, from `before_s` before the end of `week` on.
fn sky(
    systems: &str,
    week: u16,
    before_s: f64,
    stated: StatedWeek,
    keep: impl Fn(&TimedEphemeris) -> bool,
) -> Vec<Second> {
    let fleets = [('G', Fleet::Gps31), ('E', Fleet::Galileo24), ('C', Fleet::BeidouGlobal)];
    let fleets = fleets.into_iter().filter(|(letter, _)| systems.contains(*letter));
    let mut simulation = Simulation {
        satellites: fleets.flat_map(|(_, fleet)| fleet.satellites()).collect(),
        ..Simulation::above_xian(WEEK_END_S - before_s, EPOCHS, 5)
    };
    simulation.origin.week = week;
    let mut recording = simulation.record();
    recording.ephemerides.retain(keep);
    let selection = Selection::new(systems, Frequency::Dual).unwrap();
    let mut encoder = Encoder::new(&recording.ephemerides, selection).stating(stated);
    let second = |epoch| {
        let bytes = encoder.epoch(epoch).unwrap();
        let (mut sets, mut ranges) = (Vec::new(), Vec::new());
        for piece in pieces(&bytes) {
            match piece.kind {
                Kind::Rtcm(1019) => sets.push(('G', piece.bytes.to_vec())),
                Kind::Rtcm(1045 | 1046) => sets.push(('E', piece.bytes.to_vec())),
                Kind::Rtcm(1042) => sets.push(('C', piece.bytes.to_vec())),
                _ => ranges.extend_from_slice(piece.bytes),
            }
        }
        Second { time: epoch.time, sets, ranges }
    };
    recording.epochs.iter().map(second).collect()
}

/// Returns the field `ddmmyy` of `RMC` at an instant, by a calendar of its own.
fn ddmmyy(time: GpsTime) -> String {
    let day = ((time.to_ms() - 18_000) / 86_400_000).cast_signed() + UNIX_DAYS;
    let date = civil_from_days(day);
    format!("{:02}{:02}{:02}", date.2, date.1, date.0 % 100)
}

/// Returns year, month, day of days since 1970-01-01, counted day by day.
fn civil_from_days(mut days: i64) -> (i64, u32, u32) {
    let is_leap = |year: i64| year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
    let mut year = 1970;
    while days >= 365 + i64::from(is_leap(year)) {
        days -= 365 + i64::from(is_leap(year));
        year += 1;
    }
    let lengths = [31, 28 + i64::from(is_leap(year)), 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];
    let mut month = 1;
    for length in lengths {
        if days < length {
            break;
        }
        days -= length;
        month += 1;
    }
    (year, month, days as u32 + 1)
}

/// Returns the date of each epoch in the output, and true if its position is protected.
fn dates(lumps: &[Vec<u8>], by_byte: bool) -> Vec<(String, bool)> {
    let mut receiver = Receiver::new(MemoryPin::default(), Boot::on_host("week end")).unwrap();
    let mut dates = Vec::new();
    for (index, lump) in lumps.iter().enumerate() {
        let (mut reported, now_ms) = (Vec::new(), 1000 * index as u64);
        if by_byte {
            for (number, &byte) in lump.iter().enumerate() {
                receiver.gnss(&[byte], now_ms + number as u64 / 100, &mut reported);
            }
        } else {
            receiver.gnss(lump, now_ms, &mut reported);
        }
        receiver.tick(now_ms + 600, &mut reported);
        let text = String::from_utf8(reported).unwrap();
        let is_promised = sentence::epochs(&text).unwrap().iter().any(|epoch| epoch.state.is_protected());
        let rmc = text.lines().find(|line| line.starts_with("$GNRMC"));
        let date = rmc.and_then(|line| line.split(',').nth(9)).unwrap_or("none");
        dates.push((date.to_owned(), is_promised));
    }
    dates
}

/// Checks the date of every epoch from `first` on, and that all are promised.
fn check(seconds: &[Second], lumps: &[Vec<u8>], first: usize, what: &str) {
    for by_byte in [false, true] {
        let have = dates(lumps, by_byte);
        for (index, (second, (date, is_promised))) in seconds.iter().zip(&have).enumerate() {
            if index >= first {
                assert_eq!(*date, ddmmyy(second.time), "{what}, by byte: {by_byte}, epoch {index}: {have:?}");
            }
            assert!(is_promised, "{what}, by byte: {by_byte}, epoch {index}: {have:?}");
        }
    }
}

const ORDERS: [&str; 6] = ["GEC", "GCE", "EGC", "ECG", "CGE", "CEG"];

#[test]
fn date_is_right_from_the_first_epoch_on_in_every_order() {
    // The last week of a cycle of 1,024, too.
    for week in [2295, 3071] {
        for stated in [StatedWeek::Transmission, StatedWeek::Toe] {
            let seconds = sky("GEC", week, 25.0, stated, |_| true);
            for order in ORDERS {
                let lumps: Vec<_> = seconds.iter().map(|second| second.bytes(order)).collect();
                check(&seconds, &lumps, 0, &format!("{order}, {stated:?}, week {week}"));
            }
        }
    }
}

/// The sets of one system come with each second: the first epoch has those of the first only.
#[test]
fn sets_that_come_after_the_first_epoch_mend_the_date_without_loss() {
    for stated in [StatedWeek::Transmission, StatedWeek::Toe] {
        let seconds = sky("GEC", 2295, 25.0, stated, |_| true);
        for order in ORDERS {
            let lumps: Vec<_> = seconds
                .iter()
                .enumerate()
                .map(|(index, second)| {
                    let of_first = order.chars().nth(index).map(|letter| {
                        let of = seconds[0].sets.iter().filter(move |(of, _)| *of == letter);
                        of.flat_map(|(_, frame)| frame.clone()).collect::<Vec<u8>>()
                    });
                    [of_first.unwrap_or_default(), second.ranges.clone()].concat()
                })
                .collect();
            // Weeks of toe of GPS and Galileo alone look like those of transmission, until BeiDou
            // speaks.
            let beidou = order.find('C').unwrap();
            let first = if stated == StatedWeek::Toe { beidou } else { 0 };
            check(&seconds, &lumps, first, &format!("{order}, {stated:?}"));
        }
    }
}

#[test]
fn gps_alone_is_dated_by_the_week_of_transmission_or_by_one_older_set() {
    let is_gps = |ephemeris: &TimedEphemeris| ephemeris.satellite.constellation() == Constellation::Gps;
    for before_s in [1500.0, 25.0, -1900.0, -3590.0, -7190.0] {
        let seconds = sky("G", 2295, before_s, StatedWeek::Transmission, is_gps);
        let lumps: Vec<_> = seconds.iter().map(|second| second.bytes("G")).collect();
        check(&seconds, &lumps, 0, &format!("{before_s} s before the end"));
    }
    // A set of an hour before has its reference time in this week.
    let end = GpsTime { week: 2296, tow_ms: 0 };
    let older =
        |ephemeris: &TimedEphemeris| !ephemeris.satellite.number().is_multiple_of(4) || ephemeris.toe < end;
    let seconds = sky("G", 2295, 25.0, StatedWeek::Toe, older);
    assert!(seconds[0].sets.len() > 6);
    let lumps: Vec<_> = seconds.iter().map(|second| second.bytes("G")).collect();
    check(&seconds, &lumps, 0, "weeks of toe");
}

/// Sets of two sides of the roll-over together name the week, whichever comes first.
#[test]
fn sets_passed_on_from_before_the_end_do_not_date_what_comes_after_it() {
    let end = GpsTime { week: 2296, tow_ms: 0 };
    let keep = |set: &TimedEphemeris| set.satellite.number().is_multiple_of(2) == (set.toe <= end);
    let seconds = sky("G", 2295, -3500.0, StatedWeek::Transmission, keep);
    let mut lumps: Vec<_> = seconds.iter().map(|second| second.bytes("G")).collect();
    check(&seconds, &lumps, 0, "as they come");
    let reversed: Vec<u8> = seconds[0].sets.iter().rev().flat_map(|(_, frame)| frame.clone()).collect();
    lumps[0] = [reversed, seconds[0].ranges.clone()].concat();
    check(&seconds, &lumps, 0, "the other way round");
}

/// The smallest inputs that once failed, with the dates that are right.
#[test]
fn weekend_cases_are_dated_right() {
    for name in ["weekend-mixed", "weekend-gps"] {
        let Some(path) = shared::path_or_skip(&format!("data/cases/{name}.rtcm3")) else { return };
        let bytes = std::fs::read(path).unwrap();
        for size in [1, bytes.len()] {
            let (mut input, mut weeks) = (Input::new(), Vec::new());
            for lump in bytes.chunks(size) {
                input.feed(lump, 0, |event| {
                    if let Event::Epoch(epoch, _) = event {
                        weeks.push((epoch.time.week, epoch.time.tow_ms / 1000));
                    }
                });
            }
            let want: &[(u16, u32)] = if name == "weekend-gps" {
                &[(2113, 604_798), (2113, 604_799), (2114, 0), (2114, 1), (2114, 70), (2114, 130)]
            } else {
                &[(2113, 604_210), (2113, 604_211), (2113, 604_212), (2113, 604_213)]
            };
            assert_eq!(weeks, want, "{name}, {size} bytes at a time");
        }
    }
}
