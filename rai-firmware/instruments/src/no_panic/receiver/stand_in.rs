//! Surroundings of the receiver: a host, a pin and a board with any results.

use embedded_hal::digital::{self, OutputPin};
use embedded_io::Write;
use raim_firmware::board::reset::ResetCause;
use raim_firmware::board::{Board, Note, PortLosses, SEALED_BYTES};
use raim_firmware::input::Event;
use raim_firmware::timed_ring::Taken;

/// Type of an event handler.
pub(super) type Tell = fn(Event<'_>);

/// Type of the function that an outlet calls when bytes are ready to send.
pub(super) type Wake = fn();

/// A host port with any result of a writer, valid or not.
pub(super) struct Host(Result<usize, embedded_io::ErrorKind>);

impl embedded_io::ErrorType for Host {
    type Error = embedded_io::ErrorKind;
}

impl Write for Host {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Self::Error> {
        ::core::hint::black_box(bytes);
        ::core::hint::black_box(self.0)
    }

    fn flush(&mut self) -> Result<(), Self::Error> {
        ::core::hint::black_box(self.0).map(drop)
    }
}

/// A pin that may refuse.
pub(super) struct Pin(Result<(), digital::ErrorKind>);

impl digital::ErrorType for Pin {
    type Error = digital::ErrorKind;
}

impl OutputPin for Pin {
    fn set_low(&mut self) -> Result<(), Self::Error> {
        ::core::hint::black_box(self.0)
    }

    fn set_high(&mut self) -> Result<(), Self::Error> {
        ::core::hint::black_box(self.0)
    }
}

/// A board with arbitrary results.
pub(super) struct AnyBoard {
    taken: Taken,
    host: Host,
    number: u64,
    losses: PortLosses,
    cause: ResetCause,
    sealed: [u8; SEALED_BYTES],
}

impl Board for AnyBoard {
    type Pin = Pin;
    type Host = Host;

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

    fn host(&mut self) -> &mut Host {
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

    fn driven_ticks(&self, _: &Pin) -> u64 {
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
