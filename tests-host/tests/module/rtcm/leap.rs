//! A leap second on the wire, in every order of systems.

use super::{gps, names_of_nonzero};
use crate::wire::{B1I, Bits, Cell, E1C, epochs, feed, frame, msm};
use raim_firmware::input::{Event, Input, LeapSource};
use raim_firmware::time::{GpsTime, WEEK_MS};

/// 2023-01-01 00:00, as if a leap second had been inserted before it, as before 2017-01-01 (IERS
/// Bulletin C 52).
const MIDNIGHT_UTC: GpsTime = GpsTime { week: 2243, tow_ms: 0 };

/// The leap seconds before and after.
const BEFORE_S: u32 = 18;

/// One instant in four systems.
struct Burst {
    tow_ms: u32,
    utc_ms: u32,
}

impl Burst {
    /// Returns the message of a system; `more` says that others follow.
    fn message(&self, system: char, more: bool) -> Vec<u8> {
        let range_m = 2.3e7 + f64::from(self.tow_ms % 3_600_000) * 0.1;
        match system {
            'G' => gps(self.tow_ms, more),
            'R' => {
                let moscow_ms = (self.utc_ms + 3 * 3_600_000) % WEEK_MS;
                let time = ((moscow_ms / 86_400_000) << 27) + moscow_ms % 86_400_000;
                msm(1087, time, more, &[Cell(3, 2, range_m, 50.0)])
            }
            'E' => msm(1097, self.tow_ms, more, &[Cell(31, E1C, range_m, 50.0)]),
            _ => msm(1127, (self.tow_ms + WEEK_MS - 14_000) % WEEK_MS, more, &[Cell(6, B1I, range_m, 42.0)]),
        }
    }
}

/// Returns every order of the systems.
fn orders() -> Vec<String> {
    let mut orders = vec![String::new()];
    for _ in 0..4 {
        let longer = |order: &String| {
            let rest: Vec<char> = "GREC".chars().filter(|letter| !order.contains(*letter)).collect();
            rest.into_iter().map(|letter| format!("{order}{letter}")).collect::<Vec<_>>()
        };
        orders = orders.iter().flat_map(longer).collect();
    }
    orders
}

/// Runs over the step with a burst every `step_ms`, from 100 s or 250 bursts before the inserted second on, which is in the
/// week before.
fn run(order: &str, step_ms: u32) {
    let mut input = Input::new();
    input.assume(MIDNIGHT_UTC.week - 1);
    let (mut known, mut epochs) = (Vec::new(), 0);
    let before_ms = (250 * step_ms).min(100_000);
    let many = before_ms * 13 / (10 * step_ms);
    for burst in 0..many {
        let since_start_ms = u64::from(burst * step_ms);
        let gps_ms =
            MIDNIGHT_UTC.to_ms() + u64::from(BEFORE_S) * 1000 - u64::from(before_ms) + since_start_ms;
        let after_step = gps_ms >= MIDNIGHT_UTC.to_ms() + u64::from(BEFORE_S + 1) * 1000;
        let leap_s = BEFORE_S + u32::from(after_step);
        let tow_ms = (gps_ms % u64::from(WEEK_MS)) as u32;
        let burst_of = Burst { tow_ms, utc_ms: (tow_ms + WEEK_MS - leap_s * 1000) % WEEK_MS };
        for (place, system) in order.chars().enumerate() {
            let message = burst_of.message(system, place < 3);
            input.feed(&message, since_start_ms + 5 * place as u64, |event| {
                assert!(!matches!(event, Event::Rivalry(_)), "{order}, every {step_ms} ms: two receivers?");
                if let Event::Epoch(epoch, _) = event {
                    assert_eq!(epoch.time, GpsTime::from_ms(gps_ms), "{order}, every {step_ms} ms");
                    assert!(
                        epoch.satellites.len() >= 3,
                        "{order}, every {step_ms} ms: {}",
                        epoch.satellites.len()
                    );
                    epochs += 1;
                }
            });
        }
        if after_step {
            known.push(input.leap_second().map(|leap| leap.seconds));
        }
    }
    assert_eq!(epochs, many, "{order}, every {step_ms} ms");
    assert!(known[1..].iter().all(|seconds| *seconds == Some(19)), "{order}, every {step_ms} ms: {known:?}");
}

