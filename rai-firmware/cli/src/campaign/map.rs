//! Maps: boxes of a grid over the globe, coloured by class, with the outline of the land above
//! them.
//!
//! Classes range from dark violet over green to bright yellow ([viridis]). Their lightness alone
//! distinguishes them, for colour-blind readers and on paper. Equal neighbours are drawn as one.
//!
//! [viridis]: https://cran.r-project.org/package=viridis

use anyhow::Result;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::world::shore;
use crate::page::canvas::{Area, Ground, INK, NARROW_PX, RGBColor, TEXT_PX, svg, text, width_px};

/// Colours from the worst class to the best.
const COLOURS: [RGBColor; 8] = [
    RGBColor(68, 1, 84),
    RGBColor(70, 50, 127),
    RGBColor(54, 92, 141),
    RGBColor(39, 127, 142),
    RGBColor(31, 161, 135),
    RGBColor(74, 194, 109),
    RGBColor(159, 218, 58),
    RGBColor(253, 231, 37),
];

/// Quantity and borders of the classes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// Name of the quantity.
    pub label: &'static str,
    /// Borders between the classes, from the worst: seven.
    pub borders: [f64; 7],
    /// Names of the classes.
    pub words: [&'static str; 8],
    /// Factor of the number printed in a box.
    pub factor: f64,
}

/// Share of the instants at which the position may be used.
pub const AVAILABILITY: Scale = Scale {
    label: "availability / %",
    borders: [0.5, 0.75, 0.9, 0.95, 0.99, 0.995, 0.999],
    words: ["< 50", "50", "75", "90", "95", "99", "99.5", "≥ 99.9"],
    factor: 100.0,
};

/// The vertical level that 99 of 100 instants do not exceed.
pub const VERTICAL_LEVEL: Scale = Scale {
    label: "99th percentile of the VPL / m",
    borders: [-50.0, -35.0, -30.0, -25.0, -20.0, -15.0, -10.0],
    words: ["> 50", "50", "35", "30", "25", "20", "15", "≤ 10"],
    factor: -1.0,
};

impl Scale {
    /// Returns the class of a value, from the worst. NaN is in the worst class.
    fn class(&self, value: f64) -> usize {
        self.borders.iter().filter(|&&border| value >= border).count()
    }
}

/// A box of a grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tile {
    /// Latitude of its centre, degrees.
    pub latitude_deg: f64,
    /// Longitude of its centre, degrees.
    pub longitude_deg: f64,
    /// Value; larger is better.
    pub value: f64,
}

/// One map among others.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// Title of the map.
    pub title: String,
    /// Boxes from south to north and from west to east.
    pub tiles: Vec<Tile>,
}

/// Maps beside each other.
#[derive(Clone, Debug, PartialEq)]
pub struct Atlas<'a> {
    /// Title of the whole picture.
    pub title: String,
    /// Maps, line by line.
    pub panels: &'a [Panel],
    /// Number of maps in a line.
    pub columns: i32,
    /// Width of the picture, pixels; 0 for the usual one.
    pub width_px: u32,
    /// Size of a box, degrees.
    pub step_deg: f64,
    /// Scale of the classes.
    pub scale: Scale,
    /// True if each box shows its number.
    pub numbers: bool,
}

/// Usual width of a map, twice its height, pixels.
const WIDTH_PX: i32 = 468;
/// Sizes around a map, pixels.
const GAP_PX: i32 = 16;
const TITLE_PX: i32 = 24;
const TOP_PX: i32 = 40;
const BOTTOM_PX: i32 = 44;

