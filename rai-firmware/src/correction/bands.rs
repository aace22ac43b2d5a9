//! Comparison of the two bands of a satellite with those of its system, before any position is
//! known.
//!
//! The ionosphere-free combination and the first band alone differ by the delay of the ionosphere
//! on that band, as these two ranges measure it:
//!
//! ```text
//! I_i = P_1 − P = (P_2 − P_1) / (f_1²/f_2² − 1)        D_i = I_i − median of I over the system
//! a fault if  D_i < −B  or  D_i > B + 35 m        B = 12 m / (f_1²/f_2² − 1) + 5 s
//! s = median of |D|
//! ```
//!
//! | part of the bound | covers |
//! |---|---|
//! | median over the system and the pair of bands | the receiver's own delay between the bands, tens of metres |
//! | 12 m of `P_2 − P_1` | a group delay that is not broadcast (ISC, 3 m), noise and multipath of both codes (3 m each, three sigmas) |
//! | `5 s` | the obliquity of the ionosphere, 1 to 3: half of the satellites are within 0.35 of the median, the lowest satellite is 1.6 above it; also noise that is larger than expected |
//! | 35 m, upwards only | a single low satellite behind the equatorial crest: 100 TECU (16 m) more than for the others, at an obliquity of 2.2. The lower bound does not need it, because no delay is below zero |
//!
//! It is unknown which band is wrong, so that neither is used. Fewer than [`LEAST`] satellites with
//! the same bands are not compared. If half of them are faulty, the median itself is wrong. A signal
//! below 24 dB-Hz is noisier than the bound allows for, and has a sigma that says so.

use heapless::Vec;
use raim_core::satellite::Constellation;

use super::choice::ionosphere_free;
use super::twins::remove;
use super::{CAPACITY, Located, Sky, difference_m};
use crate::median::{apart_m, median};
use crate::raw::Band;

/// Least number of satellites that are compared.
const LEAST: usize = 5;

/// Largest difference of the two ranges that is not caused by the ionosphere, m.
const FLOOR_M: f32 = 12.0;

/// Multiples of the median deviation.
const SPREADS: f32 = 5.0;

/// Largest ionospheric delay of a single satellite in excess of its system, m.
const CREST_M: f32 = 35.0;

/// Noise of a signal of 24 dB-Hz relative to that of a strong one.
const WEAKEST: f32 = 8.0;

/// Group of satellites that are compared: those of one system with the same two bands.
type Group = (Constellation, Band, Band);

/// Returns the group of a satellite.
fn group_of(located: &Located) -> Option<Group> {
    let (pair, single) = (located.choices.pair.as_ref()?, located.choices.single.as_ref()?);
    let (first, Some(second)) = pair.bands else { return None };
    (single.bands.0 == first && pair.weakness <= WEAKEST).then_some((
        located.satellite.constellation(),
        first,
        second,
    ))
}

/// Returns the delay of the ionosphere that the bands of a satellite measure, m.
fn delay_m(located: &Located) -> Option<f32> {
    let (pair, single) = (located.choices.pair.as_ref()?, located.choices.single.as_ref()?);
    Some(difference_m(single.range_m, pair.range_m))
}

/// Removes the satellites whose bands no ionosphere explains, and counts them.
#[inline(never)]
pub(super) fn remove_apart(sky: &mut Sky, counter: &mut u32) {
    let (mut apart, mut compared) = (0_u64, 0_u64);
    for (index, located) in sky.iter().enumerate() {
        if compared >> index & 1 != 0 {
            continue;
        }
        let Some(group) = group_of(located) else { continue };
        let (mut places, mut delays_m) = (Vec::<u8, CAPACITY>::new(), Vec::<f32, CAPACITY>::new());
        for (place, other) in sky.iter().enumerate().skip(index) {
            if group_of(other) == Some(group)
                && let Some(delay_m) = delay_m(other)
            {
                compared |= 1 << place;
                // This never fails: all lists have the capacity of the sky.
                let _ = (places.push(place as u8), delays_m.push(delay_m));
            }
        }
        if delays_m.len() >= LEAST {
            apart |= faults(&places, &delays_m, group);
        }
    }
    remove(sky, apart, counter);
}

/// Returns the satellites of a group that are beyond the bound, a bit each.
fn faults(places: &[u8], delays_m: &[f32], (_, first, second): Group) -> u64 {
    let scale = ionosphere_free(first, second).0 as f32 - 1.0;
    // Cheap test first: no delay is farther from the median than the delays are from each other.
    if apart_m(delays_m) <= FLOOR_M * scale {
        return 0;
    }
    let middle_m = median(delays_m);
    let deviations_m: Vec<f32, CAPACITY> =
        delays_m.iter().take(CAPACITY).map(|delay_m| (delay_m - middle_m).abs()).collect();
    let bound_m = FLOOR_M * scale + SPREADS * median(&deviations_m);
    let is_fault = |delay_m: f32| !(-bound_m..=bound_m + CREST_M).contains(&(delay_m - middle_m));
    let faulty = places.iter().zip(delays_m).filter(|(_, delay_m)| is_fault(**delay_m));
    faulty.fold(0, |faults, (place, _)| faults | 1_u64.checked_shl(u32::from(*place)).unwrap_or(0))
}
