//! The stages by the host's numbers.

use core::hint::black_box;

use heapless::Vec;
use raim_core::epoch::Epoch;
use raim_core::frame::Ecef;
use raim_core::internals::clock::{CoastingClock, WINDOW};
use raim_core::internals::integrity::araim::{Allocation, AraimScratch, Prior, Priors};
use raim_core::internals::integrity::raim::detection::detect;
use raim_core::internals::integrity::raim::detection::threshold::Thresholds;
use raim_core::internals::integrity::raim::detection::threshold::policy::{Policy, ThresholdProblem};
use raim_core::internals::integrity::raim::isolation::{parity, ransac};
use raim_core::internals::integrity::raim::levels::{LevelInputs, largest_slopes};
use raim_core::internals::least_squares::{Snapshot, Workspace};
use raim_core::internals::numeric::real::Real;
use raim_core::internals::weighting::Ism;
use raim_core::monitor::{Method, Monitor, MonitorMemory, Strategy};
use raim_core::report::Report;
use raim_core::requirements::Requirements;
use raim_single::{CAPACITY, stages};

use crate::answer::Answers;
use crate::authentication::authenticate;
use crate::copies;
use crate::epochs::{epoch, point};
use crate::precision::Precision;
use crate::request::{Input, Request};
use crate::roots;
use crate::stopwatch::Stopwatch;
use crate::thread;
use crate::wire;

/// Runs the requested stage; `None` for a request without meaning.
pub fn run(request: &Request<'_>, stopwatch: &mut Stopwatch, answers: &mut Answers) -> Option<()> {
    if request.is_double {
        run_in::<f64>(request, stopwatch, answers)
    } else {
        run_in::<f32>(request, stopwatch, answers)
    }
}

fn run_in<T: Precision>(
    request: &Request<'_>,
    stopwatch: &mut Stopwatch,
    answers: &mut Answers,
) -> Option<()> {
    let input = request.input;
    match request.stage {
        0 => test::<T>(input, stopwatch, answers),
        1 => test_without_worst::<T>(input, stopwatch, answers),
        2 => group(input, stopwatch, answers),
        3 => vote(input, stopwatch, answers),
        4 => select(input, stopwatch, answers),
        5 => coast(input, stopwatch, answers),
        6 => policy(input, stopwatch, answers),
        7 => judge::<T>(input, stopwatch, answers),
        8 => wire::decode(input, stopwatch, answers),
        9 => wire::locate(input, stopwatch, answers),
        10 => wire::correct(input, stopwatch, answers),
        11 => wire::speak(input, stopwatch, answers),
        12 => wire::whole(input, stopwatch, answers),
        13 => separate::<T>(input, stopwatch, answers),
        // The loops take more ticks than the timer has.
        14 => answers.write(0, &copies::compare()),
        15 => answers.write(0, &roots::compare()),
        16 => judge_in_a_thread(input, answers, stages::process_sixteen_in),
        18 => authenticate(input, stopwatch, answers),
        19 => wire::compare(input, stopwatch, answers),
        17 => judge_in_a_thread(input, answers, stages::process_in),
        _ => None,
    }
}

fn requirements() -> Requirements {
    Requirements::non_precision_approach()
}

fn thresholds() -> Option<Thresholds<'static>> {
    Thresholds::from_tables(requirements().false_alarm, requirements().missed_detection).ok()
}

/// Reads start and epoch, and returns the equations at the position.
#[inline(never)]
fn linear<T: Real>(mut input: Input<'_>) -> Option<Workspace<T, CAPACITY>> {
    let start = point(&mut input)?;
    let epoch = epoch(&mut input)?;
    let mut workspace = Workspace::new();
    workspace.fix(&epoch, start).ok()?;
    Some(workspace)
}

/// Times snapshot, global test, w-tests, slopes and protection levels.
#[inline(never)]
fn test<T: Precision>(input: Input<'_>, stopwatch: &mut Stopwatch, answers: &mut Answers) -> Option<()> {
    let (mut workspace, thresholds) = (linear::<T>(input)?, thresholds()?);
    let mut snapshot = workspace.solve().ok()?;
    let (found, ticks) = stopwatch.time(|| {
        solve_in_place(&mut snapshot)?;
        tested(&snapshot, &thresholds)
    });
    answers.write(ticks, &found)
}

/// Solves pass after pass like a fix, with the equations in place. No row was left out that could
/// be taken back.
fn solve_in_place<T: Precision>(snapshot: &mut Snapshot<'_, T, CAPACITY>) -> Option<()> {
    T::take_back(black_box(snapshot), 0).ok()
}

