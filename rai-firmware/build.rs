//! Tells the image which commit it is, and the linker where the memory map lies.

use std::path::Path;
use std::process::Command;

/// The boards, by feature and folder.
const BOARDS: [(&str, &str); 2] = [("STM32F405", "stm32f405"), ("MPS2_AN500", "mps2_an500")];

fn main() {
    let board =
        BOARDS.iter().find(|(feature, _)| std::env::var_os(format!("CARGO_FEATURE_{feature}")).is_some());
    if let Some((_, folder)) = board {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/board").join(folder);
        println!("cargo::rustc-link-search={}", folder.display());
        println!("cargo::rerun-if-changed={}", folder.join("memory.x").display());
    }
    println!("cargo::rustc-env=RAI_GIT={}", commit().unwrap_or_else(|| "unknown".into()));
    // A commit moves HEAD or the branch it names; the log of HEAD grows with either.
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
