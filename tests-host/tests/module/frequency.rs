//! Choice between one frequency and two, and signals too weak to use.

use crate::walker::{self, Ionosphere, TOE, range_m, satellite};
use raim_core::epoch::Epoch;
use raim_core::requirements::Requirements;
use raim_firmware::correction::{Cost, Klobuchar, Preference, Ranges, Site, Sky, Tally, locate};
use raim_firmware::ephemeris::{Ephemeris, Store};
use raim_firmware::raw::{Band, Carrier, RawEpoch, RawSatellite, RawSignal};
use raim_single::{Monitor, MonitorMemory};

const NO_MASK_RAD: f64 = 0.1;

/// Coefficients of a calm day.
const CALM: [f64; 8] = walker::CALM;

/// Returns a sky seen from 45° N, with the given signals of each satellite.
fn sky(signals: impl Fn(usize, f64) -> Vec<RawSignal>, mask_dbhz: f32) -> (Sky, Tally) {
    let (mut store, mut tally, mut raw) = (Store::new(), Tally::default(), RawEpoch::new(TOE));
    for index in 0..30 {
        let ephemeris = Ephemeris::new(&satellite(index)).unwrap();
        store.insert(ephemeris, Some(TOE));
        let still = Ionosphere { tecu: 0.0, per_degree: 0.0 };
        let Some(range_m) = range_m(&ephemeris, TOE, receiver(), still) else { continue };
        let signals = signals(raw.satellites.len(), range_m).into_iter().collect();
        raw.satellites.push(RawSatellite { satellite: ephemeris.satellite(), signals }).unwrap();
    }
    let mut sky = Sky::new();
    locate(&raw, &store, mask_dbhz, raim_firmware::settings::Systems::AT_START, &mut tally, &mut sky);
    (sky, tally)
}

fn receiver() -> raim_core::frame::Ecef {
    raim_core::frame::Geodetic { latitude_rad: 0.785, longitude_rad: 0.2, height_m: 0.0 }.to_ecef()
}

fn on(band: Band, range_m: f64, cn0_dbhz: f32) -> RawSignal {
    RawSignal::new(Carrier::of(band), range_m).with_cn0_dbhz(cn0_dbhz)
}

fn cost(sky: &Sky, ranges: Ranges, noise: f32) -> f64 {
    let monitor = Monitor::new(Requirements::non_precision_approach()).unwrap();
    let mut epoch = Epoch::new(0.0);
    let site = Site::new(receiver(), TOE, NO_MASK_RAD, Klobuchar::new(CALM)).with_ranges(ranges);
    site.correct(sky, &mut Tally::default(), &mut epoch);
    let levels = raim_single::levels(&monitor, &epoch, receiver(), noise, &mut MonitorMemory::new()).unwrap();
    (levels.hpl_m / 40.0).max(levels.vpl_m / 50.0)
}

#[test]
fn pairs_are_better_where_all_satellites_send_them_and_worse_where_few_do() {
    let both = |_, range_m| vec![on(Band::L1, range_m, 45.0), on(Band::L2, range_m, 45.0)];
    let (all, _) = sky(both, 28.0);
    let [pairs, singles] = [Ranges::Pairs, Ranges::Singles].map(|ranges| cost(&all, ranges, 1.0));
    assert!(pairs < singles, "{pairs}, {singles}");
    // Noise of the receiver counts threefold in a pair.
    assert!(cost(&all, Ranges::Pairs, 25.0) > cost(&all, Ranges::Singles, 25.0));
    // Weak pairs of three satellites stand beside single ranges with another delay.
    let few = |index, range_m| {
        let second = (index < 3).then(|| on(Band::L5, range_m, 29.0));
        [on(Band::L1, range_m, 45.0)].into_iter().chain(second).collect()
    };
    let (few, _) = sky(few, 28.0);
    assert!(cost(&few, Ranges::Singles, 1.0) < cost(&few, Ranges::Pairs, 1.0));
}

