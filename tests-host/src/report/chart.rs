//! Lines over an axis: any quantity with its unit, linear or logarithmic.
//!
//! A value that is not finite, or not positive on a logarithmic axis, is a gap in its line.

use std::ops::Range;

use anyhow::{Result, ensure};
use plotters::coord::ranged1d::{AsRangedCoord, BoldPoints, Ranged, ValueFormatter};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::canvas::{Area, Ground, HEADING_PX, INK, Mark, TEXT_PX, heading, svg, text};

/// How an axis counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Evenly.
    Linear,
    /// By powers of ten.
    Logarithmic,
}

/// An axis: what it shows, in which unit, how far.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Quantity and unit: `time / s`.
    pub label: String,
    /// How it counts.
    pub scale: Scale,
    /// From where to where; `None` fits the lines.
    pub range: Option<Range<f64>>,
}

impl Axis {
    /// A linear axis that fits its lines.
    pub fn linear(label: &str) -> Self {
        Self { label: label.to_owned(), scale: Scale::Linear, range: None }
    }

    /// A logarithmic axis that fits its lines.
    pub fn logarithmic(label: &str) -> Self {
        Self { label: label.to_owned(), scale: Scale::Logarithmic, range: None }
    }

    /// The same axis from here to there.
    #[must_use]
    pub fn over(mut self, range: Range<f64>) -> Self {
        self.range = Some(range);
        self
    }

    /// Whether the axis has a place for a value.
    fn shows(&self, value: f64) -> bool {
        value.is_finite() && (self.scale == Scale::Linear || value > 0.0)
    }

    /// The range asked for, or one that holds all values with some air.
    fn fitted(&self, values: impl Iterator<Item = f64>) -> Range<f64> {
        if let Some(range) = &self.range {
            return range.clone();
        }
        let (low, high) = values
            .filter(|&value| self.shows(value))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
        match self.scale {
            _ if low > high => 0.1..1.0,
            // Whole powers of ten, so that at least two of them are labelled.
            Scale::Logarithmic => {
                let (floor, ceiling) = (low.log10().floor(), (high * 1.05).log10().ceil());
                10_f64.powf(floor) * EDGE..10_f64.powf(ceiling.max(floor + 1.0))
            }
            Scale::Linear => {
                let air = if high > low { 0.06 * (high - low) } else { 1.0 };
                // Quantities that are never negative keep their zero.
                let floor = if low >= 0.0 { (low - air).max(0.0) } else { low - air };
                floor..high + air
            }
        }
    }
}

/// One line of a chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Name in the legend; empty where the legend needs none.
    pub name: String,
    /// Its colour.
    pub colour: RGBColor,
    /// How it is drawn.
    pub mark: Mark,
    /// Its points, in the units of the axes.
    pub points: Vec<(f64, f64)>,
}

/// A stretch of the x axis with a tint: while a fault lasts, for instance.
#[derive(Clone, Debug, PartialEq)]
pub struct Span {
    /// Name in the legend.
    pub name: String,
    /// From where to where.
    pub range: Range<f64>,
    /// Its colour, thinned.
    pub colour: RGBColor,
}

/// Lines with axes, legend and title.
#[derive(Clone, Debug, PartialEq)]
pub struct LineChart {
    /// What it shows.
    pub title: String,
    /// The x axis.
    pub x: Axis,
    /// The y axis.
    pub y: Axis,
    /// The lines, the first at the back.
    pub series: Vec<Series>,
    /// Tinted stretches.
    pub spans: Vec<Span>,
}

impl LineChart {
    /// The chart as SVG of a width and height in pixels.
    ///
    /// # Errors
    /// An empty range, or what plotters could not draw.
    pub fn svg(&self, size: (u32, u32), ground: Ground) -> Result<String> {
        svg(size, ground, &self.title, |area| self.draw(area))
    }

    /// Draws into an area of any picture.
    ///
    /// # Errors
    /// An empty range, or what plotters could not draw.
    pub fn draw(&self, area: &Area<'_>) -> Result<()> {
        let named = self.series.iter().filter(|series| !series.name.is_empty());
        let lines = named.map(|series| (series.name.as_str(), series.colour, series.mark));
        let spans = self.spans.iter().map(|span| (span.name.as_str(), thinned(span.colour), Mark::Box));
        let mut legend: Vec<_> = lines.chain(spans).collect();
        // Stretches of the same kind need one entry; they follow each other.
        legend.dedup();
        heading(area, &self.title, &legend)?;
        let points = || self.series.iter().flat_map(|series| series.points.iter());
        let x = self.x.fitted(points().map(|point| point.0));
        let y = self.y.fitted(points().map(|point| point.1));
        ensure!(x.start < x.end && y.start < y.end, "chart `{}`: an axis is empty", self.title);
        match (self.x.scale, self.y.scale) {
            (Scale::Linear, Scale::Linear) => self.plot(area, x.clone(), y.clone(), (x, y)),
            (Scale::Linear, Scale::Logarithmic) => self.plot(area, x.clone(), y.clone().log_scale(), (x, y)),
            (Scale::Logarithmic, Scale::Linear) => self.plot(area, x.clone().log_scale(), y.clone(), (x, y)),
            (Scale::Logarithmic, Scale::Logarithmic) => {
                self.plot(area, x.clone().log_scale(), y.clone().log_scale(), (x, y))
            }
        }
    }

