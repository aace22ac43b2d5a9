//! Choice among a satellite's sets, choice of the satellites with a set, and contradictions.

use crate::orbits::{CASES, Case, later};
use raim_core::satellite::{Constellation, SatelliteId};
use raim_firmware::correction::choose;
use raim_firmware::ephemeris::{
    Broadcast, CAPACITY, Ephemeris, EphemerisError, Health, Insertion, Source, Store,
};
use raim_firmware::raw::{Band, Carrier, RawSignal};
use raim_firmware::time::GpsTime;

const GPS: usize = 0;
const GALILEO: usize = 2;
const BEIDOU_GEO: usize = 4;

/// Turn of the anomaly that moves a GPS satellite by 83 m.
const ASTRAY_SC: f64 = 1e-6;

fn after(time: GpsTime, seconds: i64) -> GpsTime {
    GpsTime::from_ms(time.to_ms().checked_add_signed(seconds * 1000).unwrap())
}

fn ephemeris(broadcast: &Broadcast) -> Ephemeris {
    Ephemeris::new(broadcast).unwrap()
}

/// Returns the orbit of a case, written about a later time and changed.
fn issue(case: &Case, seconds: i64, change: impl FnOnce(&mut Broadcast)) -> Ephemeris {
    let mut broadcast = later(&case.broadcast(), seconds);
    change(&mut broadcast);
    ephemeris(&broadcast)
}

fn sound(case: &Case, seconds: i64) -> Ephemeris {
    issue(case, seconds, |_| {})
}

fn astray(case: &Case, seconds: i64) -> Ephemeris {
    issue(case, seconds, |b| b.m0_sc += ASTRAY_SC)
}

#[test]
fn issues_of_one_orbit_about_different_times_put_the_satellite_at_one_place() {
    // Geostationary cases are left out, because their tilted plane turns with the reference time.
    for case in CASES.iter().filter(|case| !matches!(case.satellite, (Constellation::Beidou, 5 | 59))) {
        let when = after(case.toe(), 1800);
        let (one, other) = (ephemeris(&case.broadcast()), sound(case, 3600));
        let (one, other) = (one.at(when, 2e7).unwrap(), other.at(when, 2e7).unwrap());
        let apart_m = one.position.distance_m(other.position);
        assert!(apart_m < 2.0, "{}: {apart_m} m", case.id());
    }
}

#[test]
fn what_was_received_last_is_in_use_though_its_reference_time_is_earlier() {
    let (mut store, case, now) = (Store::new(), &CASES[GPS], after(CASES[GPS].toe(), 600));
    assert_eq!(store.get(case.id(), now), Err(EphemerisError::Missing));
    for seconds in [0, 7200, 16, -16] {
        assert_eq!(store.insert(sound(case, seconds), Some(now)), Insertion::Taken, "{seconds}");
        assert_eq!(*store.get(case.id(), now).unwrap(), sound(case, seconds));
    }
}

#[test]
fn a_reference_time_hours_ahead_of_its_time_does_not_block_the_later_ones_for_hours() {
    // The first set was sent four hours early and is 80 m off; then come those for the next hours
    // as they are sent.
    let (mut store, case) = (Store::new(), &CASES[GALILEO]);
    let start = case.toe();
    store.insert(sound(case, 0), Some(start));
    store.insert(astray(case, 4 * 3600 - 600), Some(start));
    for tenth in 1..20_i64 {
        let now = after(start, tenth * 600);
        store.insert(sound(case, tenth * 600), Some(now));
        assert_eq!(*store.get(case.id(), now).unwrap(), sound(case, tenth * 600), "{tenth}");
    }
}

#[test]
fn a_reference_time_in_the_far_future_does_not_block_the_true_one() {
    let (mut store, case) = (Store::new(), &CASES[GPS]);
    store.insert(sound(case, 2 * 86_400), Some(case.toe()));
    assert_eq!(store.get(case.id(), case.toe()), Err(EphemerisError::Stale));
    assert_eq!(store.insert(sound(case, 0), Some(case.toe())), Insertion::Taken);
    assert!(store.get(case.id(), case.toe()).is_ok());
}

#[test]
fn a_reference_time_in_the_far_future_does_not_displace_a_set_in_use() {
    let (mut store, case) = (Store::new(), &CASES[GPS]);
    let now = after(case.toe(), 600);
    store.insert(sound(case, 0), Some(now));
    for hours in [3, 30, 50] {
        assert_eq!(store.insert(sound(case, hours * 3600), Some(now)), Insertion::Kept, "{hours} h ahead");
        assert_eq!(store.get(case.id(), now).unwrap().toe(), case.toe(), "{hours} h ahead");
    }
}

