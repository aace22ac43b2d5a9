//! Target: calls of the C interface with arguments of every kind, one after another.
//!
//! Pointers are valid, null or misaligned. Memory is an object's, zeroed, another object's or too
//! short. Sizes at the start of structs match no version. Numbers have any bit pattern, bytes any
//! value. The promises of a C programmer are kept: memory behind a pointer is as long as stated,
//! and the first bytes of memory without an object show that there is none.
//!
//! Invariants: a refusal has a name and changes nothing; nothing is written beyond the memory
//! handed in; the words of a verdict are in the header, and a protected one has levels.
#![allow(unsafe_code)]

use std::f64::consts::TAU;
use std::ffi::CStr;

use rai::{
    RAI_MAX_SATELLITES, RAI_MONITOR_WORDS, RAI_REASON_NONE, RAI_RECEIVER_WORDS, RAI_STATE_ALERT,
    RAI_STATE_PROTECTED, RAI_STATE_UNAVAILABLE, RAI_STATUS_OK, rai_monitor_t, rai_range_t, rai_receiver_t,
    rai_settings_t, rai_text_t, rai_verdict_t,
};

use super::tape::Tape;

/// Fill value of memory before any write.
const BLANK: u8 = 0x5A;
/// Number of guard bytes after the memory handed in, which must not change.
const GUARD: usize = 64;

/// Makes calls until the bytes end.
pub fn run(input: &[u8]) {
    let mut tape = Tape::new(input);
    let mut objects = Objects::new();
    while !tape.is_over() {
        let status = objects.call(&mut tape);
        // SAFETY: the string lives as long as the program.
        let words = unsafe { CStr::from_ptr(rai::rai_status_text(status)) };
        assert_ne!(words, c"unknown status", "status {status}");
    }
}

/// Memory of a monitor and of a receiver, in words, so that it is aligned.
struct Objects {
    monitor: Vec<u64>,
    receiver: Vec<u64>,
    now_ms: u64,
}

/// Condition of a pointer.
#[derive(Clone, Copy)]
enum Pointer {
    Sound,
    Null,
    Misaligned,
}

impl Pointer {
    /// Draws a condition, mostly sound.
    fn read(tape: &mut Tape<'_>) -> Self {
        match tape.byte() {
            0..8 => Self::Null,
            8..16 => Self::Misaligned,
            _ => Self::Sound,
        }
    }

    fn of<T>(self, sound: *mut T) -> *mut T {
        match self {
            Self::Sound => sound,
            Self::Null => std::ptr::null_mut(),
            Self::Misaligned => sound.wrapping_byte_add(1),
        }
    }
}

impl Objects {
    fn new() -> Self {
        // Zeroed memory has no mark, like that of a program that has just started.
        Self { monitor: vec![0; RAI_MONITOR_WORDS], receiver: vec![0; RAI_RECEIVER_WORDS], now_ms: 0 }
    }

    /// Makes one call. A refused call must leave both objects unchanged.
    fn call(&mut self, tape: &mut Tape<'_>) -> u8 {
        let before = (tape.byte() < 32).then(|| (self.monitor.clone(), self.receiver.clone()));
        let status = match tape.byte() % 11 {
            0 => self.make_monitor(tape),
            1 => self.configure(tape),
            2..5 => self.judge(tape),
            5 => self.forget(tape),
            6 => self.make_receiver(tape),
            7 | 8 => self.receive(tape),
            9 => self.obey_or_wait(tape),
            _ => self.ask(tape),
        };
        if let (Some((monitor, receiver)), true) = (before, status != RAI_STATUS_OK) {
            assert!(self.monitor == monitor && self.receiver == receiver, "refused by {status}, and changed");
        }
        status
    }

    /// Returns a monitor's handle: its own memory, or the receiver's, which holds no monitor.
    fn monitor(&mut self, tape: &mut Tape<'_>) -> *mut rai_monitor_t {
        let memory = if tape.byte() < 4 { self.receiver.as_mut_ptr() } else { self.monitor.as_mut_ptr() };
        Pointer::read(tape).of(memory.cast())
    }

