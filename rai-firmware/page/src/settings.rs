//! Every setting of the module with its text, as INTERFACES.md has it.

use anyhow::Result;
use raim::configure;
use raim_firmware::settings::{Configuration, Setting};
use serde_json::{Value, json};

/// Returns all settings, in the order of the table.
pub(crate) fn all() -> Value {
    let start = Configuration::at_start();
    let one = |setting: &Setting| {
        let (documentation, ranges) = (setting.documentation(), setting.row().ranges);
        let mut values = Vec::new();
        start.fields(*setting, &mut |value| values.push(value.to_owned()));
        json!({
            "key": setting.key(), "text": documentation.text, "unit": documentation.unit,
            "words": documentation.words, "example": documentation.example, "start": values.join(","),
            "ranges": ranges.iter().map(|(least, most)| format!("{least} to {most}")).collect::<Vec<_>>(),
        })
    };
    Setting::ALL.iter().map(one).collect()
}

/// Returns the commands that make a receiver send what the module reads: as a person types them, with
/// their purpose, and as bytes.
///
/// # Errors
/// There is no such receiver, or it has no such port.
pub(crate) fn steps(receiver: &str, wire: &str) -> Result<Value> {
    let steps = configure::steps(receiver, wire)?;
    Ok(steps
        .into_iter()
        .map(|(typed, purpose, bytes)| json!({"typed": typed, "purpose": purpose, "bytes": bytes}))
        .collect())
}
