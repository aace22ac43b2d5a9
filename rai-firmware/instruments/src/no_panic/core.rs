//! The documented interface of the core.

use ::core::fmt::Display;
use ::core::ops::{Add, Sub};
use ::core::str::FromStr;

use raim_core::epoch::{Epoch, EpochError, EpochView};
use raim_core::frame::{Ecef, Geodetic, LocalFrame};
use raim_core::internals::numeric::real::Real;
use raim_core::monitor::{EpochOutcome, Monitor, MonitorError, MonitorMemory, ValidatedRequirements};
use raim_core::report::Solution;
use raim_core::requirements::{Requirements, RequirementsError};
use raim_core::satellite::{Constellation, ParseSatelliteError, SatelliteId};
use raim_firmware::correction::CAPACITY as N;

use crate::{exhaust, reach};

/// Reaches the monitor in one precision, and with it every method of every strategy.
pub fn monitor<T: Real>() {
    reach!(
        MonitorMemory::<T, N>::new as fn() -> _,
        <MonitorMemory<T, N> as Default>::default as fn() -> _,
        EpochOutcome::<N>::override_alert as fn(_, _),
        EpochOutcome::<N>::noise as fn(_) -> _,
        EpochOutcome::<N>::variance_ratio as fn(_) -> _,
        EpochOutcome::<N>::withdraw as fn(_, _),
        ValidatedRequirements::<T, N>::new as fn(_) -> _,
        ValidatedRequirements::<T, N>::thresholds as fn(_) -> _,
        ValidatedRequirements::<T, N>::factors as fn(_) -> _,
        Monitor::<T, N>::new as fn(_) -> _,
        Monitor::<T, N>::set_requirements as fn(_, _) -> _,
        Monitor::<T, N>::set_strategy as fn(_, _) -> _,
        Monitor::<T, N>::forget_residuals as fn(_),
        Monitor::<T, N>::change_kind as fn(_, _),
        Monitor::<T, N>::set_ism as fn(_, _),
        Monitor::<T, N>::ism as fn(_) -> _,
        Monitor::<T, N>::requirements as fn(_) -> _,
        Monitor::<T, N>::start as fn(_) -> _,
        Monitor::<T, N>::start_from as fn(_, _),
        Monitor::<T, N>::process as fn(_, _) -> _,
        Monitor::<T, N>::process_in as fn(_, _, _) -> _,
        Monitor::<T, N>::set_continuity as fn(_, _) -> _,
        Monitor::<T, N>::forget_position as fn(_),
        Monitor::<T, N>::interrupt as fn(_),
    );
}

/// Reaches the values that go in and come out.
pub fn values() {
    reach!(
        Ecef::new as fn(_, _, _) -> _,
        Ecef::radius_m as fn(_) -> _,
        Ecef::distance_m as fn(_, _) -> _,
        <Ecef as Add>::add as fn(_, _) -> _,
        <Ecef as Sub>::sub as fn(_, _) -> _,
        Geodetic::to_ecef as fn(_) -> _,
        LocalFrame::at as fn(_) -> _,
        LocalFrame::geodetic as fn(_) -> _,
        LocalFrame::rotate as fn(_, _) -> _,
        LocalFrame::unrotate as fn(_, _) -> _,
        Requirements::en_route as fn() -> _,
        Requirements::terminal as fn() -> _,
        Requirements::non_precision_approach as fn() -> _,
        Requirements::lpv200 as fn() -> _,
        Requirements::validate as fn(_) -> _,
        Solution::pdop as fn(_) -> _,
        Solution::clock_m as fn(_, _) -> _,
        Constellation::letter as fn(_) -> _,
        (|| exhaust(Constellation::all())) as fn(),
        SatelliteId::new as fn(_, _) -> _,
        SatelliteId::qzss as fn(_) -> _,
        SatelliteId::is_qzss as fn(_) -> _,
        SatelliteId::name as fn(_) -> _,
        SatelliteId::constellation as fn(_) -> _,
        SatelliteId::number as fn(_) -> _,
        Epoch::<N>::new as fn(_) -> _,
        Epoch::<N>::restart as fn(_, _),
        Epoch::<N>::push as fn(_, _) -> _,
        Epoch::<N>::push_sharing as fn(_, _, _) -> _,
        Epoch::<N>::aid as fn(_, _) -> _,
        EpochView::time_s as fn(_) -> _,
        EpochView::observations as fn(_) -> _,
        EpochView::shared as fn(_) -> _,
        Epoch::<N>::time_s as fn(_) -> _,
        Epoch::<N>::observations as fn(_) -> _,
        <EpochError as Display>::fmt as fn(_, _) -> _,
        <MonitorError as Display>::fmt as fn(_, _) -> _,
        <RequirementsError as Display>::fmt as fn(_, _) -> _,
        <SatelliteId as Display>::fmt as fn(_, _) -> _,
        <ParseSatelliteError as Display>::fmt as fn(_, _) -> _,
        <SatelliteId as FromStr>::from_str as fn(_) -> _,
    );
}
