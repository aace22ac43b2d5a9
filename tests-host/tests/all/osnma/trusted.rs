//! Times of the host that are wrong, go back, or are none.

use super::*;

/// Epochs of each part of the run.
const PART: usize = 8;

/// Orders that name no time or no bound.
const NO_TIMES: [&str; 7] =
    ["TRUST", "TRUST,1", "TRUST,nan,5", "TRUST,1e300,5", "TRUST,-1,5", "TRUST,1.8e9,-5", "TRUST,1.8e9,nan"];

/// The host takes its time back by 100 s, then corrects itself, and at last sends what is no time.
#[test]
fn time_that_goes_back_is_an_alert_until_it_is_corrected_and_what_is_none_changes_nothing() {
    let recording = Simulation::above_xian(3600.0, 4 * PART as u32, 1).record();
    let mut encoder =
        Encoder::new(&recording.ephemerides, Selection::new("GC", Frequency::Dual).expect("systems"));
    let time = recording.epochs[0].time;
    let utc_s = time.to_ms() as f64 * 1e-3 + 315_964_800.0 - 18.0;
    let mut module = Module::new(&[&format!("WEEK,{}", time.week), &format!("TRUST,{utc_s:.1},5")]);
    let mut replays = [0; 4];
    for (index, epoch) in recording.epochs.iter().enumerate() {
        let wrong_s = if index == PART { -100.0 } else { 0.0 };
        if index == PART || index == 2 * PART {
            module.obey(&format!("TRUST,{:.1},5", utc_s + index as f64 + wrong_s));
        }
        let mut reported = Vec::new();
        for text in NO_TIMES.into_iter().filter(|_| index == 3 * PART) {
            module.receiver.command(sentence::command(text).as_bytes(), &mut reported);
        }
        let refused = String::from_utf8_lossy(&reported).matches(",ERR,").count();
        assert_eq!(refused, if index == 3 * PART { NO_TIMES.len() } else { 0 });
        let bytes = encoder.epoch(epoch).expect("an epoch");
        module.receiver.gnss(&bytes, 1000 * index as u64, &mut reported);
        module.receiver.tick(1000 * index as u64 + 600, &mut reported);
        let reported = String::from_utf8(reported).expect("ASCII");
        replays[index / PART] += reported.lines().filter(|line| line.contains(",A,REPLAY,")).count();
        assert!(index / PART != 1 || !module.receiver.pin().high, "{reported}");
    }
    assert_eq!(replays, [0, PART, 0, 0]);
    assert!(module.receiver.pin().high, "the promise goes on with the right time");
}