    fn receiver(&mut self, tape: &mut Tape<'_>) -> *mut rai_receiver_t {
        // The monitor's memory is shorter. It is refused by its mark before the rest of it is read.
        let memory = if tape.byte() < 4 { self.monitor.as_mut_ptr() } else { self.receiver.as_mut_ptr() };
        Pointer::read(tape).of(memory.cast())
    }

    fn make_monitor(&mut self, tape: &mut Tape<'_>) -> u8 {
        let mut settings = settings(tape);
        let length = if tape.byte() < 16 { usize::from(tape.byte()) * 64 } else { self.monitor.len() * 8 };
        let (memory, settings) =
            (Pointer::read(tape).of(self.monitor.as_mut_ptr()), Pointer::read(tape).of(&raw mut settings));
        // SAFETY: the memory is at least as long as stated, the settings no longer than they are.
        unsafe { rai::rai_monitor_init(memory.cast(), length.min(self.monitor.len() * 8), settings) }
    }

    fn configure(&mut self, tape: &mut Tape<'_>) -> u8 {
        let mut settings = settings(tape);
        let (monitor, settings) = (self.monitor(tape), Pointer::read(tape).of(&raw mut settings));
        // SAFETY: an object, or memory without one; the settings are no longer than they are.
        unsafe { rai::rai_monitor_configure(monitor, settings) }
    }

    fn forget(&mut self, tape: &mut Tape<'_>) -> u8 {
        let monitor = self.monitor(tape);
        // SAFETY: an object, or memory without one.
        unsafe { rai::rai_monitor_forget(monitor) }
    }

    fn judge(&mut self, tape: &mut Tape<'_>) -> u8 {
        let time_s = tape.number(0.0, 1e5);
        let ranges = ranges(tape);
        let pointer = Pointer::read(tape);
        // The second count is impossible, and is refused before any range is read.
        let count = match pointer {
            Pointer::Sound => ranges.len(),
            Pointer::Null | Pointer::Misaligned => tape.one_of(&[ranges.len(), usize::MAX]),
        };
        let mut given = Given::new(tape);
        let (monitor, verdict) = (self.monitor(tape), Pointer::read(tape).of(given.place()));
        let ranges = pointer.of(ranges.as_ptr().cast_mut());
        // SAFETY: the count is true if ranges are read; the verdict has room for its stated size.
        let status = unsafe { rai::rai_monitor_judge(monitor, time_s, ranges, count, verdict) };
        given.check(status);
        status
    }

    fn make_receiver(&mut self, tape: &mut Tape<'_>) -> u8 {
        let length = if tape.byte() < 16 { usize::from(tape.byte()) * 128 } else { self.receiver.len() * 8 };
        let memory = Pointer::read(tape).of(self.receiver.as_mut_ptr());
        let most = self.receiver.len() * 8;
        Reported::during(tape, |text| {
            // SAFETY: the memory is at least as long as stated, and so is the text.
            unsafe { rai::rai_receiver_init(memory.cast(), length.min(most), text) }
        })
    }

    fn receive(&mut self, tape: &mut Tape<'_>) -> u8 {
        let count = usize::from(tape.word() as u16 % 1500);
        let bytes: Vec<u8> = (0..count.min(tape.left())).map(|_| tape.byte()).collect();
        // Time advances; for a caller without care it goes back or overflows.
        self.now_ms = match tape.byte() {
            0..3 => u64::from(tape.word()) << 32,
            3 => u64::MAX,
            _ => self.now_ms.saturating_add(tape.byte().into()),
        };
        let (receiver, pointer, mut judged) = (self.receiver(tape), Pointer::read(tape), 7_u8);
        let judged_at = if tape.byte() < 32 { std::ptr::null_mut() } else { &raw mut judged };
        let bytes_at = if matches!(pointer, Pointer::Null) { std::ptr::null() } else { bytes.as_ptr() };
        let now_ms = self.now_ms;
        Reported::during(tape, |text| {
            // SAFETY: as many bytes as stated, or null; the text is as long as stated.
            unsafe { rai::rai_receiver_gnss(receiver, bytes_at, bytes.len(), now_ms, text, judged_at) }
        })
    }

