//! ARAIM for linearised epochs with integrity parameters of each satellite, under the two published
//! allocations.

use raim_core::internals::integrity::araim::{
    self, Allocation, AraimJudgement, AraimOutcome, Finding, Hypothesis, Prior, Priors, ROWS,
};
use raim_core::internals::least_squares::equations::LinearEpoch;
use raim_core::internals::least_squares::{Snapshot, SnapshotError, Workspace};
use raim_core::internals::numeric::real::Real;
use raim_core::satellite::Constellation;
use serde::Serialize;
use serde_json::{Map, Value};

use super::line::{self, Satellite, numbers};
use super::number::Number;

/// Results of the two allocations.
#[derive(Serialize)]
pub(super) struct Araim {
    lpv: Judgement,
    haraim: Judgement,
}

/// Result of one allocation, with the names of the published vectors.
#[derive(Serialize)]
struct Judgement {
    status: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    why: Option<String>,
    #[serde(flatten)]
    found: Option<Found>,
}

#[derive(Serialize)]
#[allow(non_snake_case, reason = "names of the published vectors")]
struct Found {
    n_options: usize,
    rho: Number,
    n_modes: usize,
    p_nm: Number,
    K_fa: [Number; 3],
    x: Vec<Number>,
    pl: [Number; 3],
    hpl: Number,
    vpl: Number,
    emt: Number,
    sigma_v_acc: Number,
    detected: bool,
    max_ratio: Number,
    /// Rows of the mode with the largest share in each level.
    dominant: [Vec<usize>; 3],
    #[serde(flatten)]
    excluded: Option<Excluded>,
}

/// Result after an alarm; null if no exclusion succeeds.
#[derive(Serialize)]
struct Excluded {
    excl: Option<Vec<usize>>,
    hpl_excl: Option<Number>,
    vpl_excl: Option<Number>,
    x_excl: Option<Vec<Number>>,
    p_nm_excl: Option<Number>,
}

/// An epoch with its integrity parameters.
struct Line {
    satellites: Vec<Satellite>,
    accuracies_m: Vec<f64>,
    biases_m: Vec<f64>,
    faults: Vec<f64>,
    constellations: [f64; Constellation::COUNT],
}

/// Evaluates one line.
pub(super) fn evaluate<T: Real>(object: &Map<String, Value>) -> Result<Araim, String> {
    let line = Line::read(object)?;
    Ok(Araim {
        lpv: judge::<T>(&line, &Allocation::vertical_guidance()),
        haraim: judge::<T>(&line, &Allocation::horizontal()),
    })
}

impl Line {
    fn read(object: &Map<String, Value>) -> Result<Self, String> {
        let satellites = line::satellites(object)?;
        if satellites.len() > ROWS {
            return Err(format!("los_enu: {} rows, but at most {ROWS} fit", satellites.len()));
        }
        let list = |name: &str| {
            let list = numbers(line::array(object, name)?, name)?;
            let count = satellites.len();
            let error = format!("{name}: {} entries, but los_enu has {count}", list.len());
            if list.len() == count { Ok(list) } else { Err(error) }
        };
        Ok(Self {
            accuracies_m: list("sigma_acc")?,
            biases_m: list("b_nom")?,
            faults: list("p_sat")?,
            constellations: constellations(object)?,
            satellites,
        })
    }

    fn epoch<T: Real>(&self) -> Result<LinearEpoch<T, ROWS>, String> {
        let mut epoch = LinearEpoch::new();
        for (index, satellite) in self.satellites.iter().enumerate() {
            let Satellite { constellation, line_of_sight, residual_m, sigma_m } = *satellite;
            epoch
                .satellite(constellation, line_of_sight, residual_m, sigma_m)
                .map_err(|error| format!("satellite {index}: {error}"))?;
        }
        Ok(epoch)
    }

    fn priors<T: Real>(&self) -> Vec<Prior<T>> {
        let rows = self.accuracies_m.iter().zip(&self.biases_m).zip(&self.faults);
        let prior = |((&accuracy_m, &bias_m), &fault): ((&f64, &f64), &f64)| Prior {
            accuracy_m: T::narrow(accuracy_m),
            bias_m: T::narrow(bias_m),
            fault: T::narrow(fault),
        };
        rows.map(prior).collect()
    }

