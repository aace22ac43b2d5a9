//! The C interface by `CMake`: built and installed, found by another project, cross-compiled, and
//! as a module of Zephyr.
//!
//! Zephyr itself is stubbed, because it takes gigabytes.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::Command;

use rig::capi::program::{ARM, STRICT};
use rig::capi::{folder, run};
use rig::skip;

fn root() -> PathBuf {
    folder().join("../..").canonicalize().expect("the repository")
}

/// Folder of the libraries for C, whose compiled parts all tests share.
fn cargo_folder() -> PathBuf {
    root().join("target/capi")
}

/// Returns the lock on the folder of the libraries for C. Without it another test may replace a
/// library between its build and its installation.
fn lock() -> File {
    std::fs::create_dir_all(cargo_folder()).expect("a folder");
    let file = File::create(cargo_folder().join("building")).expect("a file");
    file.lock().expect("a lock");
    file
}

/// Returns true if these programs are installed; otherwise reports that the calling test is
/// skipped.
fn has(programs: &[&str]) -> bool {
    let missing = programs.iter().find(|program| run(Command::new(program).arg("--version")).is_err());
    if let Some(program) = missing {
        skip::say(&format!("the program {program}"));
    }
    missing.is_none()
}

/// Returns the configuration of a project into a folder.
fn configure(source: &Path, build: &Path, definitions: &[String]) -> Command {
    let mut cmake = Command::new("cmake");
    cmake.arg("-S").arg(source).arg("-B").arg(build);
    cmake.args(definitions.iter().map(|definition| format!("-D{definition}")));
    // The tests' own flags must not reach the library.
    cmake.env_remove("CARGO").env_remove("RUSTFLAGS").env_remove("CARGO_ENCODED_RUSTFLAGS");
    cmake
}

fn build(folder: &Path) {
    let mut cmake = Command::new("cmake");
    cmake.arg("--build").arg(folder).env_remove("CARGO").env_remove("RUSTFLAGS");
    // Parts that other builds have compiled are not compiled again.
    cmake.env("CARGO_BUILD_BUILD_DIR", root().join("target"));
    run(&mut cmake).expect("it builds");
}

/// Builds and installs the library for C, and returns the prefix.
fn install(out: &Path, definitions: &[String]) -> PathBuf {
    let (at, prefix) = (out.join("library"), out.join("prefix"));
    let _lock = lock();
    let mut all = vec![format!("RAI_BUILD_FOLDER={}", cargo_folder().display())];
    all.extend_from_slice(definitions);
    all.push("CMAKE_INSTALL_LIBDIR=lib".into());
    run(&mut configure(&folder(), &at, &all)).expect("it configures");
    build(&at);
    run(Command::new("cmake").arg("--install").arg(&at).arg("--prefix").arg(&prefix)).expect("it installs");
    prefix
}

/// Output of the example in the README of `raim-core`: G05 is left out, and nothing else.
fn assert_is_the_example(program: &mut Command) {
    let reported = String::from_utf8(run(program).expect("protected")).expect("text");
    assert!(reported.starts_with("EXCLUDED: 6 of 7 satellites, HPL "), "{reported}");
    assert!(reported.contains("left out: G05, off by 80.0 m"), "{reported}");
}

/// Configures the library for a processor, and returns cmake's words.
fn derived(system: &str, processor: &str, flags: &str, out: &Path) -> Result<String, String> {
    let toolchain = out.join("toolchain.cmake");
    // The compiler is not that of the processor: nothing is compiled.
    let lines = format!(
        "set(CMAKE_SYSTEM_NAME {system})\nset(CMAKE_SYSTEM_PROCESSOR {processor})\nset(CMAKE_C_COMPILER gcc)\n\
         set(CMAKE_C_COMPILER_WORKS ON)\nset(CMAKE_C_FLAGS_INIT \"{flags}\")\n\
         set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)\n"
    );
    std::fs::write(&toolchain, lines).expect("a file");
    let build = tempfile::tempdir_in(out).expect("a folder");
    let toolchain = format!("CMAKE_TOOLCHAIN_FILE={}", toolchain.display());
    let output = configure(&folder(), build.path(), &[toolchain]).output().expect("cmake");
    let reported = String::from_utf8_lossy(&output.stdout).into_owned();
    if output.status.success() {
        Ok(reported)
    } else {
        Err(String::from_utf8_lossy(&output.stderr).into_owned())
    }
}