    fn obey_or_wait(&mut self, tape: &mut Tape<'_>) -> u8 {
        let receiver = self.receiver(tape);
        let choice = tape.byte();
        if choice < 128 {
            let count = usize::from(tape.byte()).min(tape.left());
            let mut bytes: Vec<u8> = (0..count).map(|_| tape.byte()).collect();
            if choice < 32 {
                return set(receiver, &mut bytes, tape);
            }
            return Reported::during(tape, |text| {
                // SAFETY: as many bytes as stated; the text is as long as stated.
                unsafe { rai::rai_receiver_command(receiver, bytes.as_ptr(), bytes.len(), text) }
            });
        }
        self.now_ms = self.now_ms.saturating_add(u64::from(tape.word() as u16));
        let now_ms = self.now_ms;
        // SAFETY: an object, or memory without one; the text is as long as stated.
        Reported::during(tape, |text| unsafe { rai::rai_receiver_tick(receiver, now_ms, text) })
    }

    /// Checks that all queries of a receiver agree with each other.
    fn ask(&mut self, tape: &mut Tape<'_>) -> u8 {
        let receiver = self.receiver(tape);
        let mut given = Given::new(tape);
        let mut reason = 0;
        // SAFETY: an object, or memory without one; the verdict has room for its stated size.
        let (pin, state, reset, status) = unsafe {
            (
                rai::rai_receiver_pin(receiver),
                rai::rai_receiver_state(receiver, &raw mut reason),
                rai::rai_receiver_reset_requested(receiver),
                rai::rai_receiver_report(receiver, given.place()),
            )
        };
        assert!(pin <= 1 && reset <= 1);
        assert!(
            pin == 0 || state == RAI_STATE_PROTECTED,
            "the pin is high in state {state}, reason {reason}"
        );
        if status == RAI_STATUS_OK {
            assert_eq!((given.verdict().state, given.verdict().reason), (state, reason));
            if given.size == size_of::<rai_verdict_t>() {
                explain(receiver, &given.verdict());
            }
        }
        given.check(status);
        status
    }
}

/// Sets by a key and values cut from the bytes at the first NUL.
fn set(receiver: *mut rai_receiver_t, bytes: &mut Vec<u8>, tape: &mut Tape<'_>) -> u8 {
    bytes.extend([0, 0]);
    let mut texts = bytes.splitn(2, |byte| *byte == 0).map(<[u8]>::as_ptr);
    let (key, values) = (texts.next().expect("a key").cast(), texts.next().expect("values").cast());
    // SAFETY: a NUL ends each text; the text for the answer is as long as stated.
    Reported::during(tape, |text| unsafe { rai::rai_receiver_set(receiver, key, values, text) })
}

