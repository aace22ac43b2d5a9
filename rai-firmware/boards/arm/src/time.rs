//! Time since start: milliseconds for the receiver, ticks of the core clock for the log.
//!
//! `SysTick` counts the core clock down from `f_core / 1000 − 1` and interrupts once per
//! millisecond. The counter's position inside the millisecond refines it to one tick. The chip's
//! cycle counter is not used, because some cores claim one that does not count.

use core::sync::atomic::{AtomicU32, Ordering};

use cortex_m::peripheral::{SCB, SYST, syst::SystClkSource};
use cortex_m_rt::exception;
use raim_firmware::division::divided;

static MS_LOW: AtomicU32 = AtomicU32::new(0);
static MS_HIGH: AtomicU32 = AtomicU32::new(0);
static TICKS_PER_MS: AtomicU32 = AtomicU32::new(1);

/// Starts the time base.
pub fn start(mut syst: SYST, core_hz: u32) {
    let ticks_per_ms = core_hz / 1000;
    TICKS_PER_MS.store(ticks_per_ms, Ordering::Relaxed);
    syst.set_clock_source(SystClkSource::Core);
    syst.set_reload(ticks_per_ms - 1);
    syst.clear_current();
    syst.enable_interrupt();
    syst.enable_counter();
}

/// Returns the low word of the milliseconds since start, for interrupts, which must be short.
pub fn now_ms_low() -> u32 {
    MS_LOW.load(Ordering::Relaxed)
}

/// Returns the milliseconds since start.
pub fn now_ms() -> u64 {
    cortex_m::interrupt::free(|_| milliseconds())
}

/// Returns the ticks of the core clock since start.
pub fn now_ticks() -> u64 {
    cortex_m::interrupt::free(|_| {
        let per_ms = TICKS_PER_MS.load(Ordering::Relaxed);
        let (mut ms, mut count) = (milliseconds(), SYST::get_current());
        // The counter may have passed zero while its interrupt was held back. The count then
        // belongs to the next millisecond.
        if SCB::is_pendst_pending() {
            (ms, count) = (ms + 1, SYST::get_current());
        }
        let inside = if count == 0 { 0 } else { per_ms.saturating_sub(count) };
        ms * u64::from(per_ms) + u64::from(inside)
    })
}

/// Returns the microseconds since start.
pub fn now_us() -> u64 {
    divided(now_ticks() * 1000, TICKS_PER_MS.load(Ordering::Relaxed)).0
}

/// Sleeps until a millisecond begins or there is `work`; returns the tick at which an interrupt
/// first ended the sleep.
///
/// If an interrupt does not bring enough work, the sleep continues after it. A pass of the loop for
/// each byte would cost several times an epoch.
pub fn sleep_unless(work: impl Fn() -> bool) -> Option<u64> {
    let (slept_ms, mut woken_ticks) = (now_ms_low(), None);
    while now_ms_low() == slept_ms
        && let Some(ticks) = doze_unless(&work)
    {
        woken_ticks = woken_ticks.or(Some(ticks));
    }
    woken_ticks
}

/// Sleeps until the next interrupt, unless there is `work`; returns the tick at which it ended the
/// sleep.
///
/// Interrupts are held back while `work` is tested and during the sleep. An interrupt between the
/// two ends the sleep at once, and is served after it.
fn doze_unless(work: impl Fn() -> bool) -> Option<u64> {
    cortex_m::interrupt::free(|_| {
        if work() {
            return None;
        }
        cortex_m::asm::wfi();
        Some(now_ticks())
    })
}

fn milliseconds() -> u64 {
    u64::from(MS_HIGH.load(Ordering::Relaxed)) << 32 | u64::from(MS_LOW.load(Ordering::Relaxed))
}

#[exception]
fn SysTick() {
    let low = MS_LOW.load(Ordering::Relaxed).wrapping_add(1);
    MS_LOW.store(low, Ordering::Relaxed);
    if low == 0 {
        MS_HIGH.store(MS_HIGH.load(Ordering::Relaxed).wrapping_add(1), Ordering::Relaxed);
    }
}