#[test]
fn ranges_have_no_say_in_the_choice() {
    let both = |off_m: f64| {
        move |index, range_m| {
            let off_m = if index == 2 { off_m } else { 0.0 };
            vec![on(Band::L1, range_m + off_m, 45.0), on(Band::L5, range_m - off_m, 45.0)]
        }
    };
    let ((right, _), (wrong, _)) = (sky(both(0.0), 28.0), sky(both(4.0), 28.0));
    for ranges in [Ranges::Pairs, Ranges::Singles] {
        // The satellite's own place moves by a millimetre with its range.
        let change = cost(&wrong, ranges, 1.0) / cost(&right, ranges, 1.0) - 1.0;
        assert!(change.abs() < 1e-5, "{ranges:?}: {change:e}");
    }
}

/// A preference that is asked in equal steps of time.
struct Asked {
    preference: Preference,
    tow_ms: u32,
    step_ms: u32,
}

impl Asked {
    fn every(step_ms: u32) -> Self {
        Self { preference: Preference::new(), tow_ms: 0, step_ms }
    }

    fn new() -> Self {
        Self::every(1000)
    }

    fn weigh(
        &mut self,
        noise: f32,
        others: Option<f32>,
        mut cost: impl FnMut(Ranges, f32) -> Option<Cost>,
    ) -> Ranges {
        self.tow_ms = (self.tow_ms + self.step_ms) % 604_800_000;
        if self.preference.is_due(self.tow_ms) {
            let [pairs, singles] = self.preference.noises(noise, others);
            let costs = [cost(Ranges::Pairs, pairs), cost(Ranges::Singles, singles)];
            self.preference.compare(costs, noise < 1.0 || others.is_some());
        }
        self.preference.ranges()
    }
}

/// Returns a cost that is the same on both axes.
const fn even(share: f32) -> Cost {
    Cost { decisive: share, other: share }
}

/// Returns the costs of both kinds, whatever their noise.
fn costs(pairs: Option<f32>, singles: Option<f32>) -> impl Fn(Ranges, f32) -> Option<Cost> {
    move |ranges, _| if ranges == Ranges::Pairs { pairs } else { singles }.map(even)
}

/// Returns a preference after its first comparisons, which found pairs to be better.
fn settled() -> Asked {
    let mut preference = Asked::new();
    for _ in 0..61 {
        assert_eq!(preference.weigh(1.0, None, costs(Some(1.0), Some(1.0))), Ranges::Pairs);
    }
    preference
}

#[test]
fn the_set_changes_when_the_other_has_been_a_twentieth_better_for_ten_seconds() {
    assert_eq!(Asked::new().weigh(1.0, None, costs(Some(1.0), Some(0.94))), Ranges::Singles);
    let mut preference = settled();
    for epoch in 1..=9 {
        assert_eq!(preference.weigh(1.0, None, costs(Some(1.0), Some(0.94))), Ranges::Pairs, "epoch {epoch}");
    }
    assert_eq!(preference.weigh(1.0, None, costs(Some(1.0), Some(0.94))), Ranges::Singles);
    // It changes back only when the pairs are better by a twentieth.
    for _ in 0..100 {
        assert_eq!(preference.weigh(1.0, None, costs(Some(0.96), Some(1.0))), Ranges::Singles);
    }
    // A set without a position is worse than one with a position, but no reason to change if
    // neither has one.
    for _ in 0..100 {
        assert_eq!(preference.weigh(1.0, None, costs(None, None)), Ranges::Singles);
    }
    // While the other set is not better, it is compared only every thirtieth epoch.
    for _ in 0..40 {
        preference.weigh(1.0, None, costs(Some(5.0), None));
    }
    assert_eq!(preference.preference.ranges(), Ranges::Pairs);
}

/// A satellite that is lost for one epoch doubles the levels of pairs for that epoch.
#[test]
fn half_a_minute_apart_each_epoch_takes_the_better_set() {
    let mut preference = Asked::every(30_000);
    for _ in 0..20 {
        assert_eq!(preference.weigh(1.0, None, costs(Some(1.0), Some(1.2))), Ranges::Pairs);
        assert_eq!(preference.weigh(1.0, None, costs(Some(2.0), Some(1.2))), Ranges::Singles);
    }
}

