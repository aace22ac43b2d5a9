//! Settings of a command line, `KEY=VALUE`, as commands of the module.

use anyhow::{Result, bail};
use raim_firmware::settings::{Order, Setting};

/// Returns the words that a setting may be.
///
/// # Panics
/// Panics if the module has no setting with this key.
pub fn words(key: &str) -> &'static [&'static str] {
    Setting::named(key).expect("a key of the module").documentation().words
}

/// Returns the body of the command for `KEY=VALUE`, or for `CONFIRM` and `FORGET`.
///
/// # Errors
/// Fails for a text of another form.
pub fn command_for(text: &str) -> Result<String> {
    if let Some((key, value)) = text.split_once('=') {
        return Ok(format!("{},{value}", key.to_uppercase()));
    }
    let key = text.to_uppercase();
    match Order::read(&key, std::iter::empty()) {
        Some(Ok(Order::Confirm | Order::Forget)) => Ok(key),
        Some(
            Ok(Order::Statistics | Order::SelfTest | Order::Week(_) | Order::Height(..) | Order::Reset)
            | Err(_),
        )
        | None => {
            bail!("--set {text}: write it like HAL=40")
        }
    }
}

/// Returns what a refusal leaves open, to be said behind it: the nearest key, or the values that the
/// key takes.
pub(crate) fn advice(key: &str, why: &str) -> String {
    if why == "unknown key" {
        let distance = |other: &Setting| differences(&key.to_uppercase(), other.key());
        let nearest = Setting::ALL.iter().min_by_key(|other| distance(other));
        let near = nearest.filter(|other| distance(other) <= 2);
        return near.map_or_else(String::new, |other| format!("; is {} meant?", other.key()));
    }
    let Some(setting) = Setting::named(key) else { return String::new() };
    let documentation = setting.documentation();
    let (ranges, unit) = (setting.row().ranges, documentation.unit);
    if why == "out of range" && !ranges.is_empty() {
        let ranges: Vec<String> = ranges.iter().map(|(least, most)| format!("{least} to {most}")).collect();
        return format!("; it takes {}{}{unit}", ranges.join(", "), if unit.is_empty() { "" } else { " " });
    }
    if why == "unknown value" && !documentation.words.is_empty() {
        return format!("; it takes {}", documentation.words.join(", "));
    }
    String::new()
}

/// Returns the number of letters to insert, remove or change between two words (Levenshtein).
fn differences(one: &str, other: &str) -> usize {
    let mut row: Vec<usize> = (0..=other.len()).collect();
    for (number, letter) in one.bytes().enumerate() {
        let mut before = number;
        let mut next = vec![number + 1];
        for (column, another) in other.bytes().enumerate() {
            let above = row.get(column + 1).copied().unwrap_or_default();
            let left = next.last().copied().unwrap_or_default();
            next.push((before + usize::from(letter != another)).min(above + 1).min(left + 1));
            before = above;
        }
        row = next;
    }
    row.last().copied().unwrap_or_default()
}

/// Returns the example of every setting, and a setting of every word, as `KEY=VALUE`.
pub fn every() -> Vec<String> {
    let mut every = Vec::new();
    for setting in Setting::ALL {
        let (key, documentation) = (setting.key(), setting.documentation());
        every.push(format!("{key}={}", documentation.example));
        every.extend(documentation.words.iter().map(|word| match setting {
            Setting::Output => format!("{key}={word},1"),
            _ => format!("{key}={word}"),
        }));
    }
    every
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refusals_name_the_nearest_key_the_range_and_the_words() {
        assert_eq!(advice("MAKS", "unknown key"), "; is MASK meant?");
        assert_eq!(advice("phse", "unknown key"), "; is PHASE meant?");
        assert_eq!(advice("COLOUR", "unknown key"), "");
        assert_eq!(advice("MASK", "out of range"), "; it takes 0 to 60 °");
        assert!(advice("PHASE", "unknown value").contains("NPA, LPV200"));
        assert_eq!(differences("kitten", "sitting"), 3);
    }
}
