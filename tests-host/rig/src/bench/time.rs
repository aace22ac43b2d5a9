//! Times of an epoch on the chip, from both bounds of its cycles.
//!
//! ```text
//! t = cycles / f
//! ```
//!
//! | symbol | constant | unit |
//! |---|---|---|
//! | f with five wait states | [`FULL_HZ`] | Hz |
//! | f without wait states | [`INTERNAL_HZ`] | Hz |

use super::figure::Figure;
use crate::laboratory::cycles::{Bounds, Cycles};

/// Frequency of the core with a crystal, Hz.
pub const FULL_HZ: u64 = 168_000_000;
/// Frequency of the core without a crystal, Hz.
pub const INTERNAL_HZ: u64 = 16_000_000;

/// Returns the name of an upper bound.
pub fn at_most(name: &str, core_hz: u64) -> String {
    bound(name, core_hz, "at most")
}

fn bound(name: &str, core_hz: u64, words: &str) -> String {
    format!("{name}, cycles at {} MHz, {words}", core_hz / 1_000_000)
}

fn each(cycles: &Cycles) -> [(u64, Bounds); 2] {
    [(FULL_HZ, cycles.with_wait_states), (INTERNAL_HZ, cycles.without_wait_states)]
}

/// Returns both bounds at both frequencies.
pub(super) fn figures(name: &str, cycles: &Cycles) -> Vec<Figure> {
    let figure = |name, value| Figure { name, value, target: None };
    let both = |(core_hz, Bounds { least, most })| {
        [figure(bound(name, core_hz, "at least"), least), figure(at_most(name, core_hz), most)]
    };
    each(cycles).into_iter().flat_map(both).collect()
}

/// Returns the times and the cycles per instruction as text.
pub(super) fn text(name: &str, cycles: &Cycles) -> String {
    let at = |(core_hz, Bounds { least, most }): (u64, Bounds)| {
        let ms = |count: u64| 1e3 * count as f64 / core_hz as f64;
        let ratio = |count: u64| count as f64 / cycles.instructions as f64;
        format!(
            "{:.1} to {:.1} ms at {} MHz ({:.2} to {:.2} cycles per instruction)",
            ms(least),
            ms(most),
            core_hz / 1_000_000,
            ratio(least),
            ratio(most)
        )
    };
    format!("{name}, {} instructions: {}", cycles.instructions, each(cycles).map(at).join(", "))
}
