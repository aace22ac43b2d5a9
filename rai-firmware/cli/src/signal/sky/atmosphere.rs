//! Delays of the atmosphere, written independently of the models under test, and simpler. Their
//! differences remain in the ranges, as the model errors of a real receiver do (some centimetres at
//! the zenith).
//!
//! ```text
//! T = (z_h + z_w) m(E)      m(E) = 1.001 / √(0.002001 + sin²E)                 [DO-229] A.4.2.4
//! I = 40.3·10¹⁶ TEC / (f² cos z′)      sin z′ = R cos E / (R + h)              [IS-GPS-200] thin shell
//! ```
//!
//! | symbol | meaning | value |
//! |---|---|---|
//! | `z_h` | hydrostatic zenith delay over the sea | 2.3 m, falling by `exp(−h / 8.4 km)` |
//! | `z_w` | wet zenith delay over the sea | 0.1 m, falling by `exp(−h / 2 km)` |
//! | `TEC` | total electron content, 10¹⁶ electrons/m² | given, the same in all directions |
//! | `h` | height of the shell | 350 km |

/// Mean radius of the earth, m.
const EARTH_RADIUS_M: f64 = 6_371_000.0;

/// Height of the electron shell, m.
const SHELL_HEIGHT_M: f64 = 350_000.0;

/// Returns the delay of the troposphere, m.
pub fn troposphere_m(sin_elevation: f64, height_m: f64) -> f64 {
    let hydrostatic_m = 2.3 * libm::exp(-height_m / 8400.0);
    let wet_m = 0.1 * libm::exp(-height_m / 2000.0);
    (hydrostatic_m + wet_m) * 1.001 / libm::sqrt(0.002_001 + sin_elevation * sin_elevation)
}

/// Returns the delay of a code in the ionosphere, m.
pub fn ionosphere_m(sin_elevation: f64, frequency_hz: f64, electrons_tecu: f64) -> f64 {
    let cos_squared = 1.0 - sin_elevation * sin_elevation;
    let ratio = EARTH_RADIUS_M / (EARTH_RADIUS_M + SHELL_HEIGHT_M);
    let cos_at_shell = libm::sqrt(1.0 - ratio * ratio * cos_squared);
    40.3e16 * electrons_tecu / (frequency_hz * frequency_hz * cos_at_shell)
}
