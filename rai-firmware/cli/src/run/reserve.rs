//! Descriptors that are held back for the pin and for the receiver's line, so that the pin can fall and
//! the line be connected again when all others are in use.

use std::fs::File;
use std::sync::{Mutex, PoisonError};

/// Descriptors that the start of a program needs: its input, and both ends of the pipe that reports
/// a failed start; one more for a file. A line needs fewer.
const HELD: usize = 4;

#[cfg(unix)]
const NOTHING: &str = "/dev/null";
#[cfg(not(unix))]
const NOTHING: &str = "NUL";

/// The descriptors.
#[derive(Debug)]
pub(super) struct Reserve(Mutex<Vec<File>>);

impl Reserve {
    /// Opens the descriptors, as many as the system gives.
    pub(super) fn new() -> Self {
        Self(Mutex::new(held()))
    }

    /// Does something with the descriptors free, and takes them back.
    pub(super) fn with<T>(&self, act: impl FnOnce() -> T) -> T {
        let mut files = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        files.clear();
        let done = act();
        *files = held();
        done
    }
}

fn held() -> Vec<File> {
    (0..HELD).map_while(|_| File::open(NOTHING).ok()).collect()
}
