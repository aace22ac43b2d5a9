//! Difference of two colours for readers with and without colour blindness.
//!
//! ```text
//! ΔE₀₀ = √((ΔL′/S_L)² + (ΔC′/S_C)² + (ΔH′/S_H)² + R_T (ΔC′/S_C)(ΔH′/S_H))
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | `L, a, b` | CIELAB under D65 | 1 |
//! | `ΔL′, ΔC′, ΔH′` | differences of lightness, chroma and hue | 1 |
//!
//! Colours are linear sRGB between the steps. A colour-blind reader's colour is the matrix of
//! [Machado2009], table 1 at severity 1, times the colour. The difference is that of [Sharma2005].
//!
//! [Machado2009]: https://doi.org/10.1109/TVCG.2009.113
//! [Sharma2005]: https://doi.org/10.1002/col.20070

use plotters::style::RGBColor;

use super::canvas::Mark;
use super::palette::{LEAST_DIFFERENCE, NAMED};

type Triple = [f64; 3];
type Matrix = [Triple; 3];

/// Readers, each with the matrix of [Machado2009].
const READERS: [(&str, Matrix); 4] = [
    ("all colours", [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
    (
        "protanopia",
        [
            [0.152_286, 1.052_583, -0.204_868],
            [0.114_503, 0.786_281, 0.099_216],
            [-0.003_882, -0.048_116, 1.051_998],
        ],
    ),
    (
        "deuteranopia",
        [
            [0.367_322, 0.860_646, -0.227_968],
            [0.280_085, 0.672_501, 0.047_413],
            [-0.011_820, 0.042_940, 0.968_881],
        ],
    ),
    (
        "tritanopia",
        [
            [1.255_528, -0.076_749, -0.178_779],
            [-0.078_411, 0.930_809, 0.147_602],
            [0.004_733, 0.691_367, 0.303_900],
        ],
    ),
];

/// Linear sRGB to XYZ (IEC 61966-2-1).
const XYZ: Matrix = [
    [0.412_456_4, 0.357_576_1, 0.180_437_5],
    [0.212_672_9, 0.715_152_2, 0.072_175_0],
    [0.019_333_9, 0.119_192_0, 0.950_304_1],
];

/// White of D65.
const WHITE: Triple = [0.950_47, 1.0, 1.088_83];

fn times(matrix: &Matrix, vector: Triple) -> Triple {
    matrix.map(|row| row.iter().zip(vector).map(|(a, b)| a * b).sum())
}

fn linear(RGBColor(red, green, blue): RGBColor) -> Triple {
    [red, green, blue].map(|part| {
        let part = f64::from(part) / 255.0;
        if part <= 0.040_45 { part / 12.92 } else { ((part + 0.055) / 1.055).powf(2.4) }
    })
}

fn lab(linear: Triple) -> Triple {
    const BEND: f64 = 6.0 / 29.0;
    let xyz = times(&XYZ, linear.map(|part| part.clamp(0.0, 1.0)));
    let root = |part: f64| {
        if part > BEND.powi(3) { part.cbrt() } else { part / (3.0 * BEND * BEND) + 4.0 / 29.0 }
    };
    let [x, y, z] = [0, 1, 2].map(|axis| root(xyz[axis] / WHITE[axis]));
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// Returns ΔE₀₀ of two colours in CIELAB.
fn ciede2000([l1, a1, b1]: Triple, [l2, a2, b2]: Triple) -> f64 {
    let seventh = |chroma: f64| (chroma.powi(7) / (chroma.powi(7) + 25.0_f64.powi(7))).sqrt();
    let g = 0.5 * (1.0 - seventh(f64::midpoint(a1.hypot(b1), a2.hypot(b2))));
    let polar = |a: f64, b: f64| {
        let a = (1.0 + g) * a;
        (a.hypot(b), if a == 0.0 && b == 0.0 { 0.0 } else { b.atan2(a).to_degrees().rem_euclid(360.0) })
    };
    let ((c1, h1), (c2, h2)) = (polar(a1, b1), polar(a2, b2));
    let is_grey = c1 * c2 == 0.0;
    let turn = match h2 - h1 {
        _ if is_grey => 0.0,
        turn if turn > 180.0 => turn - 360.0,
        turn if turn < -180.0 => turn + 360.0,
        turn => turn,
    };
    let hue = 2.0 * (c1 * c2).sqrt() * (turn.to_radians() / 2.0).sin();
    let mean = match h1 + h2 {
        sum if is_grey => sum,
        _ if (h1 - h2).abs() <= 180.0 => f64::midpoint(h1, h2),
        sum if sum < 360.0 => f64::midpoint(sum, 360.0),
        sum => f64::midpoint(sum, -360.0),
    };
    let (l, c) = (f64::midpoint(l1, l2), f64::midpoint(c1, c2));
    let cos = |degrees: f64| degrees.to_radians().cos();
    let t = 1.0 - 0.17 * cos(mean - 30.0) + 0.24 * cos(2.0 * mean) + 0.32 * cos(3.0 * mean + 6.0)
        - 0.20 * cos(4.0 * mean - 63.0);
    let s_l = 1.0 + 0.015 * (l - 50.0).powi(2) / (20.0 + (l - 50.0).powi(2)).sqrt();
    let (s_c, s_h) = (1.0 + 0.045 * c, 1.0 + 0.015 * c * t);
    let twist = 30.0 * (-((mean - 275.0) / 25.0).powi(2)).exp();
    let r_t = -(2.0 * twist).to_radians().sin() * 2.0 * seventh(c);
    let (l, c, h) = ((l2 - l1) / s_l, (c2 - c1) / s_c, hue / s_h);
    (l * l + c * c + h * h + r_t * c * h).sqrt()
}

/// Returns the least difference of two colours among all readers, and the reader.
fn least_difference(one: RGBColor, other: RGBColor) -> (f64, &'static str) {
    let of = |(name, matrix): &(&'static str, Matrix)| {
        (ciede2000(lab(times(matrix, linear(one))), lab(times(matrix, linear(other)))), *name)
    };
    READERS.iter().map(of).min_by(|a, b| a.0.total_cmp(&b.0)).unwrap()
}

/// Checks that any two lines differ by colour or by form.
pub(super) fn check(picture: &str, lines: &[(&str, RGBColor, Mark)]) {
    for (index, (one, colour, mark)) in lines.iter().enumerate() {
        for (other, of_other, its_mark) in &lines[..index] {
            let (difference, reader) = least_difference(*colour, *of_other);
            assert!(
                mark != its_mark || difference >= LEAST_DIFFERENCE,
                "{picture}: {one} and {other} differ by {difference:.1} with {reader}"
            );
        }
    }
}

/// Pairs of [Sharma2005], table 1, with their differences: hues on both sides of all cases.
#[rustfmt::skip]
const SHARMA: [([f64; 6], f64); 16] = [
    ([50.0, 2.6772, -79.7751, 50.0, 0.0, -82.7485], 2.0425),
    ([50.0, 3.1571, -77.2803, 50.0, 0.0, -82.7485], 2.8615),
    ([50.0, 2.8361, -74.0200, 50.0, 0.0, -82.7485], 3.4412),
    ([50.0, 0.0, 0.0, 50.0, -1.0, 2.0], 2.3669),
    ([50.0, 2.4900, -0.0010, 50.0, -2.4900, 0.0009], 7.1792),
    ([50.0, 2.4900, -0.0010, 50.0, -2.4900, 0.0011], 7.2195),
    ([50.0, -0.0010, 2.4900, 50.0, 0.0011, -2.4900], 4.7461),
    ([50.0, 2.5, 0.0, 73.0, 25.0, -18.0], 27.1492),
    ([50.0, 2.5, 0.0, 61.0, -5.0, 29.0], 22.8977),
    ([50.0, 2.5, 0.0, 56.0, -27.0, -3.0], 31.9030),
    ([50.0, 2.5, 0.0, 58.0, 24.0, 15.0], 19.4535),
    ([60.2574, -34.0099, 36.2677, 60.4626, -34.1751, 39.4387], 1.2644),
    ([63.0109, -31.0961, -5.8663, 62.8187, -29.7946, -4.0864], 1.2630),
    ([35.0831, -44.1164, 3.7933, 35.0232, -40.0716, 1.5901], 1.8645),
    ([90.8027, -2.0831, 1.4410, 91.1528, -1.6435, 0.0447], 1.4441),
    ([2.0776, 0.0795, -1.1350, 0.9033, -0.0636, -0.5514], 0.9082),
];

#[test]
fn the_difference_is_that_of_the_published_pairs() {
    for ([l1, a1, b1, l2, a2, b2], want) in SHARMA {
        let (one, other) = ([l1, a1, b1], [l2, a2, b2]);
        for have in [ciede2000(one, other), ciede2000(other, one)] {
            assert!((have - want).abs() < 5e-5, "{one:?} {other:?}: {have}");
        }
    }
}

#[test]
fn any_two_colours_differ_for_every_reader_on_light_and_on_dark_pages() {
    let light = NAMED.map(|(name, light, _)| (name, light, Mark::Line));
    check("light", &light);
    check("dark", &NAMED.map(|(name, _, dark)| (name, dark, Mark::Line)));
}

/// The colours before: a violet level beside a blue error.
#[test]
fn a_blue_and_a_violet_of_the_same_lightness_are_found_alike() {
    let (difference, _) = least_difference(RGBColor(0x2F, 0x6F, 0xDE), RGBColor(0x8A, 0x5C, 0xE0));
    assert!(difference < 2.5, "{difference}");
}
