//! Lines over an axis: any quantity with its unit, linear or logarithmic.
//!
//! A value that is not finite, or not positive on a logarithmic axis, is a gap in its line.

use std::ops::Range;

use anyhow::{Result, ensure};
use plotters::coord::ranged1d::{AsRangedCoord, BoldPoints, Ranged, ValueFormatter};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::canvas::{Area, Ground, INK, Mark, NARROW_PX, TEXT_PX, heading, heading_px, svg, text};
use super::dashes::dashes;
use super::decades::Decades;

/// Scale of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Even steps.
    Linear,
    /// Powers of ten.
    Logarithmic,
}

/// Axis with its quantity, unit and range.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Quantity and unit: `time / s`.
    pub label: String,
    /// Scale of the axis.
    pub scale: Scale,
    /// Range of the axis; `None` fits the lines.
    pub range: Option<Range<f64>>,
}

impl Axis {
    /// Returns a linear axis that fits its lines.
    pub fn linear(label: &str) -> Self {
        Self { label: label.to_owned(), scale: Scale::Linear, range: None }
    }

    /// Returns a logarithmic axis that fits its lines.
    pub fn logarithmic(label: &str) -> Self {
        Self { label: label.to_owned(), scale: Scale::Logarithmic, range: None }
    }

    /// Returns the same axis with a range.
    #[must_use]
    pub fn over(mut self, range: Range<f64>) -> Self {
        self.range = Some(range);
        self
    }

    /// Returns true if the axis can show a value.
    fn shows(&self, value: f64) -> bool {
        value.is_finite() && (self.scale == Scale::Linear || value > 0.0)
    }

    /// Returns the given range, or one that holds all values with a margin.
    fn fitted(&self, values: impl Iterator<Item = f64>) -> Range<f64> {
        if let Some(range) = &self.range {
            return range.clone();
        }
        let (low, high) = values
            .filter(|&value| self.shows(value))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
        match self.scale {
            _ if low > high => 0.1..1.0,
            // Whole powers of ten, so that at least two of them have labels.
            Scale::Logarithmic => {
                let (floor, ceiling) = (libm::log10(low).floor(), libm::log10(high * 1.05).ceil());
                libm::exp10(floor) * EDGE..libm::exp10(ceiling.max(floor + 1.0))
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
    /// Name in the legend; empty if it needs none.
    pub name: String,
    /// Colour of the line.
    pub colour: RGBColor,
    /// Mark of the line.
    pub mark: Mark,
    /// Points of the line, in the units of the axes.
    pub points: Vec<(f64, f64)>,
}

/// Tinted part of the x axis, such as the duration of a fault.
#[derive(Clone, Debug, PartialEq)]
pub struct Span {
    /// Name in the legend.
    pub name: String,
    /// Range on the x axis.
    pub range: Range<f64>,
    /// Colour, before it is thinned.
    pub colour: RGBColor,
}

/// Lines with axes, legend and title.
#[derive(Clone, Debug, PartialEq)]
pub struct LineChart {
    /// Title of the chart.
    pub title: String,
    /// X axis.
    pub x: Axis,
    /// Y axis.
    pub y: Axis,
    /// Lines, the first at the back.
    pub series: Vec<Series>,
    /// Tinted parts.
    pub spans: Vec<Span>,
}

impl LineChart {
    /// Returns the chart as SVG of a width and height in pixels.
    ///
    /// # Errors
    /// A range is empty, or plotters fails to draw.
    pub fn svg(&self, size: (u32, u32), ground: Ground) -> Result<String> {
        svg(size, ground, &self.title, |area| self.draw(area))
    }

    /// Draws into an area of a picture.
    ///
    /// # Errors
    /// A range is empty, or plotters fails to draw.
    pub fn draw(&self, area: &Area<'_>) -> Result<()> {
        let legend = self.legend();
        heading(area, &self.title, &legend)?;
        let top = heading_px(area.dim_in_pixel().0.cast_signed(), &self.title, &legend);
        let points = || self.series.iter().flat_map(|series| series.points.iter());
        let x = self.x.fitted(points().map(|point| point.0));
        let y = self.y.fitted(points().map(|point| point.1));
        ensure!(x.start < x.end && y.start < y.end, "chart `{}`: an axis is empty", self.title);
        match (self.x.scale, self.y.scale) {
            (Scale::Linear, Scale::Linear) => self.plot(area, top, x.clone(), y.clone(), (x, y)),
            (Scale::Linear, Scale::Logarithmic) => {
                self.plot(area, top, x.clone(), Decades::from(y.clone()), (x, y))
            }
            (Scale::Logarithmic, Scale::Linear) => {
                self.plot(area, top, Decades::from(x.clone()), y.clone(), (x, y))
            }
            (Scale::Logarithmic, Scale::Logarithmic) => {
                self.plot(area, top, Decades::from(x.clone()), Decades::from(y.clone()), (x, y))
            }
        }
    }

    /// Returns the entries of the legend.
    pub(super) fn legend(&self) -> Vec<(&str, RGBColor, Mark)> {
        let named = self.series.iter().filter(|series| !series.name.is_empty());
        let lines = named.map(|series| (series.name.as_str(), series.colour, series.mark));
        let spans = self.spans.iter().map(|span| (span.name.as_str(), thinned(span.colour), Mark::Box));
        let mut legend: Vec<_> = lines.chain(spans).collect();
        // Parts of the same kind follow each other, and need one entry.
        legend.dedup();
        legend
    }

    fn plot<X, Y>(
        &self,
        area: &Area<'_>,
        top: u32,
        x: X,
        y: Y,
        bounds: (Range<f64>, Range<f64>),
    ) -> Result<()>
    where
        X: AsRangedCoord<Value = f64>,
        Y: AsRangedCoord<Value = f64>,
        X::CoordDescType: Ranged<ValueType = f64> + ValueFormatter<f64>,
        Y::CoordDescType: Ranged<ValueType = f64> + ValueFormatter<f64>,
    {
        let room_px = area.dim_in_pixel().1.saturating_sub(top + X_LABELS_PX);
        let y_labels = (room_px as usize / Y_LABEL_PX).clamp(3, 11);
        let is_narrow = area.dim_in_pixel().0.cast_signed() < NARROW_PX;
        let (x_label, y_label) = (label(self.x.scale, &bounds.0), label(self.y.scale, &bounds.1));
        let mut chart = ChartBuilder::on(area)
            .margin_top(top)
            .margin_right(RIGHT_PX)
            .margin_bottom(6)
            .margin_left(6)
            .x_label_area_size(X_LABELS_PX)
            .y_label_area_size(Y_LABELS_PX)
            .build_cartesian_2d(x, y)?;
        chart
            .configure_mesh()
            .axis_style(INK.mix(0.35))
            .bold_line_style(INK.mix(0.14))
            .light_line_style(TRANSPARENT)
            .label_style(text(TEXT_PX - 1, INK, HPos::Left, VPos::Top))
            .axis_desc_style(text(TEXT_PX, INK, HPos::Left, VPos::Top))
            .x_labels(if is_narrow { 5 } else { 11 })
            .y_labels(y_labels)
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
                        let inner = chart.plotting_area().strip_coord_spec();
                        let (left, above) = chart.plotting_area().get_pixel_range();
                        let place = |point: &(f64, f64)| {
                            let (x, y) = chart.backend_coord(point);
                            (x - left.start, y - above.start)
                        };
                        for dash in dashes(&run.iter().map(place).collect::<Vec<_>>(), 7.0, 5.0) {
                            inner.draw(&PathElement::new(dash, series.colour.stroke_width(2)))?;
                        }
                    }
                    Mark::Line | Mark::Box | Mark::Hatched | Mark::Low => {
                        chart.draw_series(LineSeries::new(run, series.colour.stroke_width(2)))?;
                    }
                }
            }
        }
        Ok(())
    }

    /// Returns the unbroken parts of a line. Points beyond the axes are drawn at their ends.
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

