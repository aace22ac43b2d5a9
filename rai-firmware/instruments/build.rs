//! Passes the folders of the memory map to the linker, as the packages of the boards do, and the
//! calls of the documented interface to the proof.

use std::path::Path;

fn main() {
    println!("cargo::rustc-check-cfg=cfg(interface)");
    println!("cargo::rerun-if-env-changed=RAI_INTERFACE");
    if std::env::var_os("RAI_INTERFACE").is_some() {
        println!("cargo::rustc-cfg=interface");
    }
    let firmware = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let is_first = std::env::var_os("CARGO_FEATURE_STM32F405").is_some();
    let board = firmware.join("boards").join(if is_first { "stm32f405" } else { "mps2_an500" });
    for (folder, file) in [(firmware.join(".."), "memory.x"), (board, "regions.x")] {
        println!("cargo::rustc-link-search={}", folder.display());
        println!("cargo::rerun-if-changed={}", folder.join(file).display());
    }
}
