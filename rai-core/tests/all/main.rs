//! Tests of the core's public interface.
//!
//! One program for all, so that their common part is compiled and linked once.

mod absolute;
mod adaptation;
mod angle;
mod broken_system;
mod capacity;
mod chi_square;
mod clock;
mod clock_aiding;
mod clock_limits;
mod clock_ramps;
mod common_error;
mod continuity;
mod covered;
mod detection;
mod epoch;
mod exclusion_levels;
mod frame;
mod kept_subsets;
mod known_height;
mod least_squares;
mod monitor;
mod monitor_limits;
mod motion;
mod multiple_faults;
mod noise;
mod noisy_receivers;
mod normal;
mod parity;
mod policy;
mod properties;
mod ransac;
mod rivals;
mod satellites;
mod separation;
mod separation_symmetries;
mod shift;
mod sky;
mod solved;
mod strategy;
mod tags;
mod velocity;
mod weighting;
mod words;
