//! Simulated sky.
