//! The attacks on the module, on the emulated board and on the service, and what their records say.
//!
//! `cargo xtask check` runs them; `cargo xtask test` does not compile this package.

mod attack_small;
#[cfg(target_os = "linux")]
mod endurance;
mod full_sky;
mod fuzz_corpus;
mod merged_stream;
mod own_evidence;
mod sky;
mod soak;
mod steered_clock;
