//! Numbers in JSON lines: NaN is `null`, infinity `"inf"`.

use serde::{Serialize, Serializer};
use serde_json::Value;

/// A double, NaN and infinities included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Number(pub(super) f64);

impl Number {
    /// Reads a JSON number, `null`, or a word for a number; `None` for anything else.
    pub(super) fn read(value: &Value) -> Option<f64> {
        match value {
            Value::Null => Some(f64::NAN),
            Value::Number(number) => number.as_f64(),
            Value::String(word) => word.parse().ok(),
            _ => None,
        }
    }
}

impl Serialize for Number {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.0 {
            number if number.is_nan() => serializer.serialize_none(),
            f64::INFINITY => serializer.serialize_str("inf"),
            f64::NEG_INFINITY => serializer.serialize_str("-inf"),
            number => serializer.serialize_f64(number),
        }
    }
}

impl From<f64> for Number {
    fn from(number: f64) -> Self {
        Self(number)
    }
}