/// Factor at which a logarithmic axis begins below its first power of ten, so that rounding cannot
/// remove its label.
pub const EDGE: f64 = 0.99;

/// Pixels right of the axes, so that half a label fits.
const RIGHT_PX: u32 = 22;

/// Pixels of the labels below the axes.
const X_LABELS_PX: u32 = 44;

/// Pixels from one label left of the axes to the next.
const Y_LABEL_PX: usize = 26;

/// Pixels of the labels left of the axes.
const Y_LABELS_PX: u32 = 66;

/// Opacity of a span's tint.
const SPAN_OPACITY: f64 = 0.13;

/// Returns the colour of a tint in the legend.
fn thinned(RGBColor(red, green, blue): RGBColor) -> RGBColor {
    let thin = |part: u8| (255.0 - (255.0 - f64::from(part)) * 0.35) as u8;
    RGBColor(thin(red), thin(green), thin(blue))
}

/// Returns the labels of an axis. On a linear axis, a position that is zero except for rounding is
/// zero.
fn label(scale: Scale, range: &Range<f64>) -> impl Fn(&f64) -> String + use<> {
    let rounding = if scale == Scale::Linear { 1e-9 * (range.end - range.start) } else { 0.0 };
    move |&value| short(if value.abs() < rounding { 0.0 } else { value })
}

/// Returns a label of an axis with as few digits as possible.
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

/// Returns the positions of an axis' labels, at most `most`; for pictures with their own axes.
pub fn ticks(range: Range<f64>, most: usize) -> Vec<f64> {
    plotters::coord::types::RangedCoordf64::from(range).key_points(BoldPoints(most))
}
