//! Every public function of the integrity core.

mod values;

use core::fmt::Display;
use core::ops::{Add, Mul, Sub};

use raim_core::internals::clock::{self, Autoregression, Clocks, CoastingClock, Extrapolation};
use raim_core::internals::continuity::{Continuity, ContinuitySettings, Motion, Recovery};
use raim_core::internals::integrity::araim::{self, AraimScratch, Finding};
use raim_core::internals::integrity::raim::detection::threshold::policy::ThresholdProblem;
use raim_core::internals::integrity::raim::detection::{self, Detection};
use raim_core::internals::integrity::raim::exclusion_levels;
use raim_core::internals::integrity::raim::hypotheses::separability;
use raim_core::internals::integrity::raim::isolation::ransac::{self, Selection};
use raim_core::internals::integrity::raim::isolation::{baarda, exclusion, parity};
use raim_core::internals::integrity::raim::levels::{self, Slopes};
use raim_core::internals::integrity::raim::shared_errors;
use raim_core::internals::integrity::{self, MethodScratch};
use raim_core::internals::least_squares::downdate::{self, ExclusionSet, NormalisedRow};
use raim_core::internals::least_squares::equations::LinearEpoch;
use raim_core::internals::least_squares::fix::Fix;
use raim_core::internals::least_squares::{Excludable, RowFit, Snapshot, Workspace};
use raim_core::internals::numeric::absolute::{Absolute, Grid};
use raim_core::internals::numeric::chi_square::ChiSquare;
use raim_core::internals::numeric::four::{Apart, Four};
use raim_core::internals::numeric::real::Real;
use raim_core::internals::numeric::{angle, bounds, normal};
use raim_core::internals::velocity::{self, RangeRate, Velocity, VelocityError};
use raim_core::monitor::{EpochOutcome, Monitor, MonitorMemory, ValidatedRequirements};
use raim_firmware::correction::CAPACITY as N;
use raim_single::stages;

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
        Workspace::<T, N>::copy_of::<N> as fn(_, _) -> _,
        Snapshot::<T, N>::leave_out as fn(_, _) -> _,
        Snapshot::<T, N>::take_back as fn(_, _) -> _,
        Snapshot::<T, N>::equations as fn(_) -> _,
        Snapshot::<T, N>::reference_m as fn(_, _) -> _,
        (|snapshot| exhaust(Snapshot::<T, N>::rows(snapshot))) as fn(&_),
        Snapshot::<T, N>::row as fn(_, _) -> _,
        Snapshot::<T, N>::fits as fn(_) -> _,
        Snapshot::<T, N>::correction as fn(_) -> _,
        Snapshot::<T, N>::covariance as fn(_) -> _,
        Snapshot::<T, N>::sse as fn(_) -> _,
        Snapshot::<T, N>::used as fn(_) -> _,
        Snapshot::<T, N>::dof as fn(_) -> _,
        Snapshot::<T, N>::determines as fn(_, _) -> _,
        Snapshot::<T, N>::clock_m as fn(_, _) -> _,
        Snapshot::<T, N>::clock_variance as fn(_, _) -> _,
        Snapshot::<T, N>::level_variance as fn(_, _) -> _,
        Snapshot::<T, N>::projection as fn(_, _, _) -> _,
        Snapshot::<T, N>::dilutions as fn(_) -> _,
        Snapshot::<T, N>::hdop_without as fn(_, _) -> _,
        <Snapshot<'_, T, N> as Excludable<T, N>>::snapshot as fn(_) -> _,
        <Snapshot<'_, T, N> as Excludable<T, N>>::leave_out as fn(_, _) -> _,
        <Snapshot<'_, T, N> as Excludable<T, N>>::take_back as fn(_, _) -> _,
        <Snapshot<'_, T, N> as Excludable<T, N>>::set_aside as fn(_, _) -> _,
        <Snapshot<'_, T, N> as Excludable<T, N>>::set_aside_all as fn(_, _) -> _,
    );
}

