//! Settings of a command line, `KEY=VALUE`, as commands of the module.

use anyhow::{Context as _, Result, bail, ensure};
use raim_firmware::settings::{Order, Setting};

/// Returns the words that a setting may be.
///
/// # Panics
/// Panics if the module has no setting with this key.
pub fn words(key: &str) -> &'static [&'static str] {
    Setting::named(key).expect("a key of the module").documentation().words
}

/// Reads a setting as every command line and configuration file writes it: `KEY=VALUE` with the key
/// and its words in any case, or an order without values, `CONFIRM` or `FORGET`. Returns key and
/// value; an order has the value "".
///
/// # Errors
/// Fails for a text of another form. Whether there is such a key is the module's answer.
pub fn setting(text: &str) -> Result<(String, String)> {
    let is_plain =
        |text: &str| text.bytes().all(|byte| byte.is_ascii_graphic() && byte != b'*' && byte != b'$');
    let (key, value) = text.split_once('=').unwrap_or((text, ""));
    if value.is_empty() {
        let key = key.to_uppercase();
        return match Order::read(&key, std::iter::empty()) {
            Some(Ok(Order::Confirm | Order::Forget)) => Ok((key, String::new())),
            Some(
                Ok(
                    Order::Statistics
                    | Order::SelfTest
                    | Order::Week(_)
                    | Order::Height(..)
                    | Order::Trust(..)
                    | Order::Reset,
                )
                | Err(_),
            ) => bail!("{key} is a command and no setting, such as HAL=40"),
            None => bail!("`{text}` must be KEY=VALUE, such as HAL=40, or CONFIRM or FORGET"),
        };
    }
    ensure!(
        !key.is_empty() && is_plain(key) && is_plain(value),
        "`{text}` must be KEY=VALUE without blanks, such as HAL=40"
    );
    let key = key.to_uppercase();
    let words = Setting::named(&key).map_or(&[][..], |setting| setting.documentation().words);
    let in_its_case = |item: &str| {
        let word = words.iter().find(|word| word.eq_ignore_ascii_case(item));
        word.map_or_else(|| item.to_owned(), |word| (*word).to_owned())
    };
    let value = value.split(',').map(in_its_case).collect::<Vec<_>>().join(",");
    Ok((key, value))
}

/// Returns the body of the command for a [`setting`].
///
/// # Errors
/// As for [`setting`].
pub fn command_for(text: &str) -> Result<String> {
    let (key, value) = setting(text).with_context(|| format!("--set {text}"))?;
    Ok(if value.is_empty() { key } else { format!("{key},{value}") })
}

/// Returns what a refusal leaves open, to be said behind it: the nearest key or where all are, the
/// values that the key takes, or an example.
pub(crate) fn advice(key: &str, why: &str) -> String {
    if why == "unknown key" {
        let distance = |other: &Setting| differences(&key.to_uppercase(), other.key());
        let nearest = Setting::ALL.iter().min_by_key(|other| distance(other));
        // At least half of a misspelt word is right.
        let near = nearest.filter(|other| distance(other) <= 2 && 2 * distance(other) <= key.len());
        return near.map_or_else(
            || "; INTERFACES.md lists every key and its values".to_owned(),
            |other| format!("; is {} meant?", other.key()),
        );
    }
    let Some(setting) = Setting::named(key) else { return String::new() };
    let documentation = setting.documentation();
    let (ranges, unit) = (setting.row().ranges, documentation.unit);
    // What is out of range may also be a value that is no number, such as digits of a key.
    let are_all_numbers = documentation.example.split(',').count() <= ranges.len();
    if why == "out of range" && are_all_numbers {
        let ranges: Vec<String> = ranges.iter().map(|(least, most)| format!("{least} to {most}")).collect();
        return format!("; it takes {}{}{unit}", ranges.join(", "), if unit.is_empty() { "" } else { " " });
    }
    if why == "unknown value" && !documentation.words.is_empty() {
        return format!("; it takes {}", documentation.words.join(", "));
    }
    format!("; for example {}={}", setting.key(), documentation.example)
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
    fn a_setting_has_one_grammar() {
        let read = |text: &str| setting(text).ok();
        let pair = |key: &str, value: &str| Some((key.to_owned(), value.to_owned()));
        assert_eq!(read("hal=40"), pair("HAL", "40"));
        assert_eq!(read("phase=lpv200"), pair("PHASE", "LPV200"));
        assert_eq!(read("output=gsv,1"), pair("OUTPUT", "GSV,1"));
        assert_eq!(read("confirm"), pair("CONFIRM", ""));
        assert_eq!(read("FORGET"), pair("FORGET", ""));
        // The module has no such key, and says so.
        assert_eq!(read("foo=bar"), pair("FOO", "bar"));
        for wrong in ["", "=5", "HAL=", "HAL", "RESET", "STATS", "HAL= 40", "HAL=4*0", "$HAL=40"] {
            assert_eq!(read(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn every_example_is_a_setting() {
        for text in every() {
            assert_eq!(command_for(&text).unwrap(), text.replacen('=', ",", 1));
            let lower = text.to_lowercase();
            let (key, _) = text.split_once('=').unwrap();
            assert_eq!(setting(&lower).unwrap().0, key);
        }
    }

    #[test]
    fn refusals_name_the_nearest_key_the_range_and_the_words() {
        assert_eq!(advice("MAKS", "unknown key"), "; is MASK meant?");
        assert_eq!(advice("phse", "unknown key"), "; is PHASE meant?");
        for key in ["COLOUR", "FOO"] {
            assert_eq!(advice(key, "unknown key"), "; INTERFACES.md lists every key and its values");
        }
        assert_eq!(advice("MASK", "out of range"), "; it takes 0 to 60 °");
        assert!(advice("KEY", "out of range").starts_with("; for example KEY=1,"));
        assert!(advice("PHASE", "unknown value").contains("NPA, LPV200"));
        assert_eq!(differences("kitten", "sitting"), 3);
    }
}