#[test]
fn two_sets_that_contradict_each_other_are_not_used_until_a_third_agrees_with_one() {
    let case = &CASES[GPS];
    let now = after(case.toe(), 600);
    for (third, is_of_the_first) in [(sound(case, 32), true), (astray(case, 32), false)] {
        let mut store = Store::new();
        assert_eq!(store.insert(sound(case, 0), Some(now)), Insertion::Taken);
        assert_eq!(store.insert(astray(case, 16), Some(now)), Insertion::Disputed);
        assert_eq!(store.get(case.id(), now), Err(EphemerisError::Disputed));
        // A copy of the disputed set is not a third set.
        assert_eq!(store.insert(astray(case, 16), Some(now)), Insertion::Disputed);
        assert_eq!(store.get(case.id(), now), Err(EphemerisError::Disputed));
        // Against the known set it decides as long after the contradiction as satellites take.
        let at_once = store.insert(third, Some(now));
        assert_eq!(at_once == Insertion::Taken, is_of_the_first);
        let later = after(now, 1050);
        assert_eq!(store.insert(third, Some(later)), Insertion::Taken);
        assert_eq!(*store.get(case.id(), later).unwrap(), third, "of the first: {is_of_the_first}");
    }
}

#[test]
fn a_copy_of_the_known_set_takes_back_a_contradiction_that_came_once_and_none_that_is_repeated() {
    use Insertion::{Disputed, Taken};
    let (mut store, case) = (Store::new(), &CASES[GPS]);
    let now = after(case.toe(), 600);
    let (known, other) = (sound(case, 0), astray(case, 16));
    let stream = [(known, Taken), (other, Disputed), (known, Taken), (other, Disputed)];
    for (index, (set, want)) in stream.into_iter().chain([(known, Disputed), (other, Disputed)]).enumerate() {
        assert_eq!(store.insert(set, Some(now)), want, "message {index}");
        assert_eq!(store.get(case.id(), now).is_ok(), want == Taken, "message {index}");
    }
    assert_eq!(store.insert(sound(case, 32), Some(now)), Taken);
    assert!(store.get(case.id(), now).is_ok());
}

#[test]
fn a_clock_that_contradicts_is_a_contradiction_and_one_within_some_metres_is_none() {
    let case = &CASES[GPS];
    let now = after(case.toe(), 600);
    // 10.2 m and 9.3 m.
    for (off_s, want) in
        [(3.4e-8, Insertion::Disputed), (-3.4e-8, Insertion::Disputed), (3.1e-8, Insertion::Taken)]
    {
        let mut store = Store::new();
        store.insert(sound(case, 0), Some(now));
        let have = store.insert(issue(case, 16, |b| b.af0_s += off_s), Some(now));
        assert_eq!(have, want, "{off_s}");
    }
}

/// Each set is 0.83 m from the one before.
#[test]
fn series_of_sets_carries_a_satellite_as_far_as_one_set_may_and_then_some_metres_an_hour() {
    let case = &CASES[GPS];
    // A second set 10 m away at most, and a third one as far from it, decide in 17 minutes at best.
    for (every_s, most_m) in [(1, 10.0), (60, 10.0 + 2.0 * 20.0 * 7000.0 / 1049.0), (600, 10.0)] {
        let (mut store, mut count) = (Store::new(), 0);
        store.insert(sound(case, 0), Some(case.toe()));
        for step in 1..=7000 / every_s {
            let now = after(case.toe(), step * every_s);
            let set = issue(case, 0, |b| b.m0_sc += 0.01 * ASTRAY_SC * step as f64);
            if store.insert(set, Some(now)) == Insertion::Taken {
                count = step;
            }
        }
        let moved_m = 0.83 * count as f64;
        assert!(moved_m <= most_m, "every {every_s} s: {moved_m} m");
    }
}

#[test]
fn third_set_decides_nothing_while_the_known_one_is_sent() {
    let case = &CASES[GPS];
    let mut store = Store::new();
    for step in 0..200_i64 {
        let now = after(case.toe(), 30 * step);
        let known = store.insert(sound(case, 0), Some(now));
        assert_eq!(known == Insertion::Taken, step < 1, "{step}");
        for _ in 0..2 {
            let other = issue(case, 0, |b| b.m0_sc += ASTRAY_SC * (1.0 + 1e-3 * (step / 40) as f64));
            assert_eq!(store.insert(other, Some(now)), Insertion::Disputed, "{step}");
        }
    }
}

