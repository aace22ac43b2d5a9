//! What all boards with a Cortex-M share: time, the guarded stack, faults, the log, the rings of the ports, memory over a
//! restart, and how it is copied.

pub mod fault;
pub mod log;
mod memory;
pub mod rings;
pub mod sealed;
pub mod stack;
pub mod start;
pub mod time;
