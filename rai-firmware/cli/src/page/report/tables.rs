//! Tables of a report: facts, reasons, events, satellites.

use std::fmt::Write as _;

use super::data::{scale, start_ms};
use super::facts::Facts;
use super::journal::Journal;
use super::reasons::explanation;
use super::satellites::Satellite;
use crate::page::Verdict;
use crate::page::html::{Page, escaped};
use crate::satellites::Fate;
use crate::signal::calendar::readable_unix;

/// Adds source, time, place, settings, version and command.
pub(super) fn facts(page: &mut Page, journal: &Journal, facts: &Facts) {
    page.heading("Facts");
    let mut rows = vec![("source", facts.source.clone())];
    if let Some(start_ms) = start_ms(journal) {
        let end_ms = start_ms + (journal.last_s * 1e3).round() as i64;
        let (start, end) = (readable_unix(start_ms), readable_unix(end_ms));
        rows.push(("time", format!("{start} to {end} {}, {}", scale(journal), duration(journal.last_s))));
    } else {
        rows.push(("time", duration(journal.last_s)));
    }
    if let Some(place) = journal.place {
        rows.push((
            "place",
            format!(
                "{:.6}° {:.6}°, {:.1} m above the ellipsoid (first protected position)",
                place.latitude_rad.to_degrees(),
                place.longitude_rad.to_degrees(),
                place.height_m
            ),
        ));
    }
    let settings: Vec<String> = facts.settings.iter().map(|(key, value)| format!("{key}={value}")).collect();
    let settings = if settings.is_empty() { "those at start".to_owned() } else { settings.join(" ") };
    rows.push(("settings", format!("{settings} (hash {})", facts.settings_hash)));
    rows.push(("version", format!("raim {}", env!("CARGO_PKG_VERSION"))));
    rows.push(("command", facts.command.clone()));
    let mut html = String::from("<table class=\"facts\">\n");
    for (name, value) in rows.iter().filter(|(_, value)| !value.is_empty()) {
        let _ = writeln!(html, "<tr><th>{name}</th><td>{}</td></tr>", escaped(value));
    }
    html += "</table>\n";
    page.raw(&html);
    if !facts.counters.is_empty() {
        let counters: Vec<String> =
            facts.counters.iter().map(|(name, count)| format!("{name} {count}")).collect();
        page.raw(&format!(
            "<details><summary>Counters that are not zero: {}</summary><p>{}</p></details>\n",
            counters.len(),
            escaped(&counters.join(", "))
        ));
    }
}

/// Returns a duration in hours, minutes and seconds.
pub(super) fn duration(seconds: f64) -> String {
    let whole = seconds as u64;
    match whole {
        0..60 => format!("{seconds:.1} s"),
        60..3600 => format!("{} min {} s", whole / 60, whole % 60),
        _ => format!("{} h {} min", whole / 3600, whole / 60 % 60),
    }
}

/// Seconds of a day.
const DAY_S: f64 = 86_400.0;

/// Returns the time of an event: date and time, or seconds.
pub(super) fn clock(journal: &Journal, time_s: f64) -> String {
    start_ms(journal).map_or_else(
        || format!("{time_s:.1}"),
        |start_ms| {
            let text = readable_unix(start_ms + (time_s * 1e3).round() as i64);
            // Within a day the date is that of the facts.
            if journal.last_s < DAY_S { text[11..].to_owned() } else { text }
        },
    )
}

/// Adds a row for every reason.
pub(super) fn reasons(page: &mut Page, journal: &Journal) {
    page.heading("States and their reasons");
    let mut counts = journal.counts.clone();
    counts.sort_by_key(|count| {
        (
            count.verdict != Verdict::Protected,
            count.verdict != Verdict::Alert,
            std::cmp::Reverse(count.epochs),
        )
    });
    let all = journal.len().max(1) as f64;
    let rows: Vec<(Vec<String>, String)> = counts
        .iter()
        .map(|count| {
            let cells = vec![
                count.verdict.word().to_owned(),
                count.reason.clone(),
                count.epochs.to_string(),
                format!("{:.2}", 100.0 * count.epochs as f64 / all),
                clock(journal, count.first_s),
                clock(journal, count.last_s),
            ];
            (cells, explanation(&count.reason).unwrap_or("").to_owned())
        })
        .collect();
    page.table_with_notes(&["state", "reason", "epochs", "%", "first", "last"], &rows);
    page.paragraph(
        "The pin is high while the state is protected, and low otherwise. A silence counts as one epoch of STALE.",
    );
}

