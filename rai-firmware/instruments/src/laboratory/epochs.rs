//! Epochs in the format of the host: `time_s`, a count, and for each satellite constellation,
//! number, x, y, z, range, sigma.

use raim_core::epoch::{Epoch, Observation};
use raim_core::frame::Ecef;
use raim_core::satellite::{Constellation, SatelliteId};

use crate::request::Input;

/// Reads an epoch, or `None` if the bytes end. Observations that the core refuses are left out, as
/// in the module.
pub fn epoch<const N: usize>(input: &mut Input<'_>) -> Option<Epoch<N>> {
    let mut epoch = Epoch::new(input.double()?);
    for _ in 0..input.byte()? {
        let _ = epoch.push(observation(input)?);
    }
    Some(epoch)
}

/// Reads a point: x, y, z.
pub fn point(input: &mut Input<'_>) -> Option<Ecef> {
    Some(Ecef::new(input.double()?, input.double()?, input.double()?))
}

fn observation(input: &mut Input<'_>) -> Option<Observation> {
    let constellation = *Constellation::ALL.get(usize::from(input.byte()?))?;
    Some(Observation {
        satellite: SatelliteId::new(constellation, input.byte()?)?,
        position: point(input)?,
        range_m: input.double()?,
        sigma_m: input.double()?,
    })
}