/// Returns the results of a snapshot: statistic, largest w, largest slopes times √λ.
fn tested<T: Precision>(
    snapshot: &Snapshot<'_, T, CAPACITY>,
    thresholds: &Thresholds<'_>,
) -> Option<(bool, usize, [f64; 3])> {
    let detection = detect(snapshot, thresholds)?;
    let (worst, largest, _) = T::worst_two(snapshot)?;
    let lambda: T = thresholds.lambda(snapshot.dof())?;
    let levels = T::largest_slopes(snapshot).protect(lambda.widen());
    Some((detection.fault(), worst, [largest.widen(), levels.hpl_m, levels.vpl_m]))
}

/// Times the same with the worst row left out and the rest tested again.
#[inline(never)]
fn test_without_worst<T: Precision>(
    input: Input<'_>,
    stopwatch: &mut Stopwatch,
    answers: &mut Answers,
) -> Option<()> {
    let (mut workspace, thresholds) = (linear::<T>(input)?, thresholds()?);
    let mut snapshot = workspace.solve().ok()?;
    let (found, ticks) = stopwatch.time(|| {
        solve_in_place(&mut snapshot)?;
        let (_, worst, _) = tested(&snapshot, &thresholds)?;
        T::leave_out(&mut snapshot, worst).ok()?;
        tested(&snapshot, &thresholds)
    });
    answers.write(ticks, &found)
}

/// Times grouping up to a number of rows, given by the first byte.
#[inline(never)]
fn group(mut input: Input<'_>, stopwatch: &mut Stopwatch, answers: &mut Answers) -> Option<()> {
    let rows = usize::from(input.byte()?);
    let (mut workspace, thresholds) = (linear::<f32>(input)?, thresholds()?);
    let snapshot = workspace.solve().ok()?;
    let limits = parity::SearchLimits { rows, ..parity::SearchLimits::published() };
    let (found, ticks) = stopwatch.time(|| {
        let finding = stages::grouping(black_box(&snapshot), &thresholds, &limits);
        (finding.sets, finding.set.is_ok())
    });
    answers.write(ticks, &found)
}

/// Times range consensus with an existing selection.
#[inline(never)]
fn vote(input: Input<'_>, stopwatch: &mut Stopwatch, answers: &mut Answers) -> Option<()> {
    let (mut workspace, thresholds) = (linear::<f32>(input)?, thresholds()?);
    let limits = ransac::ConsensusLimits::published().ok()?;
    let mut snapshot = workspace.solve().ok()?;
    let selection = stages::choose(snapshot.equations(), ransac::MAX_WORK);
    let (found, ticks) = stopwatch.time(|| {
        stages::exclude_by_consensus(black_box(&mut snapshot), &selection, &thresholds, &limits).outcome
    });
    answers.write(ticks, &found)
}

/// Times range consensus with a new selection.
#[inline(never)]
fn select(input: Input<'_>, stopwatch: &mut Stopwatch, answers: &mut Answers) -> Option<()> {
    let (mut workspace, thresholds) = (linear::<f32>(input)?, thresholds()?);
    let limits = ransac::ConsensusLimits::published().ok()?;
    let mut snapshot = workspace.solve().ok()?;
    let (found, ticks) = stopwatch.time(|| {
        let selection = stages::choose(black_box(snapshot.equations()), ransac::MAX_WORK);
        stages::exclude_by_consensus(&mut snapshot, &selection, &thresholds, &limits).outcome
    });
    answers.write(ticks, &found)
}

/// Times ARAIM on an existing snapshot, tests and levels. The first byte states if satellites have
/// nominal biases.
#[inline(never)]
fn separate<T: Precision>(
    mut input: Input<'_>,
    stopwatch: &mut Stopwatch,
    answers: &mut Answers,
) -> Option<()> {
    let has_bias = input.byte()? == 1;
    let mut workspace = linear::<T>(input)?;
    let mut snapshot = workspace.solve().ok()?;
    let mut satellites = Vec::<Prior<T>, CAPACITY>::new();
    for row in snapshot.equations() {
        let support = Ism::RESEARCH.of(row.clock?);
        let accuracy_m = T::narrow(0.8) * row.sigma;
        let bias_m = T::narrow(if has_bias { support.bias_m } else { 0.0 });
        satellites.push(Prior { accuracy_m, bias_m, fault: T::narrow(support.satellite_fault) }).ok()?;
    }
    let constellations = Ism::RESEARCH.constellations.map(|support| T::narrow(support.constellation_fault));
    let allocation = Allocation::vertical_guidance();
    // A monitor keeps this memory.
    let mut room = AraimScratch::new();
    let (found, ticks) = stopwatch.time(|| {
        let priors = Priors { satellites: &satellites, constellations };
        T::separate(black_box(&mut snapshot), &priors, &allocation, &mut room)
    });
    answers.write(ticks, &found.ok()?.whole)
}

