//! Target: calls of the C interface with arguments of every kind, one after another.
//!
//! Pointers are sound, null or misaligned; memory is an object's, zeroed, another object's or too short; sizes at the start of
//! structs are of no version; numbers are any pattern of bits, bytes anything. What a C programmer must promise is kept: what is
//! pointed to is as long as said, and the first bytes of memory without an object say so.
//!
//! What must hold: a refusal has a name and has changed nothing; nothing is written beyond what was handed in; what a verdict
//! says is one of the header's words, and a protected one has levels.
#![allow(unsafe_code)]

use std::f64::consts::TAU;
use std::ffi::CStr;

use rai::{
    RAI_MONITOR_WORDS, RAI_REASON_NONE, RAI_RECEIVER_WORDS, RAI_STATE_ALERT, RAI_STATE_PROTECTED,
    RAI_STATE_UNAVAILABLE, RAI_STATUS_OK, rai_monitor_t, rai_range_t, rai_receiver_t, rai_settings_t,
    rai_text_t, rai_verdict_t,
};

use super::tape::Tape;

/// What memory is filled with before anybody writes to it.
const BLANK: u8 = 0x5A;
/// Bytes behind what is handed in, which must stay as they are.
const GUARD: usize = 64;

/// Reads calls until the bytes end.
pub fn run(input: &[u8]) {
    let mut tape = Tape::new(input);
    let mut objects = Objects::new();
    while !tape.is_over() {
        let status = objects.call(&mut tape);
        // SAFETY: a string that lives as long as the program.
        let words = unsafe { CStr::from_ptr(rai::rai_status_text(status)) };
        assert_ne!(words, c"unknown status", "status {status}");
    }
}

/// A monitor's and a receiver's memory, in words, so that they are aligned.
struct Objects {
    monitor: Vec<u64>,
    receiver: Vec<u64>,
    now_ms: u64,
}

/// What became of a pointer on its way.
#[derive(Clone, Copy)]
enum Pointer {
    Sound,
    Null,
    Misaligned,
}

impl Pointer {
    /// Mostly sound.
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
        // Without a mark: as memory of a program that has just started.
        Self { monitor: vec![0; RAI_MONITOR_WORDS], receiver: vec![0; RAI_RECEIVER_WORDS], now_ms: 0 }
    }

    /// One call; what is refused leaves both objects as they were.
    fn call(&mut self, tape: &mut Tape<'_>) -> u8 {
        let before = (tape.byte() < 32).then(|| (self.monitor.clone(), self.receiver.clone()));
        let status = match tape.byte() % 11 {
            0 => self.make_monitor(tape),
            1 => self.configure(tape),
            2..5 => self.judge(tape),
            5 => self.forget(tape),
            6 => self.make_receiver(tape),
            7 | 8 => self.hear(tape),
            9 => self.obey_or_wait(tape),
            _ => self.ask(tape),
        };
        if let (Some((monitor, receiver)), true) = (before, status != RAI_STATUS_OK) {
            assert!(self.monitor == monitor && self.receiver == receiver, "refused by {status}, and changed");
        }
        status
    }

    /// A monitor's handle: its own memory, or the receiver's, where none of its kind is.
    fn monitor(&mut self, tape: &mut Tape<'_>) -> *mut rai_monitor_t {
        let memory = if tape.byte() < 4 { self.receiver.as_mut_ptr() } else { self.monitor.as_mut_ptr() };
        Pointer::read(tape).of(memory.cast())
    }

    fn receiver(&mut self, tape: &mut Tape<'_>) -> *mut rai_receiver_t {
        // The monitor's memory is shorter, and refused by its mark before anything of it is looked at.
        let memory = if tape.byte() < 4 { self.monitor.as_mut_ptr() } else { self.receiver.as_mut_ptr() };
        Pointer::read(tape).of(memory.cast())
    }

    fn make_monitor(&mut self, tape: &mut Tape<'_>) -> u8 {
        let mut settings = settings(tape);
        let length = if tape.byte() < 16 { usize::from(tape.byte()) * 64 } else { self.monitor.len() * 8 };
        let (memory, settings) =
            (Pointer::read(tape).of(self.monitor.as_mut_ptr()), Pointer::read(tape).of(&raw mut settings));
        // SAFETY: memory as long as said at least, settings no longer than they are.
        unsafe { rai::rai_monitor_init(memory.cast(), length.min(self.monitor.len() * 8), settings) }
    }

    fn configure(&mut self, tape: &mut Tape<'_>) -> u8 {
        let mut settings = settings(tape);
        let (monitor, settings) = (self.monitor(tape), Pointer::read(tape).of(&raw mut settings));
        // SAFETY: an object or memory without one; settings no longer than they are.
        unsafe { rai::rai_monitor_configure(monitor, settings) }
    }

    fn forget(&mut self, tape: &mut Tape<'_>) -> u8 {
        let monitor = self.monitor(tape);
        // SAFETY: an object or memory without one.
        unsafe { rai::rai_monitor_forget(monitor) }
    }

    fn judge(&mut self, tape: &mut Tape<'_>) -> u8 {
        let time_s = tape.number(0.0, 1e5);
        let ranges = ranges(tape);
        let pointer = Pointer::read(tape);
        // Nobody has as many as the second says: they are refused before they are looked at.
        let count = match pointer {
            Pointer::Sound => ranges.len(),
            Pointer::Null | Pointer::Misaligned => tape.one_of(&[ranges.len(), usize::MAX]),
        };
        let mut given = Given::new(tape);
        let (monitor, verdict) = (self.monitor(tape), Pointer::read(tape).of(given.place()));
        let ranges = pointer.of(ranges.as_ptr().cast_mut());
        // SAFETY: as many ranges as said where they are looked at; a verdict with room for what it says.
        let status = unsafe { rai::rai_monitor_judge(monitor, time_s, ranges, count, verdict) };
        given.check(status);
        status
    }

    fn make_receiver(&mut self, tape: &mut Tape<'_>) -> u8 {
        let length = if tape.byte() < 16 { usize::from(tape.byte()) * 128 } else { self.receiver.len() * 8 };
        let memory = Pointer::read(tape).of(self.receiver.as_mut_ptr());
        let most = self.receiver.len() * 8;
        Said::during(tape, |text| {
            // SAFETY: memory as long as said at least, and a text as long as it says.
            unsafe { rai::rai_receiver_init(memory.cast(), length.min(most), text) }
        })
    }

    fn hear(&mut self, tape: &mut Tape<'_>) -> u8 {
        let count = usize::from(tape.word() as u16 % 1500);
        let bytes: Vec<u8> = (0..count.min(tape.left())).map(|_| tape.byte()).collect();
        // Time passes; for who cannot be trusted it goes back, or ends.
        self.now_ms = match tape.byte() {
            0..3 => u64::from(tape.word()) << 32,
            3 => u64::MAX,
            _ => self.now_ms.saturating_add(tape.byte().into()),
        };
        let (receiver, pointer, mut judged) = (self.receiver(tape), Pointer::read(tape), 7_u8);
        let judged_at = if tape.byte() < 32 { std::ptr::null_mut() } else { &raw mut judged };
        let bytes_at = if matches!(pointer, Pointer::Null) { std::ptr::null() } else { bytes.as_ptr() };
        let now_ms = self.now_ms;
        Said::during(tape, |text| {
            // SAFETY: as many bytes as said, or null; a text as long as it says.
            unsafe { rai::rai_receiver_gnss(receiver, bytes_at, bytes.len(), now_ms, text, judged_at) }
        })
    }

    fn obey_or_wait(&mut self, tape: &mut Tape<'_>) -> u8 {
        let receiver = self.receiver(tape);
        if tape.byte() < 128 {
            let count = usize::from(tape.byte()).min(tape.left());
            let bytes: Vec<u8> = (0..count).map(|_| tape.byte()).collect();
            return Said::during(tape, |text| {
                // SAFETY: as many bytes as said; a text as long as it says.
                unsafe { rai::rai_receiver_command(receiver, bytes.as_ptr(), bytes.len(), text) }
            });
        }
        self.now_ms = self.now_ms.saturating_add(u64::from(tape.word() as u16));
        let now_ms = self.now_ms;
        // SAFETY: an object or memory without one; a text as long as it says.
        Said::during(tape, |text| unsafe { rai::rai_receiver_tick(receiver, now_ms, text) })
    }

    /// All that can be asked of a receiver agrees with each other.
    fn ask(&mut self, tape: &mut Tape<'_>) -> u8 {
        let receiver = self.receiver(tape);
        let mut given = Given::new(tape);
        let mut reason = 0;
        // SAFETY: an object or memory without one; a verdict with room for what it says.
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
        }
        given.check(status);
        status
    }
}