/// Adds the list of events, each a button for the script.
pub(super) fn events(page: &mut Page, journal: &Journal) {
    page.heading("Events");
    page.raw("<p class=\"live-only\">A click on a time shows the minute around it in all rows above.</p>\n");
    let mut html =
        String::from("<div class=\"wide events\"><table>\n<tr><th>time</th><th>state</th><th>reason</th>");
    html += "<th>excluded (bias)</th><th>lasted</th></tr>\n";
    for (index, event) in journal.events.iter().enumerate() {
        let until_s = journal.events.get(index + 1).map_or(journal.last_s, |next| next.time_s);
        let title = explanation(&event.reason).unwrap_or("");
        let _ = writeln!(
            html,
            "<tr class=\"{}\"><td><button data-from=\"{:.3}\" data-to=\"{:.3}\">{}</button></td><td>{}</td>\
             <td title=\"{}\">{}</td><td>{}</td><td class=\"number\">{}</td></tr>",
            event.verdict.word(),
            event.time_s,
            until_s,
            clock(journal, event.time_s),
            event.verdict.word(),
            escaped(title),
            escaped(&event.reason),
            escaped(&event.excluded),
            duration((until_s - event.time_s).max(0.0)),
        );
    }
    html += "</table></div>\n";
    page.raw(&html);
    if journal.more_events > 0 {
        page.paragraph(&format!("{} further changes are not listed.", journal.more_events));
    }
}

/// Adds a row for every satellite.
pub(super) fn satellites(page: &mut Page, journal: &Journal) {
    if journal.satellites.all.is_empty() {
        return;
    }
    page.raw("<div id=\"now\"></div>\n");
    page.subheading("Over the whole time");
    let number = |value: Option<f64>, decimals: usize| {
        value.map_or_else(|| "–".to_owned(), |value| format!("{value:.decimals$}"))
    };
    let rows: Vec<(Vec<String>, String)> = journal
        .satellites
        .all
        .iter()
        .map(|(satellite, known)| {
            let elevation = known.elevation_deg.map_or_else(
                || "–".to_owned(),
                |[low, high]| {
                    if high - low < 1.0 { format!("{high:.0}") } else { format!("{low:.0} to {high:.0}") }
                },
            );
            let cells = vec![
                satellite.to_string(),
                number(known.last_azimuth_deg, 0),
                elevation,
                number(known.cn0_dbhz(), 1),
                number(known.residual_m(), 2),
                number(known.sigma_m(), 2),
                number(known.largest_w, 1),
                format!("{} of {}", known.used(), known.epochs),
            ];
            (cells, why(known))
        })
        .collect();
    page.table_with_notes(
        &[
            "satellite",
            "azimuth / °",
            "elevation / °",
            "C/N0 / dB-Hz",
            "residual, rms / m",
            "sigma / m",
            "largest w-test",
            "used in epochs",
        ],
        &rows,
    );
    page.paragraph(
        "Below a satellite: why it was not used, and in how many epochs. The azimuth is the last one; C/N0 and sigma are means. Residuals are those of epochs in which the satellite was \
         used. The w-test is a residual over its standard deviation.",
    );
}

/// Returns the reasons for which a satellite was not used, with the number of epochs.
fn why(known: &Satellite) -> String {
    let others =
        Fate::ALL.iter().zip(known.fates).filter(|(fate, epochs)| **fate != Fate::Used && *epochs > 0);
    others.map(|(fate, epochs)| format!("{fate} ({epochs})")).collect::<Vec<_>>().join(", ")
}
