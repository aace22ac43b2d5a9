//! The rows of the phases of flight alone: what is left of the tables without the feature `tables`.
//!
//! All phases ask for the same two probabilities ([`crate::requirements`]). One pair of 36 takes 1.5 KB of flash, all take 26.

use super::table;
use crate::numeric::probability::Probability;
use crate::requirements;

/// Where the tables have the phases' probability of false alarm.
const ALARM: usize = 6;
const _: () = assert!(table::FALSE_ALARM[ALARM].get().to_bits() == requirements::FALSE_ALARM.get().to_bits());

/// Where they have that of missed detection.
const MISS: usize = 0;
const _: () =
    assert!(table::MISSED_DETECTION[MISS].get().to_bits() == requirements::MISSED_DETECTION.get().to_bits());

pub(super) static FALSE_ALARM: [Probability; 1] = [table::FALSE_ALARM[ALARM]];
pub(super) static MISSED_DETECTION: [Probability; 1] = [table::MISSED_DETECTION[MISS]];
pub(super) static TAU1: [[f64; 60]; 1] = [table::TAU1[ALARM]];
pub(super) static LAMBDA: [[[f64; 60]; 1]; 1] = [[table::LAMBDA[ALARM][MISS]]];
pub(super) static W_TEST: [[f64; 64]; 1] = [table::W_TEST[ALARM]];