/// Times one more value into a full window, and the forecast from it. The input is the clock, one
/// double per second.
#[inline(never)]
fn coast(mut input: Input<'_>, stopwatch: &mut Stopwatch, answers: &mut Answers) -> Option<()> {
    let mut clock = CoastingClock::<f32>::new();
    let mut time_s = 0.0;
    for _ in 0..WINDOW {
        clock.observe(time_s, input.double()?, 0.3);
        time_s += 1.0;
    }
    let next_m = input.double()?;
    let (forecast, ticks) = stopwatch.time(|| {
        stages::observe(black_box(&mut clock), time_s, next_m, 0.3);
        stages::forecast(&clock, time_s + 1.0)
    });
    answers.write(ticks, &forecast)
}

/// Times the threshold of a policy for a new geometry. The first byte is the policy.
#[inline(never)]
fn policy(mut input: Input<'_>, stopwatch: &mut Stopwatch, answers: &mut Answers) -> Option<()> {
    let policy = policy_of(input.byte()?)?;
    let mut workspace = linear::<f32>(input)?;
    let snapshot = workspace.solve().ok()?;
    let (slopes, requirements, thresholds) = (largest_slopes(&snapshot), requirements(), thresholds()?);
    let (found, ticks) = stopwatch.time(|| {
        let demand = ThresholdProblem::new(
            black_box(snapshot.dof()),
            &LevelInputs::to_faults(slopes),
            black_box(&requirements),
            thresholds,
        );
        stages::threshold(&demand, policy)
    });
    answers.write(ticks, &found)
}

/// `process_in` of an instance that is compiled for speed.
type ProcessIn<const N: usize> =
    for<'m> fn(&mut Monitor<f32, N>, &'m mut MonitorMemory<f32, N>, &Epoch<N>) -> &'m Report<N>;

/// Judges as [`judge`], on the stack of a thread that has nothing else on it. The last answer has
/// the bytes of the deepest stack, of the monitor and of its memory.
fn judge_in_a_thread<const N: usize>(
    mut input: Input<'_>,
    answers: &mut Answers,
    process_in: ProcessIn<N>,
) -> Option<()> {
    let mut monitor = monitor::<f32, N>(&mut input)?;
    let mut memory = MonitorMemory::<f32, N>::new();
    let mut deepest = 0;
    for _ in 0..input.byte()? {
        let epoch = epoch::<N>(&mut input)?;
        let used = thread::depth_of(|| {
            process_in(&mut monitor, &mut memory, black_box(&epoch));
        });
        deepest = deepest.max(used);
        answers.write(0, &memory.outcome().report)?;
    }
    answers.write(0, &[deepest, size_of_val(&monitor), size_of_val(&memory)])
}

/// Reads method, policy, clock aiding and start of a monitor.
fn monitor<T: Real, const N: usize>(input: &mut Input<'_>) -> Option<Monitor<T, N>> {
    let strategy = Strategy::CLASSIC
        .with_method(method_of(input.byte()?)?)
        .with_policy(policy_of(input.byte()?)?)
        .with_clock_aid(input.byte()? == 1);
    let mut monitor = Monitor::<T, N>::new(requirements()).ok()?;
    monitor.set_strategy(strategy).ok()?;
    monitor.start_from(start(point(input)?));
    Some(monitor)
}

/// Times one monitor over several epochs: method, policy, clock aiding, start, number of epochs.
/// Each gives an answer.
#[inline(never)]
fn judge<T: Precision>(mut input: Input<'_>, stopwatch: &mut Stopwatch, answers: &mut Answers) -> Option<()> {
    let mut monitor = monitor::<T, CAPACITY>(&mut input)?;
    for _ in 0..input.byte()? {
        let epoch = epoch(&mut input)?;
        let (report, ticks) = stopwatch.time(|| T::process(&mut monitor, black_box(&epoch)));
        answers.write(ticks, &report)?;
    }
    Some(())
}

/// Returns a start position. A new monitor starts from the centre of the earth.
fn start(point: Ecef) -> Ecef {
    if point.radius_m() > 0.0 { point } else { Ecef::CENTRE }
}

fn policy_of(number: u8) -> Option<Policy> {
    [Policy::T1, Policy::T2, Policy::TOp].get(usize::from(number)).copied()
}

fn method_of(number: u8) -> Option<Method> {
    use parity::Isolation::{Grouping, Hybrid, Sequential, Simultaneous};
    let methods = [
        Method::Baarda,
        Method::Parity(Simultaneous),
        Method::Parity(Sequential),
        Method::Parity(Hybrid),
        Method::Parity(Grouping),
        Method::Ransac,
        Method::Araim,
        Method::Auto,
    ];
    methods.get(usize::from(number)).copied()
}