/// Settings of a phase, with anything in them.
fn settings(tape: &mut Tape<'_>) -> rai_settings_t {
    // SAFETY: integers and doubles, of which zeros are values.
    let mut settings: rai_settings_t = unsafe { std::mem::zeroed() };
    settings.size = size_of::<rai_settings_t>() as u32;
    // SAFETY: a struct as long as it says.
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
        // Never more than there is: that is the caller's to promise.
        settings.size = tape.one_of(&[0, 4, 79, 81, u32::MAX]);
    }
    settings
}

/// Ranges of satellites about a point, with anything in them.
fn ranges(tape: &mut Tape<'_>) -> Vec<rai_range_t> {
    const RADIUS_M: f64 = 2.6e7;
    let clock_m = tape.number(-3e5, 3e5);
    let range = |tape: &mut Tape<'_>| {
        let (azimuth, sine) = (tape.within(0.0, TAU), tape.within(0.0, 1.0));
        let flat = RADIUS_M * (1.0 - sine * sine).sqrt();
        let [x_m, y_m, z_m] = [RADIUS_M * sine, flat * azimuth.cos(), flat * azimuth.sin()];
        // From a point on the equator.
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

/// A verdict's memory with a guard behind it, and what it says of its size.
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
        // SAFETY: aligned, longer, initialised, and every pattern of bits is a verdict.
        unsafe { self.words.as_ptr().cast::<rai_verdict_t>().read() }
    }

    /// Nothing beyond it was written, nothing at all where it was refused; and what it says makes sense.
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
        // SAFETY: a string that lives as long as the program.
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

/// Memory for sentences with a guard behind it.
struct Said;

impl Said {
    /// Makes a call that may say something, and looks at what it has written.
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
        let said = length.min(capacity)..end.min(capacity).max(length.min(capacity));
        let untouched = bytes.iter().enumerate().filter(|(index, _)| !said.contains(index));
        assert!(untouched.clone().all(|(_, &byte)| byte == BLANK), "written beyond what was handed in");
        let words = bytes.get(said).unwrap_or_default();
        assert!(words.is_empty() || words.ends_with(b"\n") || !words.is_ascii(), "a sentence is whole");
        status
    }
}
