//! Pictures over time: the statistic against its threshold, the error against its bound, the
//! verdicts.
//!
//! The three share their time axis, so that [`stacked`] can put them above each other.

use std::ops::Range;

use anyhow::Result;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::canvas::{
    Area, BLUE, GREEN, GREY, Ground, INK, Mark, NARROW_PX, ORANGE, RED, TEAL, TEXT_PX, VIOLET, hatched,
    heading, heading_px, svg, text, verdict_colour,
};
use super::chart::{Axis, LineChart, Series, Span, short, ticks};
use super::thinned::Thinned;
use super::{Moment, Verdict};

/// Pixels left and right of the time axis, as in a [`LineChart`].
const LEFT_PX: i32 = 72;
const RIGHT_PX: i32 = 22;

/// Interval with a fault.
#[derive(Clone, Debug, PartialEq)]
pub struct Incident {
    /// Description of the fault: `C08 drifts off`.
    pub name: String,
    /// Interval, s since the first epoch.
    pub range_s: Range<f64>,
}

fn line(
    name: &str,
    colour: RGBColor,
    mark: Mark,
    moments: &[Moment],
    value: impl Fn(&Moment) -> Option<f64>,
) -> Series {
    let point = |moment: &Moment| (moment.time_s, value(moment).unwrap_or(f64::NAN));
    Series { name: name.to_owned(), colour, mark, points: moments.iter().map(point).collect() }
}

/// Tints of incidents, in order, so that overlapping ones differ.
const TINTS: [RGBColor; 5] = [RED, TEAL, VIOLET, ORANGE, BLUE];

fn spans(incidents: &[Incident]) -> Vec<Span> {
    let span = |(incident, colour): (&Incident, &RGBColor)| Span {
        name: incident.name.clone(),
        range: incident.range_s.clone(),
        colour: *colour,
    };
    incidents.iter().zip(TINTS.iter().cycle()).map(span).collect()
}

/// Returns the axis from the first epoch to the end of the last.
fn time_axis(moments: &[Moment]) -> Axis {
    let first_s = moments.first().map_or(0.0, |moment| moment.time_s);
    Axis::linear("time / s").over(first_s..end_s(moments).max(first_s + 1.0))
}

/// Returns the end of the last epoch, s. It lasts as long as the one before, but at most a twentieth
/// of all, so that a long gap before it does not look like a long state after it. Of fewer than
/// three epochs the last lasts a second.
fn end_s(moments: &[Moment]) -> f64 {
    let [first, .., before, last] = moments else {
        return moments.last().map_or(1.0, |moment| moment.time_s + 1.0);
    };
    last.time_s + (last.time_s - before.time_s).min((last.time_s - first.time_s) / 20.0)
}

/// Returns the chart of the test statistic against its threshold.
pub fn statistic(moments: &[Moment], incidents: &[Incident]) -> LineChart {
    LineChart {
        title: "Do the satellites agree?  Test statistic against threshold".to_owned(),
        x: time_axis(moments),
        y: Axis::linear("√(SSE/dof), no unit"),
        series: vec![
            line("threshold", ORANGE, Mark::Dashed, moments, |moment| moment.threshold),
            line("statistic", BLUE, Mark::Line, moments, |moment| moment.statistic),
        ],
        spans: spans(incidents),
    }
}

/// Returns the chart of the horizontal error against the protection level and the alert limit.
pub fn horizontal(moments: &[Moment], incidents: &[Incident]) -> LineChart {
    LineChart {
        title: "Is the error bounded?  Horizontal error against protection level".to_owned(),
        x: time_axis(moments),
        y: Axis::logarithmic("horizontal distance / m"),
        series: vec![
            line("alert limit", RED, Mark::Dashed, moments, |moment| moment.hal_m),
            line("protection level", VIOLET, Mark::Line, moments, |moment| moment.hpl_m),
            line("position error", BLUE, Mark::Line, moments, |moment| moment.horizontal_error_m),
        ],
        spans: spans(incidents),
    }
}

