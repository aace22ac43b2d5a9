//! Numbers of a report in few bytes, which its script decodes.
//!
//! ```text
//! c = sgn(v) (1 + round(32766/12 · log₁₀(|v|/10⁻⁴)))     0 for |v| < 10⁻⁴
//! ```
//!
//! A code of 16 bits holds 12 decades of both signs within 0.05 %. Codes are in the order of their
//! values, so that extremes of codes are those of values. Bytes travel in base64.

use std::io::{self, Write};

/// Code of an unknown value.
pub(super) const UNKNOWN: i16 = i16::MIN;

/// Smallest magnitude with a code.
const LEAST: f64 = 1e-4;

/// Codes of a decade.
const PER_DECADE: f64 = 32_766.0 / 12.0;

/// Returns the code of a value.
pub(super) fn coded(value: Option<f64>) -> i16 {
    let Some(value) = value.filter(|value| !value.is_nan()) else { return UNKNOWN };
    let magnitude = value.abs();
    if magnitude < LEAST {
        return 0;
    }
    // The conversion saturates, so that an infinite value has the largest code.
    let code = ((libm::log10(magnitude / LEAST) * PER_DECADE).round() as i16).saturating_add(1);
    let code = if magnitude >= 1e8 { i16::MAX } else { code };
    if value < 0.0 { -code } else { code }
}

/// Returns the value of a code; `None` for the unknown.
pub(super) fn value(code: i16) -> Option<f64> {
    let magnitude = f64::from(code).abs();
    match code {
        UNKNOWN => None,
        0 => Some(0.0),
        _ => Some(f64::from(code.signum()) * LEAST * 10.0_f64.powf((magnitude - 1.0) / PER_DECADE)),
    }
}

/// Appends bytes in base64 (RFC 4648, with padding).
///
/// # Errors
/// The writer's own.
pub(super) fn base64(bytes: impl IntoIterator<Item = u8>, out: &mut impl Write) -> io::Result<()> {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut bytes = bytes.into_iter();
    while let Some(first) = bytes.next() {
        let (second, third) = (bytes.next(), bytes.next());
        let rest = [second, third].map(|byte| u32::from(byte.unwrap_or(0)));
        let bits = u32::from(first) << 16 | rest[0] << 8 | rest[1];
        let known = 1 + second.iter().chain(&third).count();
        let letter = |index: usize| {
            if index <= known { LETTERS[(bits >> (18 - 6 * index) & 63) as usize] } else { b'=' }
        };
        out.write_all(&[0, 1, 2, 3].map(letter))?;
    }
    Ok(())
}

/// Returns bytes in base64.
pub fn base64_text(bytes: &[u8]) -> String {
    let mut text = Vec::new();
    // Memory has room, and the letters are ASCII.
    let _ = base64(bytes.iter().copied(), &mut text);
    String::from_utf8(text).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// RFC 4648, chapter 10.
    #[test]
    fn base64_is_that_of_its_document() {
        for (bytes, want) in
            [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")]
        {
            assert_eq!(base64_text(bytes.as_bytes()), want);
        }
    }

    #[test]
    fn a_code_keeps_a_value_and_the_order_of_values() {
        let mut before = i16::MIN;
        for exponent in -39..=79 {
            let want = -10.0_f64.powf(f64::from(-exponent + 40) / 10.0);
            let code = coded(Some(want));
            assert!(code > before, "{want}");
            before = code;
            let have = value(code).unwrap();
            assert!((have / want - 1.0).abs() < 5e-4, "{want} {have}");
            assert_eq!(coded(Some(-want)), -code);
        }
        assert_eq!((coded(None), coded(Some(f64::NAN)), coded(Some(5e-5))), (UNKNOWN, UNKNOWN, 0));
        assert_eq!((coded(Some(f64::INFINITY)), coded(Some(f64::NEG_INFINITY))), (i16::MAX, -i16::MAX));
    }
}
