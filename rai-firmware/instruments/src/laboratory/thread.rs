//! A thread with a small stack of its own, and the depth that it used.
//!
//! The stack is painted before a function runs on it, and the lowest word that lost its paint is
//! the depth. Below the stack is more paint, so that a function that needs more is found. No
//! interrupt runs, so that the function is alone on its stack, as a task of an RTOS is on its own.

use core::arch::asm;
use core::ptr;

/// Words of the stack: 4 KiB.
const STACK_WORDS: usize = 4096 / size_of::<u32>();

/// Words below the stack that show by how much a function exceeds it.
const BELOW_WORDS: usize = 8192 / size_of::<u32>();

const PAINT: u32 = 0xACCE_55ED;

const WORDS: usize = BELOW_WORDS + STACK_WORDS;

// Of 64 bits, to which a stack is aligned.
static mut STACK: [u64; WORDS / 2] = [0; WORDS / 2];

/// Runs a function on the thread's stack; returns the number of bytes that it used.
#[allow(unsafe_code)]
pub fn depth_of(mut work: impl FnMut()) -> usize {
    extern "C" fn call(work: *mut &mut dyn FnMut()) {
        // SAFETY: the pointer is that of `reference` below, which outlives the call.
        unsafe { (*work)() }
    }
    let mut reference: &mut dyn FnMut() = &mut work;
    let words = (&raw mut STACK).cast::<u32>();
    // SAFETY: the words are those of the static, which only this function uses, and it is not called
    // from within `work`. The new stack is aligned to 8 bytes; the old one is restored.
    unsafe {
        (0..WORDS).for_each(|index| ptr::write_volatile(words.add(index), PAINT));
        asm!(
            "mov r4, sp",
            "mov sp, {top}",
            "blx {call}",
            "mov sp, r4",
            top = in(reg) words.add(WORDS),
            call = in(reg) call as extern "C" fn(*mut &mut dyn FnMut()),
            inout("r0") &raw mut reference => _,
            out("r1") _, out("r2") _, out("r3") _, out("r4") _, out("r12") _, out("lr") _,
            out("s0") _, out("s1") _, out("s2") _, out("s3") _, out("s4") _, out("s5") _, out("s6") _, out("s7") _,
            out("s8") _, out("s9") _, out("s10") _, out("s11") _, out("s12") _, out("s13") _, out("s14") _, out("s15") _,
        );
        let kept = (0..WORDS).take_while(|&index| ptr::read_volatile(words.add(index)) == PAINT).count();
        (WORDS - kept) * size_of::<u32>()
    }
}