impl Atlas<'_> {
    /// Returns the usual width of the picture, pixels.
    pub fn width_px(&self) -> u32 {
        let columns = self.columns.clamp(1, i32::try_from(self.panels.len()).unwrap_or(1).max(1));
        (GAP_PX + columns * (WIDTH_PX + GAP_PX)).unsigned_abs()
    }

    /// Draws the picture.
    ///
    /// # Errors
    /// If plotters cannot draw it.
    pub fn svg(&self, ground: Ground) -> Result<String> {
        let panels = i32::try_from(self.panels.len())?;
        let columns = self.columns.clamp(1, panels.max(1));
        let lines = (panels + columns - 1) / columns;
        let usual = self.width_px().cast_signed();
        let width = if self.width_px == 0 { usual } else { self.width_px.cast_signed() };
        let map = Map::of((width - GAP_PX) / columns - GAP_PX);
        let bottom = if width < NARROW_PX { BOTTOM_PX + 20 } else { BOTTOM_PX };
        let height = TOP_PX + lines * (map.height + TITLE_PX + GAP_PX) + bottom;
        svg((width.unsigned_abs(), height.unsigned_abs()), ground, &self.title, |area| {
            let style = text(TEXT_PX + 3, INK, HPos::Left, VPos::Top);
            area.draw(&Text::new(self.title.clone(), (GAP_PX, 10), style))?;
            for (index, panel) in (0..).zip(self.panels) {
                let left = GAP_PX + index % columns * (map.width + GAP_PX);
                let top = TOP_PX + index / columns * (map.height + TITLE_PX + GAP_PX);
                self.panel(area, panel, map, (left, top))?;
            }
            self.legend(area, width, height - bottom + 8)
        })
    }

    fn panel(&self, area: &Area<'_>, panel: &Panel, map: Map, (left, top): (i32, i32)) -> Result<()> {
        let size_px = if width_px(&panel.title, TEXT_PX) > map.width { TEXT_PX - 3 } else { TEXT_PX };
        let style = text(size_px, INK, HPos::Left, VPos::Top);
        area.draw(&Text::new(panel.title.clone(), (left, top), style))?;
        let top = top + TITLE_PX;
        let place = |longitude: f64, latitude: f64| {
            let x = f64::from(map.width) * (longitude + 180.0) / 360.0;
            let y = f64::from(map.height) * (90.0 - latitude) / 180.0;
            (left + x.round() as i32, top + y.round() as i32)
        };
        let half = self.step_deg / 2.0;
        let is_next = |a: &Tile, b: &Tile| {
            a.latitude_deg.to_bits() == b.latitude_deg.to_bits()
                && self.scale.class(a.value) == self.scale.class(b.value)
        };
        for run in panel.tiles.chunk_by(is_next) {
            let [first, .., last] = run else {
                let Some(one) = run.first() else { continue };
                self.tile(area, (one, one), half, &place)?;
                continue;
            };
            self.tile(area, (first, last), half, &place)?;
        }
        let shore: Vec<Vec<(i32, i32)>> =
            shore().iter().map(|line| line.iter().map(|&(x, y)| place(x, y)).collect()).collect();
        // White under the line makes it visible on dark boxes as well as on bright ones.
        for style in [WHITE.mix(0.55).stroke_width(2), INK.mix(0.9).stroke_width(1)] {
            for line in &shore {
                let mut corners = line.clone();
                corners.dedup();
                area.draw(&PathElement::new(corners, style))?;
            }
        }
        if self.numbers {
            for tile in &panel.tiles {
                let class = self.scale.class(tile.value);
                let colour = if class < 4 { WHITE } else { RGBColor(0x10, 0x14, 0x18) };
                let words = number(self.scale.factor * tile.value);
                let style = text(8, colour, HPos::Center, VPos::Center);
                area.draw(&Text::new(words, place(tile.longitude_deg, tile.latitude_deg), style))?;
            }
        }
        let frame = Rectangle::new([(left, top), (left + map.width, top + map.height)], INK.mix(0.5));
        area.draw(&frame)?;
        Ok(())
    }

    fn tile(
        &self,
        area: &Area<'_>,
        (first, last): (&Tile, &Tile),
        half_deg: f64,
        place: &impl Fn(f64, f64) -> (i32, i32),
    ) -> Result<()> {
        let corners = [
            place(first.longitude_deg - half_deg, first.latitude_deg + half_deg),
            place(last.longitude_deg + half_deg, first.latitude_deg - half_deg),
        ];
        let colour = COLOURS[self.scale.class(first.value)];
        area.draw(&Rectangle::new(corners, colour.filled()))?;
        Ok(())
    }

    fn legend(&self, area: &Area<'_>, width: i32, y: i32) -> Result<()> {
        let label = text(TEXT_PX, INK, HPos::Left, VPos::Center);
        area.draw(&Text::new(self.scale.label, (GAP_PX, y + 7), label))?;
        // A narrow picture has its classes below their label.
        let beside = GAP_PX + width_px(self.scale.label, TEXT_PX) + 10;
        let (left, y) = if width < NARROW_PX { (GAP_PX, y + 20) } else { (beside, y) };
        let box_px = ((width - left - GAP_PX) / COLOURS.len().try_into().unwrap_or(1)).min(48);
        for (index, (colour, words)) in (0..).zip(COLOURS.iter().zip(self.scale.words)) {
            let x = left + index * box_px;
            area.draw(&Rectangle::new([(x, y), (x + box_px, y + 14)], colour.filled()))?;
            let style = text(TEXT_PX - 2, INK, HPos::Center, VPos::Top);
            area.draw(&Text::new(words, (x + box_px / 2, y + 17), style))?;
        }
        Ok(())
    }
}

/// Size of a map, pixels.
#[derive(Clone, Copy)]
struct Map {
    width: i32,
    height: i32,
}

impl Map {
    const fn of(width: i32) -> Self {
        Self { width, height: width / 2 }
    }
}

/// Formats a value with as few digits as needed.
fn number(value: f64) -> String {
    match value {
        value if !value.is_finite() => "–".to_owned(),
        value if value >= 99.95 => format!("{value:.0}"),
        value => format!("{value:.1}"),
    }
}

#[cfg(test)]
mod tests {
    use super::{AVAILABILITY, VERTICAL_LEVEL};

    #[test]
    fn classes_begin_where_they_say_and_the_worst_is_what_is_not_known() {
        for (value, want) in [(0.0, 0), (0.5, 1), (0.9899, 4), (0.99, 5), (0.999, 7), (1.0, 7), (f64::NAN, 0)]
        {
            assert_eq!(AVAILABILITY.class(value), want, "{value}");
        }
        for (level_m, want) in [(f64::INFINITY, 0), (50.0, 1), (35.0, 2), (12.0, 6), (10.0, 7)] {
            assert_eq!(VERTICAL_LEVEL.class(-level_m), want, "{level_m}");
        }
    }
}
