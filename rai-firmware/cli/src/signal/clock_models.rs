//! Other forecasts of a receiver clock, used only for comparison with the core's.
//!
//! ```text
//! Burg          reflection k_m = 2 Σ f b / Σ (f² + b²), σ² ← σ² (1 − k_m²), order 3
//! Yule–Walker   R a = r, r_k = (1/n) Σ x_t x_{t−k}, σ² = r_0 − a·r
//! polynomial    Z(t) = p(t) of degree 1 or 2 by least squares; σ²(h) = s² (1 + q(h)ᵀ (QᵀQ)⁻¹ q(h))
//! ```
//!
//! `x` are centred differences, as in [`raim_core::internals::clock`]; the variance of a forecast is that of
//! the core's process with these coefficients. References: [Chen2009] §2 and table 1.
//!
//! [Chen2009]: crate#references

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

/// Coefficients of the last three differences, and the variance of one step in m².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Process {
    /// `a_1, a_2, a_3`.
    pub coefficients: [f64; 3],
    /// Variance of one step, m².
    pub variance: f64,
}

/// Forecast levels, m, and their standard deviations, m.
#[derive(Clone, Debug, PartialEq)]
pub struct Levels {
    /// Levels one, two, … steps ahead, m.
    pub forecast: Vec<f64>,
    /// Standard deviation of each, m.
    pub sigma_predict: Vec<f64>,
}

/// Returns the first differences without their mean, and the mean.
pub fn centred_differences(levels_m: &[f64]) -> (Vec<f64>, f64) {
    let differences: Vec<f64> = levels_m.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let mean = differences.iter().sum::<f64>() / differences.len().max(1) as f64;
    (differences.iter().map(|difference| difference - mean).collect(), mean)
}

/// Returns Burg's estimate, which is stable, but biased on short records.
pub fn burg(differences: &[f64]) -> Process {
    let squares: f64 = differences.iter().map(|x| x * x).sum();
    let mut variance = squares / differences.len().max(1) as f64;
    let (mut forward, mut backward) = (differences.to_vec(), differences.to_vec());
    let mut coefficients: Vec<f64> = Vec::new();
    for _ in 0..3 {
        let ahead = forward.get(1..).unwrap_or_default();
        let behind = backward.get(..backward.len().saturating_sub(1)).unwrap_or_default();
        let products: f64 = ahead.iter().zip(behind).map(|(f, b)| f * b).sum();
        let squares: f64 = ahead.iter().zip(behind).map(|(f, b)| f * f + b * b).sum();
        let reflection = if squares > 0.0 { 2.0 * products / squares } else { 0.0 };
        let mirrored = coefficients.iter().rev();
        coefficients = coefficients.iter().zip(mirrored).map(|(a, b)| a - reflection * b).collect();
        coefficients.push(reflection);
        variance *= 1.0 - reflection * reflection;
        (forward, backward) =
            ahead.iter().zip(behind).map(|(f, b)| (f - reflection * b, b - reflection * f)).unzip();
    }
    Process { coefficients: [coefficients[0], coefficients[1], coefficients[2]], variance }
}

/// Returns the Yule–Walker estimate from the biased autocovariance; `None` if that is singular.
pub fn yule_walker(differences: &[f64]) -> Option<Process> {
    let count = differences.len() as f64;
    let lagged = |lag: usize| -> f64 {
        differences.iter().zip(differences.iter().skip(lag)).map(|(a, b)| a * b).sum::<f64>() / count
    };
    let (r0, r) = (lagged(0), Vector3::new(lagged(1), lagged(2), lagged(3)));
    let matrix = Matrix3::new(r0, r.x, r.y, r.x, r0, r.x, r.y, r.x, r0);
    let coefficients = matrix.cholesky()?.solve(&r);
    Some(Process { coefficients: coefficients.into(), variance: r0 - coefficients.dot(&r) })
}

impl Process {
    /// Returns the levels after the last one of a series with these centred differences and this
    /// mean difference.
    pub fn levels(&self, last_m: f64, differences: &[f64], mean_m: f64, steps: usize) -> Levels {
        let mut recent: Vec<f64> = differences.iter().rev().take(3).copied().collect();
        let mut response = vec![1.0];
        let (mut level_m, mut level_response, mut squares) = (last_m, 0.0, 0.0);
        let (mut forecast, mut sigma_predict) = (Vec::new(), Vec::new());
        for _ in 0..steps {
            let next = self.weigh(recent.iter());
            recent.insert(0, next);
            level_m += mean_m + next;
            forecast.push(level_m);

            level_response += response[0];
            response.insert(0, self.weigh(response.iter()));
            squares += level_response * level_response;
            sigma_predict.push(libm::sqrt(self.variance * squares));
        }
        Levels { forecast, sigma_predict }
    }

    fn weigh<'a>(&self, latest_first: impl Iterator<Item = &'a f64>) -> f64 {
        self.coefficients.iter().zip(latest_first).map(|(a, x)| a * x).sum()
    }
}

/// Fits a polynomial to the levels and extrapolates it; returns `None` if there are too few.
pub fn polynomial(levels_m: &[f64], degree: usize, steps: usize) -> Option<Levels> {
    let (count, unknowns) = (levels_m.len(), degree + 1);
    let freedom = count.checked_sub(unknowns).filter(|&freedom| freedom > 0)?;
    // Time is counted from the last value, in window lengths, so that the normal equations stay
    // well conditioned.
    let powers =
        |step: f64| DVector::from_fn(unknowns, |power, _| libm::pow(step / count as f64, power as f64));
    let last = count as f64 - 1.0;
    let design = DMatrix::from_fn(count, unknowns, |row, power| powers(row as f64 - last)[power]);
    let levels = DVector::from_column_slice(levels_m);
    let inverse = (design.transpose() * &design).try_inverse()?;
    let solution = &inverse * design.transpose() * &levels;
    let variance = (&levels - &design * &solution).norm_squared() / freedom as f64;
    let ahead = (1..=steps).map(|step| powers(step as f64));
    let (forecast, sigma_predict) = ahead
        .map(|row| (row.dot(&solution), libm::sqrt(variance * (1.0 + row.dot(&(&inverse * &row))))))
        .unzip();
    Some(Levels { forecast, sigma_predict })
}
