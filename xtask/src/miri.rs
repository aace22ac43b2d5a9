//! `cargo xtask miri`: the core and the firmware's library in an interpreter that notices undefined behaviour.
//!
//! Neither has an unsafe line of its own outside the board files; what they build on has, and the C interface around them. The
//! tests that stay out say why where they stand.

use anyhow::{Context as _, ensure};

/// As the chip: 32 bits, little-endian; and square roots are no inline assembly there, which Miri cannot interpret.
const TARGET: &str = "armv7-unknown-linux-gnueabihf";

/// The tests that are interpreted: small ones that reach every container and every solve, but for the clock's. Its
/// Cholesky factor is nalgebra's, which borrows one column while it writes to another: more than Miri's stacked borrows
/// allow.
const TESTS: [&[&str]; 4] = [
    &["--package", "rai-core", "--lib"],
    &["--package", "rai-core", "--test", "epoch", "--test", "frame", "--test", "monitor"],
    &["--package", "rai-firmware", "--lib"],
    &["--package", "rai-capi"],
];

/// Runs the command.
pub(crate) fn run() -> anyhow::Result<()> {
    let install = "rustup component add --toolchain nightly miri rust-src";
    crate::nightly::ensure(&["miri", "--version"], install)?;
    for tests in TESTS {
        let mut command =
            crate::nightly::cargo(&["miri", "test", "--target", TARGET, "--target-dir", "target/miri"]);
        // No file is read but by tests that look for reference values, and those are skipped without.
        command.args(tests).env("MIRIFLAGS", "-Zmiri-disable-isolation").env("PROPTEST_CASES", "8");
        let status = command.status().context("miri cannot be run")?;
        ensure!(status.success(), "`cargo miri test {}` failed", tests.join(" "));
    }
    Ok(())
}
