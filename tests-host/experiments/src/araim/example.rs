//! The worked example of the working group's algorithm description, version 3.1, appendix D, in
//! `f64`.
//!
//! Redundancies, sigmas, threshold factors and levels are the core's. The core does not expose
//! separations and biases of each mode; its own tests compare them with the same numbers. Here they
//! are computed by dense least squares.

use anyhow::{Context as _, Result};
use nalgebra::{DVector, Vector3};
use raim_core::internals::integrity::araim::{Allocation, Priors, judge};
use raim_core::internals::least_squares::{Snapshot, Workspace};
use raim_core::satellite::Constellation;

use super::scene::{Scene, Sighted, spread};
use super::{Finding, Judgement, Row, Section};

/// Direction to the east, north and up, constellation, and variances for integrity and for
/// accuracy, m².
const SATELLITES: [([f64; 3], usize, f64, f64); 10] = [
    ([0.0225, 0.9951, -0.0966], 0, 3.2899, 2.9774),
    ([0.6750, -0.6900, -0.2612], 0, 1.2792, 0.9667),
    ([0.0723, -0.6601, -0.7477], 0, 0.7901, 0.4776),
    ([-0.9398, 0.2553, -0.2269], 0, 1.4430, 1.1305),
    ([-0.5907, -0.7539, -0.2877], 0, 1.1847, 0.8722),
    ([-0.3236, -0.0354, -0.9455], 1, 0.7737, 0.4612),
    ([-0.6748, 0.4356, -0.5957], 1, 0.8233, 0.5108),
    ([0.0938, -0.7004, -0.7075], 1, 0.7962, 0.4837),
    ([0.5571, 0.3088, -0.7709], 1, 0.7871, 0.4746),
    ([0.6622, 0.6958, -0.2780], 1, 1.2166, 0.9041),
];

/// Redundancy, weight over redundancy, 1/m², and the residual's variance under the accuracy's
/// variances, m², by satellite.
const RESIDUALS: [[f64; 3]; 10] = [
    [0.672704, 0.451849, 1.844987],
    [0.522312, 1.496688, 0.475526],
    [0.312970, 4.044034, 0.162860],
    [0.548953, 1.262403, 0.598070],
    [0.542257, 1.556634, 0.458059],
    [0.542907, 2.380687, 0.260149],
    [0.523702, 2.319305, 0.283154],
    [0.370560, 3.389377, 0.211082],
    [0.524540, 2.422096, 0.268599],
    [0.439095, 1.871947, 0.379516],
];

/// Sigma, sigma of the separation, and bias, each to the east, north and up, m: without each
/// satellite, then without each constellation.
#[rustfmt::skip]
const WITHOUT: [[[f64; 3]; 3]; 12] = [
    [[0.62720, 0.84141, 1.69680], [0.07111, 0.35731, 0.01445], [0.88397, 1.06907, 2.40316]],
    [[0.70671, 0.78460, 1.80372], [0.28249, 0.20800, 0.51629], [0.95984, 0.92755, 2.35654]],
    [[0.65871, 0.76488, 2.39293], [0.17515, 0.14109, 1.36939], [0.82008, 0.89673, 2.99520]],
    [[0.70288, 0.77450, 1.71245], [0.28386, 0.18439, 0.20122], [0.91007, 0.93629, 2.41111]],
    [[0.67889, 0.83797, 1.87212], [0.22905, 0.32417, 0.66808], [0.88777, 0.92375, 2.66304]],
    [[0.64474, 0.75196, 1.93523], [0.13256, 0.08114, 0.73245], [0.83217, 0.95931, 2.43263]],
    [[0.73702, 0.75442, 1.71153], [0.31995, 0.09701, 0.18206], [0.96268, 0.94652, 2.34444]],
    [[0.62410, 1.08215, 1.89168], [0.03956, 0.66399, 0.70746], [0.86895, 1.08499, 2.45763]],
    [[0.71989, 0.81122, 1.82956], [0.29185, 0.25918, 0.55203], [0.86075, 1.00719, 2.34376]],
    [[0.70000, 0.76023, 1.95926], [0.27009, 0.12820, 0.82577], [0.86118, 0.89866, 2.52379]],
    [[0.87994, 1.00786, 2.45995], [0.51160, 0.57452, 1.42898], [0.84441, 0.98654, 2.89151]],
    [[0.97982, 1.12400, 2.43593], [0.64753, 0.72050, 1.42171], [0.81575, 0.86979, 2.08751]],
];

