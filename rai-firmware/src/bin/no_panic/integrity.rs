//! Every public function of the integrity core.

use core::fmt::Display;
use core::ops::{Add, Sub};
use core::str::FromStr;

use raim_core::allocation::AllocationError;
use raim_core::clock::{self, Autoregression, Clocks, CoastingClock, Extrapolation};
use raim_core::continuity::{Continuity, ContinuityError, ContinuitySettings, Motion, Recovery};
use raim_core::epoch::{Epoch, EpochError, EpochView};
use raim_core::frame::{Ecef, Enu, Geodetic, LocalAxes, LocalFrame};
use raim_core::integrity::araim::{self, Allocation, AraimError, AraimScratch, Finding, Hypothesis};
use raim_core::integrity::raim::detection::threshold::policy::{
    self, NoThreshold, ThresholdProblem, Weights,
};
use raim_core::integrity::raim::detection::threshold::{self, ThresholdError, Thresholds};
use raim_core::integrity::raim::detection::{self, Detection};
use raim_core::integrity::raim::hypotheses::separability;
use raim_core::integrity::raim::isolation::baarda;
use raim_core::integrity::raim::isolation::exclusion;
use raim_core::integrity::raim::isolation::parity;
use raim_core::integrity::raim::isolation::ransac::{self, NoConsensus, Selection};
use raim_core::integrity::raim::levels::{self, Slopes};
use raim_core::integrity::raim::shared_errors;
use raim_core::integrity::{self, Method, MethodError, MethodScratch};
use raim_core::least_squares::downdate::{self, ExclusionSet, NormalisedRow};
use raim_core::least_squares::equations::{LinearEpoch, RowError};
use raim_core::least_squares::fix::{Fix, FixError};
use raim_core::least_squares::{Excludable, RowFit, Snapshot, SnapshotError, Workspace};
use raim_core::monitor::{EpochOutcome, Monitor, MonitorError, MonitorWorkspace, ValidatedRequirements};
use raim_core::numeric::absolute::{Absolute, Grid};
use raim_core::numeric::chi_square::ChiSquare;
use raim_core::numeric::normal;
use raim_core::numeric::probability::Probability;
use raim_core::numeric::real::Real;
use raim_core::numeric::{angle, bounds};
use raim_core::report::Solution;
use raim_core::requirements::{Requirements, RequirementsError};
use raim_core::satellite::{Constellation, ParseSatelliteError, SatelliteId};
use raim_core::single::{self, stages};
use raim_core::velocity::{self, RangeRate, Velocity, VelocityError};
use raim_core::weighting;
use raim_core::weighting::adaptation::Adaptation;
use raim_core::weighting::ionosphere::{self, IonosphereError};
use raim_firmware::correction::CAPACITY as N;

use crate::{exhaust, reach};

/// Reaches all functions that are generic over the precision, from the linearised epoch to the
/// verdict.
pub fn reach_all<T: Real>() {
    the_linearised_epoch::<T>();
    detection_and_protection::<T>();
    removals::<T>();
    identification_by_w_test::<T>();
    identification_in_parity_space::<T>();
    identification_by_consensus::<T>();
    separation_of_solutions::<T>();
    clocks::<T>();
    thresholds::<T>();
    velocity::<T>();
    the_pipeline::<T>();
}

