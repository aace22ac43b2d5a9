//! Our own rows: fix and integrity from positions and ranges, as [`stages`] measures them.

use anyhow::{Result, ensure};
use raim_core::frame::Ecef;
use raim_core::internals::numeric::real::Real;
use raim_core::monitor::{Monitor, Strategy};
use raim_core::report::{Report, Verdict};
use raim_core::requirements::Requirements;
use raim_firmware::correction::CAPACITY;

use super::super::stages;
use super::{Core, FAULTS, OURS, Outcome, Row, SATELLITES, Start, epoch, error_m};
use crate::laboratory::{Answer, Bench, Scalar, Stage};

/// Measures single and double precision, from both starts.
///
/// # Errors
/// If the measuring image does not finish, or reports another result than the host.
pub(super) fn measure(core: Core) -> Result<Vec<Row>> {
    let mut rows = Vec::new();
    for (scalar, setting) in [
        (Scalar::Single, "single precision, with HPL and VPL"),
        (Scalar::Double, "double precision, with HPL and VPL"),
    ] {
        for start in Start::ALL {
            rows.push(Row { program: OURS, setting, core, start, outcomes: outcomes(core, scalar, start)? });
        }
    }
    Ok(rows)
}

fn outcomes(core: Core, scalar: Scalar, start: Start) -> Result<Vec<Outcome>> {
    let mut bench = Bench::default();
    for faults in FAULTS {
        let baarda = 0;
        let input = stages::judgement(baarda, start.position(), SATELLITES, &[faults])?;
        bench.request(Stage::Judge, scalar, &input);
    }
    let answers = bench.run_on(core.machine())?;
    ensure!(answers.len() == FAULTS.len(), "{} answers to {} epochs", answers.len(), FAULTS.len());
    FAULTS.into_iter().zip(answers).map(|(faults, answer)| outcome(scalar, start, faults, &answer)).collect()
}

/// Combines the cost on the chip with the answer of the host, which is identical to the bit.
fn outcome(scalar: Scalar, start: Start, faults: usize, answer: &Answer) -> Result<Outcome> {
    let report = match scalar {
        Scalar::Single => judged::<f32>(start, faults)?,
        Scalar::Double => judged::<f64>(start, faults)?,
    };
    ensure!(
        format!("{report:?}") == answer.result,
        "the chip reports {}, the host {report:?}",
        answer.result
    );
    let is_good = matches!(report.verdict, Verdict::Protected(_));
    let left_out = report.excluded.iter().map(|excluded| excluded.satellite.to_string()).collect();
    let solution = report.solution.filter(|_| is_good);
    Ok(Outcome {
        instructions: answer.instructions,
        error_m: solution.map(|solution| error_m(solution.position)),
        left_out,
    })
}

fn judged<T: Real>(start: Start, faults: usize) -> Result<Report<CAPACITY>> {
    let mut monitor = Monitor::<T, CAPACITY>::new(Requirements::non_precision_approach())?;
    monitor.set_strategy(Strategy::CLASSIC)?;
    if start.position() != Ecef::CENTRE {
        monitor.start_from(start.position());
    }
    Ok(monitor.process(&epoch(faults)?))
}