fn scene() -> Scene {
    let satellite =
        |&(los, constellation, integrity_m2, accuracy_m2): &([f64; 3], usize, f64, f64)| Sighted {
            constellation: Constellation::ALL[constellation],
            // The example prints the rows of the geometry matrix, which point from the satellite.
            direction: -Vector3::from(los),
            sigma_m: integrity_m2.sqrt(),
            accuracy_m: accuracy_m2.sqrt(),
            bias_m: 0.5,
            fault: 1e-5,
        };
    Scene { satellites: SATELLITES.iter().map(satellite).collect(), constellations: [1e-4, 1e-4, 0.0, 0.0] }
}

/// Returns the section.
pub(super) fn section() -> Result<Section> {
    let scene = scene();
    let mut workspace = Workspace::of(widened(&scene)?);
    let mut snapshot = workspace.solve()?;
    let mut rows = residuals(&scene, &snapshot)?;
    rows.extend(modes(&scene, &mut snapshot)?);
    rows.extend(levels(&scene)?);
    Ok(Section {
        title: "The worked example of the algorithm description 3.1, appendix D: 10 satellites of two constellations"
            .into(),
        rows,
    })
}

fn widened(scene: &Scene) -> Result<raim_core::internals::least_squares::equations::LinearEpoch<f64, 64>> {
    let mut epoch = raim_core::internals::least_squares::equations::LinearEpoch::new();
    for one in &scene.satellites {
        epoch.satellite(one.constellation, one.direction, 0.0, one.sigma_m)?;
    }
    Ok(epoch)
}

fn words(values: &[f64], decimals: u8) -> String {
    let decimals = usize::from(decimals);
    values.iter().map(|value| format!("{value:.decimals$}")).collect::<Vec<_>>().join(" ")
}

/// Returns a row of several numbers, each accurate to its last printed digit.
fn row(quantity: String, have: &[f64], want: &[f64], decimals: u8) -> Row {
    let within = 0.6 * 10f64.powi(-i32::from(decimals));
    let holds =
        have.len() == want.len() && have.iter().zip(want).all(|(have, want)| (have - want).abs() <= within);
    let judgement = if holds { Judgement::Reproduced } else { Judgement::NotReproducible };
    Row::new(quantity, words(want, decimals), Finding::Words(words(have, decimals)), judgement)
        .holding("the last digit", holds)
}

/// Returns redundancy and gauge of the core, and the variance of the residual of dense least
/// squares.
fn residuals(scene: &Scene, snapshot: &Snapshot<'_, f64>) -> Result<Vec<Row>> {
    let all = scene.gains(&[])?;
    let mut rows = Vec::new();
    for (index, want) in RESIDUALS.iter().enumerate() {
        let (row_of, fit) = snapshot.row(index).context("a row")?;
        let without = scene.gains(&[index])?;
        // The separation is the residual's, magnified by the gauge and the gain.
        let gauge = row_of.weight / fit.redundancy;
        let separation = (0..3).map(|axis| {
            let moved = without.row(axis) - all.row(axis);
            let spread_m = spread(moved.iter().copied(), scene.satellites.iter().map(|one| one.accuracy_m));
            (spread_m, all[(axis, index)].abs() / row_of.weight)
        });
        let (spread_m, gain) = separation.max_by(|a, b| a.1.total_cmp(&b.1)).context("an axis")?;
        let variance_m2 = (spread_m / (gauge * gain)).powi(2);
        let have = [fit.redundancy, gauge, variance_m2];
        rows.push(row_of_six(format!("satellite {}: r, w/r, kappa", index + 1), &have, want));
    }
    Ok(rows)
}

fn row_of_six(quantity: String, have: &[f64], want: &[f64]) -> Row {
    row(quantity, have, want, 6)
}

