//! The account of one satellite: what the judgement says of it.

use core::f64::consts::TAU;

use raim_core::frame::{Ecef, LocalFrame};
use raim_core::satellite::SatelliteId;

use super::{Fate, Judged};
use crate::navigator::Navigator;
use crate::raw::{RawSatellite, RawSignal};
use crate::time::GpsTime;

/// Account of one satellite of an epoch. Unknown values are `None`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Account {
    /// The satellite.
    pub satellite: SatelliteId,
    /// Angle from north over east, rad.
    pub azimuth_rad: Option<f64>,
    /// Angle above the horizon, rad.
    pub elevation_rad: Option<f64>,
    /// C/N0 of its strongest signal, dB-Hz.
    pub cn0_dbhz: Option<f64>,
    /// Range minus distance and receiver clock, m: positive for a range that is too long.
    pub residual_m: Option<f64>,
    /// Standard deviation of the range, m.
    pub sigma_m: Option<f64>,
    /// Residual over its standard deviation, dimensionless; `None` if nothing else tests the range.
    pub w_test: Option<f64>,
    /// Use of the satellite, or the reason why it is not used.
    pub fate: Fate,
}

impl Account {
    /// Returns the account of a satellite of which nothing else is known.
    pub const fn of(satellite: SatelliteId, fate: Fate) -> Self {
        Self {
            satellite,
            azimuth_rad: None,
            elevation_rad: None,
            cn0_dbhz: None,
            residual_m: None,
            sigma_m: None,
            w_test: None,
            fate,
        }
    }
}

impl<'e> Judged<'e> {
    /// Iterates over the satellites in the order of the receiver.
    pub fn accounts(&self) -> impl Iterator<Item = Account> + use<'e> {
        let Self { raw, navigator, .. } = *self;
        let solution = navigator.report().solution.as_ref();
        let place = solution.map(|solution| solution.position).or_else(|| navigator.place());
        let view = place.map(|place| (place, LocalFrame::at(place)));
        raw.satellites.iter().map(move |satellite| account(satellite, raw.time, navigator, view.as_ref()))
    }
}

/// Returns the account of a satellite, seen from a place with its local frame.
fn account(
    raw: &RawSatellite,
    time: GpsTime,
    navigator: &Navigator,
    view: Option<&(Ecef, LocalFrame)>,
) -> Account {
    let satellite = raw.satellite;
    let position = navigator.position_of(raw, time);
    let toward = view.zip(position).map(|((place, frame), position)| frame.rotate(position - *place));
    let cn0_dbhz = raw.signals.iter().filter_map(RawSignal::cn0_dbhz).map(f64::from).max_by(f64::total_cmp);
    let mut account = Account {
        azimuth_rad: toward.map(|toward| {
            let azimuth_rad = libm::atan2(toward.east, toward.north);
            if azimuth_rad < 0.0 { azimuth_rad + TAU } else { azimuth_rad }
        }),
        elevation_rad: toward.map(|toward| libm::atan2(toward.up, libm::hypot(toward.east, toward.north))),
        cn0_dbhz,
        ..Account::of(satellite, navigator.fate_of(satellite))
    };
    let observations = navigator.epoch().observations();
    let found = observations.iter().enumerate().find(|(_, one)| one.satellite == satellite);
    if let (Some((index, observation)), Some(solution)) = (found, &navigator.report().solution) {
        account.residual_m = solution.residual_m::<f64>(observation);
        account.sigma_m = Some(observation.sigma_m);
        account.w_test = navigator.w_test(index);
    }
    account
}