/// Checks that the explanations of an epoch agree with its verdict.
fn explain(receiver: *const rai_receiver_t, verdict: &rai_verdict_t) {
    // SAFETY: the fields are integers and doubles, of which zeros are values.
    let (mut accuracy, mut velocity): (rai::rai_accuracy_t, rai::rai_velocity_t) =
        unsafe { (std::mem::zeroed(), std::mem::zeroed()) };
    accuracy.size = size_of_val(&accuracy) as u32;
    velocity.size = size_of_val(&velocity) as u32;
    let mut residuals =
        [const { std::mem::MaybeUninit::<rai::rai_residual_t>::uninit() }; RAI_MAX_SATELLITES];
    let mut count = 0;
    // SAFETY: an object; every struct has the size that it states.
    let statuses = unsafe {
        [
            rai::rai_receiver_accuracy(receiver, &raw mut accuracy),
            rai::rai_receiver_velocity(receiver, &raw mut velocity),
            rai::rai_receiver_residuals(
                receiver,
                residuals.as_mut_ptr().cast(),
                residuals.len(),
                &raw mut count,
            ),
        ]
    };
    assert_eq!(statuses, [RAI_STATUS_OK; 3]);
    // SAFETY: so many have been written.
    let written = residuals.iter().take(count).map(|residual| unsafe { residual.assume_init() });
    let used = written.filter(|residual| residual.is_used == 1).inspect(|residual| {
        assert!(residual.residual_m.is_finite(), "{residual:?}");
    });
    assert_eq!(used.count(), if verdict.x_m.is_nan() { 0 } else { verdict.used.into() });
    assert_eq!(accuracy.hdop.is_nan(), verdict.x_m.is_nan());
    let numbers = [velocity.east_m_s, velocity.up_m_s, velocity.threshold];
    assert!(numbers.iter().all(|number| number.is_finite() != velocity.north_m_s.is_nan()), "{velocity:?}");
}

/// Returns settings of a phase, with any values in them.
fn settings(tape: &mut Tape<'_>) -> rai_settings_t {
    // SAFETY: the fields are integers and doubles, of which zeros are values.
    let mut settings: rai_settings_t = unsafe { std::mem::zeroed() };
    settings.size = size_of::<rai_settings_t>() as u32;
    // SAFETY: the struct is as long as it states.
    let status = unsafe { rai::rai_settings_preset(&raw mut settings, tape.byte() % 5) };
    if tape.byte() < 128 {
        (settings.policy, settings.method) = (tape.byte() % 4, tape.byte() % 9);
        (settings.clock_aid, settings.levels) = (tape.byte() % 2, tape.byte() % 3);
    }
    if tape.byte() < 32 {
        (settings.hal_m, settings.val_m) = (tape.number(1.0, 4e3), tape.number(0.0, 4e3));
        settings.false_alarm = tape.one_of(&[3.33e-7, 1e-3, 1e-5, 0.0, f64::NAN]);
        settings.max_speed_m_s = tape.number(0.0, 1e3);
        (settings.min_height_m, settings.max_height_m) = (tape.number(-1e3, 0.0), tape.number(0.0, 1e5));
        (settings.recovery_s, settings.recovery_epochs) = (tape.number(0.0, 60.0), tape.byte().into());
    }
    if status == RAI_STATUS_OK && tape.byte() < 8 {
        // The size is never larger than the memory, because that is the caller's promise.
        settings.size = tape.one_of(&[0, 4, 79, 81, u32::MAX]);
    }
    settings
}

/// Returns ranges of satellites about a point, with any values in them.
fn ranges(tape: &mut Tape<'_>) -> Vec<rai_range_t> {
    const RADIUS_M: f64 = 2.6e7;
    let clock_m = tape.number(-3e5, 3e5);
    let range = |tape: &mut Tape<'_>| {
        let (azimuth, sine) = (tape.within(0.0, TAU), tape.within(0.0, 1.0));
        let flat = RADIUS_M * (1.0 - sine * sine).sqrt();
        let [x_m, y_m, z_m] = [RADIUS_M * sine, flat * azimuth.cos(), flat * azimuth.sin()];
        // The point is on the equator.
        let far_m = ((x_m - 6_378_137.0).powi(2) + y_m * y_m + z_m * z_m).sqrt();
        rai_range_t {
            x_m: if tape.byte() < 4 { tape.number(-1e8, 1e8) } else { x_m },
            y_m,
            z_m,
            range_m: far_m + clock_m + if tape.byte() < 16 { tape.number(-1e4, 1e4) } else { 0.0 },
            sigma_m: tape.number(0.5, 10.0),
            system: tape.one_of(b"GGCERX"),
            number: tape.byte() % 101,
            reserved: [0; 6],
        }
    };
    (0..tape.byte() % 60).map(|_| range(tape)).collect()
}

