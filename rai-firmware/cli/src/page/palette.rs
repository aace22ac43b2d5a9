//! Colours of all pictures, on a light and on a dark page.
//!
//! A colour has one meaning everywhere: green may be used, red must not, grey is unavailable. Any
//! two lines of a picture differ by ΔE₀₀ ≥ [`LEAST_DIFFERENCE`] or by their dashes, for all readers
//! and for those with protanopia, deuteranopia or tritanopia. The tests compute the difference by
//! CIEDE2000 [Sharma2005] after the simulation of [Machado2009].
//!
//! [Sharma2005]: https://doi.org/10.1002/col.20070
//! [Machado2009]: https://doi.org/10.1109/TVCG.2009.113

use plotters::style::RGBColor;

/// Colour of text, axes, grid.
pub const INK: RGBColor = RGBColor(0x24, 0x29, 0x2F);
/// Colour of measurements.
pub const BLUE: RGBColor = RGBColor(0x69, 0x76, 0xFF);
/// Colour of the quantity to compare with.
pub const ORANGE: RGBColor = RGBColor(0xD9, 0x69, 0x04);
/// Colour of computed bounds.
pub const VIOLET: RGBColor = RGBColor(0x77, 0x38, 0xA2);
/// Colour of a position that may be used.
pub const GREEN: RGBColor = RGBColor(0x02, 0xB0, 0x74);
/// Colour of a position that must not be used.
pub const RED: RGBColor = RGBColor(0xA8, 0x23, 0x2A);
/// Colour of an unavailable position.
pub const GREY: RGBColor = RGBColor(0x8D, 0x93, 0xA0);
/// Colour of one more line.
pub const TEAL: RGBColor = RGBColor(0x19, 0x6B, 0x67);

/// Colours of lines without another meaning, in order.
pub const SERIES: [RGBColor; 6] = [BLUE, ORANGE, GREEN, VIOLET, RED, TEAL];

/// Least difference of two lines of the same dash, by CIEDE2000.
pub const LEAST_DIFFERENCE: f64 = 15.0;

/// Name of each colour in the style of a page, on light ground and on dark ground.
pub const NAMED: [(&str, RGBColor, RGBColor); 8] = [
    ("ink", INK, RGBColor(0xE6, 0xEB, 0xF0)),
    ("blue", BLUE, RGBColor(0x85, 0x70, 0xFF)),
    ("orange", ORANGE, RGBColor(0xFA, 0xA6, 0x25)),
    ("violet", VIOLET, RGBColor(0x96, 0x5E, 0x94)),
    ("green", GREEN, RGBColor(0x33, 0x82, 0x5E)),
    ("red", RED, RGBColor(0xE4, 0x16, 0x08)),
    ("grey", GREY, RGBColor(0xA3, 0x99, 0x9B)),
    ("teal", TEAL, RGBColor(0x51, 0xCB, 0xFD)),
];

/// Returns a colour as in HTML: `#24292F`.
pub fn hexadecimal(RGBColor(red, green, blue): RGBColor) -> String {
    format!("#{red:02X}{green:02X}{blue:02X}")
}

/// Returns the definitions of all colours, for light and for dark pages.
pub fn style() -> String {
    let all = |pick: fn(&(&str, RGBColor, RGBColor)) -> RGBColor| -> String {
        NAMED
            .iter()
            .flat_map(|named| ["--", named.0, ": ", &hexadecimal(pick(named)), "; "].map(str::to_owned))
            .collect()
    };
    let (light, dark) = (all(|named| named.1), all(|named| named.2));
    format!(":root {{ {light}}}\n@media (prefers-color-scheme: dark) {{ :root {{ {dark}}} }}\n")
}

/// Replaces the colours of a picture by the names of the page's, so that they follow a light or a
/// dark page.
pub fn follow_the_page(svg: &str) -> String {
    let replaced = svg.replace(&hexadecimal(INK), "currentColor");
    NAMED.iter().skip(1).fold(replaced, |svg, (name, light, _)| {
        svg.replace(&format!("\"{}\"", hexadecimal(*light)), &format!("\"var(--{name})\""))
    })
}
