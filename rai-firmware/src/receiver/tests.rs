use core::convert::Infallible;

use embedded_hal::digital::ErrorType;
use embedded_io::ErrorKind;
use rai_core::requirements::Requirements;

use super::*;
use crate::selftest::Failure;

#[derive(Debug)]
struct Level {
    high: bool,
}

impl ErrorType for Level {
    type Error = Infallible;
}

impl OutputPin for Level {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.high = false;
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.high = true;
        Ok(())
    }
}

/// A host that takes nothing.
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

fn promising() -> Receiver<Level> {
    let boot = Boot::on_host("test");
    let mut receiver = Receiver::new(Level { high: true }, boot).expect("in the tables");
    receiver.epochs.drive_pin(true);
    receiver
}

#[test]
fn a_change_whose_answer_is_lost_is_judged_by_nevertheless() {
    let mut receiver = promising();
    receiver.command(b"$PRAIC,HAL,40*08\r\n", &mut Deaf);
    let want = Requirements { hal_m: 40.0, ..Requirements::non_precision_approach() };
    assert_eq!(receiver.configuration().requirements, want);
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

#[test]
fn other_requirements_take_the_promise_back() {
    let mut receiver = promising();
    receiver.command(b"$PRAIC,MASK,5*68\r\n", &mut [0; 100].as_mut_slice());
    assert!(receiver.pin().high, "the mask is no requirement");
    receiver.command(b"$PRAIC,HAL,40*08\r\n", &mut [0; 100].as_mut_slice());
    assert!(!receiver.pin().high);
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

/// The settings at start are nobody's until they are confirmed: sealed before, a second restart would take them for meant.
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
    // The silence so far is said; then there is an epoch, and the clock of 32 bits begins anew.
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
