//! Levels against limits over time, and the sky.

use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Style};
use ratatui::symbols::Marker;
use ratatui::text::{Line, Span};
use ratatui::widgets::canvas::{Canvas, Circle, Context};
use ratatui::widgets::{Axis, Block, Chart, Dataset, GraphType, Paragraph};

use super::Dashboard;
use crate::satellites::{Account, Fate};

/// Decades in which the levels are drawn, m; levels below 1 m are drawn at 1 m.
const DECADES: [&str; 5] = ["1 m", "10", "100", "1 km", "10"];

/// Name and colour of each curve.
const CURVES: [(&str, Color); 4] =
    [("HPL", Color::Cyan), ("VPL", Color::Green), ("HAL", Color::Red), ("VAL", Color::Magenta)];

/// Returns the colour of a state.
pub(super) const fn colour(state: char) -> Color {
    match state {
        'P' => Color::Green,
        'A' => Color::Red,
        _ => Color::Yellow,
    }
}

/// Draws levels and limits over the last epochs, and a strip of the states below.
pub(super) fn levels(frame: &mut Frame, area: Rect, dashboard: &Dashboard) {
    let block = Block::bordered().title(title());
    let inner = block.inner(area);
    frame.render_widget(block, area);
    let [curves, strip] = Layout::vertical([Constraint::Min(3), Constraint::Length(1)]).areas(inner);

    let history = &dashboard.history;
    let points: Vec<Vec<(f64, f64)>> = (0..CURVES.len()).map(|curve| points(dashboard, curve)).collect();
    let datasets = points.iter().zip(CURVES).enumerate().map(|(index, (points, (_, colour)))| {
        Dataset::default()
            .marker(if index < 2 { Marker::Braille } else { Marker::Dot })
            .graph_type(if index < 2 { GraphType::Line } else { GraphType::Scatter })
            .style(Style::new().fg(colour))
            .data(points)
    });
    let newest = history.len().max(60) as f64;
    let chart = Chart::new(datasets.collect())
        .x_axis(Axis::default().bounds([newest - 60.0_f64.max(newest), newest]).labels(ends(dashboard)))
        .y_axis(Axis::default().bounds([0.0, (DECADES.len() - 1) as f64]).labels(DECADES));
    frame.render_widget(chart, curves);
    frame.render_widget(Paragraph::new(states(dashboard, usize::from(strip.width))), strip);
}

/// Returns seconds of the day as `hh:mm:ss`.
pub(super) fn clock(time_s: Option<f64>) -> String {
    let Some(time_s) = time_s else { return "--:--:--".to_owned() };
    let seconds = time_s as u32;
    format!("{:02}:{:02}:{:02} UTC", seconds / 3600, seconds / 60 % 60, seconds % 60)
}

/// Returns the times of the first and of the last epoch.
fn ends(dashboard: &Dashboard) -> Vec<String> {
    let [first, last] = [dashboard.history.front(), dashboard.history.back()];
    [first, last].map(|point| clock(point.and_then(|point| point.time_s))).to_vec()
}

fn title() -> Line<'static> {
    let mut spans = vec![Span::raw(" Levels and limits: ")];
    spans.extend(CURVES.map(|(name, colour)| Span::styled(format!("{name} "), colour)));
    Line::from(spans)
}

/// Returns the logarithms of one curve's metres, by number of epoch.
fn points(dashboard: &Dashboard, curve: usize) -> Vec<(f64, f64)> {
    let decade = |metres: f64| metres.max(1.0).log10();
    let value = |point: &super::Point| match curve {
        0 | 1 => point.levels_m[curve],
        _ => point.limits_m[curve - 2],
    };
    let numbered = dashboard.history.iter().enumerate();
    numbered.filter_map(|(index, point)| Some((index as f64, decade(value(point)?)))).collect()
}

/// Returns the last states, one character each; letters make the difference without colours.
fn states(dashboard: &Dashboard, width: usize) -> Line<'static> {
    let shown = dashboard.history.len().min(width);
    let skipped = dashboard.history.len() - shown;
    let spans = dashboard.history.iter().skip(skipped).map(|point| {
        let mark = if point.state == 'P' { '▪' } else { point.state };
        Span::styled(mark.to_string(), colour(point.state))
    });
    Line::from(spans.collect::<Vec<_>>())
}

