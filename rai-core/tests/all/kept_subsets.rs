//! The subsets of range consensus belong to the satellites: kept while these stay, with any aiding
//! rows.
#![allow(clippy::unwrap_used)]

use raim_core::epoch::{Aiding, Epoch};
use raim_core::internals::integrity::raim::isolation::ransac::{MAX_WORK, Selection, Subsets};
use raim_core::internals::least_squares::Workspace;
use raim_core::satellite::Constellation;

use crate::sky::{CAPACITY, observe, receiver, satellite};

/// Returns sixteen satellites, numbered from one on; `turned_deg` turns the sky about the zenith.
fn epoch(first: usize, turned_deg: f64) -> Epoch<CAPACITY> {
    let mut epoch = Epoch::new(0.0);
    for index in 0..16_u8 {
        let (azimuth_deg, elevation_deg) = (137.5 * f64::from(index), 12.0 + 4.5 * f64::from(index));
        let id = satellite(Constellation::Gps, first + usize::from(index));
        epoch.push(observe(id, (azimuth_deg + turned_deg, elevation_deg), 1e5)).unwrap();
    }
    epoch
}

/// Returns the content of `subsets` after an epoch.
fn asked(subsets: &mut Subsets, epoch: &Epoch<CAPACITY>) -> Selection {
    let mut workspace = Workspace::<f32, CAPACITY>::new();
    let fix = workspace.fix(epoch, receiver()).unwrap();
    subsets.of(&epoch.view(), fix.snapshot().equations()).clone()
}

/// Returns the subsets for an epoch by itself.
fn dealt(epoch: &Epoch<CAPACITY>) -> Selection {
    let mut workspace = Workspace::<f32, CAPACITY>::new();
    let fix = workspace.fix(epoch, receiver()).unwrap();
    Selection::choose(fix.snapshot().equations(), MAX_WORK)
}

#[test]
fn they_are_those_of_the_epoch_that_asked_first() {
    let mut subsets = Subsets::new();
    let have = asked(&mut subsets, &epoch(1, 0.0));
    assert_eq!(have, dealt(&epoch(1, 0.0)));
    assert_eq!((have.rows(), have.subsets()), (16, 4));
    // Another geometry of the same satellites is dealt otherwise; the kept subsets stay.
    let mut other = epoch(1, 0.0);
    other.restart(1.0);
    for (place, observation) in
        epoch(1, 0.0).observations().iter().zip(epoch(1, 0.0).observations().iter().rev())
    {
        let id = place.satellite;
        other.push(raim_core::epoch::Observation { satellite: id, ..*observation }).unwrap();
    }
    assert_ne!(dealt(&other), have);
    assert_eq!(asked(&mut subsets, &other), have);
}

#[test]
fn a_known_height_beside_the_satellites_changes_nothing() {
    let mut subsets = Subsets::new();
    let have = asked(&mut subsets, &epoch(1, 0.0));
    let mut aided = epoch(1, 0.0);
    aided.aid(Aiding::Height { value_m: 150.0, sigma_m: 5.0 }).unwrap();
    assert_eq!(asked(&mut subsets, &aided), have);
    // The same holds if it was there from the start.
    let mut subsets = Subsets::new();
    assert_eq!(asked(&mut subsets, &aided), have);
    assert_eq!(asked(&mut subsets, &epoch(1, 0.0)), have);
}

#[test]
fn other_satellites_are_dealt_anew() {
    let mut subsets = Subsets::new();
    let _ = asked(&mut subsets, &epoch(1, 0.0));
    let other = epoch(2, 70.0);
    let mut fewer = Epoch::<CAPACITY>::new(0.0);
    other.observations().iter().skip(3).for_each(|observation| fewer.push(*observation).unwrap());
    assert_eq!(asked(&mut subsets, &fewer), dealt(&fewer));
}
