//! Detection of one satellite under two numbers, by its place.
//!
//! ```text
//! |r_i − r_j| < 2 km, both of one system        one satellite: neither number is used
//! ```
//!
//! It is unknown which number is right, and a range that counts twice outvotes others. Two
//! broadcasts of one orbit differ by metres. Real satellites of one system are farther apart. In
//! one plane they are degrees apart. The geostationary satellites C01 and C59 of `BeiDou` share a
//! slot at 140° E and stay more than 5 km apart. Operators of shared slots count less as a close
//! approach.

use heapless::Vec;

use super::{CAPACITY, Located, Sky};
use crate::counters::count;

/// Distance below which two satellites are one, m.
const ONE_M: f32 = 2e3;

/// Removes both numbers of each satellite that appears under two, and counts them.
#[inline(never)]
pub(super) fn remove_twins(sky: &mut Sky, counter: &mut u32) {
    // Single precision suffices: its steps are at most 4 m at the distance of a satellite.
    let mut places = Vec::<[f32; 3], CAPACITY>::new();
    for located in sky.iter() {
        // Both lists have the same capacity, so that this never fails.
        let _ = places.push(located.coordinates_m());
    }
    let mut doubled = 0_u64;
    for (index, here) in places.iter().enumerate() {
        let [x_m, ..] = *here;
        let others = places.get(index + 1..).unwrap_or_default();
        for (other_index, there) in others.iter().enumerate() {
            // One coordinate already tells nearly every pair apart.
            if (x_m - there[0]).abs() < ONE_M
                && is_one(here, there)
                && is_of_one_system(sky, index, index + 1 + other_index)
            {
                doubled |= 1 << index | 1 << (index + 1 + other_index);
            }
        }
    }
    remove(sky, doubled, counter);
}

/// Returns true if two places are near each other in every coordinate.
fn is_one(here: &[f32; 3], there: &[f32; 3]) -> bool {
    here.iter().zip(there).all(|(a, b)| (a - b).abs() < ONE_M)
}

/// Returns true if the satellites at two places of the sky are of one system.
fn is_of_one_system(sky: &Sky, one: usize, other: usize) -> bool {
    let system = |index| sky.get(index).map(|located: &Located| located.satellite.constellation());
    system(one) == system(other)
}

/// Removes the satellites at these places of the sky, one bit each, and counts them.
pub(crate) fn remove(sky: &mut Sky, mut places: u64, counter: &mut u32) {
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
