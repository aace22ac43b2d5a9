//! The instance that a microcontroller runs: it finds what was put there, and is the generic code to the last bit.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use rai_core::clock::{CoastingClock, Uptake};
use rai_core::epoch::Epoch;
use rai_core::equations::LinearEpoch;
use rai_core::fix::Workspace;
use rai_core::frame::{Ecef, LocalFrame};
use rai_core::integrity::residuals::baarda;
use rai_core::integrity::residuals::exclusion::Outcome;
use rai_core::integrity::residuals::levels;
use rai_core::integrity::residuals::parity;
use rai_core::integrity::residuals::ransac::{self, MAX_WORK, Selection};
use rai_core::integrity::residuals::threshold::policy::{Demand, Policy};
use rai_core::integrity::residuals::threshold::{Thresholds, false_alarms, missed_detections};
use rai_core::monitor::Monitor;
use rai_core::report::{Protected, Verdict};
use rai_core::requirements::Requirements;
use rai_core::satellite::Constellation;
use rai_core::single::{self, CAPACITY};
use rai_core::snapshot::Snapshot;
use sky::{observe, receiver, satellite};

mod sky;

/// Azimuth and elevation in degrees.
const DIRECTIONS: [(f64, f64); 10] = [
    (0.0, 80.0),
    (30.0, 25.0),
    (150.0, 30.0),
    (270.0, 20.0),
    (100.0, 50.0),
    (210.0, 45.0),
    (330.0, 40.0),
    (60.0, 15.0),
    (240.0, 70.0),
    (185.0, 12.0),
];
const FAULTY: usize = 3;
const BIAS_M: f64 = 200.0;

/// Ten satellites, the fourth of them wrong by so much.
fn epoch(bias_m: f64) -> Epoch<CAPACITY> {
    let mut epoch = Epoch::new(0.0);
    for (index, direction) in DIRECTIONS.into_iter().enumerate() {
        let mut observation = observe(satellite(Constellation::Gps, index + 1), direction, 1e5);
        observation.range_m += if index == FAULTY { bias_m } else { 0.0 };
        epoch.push(observation).unwrap();
    }
    epoch
}

/// The same about the receiver.
fn linear(bias_m: f64) -> LinearEpoch<f32, CAPACITY> {
    let frame = LocalFrame::at(receiver());
    let mut linear = LinearEpoch::default();
    for (index, observation) in epoch(0.0).observations().iter().enumerate() {
        let sight = frame.rotate(observation.position - receiver());
        let direction = nalgebra::Vector3::new(sight.east, sight.north, sight.up).normalize();
        let residual_m = if index == FAULTY { bias_m } else { 0.0 };
        linear.satellite(Constellation::Gps, direction, residual_m, observation.sigma_m).unwrap();
    }
    linear
}

fn thresholds() -> Thresholds<'static> {
    let (false_alarm, missed) = (false_alarms().last().unwrap(), missed_detections().first().unwrap());
    Thresholds::from_tables(*false_alarm, *missed).unwrap()
}

#[test]
fn position_is_where_the_receiver_is() {
    let position = single::position(&epoch(0.0), Ecef::CENTRE).unwrap();
    assert!(position.distance_m(receiver()) < 0.1, "{} m", position.distance_m(receiver()));
    assert!(single::position(&Epoch::new(0.0), Ecef::CENTRE).is_none(), "an empty epoch");

    let epoch = epoch(0.0);
    let mut room = Workspace::<f32, CAPACITY>::default();
    let fix = room.fix(&epoch, Ecef::CENTRE).unwrap();
    assert_eq!(fix.position(), position);
    assert!((LocalFrame::at(fix.position()).height_m() - 150.0).abs() < 0.1);
}

