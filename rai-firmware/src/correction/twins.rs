//! One satellite under two numbers, told by its place.
//!
//! ```text
//! |r_i − r_j| < 2 km, both of one system        one satellite: neither number is used
//! ```
//!
//! It is unknown which number is right, and a range that counts twice outvotes others. Two
//! broadcasts of one orbit differ by metres. Real satellites of one system keep farther apart:
//! those of one plane by degrees, and two geostationary ones of `BeiDou` that share a slot (C01 and
//! C59 at 140° E) by more than 5 km, which is the distance that operators of shared slots count as
//! a close approach.

use super::horizon::coordinates_m;
use super::{CAPACITY, Sky};
use crate::counters::count;

/// Distance below which two satellites are one, m.
const ONE_M: f32 = 2e3;

/// Removes both of each two satellites that are one, and counts them.
#[inline(never)]
pub(super) fn remove_twins(sky: &mut Sky, counter: &mut u32) {
    // A number of single precision has steps of 4 m at the distance of a satellite.
    let mut places = [[0.0_f32; 3]; CAPACITY];
    for (place, located) in places.iter_mut().zip(sky.iter()) {
        *place = coordinates_m(located.position);
    }
    let mut doubled = 0_u64;
    for (index, (here, one)) in places.iter().zip(sky.iter()).enumerate() {
        for (other_index, (there, other)) in places.iter().zip(sky.iter()).enumerate().skip(index + 1) {
            let is_near = here.iter().zip(there).all(|(a, b)| (a - b).abs() < ONE_M);
            if is_near && one.satellite.constellation() == other.satellite.constellation() {
                doubled |= 1 << index | 1 << other_index;
            }
        }
    }
    remove(sky, doubled, counter);
}

/// Removes the satellites at these places of the sky, one bit each, and counts them.
pub(super) fn remove(sky: &mut Sky, mut places: u64, counter: &mut u32) {
    if places == 0 {
        return;
    }
    sky.retain(|_| {
        let is_removed = places & 1 != 0;
        places >>= 1;
        if is_removed {
            count(counter);
        }
        !is_removed
    });
}

const _: () = assert!(CAPACITY <= 64, "a bit for each satellite");