    /// Returns the rows that a hypothesis names.
    fn rows_of(&self, hypothesis: Hypothesis) -> Vec<usize> {
        let is_lost =
            |satellite: &Satellite| hypothesis.constellations >> satellite.constellation as u8 & 1 != 0;
        let lost = self.satellites.iter().enumerate().filter(|(_, satellite)| is_lost(satellite));
        let mut rows: Vec<usize> = lost.map(|(index, _)| index).chain(hypothesis.rows()).collect();
        rows.sort_unstable();
        rows
    }
}

/// Reads `p_const`: an object from the constellation's id to its probability.
fn constellations(object: &Map<String, Value>) -> Result<[f64; Constellation::COUNT], String> {
    let by_id = object.get("p_const").and_then(Value::as_object).ok_or("p_const: not an object")?;
    let mut probabilities = [0.0; Constellation::COUNT];
    for (id, value) in by_id {
        let slot = id.parse().ok().and_then(|id: usize| probabilities.get_mut(id));
        *slot.ok_or_else(|| format!("p_const: no constellation {id}"))? =
            value.as_f64().ok_or_else(|| format!("p_const.{id}: not a number"))?;
    }
    Ok(probabilities)
}

fn judge<T: Real>(line: &Line, allocation: &Allocation) -> Judgement {
    let without = |status: &'static str, why: Option<String>| Judgement { status, why, found: None };
    let epoch = match line.epoch::<T>() {
        Ok(epoch) => epoch,
        Err(why) => return without("invalid_input", Some(why)),
    };
    let mut workspace = Workspace::of(epoch);
    let mut snapshot = match workspace.solve() {
        Ok(snapshot) => snapshot,
        Err(SnapshotError::Insufficient) => return without("insufficient", None),
        Err(SnapshotError::Singular) => return without("singular", None),
    };
    let x = unknowns(&snapshot);
    let priors =
        Priors { satellites: &line.priors::<T>(), constellations: line.constellations.map(T::narrow) };
    match araim::judge(&mut snapshot, &priors, allocation) {
        Ok(judged) => {
            let found = Some(found(line, &judged, x, &snapshot));
            Judgement { status: "ok", why: None, found }
        }
        Err(error) => without("invalid_input", Some(error.to_string())),
    }
}

fn found<T: Real>(
    line: &Line,
    judged: &AraimJudgement<T>,
    x: Vec<Number>,
    after: &Snapshot<'_, T, ROWS>,
) -> Found {
    let whole = &judged.whole;
    Found {
        n_options: judged.options,
        rho: wide(judged.risk_share),
        n_modes: whole.modes,
        p_nm: wide(whole.unmonitored_probability),
        K_fa: whole.factors.map(wide),
        x,
        pl: whole.levels_m.map(wide),
        hpl: wide(whole.hpl_m()),
        vpl: wide(whole.vpl_m()),
        emt: wide(whole.effective_monitor_threshold_m),
        sigma_v_acc: wide(whole.accuracy_m),
        detected: whole.alarm,
        max_ratio: wide(whole.ratio),
        dominant: whole.dominant.map(|hypothesis| line.rows_of(hypothesis)),
        excluded: excluded(line, &judged.outcome, after),
    }
}

fn excluded<T: Real>(
    line: &Line,
    outcome: &AraimOutcome<T>,
    after: &Snapshot<'_, T, ROWS>,
) -> Option<Excluded> {
    let level = |finding: &Finding<T>, level: fn(&Finding<T>) -> T| Some(wide(level(finding)));
    match outcome {
        AraimOutcome::Passed => None,
        AraimOutcome::NotIsolated | AraimOutcome::Ambiguous => {
            Some(Excluded { excl: None, hpl_excl: None, vpl_excl: None, x_excl: None, p_nm_excl: None })
        }
        AraimOutcome::Excluded { excluded, finding, .. } => Some(Excluded {
            excl: Some(line.rows_of(*excluded)),
            hpl_excl: level(finding, Finding::hpl_m),
            vpl_excl: level(finding, Finding::vpl_m),
            x_excl: Some(unknowns(after)),
            p_nm_excl: Some(wide(finding.unmonitored_probability)),
        }),
    }
}

/// Returns east, north, up.
fn unknowns<T: Real>(snapshot: &Snapshot<'_, T, ROWS>) -> Vec<Number> {
    snapshot.correction().iter().map(|&coordinate| wide(coordinate)).collect()
}

fn wide<T: Real>(value: T) -> Number {
    Number(value.widen())
}
