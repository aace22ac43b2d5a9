//! Satellites of an epoch: their signals, and their places, from which directions are computed.
//!
//! Directions are computed only if an output needs them.

use core::fmt;

use raim_core::frame::{Ecef, LocalAxes};
use raim_core::satellite::SatelliteId;

use crate::raw::RawEpoch;

/// Places of the satellites of an epoch.
pub trait Places {
    /// Returns the place of a satellite when its signal left; `None` if it is unknown.
    fn place_of(&self, satellite: SatelliteId) -> Option<Ecef>;
}

/// Satellites of an epoch, used or not.
#[derive(Clone, Copy)]
pub struct InView<'r> {
    /// Signals of the epoch.
    pub raw: &'r RawEpoch,
    /// Places of the satellites.
    pub satellites: &'r dyn Places,
    /// Place of the receiver, accurate to some kilometres; `None` if it is unknown.
    pub place: Option<Ecef>,
}

// Not derived, because every image would then contain the formatting of every type behind `Places`.
impl fmt::Debug for InView<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("InView")
    }
}

/// Axes at the receiver. Single precision suffices, because a direction is reported in degrees.
#[cfg_attr(not(feature = "gsv"), allow(dead_code))]
pub(super) struct Horizon {
    place: Ecef,
    axes: [[f32; 3]; 3],
}

#[cfg_attr(not(feature = "gsv"), allow(dead_code))]
impl Horizon {
    pub(super) fn at(place: Ecef) -> Self {
        Self { place, axes: LocalAxes::at(place).east_north_up() }
    }

    /// Returns the components of the way to a point: east, north, up, m.
    pub(super) fn way_to(&self, point: Ecef) -> [f32; 3] {
        let way = point - self.place;
        let [x_m, y_m, z_m] = [way.x_m, way.y_m, way.z_m].map(|component_m| component_m as f32);
        self.axes.map(|[x, y, z]| x * x_m + y * y_m + z * z_m)
    }
}