fn the_linearised_epoch<T: Real>() {
    reach!(
        LinearEpoch::<T, N>::new as fn() -> _,
        <LinearEpoch<T, N> as Default>::default as fn() -> _,
        LinearEpoch::<T, N>::satellite as fn(_, _, _, _, _) -> _,
        LinearEpoch::<T, N>::clock as fn(_, _, _, _) -> _,
        LinearEpoch::<T, N>::height as fn(_, _, _) -> _,
        LinearEpoch::<T, N>::rows as fn(_) -> _,
        LinearEpoch::<T, N>::reference_m as fn(_, _) -> _,
        LinearEpoch::<T, N>::clear as fn(_),
        LinearEpoch::<T, N>::leave_out as fn(_, _),
        LinearEpoch::<T, N>::take_back as fn(_, _),
    );
    reach!(
        Workspace::<T, N>::of as fn(_) -> _,
        Workspace::<T, N>::equations as fn(_) -> _,
        Workspace::<T, N>::equations_mut as fn(_) -> _,
        Workspace::<T, N>::solve as fn(_) -> _,
        Workspace::<T, N>::copy_of as fn(_, _) -> _,
        Snapshot::<T>::leave_out as fn(_, _) -> _,
        Snapshot::<T>::take_back as fn(_, _) -> _,
        Snapshot::<T>::equations as fn(_) -> _,
        Snapshot::<T>::reference_m as fn(_, _) -> _,
        (|snapshot| exhaust(Snapshot::<T>::rows(snapshot))) as fn(&_),
        Snapshot::<T>::row as fn(_, _) -> _,
        Snapshot::<T>::fits as fn(_) -> _,
        Snapshot::<T>::correction as fn(_) -> _,
        Snapshot::<T>::covariance as fn(_) -> _,
        Snapshot::<T>::sse as fn(_) -> _,
        Snapshot::<T>::used as fn(_) -> _,
        Snapshot::<T>::dof as fn(_) -> _,
        Snapshot::<T>::determines as fn(_, _) -> _,
        Snapshot::<T>::clock_m as fn(_, _) -> _,
        Snapshot::<T>::clock_variance as fn(_, _) -> _,
        Snapshot::<T>::level_variance as fn(_, _) -> _,
        Snapshot::<T>::projection as fn(_, _, _) -> _,
        Snapshot::<T>::dilutions as fn(_) -> _,
        Snapshot::<T>::hdop_without as fn(_, _) -> _,
        <Snapshot<'_, T> as Excludable<T>>::snapshot as fn(_) -> _,
        <Snapshot<'_, T> as Excludable<T>>::leave_out as fn(_, _) -> _,
        <Snapshot<'_, T> as Excludable<T>>::take_back as fn(_, _) -> _,
        <Snapshot<'_, T> as Excludable<T>>::set_aside as fn(_, _) -> _,
        <Snapshot<'_, T> as Excludable<T>>::set_aside_all as fn(_, _) -> _,
    );
}

fn detection_and_protection<T: Real>() {
    reach!(
        detection::detect::<T> as fn(_, _) -> _,
        Detection::<T>::fault as fn(_) -> _,
        Detection::<T>::statistic as fn(_) -> _,
        levels::slopes::<T> as fn(_, _) -> _,
        levels::largest_slopes::<T> as fn(_) -> _,
        Slopes::<T>::protect as fn(_, _) -> _,
        levels::largest_hdop_change::<T> as fn(_) -> _,
        levels::PositionSigma::<T>::of as fn(_) -> _,
        shared_errors::shared_shift::<T> as fn(_, _) -> _,
        levels::KFactors::<T>::new as fn(_, _) -> _,
        levels::LevelInputs::<T>::of as fn(_, _, _) -> _,
        levels::LevelInputs::<T>::to_faults as fn(_) -> _,
        levels::LevelInputs::<T>::protect as fn(_, _) -> _,
        levels::LevelInputs::<T>::horizontal_noncentrality as fn(_, _) -> _,
        levels::LevelInputs::<T>::vertical_noncentrality as fn(_, _) -> _,
        Detection::<T>::of as fn(_, _, _) -> _,
        Detection::<T>::passes as fn(_, _) -> _,
    );
}