#[test]
fn leap_second_costs_no_epoch_in_any_order_of_systems() {
    assert_eq!(orders().len(), 24);
    for order in orders() {
        for step_ms in [100, 1000, 5000] {
            run(&order, step_ms);
        }
    }
}

/// 1013 of 2020-06-24 21:00:00 UTC with 18 leap seconds, as pyrtcm 1.1 writes and reads it.
const DATE: [u8; 15] = [0xD3, 0, 9, 0x3F, 0x50, 0, 0xE6, 0x90, 0x93, 0xA8, 0, 0x48, 0x1D, 0xDB, 0x91];

/// GLONASS ranges of that instant: midnight in Moscow, on a Thursday.
fn midnight_in_moscow() -> Vec<u8> {
    msm(1087, 4 << 27, false, &[Cell(3, 2, 2.0e7, 50.0)])
}

#[test]
fn glonass_alone_has_its_week_and_leap_seconds_from_1013() {
    let mut input = Input::new();
    assert!(epochs(feed(&mut input, &midnight_in_moscow())).is_empty());
    feed(&mut input, &DATE);
    let reported = input.leap_second().map(|leap| (leap.seconds, leap.source));
    assert_eq!(reported, Some((18, LeapSource::Receiver)));
    let seen = epochs(feed(&mut input, &midnight_in_moscow()));
    // 2020-06-24 is the third day of week 2111, counted from 0.
    let want = GpsTime { week: 2111, tow_ms: (3 * 86_400 + 21 * 3600 + 18) * 1000 };
    assert_eq!(seen.iter().map(|epoch| epoch.time).collect::<Vec<_>>(), [want]);
    assert_eq!(names_of_nonzero(input.counters()), [("leap_unknown", 1)]);
}

#[test]
fn date_that_cannot_be_is_refused() {
    let date = |day: i64, second: i64, leap_s: i64| {
        let bits = Bits::default().put(12, 1013).put(12, 0).put(16, day).put(17, second).put(5, 0);
        frame(&bits.put(8, leap_s).bytes())
    };
    for (day, second, leap_s, is_read) in [
        (59_024, 86_400, 18, true),
        (65_535, 0, 63, true),
        // 1970-01-01 and 1980-01-05.
        (40_587, 0, 18, false),
        (59_024, 0, 0, false),
        (59_024, 0, 64, false),
        (59_024, 0, 255, false),
        (44_243, 0, 18, false),
    ] {
        let mut input = Input::new();
        feed(&mut input, &date(day, second, leap_s));
        assert_eq!(input.leap_second().is_some(), is_read, "{day} {second} {leap_s}");
        assert_eq!(input.counters().times_out_of_range, u32::from(!is_read), "{day} {second} {leap_s}");
    }
    let mut short = Input::new();
    feed(&mut short, &frame(&DATE[3..11]));
    assert_eq!(short.counters().messages_malformed, 1);
}

/// 2038-04-24 is modified Julian day 65,537, of which the field has the lower 16 bits.
#[test]
fn date_rolls_over_in_2038() {
    let mut input = Input::new();
    feed(
        &mut input,
        &frame(
            &Bits::default().put(12, 1013).put(12, 0).put(16, 1).put(17, 75_600).put(5, 0).put(8, 18).bytes(),
        ),
    );
    // Three hours ahead of UTC, Sunday begins: day 0.
    let seen = epochs(feed(&mut input, &msm(1087, 0, false, &[Cell(3, 2, 2.0e7, 50.0)])));
    let days = 21_293_u64;
    let want = GpsTime::from_ms(1000 * (86_400 * days + 75_600 + 18));
    assert_eq!(seen.iter().map(|epoch| epoch.time).collect::<Vec<_>>(), [want]);
}