/// Draws the sky: zenith in the middle, horizon at the rim, north up, east to the right.
pub(super) fn sky(frame: &mut Frame, area: Rect, dashboard: &Dashboard) {
    let block = Block::bordered().title(" Sky ");
    let is_placed = |seen: &&Account| seen.elevation_rad.is_some_and(|elevation_rad| elevation_rad >= 0.0);
    let placed: Vec<&Account> = dashboard.satellites.iter().filter(is_placed).collect();
    if placed.is_empty() {
        let text = "no orbits come with the sentences;\nwatch a capture or --demo to see the sky";
        frame.render_widget(Paragraph::new(text).block(block), area);
        return;
    }
    // A cell is about twice as high as wide.
    let inner = block.inner(area);
    let stretch = (f64::from(inner.width) / (2.0 * f64::from(inner.height).max(1.0))).max(0.1);
    let (x, y) = if stretch > 1.0 { (1.15 * stretch, 1.15) } else { (1.15, 1.15 / stretch) };
    let canvas =
        Canvas::default().block(block).marker(Marker::Dot).x_bounds([-x, x]).y_bounds([-y, y]).paint(
            |context| {
                for radius in [1.0, 2.0 / 3.0, 1.0 / 3.0] {
                    context.draw(&Circle { x: 0.0, y: 0.0, radius, color: Color::DarkGray });
                }
                context.print(0.0, 1.05, Line::styled("N", Color::DarkGray));
                context.layer();
                for seen in &placed {
                    place(context, seen);
                }
            },
        );
    frame.render_widget(canvas, area);
}

/// Draws a satellite by its name: red and with a mark if it is excluded, dim if it is not used.
fn place(context: &mut Context<'_>, seen: &Account) {
    let (Some(azimuth_rad), Some(elevation_rad)) = (seen.azimuth_rad, seen.elevation_rad) else { return };
    let radius = 1.0 - elevation_rad / std::f64::consts::FRAC_PI_2;
    let (text, colour) = match seen.fate {
        Fate::Excluded | Fate::SystemExcluded => (format!("{}!", seen.satellite), Color::Red),
        Fate::Used => (seen.satellite.to_string(), Color::White),
        _ => (seen.satellite.to_string().to_lowercase(), Color::DarkGray),
    };
    let (sin, cos) = azimuth_rad.sin_cos();
    context.print(radius * sin, radius * cos, Line::styled(text, colour));
}

/// Draws all satellites in columns: the excluded first, then those used, then the others with the
/// reason.
pub(super) fn satellites(frame: &mut Frame, area: Rect, dashboard: &Dashboard) {
    const COLUMN: u16 = 26;
    let count = |is: fn(Fate) -> bool| dashboard.satellites.iter().filter(|seen| is(seen.fate)).count();
    let (used, excluded) = (count(|fate| fate == Fate::Used), count(Fate::is_excluded));
    let others = dashboard.satellites.len() - used - excluded;
    let title = format!(" Satellites: {used} used, {excluded} excluded, {others} not used ");
    let block = Block::bordered().title(title);
    let inner = block.inner(area);
    frame.render_widget(block, area);
    if dashboard.satellites.is_empty() {
        frame.render_widget(Paragraph::new("none so far"), inner);
        return;
    }
    let mut all: Vec<&Account> = dashboard.satellites.iter().collect();
    all.sort_by_key(|seen| (rank(seen.fate), seen.satellite));
    let columns = (inner.width / COLUMN).max(1);
    let rows = usize::from(inner.height.saturating_sub(1)).max(1);
    let heading = Line::styled(format!("{:<4}{:<6}{:>6}{:>8}", "", "", "dB-Hz", "res. m"), Color::DarkGray);
    for (column, group) in (0..columns).zip(all.chunks(rows)) {
        let place = Rect { x: inner.x + column * COLUMN, width: COLUMN.min(inner.width), ..inner };
        let lines: Vec<Line<'_>> =
            std::iter::once(heading.clone()).chain(group.iter().map(|seen| line(seen))).collect();
        frame.render_widget(Paragraph::new(lines), place.intersection(inner));
    }
}

const fn rank(fate: Fate) -> u8 {
    match fate {
        Fate::Excluded | Fate::SystemExcluded => 0,
        Fate::Used => 1,
        _ => 2,
    }
}

fn line(seen: &Account) -> Line<'static> {
    let number = |value: Option<f64>| value.map_or("–".to_owned(), |value| format!("{value:.1}"));
    let (word, colour) = match seen.fate {
        Fate::Used => ("used", Color::White),
        Fate::Excluded | Fate::SystemExcluded => ("EXCL", Color::Red),
        Fate::BelowMask => ("low", Color::DarkGray),
        Fate::SignalUnusable => ("weak", Color::DarkGray),
        Fate::SystemLeftOut => ("off", Color::DarkGray),
        Fate::EphemerisMissing | Fate::EphemerisStale | Fate::EphemerisDisputed | Fate::EphemerisUnproved => {
            ("orbit", Color::DarkGray)
        }
        Fate::Unhealthy => ("ill", Color::DarkGray),
        Fate::NoPosition => ("–", Color::DarkGray),
        _ => ("unfit", Color::DarkGray),
    };
    let (cn0, residual) = (number(seen.cn0_dbhz), number(seen.residual_m));
    Line::styled(format!("{:<4}{word:<6}{cn0:>6}{residual:>8}", seen.satellite.to_string()), colour)
}