fn removals<T: Real>() {
    reach!(
        downdate::testable_rows::<T> as fn(_, _),
        NormalisedRow::<T>::projection as fn(_, _) -> _,
        ExclusionSet::<T>::none as fn() -> _,
        <ExclusionSet<T> as Default>::default as fn() -> _,
        ExclusionSet::<T>::of as fn(_, _) -> _,
        ExclusionSet::<T>::among as fn(_, _) -> _,
        ExclusionSet::<T>::and as fn(_, _) -> _,
        ExclusionSet::<T>::explains_more as fn(_, _) -> _,
        ExclusionSet::<T>::rows as fn(_) -> _,
        ExclusionSet::<T>::explained as fn(_) -> _,
        ExclusionSet::<T>::sse as fn(_, _) -> _,
        ExclusionSet::<T>::dof as fn(_, _) -> _,
        ExclusionSet::<T>::correction as fn(_, _) -> _,
        ExclusionSet::<T>::covariance as fn(_, _) -> _,
    );
}

fn identification_by_w_test<T: Real>() {
    reach!(
        RowFit::<T>::w_test as fn(_) -> _,
        RowFit::<T>::w_squared as fn(_) -> _,
        baarda::worst_two::<T> as fn(_) -> _,
        baarda::identify::<T> as fn(_, _) -> _,
        baarda::exclude_sequentially::<T> as fn(&mut Snapshot<'static, T>, _) -> _,
        baarda::exclude_sequentially::<T> as fn(&mut Fix<'static, T>, _) -> _,
        separability::separable::<T> as fn(&mut Snapshot<'static, T>, _, _) -> _,
        separability::separable::<T> as fn(&mut Fix<'static, T>, _, _) -> _,
        exclusion::Exclusion::<T>::passed as fn() -> _,
        exclusion::Exclusion::<T>::not_isolated as fn(_) -> _,
        exclusion::leave_out::<T> as fn(&mut Snapshot<'static, T>, _, _) -> _,
        exclusion::leave_out::<T> as fn(&mut Fix<'static, T>, _, _) -> _,
    );
}

fn identification_in_parity_space<T: Real>() {
    reach!(
        parity::correlation::<T> as fn(_, _) -> _,
        parity::correlation_threshold::<T> as fn(_, _) -> _,
        parity::simultaneous::<T> as fn(_, _, _) -> _,
        parity::sequential::<T> as fn(_, _, _) -> _,
        parity::hybrid_without_grouping::<T> as fn(_, _, _) -> _,
        parity::hybrid::<T> as fn(_, _, _) -> _,
        parity::grouping::<T> as fn(_, _, _) -> _,
        parity::exclude::<T> as fn(_, &mut Snapshot<'static, T>, _, _) -> _,
        parity::exclude::<T> as fn(_, &mut Fix<'static, T>, _, _) -> _,
    );
}

fn identification_by_consensus<T: Real>() {
    reach!(
        Selection::choose::<T> as fn(_, _) -> _,
        ransac::consensus::<T> as fn(_, _, _) -> _,
        ransac::refine::<T> as fn(_, _, _, _) -> _,
        ransac::exclude::<T> as fn(&mut Snapshot<'static, T>, _, _, _) -> _,
        ransac::exclude::<T> as fn(&mut Fix<'static, T>, _, _, _) -> _,
        ransac::exclude_in::<T> as fn(&mut Snapshot<'static, T>, _, _, _) -> _,
        ransac::exclude_in::<T> as fn(&mut Fix<'static, T>, _, _, _) -> _,
        ransac::Subsets::of::<T> as fn(_, _, _) -> _,
    );
}

fn separation_of_solutions<T: Real>() {
    reach!(
        araim::judge::<T> as fn(&mut Snapshot<'static, T>, _, _) -> _,
        araim::judge::<T> as fn(&mut Fix<'static, T>, _, _) -> _,
        araim::judge_in::<T> as fn(&mut Fix<'static, T>, _, _, _) -> _,
        AraimScratch::<T>::new as fn() -> _,
        <AraimScratch<T> as Default>::default as fn() -> _,
        <Snapshot<'_, T> as Excludable<T>>::leave_out_all as fn(_, _) -> _,
        <Snapshot<'_, T> as Excludable<T>>::take_back_all as fn(_, _),
        <Fix<'_, T> as Excludable<T>>::leave_out_all as fn(_, _) -> _,
        <Fix<'_, T> as Excludable<T>>::take_back_all as fn(_, _),
        Finding::<T>::hpl_m as fn(_) -> _,
        Finding::<T>::vpl_m as fn(_) -> _,
        normal::tail::<T> as fn(_) -> _,
        normal::quantile::<T> as fn(_) -> _,
    );
}

fn clocks<T: Real>() {
    reach!(
        Autoregression::<T>::white as fn() -> _,
        (|differences| Autoregression::<T>::fit(differences.iter().copied())) as fn(&[Option<T>]) -> _,
        Autoregression::<T>::coefficients as fn(_) -> _,
        Autoregression::<T>::variance as fn(_) -> _,
        Autoregression::<T>::rows as fn(_) -> _,
        Autoregression::<T>::extrapolate as fn(_, _) -> _,
        <Extrapolation<T> as Iterator>::next as fn(_) -> _,
        CoastingClock::<T>::new as fn() -> _,
        <CoastingClock<T> as Default>::default as fn() -> _,
        CoastingClock::<T>::restart as fn(_),
        CoastingClock::<T>::observe as fn(_, _, _, _) -> _,
        CoastingClock::<T>::forecast as fn(_, _) -> _,
        CoastingClock::<T>::last_time_s as fn(_) -> _,
        CoastingClock::<T>::process as fn(_) -> _,
    );
    reach!(
        Clocks::<T>::new as fn() -> _,
        <Clocks<T> as Default>::default as fn() -> _,
        Clocks::<T>::restart as fn(_),
        Clocks::<T>::of as fn(_, _) -> _,
        Clocks::<T>::aiding as fn(_, _) -> _,
        Clocks::<T>::learn as fn(_, _, _),
        clock::SolvedClocks::of::<T> as fn(_) -> _,
        clock::satellites_alone::<T> as fn(_, _) -> _,
    );
}

fn absolute_lengths() {
    reach!(
        angle::of_unit_vector as fn(_, _) -> _,
        angle::sine as fn(_) -> _,
        bounds::is_within as fn(_, _) -> _,
        <f64 as Absolute<f64>>::of as fn(_) -> _,
        <f64 as Absolute<f64>>::less as fn(_, _) -> _,
        <f64 as Absolute<f64>>::widen as fn(_) -> _,
        <f64 as Absolute<f64>>::narrow as fn(_) -> _,
        <f64 as Absolute<f64>>::vector as fn(_) -> _,
        <f64 as Absolute<f64>>::length as fn(_) -> _,
        Grid::of_multiple as fn(_, _) -> _,
        <Grid as Absolute<f32>>::of as fn(_) -> _,
        <Grid as Absolute<f32>>::less as fn(_, _) -> _,
        <Grid as Absolute<f32>>::widen as fn(_) -> _,
        <Grid as Absolute<f32>>::narrow as fn(_) -> _,
        <Grid as Absolute<f32>>::vector as fn(_) -> _,
        <Grid as Absolute<f32>>::length as fn(_) -> _,
    );
}

fn thresholds<T: Real>() {
    reach!(
        ChiSquare::<T>::new as fn(_) -> _,
        ChiSquare::<T>::quantile as fn(_, _, _) -> _,
        ChiSquare::<T>::noncentrality as fn(_, _, _) -> _,
        ChiSquare::<T>::crossing as fn(_, _, _) -> _,
        ThresholdProblem::new::<T> as fn(_, _, _, _) -> _,
        ThresholdProblem::threshold::<T> as fn(_, _) -> _,
        ThresholdProblem::decide::<T> as fn(_) -> _,
    );
}

fn velocity<T: Real>() {
    reach!(
        (|workspace, rates, thresholds, factors| {
            velocity::estimate::<T, N>(workspace, rates.iter().copied(), thresholds, factors)
        }) as fn(_, &[RangeRate<T>], _, _) -> _,
    );
}

fn the_pipeline<T: Real>() {
    reach!(
        Workspace::<T, N>::new as fn() -> _,
        <Workspace<T, N> as Default>::default as fn() -> _,
        Workspace::<T, N>::fix as fn(_, _, _) -> _,
        Fix::<T>::position as fn(_) -> _,
        Fix::<T>::snapshot as fn(_) -> _,
        <Fix<'_, T> as Excludable<T>>::snapshot as fn(_) -> _,
        <Fix<'_, T> as Excludable<T>>::leave_out as fn(_, _) -> _,
        <Fix<'_, T> as Excludable<T>>::take_back as fn(_, _) -> _,
        <Fix<'_, T> as Excludable<T>>::set_aside as fn(_, _) -> _,
        <Fix<'_, T> as Excludable<T>>::set_aside_all as fn(_, _) -> _,
        MonitorWorkspace::<T, N>::new as fn() -> _,
        <MonitorWorkspace<T, N> as Default>::default as fn() -> _,
        MonitorWorkspace::<T, N>::workspace as fn(_) -> _,
        MonitorWorkspace::<T, N>::outcome as fn(_) -> _,
        MonitorWorkspace::<T, N>::outcome_mut as fn(_) -> _,
        EpochOutcome::<N>::override_alert as fn(_, _),
        EpochOutcome::<N>::withdraw as fn(_, _),
        ValidatedRequirements::<T>::new as fn(_) -> _,
        ValidatedRequirements::<T>::thresholds as fn(_) -> _,
        ValidatedRequirements::<T>::factors as fn(_) -> _,
        Monitor::<T, N>::of as fn(_) -> _,
        Monitor::<T, N>::validated as fn(_) -> _,
        Monitor::<T, N>::new as fn(_) -> _,
        Monitor::<T, N>::set_requirements as fn(_, _) -> _,
        Monitor::<T, N>::set_strategy as fn(_, _) -> _,
        Monitor::<T, N>::forget_residuals as fn(_),
        Monitor::<T, N>::set_ism as fn(_, _),
        Monitor::<T, N>::ism as fn(_) -> _,
        Monitor::<T, N>::requirements as fn(_) -> _,
        Monitor::<T, N>::start as fn(_) -> _,
        Monitor::<T, N>::start_from as fn(_, _),
        Monitor::<T, N>::process as fn(_, _) -> _,
        Monitor::<T, N>::judge as fn(_, _, _, _, _, _) -> _,
        Monitor::<T, N>::learn as fn(_, _, _, _),
        Monitor::<T, N>::set_continuity as fn(_, _) -> _,
        Monitor::<T, N>::continuity_settings as fn(_) -> _,
        Monitor::<T, N>::disable_continuity as fn(_),
        Monitor::<T, N>::forget_position as fn(_),
        Monitor::<T, N>::interrupt as fn(_),
        Fix::<T>::clock_row as fn(_) -> _,
        MethodScratch::<T>::new as fn() -> _,
        <MethodScratch<T> as Default>::default as fn() -> _,
        integrity::judge::<T> as fn(&mut Snapshot<'static, T>, _, _, _, _, _, _) -> _,
        integrity::judge::<T> as fn(&mut Fix<'static, T>, _, _, _, _, _, _) -> _,
        integrity::Criteria::<T>::test as fn(_, _, _) -> _,
        integrity::Judgement::<T>::levels as fn(_) -> _,
    );
}

/// Reaches all functions with one precision only, or without arithmetic.
pub fn reach_what_has_no_precision() {
    as_a_module_runs_it();
    absolute_lengths();
    continuity();
    frames();
    requirements();
    epochs();
    tables();
    errors();
}

fn continuity() {
    reach!(
        Continuity::new as fn() -> _,
        <Continuity as Default>::default as fn() -> _,
        Continuity::forget as fn(_),
        Continuity::interrupt as fn(_),
        Continuity::conclude::<N> as fn(_, _, _, _, _, _) -> _,
        ContinuitySettings::anywhere as fn() -> _,
        ContinuitySettings::validate as fn(_) -> _,
        Recovery::is_met as fn(_, _, _, _) -> _,
        Velocity::is_within as fn(_, _) -> _,
        Velocity::speed_m_s as fn(_) -> _,
        Motion::new as fn() -> _,
        <Motion as Default>::default as fn() -> _,
        Motion::restart as fn(_),
        Motion::judge::<N> as fn(_, _, _, _) -> _,
    );
}

fn as_a_module_runs_it() {
    reach!(
        single::process as fn(_, _) -> _,
        single::judge as fn(_, _, _, _, _, _) -> _,
        single::velocity as fn(_, _, _, _) -> _,
        <VelocityError as Display>::fmt as fn(_, _) -> _,
        single::position as fn(_, _, _) -> _,
        single::solve as fn(_) -> _,
        stages::leave_out as fn(_, _) -> _,
        stages::take_back as fn(_, _) -> _,
        stages::worst_two as fn(_) -> _,
        stages::largest_slopes as fn(_) -> _,
        stages::grouping as fn(_, _, _) -> _,
        stages::choose as fn(_, _) -> _,
        stages::exclude_by_consensus as fn(_, _, _, _) -> _,
        stages::separate as fn(_, _, _, _) -> _,
        stages::observe as fn(_, _, _, _) -> _,
        stages::forecast as fn(_, _) -> _,
        stages::threshold as fn(_, _) -> _,
    );
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
        weighting::noise_factor_from_cn0 as fn(_) -> _,
        weighting::reflection_sigma_m as fn(_, _) -> _,
        IonosphereError::of as fn(_, _, _, _) -> _,
        IonosphereError::times as fn(_, _) -> _,
        IonosphereError::undivided as fn(_) -> _,
        ionosphere::obliquity as fn(_) -> _,
        weighting::integrity_sigma_m as fn(_, _, _) -> _,
        weighting::Ism::of as fn(_, _) -> _,
        weighting::Ism::is_valid as fn(_) -> _,
        weighting::IsmParameters::is_valid as fn(_) -> _,
        Adaptation::new as fn() -> _,
        <Adaptation as Default>::default as fn() -> _,
        Adaptation::restart as fn(_),
        Adaptation::learn as fn(_, _, _),
        Adaptation::scale as fn(_, _) -> _,
        Adaptation::sigma_m as fn(_, _, _, _) -> _,
        Epoch::<N>::new as fn(_) -> _,
        Epoch::<N>::restart as fn(_, _),
        Epoch::<N>::push as fn(_, _) -> _,
        Epoch::<N>::push_sharing as fn(_, _, _) -> _,
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
        Thresholds::from_rows as fn(_, _, _) -> _,
        Thresholds::tau1::<f32> as fn(_, _) -> _,
        Thresholds::lambda::<f32> as fn(_, _) -> _,
        Thresholds::w_test::<f32> as fn(_, _) -> _,
        Weights::new as fn(_, _) -> _,
        levels::noncentrality_at as fn(_, _) -> _,
        exclusion::leaves_enough as fn(_, _) -> _,
        raim_core::integrity::raim::isolation::sets::count_up_to as fn(_, _) -> _,
        policy::range_threshold_m as fn(_, _, _) -> _,
        parity::SearchLimits::published as fn() -> _,
        ransac::ConsensusLimits::published as fn() -> _,
        Selection::none as fn() -> _,
        ransac::Subsets::new as fn() -> _,
        Selection::subsets as fn(_) -> _,
        Selection::rows as fn(_) -> _,
        Selection::contains as fn(_, _, _) -> _,
        Selection::work as fn(_) -> _,
        Selection::cut as fn(_) -> _,
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
