//! A sky with more satellites than an epoch can hold: those low above the horizon are replaced by
//! usable ones.

use adversary::attack::victim::{Seen, Victim};
use raim::signal::encode::{Encoder, Frequency, Selection};
use raim::signal::fault::Measured;
use raim::signal::sky::Fleet;
use raim::signal::sky::raw::Simulation;
use raim_firmware::correction::CAPACITY;

/// Returns the module, its report on the last of some epochs down to an elevation, and the number
/// of satellites in it.
fn last_epoch(mask_deg: f64) -> (Victim, Seen, usize) {
    let fleets = [Fleet::BeidouRegional, Fleet::Beidou24, Fleet::Galileo24, Fleet::Gps31];
    let simulation = Simulation {
        satellites: fleets.into_iter().flat_map(Fleet::satellites).collect(),
        mask_rad: mask_deg.to_radians(),
        ..Simulation::above_xian(3600.0, 5, 1)
    };
    let mut recording = simulation.record();
    let tracked: Vec<_> = recording.epochs.iter().flat_map(Measured::satellites).collect();
    recording.ephemerides.retain(|set| tracked.contains(&set.satellite));
    // GPS comes last.
    let selection = Selection::new("CEG", Frequency::Dual).expect("three systems");
    let mut encoder = Encoder::new(&recording.ephemerides, selection);
    let mut victim = Victim::new(&[], 1.0).expect("no command");
    let mut last = None;
    for epoch in &recording.epochs {
        let bytes = encoder.epoch(epoch).expect("ranges of a sky");
        last = victim.receive(&bytes, simulation.site.position).expect("sentences").pop();
    }
    let satellites = recording.epochs.last().map_or(0, |epoch| epoch.satellites().len());
    (victim, last.expect("an epoch was judged"), satellites)
}

#[test]
fn low_satellites_take_no_place_of_high_ones() {
    let (_, want, _) = last_epoch(10.5);
    let (mut victim, have, satellites) = last_epoch(-15.0);
    assert!(satellites > CAPACITY, "{satellites} satellites are no crowd");
    assert!(have.is_promised && !have.is_misleading());
    assert!(have.reported.state.used >= want.reported.state.used, "used {}", have.reported.state.used);
    // The very first epoch has no horizon yet.
    assert!(victim.counter("epoch_full").expect("an answer") as usize <= satellites - CAPACITY);
}
