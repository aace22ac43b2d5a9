//! The log: one line at the start, and one at each change of the state, on standard error.
//!
//! Service managers add the time to each line, so a text has none. A line of JSON has the seconds
//! of Unix time.
//!
//! ```text
//! state: alert STALE, pin low
//! {"time_s":1767657600.125,"event":"state","state":"alert","reason":"STALE","pin":false}
//! ```

use std::time::SystemTime;

use serde_json::{Value, json};

use crate::page::Verdict;
use crate::run::words::say;
use crate::verdict::State;

/// Form of the lines.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Form {
    /// Words.
    #[default]
    Text,
    /// One JSON object a line.
    Json,
}

/// The log; `None` is a quiet one.
#[derive(Debug)]
pub(super) struct Log {
    form: Option<Form>,
    /// State and reason of the last line.
    last: Option<(char, String)>,
}

impl Log {
    /// Returns a log before its first line.
    pub(super) fn new(form: Option<Form>) -> Self {
        Self { form, last: None }
    }

    /// Reports what the service does: its input, its outputs, its pin, and the settings that differ
    /// from those at start.
    pub(super) fn start(&self, input: &str, outputs: &[String], pin: &str, settings: &[(String, String)]) {
        let settings: Vec<String> = settings.iter().map(|(key, value)| format!("{key}={value}")).collect();
        let words = format!(
            "start: input {input}; output {}; pin {pin}; settings {}",
            outputs.join(", "),
            if settings.is_empty() { "as at start".to_owned() } else { settings.join(" ") }
        );
        self.line(
            &words,
            json!({"event": "start", "input": input, "outputs": outputs, "pin": pin, "settings": settings}),
        );
    }

    /// Reports a state, if it is another than that of the last line. The level of the pin is that
    /// which the state demands.
    pub(super) fn note(&mut self, state: &State) {
        let State { state, reason, .. } = state;
        if self.last.as_ref().is_some_and(|(last, why)| last == state && why == reason) {
            return;
        }
        self.last = Some((*state, reason.clone()));
        let name = Verdict::from_letter(*state).word();
        let is_high = *state == 'P';
        let pin = if is_high { "high" } else { "low" };
        self.line(
            &format!("state: {name} {reason}, pin {pin}"),
            json!({"event": "state", "state": name, "reason": reason, "pin": is_high}),
        );
    }

    fn line(&self, words: &str, mut object: Value) {
        match self.form {
            None => {}
            Some(Form::Text) => say!("{words}"),
            Some(Form::Json) => {
                let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
                if let Some(fields) = object.as_object_mut() {
                    let time_s = (since.as_millis() as f64) * 1e-3;
                    fields.insert("time_s".to_owned(), json!(time_s));
                }
                say!("{object}");
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sentence::{self, Sentence};
    use crate::signal::checksum::nmea_line;

    #[test]
    fn a_state_is_reported_once() {
        let mut log = Log::new(None);
        for (second, body) in ["A,STALE", "P,OK", "P,OK"].iter().enumerate() {
            let text = nmea_line(&format!("PRAIS,01020{second}.00,{body},9,9,,,,,,40.0,"));
            let Ok(Sentence::State(state)) = sentence::parse(&text) else { panic!("{text}") };
            log.note(&state);
            let last = log.last.as_ref().map(|(state, reason)| format!("{state},{reason}"));
            assert_eq!(last.as_deref(), Some(*body));
        }
    }
}
