//! Files of the host and the end of the program.
//!
//! Reference: Arm, *Semihosting for `AArch32` and `AArch64`*, 2024, operations `SYS_OPEN`,
//! `SYS_READ`, `SYS_WRITE`.

use cortex_m_semihosting::debug::{self, EXIT_FAILURE, EXIT_SUCCESS};
use cortex_m_semihosting::syscall;

/// Mode of `SYS_OPEN` to read, as in `fopen`.
const READ_BINARY: usize = 1;
/// Mode of `SYS_OPEN` to write, as in `fopen`.
const WRITE_BINARY: usize = 5;

/// An open file of the host.
pub struct File(usize);

impl File {
    /// Opens a file to read; `name` ends with a NUL.
    pub fn to_read(name: &[u8]) -> Option<Self> {
        Self::open(name, READ_BINARY)
    }

    /// Opens a file to write; `name` ends with a NUL.
    pub fn to_write(name: &[u8]) -> Option<Self> {
        Self::open(name, WRITE_BINARY)
    }

    #[allow(unsafe_code)]
    fn open(name: &[u8], mode: usize) -> Option<Self> {
        let length = name.len().checked_sub(1)?;
        // SAFETY: the three words describe a string that outlives the call.
        let handle = unsafe { syscall!(OPEN, name.as_ptr(), mode, length) };
        (handle != usize::MAX).then_some(Self(handle))
    }

    /// Fills the buffer; returns false if the file ends before.
    #[allow(unsafe_code)]
    pub fn fill(&mut self, buffer: &mut [u8]) -> bool {
        // SAFETY: the host writes at most the buffer's length to its address.
        buffer.is_empty() || unsafe { syscall!(READ, self.0, buffer.as_mut_ptr(), buffer.len()) } == 0
    }

    /// Writes all bytes; returns false if the host does not take them.
    #[allow(unsafe_code)]
    pub fn write(&mut self, bytes: &[u8]) -> bool {
        // SAFETY: the host reads the slice's length from its address.
        bytes.is_empty() || unsafe { syscall!(WRITE, self.0, bytes.as_ptr(), bytes.len()) } == 0
    }
}

/// Ends the emulator.
pub fn exit(is_success: bool) -> ! {
    debug::exit(if is_success { EXIT_SUCCESS } else { EXIT_FAILURE });
    loop {
        cortex_m::asm::nop();
    }
}