fn detection_and_protection<T: Real>() {
    reach!(
        detection::detect::<T, N> as fn(_, _) -> _,
        Detection::<T>::fault as fn(_) -> _,
        Detection::<T>::statistic as fn(_) -> _,
        levels::slopes::<T> as fn(_, _) -> _,
        levels::largest_slopes::<T, N> as fn(_) -> _,
        Slopes::<T>::protect as fn(_, _) -> _,
        levels::largest_hdop_change::<T, N> as fn(_) -> _,
        levels::PositionSigma::<T>::of as fn(_) -> _,
        shared_errors::shared_shift::<T, N> as fn(_, _, _) -> _,
        levels::KFactors::<T>::new as fn(_, _) -> _,
        exclusion_levels::exclusion_levels::<T, N> as fn(_, _, _, _) -> _,
        levels::LevelInputs::<T>::of::<N> as fn(_, _, _) -> _,
        levels::LevelInputs::<T>::to_faults as fn(_) -> _,
        levels::LevelInputs::<T>::protect as fn(_, _) -> _,
        levels::LevelInputs::<T>::horizontal_noncentrality as fn(_, _) -> _,
        levels::LevelInputs::<T>::vertical_noncentrality as fn(_, _) -> _,
        Detection::<T>::of as fn(_, _, _) -> _,
        Detection::<T>::passes::<N> as fn(_, _) -> _,
    );
}

fn removals<T: Real>() {
    reach!(
        downdate::testable_rows::<T, N> as fn(_, _),
        NormalisedRow::<T>::projection as fn(_, _) -> _,
        ExclusionSet::<T>::none as fn() -> _,
        <ExclusionSet<T> as Default>::default as fn() -> _,
        ExclusionSet::<T>::of::<N> as fn(_, _) -> _,
        ExclusionSet::<T>::among as fn(_, _) -> _,
        ExclusionSet::<T>::and as fn(_, _) -> _,
        ExclusionSet::<T>::explains_more as fn(_, _) -> _,
        ExclusionSet::<T>::rows as fn(_) -> _,
        ExclusionSet::<T>::explained as fn(_) -> _,
        ExclusionSet::<T>::sse as fn(_, _) -> _,
        ExclusionSet::<T>::dof::<N> as fn(_, _) -> _,
        ExclusionSet::<T>::correction::<N> as fn(_, _) -> _,
        ExclusionSet::<T>::covariance::<N> as fn(_, _) -> _,
    );
}

