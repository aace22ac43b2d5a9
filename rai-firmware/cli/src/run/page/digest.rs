//! The source by which a Content-Security-Policy names a style or a script: its SHA-256, which
//! identifies what the page itself contains and keeps no secret.
//!
//! Reference: W3C, *Content Security Policy Level 3*, 2.3.1.

use sha2::{Digest as _, Sha256};

use crate::page::report::base64_text;

/// Returns the source of a Content-Security-Policy that allows this text: `'sha256-…'`.
pub(super) fn source(text: &str) -> String {
    format!("'sha256-{}'", base64_text(&Sha256::digest(text.as_bytes())))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The example of Content Security Policy Level 2, 7.15.2.
    #[test]
    fn source_is_that_of_the_policy() {
        assert_eq!(
            source("alert('Hello, world.');"),
            "'sha256-qznLcsROx4GACP2dm0UCKCzCG+HiZ1guq6ZZDob/Tng='"
        );
    }
}
