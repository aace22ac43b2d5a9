use super::*;

#[test]
fn an_older_time_comes_back_though_every_system_ends_its_own_epoch() {
    let (mut calendar, mut counters) = (Calendar::new(), Counters::default());
    calendar.learn(Constellation::Gps, GpsTime { week: 2111, tow_ms: 0 }, &mut counters);
    assert!(calendar.advance(90_000_000, 0, &mut counters).is_ok());
    let older = (1..=5).flat_map(|second| [second * 1000; 2]);
    let accepted = older.filter(|&tow_ms| calendar.advance(tow_ms, 0, &mut counters).is_ok()).count();
    assert_eq!((accepted, calendar.time()), (1, Some(GpsTime { week: 2111, tow_ms: 5000 })));
}

/// Returns the accepted times, s after the beginning of week 2111, for seconds of the week and
/// their arrivals, s. One of them may be confirmed.
fn times_of(epochs: &[(u32, u64)], confirmed: Option<usize>) -> std::vec::Vec<Option<i64>> {
    let (mut calendar, mut counters) = (Calendar::new(), Counters::default());
    let start = GpsTime { week: 2111, tow_ms: 0 };
    calendar.learn(Constellation::Gps, start.later_by_ms(200_000_000), &mut counters);
    let mut time = |(index, &(tow_s, came_s)): (usize, &(u32, u64))| {
        let time = calendar.advance(tow_s * 1000, came_s * 1000, &mut counters).ok()?;
        if confirmed == Some(index) {
            calendar.confirm(time, came_s * 1000);
        }
        Some(time.since_ms(start) / 1000)
    };
    epochs.iter().enumerate().map(&mut time).collect()
}

const WEEK_S: u32 = WEEK_MS / 1000;

#[test]
fn leaps_do_not_carry_what_is_confirmed_away() {
    let far = |leaps: u32| (100 + leaps * 280_000) % WEEK_S;
    // The leaps are many, far and long; two more lead only a little ahead.
    let mut epochs: std::vec::Vec<_> = (1..=3)
        .flat_map(|leaps| (0..8).map(move |second| (far(leaps) + second, u64::from(second))))
        .collect();
    epochs.push((112, 8));
    epochs.push((167, 8));
    epochs.extend([(109, 9), (110, 10)]);
    let times = times_of(&[&[(100, 0)], &epochs[..]].concat(), Some(0));
    assert_eq!(times[times.len() - 2..], [Some(109), Some(110)]);
}

#[test]
fn what_comes_twice_is_not_the_time_twice() {
    // The second is not confirmed.
    assert_eq!(
        times_of(&[(100, 0), (101, 1), (101, 1), (102, 2)], Some(0)),
        [Some(100), Some(101), None, Some(102)]
    );
}

#[test]
fn votes_do_not_carry_what_is_confirmed_into_another_week() {
    let (mut calendar, mut counters) = (Calendar::new(), Counters::default());
    let week = |week: u16| GpsTime { week, tow_ms: 200_000_000 };
    calendar.learn(Constellation::Gps, week(2111), &mut counters);
    let first = calendar.advance(200_001_000, 1000, &mut counters).unwrap();
    calendar.confirm(first, 1000);
    for system in [Constellation::Gps, Constellation::Beidou, Constellation::Galileo] {
        (0..20).for_each(|_| _ = calendar.learn(system, week(2110), &mut counters));
    }
    assert_eq!(counters.week_corrections, 1);
    assert_eq!(
        calendar.advance(200_002_000, 2000, &mut counters),
        Ok(GpsTime { week: 2111, tow_ms: 200_002_000 })
    );
}

#[test]
fn sets_that_fit_two_weeks_do_not_confirm_the_week() {
    let (mut calendar, mut counters) = (Calendar::new(), Counters::default());
    let before_end_ms = WEEK_MS - 1_200_000;
    // The set states the week of its reference time, but may also state that of transmission.
    calendar.learn(Constellation::Gps, GpsTime { week: 2112, tow_ms: 0 }, &mut counters);
    let late = calendar.advance(before_end_ms, 0, &mut counters).unwrap();
    assert_eq!((late.week, calendar.take_redating()), (2112, Some(late)));
    // A set of GLONASS is no evidence, because the present has dated it.
    calendar.learn(Constellation::Glonass, late, &mut counters);
    calendar.confirm(late, 0);
    // A set of Galileo fits one week only.
    let stated = GpsTime { week: 2111, tow_ms: before_end_ms - 600_000 };
    assert_eq!(calendar.learn(Constellation::Galileo, stated, &mut counters), stated);
    let time = calendar.advance(before_end_ms + 1000, 1000, &mut counters).unwrap();
    assert_eq!(time, GpsTime { week: 2111, tow_ms: before_end_ms + 1000 });
    assert_eq!(counters.week_corrections, 1);
    // From now on it dates the sets of GPS, whichever week they state.
    for week in [2111, 2112] {
        let toe = calendar.learn(Constellation::Gps, GpsTime { week, tow_ms: 0 }, &mut counters);
        assert_eq!(toe, GpsTime { week: 2112, tow_ms: 0 });
    }
}

/// Returns the week after ephemerides have voted for the next one, this number of epochs after the
/// last confirmed one.
fn week_voted_on(epochs: u32) -> u16 {
    let (mut calendar, mut counters) = (Calendar::new(), Counters::default());
    let week = |week: u16| GpsTime { week, tow_ms: 200_000_000 };
    calendar.learn(Constellation::Gps, week(2110), &mut counters);
    let mut advance = |second: u32| {
        let time =
            calendar.advance(200_001_000 + 1000 * second, 1000 * u64::from(second), &mut counters).unwrap();
        if second == 0 {
            calendar.confirm(time, 0);
        }
        if second == epochs {
            (0..20).for_each(|_| _ = calendar.learn(Constellation::Gps, week(2111), &mut counters));
        }
        time.week
    };
    (0..=epochs + 1).map(&mut advance).last().unwrap()
}

#[test]
fn what_was_confirmed_ten_minutes_ago_gives_way_to_the_votes() {
    assert_eq!([599, 600].map(week_voted_on), [2110, 2111]);
}

#[test]
fn receiver_of_an_earlier_cycle_says_no_week() {
    let mut calendar = Calendar::new();
    calendar.suppose(GpsTime { week: NOT_BEFORE_WEEK - 700, tow_ms: 0 }, &mut Counters::default());
    assert_eq!(calendar.present(), None);
}

#[test]
fn cycle_of_gps_is_that_of_the_others() {
    let (mut calendar, mut counters) = (Calendar::new(), Counters::default());
    let week = |week: u16| GpsTime { week, tow_ms: 0 };
    calendar.learn(Constellation::Beidou, week(2111 + 1024), &mut counters);
    (0..100).for_each(|_| _ = calendar.learn(Constellation::Gps, week(2111 + 1024), &mut counters));
    (0..4).for_each(|_| _ = calendar.learn(Constellation::Beidou, week(2111), &mut counters));
    assert_eq!((counters.week_corrections, calendar.present()), (1, Some(week(2111))));
}

#[test]
fn silence_of_days_ends_in_the_week_that_the_own_clock_tells() {
    let days = |days: u32| 86_400 * days;
    let ends_s = [days(3), days(5), days(6) + 3600, days(9)];
    for ends_s in ends_s {
        let epochs = [(100, 0), (ends_s % WEEK_S, u64::from(ends_s - 100))];
        assert_eq!(times_of(&epochs, None)[1], Some(i64::from(ends_s)));
    }
}
