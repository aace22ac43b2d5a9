//! The counts as a table, and whether those that must be zero are.

use std::fmt::Write as _;

use super::Outcome;
use super::watch::Watch;
use crate::board::{CORE_HZ, instructions};

/// Longest time from the last byte of an epoch to the pin, ms of board time.
pub const TO_PIN_MS: f64 = 10.0;

/// A row: what is counted, and the value in words.
type Row = (&'static str, String);

/// A count that must be zero.
type Zero = (&'static str, u64);

/// Outcomes side by side.
pub fn table(outcomes: &[Outcome]) -> String {
    let columns: Vec<Vec<Row>> = outcomes.iter().map(Outcome::rows).collect();
    let width = columns.iter().flatten().map(|(_, value)| value.chars().count()).max().unwrap_or(0);
    let Some(first) = columns.first() else { return String::new() };
    let mut text = String::new();
    for (index, (name, _)) in first.iter().enumerate() {
        let _ = write!(text, "{name:<46}");
        for (_, value) in columns.iter().filter_map(|column| column.get(index)) {
            let _ = write!(text, "  {value:>width$}");
        }
        text.push('\n');
    }
    text
}

impl Outcome {
    /// The rows of the table.
    pub fn rows(&self) -> Vec<Row> {
        let mut rows = self.scene();
        rows.extend(self.zeros().into_iter().map(|(name, count)| (name, count.to_string())));
        rows.extend(self.beyond());
        rows.extend(self.times());
        rows
    }

    /// The counts that must be zero.
    pub fn zeros(&self) -> Vec<Zero> {
        let (tally, watch) = (&self.tally, &self.watch);
        let unasked =
            (tally.starts_unasked.len() as u64).max(watch.starts.saturating_sub(tally.starts_asked));
        let late = watch.to_pin_ticks.iter().filter(|&&ticks| ms(ticks) > TO_PIN_MS).count();
        vec![
            ("sentences damaged", tally.damaged.len() as u64),
            ("resets not asked for", unasked),
            ("pin high, error beyond the alert limit", tally.hazardous),
            ("pin high on a stale epoch", tally.stale + watch.stale),
            ("pin against the verdict", watch.contradictions),
            ("pin later than 10 ms after the last byte", late as u64),
            ("whole epochs never judged", tally.unspoken.len() as u64),
            ("epochs judged that nobody sent", tally.invented),
            ("commands refused", tally.refused.len() as u64),
            ("reports of lost bytes or faults", watch.complaints.len() as u64),
        ]
    }

    /// What is not zero and must be, with what was heard of it.
    pub fn broken(&self) -> Vec<String> {
        let mut broken: Vec<String> = self
            .zeros()
            .into_iter()
            .filter(|(_, count)| *count > 0)
            .map(|(name, count)| format!("{}: {name}: {count}", self.name))
            .collect();
        let (tally, watch) = (&self.tally, &self.watch);
        for heard in [
            &tally.wrongly_promised,
            &tally.unspoken,
            &tally.damaged,
            &tally.starts_unasked,
            &tally.refused,
            &watch.complaints,
        ] {
            broken.extend(heard.iter().take(3).map(|words| format!("{}: {words}", self.name)));
        }
        broken
    }

    fn scene(&self) -> Vec<Row> {
        let tally = &self.tally;
        let disturbed: u64 = self.disturbances.iter().map(|(_, count)| count).sum();
        let judged: u64 = tally.verdicts.values().sum();
        vec![
            ("", self.name.to_owned()),
            ("time on the board", hours(self.board_s)),
            ("epochs offered", tally.offered.to_string()),
            ("disturbances of the line", disturbed.to_string()),
            ("resets, silences, host deaf", {
                format!("{}, {}, {}", tally.starts_asked - 1, self.watch.to_alert_s.len(), self.unread)
            }),
            ("epochs judged", judged.to_string()),
            ("protected, alert, unavailable", {
                let [protected, alert, unavailable] = ['P', 'A', 'U'].map(|state| tally.in_state(state));
                format!("{protected}, {alert}, {unavailable}")
            }),
            ("with one satellite false", (tally.falsified - tally.beyond_promise).to_string()),
            ("  beyond the limit, were every one believed", tally.believed[0].to_string()),
            ("alerts without a false range", tally.false_alerts.to_string()),
            ("sentences", tally.sentences.to_string()),
        ]
    }

    fn beyond(&self) -> Vec<Row> {
        let tally = &self.tally;
        vec![
            ("error above the protection level, pin high", tally.misleading[0].to_string()),
            ("several satellites or a system false, epochs", tally.beyond_promise.to_string()),
            ("  beyond the limit, were every one believed", tally.believed[1].to_string()),
            ("  pin high, error beyond the alert limit", tally.hazardous_beyond_promise.to_string()),
            ("  error above the protection level, pin high", tally.misleading[1].to_string()),
        ]
    }

    fn times(&self) -> Vec<Row> {
        let watch = &self.watch;
        let mut ticks = watch.to_pin_ticks.clone();
        ticks.sort_unstable();
        let at = |share: f64| ticks.get((ticks.len() as f64 * share) as usize).or(ticks.last()).copied();
        let in_ms = |ticks: Option<u64>| ticks.map_or("-".to_owned(), |ticks| format!("{:.2} ms", ms(ticks)));
        let longest_s = watch.to_alert_s.iter().copied().fold(0.0, f64::max);
        vec![
            ("last byte to pin, median", in_ms(at(0.5))),
            ("last byte to pin, worst", in_ms(at(1.0))),
            ("silence to pin low, worst", format!("{longest_s:.3} of {} s", self.tempo.time_to_alert_s)),
            ("stack, deepest", format!("{} B", watch.stack_bytes)),
            ("rings, fullest: GNSS, host in, host out, log", rings(watch)),
        ]
    }
}

/// Board time of so many ticks, ms.
pub fn ms(ticks: u64) -> f64 {
    const { assert!(CORE_HZ == 168_000_000, "an instruction takes one nanosecond") };
    instructions(ticks) as f64 * 1e-6
}

fn hours(time_s: f64) -> String {
    let minutes = (time_s / 60.0).round() as u64;
    format!("{} h {:02} min", minutes / 60, minutes % 60)
}

fn rings(watch: &Watch) -> String {
    let names = ["gnss_in", "host_in", "host_out", "log_out"];
    let fullest = names.map(|name| watch.rings.get(name).map_or("-".to_owned(), ToString::to_string));
    format!("{} B", fullest.join(", "))
}
