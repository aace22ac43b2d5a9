//! Picture in the terminal: state, levels over time, sky, satellites left out, settings, counters,
//! keys.

use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Modifier, Style};
use ratatui::text::{Line, Span};
use ratatui::widgets::{Block, Paragraph};

use super::charts::{clock, colour, levels, satellites, sky};
use super::{Dashboard, Pin, keys};

/// Keys in the footer.
const KEYS: &str = " q quit  space pause  s satellites ";

/// Keys for a source that takes commands.
const COMMAND_KEYS: &str = " c counters  p phase  h HAL  v VAL ";

/// Keys for a file.
const FILE_KEYS: &str = " + faster  - slower  a next alert ";

/// Width from which on the satellites are listed beside the sky, characters.
const WIDE: u16 = 120;

/// Width of that list: two columns.
const SATELLITES_WIDTH: u16 = 54;

/// Draws everything.
pub fn draw(frame: &mut Frame, dashboard: &Dashboard) {
    let below = if frame.area().height >= 34 { 12 } else { 8 };
    let [head, middle, lists, foot] = Layout::vertical([
        Constraint::Length(3),
        Constraint::Min(6),
        Constraint::Length(below),
        Constraint::Length(1),
    ])
    .areas(frame.area());
    header(frame, head, dashboard);
    if dashboard.shows_satellites {
        satellites(frame, middle, dashboard);
    } else if middle.width >= WIDE {
        let parts = [Constraint::Fill(1), Constraint::Fill(1), Constraint::Length(SATELLITES_WIDTH)];
        let [chart, plot, list] = Layout::horizontal(parts).areas(middle);
        levels(frame, chart, dashboard);
        sky(frame, plot, dashboard);
        satellites(frame, list, dashboard);
    } else {
        let [chart, plot] =
            Layout::horizontal([Constraint::Percentage(58), Constraint::Fill(1)]).areas(middle);
        levels(frame, chart, dashboard);
        sky(frame, plot, dashboard);
    }
    let [left, centre, right] =
        Layout::horizontal([Constraint::Fill(3), Constraint::Fill(4), Constraint::Fill(3)]).areas(lists);
    left_out(frame, left, dashboard);
    settings(frame, centre, dashboard);
    counters(frame, right, dashboard);
    footer(frame, foot, dashboard);
}

/// Draws state and reason in words, the pin, the time, the position, the result of the test.
fn header(frame: &mut Frame, area: Rect, dashboard: &Dashboard) {
    let (first, second) = match &dashboard.state {
        None => (Line::from(" waiting for the first verdict"), Line::default()),
        Some(state) => {
            let word = match state.state {
                'P' => " PROTECTED ",
                'A' => " ALERT ",
                _ => " UNAVAILABLE ",
            };
            let badge = Style::new().fg(Color::Black).bg(colour(state.state)).add_modifier(Modifier::BOLD);
            let first = Line::from(vec![
                Span::styled(word, badge),
                Span::raw(format!(" {}   ", state.reason)),
                pin(dashboard.pin),
                Span::raw(format!(
                    "   {}   {} of {} satellites",
                    clock(state.time_s),
                    state.used,
                    state.tracked
                )),
            ]);
            let metres = |value: Option<f64>| value.map_or("–".to_owned(), |value| format!("{value:.1}"));
            let ratio = |value: Option<f64>| value.map_or("–".to_owned(), |value| format!("{value:.2}"));
            let second = format!(
                " HPL {}/{} m  VPL {}/{} m  test {}/{}  NIC {}",
                metres(state.hpl_m),
                metres(state.hal_m),
                metres(state.vpl_m),
                metres(state.val_m),
                ratio(state.statistic),
                ratio(state.threshold),
                dashboard.nic.map_or("–".to_owned(), |nic| nic.to_string()),
            );
            (first, Line::from(second))
        }
    };
    let authentication =
        dashboard.authentication.as_ref().map_or(String::new(), |words| format!("   {words}"));
    let interference = interference(dashboard.interference);
    let third = Line::from(format!(" {}{interference}{authentication}", place(dashboard)));
    frame.render_widget(Paragraph::new(vec![first, second, third]), area);
}

fn pin(pin: Pin) -> Span<'static> {
    let (text, high) = match pin {
        Pin::Unknown => return Span::raw("pin unknown"),
        Pin::Seen(true) => ("pin HIGH", true),
        Pin::Seen(false) => ("pin LOW", false),
        Pin::Implied(true) => ("pin HIGH by the verdict", true),
        Pin::Implied(false) => ("pin LOW by the verdict", false),
    };
    Span::styled(text, if high { Color::Green } else { Color::Red })
}