fn identification_by_w_test<T: Real>() {
    reach!(
        RowFit::<T>::w_test as fn(_) -> _,
        RowFit::<T>::w_squared as fn(_) -> _,
        baarda::worst_two::<T, N> as fn(_) -> _,
        baarda::identify::<T, N> as fn(_, _) -> _,
        baarda::exclude_sequentially::<T, N> as fn(&mut Snapshot<'static, T, N>, _) -> _,
        baarda::exclude_sequentially::<T, N> as fn(&mut Fix<'static, T, N>, _) -> _,
        separability::separable::<T, N> as fn(&mut Snapshot<'static, T, N>, _, _) -> _,
        separability::separable::<T, N> as fn(&mut Fix<'static, T, N>, _, _) -> _,
        exclusion::Exclusion::<T>::passed as fn() -> _,
        exclusion::Exclusion::<T>::not_isolated as fn(_) -> _,
        exclusion::leave_out::<T, N> as fn(&mut Snapshot<'static, T, N>, _, _) -> _,
        exclusion::leave_out::<T, N> as fn(&mut Fix<'static, T, N>, _, _) -> _,
    );
}

fn identification_in_parity_space<T: Real>() {
    reach!(
        parity::correlation::<T, N> as fn(_, _) -> _,
        parity::correlation_threshold::<T> as fn(_, _) -> _,
        parity::simultaneous::<T, N> as fn(_, _, _) -> _,
        parity::sequential::<T, N> as fn(_, _, _) -> _,
        parity::hybrid_without_grouping::<T, N> as fn(_, _, _) -> _,
        parity::hybrid::<T, N> as fn(_, _, _) -> _,
        parity::grouping::<T, N> as fn(_, _, _) -> _,
        parity::exclude::<T, N> as fn(_, &mut Snapshot<'static, T, N>, _, _) -> _,
        parity::exclude::<T, N> as fn(_, &mut Fix<'static, T, N>, _, _) -> _,
    );
}

fn identification_by_consensus<T: Real>() {
    reach!(
        Selection::<N>::choose::<T> as fn(_, _) -> _,
        ransac::consensus::<T, N> as fn(_, _, _) -> _,
        ransac::refine::<T, N> as fn(_, _, _, _) -> _,
        ransac::exclude::<T, N> as fn(&mut Snapshot<'static, T, N>, _, _, _) -> _,
        ransac::exclude::<T, N> as fn(&mut Fix<'static, T, N>, _, _, _) -> _,
        ransac::exclude_in::<T, N> as fn(&mut Snapshot<'static, T, N>, _, _, _) -> _,
        ransac::exclude_in::<T, N> as fn(&mut Fix<'static, T, N>, _, _, _) -> _,
        ransac::Subsets::<N>::of::<T> as fn(_, _, _) -> _,
    );
}

fn separation_of_solutions<T: Real>() {
    reach!(
        araim::judge::<T, N> as fn(&mut Snapshot<'static, T, N>, _, _) -> _,
        araim::judge::<T, N> as fn(&mut Fix<'static, T, N>, _, _) -> _,
        araim::judge_in::<T, N> as fn(&mut Fix<'static, T, N>, _, _, _) -> _,
        AraimScratch::<T, N>::new as fn() -> _,
        <AraimScratch<T, N> as Default>::default as fn() -> _,
        <Snapshot<'_, T, N> as Excludable<T, N>>::leave_out_all as fn(_, _) -> _,
        <Snapshot<'_, T, N> as Excludable<T, N>>::take_back_all as fn(_, _),
        <Fix<'_, T, N> as Excludable<T, N>>::leave_out_all as fn(_, _) -> _,
        <Fix<'_, T, N> as Excludable<T, N>>::take_back_all as fn(_, _),
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
        clock::SolvedClocks::of::<T, N> as fn(_) -> _,
        clock::satellites_alone::<T, N> as fn(_, _) -> _,
    );
}

fn absolute_lengths() {
    reach!(
        angle::of_unit_vector as fn(_, _) -> _,
        angle::sine as fn(_) -> _,
        bounds::is_within as fn(_, _) -> _,
        <f64 as Absolute<f64>>::of as fn(_) -> _,
        <f64 as Absolute<f64>>::of_admitted as fn(_) -> _,
        <f64 as Absolute<f64>>::less as fn(_, _) -> _,
        <f64 as Absolute<f64>>::widen as fn(_) -> _,
        <f64 as Absolute<f64>>::narrow as fn(_) -> _,
        <f64 as Absolute<f64>>::units as fn(_) -> _,
        <f64 as Absolute<f64>>::vector as fn(_) -> _,
        <f64 as Absolute<f64>>::length as fn(_) -> _,
        Grid::of_multiple as fn(_, _) -> _,
        <Grid as Absolute<f32>>::of as fn(_) -> _,
        <Grid as Absolute<f32>>::of_admitted as fn(_) -> _,
        <Grid as Absolute<f32>>::less as fn(_, _) -> _,
        <Grid as Absolute<f32>>::widen as fn(_) -> _,
        <Grid as Absolute<f32>>::narrow as fn(_) -> _,
        <Grid as Absolute<f32>>::units as fn(_) -> _,
        <Grid as Absolute<f32>>::vector as fn(_) -> _,
        <Grid as Absolute<f32>>::length as fn(_) -> _,
    );
}

fn four_numbers() {
    reach!(
        <Apart<f32> as Four<f32>>::join as fn(_) -> _,
        <Apart<f32> as Four<f32>>::repeat as fn(_) -> _,
        <Apart<f32> as Four<f32>>::numbers as fn(_) -> _,
        <Apart<f32> as Four<f32>>::magnitudes as fn(_) -> _,
        <Apart<f32> as Add>::add as fn(_, _) -> _,
        <Apart<f32> as Sub>::sub as fn(_, _) -> _,
        <Apart<f32> as Mul>::mul as fn(_, _) -> _,
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
        Fix::<T, N>::position as fn(_) -> _,
        Fix::<T, N>::snapshot as fn(_) -> _,
        <Fix<'_, T, N> as Excludable<T, N>>::snapshot as fn(_) -> _,
        <Fix<'_, T, N> as Excludable<T, N>>::leave_out as fn(_, _) -> _,
        <Fix<'_, T, N> as Excludable<T, N>>::take_back as fn(_, _) -> _,
        <Fix<'_, T, N> as Excludable<T, N>>::set_aside as fn(_, _) -> _,
        <Fix<'_, T, N> as Excludable<T, N>>::set_aside_all as fn(_, _) -> _,
        MonitorMemory::<T, N>::new as fn() -> _,
        <MonitorMemory<T, N> as Default>::default as fn() -> _,
        MonitorMemory::<T, N>::workspace as fn(_) -> _,
        MonitorMemory::<T, N>::outcome as fn(_) -> _,
        MonitorMemory::<T, N>::outcome_mut as fn(_) -> _,
        EpochOutcome::<N>::override_alert as fn(_, _),
        EpochOutcome::<N>::noise as fn(_) -> _,
        EpochOutcome::<N>::withdraw as fn(_, _),
        ValidatedRequirements::<T, N>::new as fn(_) -> _,
        ValidatedRequirements::<T, N>::thresholds as fn(_) -> _,
        ValidatedRequirements::<T, N>::factors as fn(_) -> _,
        Monitor::<T, N>::of as fn(_) -> _,
        Monitor::<T, N>::validated as fn(_) -> _,
        Monitor::<T, N>::new as fn(_) -> _,
        Monitor::<T, N>::set_requirements as fn(_, _) -> _,
        Monitor::<T, N>::set_strategy as fn(_, _) -> _,
        Monitor::<T, N>::forget_residuals as fn(_),
        Monitor::<T, N>::noise as fn(_, _) -> _,
        Monitor::<T, N>::levels as fn(_, _, _, _, _) -> _,
        Monitor::<T, N>::fault_free as fn(_, _, _, _, _) -> _,
        Monitor::<T, N>::adaptation_mut as fn(_) -> _,
        Monitor::<T, N>::set_ism as fn(_, _),
        Monitor::<T, N>::ism as fn(_) -> _,
        Monitor::<T, N>::requirements as fn(_) -> _,
        Monitor::<T, N>::start as fn(_) -> _,
        Monitor::<T, N>::start_from as fn(_, _),
        Monitor::<T, N>::process as fn(_, _) -> _,
        Monitor::<T, N>::process_in as fn(_, _, _) -> _,
        Monitor::<T, N>::judge as fn(_, _, _, _, _, _) -> _,
        Monitor::<T, N>::learn as fn(_, _, _, _),
        Monitor::<T, N>::set_continuity as fn(_, _) -> _,
        Monitor::<T, N>::continuity_settings as fn(_) -> _,
        Monitor::<T, N>::disable_continuity as fn(_),
        Monitor::<T, N>::forget_position as fn(_),
        Monitor::<T, N>::interrupt as fn(_),
        Fix::<T, N>::clock_row as fn(_) -> _,
        MethodScratch::<T, N>::new as fn() -> _,
        <MethodScratch<T, N> as Default>::default as fn() -> _,
        integrity::judge::<T, N> as fn(&mut Snapshot<'static, T, N>, _, _, _, _, _, _) -> _,
        integrity::judge::<T, N> as fn(&mut Fix<'static, T, N>, _, _, _, _, _, _) -> _,
        integrity::Criteria::<T>::test::<N> as fn(_, _, _) -> _,
        integrity::Judgement::<T>::levels as fn(_) -> _,
    );
}

/// Reaches all functions with one precision only, or without arithmetic.
pub fn reach_what_has_no_precision() {
    as_a_module_runs_it();
    absolute_lengths();
    four_numbers();
    continuity();
    values::reach_all();
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
        Velocity::zero as fn(_, _) -> _,
        Velocity::speed_m_s as fn(_) -> _,
        Motion::new as fn() -> _,
        <Motion as Default>::default as fn() -> _,
        Motion::restart as fn(_),
        Motion::judge::<N> as fn(_, _, _, _) -> _,
    );
}

fn as_a_module_runs_it() {
    reach!(
        raim_single::process as fn(_, _) -> _,
        raim_single::judge as fn(_, _, _, _, _, _) -> _,
        raim_single::velocity as fn(_, _, _, _) -> _,
        <VelocityError as Display>::fmt as fn(_, _) -> _,
        raim_single::position as fn(_, _, _) -> _,
        raim_single::levels as fn(_, _, _, _, _) -> _,
        raim_single::solve as fn(_) -> _,
        stages::process_in as fn(_, _, _) -> _,
        stages::process_sixteen_in as fn(_, _, _) -> _,
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
