//! Most likely noise that causes an outcome, about which the draws are made.

use anyhow::Result;
use nalgebra::{DMatrix, DVector};

use super::{Mode, Trial, set};
use crate::araim::scene::spread;

/// Number of sets most easily confused with the faulty one.
const CONFUSED: usize = 2;

/// Centre of the draws: the fault, the noise, and the outcome that counts.
pub(super) struct Aim {
    pub(super) fault_m: DVector<f64>,
    pub(super) centre: DVector<f64>,
    pub(super) left_out: u64,
}

impl Trial<'_> {
    /// Returns the mode itself, and the modes whose separation is most similar to its own.
    pub(super) fn likely_exclusions(&self, mode: &Mode, axis: usize) -> Result<Vec<Vec<usize>>> {
        let all = self.scene.gains(&[])?;
        let moved = |taken: &[usize]| -> Result<DVector<f64>> {
            Ok(self.noise_gain(&(self.scene.gains(taken)? - &all), axis).normalize())
        };
        let own = moved(&mode.taken)?;
        let mut others: Vec<(f64, &Mode)> = Vec::new();
        for other in self.modes.iter().filter(|other| other.taken != mode.taken) {
            others.push((moved(&other.taken)?.dot(&own).abs(), other));
        }
        others.sort_by(|a, b| b.0.total_cmp(&a.0));
        let confused = others.into_iter().take(CONFUSED).map(|(_, other)| other.taken.clone());
        Ok(std::iter::once(mode.taken.clone()).chain(confused).collect())
    }

    /// Chooses the centre of the draws so that the position is beyond the level and the remaining
    /// tests pass.
    pub(super) fn aim(
        &self,
        mode: &Mode,
        left_out: &[usize],
        levels_m: [f32; 3],
        axis: usize,
        size: f64,
    ) -> Result<Option<Aim>> {
        let (is_right, all) = (left_out == mode.taken, self.scene.gains(&[])?);
        let kept = self.scene.gains(left_out)?;
        let both: Vec<usize> = left_out.iter().chain(&mode.taken).copied().collect();
        let Ok(without) = self.scene.gains(&both) else { return Ok(None) };
        // The threshold of the mode, in the units in which its fault must pass it, or exceed it.
        let moved = if is_right { &kept - &all } else { &without - &kept };
        let accuracies_m = self.scene.satellites.iter().map(|one| one.accuracy_m);
        let threshold_m = self.factors[axis] * spread(moved.row(axis).iter().copied(), accuracies_m);
        let unit = self.unit_fault(mode, axis);
        let per_metre = (if is_right { &all } else { &kept }).row(axis).dot(&unit.transpose());
        if per_metre.abs() < 1e-6 {
            return Ok(None);
        }
        let nominal = self.nominal(&without, axis);
        let fault_m = &unit * (size * threshold_m / per_metre) + nominal;
        let missing_m = self.level_m(levels_m) - kept.row(axis).dot(&fault_m.transpose());
        let towards = self.noise_gain(&kept, axis);
        let seen = self.noise_gain(&(&kept - &without), axis);
        let room_m = threshold_m - (&kept - &without).row(axis).dot(&fault_m.transpose());
        let centre = if is_right {
            &towards * (missing_m.max(0.0) / towards.norm_squared())
        } else {
            nearest(&towards, missing_m, &seen, room_m)
        };
        Ok(Some(Aim { fault_m, centre, left_out: set(left_out) }))
    }

    /// Returns a fault of one metre: of one range, or of a shift along the axis that all members
    /// share.
    pub(super) fn unit_fault(&self, mode: &Mode, axis: usize) -> DVector<f64> {
        let mut fault = DVector::zeros(self.scene.satellites.len());
        for &index in &mode.taken {
            fault[index] = match mode.constellation {
                None => 1.0,
                Some(_) => -self.scene.satellites[index].direction[axis],
            };
        }
        fault
    }

    /// Returns `(S C^½)_q`.
    pub(super) fn noise_gain(&self, gains: &DMatrix<f64>, axis: usize) -> DVector<f64> {
        DVector::from_fn(gains.ncols(), |index, _| {
            gains[(axis, index)] * self.scene.satellites[index].sigma_m
        })
    }

    /// Returns the nominal biases with the signs that move the position most.
    pub(super) fn nominal(&self, gains: &DMatrix<f64>, axis: usize) -> DVector<f64> {
        DVector::from_fn(gains.ncols(), |index, _| {
            gains[(axis, index)].signum() * self.scene.satellites[index].bias_m
        })
    }
}

/// Returns the shortest `z` with `a·z ≥ α` and `d·z ≤ β`.
fn nearest(a: &DVector<f64>, alpha: f64, d: &DVector<f64>, beta: f64) -> DVector<f64> {
    let zero = DVector::zeros(a.len());
    let far = if alpha > 0.0 { a * (alpha / a.norm_squared()) } else { zero.clone() };
    if d.dot(&far) <= beta {
        return far;
    }
    let quiet = d * (beta.min(0.0) / d.norm_squared());
    if a.dot(&quiet) >= alpha {
        return quiet;
    }
    let (aa, ad, dd) = (a.norm_squared(), a.dot(d), d.norm_squared());
    let determinant = aa * dd - ad * ad;
    if determinant <= 1e-9 * aa * dd {
        return far;
    }
    a * ((alpha * dd - beta * ad) / determinant) + d * ((beta * aa - alpha * ad) / determinant)
}

#[cfg(test)]
mod tests {
    use nalgebra::DVector;

    use super::nearest;

    /// In the plane, by hand: `a` alone requires (2, 0); `d` along (1, 1) limits the sum to 1, so
    /// that the corner is (2, −1).
    #[test]
    fn the_nearest_point_is_on_the_borders_that_bind() {
        let vector = |x, y| DVector::from_vec(vec![x, y]);
        let (a, d) = (vector(1.0, 0.0), vector(1.0, 1.0));
        for (alpha, beta, want) in [
            (2.0, 5.0, vector(2.0, 0.0)),
            (2.0, 1.0, vector(2.0, -1.0)),
            (-3.0, 1.0, vector(0.0, 0.0)),
            (-3.0, -2.0, vector(-1.0, -1.0)),
        ] {
            let have = nearest(&a, alpha, &d, beta);
            assert!((&have - &want).norm() < 1e-12, "{alpha} {beta}: have {have}, want {want}");
        }
    }
}
