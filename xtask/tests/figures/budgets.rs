//! Committed figures of the target, as the documents have them.

use std::collections::BTreeMap;

use rig::bench::budget;
use rig::bench::time::{FULL_HZ, INTERNAL_HZ};

/// Committed figures by name.
pub(crate) struct Budgets(BTreeMap<String, u64>);

impl Budgets {
    /// Reads the file.
    pub(crate) fn read() -> Self {
        Self(budget::committed().expect("the committed figures"))
    }

    /// Returns the number of committed figures.
    pub(crate) fn count(&self) -> usize {
        self.0.len()
    }

    /// Returns a figure.
    pub(crate) fn bytes(&self, name: &str) -> u64 {
        *self.0.get(name).unwrap_or_else(|| panic!("{name} is not committed"))
    }

    /// Returns a figure in KiB.
    pub(crate) fn kib(&self, name: &str) -> f64 {
        self.bytes(name) as f64 / 1024.0
    }

    /// Returns instructions in millions, with two decimals.
    pub(crate) fn millions(&self, name: &str) -> String {
        format!("{:.2}", self.bytes(name) as f64 / 1e6)
    }

    /// Returns instructions, rounded to hundreds, and from 100,000 on to thousands.
    pub(crate) fn rounded(&self, name: &str) -> String {
        let count = self.bytes(name);
        let step = if count < 100_000 { 100 } else { 1000 };
        let rounded = (count + step / 2) / step * step;
        format!("{},{:03}", rounded / 1000, rounded % 1000)
    }

    /// Returns instructions, rounded to thousands.
    pub(crate) fn thousands(&self, name: &str) -> String {
        format!("{},000", (self.bytes(name) + 500) / 1000)
    }

    /// Returns both bounds of the cycles at a frequency.
    pub(crate) fn cycles(&self, name: &str, core_hz: u64) -> [f64; 2] {
        let mhz = core_hz / 1_000_000;
        ["least", "most"].map(|bound| self.bytes(&format!("{name}, cycles at {mhz} MHz, at {bound}")) as f64)
    }

    /// Returns the bounds of a time at full speed, ms.
    pub(crate) fn times_ms(&self, name: &str) -> String {
        let [least, most] = self.cycles(name, FULL_HZ).map(|cycles| 1e3 * cycles / FULL_HZ as f64);
        format!("{least:.1} to {most:.1} ms")
    }

    /// Returns the bounds of a time without a crystal, in whole ms.
    pub(crate) fn times_without_crystal_ms(&self, name: &str) -> String {
        let [least, most] = self.cycles(name, INTERNAL_HZ).map(|cycles| 1e3 * cycles / INTERNAL_HZ as f64);
        format!("{least:.0} to {most:.0} ms")
    }
}
