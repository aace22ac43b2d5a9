//! Choice of the build for long work: the one that runs, or an optimised one.
//!
//! An optimised build is made if it saves more time than it costs:
//!
//! t − t ÷ ρ > b ÷ p,  t = s + w ÷ p
//!
//! | symbol | field, constant | unit |
//! |---|---|---|
//! | s | [`Work::serial_s`] | s, in the development profile |
//! | w | [`Work::parallel_s`] | s of one processor, in the development profile |
//! | ρ | [`RATIO`] | 1 |
//! | b | [`BUILD_CPU_S`] | s of one processor |
//! | p | number of processors | 1 |
//!
//! An optimised build that is there and newer than its sources costs nothing, and is used.
//!
//! Assumption: a machine like the one on which the constants were measured. On another one all
//! three times change together, so that the choice stays the same.

use std::collections::BTreeSet;
use std::fmt;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::SystemTime;

use anyhow::{Context as _, Result, ensure};

use crate::cargo::{command, root};

/// Time in the development profile over the time optimised, by `user` of the shell's `time`.
///
/// It is 1.8 for `lpv200.toml` (7.5 and 4.1 s), and 1.3 for all attacks in the quick form (52 and
/// 41 s). The larger one is taken, so that a build is rather made than not.
const RATIO: f64 = 1.8;

/// Time of an optimised build from nothing: 7.5 minutes on two processors.
const BUILD_CPU_S: f64 = 900.0;

/// Work that a command is asked to do.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Work {
    /// Time of the work that uses one processor, s in the development profile.
    pub(crate) serial_s: f64,
    /// Time of the work that uses all processors, s of one processor.
    pub(crate) parallel_s: f64,
    /// Source of the estimate, for the terminal.
    pub(crate) source: String,
}

/// Build that does the work.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Choice {
    /// The one that runs.
    This,
    /// An optimised one that is there, at this path.
    Ready(PathBuf),
    /// An optimised one that has to be built first.
    Build,
}

impl Work {
    /// Returns the time in the development profile on so many processors, s.
    fn seconds(&self, processors: f64) -> f64 {
        self.serial_s + self.parallel_s / processors
    }

    /// Returns the work of both.
    pub(crate) fn and(&self, other: &Self) -> Self {
        Self {
            serial_s: self.serial_s + other.serial_s,
            parallel_s: self.parallel_s + other.parallel_s,
            source: format!("{}; {}", self.source, other.source),
        }
    }

    /// Chooses the build.
    fn choose(&self, processors: f64, ready: Option<PathBuf>) -> Choice {
        let seconds = self.seconds(processors);
        match ready {
            Some(program) => Choice::Ready(program),
            None if seconds - seconds / RATIO > BUILD_CPU_S / processors => Choice::Build,
            None => Choice::This,
        }
    }
}

/// Does the work by an optimised build if that is faster, and prints the reason for the choice.
/// Returns true if the work is done, and false if the caller must do it.
///
/// # Errors
/// With the text `failed` if the optimised build fails.
pub(crate) fn done_elsewhere(work: &Work, failed: &'static str) -> Result<bool> {
    if !cfg!(debug_assertions) {
        return Ok(false);
    }
    let processors = std::thread::available_parallelism().map_or(1.0, |number| number.get() as f64);
    let choice = work.choose(processors, ready());
    let (needed, build) = (Time(work.seconds(processors)), Time(BUILD_CPU_S / processors));
    let mut again = match choice {
        Choice::This => {
            eprintln!(
                "about {needed} of work ({}); an optimised build takes {build} and is not worth it",
                work.source
            );
            return Ok(false);
        }
        Choice::Ready(program) => {
            eprintln!("about {needed} of work ({}); the optimised build is there, and does it", work.source);
            Command::new(program)
        }
        Choice::Build => {
            eprintln!(
                "about {needed} of work ({}), up to {RATIO} times as fast after an optimised build of {build}",
                work.source
            );
            command(&["run", "--release", "--package", "xtask", "--"])
        }
    };
    // Paths on the command line are relative to the caller's folder.
    let folder = std::env::current_dir()?;
    let status = again.args(std::env::args_os().skip(1)).current_dir(folder).status();
    ensure!(status.context("the optimised build cannot be run")?.success(), failed);
    Ok(true)
}

