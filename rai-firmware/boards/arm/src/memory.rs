//! Copies, fills and comparisons of memory, which the compiler calls to move values.
//!
//! The compiler's functions are unrolled for processors of any kind, once for each alignment, and
//! take 3 KiB. A Cortex-M from M3 on loads words from any address, and several aligned words at
//! once. These functions therefore take 0.2 KiB and fewer instructions.
//!
//! | register | at entry of a copy | of a fill | of a comparison |
//! |---|---|---|---|
//! | `r0` | to | to | one |
//! | `r1` | from | bytes | other |
//! | `r2` | bytes | value | bytes |
//!
//! A copy goes forwards, four words at a time while both ends are aligned, and reads each piece
//! before it writes it. If it moves towards lower addresses, it is therefore correct for
//! overlapping blocks too. References: [AAPCS-RT] §5.3.4.
//!
//! [AAPCS-RT]: https://github.com/ARM-software/abi-aa/blob/main/rtabi32/rtabi32.rst

// SAFETY: each function writes only the memory that its caller names, and keeps the registers that
// a function must keep.
#![allow(unsafe_code)]

// These symbols replace the compiler's own, which are weak.
core::arch::global_asm!(
    ".pushsection .text.memory, \"ax\", %progbits",
    ".macro entry name:vararg",
    ".irp each, \\name",
    ".global \\each",
    ".type \\each, %function",
    ".thumb_func",
    "\\each:",
    ".endr",
    ".endm",
    ".balign 4",
    // Towards higher addresses only blocks that do not overlap may go forwards.
    "entry memmove, __aeabi_memmove, __aeabi_memmove4, __aeabi_memmove8",
    "subs r3, r0, r1",
    "cmp r3, r2",
    "bhs 0f",
    "adds r1, r1, r2",
    "add r12, r0, r2",
    "1: subs r2, r2, #4",
    "blo 2f",
    "ldr r3, [r1, #-4]!",
    "str r3, [r12, #-4]!",
    "b 1b",
    "2: adds r2, r2, #4",
    "3: subs r2, r2, #1",
    "it lo",
    "bxlo lr",
    "ldrb r3, [r1, #-1]!",
    "strb r3, [r12, #-1]!",
    "b 3b",
    "entry memcpy, __aeabi_memcpy, __aeabi_memcpy4, __aeabi_memcpy8",
    "0: orr r3, r0, r1",
    "mov r12, r0",
    "lsls r3, r3, #30",
    "bne 5f",
    "subs r2, r2, #16",
    "blo 4f",
    "push {{r4, r5, r6, lr}}",
    "1: ldmia r1!, {{r3, r4, r5, r6}}",
    "subs r2, r2, #16",
    "stmia r12!, {{r3, r4, r5, r6}}",
    "bhs 1b",
    "pop {{r4, r5, r6, lr}}",
    "4: adds r2, r2, #16",
    "5: subs r2, r2, #4",
    "blo 3f",
    "2: ldr r3, [r1], #4",
    "subs r2, r2, #4",
    "str r3, [r12], #4",
    "bhs 2b",
    "3: adds r2, r2, #4",
    "it eq",
    "bxeq lr",
    "4: ldrb r3, [r1], #1",
    "subs r2, r2, #1",
    "strb r3, [r12], #1",
    "bne 4b",
    "bx lr",
    "entry __aeabi_memclr, __aeabi_memclr4, __aeabi_memclr8",
    "movs r2, #0",
    "entry __aeabi_memset, __aeabi_memset4, __aeabi_memset8",
    "uxtb r2, r2",
    "orr r2, r2, r2, lsl #8",
    "orr r2, r2, r2, lsl #16",
    "lsls r3, r0, #30",
    "bne 5f",
    "mov r3, r2",
    "subs r1, r1, #16",
    "blo 4f",
    "1: stmia r0!, {{r2, r3}}",
    "subs r1, r1, #16",
    "stmia r0!, {{r2, r3}}",
    "bhs 1b",
    "4: adds r1, r1, #16",
    "5: subs r1, r1, #4",
    "blo 3f",
    "2: subs r1, r1, #4",
    "str r2, [r0], #4",
    "bhs 2b",
    "3: adds r1, r1, #4",
    "it eq",
    "bxeq lr",
    "4: subs r1, r1, #1",
    "strb r2, [r0], #1",
    "bne 4b",
    "bx lr",
    "entry memcmp",
    "mov r3, r0",
    "1: subs r2, r2, #1",
    "itt lo",
    "movlo r0, #0",
    "bxlo lr",
    "ldrb r0, [r3], #1",
    "ldrb r12, [r1], #1",
    "subs r0, r0, r12",
    "beq 1b",
    "bx lr",
    ".purgem entry",
    ".popsection",
);