#[test]
fn faulty_satellite_is_left_out_as_by_the_generic_monitor() {
    let requirements = Requirements::non_precision_approach();
    let mut monitor = single::Monitor::new(requirements).unwrap();
    let have = single::process(&mut monitor, &epoch(BIAS_M));
    assert_eq!(have.verdict, Verdict::Protected(Protected::Excluded));
    let named = have.excluded.iter().map(|suspect| suspect.satellite);
    assert!(named.eq([satellite(Constellation::Gps, FAULTY + 1)]));
    let want = Monitor::<f32, CAPACITY>::new(requirements).unwrap().process(&epoch(BIAS_M));
    assert_eq!(have, want);
}

#[test]
fn fault_is_the_worst_row_and_leaves_with_it() {
    let mut snapshot = single::solve(linear(BIAS_M)).unwrap();
    let (worst, squared, _) = single::worst_two(&snapshot).unwrap();
    let (_, fit) = snapshot.row(worst).unwrap();
    assert_eq!(worst, FAULTY);
    assert!((squared.sqrt() - fit.w_test().abs()).abs() < 1e-3 * squared.sqrt());
    assert_eq!(single::worst_two(&snapshot), baarda::worst_two(&snapshot));
    assert_eq!(single::largest_slopes(&snapshot), levels::largest_slopes(&snapshot));

    let faulty = snapshot.sse();
    single::leave_out(&mut snapshot, FAULTY).unwrap();
    assert!(snapshot.sse() < 1e-6, "what is left agrees: {}", snapshot.sse());
    single::take_back(&mut snapshot, FAULTY).unwrap();
    assert_eq!(snapshot.sse().to_bits(), faulty.to_bits());
}

#[test]
fn searches_name_the_fault() {
    let snapshot = Snapshot::solve(linear(BIAS_M)).unwrap();
    let limits = parity::SearchLimits::published();
    let found = single::grouping(&snapshot, &thresholds(), &limits);
    let named = found.set.as_ref().unwrap().rows().iter().map(|row| row.index);
    assert!(named.eq([FAULTY]), "{found:?}");
    assert_eq!(found, parity::grouping(&snapshot, &thresholds(), &limits));

    let selection = single::choose(snapshot.epoch(), MAX_WORK);
    assert_eq!(selection, Selection::choose(snapshot.epoch(), MAX_WORK));
    let limits = ransac::ConsensusLimits::published().unwrap();
    let mut voted = snapshot.clone();
    let exclusion = single::exclude_by_consensus(&mut voted, &selection, &thresholds(), &limits);
    assert_eq!(exclusion.outcome, Outcome::Isolated);
    assert!(exclusion.rows.iter().map(|excluded| excluded.index).eq([FAULTY]));
}

/// A clock that drifts by 30 m a second without noise is forecast where it will be.
#[test]
fn clock_is_forecast_along_its_drift() {
    let mut clock = CoastingClock::<f32>::default();
    for second in 0..60 {
        let time_s = f64::from(second);
        let want = if second == 0 { Uptake::Restarted } else { Uptake::Continued };
        assert_eq!(single::observe(&mut clock, time_s, 1e5 + 30.0 * time_s, 1.0), want, "second {second}");
    }
    let forecast = single::forecast(&clock, 60.0).unwrap();
    assert!((forecast.value_m - (1e5 + 30.0 * 60.0)).abs() < 1e-3, "{forecast:?}");
}

/// T1 is the table's threshold, and the others are larger while the limit leaves room.
#[test]
fn thresholds_are_in_their_order() {
    let snapshot = single::solve(linear(0.0)).unwrap();
    let slopes = single::largest_slopes(&snapshot);
    let requirements = Requirements::non_precision_approach();
    let demand = Demand::new(snapshot.dof(), slopes, &requirements, thresholds());
    let [t1, optimal, t2] =
        [Policy::T1, Policy::TOp, Policy::T2].map(|policy| single::threshold(&demand, policy).unwrap().tau);
    assert_eq!(Some(t1), thresholds().tau1(snapshot.dof()));
    assert!(t1 < optimal && optimal < t2, "{t1} {optimal} {t2}");
}
