//! ARAIM by the core of this project.

use anyhow::{Result, anyhow};
use raim_core::internals::least_squares::equations::LinearEpoch;
use raim_core::internals::integrity::araim::{self, Allocation, Prior, Priors, ROWS};
use raim_core::internals::numeric::real::Real;
use raim_core::satellite::Constellation;
use raim_core::internals::least_squares::{Snapshot, Workspace};

use super::{Answer, Line};

/// Judges an epoch.
pub(super) fn judge<T: Real>(line: &Line) -> Result<Answer> {
    with::<T, _>(line, |snapshot, priors| {
        let judged = araim::judge(snapshot, priors, &Allocation::vertical_guidance())
            .map_err(|error| anyhow!("{error}"))?;
        let whole = &judged.whole;
        Ok(Answer { modes: whole.modes, levels_m: [whole.hpl_m().widen(), whole.vpl_m().widen()] })
    })
}

/// Returns the time from the solved snapshot on, µs.
pub(super) fn microseconds<T: Real>(line: &Line) -> Result<f64> {
    let allocation = Allocation::vertical_guidance();
    with::<T, _>(line, |snapshot, priors| {
        Ok(super::microseconds(|| araim::judge(snapshot, priors, &allocation).is_ok()))
    })
}

fn with<T: Real, R>(
    line: &Line,
    work: impl FnOnce(&mut Snapshot<'_, T, ROWS>, &Priors<'_, T>) -> Result<R>,
) -> Result<R> {
    let mut epoch = LinearEpoch::<T, ROWS>::new();
    for (index, &constellation) in line.con.iter().enumerate() {
        let constellation = Constellation::ALL[constellation];
        epoch
            .satellite(constellation, line.los_enu[index].into(), line.y[index], line.sigma[index])
            .map_err(|error| anyhow!("satellite {index}: {error}"))?;
    }
    let satellites: Vec<Prior<T>> = (0..line.con.len())
        .map(|index| Prior {
            accuracy_m: T::narrow(line.sigma_acc[index]),
            bias_m: T::narrow(line.b_nom[index]),
            fault: T::narrow(line.p_sat[index]),
        })
        .collect();
    let mut constellations = [T::zero(); Constellation::COUNT];
    for (id, &probability) in &line.p_const {
        constellations[id.parse::<usize>()?] = T::narrow(probability);
    }
    let mut workspace = Workspace::of(epoch);
    let mut snapshot = workspace.solve().map_err(|error| anyhow!("{error:?}"))?;
    work(&mut snapshot, &Priors { satellites: &satellites, constellations })
}
