//! A published run of MAAST for ARAIM 2: 24 satellites of GPS and Galileo, detection only.
//!
//! Its levels are the upper ends of at most ten halvings, and may lie above the root by a
//! thousandth of the bracket: here 2.3 mm.

use std::fs::File;

use anyhow::{Context as _, Result};
use nalgebra::{DVector, Vector3};
use raim_core::internals::integrity::araim::{Allocation, Priors, judge};
use raim_core::internals::least_squares::Workspace;
use raim_core::satellite::Constellation;
use serde_json::Value;

use super::scene::{Scene, Sighted};
use super::{Finding, Judgement, Row, Section};

/// Largest distance of a published level above the root, m.
const HALVING_M: f64 = 0.0023;

/// Returns the section.
pub(super) fn section() -> Result<Section> {
    let path = oracle::vectors::path("araim_maast.json");
    let run: Value = serde_json::from_reader(File::open(&path).with_context(|| path.display().to_string())?)?;
    let number = |value: &Value| value.as_f64().context("a number of the run");
    let constant = |name: &str| number(&run["constants"][name]);
    let mut allocation = Allocation::vertical();
    allocation.integrity_vertical = constant("phmi_v")?;
    allocation.integrity_horizontal = constant("phmi_h")?;
    allocation.alarm_vertical = constant("p_fa_v")?;
    allocation.alarm_horizontal = constant("p_fa_h")?;
    allocation.unmonitored_probability = constant("p_thres")?;
    allocation.consolidation = constant("fc_thres")?;
    allocation.emt_prior = constant("p_emt")?;
    allocation.exclusion = false;
    let scene = scene(&run)?;
    let mut workspace = Workspace::of(scene.epoch::<f64>(&DVector::zeros(scene.satellites.len()))?);
    let mut snapshot = workspace.solve()?;
    let priors = Priors { satellites: &scene.priors::<f64>(), constellations: scene.constellations };
    let found = judge(&mut snapshot, &priors, &allocation)?.whole;
    let published = |name: &str| number(&run["published"][name]);
    let near = |name: &str, have: f64, printed: f64, decimals: usize, relative: f64| {
        Row::new(name, format!("{printed:.decimals$}"), Finding::exact(have, decimals), Judgement::Reproduced)
            .holding(format!("within {relative:e}"), (have / printed - 1.0).abs() <= relative)
    };
    let level = |name: &str, have: f64, printed: f64| {
        let above_m = printed - have;
        Row::new(name, format!("{printed:.5}"), Finding::exact(have, 5), Judgement::Reproduced)
            .holding("0 to 2.3 mm below", (-3e-4..=HALVING_M).contains(&above_m))
            .because("printed is the upper end of ten halvings")
    };
    Ok(Section {
        title: "A published run of MAAST for ARAIM 2: 12 satellites of GPS and 12 of Galileo".into(),
        rows: vec![
            near("modes", found.modes as f64, published("n_modes")?, 0, 0.0),
            near("P_nm / 1e-8", found.unmonitored_probability * 1e8, published("p_nm")? * 1e8, 6, 1e-6),
            near("EMT / m", found.effective_monitor_threshold_m, published("emt_m")?, 8, 1e-8),
            near(
                "sigma of the height for accuracy / m",
                found.accuracy_m,
                published("sigma_v_acc_m")?,
                8,
                1e-7,
            ),
            level("VPL / m", found.vpl_m(), published("vpl_m")?),
            level("HPL / m", found.hpl_m(), published("hpl_m")?),
        ],
    })
}

fn scene(run: &Value) -> Result<Scene> {
    let number = |value: &Value| value.as_f64().context("a number of the run");
    let of_run = |name: &str| number(&run[name]);
    let (sights, ids) =
        (run["los_enu"].as_array().context("directions")?, run["con"].as_array().context("ids")?);
    let satellite = |(sight, id): (&Value, &Value)| {
        let id = id.as_u64().context("an id")? as usize;
        Ok(Sighted {
            constellation: *Constellation::ALL.get(id).context("a constellation")?,
            direction: Vector3::new(number(&sight[0])?, number(&sight[1])?, number(&sight[2])?),
            sigma_m: of_run("sigma_int_m")?,
            accuracy_m: of_run("sigma_acc_m")?,
            bias_m: of_run("b_nom_m")?,
            fault: of_run("p_sat")?,
        })
    };
    let constellations = [0, 1, 2, 3].map(|id| run["p_const"][id.to_string()].as_f64().unwrap_or(0.0));
    Ok(Scene { satellites: sights.iter().zip(ids).map(satellite).collect::<Result<_>>()?, constellations })
}
