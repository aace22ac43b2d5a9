//! Reaction to a failed program: pin low, a record, a reset; the next start reads the record.
//!
//! The handlers use only registers: no log, no lock, and no stack frame that was not checked to lie
//! in RAM.

use core::mem::MaybeUninit;
use core::panic::PanicInfo;
use core::ptr;

use cortex_m::peripheral::SCB;
use cortex_m_rt::ExceptionFrame;
use raim_firmware::board::reset::{Fault, Record, hash};

use crate::Chip;

/// Record that survives a reset, because start-up neither clears nor fills this section.
#[allow(unsafe_code)]
#[unsafe(link_section = ".uninit.FAULT_RECORD")]
static mut RECORD: MaybeUninit<Record> = MaybeUninit::uninit();

/// Reads and clears the record of a fault, if there is one.
pub fn take_record() -> Option<Fault> {
    let fault = read().fault();
    write(Record::EMPTY);
    fault
}

/// Resets the module at the host's request.
pub fn reset_on_request<C: Chip>() -> ! {
    C::drop_integrity_pin();
    SCB::sys_reset()
}

/// Drives the pin low, writes a record and resets.
pub fn give_up<C: Chip>(fault: Fault) -> ! {
    C::drop_integrity_pin();
    write(Record::of(fault));
    cortex_m::asm::dsb();
    SCB::sys_reset()
}

#[allow(unsafe_code)]
fn read() -> Record {
    // SAFETY: a record is four integers, for which any bits are a value; at start-up no other code
    // runs.
    unsafe { ptr::read_volatile(&raw const RECORD).assume_init() }
}

#[allow(unsafe_code)]
fn write(record: Record) {
    // SAFETY: written at start-up, before interrupts, or by a handler after which nothing runs.
    unsafe { ptr::write_volatile(&raw mut RECORD, MaybeUninit::new(record)) }
}

/// Gives up because of a panic.
pub fn panicked<C: Chip>(info: &PanicInfo<'_>) -> ! {
    cortex_m::interrupt::disable();
    let (file, line) = info.location().map_or((0, 0), |place| (hash(place.file()), place.line()));
    give_up::<C>(Fault::Panic { file, line })
}

/// Gives up because of a hard fault.
pub fn hard<C: Chip>(frame: &ExceptionFrame) -> ! {
    let last = C::RAM.end - size_of::<ExceptionFrame>();
    let trusted = (C::RAM.start..=last).contains(&(ptr::from_ref(frame) as usize));
    give_up::<C>(Fault::Hard { address: if trusted { frame.pc() } else { 0 } })
}
