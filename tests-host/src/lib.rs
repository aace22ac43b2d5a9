//! Tests of the whole, in `tests/all`; this library is empty.