#[test]
fn third_set_that_drifts_from_the_second_decides_nothing() {
    let case = &CASES[GPS];
    let mut store = Store::new();
    store.insert(sound(case, 0), Some(case.toe()));
    for step in 0..7000 {
        let now = after(case.toe(), step);
        let set = issue(case, 0, |b| b.m0_sc += ASTRAY_SC * (1.0 + 0.05 * step as f64));
        assert_eq!(store.insert(set, Some(now)), Insertion::Disputed, "{step} s");
    }
}

#[test]
fn a_dispute_ends_when_one_side_is_out_of_date() {
    let (mut store, case) = (Store::new(), &CASES[GPS]);
    let now = after(case.toe(), 600);
    store.insert(sound(case, 0), Some(now));
    store.insert(astray(case, 3600), Some(now));
    let later = after(case.toe(), 2 * 3600 + 120);
    assert_eq!(store.insert(astray(case, 3600), Some(later)), Insertion::Taken);
    assert!(store.get(case.id(), later).is_ok());
}

#[test]
fn more_disputes_than_are_kept_still_end() {
    let case = &CASES[GPS];
    let (mut store, now) = (Store::new(), after(case.toe(), 600));
    let of = |number, broadcast: &dyn Fn(&mut Broadcast), seconds| {
        issue(case, seconds, |b| {
            b.satellite = SatelliteId::new(Constellation::Gps, number).unwrap();
            broadcast(b);
        })
    };
    let good: &dyn Fn(&mut Broadcast) = &|_| {};
    let bad: &dyn Fn(&mut Broadcast) = &|b| b.m0_sc += ASTRAY_SC;
    for (change, seconds, want) in
        [(good, 0, Insertion::Taken), (bad, 16, Insertion::Disputed), (good, 32, Insertion::Taken)]
    {
        for number in 1..=32 {
            assert_eq!(store.insert(of(number, change, seconds), Some(now)), want, "G{number:02}");
        }
    }
}

/// Returns satellites of all systems but those of a case. The geostationary ones are left out,
/// because their elements refer to another plane.
fn names() -> Vec<(usize, SatelliteId)> {
    let of = |case, constellation, numbers: std::ops::RangeInclusive<u8>| {
        numbers.map(move |number| (case, SatelliteId::new(constellation, number).unwrap()))
    };
    of(GPS, Constellation::Gps, 1..=32)
        .chain(of(GALILEO, Constellation::Galileo, 1..=36))
        .chain(of(7, Constellation::Beidou, 6..=58))
        .collect()
}

fn named((case, satellite): (usize, SatelliteId), toe: GpsTime) -> Ephemeris {
    issue(&CASES[case], 0, |b| (b.satellite, b.toe, b.toc) = (satellite, toe, toe))
}

#[test]
fn satellites_two_days_ahead_lock_out_none_that_is_there() {
    let (mut store, now) = (Store::new(), CASES[GPS].toe());
    let names = names();
    let (real, absent) = names.split_first().unwrap();
    for name in &absent[..96] {
        store.insert(named(*name, after(now, 2 * 86_400)), Some(now));
    }
    assert_eq!(store.len(), CAPACITY);
    assert_eq!(store.insert(named(*real, now), Some(now)), Insertion::Taken);
    assert!(store.get(real.1, now).is_ok());
}

#[test]
fn a_stream_of_112_satellites_locks_out_none_of_the_33_in_view() {
    let (mut store, start) = (Store::new(), CASES[GPS].toe());
    let stream: Vec<_> = names().into_iter().take(112).collect();
    // Every third satellite is in view; all are sent again and again, one each second.
    let in_view: Vec<SatelliteId> = stream.iter().map(|(_, id)| *id).step_by(3).take(33).collect();
    for second in 0..1200 {
        let now = after(start, second);
        store.insert(named(stream[second as usize % stream.len()], start), Some(now));
        store.observe(in_view.iter().copied());
        if second >= 2 * 112 {
            for satellite in &in_view {
                assert!(store.get(*satellite, now).is_ok(), "{satellite} after {second} s");
            }
        }
    }
}

