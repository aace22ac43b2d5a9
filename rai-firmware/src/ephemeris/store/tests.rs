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

#[cfg(feature = "osnma")]
mod authentication {
    use core::num::NonZeroU8;

    use super::*;
    use crate::osnma::{Proof, Seal, Verdict};

    fn seal(version: u8, verdict: Verdict) -> Seal {
        Seal { version: NonZeroU8::new(version), verdict }
    }

    /// Returns a set of E07 from words of a version.
    fn of_galileo(ahead_sc: f64, version: u8, verdict: Verdict) -> Ephemeris {
        let mut set = set(ahead_sc).of(Origin::Bits).sealed(seal(version, verdict));
        set.satellite = SatelliteId::new(Constellation::Galileo, 7).expect("a satellite");
        set.source = Source::GalileoInav;
        set
    }

    const DEMANDS: [Demand; 5] = [
        Demand::Nothing,
        Demand::NotFalse,
        Demand::Proved(Proof::All),
        Demand::Proved(Proof::Slow),
        Demand::Proved(Proof::None),
    ];

    /// Returns for each demand whether the set is in use.
    fn used(store: &mut Store, satellite: SatelliteId) -> [bool; 5] {
        DEMANDS.map(|demand| {
            store.demand(demand);
            match store.get(satellite, TOE) {
                Ok(_) => true,
                Err(error) => {
                    assert_eq!(error, EphemerisError::Unproved);
                    false
                }
            }
        })
    }

    #[test]
    fn sets_are_used_by_their_verdict_and_what_is_demanded() {
        let mut store = Store::new();
        let set = of_galileo(0.0, 3, Verdict::Unproved);
        store.insert(set, Some(TOE));
        for (verdict, want) in [
            (Verdict::Unproved, [true, true, false, false, false]),
            (Verdict::False, [true, false, false, false, false]),
            (Verdict::Proved, [true, true, true, false, false]),
            (Verdict::ProvedLater, [true, true, true, true, false]),
        ] {
            store.take_verdict(set.satellite, seal(3, verdict));
            assert_eq!(used(&mut store, set.satellite), want, "{verdict:?}");
            // A verdict on other words changes nothing, nor does one on words that are not known.
            store.take_verdict(set.satellite, seal(4, Verdict::False));
            store.take_verdict(set.satellite, Seal { version: None, verdict: Verdict::False });
            assert_eq!(used(&mut store, set.satellite), want, "{verdict:?}");
        }
        store.forget_verdicts();
        store.take_verdict(set.satellite, seal(3, Verdict::Proved));
        assert_eq!(used(&mut store, set.satellite), [true, true, false, false, false], "forgotten");
    }

    #[test]
    fn the_next_set_has_a_verdict_of_its_own() {
        let mut store = Store::new();
        store.insert(of_galileo(0.0, 3, Verdict::Proved), Some(TOE));
        let next = of_galileo(0.01 * ASTRAY_SC, 4, Verdict::Unproved);
        assert_eq!(store.insert(next, Some(TOE)), Insertion::Taken);
        assert_eq!(used(&mut store, next.satellite), [true, true, false, false, false]);
        // Of the same orbit, from other words.
        let same = of_galileo(0.01 * ASTRAY_SC, 5, Verdict::False);
        assert_eq!(store.insert(same, Some(TOE)), Insertion::Taken);
        assert_eq!(used(&mut store, next.satellite), [true, false, false, false, false]);
    }

    #[test]
    fn nothing_is_demanded_of_other_systems() {
        let mut store = Store::new();
        store.insert(set(0.0), Some(TOE));
        assert_eq!(used(&mut store, set(0.0).satellite()), [true; 5]);
    }
}
