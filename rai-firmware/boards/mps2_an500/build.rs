//! Passes the folders of the memory map to the linker.
//!
//! `memory.x` of the workspace has the map of the first board and includes `regions.x`, which each
//! board has in its folder.

use std::path::Path;

fn main() {
    let board = Path::new(env!("CARGO_MANIFEST_DIR"));
    for (folder, file) in [(board.join("../../.."), "memory.x"), (board.to_path_buf(), "regions.x")] {
        println!("cargo::rustc-link-search={}", folder.display());
        println!("cargo::rerun-if-changed={}", folder.join(file).display());
    }
}
