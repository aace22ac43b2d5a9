//! Ground, ink and colours that all pictures share.
//!
//! Colours have one meaning everywhere: green may be used, red must not, grey is unavailable. Forms
//! make the difference without colours: alerts are hatched in bands, and crosses among dots. Every
//! picture has a text for screen readers.

use anyhow::Result;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

pub use plotters::style::RGBColor;

use super::Verdict;

/// Drawing area of plotters.
pub type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Colour of text, axes, grid.
pub const INK: RGBColor = RGBColor(0x24, 0x29, 0x2F);
/// Colour of measurements.
pub const BLUE: RGBColor = RGBColor(0x2F, 0x6F, 0xDE);
/// Colour of the quantity to compare with.
pub const ORANGE: RGBColor = RGBColor(0xE0, 0x7A, 0x1F);
/// Colour of computed bounds.
pub const VIOLET: RGBColor = RGBColor(0x8A, 0x5C, 0xE0);
/// Colour of a position that may be used.
pub const GREEN: RGBColor = RGBColor(0x2E, 0x9E, 0x5B);
/// Colour of a position that must not be used.
pub const RED: RGBColor = RGBColor(0xD6, 0x45, 0x3D);
/// Colour of an unavailable position.
pub const GREY: RGBColor = RGBColor(0x98, 0xA1, 0xAB);
/// Colour of one more line.
pub const TEAL: RGBColor = RGBColor(0x1B, 0x9A, 0xAA);

/// Colours of lines without another meaning, in order.
pub const SERIES: [RGBColor; 6] = [BLUE, ORANGE, GREEN, VIOLET, RED, TEAL];

/// Size of ordinary text, pixels.
pub const TEXT_PX: i32 = 13;

/// Background of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ground {
    /// White, for a picture in a file.
    Sheet,
    /// The page around it, light or dark.
    Page,
}

/// Returns the colour of a verdict.
pub const fn verdict_colour(verdict: Verdict) -> RGBColor {
    match verdict {
        Verdict::Protected => GREEN,
        Verdict::Alert => RED,
        Verdict::Unavailable => GREY,
    }
}

/// Draws a picture of the given width and height in pixels; `title` is its text for screen readers.
///
/// # Errors
/// Plotters fails to draw.
pub fn svg(
    size: (u32, u32),
    ground: Ground,
    title: &str,
    draw: impl FnOnce(&Area<'_>) -> Result<()>,
) -> Result<String> {
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, size).into_drawing_area();
        if ground == Ground::Sheet {
            area.fill(&WHITE)?;
        }
        draw(&area)?;
        area.present()?;
    }
    let title = title.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;");
    let text = text.replacen("<svg ", &format!("<svg role=\"img\" aria-label=\"{title}\" "), 1);
    Ok(match ground {
        Ground::Sheet => text,
        Ground::Page => text.replace(&hexadecimal(INK), "currentColor"),
    })
}

/// Returns a colour in the notation of plotters.
fn hexadecimal(RGBColor(red, green, blue): RGBColor) -> String {
    format!("#{red:02X}{green:02X}{blue:02X}")
}

/// Returns the style of text that is placed by one of its corners.
pub fn text(size_px: i32, colour: RGBColor, horizontal: HPos, vertical: VPos) -> TextStyle<'static> {
    ("sans-serif", size_px).into_font().color(&colour).pos(Pos::new(horizontal, vertical))
}

/// Returns the width of a text, pixels, estimated on the safe side because the fonts are the
/// reader's.
pub fn width_px(words: &str, size_px: i32) -> i32 {
    (words.chars().count() as f64 * f64::from(size_px) * 0.56).ceil() as i32
}

/// Mark of an entry in a legend.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// A full line.
    Line,
    /// A dashed line.
    Dashed,
    /// Dots.
    Dots,
    /// Crosses.
    Crosses,
    /// A filled box.
    Box,
    /// A hatched box.
    Hatched,
    /// A line at the foot of a box: the low level of a pin.
    Low,
}

/// Draws the heading of a picture and its legend in one row below, never on top of the lines
/// themselves.
///
/// # Errors
/// Plotters fails to draw.
pub fn heading(area: &Area<'_>, title: &str, legend: &[(&str, RGBColor, Mark)]) -> Result<()> {
    area.draw(&Text::new(title.to_owned(), (MARGIN_PX, 10), text(TEXT_PX + 3, INK, HPos::Left, VPos::Top)))?;
    let size_px = legend_size_px(legend, area.dim_in_pixel().0.cast_signed());
    let mut x = MARGIN_PX;
    for &(name, colour, mark) in legend {
        swatch(area, x, 42, colour, mark)?;
        area.draw(&Text::new(name.to_owned(), (x + 26, 35), text(size_px, INK, HPos::Left, VPos::Top)))?;
        x += MARK_PX + width_px(name, size_px);
    }
    Ok(())
}

/// Margin left and right of a legend, pixels.
const MARGIN_PX: i32 = 14;

/// Width of a legend's entry beside its words, pixels.
const MARK_PX: i32 = 38;

/// Returns the size of a legend's words, smaller if they do not fit into the width.
fn legend_size_px(legend: &[(&str, RGBColor, Mark)], width: i32) -> i32 {
    let words: i32 = legend.iter().map(|(name, _, _)| width_px(name, TEXT_PX)).sum();
    let marks: i32 = legend.iter().map(|_| MARK_PX).sum();
    let room = width - 2 * MARGIN_PX - marks;
    (TEXT_PX * room / words.max(1)).clamp(8, TEXT_PX)
}

/// Height of title and legend, pixels.
pub const HEADING_PX: u32 = 56;

fn swatch(area: &Area<'_>, x: i32, y: i32, colour: RGBColor, mark: Mark) -> Result<()> {
    let line = |from, to| PathElement::new(vec![(x + from, y), (x + to, y)], colour.stroke_width(2));
    match mark {
        Mark::Line => area.draw(&line(0, 20))?,
        Mark::Dashed => {
            [(0, 5), (8, 13), (15, 20)].into_iter().try_for_each(|(from, to)| area.draw(&line(from, to)))?;
        }
        Mark::Dots => area.draw(&Circle::new((x + 10, y), 4, colour.filled()))?,
        Mark::Crosses => area.draw(&Cross::new((x + 10, y), 4, colour.stroke_width(2)))?,
        Mark::Box => area.draw(&Rectangle::new([(x + 2, y - 6), (x + 18, y + 6)], colour.filled()))?,
        Mark::Hatched => hatched(area, [(x + 2, y - 6), (x + 18, y + 6)], colour)?,
        Mark::Low => {
            area.draw(&PathElement::new(vec![(x + 2, y + 5), (x + 18, y + 5)], colour.stroke_width(2)))?;
        }
    }
    Ok(())
}

/// Pixels between the lines of a hatching.
const HATCH_PX: i32 = 7;

/// Draws a box with white lines across, which differs from a plain one without colours.
///
/// # Errors
/// Plotters fails to draw.
pub fn hatched(area: &Area<'_>, corners: [(i32, i32); 2], colour: RGBColor) -> Result<()> {
    area.draw(&Rectangle::new(corners, colour.filled()))?;
    let [(left, top), (right, bottom)] = corners;
    // Lines of slope one have constant x + y.
    for sum in (left + top..right + bottom).step_by(HATCH_PX as usize) {
        let (from, to) =
            ((left.max(sum - bottom), bottom.min(sum - left)), (right.min(sum - top), top.max(sum - right)));
        area.draw(&PathElement::new(vec![from, to], WHITE.mix(0.8).stroke_width(2)))?;
    }
    Ok(())
}
