//! A leap second on the wire, in every order of systems.

use super::gps;
use crate::wire::{B1I, Cell, E1C, msm};
use raim_firmware::input::{Event, Input};
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

/// Runs over the step with a burst every `step_ms`, from 100 s before the inserted second on.
fn run(order: &str, step_ms: u32) {
    let mut input = Input::new();
    input.assume(MIDNIGHT_UTC.week - 1);
    let (mut known, mut epochs) = (Vec::new(), 0);
    let many = 130_000 / step_ms;
    for burst in 0..many {
        let gps_ms = MIDNIGHT_UTC.to_ms() + u64::from(BEFORE_S) * 1000 - 100_000 + u64::from(burst * step_ms);
        let after_step = gps_ms >= MIDNIGHT_UTC.to_ms() + u64::from(BEFORE_S + 1) * 1000;
        let leap_s = BEFORE_S + u32::from(after_step);
        let tow_ms = (gps_ms % u64::from(WEEK_MS)) as u32;
        let burst_of = Burst { tow_ms, utc_ms: (tow_ms + WEEK_MS - leap_s * 1000) % WEEK_MS };
        let came_ms = u64::from(burst * step_ms);
        for (place, system) in order.chars().enumerate() {
            let message = burst_of.message(system, place < 3);
            input.feed(&message, came_ms + 5 * place as u64, |event| {
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
