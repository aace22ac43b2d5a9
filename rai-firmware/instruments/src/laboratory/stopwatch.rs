//! Ticks of the core clock, from the system timer, which counts down from its largest value.

use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;

/// Reload value of the timer, 24 bits: a stage may take 16.7 million ticks, 99 million instructions
/// in the emulator.
const RELOAD: u32 = 0x00FF_FFFF;

/// A running timer.
pub struct Stopwatch {
    timer: SYST,
    overhead_ticks: u32,
}

impl Stopwatch {
    /// Starts the timer and measures the cost of a reading.
    pub fn start(mut timer: SYST) -> Self {
        timer.set_clock_source(SystClkSource::Core);
        timer.set_reload(RELOAD);
        timer.clear_current();
        timer.enable_counter();
        let mut stopwatch = Self { timer, overhead_ticks: 0 };
        stopwatch.overhead_ticks = stopwatch.time(|| ()).1;
        stopwatch
    }

    /// Runs a stage once; returns its result and its ticks.
    #[inline(never)]
    pub fn time<R>(&mut self, stage: impl FnOnce() -> R) -> (R, u32) {
        let before = self.timer.cvr.read();
        let result = core::hint::black_box(stage());
        let after = self.timer.cvr.read();
        (result, (before.wrapping_sub(after) & RELOAD).saturating_sub(self.overhead_ticks))
    }
}