#[test]
fn galileo_fnav_serves_until_inav_comes_and_does_not_replace_it() {
    let (mut store, case) = (Store::new(), &CASES[GALILEO]);
    let (toe, now) = (case.toe(), Some(case.toe()));
    let fnav = |seconds| issue(case, seconds, |b| b.source = Source::GalileoFnav);
    assert_eq!(store.insert(fnav(0), now), Insertion::Taken);
    assert_eq!(store.insert(sound(case, 0), now), Insertion::Taken);
    assert_eq!(store.insert(fnav(600), now), Insertion::Kept);
    assert_eq!(store.insert(fnav(5 * 3600), Some(after(toe, 5 * 3600))), Insertion::Taken);
}

/// Returns the choice from E1, E5b and E5a after these messages came in this order.
fn chosen(messages: &[Ephemeris]) -> Result<Option<(Band, Option<Band>)>, EphemerisError> {
    let (mut store, case) = (Store::new(), &CASES[GALILEO]);
    for message in messages {
        store.insert(*message, Some(case.toe()));
    }
    let ephemeris = store.get(case.id(), case.toe())?;
    let signals = [Band::E1, Band::E5b, Band::E5a].map(|band| RawSignal::new(Carrier::of(band), 2.4e7));
    Ok(choose(&signals, ephemeris, 0.0, f32::INFINITY).preferred().map(|choice| choice.bands))
}

#[test]
fn what_fnav_says_of_e5a_counts_though_the_orbit_is_that_of_inav() {
    let case = &CASES[GALILEO];
    let inav = |seconds, e5b, e1| {
        issue(case, seconds, |b| b.health = Health::UNKNOWN.with(Band::E5b, e5b).with(Band::E1, e1))
    };
    let fnav = |seconds, e5a, accuracy_m| {
        issue(case, seconds, |b| {
            (b.source, b.accuracy_m) = (Source::GalileoFnav, accuracy_m);
            b.health = Health::UNKNOWN.with(Band::E5a, e5a);
        })
    };
    let both_pairs = Ok(Some((Band::E1, Some(Band::E5a))));
    let other_pair = Ok(Some((Band::E1, Some(Band::E5b))));
    assert_eq!(chosen(&[inav(0, true, true)]), both_pairs, "nothing is said of E5a");
    assert_eq!(chosen(&[inav(0, true, true), fnav(0, true, Some(3.12))]), both_pairs);
    // The signals are out of service or without promise, in either order of the messages, and after
    // a new I/NAV.
    for bad in [fnav(0, false, Some(3.12)), fnav(0, true, None), fnav(0, false, None)] {
        assert_eq!(chosen(&[inav(0, true, true), bad]), other_pair);
        assert_eq!(chosen(&[bad, inav(0, true, true)]), other_pair);
        assert_eq!(chosen(&[inav(0, true, true), bad, inav(600, true, true)]), other_pair);
        assert_eq!(chosen(&[inav(0, false, true), bad]), Ok(Some((Band::E1, None))));
        assert_eq!(chosen(&[inav(0, true, true), bad, fnav(600, true, Some(3.12))]), both_pairs);
    }
    assert_eq!(chosen(&[fnav(0, false, None)]), Err(EphemerisError::Unhealthy));
    assert_eq!(chosen(&[inav(0, false, true), fnav(0, true, Some(3.12))]), both_pairs);
    // By the service definition, a signal without a statement is not healthy.
    assert_eq!(chosen(&[fnav(0, false, Some(3.12))]), Err(EphemerisError::Unhealthy));
    assert_eq!(chosen(&[inav(0, false, true)]), Ok(Some((Band::E1, None))));
    assert_eq!(chosen(&[fnav(0, true, Some(3.12))]), both_pairs, "F/NAV alone, for E1 and E5a");
}

