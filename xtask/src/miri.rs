//! `cargo xtask miri`: the tests of the core and of the firmware's library under Miri, which
//! detects undefined behaviour.
//!
//! Neither has unsafe code of its own outside the board files. Their dependencies have some, and so
//! has the C interface around them. A test that is left out gives its reason where it is defined.

use anyhow::{Context as _, Result, ensure};
use pico_args::Arguments;
use xtask::nightly;

/// Target like the chip, with 32 bits, little-endian. Its square roots are no inline assembly,
/// which Miri cannot interpret.
const TARGET: &str = "armv7-unknown-linux-gnueabihf";

/// Tests to run: small ones that reach every container and every solve except the clock's. Its
/// Cholesky factor is nalgebra's, which borrows one column while it writes to another; Miri's
/// stacked borrows do not allow that.
const TESTS: [&[&str]; 4] = [
    &["--package", "raim-core", "--lib"],
    &["--package", "raim-core", "--test", "all", "--", "epoch::", "frame::", "monitor::"],
    &["--package", "raim-firmware", "--lib"],
    &["--package", "rai-capi"],
];

/// Runs the command.
pub(crate) fn run(arguments: &mut Arguments) -> Result<()> {
    crate::test::ensure_none_is_left(arguments)?;
    let install = "rustup component add --toolchain nightly miri rust-src";
    nightly::ensure(&["miri", "--version"], install)?;
    for tests in TESTS {
        let mut command =
            nightly::cargo(&["miri", "test", "--target", TARGET, "--target-dir", "target/miri"]);
        // Only tests of reference values read files, and they are skipped without them.
        command.args(tests).env("MIRIFLAGS", "-Zmiri-disable-isolation").env("PROPTEST_CASES", "8");
        let status = command.status().context("miri cannot be run")?;
        ensure!(status.success(), "`cargo miri test {}` failed", tests.join(" "));
    }
    Ok(())
}
