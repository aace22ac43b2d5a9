//! Ground, ink and colours that all pictures share.
//!
//! Forms make the difference without colours: alerts are hatched in bands, and crosses among dots.
//! Every picture has a text for screen readers. A picture may be as narrow as a telephone: its
//! title and legend then take more lines ([`heading_px`]).

use anyhow::Result;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

pub use plotters::style::RGBColor;

use super::{Verdict, palette};

/// Drawing area of plotters.
pub type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

pub use super::palette::{BLUE, GREEN, GREY, INK, ORANGE, RED, SERIES, TEAL, VIOLET};

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
        Ground::Page => palette::follow_the_page(&text),
    })
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

/// Draws the heading of a picture and its legend below, never on top of the lines themselves.
///
/// # Errors
/// Plotters fails to draw.
pub fn heading(area: &Area<'_>, title: &str, legend: &[(&str, RGBColor, Mark)]) -> Result<()> {
    let width = area.dim_in_pixel().0.cast_signed();
    let (size_px, title) = title_lines(title, width);
    let mut y = 10;
    for line in &title {
        area.draw(&Text::new(line.clone(), (MARGIN_PX, y), text(size_px, INK, HPos::Left, VPos::Top)))?;
        y += LINE_PX;
    }
    let size_px = legend_size_px(legend, width);
    let (mut x, mut y) = (MARGIN_PX, y + 3);
    for &(name, colour, mark) in legend {
        let entry = MARK_PX + width_px(name, size_px);
        if x > MARGIN_PX && x + entry > width {
            (x, y) = (MARGIN_PX, y + LINE_PX);
        }
        swatch(area, x, y + 7, colour, mark)?;
        area.draw(&Text::new(name.to_owned(), (x + 26, y), text(size_px, INK, HPos::Left, VPos::Top)))?;
        x += entry;
    }
    Ok(())
}

/// Margin left and right of a legend, pixels.
const MARGIN_PX: i32 = 14;

/// Width of a legend's entry beside its words, pixels.
const MARK_PX: i32 = 38;

/// Height of a line of a title or of a legend, pixels.
const LINE_PX: i32 = 22;

/// Width below which a picture is one for a telephone, pixels.
pub const NARROW_PX: i32 = 480;

/// Returns the lines of a title and their size. Only a narrow picture breaks them.
fn title_lines(title: &str, width: i32) -> (i32, Vec<String>) {
    if width >= NARROW_PX {
        return (TEXT_PX + 3, vec![title.to_owned()]);
    }
    let mut lines = vec![String::new()];
    for word in title.split_whitespace() {
        let last = lines.last().map_or("", String::as_str);
        let longer = if last.is_empty() { word.to_owned() } else { format!("{last} {word}") };
        if last.is_empty() || width_px(&longer, TEXT_PX + 1) <= width - 2 * MARGIN_PX {
            lines.pop();
            lines.push(longer);
        } else {
            lines.push(word.to_owned());
        }
    }
    (TEXT_PX + 1, lines)
}

/// Returns the size of a legend's words. In a wide picture they are smaller if one line does not
/// hold them; in a narrow one they take several lines.
fn legend_size_px(legend: &[(&str, RGBColor, Mark)], width: i32) -> i32 {
    if width < NARROW_PX {
        return TEXT_PX - 1;
    }
    let words: i32 = legend.iter().map(|(name, _, _)| width_px(name, TEXT_PX)).sum();
    let marks: i32 = legend.iter().map(|_| MARK_PX).sum();
    let room = width - 2 * MARGIN_PX - marks;
    (TEXT_PX * room / words.max(1)).clamp(8, TEXT_PX)
}

/// Returns the height of title and legend in a picture of a width, pixels.
pub fn heading_px(width: i32, title: &str, legend: &[(&str, RGBColor, Mark)]) -> u32 {
    if width >= NARROW_PX {
        return HEADING_PX;
    }
    let (_, title) = title_lines(title, width);
    let (mut lines, mut x) = (title.len() + 1, MARGIN_PX);
    for (name, _, _) in legend {
        let entry = MARK_PX + width_px(name, TEXT_PX - 1);
        if x > MARGIN_PX && x + entry > width {
            (x, lines) = (MARGIN_PX, lines + 1);
        }
        x += entry;
    }
    HEADING_PX + lines.saturating_sub(2) as u32 * LINE_PX.unsigned_abs()
}

/// Height of title and legend of one line each, pixels.
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
