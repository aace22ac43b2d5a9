//! Passes the commit to the image.

use std::process::Command;

fn main() {
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
