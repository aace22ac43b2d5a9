//! What the module costs on the chip.

pub mod workload;
