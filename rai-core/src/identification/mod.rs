//! Which satellite is it? From a detected fault to the satellites to leave out.

pub mod baarda;
