//! Times of the host that are wrong, go back, or are none.

use super::*;

/// Epochs of each part of the run.
const PART: usize = 8;

/// The host takes its time back by 100 s, then corrects itself.
#[test]
fn time_that_goes_back_is_an_alert_until_it_is_corrected() {
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
        let mut said = Vec::new();
        let bytes = encoder.epoch(epoch).expect("an epoch");
        module.receiver.gnss(&bytes, 1000 * index as u64, &mut said);
        module.receiver.tick(1000 * index as u64 + 600, &mut said);
        let said = String::from_utf8(said).expect("ASCII");
        replays[index / PART] += said.lines().filter(|line| line.contains(",A,REPLAY,")).count();
        assert!(index / PART != 1 || !module.receiver.pin().high, "{said}");
    }
    assert_eq!(replays, [0, PART, 0, 0]);
    assert!(module.receiver.pin().high, "the promise goes on with the right time");
}

#[test]
fn what_is_no_time_is_refused_and_changes_nothing() {
    let mut module = Module::new(&[]);
    for text in [
        "TRUST",
        "TRUST,1",
        "TRUST,nan,5",
        "TRUST,1e300,5",
        "TRUST,-1,5",
        "TRUST,1.8e9,-5",
        "TRUST,1.8e9,nan",
    ] {
        let mut said = Vec::new();
        module.receiver.command(sentence::command(text).as_bytes(), &mut said);
        let said = String::from_utf8(said).expect("ASCII");
        assert!(said.contains(",ERR,"), "{text}: {said}");
    }
    let said = module.epoch(&[2, 5, 11, 19, 24], 810_000_000, 1000);
    assert!(!said.contains("REPLAY"), "{said}");
}
