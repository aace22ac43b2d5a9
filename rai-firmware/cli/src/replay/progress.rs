//! Progress of a replay on the terminal of the command. Without the command there is none: a page
//! shows its own.

#[cfg(feature = "commands")]
use indicatif::{ProgressBar, ProgressStyle};

/// Number of epochs so far, on standard error.
pub(super) struct Progress {
    #[cfg(feature = "commands")]
    bar: ProgressBar,
}

#[cfg_attr(not(feature = "commands"), expect(clippy::unused_self, reason = "there is nothing to show"))]
impl Progress {
    /// Begins; shows `place`, in which the module runs.
    #[cfg(feature = "commands")]
    pub(super) fn of(place: &'static str) -> Self {
        let style = ProgressStyle::with_template("{spinner} {msg} {pos} epochs {per_sec}");
        let bar = ProgressBar::new_spinner().with_message(place);
        Self { bar: style.map(|style| bar.clone().with_style(style)).unwrap_or(bar) }
    }

    /// Begins; shows nothing.
    #[cfg(not(feature = "commands"))]
    pub(super) fn of(_: &'static str) -> Self {
        Self {}
    }

    /// Counts an epoch.
    pub(super) fn advance(&self) {
        #[cfg(feature = "commands")]
        self.bar.inc(1);
    }

    /// Clears the line.
    pub(super) fn end(&self) {
        #[cfg(feature = "commands")]
        self.bar.finish_and_clear();
    }
}