#[test]
fn each_processor_has_its_target_or_is_refused() {
    if !has(&["cmake", "gcc"]) {
        return;
    }
    let out = tempfile::tempdir().expect("a folder");
    let (hard, nothing) = ("-mfloat-abi=hard", "");
    for (system, processor, flags, want) in [
        ("Generic", "cortex-m0plus", nothing, "thumbv6m-none-eabi"),
        ("Generic", "cortex-m3", nothing, "thumbv7m-none-eabi"),
        ("Generic", "cortex-m4", nothing, "thumbv7em-none-eabi"),
        ("Generic", "cortex-m7", hard, "thumbv7em-none-eabihf"),
        ("Generic", "cortex-m23", nothing, "thumbv8m.base-none-eabi"),
        ("Generic", "cortex-m33", hard, "thumbv8m.main-none-eabihf"),
        ("Generic", "arm", "-mcpu=cortex-m55 -mfloat-abi=hard", "thumbv8m.main-none-eabihf"),
        ("Generic", "riscv32", "-march=rv32imac_zicsr -mabi=ilp32", "riscv32imac-unknown-none-elf"),
        ("Generic", "riscv32", "-march=rv32imc -mabi=ilp32", "riscv32imc-unknown-none-elf"),
        ("Generic", "riscv32", "-march=rv32imafc -mabi=ilp32f", "riscv32imafc-unknown-none-elf"),
        ("Linux", "aarch64", nothing, "aarch64-unknown-linux-gnu"),
    ] {
        // Flags of another processor than the compiler's would end the configuration early.
        let reported = derived(system, processor, flags, out.path());
        let reported = reported.unwrap_or_else(|error| panic!("{processor} {flags}: {error}"));
        assert!(reported.contains(&format!("rai: Rust target {want} ")), "{processor} {flags}: {reported}");
    }
    for (system, processor, flags) in [
        ("Generic", "arm", nothing),
        ("Generic", "avr", nothing),
        ("Generic", "cortex-a9", hard),
        ("Generic", "riscv32", "-march=rv32i"),
        ("Linux", "mips", nothing),
    ] {
        let error = derived(system, processor, flags, out.path()).expect_err(processor);
        assert!(error.contains("no Rust target is known for"), "{processor}: {error}");
    }
}

#[test]
fn module_of_zephyr_stands_where_west_finds_it_and_refuses_an_unknown_processor() {
    let module = std::fs::read_to_string(root().join("zephyr/module.yml")).expect("west looks there");
    let place = |key: &str| {
        let line = module.lines().find_map(|line| line.trim().strip_prefix(key)).expect("a key");
        root().join(line.trim())
    };
    let (cmake, kconfig) = (place("cmake:"), place("kconfig:"));
    assert!(cmake.join("CMakeLists.txt").exists() && kconfig.exists());
    if !has(&["cmake", "gcc"]) {
        return;
    }
    let out = tempfile::tempdir().expect("a folder");
    let stub = |target: &str, satellites: &str| {
        let mut settings = vec![format!("MODULE={}", cmake.display()), format!("CONFIG_RAI_TARGET={target}")];
        settings.extend(["CONFIG_RAI=y", "CONFIG_RAI_RECEIVER=y", "CONFIG_RAI_UBX=y"].map(str::to_owned));
        settings.push(format!("CONFIG_RAI_SATELLITES={satellites}"));
        let build = tempfile::tempdir_in(out.path()).expect("a folder");
        let output =
            configure(&folder().join("tests/zephyr"), build.path(), &settings).output().expect("cmake");
        let reported = [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned());
        (output.status.success(), reported.concat())
    };
    let (is_good, reported) = stub("thumbv7em-none-eabihf", "32");
    assert!(is_good, "{reported}");
    assert!(
        reported.contains("thumbv7em-none-eabihf/firmware/librai.a with panic-handler,receiver,ubx"),
        "{reported}"
    );
    assert!(reported.contains("zephyr_compile_definitions RAI_SATELLITES_32"), "{reported}");
    let (is_good, reported) = stub("", "48");
    assert!(!is_good && reported.contains("RAI knows no Rust target for this processor"), "{reported}");
}

