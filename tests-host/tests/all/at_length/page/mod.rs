//! The page for a browser alone, in a real browser, as a release builds it.
//!
//! | file | question |
//! |---|---|
//! | `sentences` | Does it say what `rai replay` says, byte for byte, from a disk, from a server and in another browser? |
//! | `alone` | Does it ask or store anything? |
//! | `wrong` | What does it say of wrong files, and how soon does it stop? |
//! | `port` | Does it judge a receiver in time, and notice that it is gone? |
//! | `cost` | How long does a long recording take, and how much memory? |
//! | `people` | Can everybody read and reach it? |

mod alone;
mod cost;
mod people;
mod port;
mod sentences;
mod server;
mod wrong;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use oracle::browser::{self, Browser, Tab};
use raim::page::report::base64_text;
use rig::skip;
use tempfile::TempDir;

/// Longest wait for the page itself, on a computer that does something else meanwhile.
const PATIENCE: Duration = Duration::from_mins(1);

/// Window of a desk, pixels.
const DESK: (u32, u32) = (1280, 900);

/// The page as a file, and a browser for it.
struct Built {
    folder: TempDir,
    path: PathBuf,
    browser: &'static str,
}

impl Built {
    /// Builds the page; `None` without a browser or without the target of its program.
    fn new() -> Option<Self> {
        let Some(browser) = browser::name() else {
            skip::say("a browser (chromium)");
            return None;
        };
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("out");
        let mut release = Command::new(xtask::cargo::build("release").unwrap());
        let output = release.args(["release", "--only", "page", "--out"]).arg(&out).output().unwrap();
        let reported = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success(), "{reported}{}", String::from_utf8_lossy(&output.stderr));
        let path = out.join("rai.html");
        if !path.is_file() {
            skip::say("the target wasm32-wasip1 (rustup target add wasm32-wasip1)");
            return None;
        }
        Some(Self { folder, path, browser })
    }

    fn address(&self) -> String {
        format!("file://{}", self.path.display())
    }

    /// Opens the page from the disk, and waits until it is ready.
    fn open(&self, size: (u32, u32), scheme: &str) -> Browser {
        opened(Browser::open_in(self.browser, &self.address(), size, scheme, &[]).unwrap())
    }

    /// Writes a file into the folder of the page.
    fn file(&self, name: &str, content: &[u8]) -> PathBuf {
        let path = self.folder.path().join(name);
        std::fs::write(&path, content).unwrap();
        path
    }
}

fn opened(mut browser: Browser) -> Browser {
    browser.wait_for("Boolean(document.body?.dataset.ready)", PATIENCE).unwrap();
    browser
}

/// Gives files to the page and waits for its answer: `done` or `failed`.
fn judged(browser: &mut impl Tab, files: &[PathBuf]) -> String {
    browser.value("document.body.dataset.state = ''").unwrap();
    browser.choose("#files", files).unwrap();
    finished(browser)
}

/// Waits for the end of a judgement.
fn finished(browser: &mut impl Tab) -> String {
    browser.wait_for("['done', 'failed'].includes(document.body.dataset.state)", 4 * PATIENCE).unwrap();
    text(browser, "document.body.dataset.state")
}

fn text(browser: &mut impl Tab, expression: &str) -> String {
    browser.value(expression).unwrap().as_str().unwrap_or_default().to_owned()
}

fn number(browser: &mut impl Tab, expression: &str) -> f64 {
    browser.value(&format!("Number({expression})")).unwrap().as_f64().unwrap_or(f64::NAN)
}

/// Returns the last name of a path.
fn name(path: &Path) -> String {
    path.file_name().unwrap().to_string_lossy().into_owned()
}

/// Builds the program `rai`; returns its path.
fn program() -> PathBuf {
    xtask::cargo::build("rai").unwrap()
}