/// Memory of a verdict with a guard after it, and its stated size.
struct Given {
    words: Vec<u64>,
    size: usize,
}

impl Given {
    fn new(tape: &mut Tape<'_>) -> Self {
        let whole = size_of::<rai_verdict_t>();
        let size = if tape.byte() < 16 { tape.one_of(&[0, 3, whole - 1, whole + 8]) } else { whole };
        let mut words = vec![u64::from_ne_bytes([BLANK; 8]); (whole + 8 + GUARD) / 8];
        let first = words.first_mut().expect("some");
        *first = *first & !u64::from(u32::MAX) | size as u64;
        Self { words, size }
    }

    fn place(&mut self) -> *mut rai_verdict_t {
        self.words.as_mut_ptr().cast()
    }

    fn verdict(&self) -> rai_verdict_t {
        // SAFETY: the memory is aligned, longer and initialised, and every bit pattern is a
        // verdict.
        unsafe { self.words.as_ptr().cast::<rai_verdict_t>().read() }
    }

    /// Checks that nothing was written beyond the verdict, nothing at all after a refusal, and that
    /// the verdict is consistent.
    fn check(&self, status: u8) {
        let bytes = || self.words.iter().flat_map(|word| word.to_ne_bytes());
        let written = if status == RAI_STATUS_OK { size_of::<rai_verdict_t>() } else { size_of::<u32>() };
        assert!(bytes().skip(written).all(|byte| byte == BLANK), "written beyond what was handed in");
        let verdict = self.verdict();
        assert_eq!(verdict.size as usize, self.size, "the size is the caller's");
        if status != RAI_STATUS_OK {
            return;
        }
        assert!(verdict.state <= RAI_STATE_UNAVAILABLE && verdict.used <= verdict.tracked);
        // SAFETY: the string lives as long as the program.
        let words = unsafe { CStr::from_ptr(rai::rai_reason_text(verdict.reason)) };
        assert!(words != c"?" || verdict.reason == RAI_REASON_NONE, "reason {}", verdict.reason);
        if verdict.state == RAI_STATE_PROTECTED {
            let numbers = [verdict.hpl_m, verdict.x_m, verdict.y_m, verdict.z_m, verdict.latitude_rad];
            assert!(numbers.iter().all(|number| number.is_finite()), "protected: {verdict:?}");
        }
        assert!(
            verdict.state == RAI_STATE_ALERT || usize::from(verdict.excluded_count) <= verdict.excluded.len()
        );
    }
}

/// Memory for sentences with a guard after it.
struct Reported;

impl Reported {
    /// Makes a call that may write sentences, and checks them.
    fn during(tape: &mut Tape<'_>, call: impl FnOnce(*mut rai_text_t) -> u8) -> u8 {
        let capacity = if tape.byte() < 64 { usize::from(tape.byte()) } else { 4096 };
        let length = if tape.byte() < 8 { capacity + 1 } else { capacity / 3 };
        let mut bytes = vec![BLANK; capacity + GUARD];
        let at = if tape.byte() < 4 { std::ptr::null_mut() } else { bytes.as_mut_ptr() };
        let mut text = rai_text_t { bytes: at, capacity, length, lost: 0 };
        let status = call(Pointer::read(tape).of(&raw mut text));
        let end = text.length;
        assert!(
            end >= length && (end <= capacity || status != RAI_STATUS_OK),
            "{length} to {end} of {capacity}"
        );
        let reported = length.min(capacity)..end.min(capacity).max(length.min(capacity));
        let untouched = bytes.iter().enumerate().filter(|(index, _)| !reported.contains(index));
        assert!(untouched.clone().all(|(_, &byte)| byte == BLANK), "written beyond what was handed in");
        let words = bytes.get(reported).unwrap_or_default();
        assert!(words.is_empty() || words.ends_with(b"\n") || !words.is_ascii(), "a sentence is whole");
        status
    }
}
