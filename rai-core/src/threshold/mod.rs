//! Thresholds from committed tables.
