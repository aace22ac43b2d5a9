//! RAI in a browser: `rai replay` over dropped files and the module on a receiver's port, without a
//! server.
//!
//! ```text
//! rai.html ─► page.js ─► worker.js ─► wasi.js ─► this program ─► raim ─► raim-firmware
//!             screen     thread       files                     replay, report, live state
//! ```
//!
//! The page gives this program a command line and files by name, as a shell does, so that what it runs
//! *is* `rai replay`, and the command that it shows is the one that gave the result. [`run`] is the
//! only entry for recordings. A receiver's bytes come on standard input: [`receive`] and [`tick`].
//!
//! # Decisions
//!
//! | question | answer |
//! |---|---|
//! | target | `wasm32-wasip1`: its files are those of the standard library, whose twenty calls `wasi.js` answers from the dropped files. On `wasm32-unknown-unknown` every reader of files would need a second form, and the chart library measures its letters by the window of a page, which a worker does not have |
//! | bindings | five exports without parameters or with one number; everything else is text in files. `wasm-bindgen` would bring a build tool for these five |
//! | threads | one worker per judgement; ending it is how a judgement is cancelled |
//!
//! Assumes that the page gives each file a name without a folder. The program has no access to
//! anything else: no network, no storage, no clock but the browser's.

mod arrange;
mod command;
mod live;
mod sample;
mod settings;

use std::cell::RefCell;

use live::Live;

thread_local! {
    static LIVE: RefCell<Option<Live>> = const { RefCell::new(None) };
}

/// Runs the command of this process's command line; returns its exit code.
// SAFETY: the name is this program's own, and no library has one like it.
#[allow(unsafe_code, reason = "the name by which the page calls it")]
#[unsafe(no_mangle)]
pub extern "C" fn run() -> i32 {
    match command::dispatch() {
        Ok(live) => {
            LIVE.set(live);
            0
        }
        Err(error) => {
            eprintln!("error: {error:#}");
            1
        }
    }
}

/// Gives the live module the bytes on standard input, which came at this time, ms. Prints its state
/// after a verdict; returns 1 if it did.
// SAFETY: as for `run`.
#[allow(unsafe_code, reason = "the name by which the page calls it")]
#[unsafe(no_mangle)]
pub extern "C" fn receive(came_ms: f64) -> i32 {
    with_live(|live| live.receive(came_ms as u64))
}

/// Tells the live module the time, ms. Prints its state after a verdict, such as that of a silence;
/// returns 1 if it did.
// SAFETY: as for `run`.
#[allow(unsafe_code, reason = "the name by which the page calls it")]
#[unsafe(no_mangle)]
pub extern "C" fn tick(now_ms: f64) -> i32 {
    with_live(|live| live.tick(now_ms as u64))
}

/// Returns the rate at which the live module wants its port to be read, bit/s.
// SAFETY: as for `run`.
#[allow(unsafe_code, reason = "the name by which the page calls it")]
#[unsafe(no_mangle)]
pub extern "C" fn rate() -> i32 {
    LIVE.with_borrow(|live| live.as_ref().map_or(0, |live| live.baud().cast_signed()))
}

/// Returns the number of frames that the live module has read: none at a wrong rate.
// SAFETY: as for `run`.
#[allow(unsafe_code, reason = "the name by which the page calls it")]
#[unsafe(no_mangle)]
pub extern "C" fn frames() -> i32 {
    LIVE.with_borrow(|live| live.as_ref().map_or(0, |live| live.frames().cast_signed()))
}

fn with_live(act: impl FnOnce(&mut Live) -> bool) -> i32 {
    LIVE.with_borrow_mut(|live| live.as_mut().is_some_and(act).into())
}