    fn plot<X, Y>(&self, area: &Area<'_>, x: X, y: Y, bounds: (Range<f64>, Range<f64>)) -> Result<()>
    where
        X: AsRangedCoord<Value = f64>,
        Y: AsRangedCoord<Value = f64>,
        X::CoordDescType: Ranged<ValueType = f64> + ValueFormatter<f64>,
        Y::CoordDescType: Ranged<ValueType = f64> + ValueFormatter<f64>,
    {
        let (x_label, y_label) = (label(self.x.scale, &bounds.0), label(self.y.scale, &bounds.1));
        let mut chart = ChartBuilder::on(area)
            .margin_top(HEADING_PX)
            .margin_right(22)
            .margin_bottom(6)
            .margin_left(6)
            .x_label_area_size(44)
            .y_label_area_size(66)
            .build_cartesian_2d(x, y)?;
        chart
            .configure_mesh()
            .axis_style(INK.mix(0.35))
            .bold_line_style(INK.mix(0.14))
            .light_line_style(TRANSPARENT)
            .label_style(text(TEXT_PX - 1, INK, HPos::Left, VPos::Top))
            .axis_desc_style(text(TEXT_PX, INK, HPos::Left, VPos::Top))
            .x_desc(self.x.label.as_str())
            .y_desc(self.y.label.as_str())
            .x_label_formatter(&x_label)
            .y_label_formatter(&y_label)
            .draw()?;
        let (x, y) = bounds;
        for span in &self.spans {
            let corners = [(span.range.start.max(x.start), y.start), (span.range.end.min(x.end), y.end)];
            chart.draw_series([Rectangle::new(corners, span.colour.mix(SPAN_OPACITY).filled())])?;
        }
        for series in &self.series {
            for run in self.runs(series, &x, &y) {
                match series.mark {
                    Mark::Dots => {
                        let dot = |&point| Circle::new(point, 3, series.colour.mix(0.75).filled());
                        chart.draw_series(run.iter().map(dot))?;
                    }
                    Mark::Crosses => {
                        let cross = |&point| Cross::new(point, 3, series.colour.stroke_width(1));
                        chart.draw_series(run.iter().map(cross))?;
                    }
                    Mark::Dashed => {
                        let style = series.colour.stroke_width(2);
                        chart.draw_series(DashedLineSeries::new(run, 7, 5, style))?;
                    }
                    Mark::Line | Mark::Box | Mark::Hatched | Mark::Low => {
                        chart.draw_series(LineSeries::new(run, series.colour.stroke_width(2)))?;
                    }
                }
            }
        }
        Ok(())
    }

    /// The unbroken stretches of a line. What lies beyond the axes is drawn at their ends.
    fn runs(&self, series: &Series, x: &Range<f64>, y: &Range<f64>) -> Vec<Vec<(f64, f64)>> {
        let shows = |&(x, y): &(f64, f64)| self.x.shows(x) && self.y.shows(y);
        let within = |&(at_x, at_y): &(f64, f64)| (at_x.clamp(x.start, x.end), at_y.clamp(y.start, y.end));
        series
            .points
            .split(|point| !shows(point))
            .filter(|run| !run.is_empty())
            .map(|run| run.iter().map(within).collect())
            .collect()
    }
}

/// What a logarithmic axis begins below its first power of ten, so that rounding cannot take its
/// label away.
pub const EDGE: f64 = 0.99;

/// How strongly a span tints.
const SPAN_OPACITY: f64 = 0.13;

/// The colour that a tint shows in the legend.
fn thinned(RGBColor(red, green, blue): RGBColor) -> RGBColor {
    let thin = |part: u8| (255.0 - (255.0 - f64::from(part)) * 0.35) as u8;
    RGBColor(thin(red), thin(green), thin(blue))
}

/// How the labels of an axis are written. On a linear axis a place that is zero but for rounding is
/// zero.
fn label(scale: Scale, range: &Range<f64>) -> impl Fn(&f64) -> String + use<> {
    let rounding = if scale == Scale::Linear { 1e-9 * (range.end - range.start) } else { 0.0 };
    move |&value| short(if value.abs() < rounding { 0.0 } else { value })
}

/// A label of an axis: as few digits as say it.
pub fn short(value: f64) -> String {
    let magnitude = value.abs();
    match magnitude {
        _ if magnitude != 0.0 && !(1e-3..1e5).contains(&magnitude) => format!("{value:.0e}"),
        _ => {
            let text = format!("{value:.3}");
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        }
    }
}

/// Where the labels of an axis stand, at most so many; for pictures that draw their own.
pub fn ticks(range: Range<f64>, most: usize) -> Vec<f64> {
    plotters::coord::types::RangedCoordf64::from(range).key_points(BoldPoints(most))
}
