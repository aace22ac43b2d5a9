//! Facts of a run that no epoch has: its source, its command, its settings.

use raim_firmware::settings::{Configuration, Setting};

use crate::page::chart::Series;
use crate::page::timeline::Incident;

/// Facts of a run.
#[derive(Clone, Debug, Default)]
pub struct Facts {
    /// Title of the page.
    pub title: String,
    /// Result in a sentence.
    pub summary: String,
    /// Names and values of the most important figures.
    pub figures: Vec<(String, String)>,
    /// File, port or simulation that the bytes came from.
    pub source: String,
    /// Command with its arguments.
    pub command: String,
    /// Hash of the settings, as `PRAIN` reports it.
    pub settings_hash: String,
    /// Settings that differ from those at start: key, value.
    pub settings: Vec<(String, String)>,
    /// Elevation mask, degrees.
    pub mask_deg: f64,
    /// Injected faults.
    pub incidents: Vec<Incident>,
    /// Lines of another receiver behind those of the module: in the chart of the statistic, and in
    /// that of the horizontal error.
    pub beside: [Vec<Series>; 2],
    /// Counters that are not zero, by name.
    pub counters: Vec<(String, u64)>,
}

/// Returns the hash of a configuration, and its settings that differ from those at start.
pub fn settings_of(configuration: &Configuration) -> (String, Vec<(String, String)>) {
    let values = |configuration: &Configuration, setting: Setting| -> Vec<String> {
        let mut values = Vec::new();
        configuration.fields(setting, &mut |value| values.push(value.to_owned()));
        values
    };
    let start = Configuration::at_start();
    let differs = |setting: &&Setting| values(configuration, **setting) != values(&start, **setting);
    let settings = Setting::ALL.iter().filter(differs).map(|setting| {
        let value = values(configuration, *setting).join(",");
        let value = if value.is_empty() { "OFF".to_owned() } else { value };
        (setting.key().to_owned(), value)
    });
    (format!("{:08X}", configuration.hash()), settings.collect())
}

/// Variable with the name under which a person called this program, if it is not that of its file.
const CALLED_AS: &str = "RAI_CALLED_AS";

/// Returns the command of this process, quoted for a shell. Passwords in addresses are masked.
pub fn command_line() -> String {
    let mut words: Vec<String> = std::env::args().collect();
    if let Some(program) = words.first_mut() {
        let name = std::path::Path::new(program.as_str()).file_name();
        let name = name.map_or_else(|| program.clone(), |name| name.to_string_lossy().into_owned());
        *program = std::env::var(CALLED_AS).unwrap_or(name);
    }
    let quoted = |(index, word): (usize, &String)| {
        let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_=.,:/@+".contains(c);
        let word = masked(word);
        if index == 0 || (!word.is_empty() && word.chars().all(is_plain)) {
            word
        } else {
            format!("'{}'", word.replace('\'', "'\\''"))
        }
    };
    words.iter().enumerate().map(quoted).collect::<Vec<_>>().join(" ")
}

/// Returns an address with stars for its password: `ntrip://user:***@host`.
fn masked(word: &str) -> String {
    let parts = || {
        let (scheme, rest) = word.split_once("://")?;
        let (user, host) = rest.rsplit_once('@')?;
        let (user, _) = user.split_once(':')?;
        Some(format!("{scheme}://{user}:***@{host}"))
    };
    parts().unwrap_or_else(|| word.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_password_does_not_reach_a_page() {
        assert_eq!(masked("ntrip://me:se:cr@et@host:2101/M"), "ntrip://me:***@host:2101/M");
        assert_eq!(masked("tcp://host:1"), "tcp://host:1");
        assert_eq!(masked("serial:/dev/ttyS0@9600"), "serial:/dev/ttyS0@9600");
    }

    #[test]
    fn settings_are_those_that_differ_from_the_start() {
        let start = Configuration::at_start();
        assert_eq!(settings_of(&start).1, []);
        let other = start.with("MASK", ["5"].into_iter()).expect("a setting");
        let (hash, settings) = settings_of(&other);
        assert_eq!(settings, [("MASK".to_owned(), "5".to_owned())]);
        assert_eq!(hash, format!("{:08X}", other.hash()));
    }
}
