//! Bars in groups: rates or costs of several methods side by side.

use anyhow::{Result, ensure};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::canvas::{Area, Ground, INK, Mark, SERIES, TEXT_PX, heading, heading_px, svg, text, width_px};
use super::chart::{short, ticks};

/// Bars in groups, with axis, legend and title.
#[derive(Clone, Debug, PartialEq)]
pub struct BarChart {
    /// Title of the chart.
    pub title: String,
    /// Quantity and unit of the bars: `rate / %`.
    pub y_label: String,
    /// Quantity and unit of the groups: `bias / m`.
    pub x_label: String,
    /// Names of the groups, from the left.
    pub groups: Vec<String>,
    /// Name and heights of each kind of bar, one height per group; no bar is drawn for a height
    /// that is not finite.
    pub bars: Vec<(String, Vec<f64>)>,
}

/// Pixels around the bars.
const LEFT_PX: i32 = 72;
const RIGHT_PX: i32 = 22;
const BOTTOM_PX: i32 = 50;

impl BarChart {
    /// Returns the chart as SVG of a width and height in pixels.
    ///
    /// # Errors
    /// There is no group, or plotters fails to draw.
    pub fn svg(&self, size: (u32, u32), ground: Ground) -> Result<String> {
        svg(size, ground, &self.title, |area| self.draw(area))
    }

    fn draw(&self, area: &Area<'_>) -> Result<()> {
        ensure!(!self.groups.is_empty(), "chart `{}`: no groups", self.title);
        let colours = SERIES.iter().copied().cycle();
        let legend: Vec<_> = self
            .bars
            .iter()
            .zip(colours)
            .map(|((name, _), colour)| (name.as_str(), colour, Mark::Box))
            .collect();
        heading(area, &self.title, &legend)?;
        let width = area.dim_in_pixel().0.cast_signed();
        let top = heading_px(width, &self.title, &legend).cast_signed() + 4;
        let frame = Frame::of(area, top, self.highest());
        self.axis(area, &frame)?;
        let step = f64::from(frame.right - frame.left) / self.groups.len() as f64;
        for (index, group) in self.groups.iter().enumerate() {
            let left = f64::from(frame.left) + step * index as f64;
            self.group(area, &frame, index, left, step)?;
            let label = text(TEXT_PX - 1, INK, HPos::Center, VPos::Top);
            let middle = (left + step / 2.0) as i32;
            area.draw(&Text::new(group.clone(), (middle, frame.bottom + 6), label))?;
        }
        Ok(())
    }

    fn highest(&self) -> f64 {
        let heights = self.bars.iter().flat_map(|(_, heights)| heights.iter().copied());
        let highest = heights.filter(|height| height.is_finite()).fold(0.0, f64::max);
        if highest > 0.0 { highest * 1.06 } else { 1.0 }
    }

    fn axis(&self, area: &Area<'_>, frame: &Frame) -> Result<()> {
        for tick in ticks(0.0..frame.top_value, 6) {
            let y = frame.y(tick);
            area.draw(&PathElement::new(vec![(frame.left, y), (frame.right, y)], INK.mix(0.14)))?;
            let label = text(TEXT_PX - 1, INK, HPos::Right, VPos::Center);
            area.draw(&Text::new(short(tick), (frame.left - 8, y), label))?;
        }
        let middle = frame.left.midpoint(frame.right);
        let below = text(TEXT_PX, INK, HPos::Center, VPos::Top);
        area.draw(&Text::new(self.x_label.clone(), (middle, frame.bottom + 26), below))?;
        // Rotated text is placed by the corner that comes first in reading order, its lower end.
        let lower = frame.top.midpoint(frame.bottom) + width_px(&self.y_label, TEXT_PX) / 2;
        let turned = text(TEXT_PX, INK, HPos::Left, VPos::Top).transform(FontTransform::Rotate270);
        area.draw(&Text::new(self.y_label.clone(), (12, lower), turned))?;
        Ok(())
    }

    fn group(&self, area: &Area<'_>, frame: &Frame, index: usize, left: f64, step: f64) -> Result<()> {
        let bar = step * 0.76 / self.bars.len() as f64;
        let colours = SERIES.iter().cycle();
        for (position, ((_, heights), colour)) in self.bars.iter().zip(colours).enumerate() {
            let Some(&height) = heights.get(index).filter(|height| height.is_finite()) else { continue };
            let x = left + step * 0.12 + bar * position as f64;
            let corners = [(x as i32, frame.y(height)), ((x + bar - 1.0) as i32, frame.bottom)];
            area.draw(&Rectangle::new(corners, colour.filled()))?;
        }
        Ok(())
    }
}

/// Frame of the bars, pixels.
struct Frame {
    left: i32,
    right: i32,
    top: i32,
    bottom: i32,
    top_value: f64,
}

impl Frame {
    fn of(area: &Area<'_>, top: i32, top_value: f64) -> Self {
        let (width, height) = area.dim_in_pixel();
        Self {
            left: LEFT_PX,
            right: width.cast_signed() - RIGHT_PX,
            top,
            bottom: height.cast_signed() - BOTTOM_PX,
            top_value,
        }
    }

    fn y(&self, value: f64) -> i32 {
        self.bottom - (f64::from(self.bottom - self.top) * value / self.top_value) as i32
    }
}