#[test]
fn ten_epochs_suffice_at_any_rate() {
    let mut preference = Asked::every(100);
    for _ in 0..61 {
        preference.weigh(1.0, None, costs(Some(1.0), Some(1.0)));
    }
    for _ in 1..=9 {
        assert_eq!(preference.weigh(1.0, None, costs(Some(1.0), Some(0.9))), Ranges::Pairs);
    }
    assert_eq!(preference.weigh(1.0, None, costs(Some(1.0), Some(0.9))), Ranges::Singles);
    // A time that goes back is no reason to stay.
    preference.step_ms = 604_800_000 - 5000;
    let back = (0..60).find(|_| preference.weigh(1.0, None, costs(Some(0.9), Some(1.0))) == Ranges::Pairs);
    assert!(back.is_some());
}

#[test]
fn the_other_axis_decides_only_between_quiet_sets_that_are_alike_on_the_first() {
    let of = |noise, pairs: (f32, f32), singles: (f32, f32)| {
        let [pairs, singles] = [pairs, singles].map(|(decisive, other)| Cost { decisive, other });
        let cost = move |ranges, _| Some(if ranges == Ranges::Pairs { pairs } else { singles });
        Asked::new().weigh(noise, None, cost)
    };
    assert_eq!(of(0.5, (1.0, 2.0), (1.04, 1.0)), Ranges::Singles);
    assert_eq!(of(1.0, (1.0, 2.0), (1.04, 1.0)), Ranges::Pairs);
    assert_eq!(of(0.5, (1.0, 2.0), (1.06, 1.0)), Ranges::Pairs);
    assert_eq!(of(0.5, (1.0, 1.0), (0.96, 1.0)), Ranges::Pairs);
    assert_eq!(of(0.5, (1.0, 1.0), (0.94, 2.0)), Ranges::Singles);
}

#[test]
fn what_the_other_set_has_shown_at_rest_counts() {
    let cost = |ranges, noise: f32| Some(even(if ranges == Ranges::Pairs { noise.sqrt() } else { 0.9 }));
    let mut preference = Asked::new();
    for _ in 0..100 {
        assert_eq!(preference.weigh(1.0, None, cost), Ranges::Singles);
    }
    for _ in 0..40 {
        preference.weigh(1.0, Some(0.25), cost);
    }
    assert_eq!(preference.preference.ranges(), Ranges::Pairs);
}

#[test]
fn costs_that_swing_about_each_other_change_nothing() {
    let mut preference = settled();
    for epoch in 0..10_000 {
        // One set is better by half for eight epochs and worse for one; then the other.
        let (pairs, singles) = if epoch % 9 == 0 { (0.5, 1.0) } else { (1.0, 0.5) };
        let ranges = preference.weigh(1.0, None, costs(Some(pairs), Some(singles)));
        assert_eq!(ranges, Ranges::Pairs, "epoch {epoch}");
    }
}

/// One frequency hides the noise of a receiver below the ionosphere's error.
#[test]
fn noise_that_pairs_have_shown_is_kept_in_mind_for_minutes() {
    let by_noise = |ranges, noise: f32| match ranges {
        Ranges::Pairs => Some(even(noise.sqrt())),
        Ranges::Singles => Some(even(2.0)),
    };
    let mut preference = settled();
    for _ in 0..10 {
        preference.weigh(16.0, None, by_noise);
    }
    assert_eq!(preference.preference.ranges(), Ranges::Singles);
    let back = (0..2000).find(|_| preference.weigh(1.0, None, by_noise) == Ranges::Pairs);
    // 1 + 15·0.95^n is below 4/1.05² after 34 comparisons, thirty epochs apart, and ten epochs later.
    assert!(back.is_some_and(|epoch| (1020..=1030).contains(&epoch)), "{back:?}");
}

