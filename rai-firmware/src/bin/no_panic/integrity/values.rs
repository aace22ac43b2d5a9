//! Functions of the core's values: places, requirements, epochs, tables and errors.

use core::fmt::Display;
use core::ops::{Add, Sub};
use core::str::FromStr;

use raim_core::epoch::{Epoch, EpochError, EpochView};
use raim_core::frame::{Ecef, Enu, Geodetic, LocalAxes, LocalFrame};
use raim_core::internals::allocation::AllocationError;
use raim_core::internals::continuity::ContinuityError;
use raim_core::internals::integrity::araim::{Allocation, AraimError, Hypothesis};
use raim_core::internals::integrity::raim::detection::threshold::policy::{self, NoThreshold, Weights};
use raim_core::internals::integrity::raim::detection::threshold::{self, ThresholdError, Thresholds};
use raim_core::internals::integrity::raim::isolation::ransac::{self, NoConsensus, Selection};
use raim_core::internals::integrity::raim::isolation::{exclusion, parity};
use raim_core::internals::integrity::raim::levels;
use raim_core::internals::integrity::{Method, MethodError};
use raim_core::internals::least_squares::SnapshotError;
use raim_core::internals::least_squares::equations::RowError;
use raim_core::internals::least_squares::fix::FixError;
use raim_core::internals::numeric::probability::Probability;
use raim_core::internals::numeric::real::Real;
use raim_core::internals::weighting;
use raim_core::internals::weighting::adaptation::Adaptation;
use raim_core::internals::weighting::ionosphere::{self, IonosphereError};
use raim_core::monitor::MonitorError;
use raim_core::report::{ProtectionLevels, Report, Solution, Suspect, TestStatistic, Verdict};
use raim_core::requirements::{Requirements, RequirementsError};
use raim_core::satellite::{Constellation, ParseSatelliteError, SatelliteId};
use raim_firmware::correction::CAPACITY as N;

use crate::{exhaust, reach};

/// Reaches all functions of values without a precision.
pub(super) fn reach_all() {
    frames();
    requirements();
    epochs();
    tables();
    errors();
}

fn frames() {
    reach!(
        Ecef::new as fn(_, _, _) -> _,
        Ecef::radius_m as fn(_) -> _,
        Ecef::distance_m as fn(_, _) -> _,
        Ecef::is_finite as fn(_) -> _,
        <Ecef as Add>::add as fn(_, _) -> _,
        <Ecef as Sub>::sub as fn(_, _) -> _,
        Geodetic::to_ecef as fn(_) -> _,
        Enu::horizontal as fn(_) -> _,
        LocalFrame::at as fn(_) -> _,
        LocalFrame::geodetic as fn(_) -> _,
        LocalFrame::height_m as fn(_) -> _,
        LocalFrame::sin_latitude as fn(_) -> _,
        LocalFrame::rotate as fn(_, _) -> _,
        LocalFrame::unrotate as fn(_, _) -> _,
        LocalFrame::sin_elevation as fn(_, _, _) -> _,
        LocalAxes::at as fn(_) -> _,
        LocalAxes::east_north_up as fn(_) -> _,
        LocalAxes::height_m as fn(_) -> _,
        LocalAxes::sin_latitude as fn(_) -> _,
        LocalAxes::latitude_and_longitude_rad as fn(_) -> _,
    );
}

fn requirements() {
    reach!(
        Requirements::en_route as fn() -> _,
        Requirements::terminal as fn() -> _,
        Requirements::non_precision_approach as fn() -> _,
        Requirements::lpv200 as fn() -> _,
        Requirements::validate as fn(_) -> _,
        raim_core::report::ProtectionLevels::plus as fn(_, _) -> _,
        raim_core::report::ProtectionLevels::times as fn(_, _) -> _,
        raim_core::report::ProtectionLevels::or_larger as fn(_, _) -> _,
        Allocation::vertical_guidance as fn() -> _,
        Allocation::vertical as fn() -> _,
        Allocation::horizontal as fn() -> _,
        Allocation::integrity as fn(_) -> _,
        Allocation::validate as fn(_) -> _,
        (|hypothesis| exhaust(Hypothesis::rows(hypothesis))) as fn(_),
        Hypothesis::named as fn(_) -> _,
        Probability::new as fn(_) -> _,
        Probability::get as fn(_) -> _,
        levels::hdop_change_limit as fn(_, _, _) -> _,
        Solution::pdop as fn(_) -> _,
        Solution::at as fn(_, _) -> _,
        Solution::clock_m as fn(_, _) -> _,
        TestStatistic::new as fn(_, _, _) -> _,
        ProtectionLevels::new as fn(_, _) -> _,
        Suspect::new as fn(_, _, _, _) -> _,
        Report::<{ super::N }>::nothing as fn() -> _,
        Verdict::word as fn(_) -> _,
        Verdict::code as fn(_) -> _,
        Verdict::word_of as fn(_) -> _,
        (|| crate::exhaust(Verdict::all())) as fn(),
        Solution::residual_m::<f32> as fn(_, _) -> _,
        <f32 as Real>::narrow as fn(_) -> _,
        <f32 as Real>::widen as fn(_) -> _,
        <f32 as Real>::sqrt_approx as fn(_) -> _,
        <f32 as Real>::sine_and_cosine as fn(_) -> _,
        <f32 as Real>::inverse_sqrt_approx as fn(_) -> _,
        <f32 as Real>::normal_tail as fn(_) -> _,
        <f32 as Real>::normal_quantile as fn(_) -> _,
        <f64 as Real>::sqrt_approx as fn(_) -> _,
        <f64 as Real>::sine_and_cosine as fn(_) -> _,
        <f64 as Real>::inverse_sqrt_approx as fn(_) -> _,
        <f64 as Real>::normal_tail as fn(_) -> _,
        <f64 as Real>::normal_quantile as fn(_) -> _,
        <f64 as Real>::narrow as fn(_) -> _,
        <f64 as Real>::widen as fn(_) -> _,
    );
}