/// Returns the path of the optimised build if it is newer than everything that it was built from.
fn ready() -> Option<PathBuf> {
    let folder = std::env::current_exe().ok()?.parent()?.parent()?.join("release");
    let program = folder.join("xtask").with_extension(std::env::consts::EXE_EXTENSION);
    let built = modified(&program)?;
    let sources = sources(&std::fs::read_to_string(folder.join("xtask.d")).ok()?);
    is_fresh(built, &sources).then_some(program)
}

/// Returns true if every file is there and older than `built`, as are the manifests above it.
fn is_fresh(built: SystemTime, sources: &[PathBuf]) -> bool {
    let own = |path: &&PathBuf| path.starts_with(root());
    let folders: BTreeSet<&Path> =
        sources.iter().filter(own).flat_map(|path| path.ancestors().skip(1)).collect();
    let manifests = folders.into_iter().map(|folder| folder.join("Cargo.toml")).filter(|path| path.exists());
    let others = ["Cargo.toml", "Cargo.lock", "rust-toolchain.toml"].map(|name| root().join(name));
    let mut files = sources.iter().cloned().chain(manifests).chain(others);
    !sources.is_empty() && files.all(|path| modified(&path).is_some_and(|time| time < built))
}

fn modified(path: &Path) -> Option<SystemTime> {
    std::fs::metadata(path).and_then(|metadata| metadata.modified()).ok()
}

/// Returns the files in a list of dependencies as cargo writes it: `program: file file …`, with a
/// backslash before a space within a name.
fn sources(list: &str) -> Vec<PathBuf> {
    let Some((_, files)) = list.trim_end().split_once(": ") else { return Vec::new() };
    let marked = files.replace("\\ ", "\0");
    marked.split_whitespace().map(|file| PathBuf::from(file.replace('\0', " "))).collect()
}

/// Time for a reader, in seconds or minutes.
struct Time(f64);

impl fmt::Display for Time {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            seconds if seconds < 100.0 => write!(formatter, "{:.0} s", seconds.max(1.0)),
            seconds => write!(formatter, "{:.0} min", seconds / 60.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn work(serial_s: f64, parallel_s: f64) -> Work {
        Work { serial_s, parallel_s, source: "a test".into() }
    }

    #[test]
    fn build_is_made_if_it_saves_more_than_it_costs() {
        // On two processors the build takes 450 s. Work of t saves 4/9 t, so that 1012.5 s are
        // even.
        assert_eq!(work(1010.0, 0.0).choose(2.0, None), Choice::This);
        assert_eq!(work(1015.0, 0.0).choose(2.0, None), Choice::Build);
        assert_eq!(work(0.0, 2020.0).choose(2.0, None), Choice::This);
        assert_eq!(work(0.0, 2030.0).choose(2.0, None), Choice::Build);
    }

    #[test]
    fn build_that_is_there_is_used_for_any_work() {
        let program = PathBuf::from("release/xtask");
        assert_eq!(work(0.1, 0.0).choose(2.0, Some(program.clone())), Choice::Ready(program));
    }

    #[test]
    fn program_is_fresh_if_no_source_is_newer_or_missing() {
        let folder = tempfile::tempdir().expect("a folder");
        let sources = ["a.rs", "b.rs"].map(|name| folder.path().join(name));
        for source in &sources {
            std::fs::write(source, "").expect("a file");
        }
        let (later, earlier) =
            (std::time::Duration::from_hours(1), std::time::Duration::from_hours(24 * 365 * 50));
        let now = SystemTime::now();
        assert!(is_fresh(now + later, &sources));
        assert!(!is_fresh(now - earlier, &sources));
        std::fs::remove_file(&sources[1]).expect("a file");
        assert!(!is_fresh(now + later, &sources));
        assert!(!is_fresh(now + later, &[]));
    }

    #[test]
    fn list_of_cargo_is_read_with_spaces_in_names() {
        let list = "/a/release/xtask: /a/src/main.rs /b\\ c/lib.rs\n";
        assert_eq!(sources(list), ["/a/src/main.rs", "/b c/lib.rs"].map(PathBuf::from));
        assert_eq!(sources("no list"), Vec::<PathBuf>::new());
    }

    #[test]
    fn times_are_written_for_a_reader() {
        assert_eq!([0.2, 42.4, 450.0].map(|seconds| Time(seconds).to_string()), ["1 s", "42 s", "8 min"]);
    }
}
