use raim_core::satellite::{Constellation, SatelliteId};

use super::*;
use crate::ephemeris::{Broadcast, Health, Origin};

const TOE: GpsTime = GpsTime { week: 2300, tow_ms: 7_200_000 };

/// Turn of the anomaly that moves the satellite by 83 m.
const ASTRAY_SC: f64 = 1e-6;

/// Returns a set of G07 whose anomaly is this much ahead.
fn set(ahead_sc: f64) -> Ephemeris {
    let broadcast = Broadcast {
        satellite: SatelliteId::new(Constellation::Gps, 7).expect("a satellite"),
        source: Source::GpsLnav,
        health: Health::GOOD,
        accuracy_m: Some(2.0),
        toe: TOE,
        toc: TOE,
        sqrt_a_sqrt_m: 5153.7,
        eccentricity: 0.01,
        m0_sc: 0.25 + ahead_sc,
        omega0_sc: -0.5,
        i0_sc: 0.306,
        omega_sc: 0.1,
        delta_n_sc_s: 1.5e-9,
        omegadot_sc_s: -2.6e-9,
        idot_sc_s: 0.0,
        cuc_rad: 0.0,
        cus_rad: 0.0,
        crc_m: 0.0,
        crs_m: 0.0,
        cic_rad: 0.0,
        cis_rad: 0.0,
        af0_s: 1e-5,
        af1_s_s: 0.0,
        af2_s_s2: 0.0,
        group_delays_s: [0.0; 2],
    };
    Ephemeris::new(&broadcast).expect("a set")
}

fn in_use(store: &Store) -> Result<&Ephemeris, EphemerisError> {
    store.get(set(0.0).satellite(), TOE)
}

#[test]
fn bits_of_the_receiver_outrank_what_a_caster_sends() {
    let now = Some(TOE);
    for astray_sc in [ASTRAY_SC, 0.01 * ASTRAY_SC] {
        let (own, other) = (set(0.0).of(Origin::Bits), set(astray_sc));
        let mut store = Store::new();
        assert_eq!(store.insert(other, now), Insertion::Taken);
        assert_eq!(store.insert(own, now), Insertion::Taken, "it replaces what came first");
        for _ in 0..3 {
            assert_eq!(store.insert(other, now), Insertion::Kept);
            assert_eq!(in_use(&store), Ok(&own));
        }
        // The next bits are compared with them.
        let next = set(2.0 * ASTRAY_SC).of(Origin::Bits);
        assert_eq!(store.insert(next, now), Insertion::Disputed);
    }
}

#[test]
fn bits_that_are_out_of_date_outrank_nothing() {
    let later = TOE.later_by_ms(3 * 3_600_000);
    let mut store = Store::new();
    store.insert(set(0.0).of(Origin::Bits), Some(TOE));
    let mut current = set(ASTRAY_SC);
    current.toe = later;
    assert_eq!(store.insert(current, Some(later)), Insertion::Taken);
    assert_eq!(store.insert(set(0.0).of(Origin::Bits), Some(later)), Insertion::Kept);
    assert_eq!(store.get(current.satellite(), later), Ok(&current));
}
