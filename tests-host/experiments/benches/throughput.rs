//! Host throughput: epochs per second of a replay or a campaign on this machine.
//!
//! | group | element |
//! |---|---|
//! | `judged/f32`, `judged/f64` | an epoch of satellite positions and ranges, by the monitor with `BAARDA` |
//! | `two faults` | an epoch of 20 satellites of which two are faulty, by each method in `f32` |
//! | `module` | an epoch of RTCM bytes, through the whole module, to its sentences |
//!
//! Times depend on the machine as much as on the program, so they have no budget. The cost of the
//! module is counted in instructions of the target (`rig::bench`).
#![allow(missing_docs, reason = "what the macros of criterion write has no words")]

use std::hint::black_box;

use criterion::{
    BenchmarkGroup, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main,
    measurement::WallTime,
};
use raim::replay::{Lump, Pace, on_host};
use raim_core::internals::integrity::raim::isolation::parity;
use raim_core::internals::numeric::real::Real;
use raim_core::monitor::{Method, Monitor, Strategy};
use raim_core::requirements::Requirements;
use raim_firmware::correction::CAPACITY;
use raim_firmware::time::GpsTime;
use rig::bench::workload::{Stream, Wrong, epoch, site};

/// Numbers of satellites.
const SIZES: [usize; 3] = [8, 20, 40];

/// Number of epochs of RTCM in one run of the module.
const STREAM_EPOCHS: u32 = 60;

fn judge<T: Real>(
    group: &mut BenchmarkGroup<'_, WallTime>,
    id: BenchmarkId,
    method: Method,
    (count, faults): (usize, usize),
) {
    let epoch = epoch(count, 2, faults).expect("a sky of so many");
    let mut monitor =
        Monitor::<T, CAPACITY>::new(Requirements::non_precision_approach()).expect("requirements");
    monitor.set_strategy(Strategy::CLASSIC.with_method(method)).expect("every method is built in");
    monitor.start_from(site().position);
    group.bench_function(id, |bencher| bencher.iter(|| monitor.process(black_box(&epoch))));
}

fn judged<T: Real>(criterion: &mut Criterion, name: &str) {
    let mut group = criterion.benchmark_group(name);
    group.throughput(Throughput::Elements(1));
    for count in SIZES {
        judge::<T>(&mut group, BenchmarkId::from_parameter(count), Method::Baarda, (count, 0));
    }
    group.finish();
}

fn precisions(criterion: &mut Criterion) {
    judged::<f32>(criterion, "judged/f32");
    judged::<f64>(criterion, "judged/f64");
}

fn methods(criterion: &mut Criterion) {
    use parity::Isolation::{Grouping, Hybrid, Sequential, Simultaneous};
    let mut group = criterion.benchmark_group("two faults");
    group.throughput(Throughput::Elements(1));
    let methods = [
        ("BAARDA", Method::Baarda),
        ("SIMULTANEOUS", Method::Parity(Simultaneous)),
        ("SEQUENTIAL", Method::Parity(Sequential)),
        ("HYBRID", Method::Parity(Hybrid)),
        ("GROUPING", Method::Parity(Grouping)),
        ("RANSAC", Method::Ransac),
    ];
    for (name, method) in methods {
        judge::<f32>(&mut group, BenchmarkId::from_parameter(name), method, (20, 2));
    }
    group.finish();
}

fn module(criterion: &mut Criterion) {
    let stream = Stream::with(STREAM_EPOCHS, 20, Wrong::NOTHING).expect("a stream of so many satellites");
    let lump = |(number, bytes): (u32, Vec<u8>)| Lump {
        time: GpsTime { week: 2295, tow_ms: 86_400_000 + 1000 * number },
        elapsed_s: f64::from(number),
        bytes,
    };
    let lumps: Vec<Lump> = (0..).zip(stream.epochs).map(lump).collect();
    let mut group = criterion.benchmark_group("module");
    group.throughput(Throughput::Elements(u64::from(STREAM_EPOCHS)));
    group.bench_function("20 satellites", |bencher| {
        bencher.iter(|| on_host(black_box(&lumps), &[], Pace::LockStep, |_| ()).expect("sentences"));
    });
    group.finish();
}

criterion_group!(throughput, precisions, methods, module);
criterion_main!(throughput);
