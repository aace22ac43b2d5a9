//! The stages, by the number that the host gives them.

use core::hint::black_box;

use heapless::Vec;
use rai_core::clock::{CoastingClock, WINDOW};
use rai_core::frame::Ecef;
use rai_core::integrity::araim::{Allocation, AraimScratch, Prior, Priors};
use rai_core::integrity::raim::detection::detect;
use rai_core::integrity::raim::detection::threshold::Thresholds;
use rai_core::integrity::raim::detection::threshold::policy::{Policy, ThresholdProblem};
use rai_core::integrity::raim::isolation::{parity, ransac};
use rai_core::integrity::raim::levels::{LevelInputs, largest_slopes};
use rai_core::least_squares::{Snapshot, Workspace};
use rai_core::monitor::{Method, Monitor, Strategy};
use rai_core::numeric::real::Real;
use rai_core::requirements::Requirements;
use rai_core::single::{CAPACITY, stages};
use rai_core::weighting::Ism;

use crate::answer::Answers;
use crate::epochs::{epoch, point};
use crate::precision::Precision;
use crate::request::{Input, Request};
use crate::stopwatch::Stopwatch;
use crate::wire;

/// Runs what is asked for; `None` where the request makes no sense.
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
        _ => None,
    }
}

fn requirements() -> Requirements {
    Requirements::non_precision_approach()
}

fn thresholds() -> Option<Thresholds<'static>> {
    Thresholds::from_tables(requirements().false_alarm, requirements().missed_detection).ok()
}

/// Start and epoch to the equations about the position.
#[inline(never)]
fn linear<T: Real>(mut input: Input<'_>) -> Option<Workspace<T, CAPACITY>> {
    let start = point(&mut input)?;
    let epoch = epoch(&mut input)?;
    let mut workspace = Workspace::new();
    workspace.fix(&epoch, start).ok()?;
    Some(workspace)
}

/// Snapshot, global test, w-tests, slopes, protection levels.
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

/// As a fix does it, pass after pass: the equations stay where they are. No row was out that could be taken back.
fn solve_in_place<T: Precision>(snapshot: &mut Snapshot<'_, T>) -> Option<()> {
    T::take_back(black_box(snapshot), 0).ok()
}

/// What a snapshot is asked: statistic, largest w, largest slopes times √λ.
fn tested<T: Precision>(
    snapshot: &Snapshot<'_, T>,
    thresholds: &Thresholds<'_>,
) -> Option<(bool, usize, [f64; 3])> {
    let detection = detect(snapshot, thresholds)?;
    let (worst, largest, _) = T::worst_two(snapshot)?;
    let lambda: T = thresholds.lambda(snapshot.dof())?;
    let levels = T::largest_slopes(snapshot).protect(lambda.widen());
    Some((detection.fault(), worst, [largest.widen(), levels.hpl_m, levels.vpl_m]))
}

/// The same with the worst row left out and the rest tested again.
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

/// Grouping up to a number of rows, which the first byte says.
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

/// Range consensus with a selection that is at hand.
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

/// Range consensus with a new selection.
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

/// ARAIM on a snapshot that is at hand, tests and levels. The first byte says whether satellites have nominal biases.
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
    // A monitor keeps it.
    let mut room = AraimScratch::new();
    let (found, ticks) = stopwatch.time(|| {
        let priors = Priors { satellites: &satellites, constellations };
        T::separate(black_box(&mut snapshot), &priors, &allocation, &mut room)
    });
    answers.write(ticks, &found.ok()?.whole)
}

/// One more value into a full window, and the forecast from it. The input is the clock, one double a second.
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

/// The threshold of a policy for a geometry that is new. The first byte is the policy.
#[inline(never)]
fn policy(mut input: Input<'_>, stopwatch: &mut Stopwatch, answers: &mut Answers) -> Option<()> {
    let policy = policy_of(input.byte()?)?;
    let mut workspace = linear::<f32>(input)?;
    let snapshot = workspace.solve().ok()?;
    let (slopes, thresholds) = (largest_slopes(&snapshot), thresholds()?);
    let (found, ticks) = stopwatch.time(|| {
        let demand = ThresholdProblem::new(
            black_box(snapshot.dof()),
            &LevelInputs::to_faults(slopes),
            &requirements(),
            thresholds,
        );
        stages::threshold(&demand, policy)
    });
    answers.write(ticks, &found)
}

/// One monitor over several epochs: method, policy, clock aiding, start, number of epochs. An answer for each.
#[inline(never)]
fn judge<T: Precision>(mut input: Input<'_>, stopwatch: &mut Stopwatch, answers: &mut Answers) -> Option<()> {
    let strategy = Strategy {
        method: method_of(input.byte()?)?,
        policy: policy_of(input.byte()?)?,
        clock_aid: input.byte()? == 1,
        ..Strategy::CLASSIC
    };
    let mut monitor = Monitor::<T, CAPACITY>::new(requirements()).ok()?;
    monitor.set_strategy(strategy);
    monitor.start_from(start(point(&mut input)?));
    for _ in 0..input.byte()? {
        let epoch = epoch(&mut input)?;
        let (report, ticks) = stopwatch.time(|| T::process(&mut monitor, black_box(&epoch)));
        answers.write(ticks, &report)?;
    }
    Some(())
}

/// The centre of the earth is where a monitor starts by itself.
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
