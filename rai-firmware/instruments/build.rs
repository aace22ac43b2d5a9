//! Passes the folders of the memory map to the linker, as the packages of the boards do.

use std::path::Path;

fn main() {
    let firmware = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let is_first = std::env::var_os("CARGO_FEATURE_STM32F405").is_some();
    let board = firmware.join("boards").join(if is_first { "stm32f405" } else { "mps2_an500" });
    for (folder, file) in [(firmware.join(".."), "memory.x"), (board, "regions.x")] {
        println!("cargo::rustc-link-search={}", folder.display());
        println!("cargo::rerun-if-changed={}", folder.join(file).display());
    }
}
