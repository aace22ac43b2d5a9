//! Known-answer tests: they show that this processor and this image compute as tested.
//!
//! | test | source of the known answer |
//! |---|---|
//! | `TABLE` | [Yang2015]: τ1 of 4 degrees of freedom at 3.33e-7, and T1 = 17.9257 m for a sigma of 6 m |
//! | `SOLVE` | a geometry whose least squares can be done by hand |
//! | `FRAME` | WGS 84: the point of the ellipsoid at the parametric latitude of 45° |
//! | `RTCM` | the example of message 1005 in the standard ([RTCM-10403.3] 4.1) |
//!
//! `SOLVE`: four satellites to the east, west, north and south at the elevation with sine 0.6, and
//! one at the zenith. Residuals `(1, 1, −1, −1, 0)` are orthogonal to every column of the design
//! matrix. The position therefore does not move, and the residuals do not change. SSE is 4 with one
//! degree of freedom, and each of the four has the redundancy number 1/4. The test solves by the
//! function that solves epochs, in single precision.
//!
//! `FRAME` tests double precision by a conversion that every epoch needs. With the semi-axes `a`
//! and `b` the point is `(a, 0, b)/√2`; its normal is `(b, 0, a)/√(a² + b²)`, and its height 0.
//!
//! [RTCM-10403.3]: crate#references
//! [Yang2015]: crate#references

use nalgebra::Vector3;
use raim_core::frame::{Ecef, LocalFrame};
use raim_core::internals::integrity::raim::detection::threshold::Thresholds;
use raim_core::internals::numeric::probability::Probability;
use raim_core::internals::numeric::real::Real;
use raim_core::internals::numeric::sqrt_f64;
use raim_core::satellite::Constellation;
use raim_single::{CAPACITY, Workspace};

use crate::input;

/// Test whose result is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Failure {
    /// The threshold tables.
    Table,
    /// The 3×3 solve in single precision.
    Solve,
    /// The frame of a point in double precision.
    Frame,
    /// Framing, CRC and decoding.
    Rtcm,
}

impl Failure {
    /// Returns the name for the host.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Table => "FAIL TABLE",
            Self::Solve => "FAIL SOLVE",
            Self::Frame => "FAIL FRAME",
            Self::Rtcm => "FAIL RTCM",
        }
    }
}

/// Runs all tests. The scratch memory is the caller's, because the equations are too large for some
/// stacks.
///
/// # Errors
/// Returns the first test whose answer is wrong.
pub fn run(workspace: &mut Workspace) -> Result<(), Failure> {
    let demand = |is_right, failure| if is_right { Ok(()) } else { Err(failure) };
    demand(table_is_right(), Failure::Table)?;
    demand(solve_is_right(workspace), Failure::Solve)?;
    demand(frame_is_right(), Failure::Frame)?;
    demand(rtcm_is_right(), Failure::Rtcm)
}

fn is_close(have: f64, want: f64, tolerance: f64) -> bool {
    (have - want).abs() <= tolerance
}

fn table_is_right() -> bool {
    let (Some(false_alarm), Some(missed_detection)) = (Probability::new(3.33e-7), Probability::new(1e-3))
    else {
        return false;
    };
    Thresholds::up_to::<CAPACITY>(false_alarm, missed_detection)
        .ok()
        .and_then(|thresholds| thresholds.tau1::<f32>(4))
        .is_some_and(|tau1| is_close(6.0 * sqrt_f64(f64::from(tau1) / 4.0), 17.925_711, 1e-6))
}

#[inline(never)]
fn solve_is_right(workspace: &mut Workspace) -> bool {
    let directions = [(0.8, 0.0, 0.6), (-0.8, 0.0, 0.6), (0.0, 0.8, 0.6), (0.0, -0.8, 0.6), (0.0, 0.0, 1.0)];
    let residuals_m = [1.0, 1.0, -1.0, -1.0, 0.0];
    workspace.equations_mut().clear();
    for ((east, north, up), residual_m) in directions.into_iter().zip(residuals_m) {
        let direction = Vector3::new(east, north, up);
        if workspace.equations_mut().satellite(Constellation::Gps, direction, residual_m, 1.0).is_err() {
            return false;
        }
    }
    let Ok(snapshot) = raim_single::solve(workspace) else { return false };
    let still = snapshot.correction().iter().all(|component| is_close(component.widen(), 0.0, 1e-5));
    let quarters = snapshot.rows().take(4).all(|(_, fit)| is_close(fit.redundancy.widen(), 0.25, 1e-5));
    still && quarters && snapshot.dof() == 1 && is_close(snapshot.sse().widen(), 4.0, 1e-4)
}

fn frame_is_right() -> bool {
    let frame = LocalFrame::at(Ecef::new(4_510_023.924_036_823, 0.0, 4_494_902.667_726_046));
    let longitude_rad = frame.geodetic().longitude_rad;
    is_close(frame.sin_latitude(), 0.708_293_170_693_72, 1e-12)
        && is_close(frame.height_m(), 0.0, 1e-6)
        && is_close(longitude_rad, 0.0, 1e-15)
}

fn rtcm_is_right() -> bool {
    const FRAME: [u8; 25] = [
        0xD3, 0x00, 0x13, 0x3E, 0xD7, 0xD3, 0x02, 0x02, 0x98, 0x0E, 0xDE, 0xEF, 0x34, 0xB4, 0xBD, 0x62, 0xAC,
        0x09, 0x41, 0x98, 0x6F, 0x33, 0x36, 0x0B, 0x98,
    ];
    let want = Ecef::new(1_114_104.599_9, -4_850_729.710_8, 3_975_521.464_3);
    input::station(&FRAME).is_some_and(|have| have.distance_m(want) < 1e-3)
}

#[cfg(test)]
mod tests {
    #[test]
    fn this_machine_knows_the_answers() {
        assert_eq!(super::run(&mut super::Workspace::new()), Ok(()));
    }
}
