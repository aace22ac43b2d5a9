//! Prints the instructions of an epoch on this machine in both precisions, for `cargo xtask bench
//! --host`.

use rig::bench::host;

fn main() -> anyhow::Result<()> {
    if let Ok(words) = std::env::var(host::VARIABLE) {
        return host::judge(&words);
    }
    if !host::is_measurable() {
        println!("instructions are not counted: valgrind is not installed");
        return Ok(());
    }
    let program = std::env::current_exe()?.display().to_string();
    println!(
        "instructions of an epoch by BAARDA on this machine\n\nsatellites  faulty        f32        f64"
    );
    for sky in host::SKIES {
        println!("{}", host::measure(&[&program], sky)?);
    }
    Ok(())
}
