//! Place of a fixed antenna as a value: four numbers, or none.

use super::Refusal;
use super::number::plain;
use super::read::{Values, next, next_number, number};
use super::value::{Ranges, Spelled, Take, Value, range};

/// Heights above the ellipsoid, m: from the deepest trench to below the satellites.
pub(super) const HEIGHT_M: (f64, f64) = (-12_000.0, 2_000_000.0);

/// Range of the standard deviation of a height or a place, m. Below, nothing is known so well;
/// above, it has no effect.
pub(super) const PLACE_SIGMA_M: (f64, f64) = (0.1, 1000.0);

/// Word for an antenna that may move.
const OFF: &str = "OFF";

/// Place of a fixed antenna.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Place {
    /// Latitude, degrees, north positive.
    pub latitude_deg: f64,
    /// Longitude, degrees, east positive.
    pub longitude_deg: f64,
    /// Height above the ellipsoid, m.
    pub height_m: f64,
    /// Standard deviation in each direction, m.
    pub sigma_m: f64,
}

impl Spelled for Option<Place> {
    const RANGES: usize = 4;
    const WORDS: &'static [&'static str] = &[OFF];
}

impl Value for Option<Place> {
    fn change(&mut self, values: Values<'_, '_>, ranges: &Ranges) -> Result<(), Refusal> {
        let first = next(values)?;
        *self = None;
        if first != OFF && !cfg!(feature = "aiding") {
            return Err(Refusal::NotInBuild);
        }
        if first != OFF {
            *self = Some(Place {
                latitude_deg: number(first, range(ranges, 0))?,
                longitude_deg: next_number(values, range(ranges, 1))?,
                height_m: next_number(values, range(ranges, 2))?,
                sigma_m: next_number(values, range(ranges, 3))?,
            });
        }
        Ok(())
    }

    fn say(&self, take: Take<'_>) {
        match self {
            Some(Place { latitude_deg, longitude_deg, height_m, sigma_m }) if cfg!(feature = "aiding") => {
                for value in [latitude_deg, longitude_deg, height_m, sigma_m] {
                    take(&plain(*value));
                }
            }
            _ => [OFF, "", "", ""].iter().for_each(|field| take(field)),
        }
    }

    fn tell(&self, take: Take<'_>) -> bool {
        if self.is_none() {
            take(OFF);
        }
        self.is_none()
    }
}
