//! The log: defmt frames to the log port and, for a debug probe, to RTT.
//!
//! A frame is first collected and then offered to both; without room it is dropped. Logging
//! therefore never waits, with or without a cable or a probe. The host decodes the frames with the
//! table in the image.

use core::cell::UnsafeCell;

use critical_section::RestoreState;
use rtt_target::{ChannelMode, UpChannel};

use raim_firmware::board::Note;

use crate::{Chip, HAS_LOG, log, rings, stack};

/// Largest number of bytes in a frame; a longer one is dropped.
const FRAME_BYTES: usize = 256;

struct State {
    restore: RestoreState,
    encoder: defmt::Encoder,
    frame: heapless::Vec<u8, FRAME_BYTES>,
    whole: bool,
    probe: Option<UpChannel>,
}

struct Shared(UnsafeCell<State>);

// SAFETY: only code between `acquire` and `release` touches the state, with interrupts held back on
// the one core, and `start`, which runs before the first log.
#[allow(unsafe_code)]
unsafe impl Sync for Shared {}

static SHARED: Shared = Shared(UnsafeCell::new(State {
    restore: RestoreState::invalid(),
    encoder: defmt::Encoder::new(),
    frame: heapless::Vec::new(),
    whole: true,
    probe: None,
}));

/// Opens the channel for a debug probe. Call it once, before the first log.
#[allow(unsafe_code)]
pub fn start() {
    if !HAS_LOG {
        return;
    }
    let channels = rtt_target::rtt_init! {
        up: {
            0: {
                size: 512,
                mode: ChannelMode::NoBlockSkip,
                name: "defmt"
            }
        }
    };
    critical_section::with(|_| {
        // SAFETY: no log is under way inside a critical section that did not come from one.
        unsafe { (*SHARED.0.get()).probe = Some(channels.up.0) };
    });
}

/// Logs an event of the epoch loop.
pub fn note(note: Note) {
    match note {
        Note::Judged(verdict, ticks) => {
            log!(info, "judged {}: pin {=u64} ticks after the last byte", verdict, ticks);
        }
        Note::Stale(verdict) => log!(info, "judged {}: no byte came", verdict),
        Note::Epoch(number, ticks) => log!(info, "epoch {=u32} took {=u64} ticks", number, ticks),
        Note::HighWater => {
            log!(info, "stack high water {=u32} bytes", stack::high_water_bytes());
            log!(info, "rings high water {}", rings::high_water());
        }
        Note::GnssRate(baud) => log!(info, "GNSS port at {=u32} baud", baud),
        Note::Lost(losses) => log!(warn, "bytes lost since start: {}", losses),
        _ => {}
    }
}

impl State {
    fn gather(frame: &mut heapless::Vec<u8, FRAME_BYTES>, whole: &mut bool, bytes: &[u8]) {
        *whole &= frame.extend_from_slice(bytes).is_ok();
    }

    fn begin(&mut self) {
        self.frame.clear();
        self.whole = true;
        self.encoder.start_frame(|bytes| Self::gather(&mut self.frame, &mut self.whole, bytes));
    }

    fn append(&mut self, bytes: &[u8]) {
        self.encoder.write(bytes, |bytes| Self::gather(&mut self.frame, &mut self.whole, bytes));
    }

    fn finish<C: Chip>(&mut self) {
        self.encoder.end_frame(|bytes| Self::gather(&mut self.frame, &mut self.whole, bytes));
        if !self.whole {
            return;
        }
        C::send_log(&self.frame);
        if let Some(probe) = &mut self.probe {
            // A probe may have asked for blocking and then left, which must not stop the epoch
            // loop.
            probe.set_mode(ChannelMode::NoBlockSkip);
            probe.write(&self.frame);
        }
    }
}

/// Holds interrupts back and begins a frame.
#[allow(unsafe_code)]
pub fn acquire() {
    if !HAS_LOG {
        return;
    }
    // SAFETY: released in `release`, which defmt calls exactly once for each `acquire`.
    let restore = unsafe { critical_section::acquire() };
    // SAFETY: interrupts are held back.
    let state = unsafe { &mut *SHARED.0.get() };
    state.restore = restore;
    state.begin();
}

/// Adds bytes to the frame.
///
/// # Safety
/// Call it between [`acquire`] and [`release`].
#[allow(unsafe_code)]
pub unsafe fn write(bytes: &[u8]) {
    if !HAS_LOG {
        return;
    }
    // SAFETY: between `acquire` and `release`.
    unsafe { (*SHARED.0.get()).append(bytes) };
}

/// Sends the frame and lets interrupts pass.
///
/// # Safety
/// Call it once for each [`acquire`].
#[allow(unsafe_code)]
pub unsafe fn release<C: Chip>() {
    if !HAS_LOG {
        return;
    }
    // SAFETY: between `acquire` and `release`.
    let state = unsafe { &mut *SHARED.0.get() };
    state.finish::<C>();
    // SAFETY: paired with the `acquire` of the same name above.
    unsafe { critical_section::release(state.restore) };
}