#[test]
fn a_signal_below_the_mask_is_not_used_and_a_weak_one_weighs_less() {
    let strength = |cn0_dbhz: f32| move |_, range_m| vec![on(Band::L1, range_m, cn0_dbhz)];
    let (weak, tally) = sky(strength(27.9), 28.0);
    assert!(weak.is_empty() && tally.ranges.signal_unusable > 5, "{tally:?}");
    let (at_mask, _) = sky(strength(28.0), 28.0);
    let (strong, _) = sky(strength(45.0), 28.0);
    let (unknown, _) = sky(|_, range_m| vec![RawSignal::new(Carrier::of(Band::L1), range_m)], 28.0);
    assert_eq!((at_mask.len(), unknown.len()), (strong.len(), strong.len()));
    let sigma_m = |sky: &Sky| {
        let mut tally = Tally::default();
        let site = Site::new(receiver(), TOE, NO_MASK_RAD, Klobuchar::new(CALM));
        let mut epoch = Epoch::new(0.0);
        site.correct(sky, &mut tally, &mut epoch);
        epoch.observations().iter().map(|observation| observation.sigma_m).collect::<Vec<_>>()
    };
    let (weak_m, strong_m) = (sigma_m(&at_mask), sigma_m(&strong));
    assert!(
        weak_m.iter().zip(&strong_m).all(|(weak_m, strong_m)| weak_m > strong_m),
        "{weak_m:?} {strong_m:?}"
    );
    assert_eq!(sigma_m(&unknown), strong_m, "who says nothing is accepted");
    // If a receiver reports the strength of one signal, another without a report counts as weak.
    for strength in [0.0, 45.0] {
        let (mixed, _) = sky(
            |index, range_m| {
                let cn0_dbhz = if index == 0 { 45.0 } else { strength };
                vec![on(Band::L1, range_m, cn0_dbhz)]
            },
            28.0,
        );
        let want_m = if strength > 0.0 { &strong_m } else { &weak_m };
        assert_eq!(sigma_m(&mixed)[1..], want_m[1..], "{strength} dB-Hz");
    }
}

#[test]
fn a_pair_needs_both_carriers_to_be_strong_where_the_receiver_says_how_strong_they_are() {
    let both = |first_dbhz: f32, second_dbhz: f32| {
        move |_, range_m| vec![on(Band::L1, range_m, first_dbhz), on(Band::L2, range_m, second_dbhz)]
    };
    let of_codeless = |_, range_m| {
        let codeless = RawSignal::new(Carrier::of(Band::L2), range_m).codeless();
        vec![on(Band::L1, range_m, 45.0), codeless]
    };
    let ((strong, _), (codeless, _)) = (sky(both(45.0, 45.0), 28.0), sky(of_codeless, 28.0));
    assert!(codeless.iter().all(raim_firmware::correction::Located::has_pair));
    let close = |have: f64, want: f64| (have / want - 1.0).abs() < 1e-6;
    let cost_of_strong = cost(&strong, Ranges::Pairs, 1.0);
    assert!(
        close(cost(&codeless, Ranges::Pairs, 1.0), cost_of_strong),
        "it is as strong as what it is tracked by"
    );
    // A signal with its code and without a report counts as at the mask, because the other has a
    // report.
    let ((unsaid, _), (at_mask, _)) = (sky(both(45.0, 0.0), 28.0), sky(both(45.0, 28.0), 28.0));
    assert!(close(cost(&unsaid, Ranges::Pairs, 1.0), cost(&at_mask, Ranges::Pairs, 1.0)));
    assert!(cost(&unsaid, Ranges::Pairs, 1.0) > 1.5 * cost_of_strong);
    for (first_dbhz, second_dbhz) in [(20.0, 45.0), (45.0, 18.0)] {
        let (weak, _) = sky(both(first_dbhz, second_dbhz), 28.0);
        assert!(!weak.iter().any(raim_firmware::correction::Located::has_pair));
    }
}
