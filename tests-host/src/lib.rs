//! Tests of the whole, in `tests/all`; this library has only the example of the readme.

/// Runs the example of the readme as a test.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct Readme;