fn place(dashboard: &Dashboard) -> String {
    let Some(position) = dashboard.position else { return "no position".to_owned() };
    format!(
        "{:.7}° {:.7}° {:.1} m",
        position.latitude_rad.to_degrees(),
        position.longitude_rad.to_degrees(),
        position.height_m
    )
}

fn interference([jamming, spoofing]: [u8; 2]) -> String {
    let word = |number: u8| match number {
        0 => "unknown",
        1 => "none",
        2 => "suspected",
        _ => "SURE",
    };
    format!("   jamming {}, spoofing {}", word(jamming), word(spoofing))
}

/// Draws the satellites that were left out and the number of epochs, the present ones first.
fn left_out(frame: &mut Frame, area: Rect, dashboard: &Dashboard) {
    let mut entries: Vec<_> = dashboard.left_out.iter().collect();
    entries.sort_by_key(|(_, left_out)| (!left_out.is_now, std::cmp::Reverse(left_out.epochs)));
    let lines = entries.into_iter().map(|(satellite, left_out)| {
        let text = format!("{satellite} {:>4} epochs {:>8.1} m", left_out.epochs, left_out.bias_m);
        Line::styled(text, if left_out.is_now { Color::Red } else { Color::Gray })
    });
    list(frame, area, " Left out ", lines.collect(), "none so far");
}

fn settings(frame: &mut Frame, area: Rect, dashboard: &Dashboard) {
    let title = if dashboard.hash.is_empty() {
        " Settings ".to_owned()
    } else {
        format!(" Settings {} ", dashboard.hash)
    };
    let words: Vec<String> =
        dashboard.settings.iter().map(|(name, value)| format!("{name} {value}")).collect();
    let width = usize::from(area.width.saturating_sub(2));
    list(frame, area, &title, wrapped(&words, width), "not said yet");
}

/// Wraps words into lines of a width, two blanks between them.
fn wrapped(words: &[String], width: usize) -> Vec<Line<'static>> {
    let mut lines = vec![String::new()];
    for word in words {
        let last = lines.last().map_or(0, |line| line.chars().count());
        if last > 0 && last + 2 + word.chars().count() > width {
            lines.push(String::new());
        }
        if let Some(line) = lines.last_mut() {
            if !line.is_empty() {
                line.push_str("  ");
            }
            line.push_str(word);
        }
    }
    lines.retain(|line| !line.is_empty());
    lines.into_iter().map(Line::from).collect()
}

/// Draws the losses first, then the nonzero counters.
fn counters(frame: &mut Frame, area: Rect, dashboard: &Dashboard) {
    let mut lines = Vec::new();
    if let Some([gnss, host, refused, late]) = dashboard.losses {
        lines.push(Line::from(format!("lost bytes {gnss} in, {host} host")));
        lines.push(Line::from(format!("refused {refused}, late {late}")));
    }
    lines.push(Line::from(format!("epochs {}, damaged {}", dashboard.epochs, dashboard.damaged)));
    let counted = dashboard.counters.iter().filter(|(_, count)| **count > 0);
    lines.extend(counted.map(|(name, count)| Line::from(format!("{name} {count}"))));
    if let Some([version, git, cause, selftest]) = &dashboard.greeting {
        lines.push(Line::from(format!("{version} {git} {cause} {selftest}")));
    }
    list(frame, area, " Counters ", lines, "");
}

fn list(frame: &mut Frame, area: Rect, title: &str, lines: Vec<Line<'_>>, nothing: &str) {
    let block = Block::bordered().title(title.to_owned());
    let lines =
        if lines.is_empty() { vec![Line::styled(nothing.to_owned(), Color::DarkGray)] } else { lines };
    frame.render_widget(Paragraph::new(lines).block(block), area);
}

fn footer(frame: &mut Frame, area: Rect, dashboard: &Dashboard) {
    let state = match (&dashboard.ended, dashboard.is_paused) {
        (Some(why), _) => why.clone(),
        (None, true) => "paused".to_owned(),
        (None, false) => match &dashboard.control {
            Some(control) if control.seeks_alert() => format!("to the next alert of {}", dashboard.source),
            Some(control) => format!("{} {}", control.speed(), dashboard.source),
            None => dashboard.source.clone(),
        },
    };
    let text = if let Some((setting, value)) = &dashboard.prompt {
        format!(" {setting} ({}): {value}_   enter sends, escape cancels", keys::values(setting))
    } else {
        let of_file = if dashboard.control.is_some() { FILE_KEYS } else { "" };
        let of_commands = if dashboard.takes_commands { COMMAND_KEYS } else { "" };
        let answer =
            dashboard.answer.as_ref().map(|answer| format!(" answer: {answer} ")).unwrap_or_default();
        format!("{KEYS}{of_commands}{of_file}{answer} {state}")
    };
    let style = Style::new().add_modifier(Modifier::REVERSED);
    frame.render_widget(Paragraph::new(Line::styled(text, style)), area);
}
