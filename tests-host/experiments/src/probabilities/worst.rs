//! The worst bias: rate at which a position is called good and is beyond its level, over every size
//! of the fault.
//!
//! Residuals and position are independent for Gaussian noise, so the rate of wrong promises is a
//! product of two tails, exact to the last significant digits. One grows and the other falls with
//! the bias. The worst size is searched for every satellite that matters:
//!
//! ```text
//! P(b) = P(χ²(ν, (b v)²) < τ) · P(|b A + x| > PL)            worst = max over b and satellites, over P_md
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `ν`, `τ` | degrees of freedom, threshold | – |
//! | `v` | [`Geometry::visibility`] | 1/m |
//! | `A`, `x` | gain of the satellite, noise of the position; of dense least squares | – , m |
//! | `PL` | the core's, in single precision: the papers', and the one that bounds | m |
//!
//! With `BOUND` no level may let pass more than the requirement, with a fault or without; `SLOPE`
//! is shown for comparison. The search includes biases other than the one that corresponds to `√λ`:
//! there the papers' level shows about half of `P_md`, and at two thirds of it up to a hundred
//! times as much.

use anyhow::{Context as _, Result, ensure};
use nalgebra::{Matrix2, Vector2};
use raim::in_order::Together as _;
use raim::second_opinion::chi_square::noncentral_lower_tail;
use raim::signal::sky::Site;
use raim::signal::sky::linear::equations;
use raim_core::internals::integrity::raim::detection::threshold::Thresholds;
use raim_core::internals::integrity::raim::levels::{KFactors, LevelInputs, Levels};
use raim_core::internals::least_squares::Workspace;
use raim_core::internals::numeric::probability::Probability;
use raim_core::report::ProtectionLevels;
use raim_core::requirements::Requirements;

use super::CAPACITY;
use super::disc::beyond;
use super::geometry::Geometry;
use super::skies::{KINDS, Scene, scene, steepest, systems_in_words};
use crate::{Effort, Finding, Judgement, Row, Section};

/// Sizes of the bias, as shares of the one that corresponds to `√λ`.
const SHARES: std::ops::RangeInclusive<u32> = 4..=26;
const SHARE: f64 = 0.05;

/// Number of satellites of a geometry that are tried: those with the largest slopes.
const TRIED: usize = 4;

/// Level above which a geometry promises nothing in any phase, m.
const USELESS_M: f64 = 3704.0;

/// Required probabilities of false alarm and missed detection.
const ASKED: [(f64, f64); 3] = [(3.33e-7, 1e-3), (1e-3, 1e-3), (1e-5, 1e-6)];

/// Risk that a level lets pass, as a multiple of the requirement.
#[derive(Clone, Copy, Debug, Default)]
struct Passing {
    horizontal: f64,
    vertical: f64,
    fault_free: f64,
}

impl Passing {
    fn worse(self, other: Self) -> Self {
        Self {
            horizontal: self.horizontal.max(other.horizontal),
            vertical: self.vertical.max(other.vertical),
            fault_free: self.fault_free.max(other.fault_free),
        }
    }
}

/// Returns a section for each pair of probabilities.
pub(super) fn sections(effort: Effort, site: &Site) -> Result<Vec<Section>> {
    let skies = effort.pick(2, 60);
    ASKED.iter().map(|&(false_alarm, missed)| section(site, skies, false_alarm, missed)).collect()
}

fn section(site: &Site, skies: u64, false_alarm: f64, missed: f64) -> Result<Section> {
    let probability = |value| Probability::new(value).context("a probability");
    let thresholds = Thresholds::from_tables(probability(false_alarm)?, probability(missed)?)?;
    let mut rows = Vec::new();
    for (constellations, counts) in KINDS {
        for &count in counts {
            let drawn = |number: u64| scene(site, constellations, count, number);
            let scenes: Vec<Scene> = (0..skies).together(drawn).flatten().collect();
            ensure!(!scenes.is_empty(), "no sky of {count} satellites of {constellations} systems");
            for (levels, name) in [(Levels::Slope, "SLOPE"), (Levels::Bound, "BOUND")] {
                let passing: Vec<Passing> = scenes
                    .iter()
                    .together(|scene| of_geometry(&scene.geometry, &thresholds, levels, missed))
                    .collect::<Result<_>>()?;
                let worst = passing.into_iter().fold(Passing::default(), Passing::worse);
                rows.push(row(
                    &format!("{count} satellites, {}, {name}", systems_in_words(constellations)),
                    levels,
                    worst,
                ));
            }
        }
    }
    Ok(Section {
        title: format!(
            "Promised and beyond the level over what was asked, at the worst bias of the worst of {skies} skies, \
             P_fa {false_alarm:e}, P_md {missed:e}, P_ff {FAULT_FREE:e}"
        ),
        rows,
    })
}

