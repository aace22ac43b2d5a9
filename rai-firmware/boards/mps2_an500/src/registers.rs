//! The registers in use, by address.

use core::ptr;

/// A word of the address space.
#[derive(Clone, Copy)]
struct Word(usize);

impl Word {
    #[allow(unsafe_code)]
    fn read(self) -> u32 {
        // SAFETY: the constants below name device registers of this board, which are always there
        // and aligned.
        unsafe { ptr::read_volatile(self.0 as *const u32) }
    }

    #[allow(unsafe_code)]
    fn write(self, value: u32) {
        // SAFETY: as above; each register takes any value.
        unsafe { ptr::write_volatile(self.0 as *mut u32, value) }
    }
}

/// A serial port.
#[derive(Clone, Copy)]
pub struct Uart(usize);

/// Host port.
pub const HOST: Uart = Uart(0x4000_4000);
/// GNSS port.
pub const GNSS: Uart = Uart(0x4000_5000);
/// Log port.
pub const LOG: Uart = Uart(0x4000_6000);

impl Uart {
    /// Enables both directions with their interrupts.
    pub fn start(self, divider: u32) {
        const BOTH_WITH_INTERRUPTS: u32 = 0b1111;
        self.set_divider(divider);
        Word(self.0 + 8).write(BOTH_WITH_INTERRUPTS);
    }

    /// Sets the clock ticks per bit, 16 or more.
    pub fn set_divider(self, divider: u32) {
        Word(self.0 + 0x10).write(divider.max(16));
    }

    /// Takes a byte that has come.
    pub fn take(self) -> Option<u8> {
        const RECEIVED: u32 = 1 << 1;
        (self.state() & RECEIVED != 0).then(|| Word(self.0).read() as u8)
    }

    /// Returns true if a byte came before the last one was taken, and clears that flag.
    pub fn take_overrun(self) -> bool {
        const OVERRUN: u32 = 1 << 3;
        let is_overrun = self.state() & OVERRUN != 0;
        if is_overrun {
            Word(self.0 + 4).write(OVERRUN);
        }
        is_overrun
    }

    /// Returns true if a byte can be sent.
    pub fn is_ready(self) -> bool {
        self.state() & 1 == 0
    }

    /// Sends a byte.
    pub fn send(self, byte: u8) {
        Word(self.0).write(u32::from(byte));
    }

    /// Clears the requests for interrupts.
    pub fn clear_interrupts(self) {
        Word(self.0 + 0xC).write(0b1111);
    }

    fn state(self) -> u32 {
        Word(self.0 + 4).read()
    }
}

/// The board's LEDs.
pub struct Led(usize);

/// LEDs by their address.
pub const LED: Led = Led(0x4002_8000);

impl Led {
    /// Sets the LEDs.
    pub fn set(&self, value: u32) {
        Word(self.0).write(value);
    }
}

/// The watchdog.
pub struct Watchdog(usize);

/// Watchdog by its address.
pub const WATCHDOG: Watchdog = Watchdog(0x4000_8000);

impl Watchdog {
    /// Starts the watchdog: an interrupt after `ticks`, without a handler, and a reset after as
    /// many more.
    pub fn start(&self, ticks: u32) {
        const UNLOCK: u32 = 0x1ACC_E551;
        const INTERRUPT_AND_RESET: u32 = 0b11;
        Word(self.0 + 0xC00).write(UNLOCK);
        Word(self.0).write(ticks);
        Word(self.0 + 8).write(INTERRUPT_AND_RESET);
    }

    /// Feeds the watchdog.
    pub fn feed(&self, ticks: u32) {
        Word(self.0).write(ticks);
        Word(self.0 + 0xC).write(1);
    }
}
