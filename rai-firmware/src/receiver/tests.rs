use std::format;
use std::string::String;
use std::vec::Vec;

use embedded_io::ErrorKind;
use raim_core::report::Protected;
use raim_core::requirements::Requirements;

use super::*;
use crate::pin::MemoryPin;
use crate::selftest::Failure;
use crate::settings::Setting;

/// A host that accepts no byte.
struct Deaf;

impl embedded_io::ErrorType for Deaf {
    type Error = ErrorKind;
}

impl Write for Deaf {
    fn write(&mut self, _: &[u8]) -> Result<usize, ErrorKind> {
        Err(ErrorKind::TimedOut)
    }

    fn flush(&mut self) -> Result<(), ErrorKind> {
        Ok(())
    }
}

fn promising() -> Receiver<MemoryPin> {
    let boot = Boot::on_host("test");
    let mut receiver = Receiver::new(MemoryPin { high: true }, boot).expect("in the tables");
    receiver.epochs.drive_pin(true);
    receiver
}

#[test]
fn a_change_whose_answer_is_lost_is_judged_by_nevertheless() {
    let mut receiver = promising();
    receiver.command(b"$PRAIC,HAL,40*08\r\n", &mut Deaf);
    let want = Requirements::non_precision_approach().with_hal_m(40.0);
    assert_eq!(receiver.configuration().requirements(), want);
    assert_eq!(*receiver.epochs.navigator.requirements(), want);
}

#[test]
fn a_reset_whose_answer_is_lost_is_made_nevertheless() {
    let mut receiver = promising();
    receiver.command(b"$PRAIC,RESET*30\r\n", &mut Deaf);
    assert!(receiver.reset_requested());
    assert!(!receiver.pin().high);
    assert_eq!(receiver.epochs.verdicts.host_lost, 1);
}

/// Returns a command with its checksum.
fn command(body: &str) -> String {
    let checksum = body.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${body}*{checksum:02X}\r\n")
}

/// Returns the answer of a module that protects its position to a command, and true if the pin
/// stays high.
fn told(body: &str) -> (String, bool) {
    let mut receiver = promising();
    receiver.epochs.last_verdict = Some(Verdict::Protected(Protected::Ok));
    let mut reported = Vec::new();
    receiver.command(command(body).as_bytes(), &mut reported);
    (String::from_utf8(reported).expect("ASCII"), receiver.pin().high)
}

#[test]
fn every_setting_that_a_promise_rests_on_takes_it_back_at_once() {
    for setting in Setting::ALL {
        let (key, bears) = (setting.key(), setting.row().bears_on_promise);
        let (reported, is_high) = told(&format!("PRAIC,{key},{}", setting.documentation().example));
        assert!(reported.starts_with(&format!("$PRAIA,{key},")) && reported.contains(",OK"), "{reported}");
        assert_eq!(is_high, !bears, "{key}: {reported}");
        assert_eq!(reported.contains("\n$PRAIS,,U,SETTINGS,0,0,"), bears, "{key}: {reported}");
    }
}

#[test]
fn a_command_that_changes_nothing_takes_no_promise_back() {
    for body in ["PRAIC,MASK,10", "PRAIC,MASK", "PRAIC,MASK,x", "PRAIC,PHASE,NPA", "PRAIC,STATS"] {
        let (reported, is_high) = told(body);
        assert!(is_high && !reported.contains("PRAIS"), "{reported}");
    }
}

#[test]
fn a_setting_changed_before_any_promise_is_answered_alone() {
    let mut receiver = promising();
    let mut reported = Vec::new();
    receiver.command(command("PRAIC,MASK,5").as_bytes(), &mut reported);
    assert_eq!(reported, command("PRAIA,MASK,5,OK").as_bytes());
}

#[test]
fn settings_that_a_restart_has_lost_have_to_be_confirmed() {
    let mut sealed = [0; SEALED_BYTES];
    let mut before = promising();
    before.command(b"$PRAIC,HAL,40*08\r\n", &mut Deaf);
    before.seal(&mut sealed);
    let mut restored = promising();
    restored.restore(&sealed, false);
    assert_eq!(restored.configuration().hash(), before.configuration().hash());
    assert!(restored.epochs.is_confirmed);

    sealed[SEALED_BYTES - 1] ^= 1;
    for (memory, after_power_on, want) in
        [(sealed, false, false), ([0; SEALED_BYTES], false, false), (sealed, true, true)]
    {
        let mut receiver = promising();
        receiver.restore(&memory, after_power_on);
        assert_eq!(receiver.epochs.is_confirmed, want);
        receiver.command(b"$PRAIC,CONFIRM*37\r\n", &mut Deaf);
        assert!(receiver.epochs.is_confirmed);
    }
}

/// Sealed before the host confirms them, the settings at start would count as confirmed after a
/// second restart.
#[test]
fn settings_that_nobody_has_confirmed_are_not_sealed() {
    let mut sealed = [0; SEALED_BYTES];
    for restart in 1..4 {
        let mut receiver = promising();
        receiver.restore(&sealed, false);
        receiver.seal(&mut sealed);
        receiver.command(b"$PRAIC,HAL,40*08\r\n", &mut Deaf);
        receiver.seal(&mut sealed);
        assert!(!receiver.epochs.is_confirmed, "restart {restart}");
    }
    let mut receiver = promising();
    receiver.restore(&sealed, false);
    receiver.command(b"$PRAIC,CONFIRM*37\r\n", &mut Deaf);
    receiver.seal(&mut sealed);
    let mut restored = promising();
    restored.restore(&sealed, false);
    assert!(restored.epochs.is_confirmed);
}

#[test]
fn a_clock_that_goes_back_keeps_no_promise_alive() {
    let mut receiver = promising();
    // The silence so far is reported; then an epoch comes, and the clock of 32 bits restarts.
    receiver.tick(u64::from(u32::MAX), &mut Deaf);
    receiver.epochs.drive_pin(true);
    receiver.tick(u64::from(u32::MAX) + 1, &mut Deaf);
    assert!(receiver.pin().high);
    receiver.tick(0, &mut Deaf);
    assert!(!receiver.pin().high);
}

#[test]
fn whoever_misses_a_known_answer_promises_nothing() {
    let mut receiver = promising();
    let _ = receiver.epochs.record_self_test(Err(Failure::Table));
    assert!(!receiver.pin().high);
    receiver.epochs.drive_pin(true);
    assert!(!receiver.pin().high);
}
