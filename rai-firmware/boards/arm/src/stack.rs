//! The stack: its high-water mark, and a guard below it.
//!
//! Start-up paints the memory between the statics and the top of RAM with one word. The lowest word
//! that lost its paint is the high-water mark. A region of the memory protection unit, just above
//! the statics, refuses every access. If the stack grows too deep, the program therefore faults,
//! instead of silently changing the statics.
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `_stack_end` | end of the statics, start of the guard | address |
//! | `_stack_start` | top of RAM | address |
//!
//! References: [ARMv7-M] §B3.5.
//!
//! [ARMv7-M]: raim_firmware#references

use core::ptr;

use cortex_m::peripheral::{MPU, SCB};

/// Bytes of the guard, a power of two. No frame of the epoch loop skips it in practice, because
/// frames are written from the top.
const GUARD_BYTES: usize = 256;

// SAFETY: both are labels of the linker script; only their addresses are taken.
#[allow(unsafe_code)]
unsafe extern "C" {
    static _stack_end: u32;
    static _stack_start: u32;
}

fn guard_start() -> usize {
    (&raw const _stack_end as usize).next_multiple_of(GUARD_BYTES)
}

/// Forbids access to the guard.
#[allow(unsafe_code)]
pub fn guard(mpu: &MPU, scb: &mut SCB) {
    const REGION_VALID: u32 = 1 << 4;
    const NO_ACCESS_NO_EXECUTE: u32 = 1 << 28;
    const SIZE_256: u32 = 7 << 1;
    const ENABLE: u32 = 1;
    const DEFAULT_MAP_ELSEWHERE: u32 = 1 << 2;
    const _: () = assert!(GUARD_BYTES == 1 << (7 + 1), "the region's size field holds log2 − 1");
    // SAFETY: the region covers memory between the statics and the stack that nothing uses;
    // everything else keeps the default map.
    unsafe {
        mpu.rbar.write(guard_start() as u32 | REGION_VALID);
        mpu.rasr.write(NO_ACCESS_NO_EXECUTE | SIZE_256 | ENABLE);
        mpu.ctrl.write(DEFAULT_MAP_ELSEWHERE | ENABLE);
    }
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
    // Its own exception would report no more than the hard fault to which it escalates while it is
    // disabled.
    scb.disable(cortex_m::peripheral::scb::Exception::MemoryManagement);
}

/// Returns the largest number of bytes of stack that have been in use.
#[allow(unsafe_code)]
pub fn high_water_bytes() -> u32 {
    let top = &raw const _stack_start as usize;
    let lowest = (guard_start() + GUARD_BYTES..top)
        .step_by(4)
        // SAFETY: the address lies between the guard and the top of RAM, aligned to a word; a stack
        // slot that changes during the read yields a value other than the paint, which is correct.
        .find(
            |&address| unsafe { ptr::read_volatile(address as *const u32) } != cortex_m_rt::STACK_PAINT_VALUE,
        );
    (top - lowest.unwrap_or(top)) as u32
}