/// [OS-SDD] 2.3.1: data without guarantee makes no signal healthy. Both messages describe one
/// orbit, so either speaks for it.
///
/// [OS-SDD]: raim_firmware#references
#[test]
fn data_without_guarantee_closes_every_signal_whichever_band_says_it() {
    let case = &CASES[GALILEO];
    let inav = |seconds, without: [bool; 2]| {
        issue(case, seconds, |b| {
            b.health =
                Health::UNKNOWN.with_galileo(Band::E5b, 0, without[0]).with_galileo(Band::E1, 0, without[1]);
        })
    };
    let fnav = |seconds, without| {
        issue(case, seconds, |b| {
            b.source = Source::GalileoFnav;
            b.health = Health::UNKNOWN.with_galileo(Band::E5a, 0, without);
        })
    };
    let closed = Err(EphemerisError::Unhealthy);
    let open = Ok(Some((Band::E1, Some(Band::E5a))));
    for without in [[true, false], [false, true], [true, true]] {
        let bad = inav(0, without);
        assert_eq!(chosen(&[bad]), closed, "{without:?}");
        assert_eq!(chosen(&[fnav(0, false), bad]), closed, "{without:?}");
        assert_eq!(chosen(&[bad, fnav(0, false)]), closed, "{without:?}");
        assert_eq!(chosen(&[bad, inav(600, [false, false])]), open, "taken back");
    }
    assert_eq!(chosen(&[inav(0, [false; 2]), fnav(0, true)]), closed);
    assert_eq!(chosen(&[fnav(0, true), inav(0, [false; 2])]), closed);
    assert_eq!(chosen(&[inav(0, [false; 2]), fnav(0, true), inav(600, [false; 2])]), closed);
    assert_eq!(chosen(&[inav(0, [false; 2]), fnav(0, true), fnav(600, false)]), open);
}

/// I/NAV reported E1 healthy until its set was out of date; five hours later F/NAV reports E5a in
/// test.
#[test]
fn good_word_of_a_set_that_is_out_of_date_does_not_hold() {
    const LATER_S: i64 = 5 * 3600;
    let (mut store, case) = (Store::new(), &CASES[GALILEO]);
    let healthy = |health: Health, band| health.with_galileo(band, 0, false);
    let inav = issue(case, 0, |b| b.health = healthy(healthy(Health::UNKNOWN, Band::E5b), Band::E1));
    let fnav = issue(case, LATER_S, |b| {
        b.source = Source::GalileoFnav;
        b.health = Health::UNKNOWN.with_galileo(Band::E5a, 3, false);
    });
    let later = after(case.toe(), LATER_S);
    store.insert(inav, Some(case.toe()));
    assert_eq!(store.insert(fnav, Some(later)), Insertion::Taken);
    assert_eq!(store.get(case.id(), later).map(|_| ()), Err(EphemerisError::Unhealthy));
}

#[test]
fn a_full_store_lets_go_what_was_not_observed_for_longest() {
    let (mut store, now) = (Store::new(), CASES[BEIDOU_GEO].toe());
    let names = names();
    for name in &names[..CAPACITY] {
        store.insert(named(*name, now), Some(now));
    }
    let seen: Vec<_> = names[..CAPACITY].iter().map(|(_, id)| *id).filter(|id| *id != names[40].1).collect();
    store.observe(seen.into_iter());
    assert_eq!(store.insert(named(names[CAPACITY], now), Some(now)), Insertion::Taken);
    assert_eq!(store.len(), CAPACITY);
    assert_eq!(store.get(names[40].1, now), Err(EphemerisError::Missing));
    assert!(store.get(names[CAPACITY].1, now).is_ok());
}

#[test]
fn satellites_that_rise_together_displace_others_and_not_each_other() {
    let (mut store, now, names) = (Store::new(), CASES[GPS].toe(), names());
    let (here, rising) = (&names[..CAPACITY], &names[CAPACITY..CAPACITY + 8]);
    for name in here {
        store.insert(named(*name, now), Some(now));
    }
    // All satellites were seen; a dozen of them no longer are.
    store.observe(here.iter().map(|(_, id)| *id));
    for _ in 0..6 {
        store.observe(here.iter().map(|(_, id)| *id).skip(12));
    }
    for name in rising {
        store.insert(named(*name, now), Some(now));
    }
    let is_known = |(_, id): &&(usize, SatelliteId)| store.get(*id, now).is_ok();
    assert_eq!(rising.iter().filter(is_known).count(), rising.len());
    assert_eq!(here[12..].iter().filter(is_known).count(), CAPACITY - 12);
}

#[test]
fn strangers_after_an_epoch_of_one_satellite_displace_nobody_in_sight() {
    let (mut store, now, names) = (Store::new(), CASES[GPS].toe(), names());
    let (here, strangers) = names.split_at(30);
    for name in here {
        store.insert(named(*name, now), Some(now));
    }
    store.observe(here.iter().map(|(_, id)| *id));
    store.observe([here[0].1].into_iter());
    for name in &strangers[..64] {
        store.insert(named(*name, now), Some(now));
    }
    assert!(here.iter().all(|(_, id)| store.get(*id, now).is_ok()));
}
