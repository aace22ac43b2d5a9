//! The residual error of the ionosphere model on one frequency, divided into a part that all ranges
//! share and a part of each range.
//!
//! ```text
//! δI_i = F_i (v + g_E x_i + g_N y_i) + ε_i        F = 1/√(1 − (ρ cos el)²)        ρ = R/(R + h)
//! slant        s_i = max(delay/5, F τ(φ_m)), twice F τ without coefficients
//! v            one sigma max(s_i, 6 m F_i): enters only the levels
//! g_E, g_N     one sigma s_i/(4000 km F_i) each: enter only the levels
//! ε_i          one sigma s_i − (3/4) F τ, which is F τ/4 unless the delay is large: noise of the range
//! x_i = (R + h) e_i (1/F_i − ρ sin el)            y_i the same with n_i
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `v` | vertical error above the receiver, equal for all ranges ([`SharedError::common_m`]) | m |
//! | `g_E`, `g_N` | slopes of the vertical error to the east and the north ([`SharedError::slope_m`]) | – |
//! | `ε_i` | [`IonosphereError::own_m`] | m |
//! | `s_i` | [`IonosphereError::slant_m`]: the whole error, one sigma | m |
//! | `F` | [`obliquity`] of a thin shell at `h` = 350 km | – |
//! | `x_i`, `y_i` | distance from the receiver to the point where the path crosses the shell | m |
//! | `e_i`, `n_i` | east and north of the line of sight | – |
//! | `τ` | least error at the zenith: 9 m at geomagnetic latitudes up to 20°, 4.5 m up to 55°, 6 m above | m |
//!
//! **Why the shared part is not in the sigma.** A test compares ranges with each other. An error
//! that all of them share leaves little in the residuals. If the sigma contains it, the test
//! becomes insensitive: satellites that were 60 m wrong passed. And a level that contains it in the
//! sigmas and again as a shared error counts it twice.
//!
//! **The part of `v` in the residuals.** Above 5° of elevation the obliquity differs from
//! `3.04 − 2.28 sin el` by at most 0.245. The clock absorbs the constant, and the height absorbs
//! the sine. A quarter of `v` remains. As `F ≥ 1`, `F τ/4` covers it at one sigma.
//!
//! **Scatter that `ε_i` also covers.** Near the equator, the vertical delay scatters by 1 m about
//! an offset and two slopes on quiet days. On active days it scatters by 2 m about a quadratic fit
//! ([Marini2021]). A quarter of `τ` is 2.2 m there. At middle latitudes it is 1.1 m; in five
//! recordings of two frequencies the scatter is 0.4 to 1.1 m rms, code noise included.
//!
//! **Slopes.** One sigma is `τ/4000 km`: 1.1 mm/km at middle latitudes and 2.2 mm/km near the
//! equator, and twice that without coefficients. Three sigmas near the equator are 6.7 mm/km,
//! without coefficients 13.5 mm/km. In Brazil, 13 mm/km bounds the slopes of a day ([Chang2021]).
//! In recordings of two frequencies the slopes of the model's error are 0.2 to 1.0 mm/km rms in
//! Denmark, France and on Diego Garcia. In Japan they are 2.4 mm/km rms and at most 2.8 mm/km.
//!
//! **Offset.** At the zenith, three sigmas are 27 m near the equator and 18 m elsewhere. This is
//! the L1 delay of 166 and 111 TECU. Without coefficients they are twice as large.
//!
//! **Large delays.** If a model's delay exceeds `5 F τ`, 139 TECU at middle latitudes, the day is
//! not ordinary or the coefficients are forged. The error may then have any shape, so that the
//! excess over `F τ` counts as noise of the range.
//!
//! The levels contain the largest effect of the three shared errors within an ellipsoid of three
//! sigmas ([`crate::integrity::raim::shared_errors`]).
//!
//! **Limits.** The division is valid only if all ranges of the epoch are of one frequency. If
//! others are ionosphere-free pairs, the error of a range of one frequency is not shared, and all
//! of it is noise. So it is for ARAIM, whose subsets do not bound shared errors. Plasma bubbles
//! have slopes of some hundred mm/km over some hundred kilometres. They affect single satellites
//! and count as faults of these.
//!
//! [Marini2021]: crate#references
//! [Chang2021]: crate#references