#[test]
fn platformio_takes_the_target_from_the_board_or_refuses_it() {
    if !has(&["python3"]) {
        return;
    }
    let program = "
import runpy, sys
target_of = runpy.run_path(sys.argv[1])['target_of']
print(target_of(['-mcpu=cortex-m4', '-mfloat-abi=hard'], ''), target_of([], 'cortex-m0plus'))
print(target_of(['-mcpu=cortex-m33'], 'cortex-m4'))
target_of([], 'avr')
";
    let script = folder().join("platformio.py");
    let output = Command::new("python3").args(["-c", program]).arg(script).output().expect("python3");
    let reported = String::from_utf8_lossy(&output.stdout);
    assert_eq!(reported, "thumbv7em-none-eabihf thumbv6m-none-eabi\nthumbv8m.main-none-eabi\n");
    assert!(!output.status.success());
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(error.contains("no Rust target is known for the processor 'avr'"), "{error}");
}

#[test]
fn another_project_finds_and_links_the_installed_library() {
    if !has(&["cmake", "gcc", "pkg-config", "readelf"]) {
        return;
    }
    let out = tempfile::tempdir().expect("a folder");
    let prefix = install(out.path(), &["RAI_PROFILE=dev".into()]);
    let consumer = out.path().join("consumer");
    let found = [format!("CMAKE_PREFIX_PATH={}", prefix.display())];
    run(&mut configure(&folder().join("tests/consumer"), &consumer, &found)).expect("the package is found");
    build(&consumer);
    assert_is_the_example(&mut Command::new(consumer.join("monitor")));
    assert_is_the_example(&mut Command::new(consumer.join("monitor_shared")));

    // The shared library has the version of the interface in its name; a program loads that name.
    let header = std::fs::read_to_string(prefix.join("include/rai.h")).expect("the header is installed");
    let version = header.lines().find_map(|line| line.strip_prefix("#define RAI_ABI_VERSION "));
    let name = format!("librai.so.{}", version.expect("a version"));
    let dynamic = run(Command::new("readelf").arg("-d").arg(prefix.join("lib").join(&name))).expect("ELF");
    assert!(String::from_utf8_lossy(&dynamic).contains(&format!("Library soname: [{name}]")));
    let loads = run(Command::new("readelf").arg("-d").arg(consumer.join("monitor_shared"))).expect("ELF");
    assert!(String::from_utf8_lossy(&loads).contains(&format!("Shared library: [{name}]")));

    // By pkg-config, without CMake.
    let mut asked = Command::new("pkg-config");
    asked.args(["--cflags", "--libs", "rai"]).env("PKG_CONFIG_PATH", prefix.join("lib/pkgconfig"));
    let flags = String::from_utf8(run(&mut asked).expect("rai.pc is found")).expect("text");
    let folder_of_flag = |flag: &str| Path::new(&flag[2..]).canonicalize().expect("a folder");
    let folders: Vec<PathBuf> = flags.split_whitespace().take(2).map(folder_of_flag).collect();
    let prefix = prefix.canonicalize().expect("the prefix");
    assert_eq!(folders, [prefix.join("include"), prefix.join("lib")], "{flags}");
    let program = out.path().join("by_pkg_config");
    let mut gcc = Command::new("gcc");
    gcc.args(STRICT).arg(folder().join("examples/c/monitor.c")).args(flags.split_whitespace());
    run(gcc.arg("-o").arg(&program)).expect("it links");
    assert_is_the_example(Command::new(program).env("LD_LIBRARY_PATH", prefix.join("lib")));
}

#[test]
fn a_cross_build_takes_its_target_from_the_processor() {
    if !has(&["cmake", ARM]) {
        return;
    }
    let out = tempfile::tempdir().expect("a folder");
    let toolchain = folder().join("tests/consumer/cortex-m4.cmake");
    let toolchain = format!("CMAKE_TOOLCHAIN_FILE={}", toolchain.display());
    let prefix = install(out.path(), &[toolchain.clone(), "RAI_SATELLITES=16".into()]);
    let consumer = out.path().join("consumer");
    let found = [toolchain, format!("rai_DIR={}", prefix.join("lib/cmake/rai").display())];
    run(&mut configure(&folder().join("tests/consumer"), &consumer, &found)).expect("the package is found");
    build(&consumer);
    let program = std::fs::read(consumer.join("monitor")).expect("a program");
    // ELF: 32 bits, little-endian, Arm.
    assert_eq!((program.get(4..6), program.get(18..20)), (Some(&[1, 1][..]), Some(&[40, 0][..])));
    assert!(!prefix.join("lib/librai.so").exists(), "a microcontroller has no shared library");
}
