//! What stands for a type parameter: for each trait that bounds one, a type of the trait's name, with
//! any results. Behind the name of a function's trait stands the number of its arguments.

use core::iter::Copied;
use core::slice::Iter;

use embedded_hal::digital;
use raim_firmware::board::reset::ResetCause;
use raim_firmware::board::{self, Note, PortLosses, SEALED_BYTES};
use raim_firmware::input::Event;
use raim_firmware::timed_ring::Taken;

/// Handler of events.
pub type FnMut1 = fn(Event<'_>);

/// What an outlet calls when bytes are ready to send.
pub type FnMut0 = fn();

/// Values of a command.
pub type Iterator = Copied<Iter<'static, &'static str>>;

/// The observer of an image.
pub type Observer = ();

/// A host port with any result of a writer, valid or not.
pub struct Write(Result<usize, embedded_io::ErrorKind>);

impl embedded_io::ErrorType for Write {
    type Error = embedded_io::ErrorKind;
}

impl embedded_io::Write for Write {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Self::Error> {
        ::core::hint::black_box(bytes);
        ::core::hint::black_box(self.0)
    }

    fn flush(&mut self) -> Result<(), Self::Error> {
        ::core::hint::black_box(self.0).map(drop)
    }
}

/// A pin that may refuse.
pub struct OutputPin(Result<(), digital::ErrorKind>);

impl digital::ErrorType for OutputPin {
    type Error = digital::ErrorKind;
}

impl digital::OutputPin for OutputPin {
    fn set_low(&mut self) -> Result<(), Self::Error> {
        ::core::hint::black_box(self.0)
    }

    fn set_high(&mut self) -> Result<(), Self::Error> {
        ::core::hint::black_box(self.0)
    }
}

/// A board with arbitrary results.
pub struct Board {
    taken: Taken,
    host: Write,
    number: u64,
    losses: PortLosses,
    cause: ResetCause,
    sealed: [u8; SEALED_BYTES],
}

impl board::Board for Board {
    type Pin = OutputPin;
    type Host = Write;

    fn clock_error_ppm(&self) -> u32 {
        ::core::hint::black_box(self.number as u32)
    }

    fn gnss(&mut self, chunk: &mut [u8]) -> Taken {
        ::core::hint::black_box(chunk);
        ::core::hint::black_box(self.taken)
    }

    fn command(&mut self) -> Option<u8> {
        ::core::hint::black_box(None)
    }

    fn host(&mut self) -> &mut Write {
        &mut self.host
    }

    fn host_room(&self) -> usize {
        ::core::hint::black_box(self.number) as usize
    }

    fn now_ms(&self) -> u64 {
        ::core::hint::black_box(self.number)
    }

    fn now_ticks(&self) -> u64 {
        ::core::hint::black_box(self.number)
    }

    fn driven_ticks(&self, _: &OutputPin) -> u64 {
        ::core::hint::black_box(self.number)
    }

    fn losses(&self) -> PortLosses {
        ::core::hint::black_box(self.losses)
    }

    fn feed_watchdog(&mut self) {}

    fn sleep(&mut self) -> Option<u64> {
        ::core::hint::black_box(None)
    }

    fn reset_cause(&self) -> ResetCause {
        ::core::hint::black_box(self.cause)
    }

    fn sealed(&mut self) -> &mut [u8; SEALED_BYTES] {
        ::core::hint::black_box(&mut self.sealed)
    }

    fn set_gnss_rate(&mut self, baud: u32) {
        ::core::hint::black_box(baud);
    }

    fn note(&mut self, note: Note) {
        ::core::hint::black_box(note);
    }
}
