//! Table of the counts, and a check of those that must be zero.

use rig::board::{CORE_HZ, instructions};

use super::Outcome;
use super::watch::Watch;

/// Longest time from the last byte of an epoch to the pin, ms of board time.
pub const TO_PIN_MS: f64 = 10.0;

/// Row: name of the count, and its formatted value.
pub type Row = (&'static str, String);

/// A count that must be zero.
type Zero = (&'static str, u64);

/// Formats outcomes side by side.
pub fn table(outcomes: &[Outcome]) -> String {
    let columns: Vec<_> = outcomes.iter().map(Outcome::sections).collect();
    let values = columns.iter().flatten().flat_map(|(_, rows)| rows).map(|(_, value)| value.chars().count());
    let width = values.max().unwrap_or(0);
    let line = |name: &str, values: Vec<&str>| {
        let values: Vec<String> = values.into_iter().map(|value| format!("{value:>width$}")).collect();
        format!("{name:<NAME_WIDTH$}  {}\n", values.join("  "))
    };
    let mut text = line("", outcomes.iter().map(|outcome| outcome.name).collect());
    for (section, (heading, rows)) in columns.first().into_iter().flatten().enumerate() {
        text.push_str(heading);
        text.push('\n');
        for (row, (name, _)) in rows.iter().enumerate() {
            let values = columns.iter().map(|column| column[section].1[row].1.as_str()).collect();
            text.push_str(&line(&format!("  {name}"), values));
        }
    }
    text
}

/// Width of the longest name with its indentation, characters.
const NAME_WIDTH: usize = 50;

impl Outcome {
    /// Returns the headings of the table, each with its rows.
    pub fn sections(&self) -> Vec<(&'static str, Vec<Row>)> {
        let zeros = self.zeros().into_iter().map(|(name, count)| (name, count.to_string())).collect();
        vec![
            ("what happened", self.scene()),
            ("must be zero", zeros),
            ("false ranges", self.falsehoods()),
            ("time and room", self.times()),
        ]
    }

    /// Returns the counts that must be zero.
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
            ("satellites left out without a false range", tally.left_out_sound.len() as u64),
            ("whole epochs never judged", tally.unspoken.len() as u64),
            ("epochs judged that nobody sent", tally.invented),
            ("commands refused", tally.refused.len() as u64),
            ("settings lost by a restart", tally.settings_lost.len() as u64),
            ("reports of lost bytes or faults", watch.complaints.len() as u64),
        ]
    }

    /// Returns the counts that are not zero although they must be, with the lines that show them.
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
            &tally.left_out_sound,
            &tally.unspoken,
            &tally.damaged,
            &tally.starts_unasked,
            &tally.refused,
            &tally.settings_lost,
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
        let silences = self.watch.to_alert_s.len();
        let [protected, alert, unavailable] = ['P', 'A', 'U'].map(|state| tally.in_state(state));
        vec![
            ("time on the board", hours(self.board_s)),
            ("epochs offered", tally.offered.to_string()),
            ("disturbances of the line", disturbed.to_string()),
            ("resets, silences under a high pin", format!("{}, {silences}", tally.starts_asked - 1)),
            ("times that nobody read the host port", self.unread.to_string()),
            ("ephemerides that came too early", tally.early.to_string()),
            ("epochs judged", judged.to_string()),
            ("protected, alert, unavailable", format!("{protected}, {alert}, {unavailable}")),
            ("sentences", tally.sentences.to_string()),
        ]
    }

    fn falsehoods(&self) -> Vec<Row> {
        let tally = &self.tally;
        let one = tally.falsified - tally.beyond_promise;
        vec![
            ("alerts without a false range", tally.false_alerts.to_string()),
            ("one satellite false: epochs", one.to_string()),
            ("… beyond the limit, had it been accepted", tally.accepted[0].to_string()),
            ("… pin high, error above the protection level", tally.misleading[0].to_string()),
            ("beyond the promise, several false: epochs", tally.beyond_promise.to_string()),
            ("… beyond the limit, had they been accepted", tally.accepted[1].to_string()),
            ("… pin high, error above the protection level", tally.misleading[1].to_string()),
            ("… pin high, error beyond the alert limit", tally.hazardous_beyond_promise.to_string()),
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

/// Converts ticks of board time to ms.
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
