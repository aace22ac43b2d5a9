//! Tells the crate whether it is compiled for size, so that the root is then one function and not a
//! copy of its five instructions for each of its fifty callers.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-check-cfg=cfg(compiled_for_size)");
    if std::env::var("OPT_LEVEL").is_ok_and(|level| level == "z") {
        println!("cargo::rustc-cfg=compiled_for_size");
    }
}
