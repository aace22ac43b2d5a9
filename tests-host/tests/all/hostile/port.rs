//! A line that falls silent, and a host that sends invalid commands.

use raim::sentence;
use raim_firmware::settings::Setting;

use super::frames::frames;
use super::module::{Module, Sky};

#[test]
fn a_silent_line_is_stale_after_the_time_to_alert_and_the_pin_falls() {
    let sky = Sky::quiet(6);
    let mut module = Module::after(&sky, 3);
    let limit_ms = (module.receiver.configuration().time_to_alert_s * 1e3) as u64;
    // The last epoch came a second ago.
    assert!(module.silence(limit_ms - 1100).is_empty(), "no alert before its time");
    assert!(module.pin_is_high());
    let reported = module.silence(200);
    let [only] = reported.as_slice() else { panic!("one alert: {reported:?}") };
    assert_eq!((only.state.state, only.state.reason.as_str()), ('A', "STALE"));
    assert!(!module.pin_is_high());
    assert_eq!(module.grown("line_stale"), 1);
    module.recovers(&sky.lumps[3]);
}

#[test]
fn noise_is_no_sign_of_life() {
    let sky = Sky::quiet(15);
    let mut module = Module::after(&sky, 3);
    let limit_s = module.receiver.configuration().time_to_alert_s as usize;
    let reported: Vec<_> = (0..=limit_s).flat_map(|_| module.receive(&[0x55; 400])).collect();
    assert!(reported.iter().any(|output| output.state.reason == "STALE"), "{reported:?}");
    assert!(!module.pin_is_high());
    module.recovers(&sky.lumps[module.second()]);
}

fn command(body: &str) -> String {
    format!("${body}*{:02X}\r\n", body.bytes().fold(0_u8, |sum, byte| sum ^ byte))
}

#[test]
fn a_bad_command_is_refused_with_the_reason_and_changes_nothing() {
    let cases = [
        ("$PRAIC,HAL,40*00\r\n".to_owned(), "cmd_checksum", "checksum"),
        ("$PRAIC,HAL,40\r\n".to_owned(), "cmd_checksum", "checksum"),
        (command("PRAIC,FOO,1"), "cmd_unknown_key", "unknown key"),
        (command("PRAIC,HAL,-1"), "cmd_refused", "out of range"),
        (command("PRAIC,MASK,91"), "cmd_refused", "out of range"),
        (command("PRAIC,TTA,0"), "cmd_refused", "out of range"),
        (command("PRAIC,PFA,2"), "cmd_refused", "out of range"),
        (command("PRAIC,HAL,nan"), "cmd_refused", "not a number"),
        (command("PRAIC,HAL,1e999"), "cmd_refused", "not a number"),
        (command("PRAIC,PHASE,LUNCH"), "cmd_refused", "unknown value"),
        (command("PRAIC,HAL,"), "cmd_refused", "missing value"),
    ];
    let sky = Sky::quiet(20);
    let mut module = Module::after(&sky, 3);
    let want = *module.receiver.configuration();
    for ((bytes, counter, why), lump) in cases.into_iter().zip(&sky.lumps[3..]) {
        module.note();
        let mut reported = Vec::new();
        module.receiver.command(bytes.as_bytes(), &mut reported);
        let answer = String::from_utf8(reported).unwrap();
        assert!(
            answer.starts_with("$PRAIA,") && answer.contains(&format!(",ERR,{why}*")),
            "{bytes}: {answer}"
        );
        assert_eq!(module.grown(counter), 1, "{bytes}");
        assert_eq!(module.grown("cmd_ok"), 0, "{bytes}");
        assert_eq!(*module.receiver.configuration(), want, "{bytes}");
        module.recovers(lump);
    }
}

/// A setting that a promise rests on takes it back at once; the next epoch is judged under the new
/// one.
#[test]
fn no_setting_leaves_an_old_promise_standing() {
    let sky = Sky::quiet(5);
    for setting in Setting::ALL {
        let (key, row) = (setting.key(), setting.row());
        let mut module = Module::after(&sky, 4);
        let mut reported = Vec::new();
        let order = sentence::command(&format!("{key},{}", setting.documentation().example));
        module.receiver.command(order.as_bytes(), &mut reported);
        assert_eq!(module.pin_is_high(), !row.bears_on_promise, "{key}");
        let reported = sentence::epochs(&String::from_utf8(reported).unwrap()).unwrap();
        let reasons: Vec<_> = reported.iter().map(|output| output.state.reason.as_str()).collect();
        assert_eq!(reasons, if row.bears_on_promise { vec!["SETTINGS"] } else { vec![] }, "{key}");
        assert!(reported.iter().all(|output| !output.state.has_epoch()), "{key}");
        assert_eq!(module.receiver.last_report().is_some(), !row.bears_on_promise, "{key}");
        let reported = module.receive(&sky.lumps[4]);
        assert!(reported.len() == 1 && reported[0].state.reason != "SETTINGS", "{key}: {reported:?}");
    }
}

/// Returns a sky whose sixth lump comes half a minute after its fifth.
fn sky_with_a_gap() -> Sky {
    let mut sky = Sky::quiet(40);
    sky.lumps.drain(5..35);
    sky
}

#[test]
fn an_epoch_whose_last_message_is_lost_ends_with_the_silence_of_the_line() {
    let sky = sky_with_a_gap();
    let mut module = Module::after(&sky, 4);
    let begun = frames(&sky.lumps[4]);
    let reported = module.receive(&begun[..begun.len() - 1].concat());
    assert!(reported.len() == 1 && reported[0].state.has_epoch(), "{reported:?}");
    let reported = module.silence(30_000);
    assert!(
        reported.iter().all(|output| output.state.reason == "STALE") && !module.pin_is_high(),
        "{reported:?}"
    );
    module.recovers(&sky.lumps[5]);
}

#[test]
fn the_time_to_alert_counts_from_when_an_epoch_came() {
    let sky = sky_with_a_gap();
    let mut module = Module::after(&sky, 4);
    let begun = frames(&sky.lumps[4]);
    let reported = module.receive(&begun[..begun.len() - 1].concat());
    assert!(reported.len() == 1 && module.pin_is_high(), "{reported:?}");
    // Noise on the line is no epoch.
    let reported: Vec<_> = (0..8).flat_map(|_| module.receive(&[0x55; 400])).collect();
    assert!(reported.is_empty() && module.pin_is_high(), "nine seconds old, and still good: {reported:?}");
    let reported = module.silence(1500);
    assert!(reported.len() == 1 && reported[0].state.reason == "STALE", "{reported:?}");
    assert!(!module.pin_is_high(), "ten seconds after the epoch came");
}
