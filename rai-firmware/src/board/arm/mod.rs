//! Parts that all Cortex-M boards share: time, guarded stack, faults, log, rings of the ports,
//! memory over a restart, and memory functions.

pub mod fault;
pub mod log;
mod memory;
pub mod rings;
pub mod sealed;
pub mod stack;
pub mod start;
pub mod time;
