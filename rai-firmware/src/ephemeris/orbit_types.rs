//! The types of orbits of each system. A set of elements that fits none of them is refused.
//!
//! | system | orbit | √A, √m | eccentricity | inclination, ° | source |
//! |---|---|---|---|---|---|
//! | GPS | MEO, 26,560 km | 5140–5167 | to 0.03 | 49–61 | [IS-GPS-200] table 20-III: effective range of `e`; [GPS-SPS-PS] table 3.2-1: 55° ± 3° |
//! | QZSS | inclined, 42,164 km | 6478–6508 | 0.04–0.12 | 30–50 | [IS-QZSS-PNT] 3.1: 0.075, 36° to 45° |
//! | | geostationary | 6478–6508 | to 0.02 | 0–10 | the same |
//! | Galileo | MEO, 29,600 km | 5425–5456 | to 0.02 | 51–61 | [OS-SIS-ICD] 1.1: 56° |
//! | | E14, E18: 27,978 km | 5275–5304 | 0.13–0.2 | 45–55 | European GNSS Service Centre, constellation: 0.162, 49.85° |
//! | `BeiDou` | MEO, 27,906 km | 5268–5297 | to 0.02 | 49–61 | [BDS-SIS-B1I] 3.1: 21,528 km high, 55° |
//! | | inclined, 42,164 km | 6478–6508 | to 0.03 | 45–65 | the same: 35,786 km high, 55° |
//! | | geostationary | 6478–6508 | to 0.02 | to 10 to the equator | the same; table 4-1 for the numbers |
//! | GLONASS | MEO, 25,508 km | 5040–5061 | to 0.03 | 60–70 | [GLO-ICD] 3.1: 64.8° |
//!
//! The bounds leave room for drift: all of 10,000 broadcast sets of 2008 to 2025 are well within
//! them. If semicircles are read as radians, or the reverse, the inclination is far outside, except
//! for some geostationary orbits. The elements of geostationary `BeiDou` satellites refer to a
//! plane tilted by 5°, so that their inclination does not describe the orbit. The angle between
//! orbit and equator does: it was 0.7° to 3.3° in those sets and 4.2° in 2026. Without manoeuvres it
//! grows by up to 0.9° a year, so the bound leaves years, as for QZSS.
//!
//! [IS-GPS-200]: crate#references
//! [GPS-SPS-PS]: crate#references
//! [IS-QZSS-PNT]: crate#references
//! [OS-SIS-ICD]: crate#references
//! [BDS-SIS-B1I]: crate#references
//! [GLO-ICD]: crate#references

use core::ops::RangeInclusive;

use super::Source;

/// An orbit that some satellites of a system have.
#[derive(Debug)]
pub(super) struct OrbitType {
    /// Square root of the semi-major axis, √m.
    sqrt_a_sqrt_m: RangeInclusive<f32>,
    eccentricity: RangeInclusive<f32>,
    /// Inclination to the equator, semicircles.
    inclination_sc: RangeInclusive<f32>,
}

/// A geosynchronous axis, √m.
const SYNCHRONOUS: (f32, f32) = (6478.0, 6508.0);

const GPS: [OrbitType; 1] = [orbit((5140.0, 5167.0), (0.0, 0.03), (49.0, 61.0))];
const QZSS: [OrbitType; 2] =
    [orbit(SYNCHRONOUS, (0.04, 0.12), (30.0, 50.0)), orbit(SYNCHRONOUS, (0.0, 0.02), (0.0, 10.0))];
const GALILEO: [OrbitType; 2] =
    [orbit((5425.0, 5456.0), (0.0, 0.02), (51.0, 61.0)), orbit((5275.0, 5304.0), (0.13, 0.2), (45.0, 55.0))];
const BEIDOU: [OrbitType; 2] =
    [orbit((5268.0, 5297.0), (0.0, 0.02), (49.0, 61.0)), orbit(SYNCHRONOUS, (0.0, 0.03), (45.0, 65.0))];
const BEIDOU_GEOSTATIONARY: [OrbitType; 1] = [orbit(SYNCHRONOUS, (0.0, 0.02), (0.0, 10.0))];

/// Semi-major axes of GLONASS, m.
#[cfg(feature = "glonass")]
pub(super) const GLONASS_AXES_M: RangeInclusive<f64> = 25.40e6..=25.62e6;

/// Greatest eccentricity of GLONASS.
#[cfg(feature = "glonass")]
pub(super) const GLONASS_ECCENTRICITY: f64 = 0.03;

/// Squared cosines of the inclinations of GLONASS, those of 70° and 60°.
#[cfg(feature = "glonass")]
pub(super) const GLONASS_COS2_INCLINATIONS: RangeInclusive<f64> = 0.117..=0.25;

const fn orbit(sqrt_a: (f32, f32), eccentricity: (f32, f32), inclination_deg: (f32, f32)) -> OrbitType {
    OrbitType {
        sqrt_a_sqrt_m: sqrt_a.0..=sqrt_a.1,
        eccentricity: eccentricity.0..=eccentricity.1,
        inclination_sc: inclination_deg.0 / 180.0..=inclination_deg.1 / 180.0,
    }
}

/// Shape and tilt of an orbit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shape {
    /// Square root of the semi-major axis, √m.
    pub(super) sqrt_a_sqrt_m: f64,
    pub(super) eccentricity: f64,
    /// Inclination to the equator, semicircles.
    pub(super) inclination_sc: f64,
}

impl Shape {
    /// Returns true when satellites of this message's system have such an orbit. NaN is in no
    /// range.
    pub(super) fn is_of(&self, source: Source, is_geostationary_beidou: bool) -> bool {
        let types: &[OrbitType] = match source {
            Source::GpsLnav => const { &GPS },
            Source::QzssLnav => const { &QZSS },
            Source::GalileoFnav | Source::GalileoInav => const { &GALILEO },
            Source::BeidouD1D2 if is_geostationary_beidou => const { &BEIDOU_GEOSTATIONARY },
            Source::BeidouD1D2 => const { &BEIDOU },
            // Its orbits are not elements; see `StateVector`.
            Source::GlonassStrings => &[],
        };
        types.iter().any(|known| {
            known.sqrt_a_sqrt_m.contains(&(self.sqrt_a_sqrt_m as f32))
                && known.eccentricity.contains(&(self.eccentricity as f32))
                && known.inclination_sc.contains(&(self.inclination_sc as f32))
        })
    }
}