use super::shared::SharedError;
use crate::numeric::sqrt;

/// `ρ²`, with R = 6378.1363 km ([DO-229] A.4.4.10.4).
///
/// [DO-229]: crate#references
const RATIO_SQUARED: f32 = 0.898_665_4;

/// `ρ`.
const RATIO: f32 = 0.947_980_7;

/// Ratio of the radius of the shell, 6728 km, to 4000 km, the distance over which a slope amounts
/// to the error itself.
const SHELL: f32 = 6728.136 / 4000.0;

/// Share of the error that differs from range to range.
const OWN: f32 = 0.25;

/// Least sigma of the offset at the zenith, m.
const LEAST_OFFSET_M: f32 = 6.0;

/// Residual error of the ionosphere model on one range, at one sigma.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IonosphereError {
    /// The whole error along the path, m.
    pub slant_m: f32,
    /// Part that differs from range to range, m.
    pub own_m: f32,
    /// Part that all ranges share.
    pub shared: SharedError,
}

impl IonosphereError {
    /// The error of a range that is free of the ionosphere.
    pub const NONE: Self = Self { slant_m: 0.0, own_m: 0.0, shared: SharedError::NONE };

    /// Returns the error of a range on L1 after correction by the broadcast model, if
    /// `is_modelled`.
    ///
    /// `delay_m` is the model's delay along the path, `geomagnetic_sc` the geomagnetic latitude of
    /// the pierce point, in semicircles. The least error is that of [DO-229] appendix J. The model
    /// halves the rms delay ([Klobuchar1987]), so that without it the error is twice the least one.
    ///
    /// [DO-229]: crate#references
    /// [Klobuchar1987]: crate#references
    pub fn of(delay_m: f32, sin_elevation: f32, geomagnetic_sc: f32, is_modelled: bool) -> Self {
        let latitude_deg = 180.0 * geomagnetic_sc.abs();
        let zenith_m = if latitude_deg <= 20.0 {
            9.0
        } else if latitude_deg <= 55.0 {
            4.5
        } else {
            6.0
        };
        let sine = sin_elevation.clamp(0.0, 1.0);
        let cosine_at_shell = cosine_at_shell(sine);
        let obliquity = 1.0 / cosine_at_shell;
        let floor_m = zenith_m * obliquity;
        let (slant_m, known) =
            if is_modelled { (floor_m.max(0.2 * delay_m), 1.0) } else { (2.0 * floor_m, 2.0) };
        Self {
            slant_m,
            own_m: slant_m - (1.0 - OWN) * known * floor_m,
            shared: SharedError {
                common_m: slant_m.max(known * LEAST_OFFSET_M * obliquity),
                slope_m: slant_m * SHELL * (cosine_at_shell - RATIO * sine),
            },
        }
    }

    /// Returns the error on another frequency, `factor` times as large.
    #[must_use]
    pub fn times(self, factor: f32) -> Self {
        let SharedError { common_m, slope_m } = self.shared;
        Self {
            slant_m: factor * self.slant_m,
            own_m: factor * self.own_m,
            shared: SharedError { common_m: factor * common_m, slope_m: factor * slope_m },
        }
    }

    /// Returns the same error, all of it as noise of the range.
    #[must_use]
    pub fn undivided(self) -> Self {
        let shared = SharedError { common_m: self.slant_m, slope_m: 0.0 };
        Self { own_m: self.slant_m, shared, ..self }
    }
}

/// Returns the ratio of a path through the ionosphere to the vertical one, for a thin shell at 350
/// km.
pub fn obliquity(sin_elevation: f32) -> f32 {
    1.0 / cosine_at_shell(sin_elevation.clamp(0.0, 1.0))
}

/// Returns the cosine of the angle between the path and the vertical at the shell, `1/F`.
fn cosine_at_shell(sine: f32) -> f32 {
    sqrt(1.0 - RATIO_SQUARED * (1.0 - sine * sine))
}
