//! In an alert no output carries a coordinate, a height or a speed.
//!
//! The outputs are not named here. Two epochs that differ in place, height and velocity alone must
//! be sent as the same bytes, so that a new output is held to the rule as soon as the schedule has
//! it.

use raim_core::report::{Alert, Protected, Verdict};
use raim_firmware::output::schedule::{Item, Schedule};
use raim_firmware::output::{Motion, Statement};
use raim_firmware::publisher::Publisher;

use super::{Growing, npa, report, solution, statement};

/// Returns every item of the schedule.
fn items() -> Vec<Item> {
    Schedule::AT_START.rates().map(|(name, _)| Item::named(name).expect("an item of this name")).collect()
}

/// Returns the bytes of one epoch at a place, with a velocity, of all items.
fn sent(verdict: Verdict, place: [f64; 3], motion: Motion) -> Vec<u8> {
    sent_as(verdict, place, motion, |_| 1)
}

/// Returns the same with each item at a rate.
fn sent_as(
    verdict: Verdict,
    [latitude_deg, longitude_deg, height_m]: [f64; 3],
    motion: Motion,
    rate: impl Fn(Item) -> u8,
) -> Vec<u8> {
    let (mut report, npa) = (report(), npa());
    report.verdict = verdict;
    report.solution = Some(solution(latitude_deg, longitude_deg, height_m));
    let statement = Statement { motion: Some(motion), ..statement(&report, &npa) };
    let schedule =
        items().into_iter().fold(Schedule::AT_START, |schedule, item| schedule.with(item, rate(item)));
    let mut bytes = Vec::new();
    Publisher::new(0).tell(&statement, &schedule, &mut Growing(&mut bytes)).expect("a vector takes all");
    bytes
}

const HERE: [f64; 3] = [55.25, -10.5, 55.123];
const STILL: Motion = Motion { east_m_s: 0.01, north_m_s: 0.02, up_m_s: 0.0, sigma_m_s: 0.1 };
const FAST: Motion = Motion { east_m_s: -30.0, north_m_s: 40.0, up_m_s: 5.0, sigma_m_s: 0.1 };

/// Epochs that differ from the first in one of latitude, longitude, height and velocity.
const OTHERS: [([f64; 3], Motion); 4] = [
    ([-12.5, -10.5, 55.123], STILL),
    ([55.25, 110.5, 55.123], STILL),
    ([55.25, -10.5, 1234.5], STILL),
    (HERE, FAST),
];

const ALERTS: [Alert; 8] = [
    Alert::Fault,
    Alert::Ambiguous,
    Alert::Time,
    Alert::Stale,
    Alert::Jump,
    Alert::Clock,
    Alert::Track,
    Alert::Spoofed,
];

#[test]
fn every_item_of_the_schedule_adds_bytes() {
    let verdict = Verdict::Protected(Protected::Ok);
    // The first epoch is worse than none before it, and sends every item with a rate.
    let without = sent_as(verdict, HERE, STILL, |_| 0);
    for item in items().into_iter().filter(|item| item.is_built()) {
        let with = sent_as(verdict, HERE, STILL, |other| u8::from(other == item));
        // Satellites in view need the raw epoch, which this statement lacks.
        assert!(with.len() > without.len() || item == Item::Gsv, "{item:?} is in no output");
    }
}

#[test]
fn in_an_alert_no_output_depends_on_place_height_or_velocity() {
    for alert in ALERTS {
        let want = sent(Verdict::Alert(alert), HERE, STILL);
        for (place, motion) in OTHERS {
            let have = sent(Verdict::Alert(alert), place, motion);
            assert_eq!(
                String::from_utf8_lossy(&have),
                String::from_utf8_lossy(&want),
                "{alert:?}, {place:?}, {motion:?}"
            );
            assert_eq!(have, want, "{alert:?}, {place:?}, {motion:?}");
        }
    }
}

/// The rule above is not void, because without an alert each of them changes the output.
#[test]
fn without_an_alert_outputs_carry_place_height_and_velocity() {
    let verdict = Verdict::Protected(Protected::Ok);
    for (place, motion) in OTHERS {
        assert_ne!(sent(verdict, place, motion), sent(verdict, HERE, STILL), "{place:?}, {motion:?}");
    }
}
