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

use crate::run::words::say;

/// Form of the lines.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
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

    /// Reports the state of a sentence `PRAIS`, if it is another than that of the last line;
    /// returns its letter. The level of the pin is that which the state demands.
    pub(super) fn hear(&mut self, message: &[u8]) -> Option<char> {
        let (state, reason) = state_of(message)?;
        if self.last.as_ref().is_some_and(|(last, why)| *last == state && why == reason) {
            return Some(state);
        }
        self.last = Some((state, reason.to_owned()));
        let name = match state {
            'P' => "protected",
            'A' => "alert",
            _ => "unavailable",
        };
        let is_high = state == 'P';
        let pin = if is_high { "high" } else { "low" };
        self.line(
            &format!("state: {name} {reason}, pin {pin}"),
            json!({"event": "state", "state": name, "reason": reason, "pin": is_high}),
        );
        Some(state)
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

/// Returns the state and the reason of a sentence `PRAIS`.
fn state_of(message: &[u8]) -> Option<(char, &str)> {
    let text = std::str::from_utf8(message.strip_prefix(b"$PRAIS,")?).ok()?;
    let mut fields = text.split([',', '*']).skip(1);
    Some((fields.next()?.chars().next()?, fields.next()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn state_and_reason_are_those_of_the_sentence() {
        assert_eq!(state_of(b"$PRAIS,010203.00,A,STALE,,,*5A\r\n"), Some(('A', "STALE")));
        assert_eq!(state_of(b"$PRAIS,010203.00,P,OK*5A\r\n"), Some(('P', "OK")));
        for other in [&b"$GNRMC,1,A,B"[..], b"$PRAIS,010203.00", b"\xFD\x00", b""] {
            assert_eq!(state_of(other), None);
        }
    }

    #[test]
    fn a_state_is_reported_once() {
        let mut log = Log::new(None);
        log.hear(b"$PRAIS,010203.00,A,STALE,,,*5A\r\n");
        assert_eq!(log.last, Some(('A', "STALE".to_owned())));
        log.hear(b"$PRAIS,010204.00,P,OK,,,*5A\r\n");
        assert_eq!(log.last, Some(('P', "OK".to_owned())));
    }
}