/// Returns a row with the larger of both axes, and the parts beside it.
fn row(what: &str, levels: Levels, worst: Passing) -> Row {
    let Passing { horizontal, vertical, fault_free } = worst;
    let largest = horizontal.max(vertical);
    let row = Row::new(what, "", Finding::exact(largest, 3), Judgement::Ours).because(format!(
        "horizontal {horizontal:.2}, vertical {vertical:.2} of P_md; without a fault {fault_free:.2e} of P_ff"
    ));
    match levels {
        // The sum over the strips of a disc is accurate to a hundredth of P_ff.
        Levels::Bound => row.holding("at most 1", largest <= 1.0 && fault_free <= 1.01),
        _ => row,
    }
}

fn of_geometry(
    geometry: &Geometry,
    thresholds: &Thresholds<'_>,
    levels: Levels,
    missed: f64,
) -> Result<Passing> {
    let dof = geometry.dof();
    let tau = thresholds.tau1(dof).context("beyond the tables")?;
    let lambda = thresholds.lambda(dof).context("beyond the tables")?;
    let levels = promised(geometry, levels, lambda, missed)?;
    if !(levels.hpl_m < USELESS_M && levels.vpl_m < USELESS_M) {
        return Ok(Passing::default());
    }
    let covariance = &geometry.dense.covariance_m2;
    let ground: Matrix2<f64> = covariance.fixed_view::<2, 2>(0, 0).into_owned();
    let up_m = covariance[(2, 2)].sqrt();
    let over_the_ground = |moved: Vector2<f64>| beyond(levels.hpl_m, moved, ground);
    let in_height = |moved_m: f64| {
        let tail = |distance_m: f64| libm::erfc(distance_m / up_m / std::f64::consts::SQRT_2) / 2.0;
        tail(levels.vpl_m - moved_m) + tail(levels.vpl_m + moved_m)
    };
    let mut worst = Passing {
        fault_free: over_the_ground(Vector2::zeros()).max(in_height(0.0)) / FAULT_FREE,
        ..Passing::default()
    };
    for index in steepest(geometry, TRIED) {
        let per_share_m = lambda.sqrt() / geometry.visibility(index) * SHARE;
        for share in SHARES {
            let bias_m = f64::from(share) * per_share_m;
            let seen = (bias_m * geometry.visibility(index)).powi(2);
            let passed = noncentral_lower_tail(tau, dof, seen).0 / missed;
            let gain = |row: usize| geometry.dense.gain[(row, index)] * bias_m;
            worst = worst.worse(Passing {
                horizontal: passed * over_the_ground(Vector2::new(gain(0), gain(1))),
                vertical: passed * in_height(gain(2)),
                fault_free: 0.0,
            });
        }
    }
    Ok(worst)
}

/// Returns the largest horizontal risk over every size of the fault with `BOUND`, over the required
/// probability of missed detection of a non-precision approach.
pub(super) fn horizontal_risk(geometry: &Geometry, thresholds: &Thresholds<'_>) -> Result<f64> {
    let missed = Requirements::non_precision_approach().missed_detection.get();
    Ok(of_geometry(geometry, thresholds, Levels::Bound, missed)?.horizontal)
}

/// Fault-free risk that a level has to bound.
pub(super) const FAULT_FREE: f64 = 1e-7;

/// Returns the core's protection levels.
fn promised(geometry: &Geometry, levels: Levels, lambda: f64, missed: f64) -> Result<ProtectionLevels> {
    let probability = |value| Probability::new(value).context("a probability");
    let mut workspace = Workspace::<f32, CAPACITY>::of(equations(&geometry.rows)?);
    let snapshot = workspace.solve()?;
    let factors = KFactors::new(probability(missed)?, probability(FAULT_FREE)?);
    Ok(LevelInputs::of(&snapshot, levels, &factors).protect(lambda))
}