fn epochs() {
    reach!(
        Constellation::letter as fn(_) -> _,
        (|| crate::exhaust(Constellation::all())) as fn(),
        Constellation::from_letter as fn(_) -> _,
        SatelliteId::new as fn(_, _) -> _,
        SatelliteId::qzss as fn(_) -> _,
        SatelliteId::from_name as fn(_, _) -> _,
        SatelliteId::is_qzss as fn(_) -> _,
        SatelliteId::name as fn(_) -> _,
        SatelliteId::constellation as fn(_) -> _,
        SatelliteId::number as fn(_) -> _,
        weighting::ephemeris_sigma_m as fn(_, _) -> _,
        weighting::sigma_m as fn(_) -> _,
        weighting::sigma_with_m as fn(_, _) -> _,
        weighting::integrity_sigma_with_m as fn(_, _, _, _) -> _,
        weighting::ErrorBudget::receiver_m2 as fn(_) -> _,
        weighting::noise_factor_from_cn0 as fn(_) -> _,
        weighting::reflection_sigma_m as fn(_, _) -> _,
        IonosphereError::of as fn(_, _, _, _) -> _,
        IonosphereError::times as fn(_, _) -> _,
        IonosphereError::undivided as fn(_) -> _,
        ionosphere::obliquity as fn(_) -> _,
        weighting::integrity_sigma_m as fn(_, _, _) -> _,
        weighting::Ism::of as fn(_, _) -> _,
        weighting::Ism::with as fn(_, _, _) -> _,
        weighting::Ism::is_valid as fn(_) -> _,
        weighting::IsmParameters::is_valid as fn(_) -> _,
        Adaptation::new as fn() -> _,
        <Adaptation as Default>::default as fn() -> _,
        Adaptation::restart as fn(_),
        Adaptation::learn as fn(_, _, _),
        Adaptation::is_within as fn(_, _) -> _,
        Adaptation::noise as fn(_, _) -> _,
        Epoch::<N>::new as fn(_) -> _,
        Epoch::<N>::restart as fn(_, _),
        Epoch::<N>::push as fn(_, _) -> _,
        Epoch::<N>::push_sharing as fn(_, _, _) -> _,
        Epoch::<N>::set_receiver_m2 as fn(_, _),
        Epoch::<N>::change_noise as fn(_, _),
        Epoch::<N>::aid as fn(_, _) -> _,
        Epoch::<N>::view as fn(_) -> _,
        EpochView::time_s as fn(_) -> _,
        EpochView::observations as fn(_) -> _,
        EpochView::shared as fn(_) -> _,
        Epoch::<N>::time_s as fn(_) -> _,
        Epoch::<N>::observations as fn(_) -> _,
        Epoch::<N>::shared as fn(_) -> _,
        Epoch::<N>::aiding as fn(_) -> _,
    );
}

fn tables() {
    reach!(
        threshold::false_alarms as fn() -> _,
        threshold::missed_detections as fn() -> _,
        Thresholds::from_tables as fn(_, _) -> _,
        Thresholds::up_to::<N> as fn(_, _) -> _,
        Thresholds::from_rows as fn(_, _, _) -> _,
        Thresholds::tau1::<f32> as fn(_, _) -> _,
        Thresholds::lambda::<f32> as fn(_, _) -> _,
        Thresholds::w_test::<f32> as fn(_, _) -> _,
        Weights::new as fn(_, _) -> _,
        levels::noncentrality_at as fn(_, _) -> _,
        exclusion::leaves_enough as fn(_, _) -> _,
        raim_core::internals::integrity::raim::isolation::sets::count_up_to as fn(_, _) -> _,
        policy::range_threshold_m as fn(_, _, _) -> _,
        parity::SearchLimits::published as fn() -> _,
        ransac::ConsensusLimits::published as fn() -> _,
        Selection::<N>::none as fn() -> _,
        ransac::Subsets::<N>::new as fn() -> _,
        Selection::<N>::subsets as fn(_) -> _,
        Selection::<N>::rows as fn(_) -> _,
        Selection::<N>::contains as fn(_, _, _) -> _,
        Selection::<N>::work as fn(_) -> _,
        Selection::<N>::cut as fn(_) -> _,
    );
}

fn errors() {
    reach!(
        <ContinuityError as Display>::fmt as fn(_, _) -> _,
        <EpochError as Display>::fmt as fn(_, _) -> _,
        <FixError as Display>::fmt as fn(_, _) -> _,
        <MonitorError as Display>::fmt as fn(_, _) -> _,
        <MethodError as Display>::fmt as fn(_, _) -> _,
        Method::allows_aiding as fn(_) -> _,
        <RequirementsError as Display>::fmt as fn(_, _) -> _,
        <RowError as Display>::fmt as fn(_, _) -> _,
        <SatelliteId as Display>::fmt as fn(_, _) -> _,
        <AraimError as Display>::fmt as fn(_, _) -> _,
        <SnapshotError as Display>::fmt as fn(_, _) -> _,
        <ThresholdError as Display>::fmt as fn(_, _) -> _,
        <AllocationError as Display>::fmt as fn(_, _) -> _,
        <NoThreshold as Display>::fmt as fn(_, _) -> _,
        <NoConsensus as Display>::fmt as fn(_, _) -> _,
        <ParseSatelliteError as Display>::fmt as fn(_, _) -> _,
        <SatelliteId as FromStr>::from_str as fn(_) -> _,
    );
}
