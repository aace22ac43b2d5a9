//! Passes the commit to the image, and the folders of the memory map to the linker.
//!
//! `memory.x` of the workspace has the map of the first board and includes `regions.x`, which each
//! board has in its folder.

use std::path::Path;
use std::process::Command;

/// Boards by feature and folder.
const BOARDS: [(&str, &str); 2] = [("STM32F405", "stm32f405"), ("MPS2_AN500", "mps2_an500")];

fn main() {
    let board =
        BOARDS.iter().find(|(feature, _)| std::env::var_os(format!("CARGO_FEATURE_{feature}")).is_some());
    if let Some((_, folder)) = board {
        let package = Path::new(env!("CARGO_MANIFEST_DIR"));
        let (workspace, folder) = (package.join(".."), package.join("src/board").join(folder));
        for (folder, file) in [(workspace, "memory.x"), (folder, "regions.x")] {
            println!("cargo::rustc-link-search={}", folder.display());
            println!("cargo::rerun-if-changed={}", folder.join(file).display());
        }
    }
    println!("cargo::rustc-env=RAI_GIT={}", commit().unwrap_or_else(|| "unknown".into()));
    // A commit moves HEAD or its branch; the log of HEAD grows with either.
    for path in ["HEAD", "logs/HEAD"].into_iter().filter_map(|name| git(&["rev-parse", "--git-path", name])) {
        println!("cargo::rerun-if-changed={path}");
    }
}

fn commit() -> Option<String> {
    git(&["rev-parse", "--short=8", "HEAD"])
}

fn git(arguments: &[&str]) -> Option<String> {
    let output =
        Command::new("git").args(arguments).output().ok().filter(|output| output.status.success())?;
    let text = String::from_utf8(output.stdout).ok()?.trim().to_owned();
    (!text.is_empty()).then_some(text)
}
