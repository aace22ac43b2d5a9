//! Progress of long work on the terminal.

use indicatif::{ProgressBar, ProgressStyle};

/// Returns a bar with a name; who works sets its length.
pub(crate) fn progress(name: &'static str) -> ProgressBar {
    let style = ProgressStyle::with_template("{prefix} {bar:40} {percent:>3} % {msg} ({eta} to go)");
    let bar = ProgressBar::new(1).with_prefix(name);
    match style {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}
