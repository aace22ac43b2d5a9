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
