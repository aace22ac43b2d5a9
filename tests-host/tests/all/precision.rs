//! Cost of single precision: every epoch of the recordings is judged by the core in both
//! precisions.
//!
//! ```text
//! |x_f32 − x_f64| ≤ 1 mm      |HPL_f32 − HPL_f64| ≤ 1e-4 HPL      |VPL_f32 − VPL_f64| ≤ 1e-4 VPL
//! ```
//!
//! Both take the same corrected ranges and are independent from there on, each starting from its
//! own last position. Orbits and clocks, integers in either, have their own double-precision
//! reference (`tests-host/tests/module/orbit_reference.rs`).

use raim::replay::{self, Window};
use raim::signal::encode::{Frequency, Selection};
use raim::signal::fault::Fault;
use raim_core::epoch::Epoch;
use raim_core::frame::Ecef;
use raim_core::monitor::Monitor;
use raim_core::report::Report;
use raim_core::requirements::Requirements;
use raim_firmware::correction::{CAPACITY, Klobuchar, Ranges, Site, Sky, Tally, locate};
use raim_firmware::ephemeris::Store;
use raim_firmware::input::{Event, Input};
use raim_firmware::raw::RawEpoch;
use raim_firmware::settings::Systems;
use rig::stations::{DGAR, ESBC, KMS3, STATIC_BASE, Station, TLSE};

const POSITION_M: f64 = 1e-3;
const LEVEL: f64 = 1e-4;
const MASK_RAD: f64 = 10.0 * std::f64::consts::PI / 180.0;

/// The core in both precisions behind the module's own decoding and corrections.
struct Pair {
    input: Input,
    store: Store,
    truth: Ecef,
    klobuchar: Option<Klobuchar>,
    ranges: Ranges,
    singly: raim_single::Monitor,
    doubly: Monitor<f64, CAPACITY>,
    seen: Differences,
}

/// Largest differences so far, and the number of judged epochs.
#[derive(Debug, Default)]
struct Differences {
    epochs: u32,
    left_out: u32,
    position_m: f64,
    levels: f64,
    verdicts: u32,
}

impl Pair {
    fn new(truth: Ecef, klobuchar: Option<Klobuchar>, ranges: Ranges) -> Self {
        let requirements = Requirements::non_precision_approach();
        Self {
            input: Input::new(),
            store: Store::new(),
            truth,
            klobuchar,
            ranges,
            singly: raim_single::Monitor::new(requirements).unwrap(),
            doubly: Monitor::new(requirements).unwrap(),
            seen: Differences::default(),
        }
    }

    fn receive(&mut self, bytes: &[u8]) {
        let mut epochs = Vec::new();
        let Self { input, store, truth, klobuchar, ranges, .. } = self;
        input.feed(bytes, 0, |event| match event {
            Event::Ephemeris(ephemeris) => _ = store.insert(ephemeris, None),
            Event::Epoch(raw, _) => {
                let site = Site::new(*truth, raw.time, MASK_RAD, *klobuchar).with_ranges(*ranges);
                epochs.push(corrected(raw, store, &site));
            }
            _ => {}
        });
        for epoch in &epochs {
            let (one, other) = (raim_single::process(&mut self.singly, epoch), self.doubly.process(epoch));
            self.seen.compare(&one, &other);
        }
    }
}

fn corrected(raw: &RawEpoch, store: &Store, site: &Site) -> Epoch<CAPACITY> {
    let (mut tally, mut sky, mut epoch) = (Tally::default(), Sky::new(), Epoch::new(0.0));
    locate(raw, store, 0.0, Systems::AT_START, &mut tally, &mut sky);
    site.correct(&sky, &mut tally, &mut epoch);
    epoch
}

impl Differences {
    fn compare(&mut self, one: &Report<CAPACITY>, other: &Report<CAPACITY>) {
        self.epochs += 1;
        if (one.verdict, excluded(one)) != (other.verdict, excluded(other)) {
            self.verdicts += 1;
            return;
        }
        self.left_out += u32::from(!one.excluded.is_empty());
        if let (Some(one), Some(other)) = (&one.solution, &other.solution) {
            self.position_m = self.position_m.max(one.position.distance_m(other.position));
        }
        if let (Some(one), Some(other)) = (&one.protection, &other.protection) {
            // Two infinite values have no difference.
            let is_same = |one: f64, other: f64| one.to_bits() == other.to_bits();
            let relative =
                |one: f64, other: f64| if is_same(one, other) { 0.0 } else { (one / other - 1.0).abs() };
            let largest = relative(one.hpl_m, other.hpl_m).max(relative(one.vpl_m, other.vpl_m));
            self.levels = self.levels.max(largest);
        }
    }
}

fn excluded(report: &Report<CAPACITY>) -> Vec<raim_core::satellite::SatelliteId> {
    report.excluded.iter().map(|suspect| suspect.satellite).collect()
}

/// Compares every epoch of a recording with faults, by pairs of ranges and by single ones.
fn differ_by_rounding_alone(station: &Station, faults: &[&str]) {
    let Some(recording) = station.load() else { return };
    let selection = Selection::new("GCE", Frequency::Dual).unwrap();
    let faults: Vec<Fault> = faults.iter().map(|fault| Fault::parse_inject(fault).unwrap()).collect();
    let lumps = replay::encode(&recording, &selection, &faults, &Window::ALL).unwrap();
    for ranges in [Ranges::Pairs, Ranges::Singles] {
        let klobuchar = recording.klobuchar.and_then(Klobuchar::new);
        let mut pair = Pair::new(station.truth, klobuchar, ranges);
        for lump in &lumps {
            pair.receive(&lump.bytes);
        }
        let seen = pair.seen;
        println!("{} {ranges:?}: {seen:?}", station.folder);
        assert!(seen.epochs as usize >= lumps.len() - 1, "{seen:?}");
        assert_eq!(seen.left_out > 0, !faults.is_empty(), "{seen:?}");
        assert_eq!(seen.verdicts, 0, "{seen:?}");
        assert!(seen.position_m <= POSITION_M && seen.levels <= LEVEL, "{seen:?}");
    }
}

#[test]
fn single_precision_moves_no_epoch_of_a_day_with_three_systems() {
    differ_by_rounding_alone(&ESBC, &[]);
}

#[test]
fn single_precision_moves_no_epoch_with_faults() {
    differ_by_rounding_alone(&STATIC_BASE, &["G05:+80@60..120", "C06:-300@100..200"]);
}

#[test]
fn single_precision_moves_no_epoch_of_a_day_near_the_equator() {
    differ_by_rounding_alone(&DGAR, &[]);
}

#[test]
fn single_precision_moves_no_epoch_of_the_short_recordings() {
    differ_by_rounding_alone(&TLSE, &[]);
    differ_by_rounding_alone(&KMS3, &[]);
}