/// Returns the chart of the vertical error against the protection level and, if there is one, the
/// alert limit.
pub fn vertical(moments: &[Moment], incidents: &[Incident]) -> LineChart {
    let mut series = vec![
        line("protection level", VIOLET, Mark::Line, moments, |moment| moment.vpl_m),
        line("position error", BLUE, Mark::Line, moments, |moment| moment.vertical_error_m.map(f64::abs)),
    ];
    if moments.iter().any(|moment| moment.val_m.is_some()) {
        series.insert(0, line("alert limit", RED, Mark::Dashed, moments, |moment| moment.val_m));
    }
    LineChart {
        title: "Vertical error against protection level".to_owned(),
        x: time_axis(moments),
        y: Axis::logarithmic("vertical distance / m"),
        series,
        spans: spans(incidents),
    }
}

/// Colour and form of a band at an epoch; `None` for a gap.
type Colouring<'a> = &'a dyn Fn(&Moment) -> Option<(RGBColor, Mark)>;

/// Draws verdict, pin and exclusions as bands over time.
///
/// # Errors
/// Plotters fails to draw.
pub fn bands(area: &Area<'_>, moments: &[Moment]) -> Result<()> {
    heading(area, BANDS_TITLE, &BANDS_LEGEND)?;
    let strip = Strip::of(area, moments);
    let verdict = |moment: &Moment| {
        let mark = if moment.verdict == Verdict::Alert { Mark::Hatched } else { Mark::Box };
        Some((verdict_colour(moment.verdict), mark))
    };
    let level = |high: bool| if high { (GREEN, Mark::Box) } else { (INK, Mark::Low) };
    let pin = |moment: &Moment| moment.pin_is_high.map(level);
    let excluded = |moment: &Moment| (!moment.excluded.is_empty()).then_some((ORANGE, Mark::Box));
    let mut rows: Vec<(&str, Colouring<'_>)> = vec![("state", &verdict)];
    if moments.iter().any(|moment| moment.pin_is_high.is_some()) {
        rows.push(("pin", &pin));
    }
    rows.push(("excluded", &excluded));
    let width = area.dim_in_pixel().0.cast_signed();
    let mut y = heading_px(width, BANDS_TITLE, &BANDS_LEGEND).cast_signed();
    for (name, colour) in rows {
        strip.row(area, name, y, moments, colour)?;
        y += ROW_PX + ROW_GAP_PX;
    }
    strip.axis(area, y)
}

const ROW_PX: i32 = 20;
const ROW_GAP_PX: i32 = 6;

/// Title and legend of the bands.
const BANDS_TITLE: &str = "May the position be used?";
const BANDS_LEGEND: [(&str, RGBColor, Mark); 5] = [
    ("protected, pin high", GREEN, Mark::Box),
    ("alert", RED, Mark::Hatched),
    ("unavailable", GREY, Mark::Box),
    ("pin low", INK, Mark::Low),
    ("a satellite is left out", ORANGE, Mark::Box),
];

/// Returns the height that [`bands`] need in a picture of a width, pixels.
fn bands_px(width_px: u32) -> u32 {
    let heading_px = heading_px(width_px.cast_signed(), BANDS_TITLE, &BANDS_LEGEND);
    heading_px + 3 * (ROW_PX + ROW_GAP_PX).cast_unsigned() + 46
}

/// Time axis of the bands, pixels.
struct Strip {
    left: i32,
    right: i32,
    range_s: Range<f64>,
}

impl Strip {
    fn of(area: &Area<'_>, moments: &[Moment]) -> Self {
        let right = area.dim_in_pixel().0.cast_signed() - RIGHT_PX;
        Self { left: LEFT_PX, right, range_s: time_axis(moments).range.unwrap_or(0.0..1.0) }
    }

    fn x(&self, time_s: f64) -> i32 {
        let Range { start, end } = self.range_s;
        let fraction = ((time_s - start) / (end - start)).clamp(0.0, 1.0);
        self.left + (f64::from(self.right - self.left) * fraction).round() as i32
    }

    /// Draws a band: equal neighbours are one box, and each epoch lasts until the next.
    fn row(
        &self,
        area: &Area<'_>,
        name: &str,
        y: i32,
        moments: &[Moment],
        colour: impl Fn(&Moment) -> Option<(RGBColor, Mark)>,
    ) -> Result<()> {
        let label = text(TEXT_PX - 1, INK, HPos::Right, VPos::Center);
        area.draw(&Text::new(name.to_owned(), (self.left - 8, y + ROW_PX / 2), label))?;
        let mut rest = moments;
        while let Some(first) = rest.first() {
            let count = rest.iter().take_while(|moment| colour(moment) == colour(first)).count();
            let (_, after) = rest.split_at(count);
            let end = after.first().map_or(self.right, |moment| self.x(moment.time_s));
            let corners = [(self.x(first.time_s), y), (end, y + ROW_PX)];
            match colour(first) {
                Some((colour, Mark::Hatched)) => hatched(area, corners, colour)?,
                Some((colour, Mark::Low)) => {
                    let foot = vec![(corners[0].0, y + ROW_PX - 1), (end, y + ROW_PX - 1)];
                    area.draw(&PathElement::new(foot, colour.stroke_width(2)))?;
                }
                Some((colour, _)) => area.draw(&Rectangle::new(corners, colour.filled()))?,
                None => {}
            }
            rest = after;
        }
        Ok(())
    }

    fn axis(&self, area: &Area<'_>, y: i32) -> Result<()> {
        area.draw(&PathElement::new(vec![(self.left, y), (self.right, y)], INK.mix(0.5)))?;
        let most = if self.right < NARROW_PX { 4 } else { 11 };
        for tick in ticks(self.range_s.clone(), most) {
            let x = self.x(tick);
            area.draw(&PathElement::new(vec![(x, y), (x, y + 4)], INK.mix(0.5)))?;
            let label = text(TEXT_PX - 1, INK, HPos::Center, VPos::Top);
            area.draw(&Text::new(short(tick), (x, y + 6), label))?;
        }
        let label = text(TEXT_PX, INK, HPos::Center, VPos::Top);
        area.draw(&Text::new("time / s", (self.left.midpoint(self.right), y + 24), label))?;
        Ok(())
    }
}

/// Returns the bands in a sentence.
fn spoken([protected, alerts, unavailable]: [usize; 3]) -> String {
    format!(
        "May the position be used? Epochs protected {protected}, alert {alerts}, unavailable {unavailable}"
    )
}

/// Returns [`bands`] as a picture.
///
/// # Errors
/// Plotters fails to draw.
pub fn bands_svg(moments: &[Moment], width_px: u32, ground: Ground) -> Result<String> {
    svg((width_px, bands_px(width_px)), ground, &spoken(tally(moments)), |area| bands(area, moments))
}

/// Returns charts over time and the bands above each other: cause, effect and verdict in one
/// picture.
///
/// # Errors
/// Plotters fails to draw.
pub fn stacked(charts: &[LineChart], moments: &[Moment], width_px: u32, ground: Ground) -> Result<String> {
    stacked_of(charts, moments, tally(moments), width_px, ground)
}

/// Returns the same as [`stacked`] for moments that represent others: `tally` has the number of
/// each verdict.
fn stacked_of(
    charts: &[LineChart],
    moments: &[Moment],
    tally: [usize; 3],
    width_px: u32,
    ground: Ground,
) -> Result<String> {
    const PANEL_PX: u32 = 260;
    let titles: Vec<&str> = charts.iter().map(|chart| chart.title.as_str()).collect();
    let title = format!("{}. {}", titles.join(". "), spoken(tally));
    svg((width_px, charts.len() as u32 * PANEL_PX + bands_px(width_px)), ground, &title, |area| {
        let mut rest = area.clone();
        for chart in charts {
            let (panel, below) = rest.split_vertically(PANEL_PX);
            chart.draw(&panel)?;
            rest = below;
        }
        bands(&rest, moments)
    })
}

/// Returns statistic, both errors and verdicts above each other, with the lines of another receiver
/// in the first two.
///
/// # Errors
/// Plotters fails to draw.
pub fn picture(
    thinned: &Thinned,
    incidents: &[Incident],
    beside: &[Vec<Series>; 2],
    width_px: u32,
    ground: Ground,
) -> Result<String> {
    let moments = thinned.moments();
    let mut charts =
        [statistic(&moments, incidents), horizontal(&moments, incidents), vertical(&moments, incidents)];
    // These lines are behind the others, which are the subject of the picture.
    for (chart, beside) in charts.iter_mut().zip(beside) {
        chart.series.splice(0..0, beside.iter().cloned());
    }
    stacked_of(&charts, &moments, thinned.verdicts(), width_px, ground)
}

/// Returns the number of epochs of each verdict: protected, alert, unavailable.
pub fn tally(moments: &[Moment]) -> [usize; 3] {
    [Verdict::Protected, Verdict::Alert, Verdict::Unavailable]
        .map(|verdict| moments.iter().filter(|moment| moment.verdict == verdict).count())
}

#[cfg(test)]
mod tests {
    use super::super::vision::check;
    use super::*;

    #[test]
    fn any_two_lines_of_a_chart_differ_for_every_reader() {
        let moment = Moment {
            time_s: 0.0,
            verdict: Verdict::Protected,
            reason: "OK".to_owned(),
            statistic: Some(1.0),
            threshold: Some(2.0),
            hpl_m: Some(9.0),
            vpl_m: Some(9.0),
            hal_m: Some(40.0),
            val_m: Some(35.0),
            horizontal_error_m: Some(1.0),
            vertical_error_m: Some(1.0),
            pin_is_high: Some(true),
            used: 9,
            excluded: Vec::new(),
        };
        for chart in [statistic, horizontal, vertical].map(|chart| chart(std::slice::from_ref(&moment), &[]))
        {
            assert!(chart.legend().len() >= 2);
            check(&chart.title, &chart.legend());
        }
        check(BANDS_TITLE, &BANDS_LEGEND);
    }

    fn at(time_s: f64, verdict: Verdict) -> Moment {
        Moment {
            time_s,
            verdict,
            reason: "OK".to_owned(),
            statistic: Some(1.0),
            threshold: Some(2.0),
            hpl_m: Some(9.0),
            vpl_m: Some(9.0),
            hal_m: Some(40.0),
            val_m: Some(35.0),
            horizontal_error_m: Some(1.0),
            vertical_error_m: Some(1.0),
            pin_is_high: Some(verdict == Verdict::Protected),
            used: 9,
            excluded: Vec::new(),
        }
    }

    /// Returns the position of the left edge of each box in a colour, and its width.
    fn boxes(svg: &str, colour: RGBColor) -> Vec<(f64, f64)> {
        let colour = format!("#{:02X}{:02X}{:02X}", colour.0, colour.1, colour.2);
        let number = |line: &str, name: &str| {
            let (_, rest) = line.split_once(&format!(" {name}=\""))?;
            rest.split_once('"')?.0.parse().ok()
        };
        let rectangles = svg.lines().filter(|line| line.starts_with("<rect") && line.contains(&colour));
        rectangles.filter_map(|line| Some((number(line, "x")?, number(line, "width")?))).collect()
    }

    /// Of 31 epochs of a second each, the last has one part in 31 of the axis.
    #[test]
    fn last_state_reaches_the_edge() {
        let mut moments: Vec<Moment> =
            (0..30).map(|number| at(f64::from(number), Verdict::Protected)).collect();
        moments.push(at(30.0, Verdict::Alert));
        let svg = bands_svg(&moments, 960, Ground::Sheet).unwrap();
        let (left, width) = *boxes(&svg, RED).last().expect("an alert");
        let (room, edge) = (f64::from(960 - LEFT_PX - RIGHT_PX), f64::from(960 - RIGHT_PX));
        assert!((left + width - edge).abs() <= 1.0, "{left} {width}");
        assert!((width - room / 31.0).abs() <= 1.0, "{width} of {room}");
    }

    #[test]
    fn a_narrow_picture_has_the_width_of_a_telephone() {
        let svg = bands_svg(&[], 340, Ground::Page).unwrap();
        assert!(svg.contains("width=\"340\""), "{svg}");
    }
}
