//! Broadcast orbits and clocks.
