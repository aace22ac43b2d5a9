//! Levels against limits over time, and the sky.

use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Style};
use ratatui::symbols::Marker;
use ratatui::text::{Line, Span};
use ratatui::widgets::canvas::{Canvas, Circle, Context};
use ratatui::widgets::{Axis, Block, Chart, Dataset, GraphType, Paragraph};

use super::Dashboard;
use super::heaven::Body;

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
        .x_axis(Axis::default().bounds([newest - 60.0_f64.max(newest), newest]))
        .y_axis(Axis::default().bounds([0.0, (DECADES.len() - 1) as f64]).labels(DECADES));
    frame.render_widget(chart, curves);
    frame.render_widget(Paragraph::new(states(dashboard, usize::from(strip.width))), strip);
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
    if dashboard.heaven.is_empty() {
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
                dashboard.heaven.iter().for_each(|body| place(context, body, dashboard));
            },
        );
    frame.render_widget(canvas, area);
}

/// Draws a satellite by its name: red and with a mark if it is excluded, dim if it is not used.
fn place(context: &mut Context<'_>, body: &Body, dashboard: &Dashboard) {
    let radius = 1.0 - body.elevation_rad / std::f64::consts::FRAC_PI_2;
    let is_left_out = dashboard.left_out.get(&body.satellite).is_some_and(|left_out| left_out.is_now);
    let (text, colour) = if is_left_out {
        (format!("{}!", body.satellite), Color::Red)
    } else {
        (body.satellite.to_string(), Color::White)
    };
    let (sin, cos) = body.azimuth_rad.sin_cos();
    context.print(radius * sin, radius * cos, Line::styled(text, colour));
}