/// Returns sigmas of the core, and separations and biases of dense least squares.
fn modes(scene: &Scene, snapshot: &mut Snapshot<'_, f64>) -> Result<Vec<Row>> {
    let all = scene.gains(&[])?;
    let sets = (0..10).map(|index| vec![index]).chain([0, 1].map(|id| scene.members(Constellation::ALL[id])));
    let mut rows = Vec::new();
    for (number, (taken, [sigma, separation, bias])) in sets.zip(WITHOUT).enumerate() {
        let name = match number {
            0..10 => format!("without satellite {}", number + 1),
            _ => format!("without constellation {}", number - 10),
        };
        let gains = scene.gains(&taken)?;
        let have: [f64; 3] = if let [index] = taken[..] {
            snapshot.leave_out(index)?;
            let covariance = *snapshot.covariance();
            snapshot.take_back(index)?;
            [0, 1, 2].map(|axis| covariance[(axis, axis)].sqrt())
        } else {
            let sigmas = || scene.satellites.iter().map(|one| one.sigma_m);
            [0, 1, 2].map(|axis| spread(gains.row(axis).iter().copied(), sigmas()))
        };
        let accuracies = || scene.satellites.iter().map(|one| one.accuracy_m);
        let moved = &gains - &all;
        let separations = [0, 1, 2].map(|axis| spread(moved.row(axis).iter().copied(), accuracies()));
        let biases = [0, 1, 2].map(|axis| {
            let row = gains.row(axis);
            row.iter().zip(&scene.satellites).map(|(gain, one)| gain.abs() * one.bias_m).sum::<f64>()
        });
        rows.push(row(format!("{name}: sigma E N U / m"), &have, &sigma, 5));
        rows.push(row(format!("{name}: sigma of the separation / m"), &separations, &separation, 5));
        rows.push(row(format!("{name}: bias / m"), &biases, &bias, 5));
    }
    Ok(rows)
}

/// Returns the core's results for the whole.
fn levels(scene: &Scene) -> Result<Vec<Row>> {
    let allocation = {
        let mut allocation = Allocation::vertical_guidance();
        allocation.unmonitored_probability = 8e-8;
        allocation.consolidation = 0.0;
        allocation.exclusion = false;
        allocation
    };
    let priors = Priors { satellites: &scene.priors::<f64>(), constellations: scene.constellations };
    let mut workspace = Workspace::of(scene.epoch::<f64>(&DVector::zeros(10))?);
    let mut snapshot = workspace.solve()?;
    let found = judge(&mut snapshot, &priors, &allocation)?.whole;
    let number = |name: &str, printed: &str, have: f64, want: f64, decimals: usize, within: f64| {
        Row::new(name, printed, Finding::exact(have, decimals), Judgement::Reproduced)
            .holding(format!("{want} ± {within:e}"), (have - want).abs() <= within)
    };
    Ok(vec![
        number("modes", "12", found.modes as f64, 12.0, 0, 0.0),
        number("P_nm / 1e-8", "", found.unmonitored_probability * 1e8, 3.449_595_95, 8, 1e-7),
        number("K, horizontal", "", found.factors[0], 5.894_859_64, 8, 1e-8),
        number("K, vertical", "", found.factors[2], 5.108_340_84, 8, 1e-8),
        // A reported level is never below the root. It may be 0.3 mm above it; here it is closer.
        number("level east / m", "", found.levels_m[0], 8.903_414_15, 6, 1e-5),
        number("level north / m", "", found.levels_m[1], 10.022_778_92, 6, 1e-5),
        number("HPL / m", "13.45", found.hpl_m(), 13.406_225_45, 6, 1e-5),
        number("VPL / m", "18.3", found.vpl_m(), 18.292_447_11, 6, 1e-5)
            .because("printed with steps of 0.05 m; the equation's root is held"),
        number("EMT / m", "7.2998", found.effective_monitor_threshold_m, 7.299_716_71, 6, 1e-8),
        number("sigma of the height for accuracy / m", "1.3694", found.accuracy_m, 1.369_368_32, 6, 1e-8),
    ])
}
