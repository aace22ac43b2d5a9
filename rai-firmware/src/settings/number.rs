//! Decimal numbers, read and written without heap.
//!
//! [`decimal`] reads `[+-]digits[.digits][(e|E)[+-]digits]` and refuses everything else: `nan`,
//! `inf`, blanks, hexadecimal. Numbers of up to 15 digits with a decimal exponent within ±22 are
//! read to the nearest `f64`; others to a few units in the last place.

use heapless::String;
use heapless::string::StringView;

use super::fields::cut;
use crate::division::divided;

/// Largest power of ten that a `f64` holds exactly.
const EXACT_POWER: u32 = 22;

/// Significant digits that a `u64` collects without overflow.
const MAX_DIGITS: u32 = 18;

/// Exponent beyond which every number is zero or infinite.
const MAX_EXPONENT: i32 = 400;

/// Digits read so far, and the power of ten that scales them.
#[derive(Clone, Copy, Default)]
struct Mantissa {
    digits: u64,
    significant: u32,
    exponent: i32,
}

impl Mantissa {
    /// Appends a digit; digits beyond [`MAX_DIGITS`] only scale.
    fn push(&mut self, digit: u8, after_point: bool) {
        let kept = self.significant < MAX_DIGITS;
        if kept {
            self.digits = self.digits * 10 + u64::from(digit);
            self.significant += u32::from(self.digits > 0);
        }
        self.exponent += i32::from(!kept) - i32::from(after_point);
    }
}

/// Returns the value of a decimal number; `None` for any other text, and for a value too large for
/// `f64`.
pub fn decimal(text: &str) -> Option<f64> {
    let (negative, text) = sign(text);
    let (mantissa, exponent) = match cut(text, b'e').or_else(|| cut(text, b'E')) {
        Some((mantissa, exponent)) => (mantissa, integer(exponent)?),
        None => (text, 0),
    };
    let (whole, fraction) = cut(mantissa, b'.').unwrap_or((mantissa, ""));
    if whole.is_empty() && fraction.is_empty() {
        return None;
    }
    let mut number = Mantissa::default();
    for (part, after_point) in [(whole, false), (fraction, true)] {
        for byte in part.bytes() {
            number.push(digit(byte)?, after_point);
        }
    }
    let magnitude = scale(number.digits as f64, number.exponent.saturating_add(exponent));
    magnitude.is_finite().then_some(if negative { -magnitude } else { magnitude })
}

fn sign(text: &str) -> (bool, &str) {
    match text.as_bytes().first() {
        Some(sign @ (b'-' | b'+')) => (*sign == b'-', text.get(1..).unwrap_or_default()),
        _ => (false, text),
    }
}

fn digit(byte: u8) -> Option<u8> {
    byte.is_ascii_digit().then(|| byte - b'0')
}

/// Returns the value of a signed whole number, limited to ±[`MAX_EXPONENT`]; `None` without digits.
fn integer(text: &str) -> Option<i32> {
    let (negative, digits) = sign(text);
    if digits.is_empty() {
        return None;
    }
    let magnitude = digits
        .bytes()
        .try_fold(0, |value: i32, byte| Some((value * 10 + i32::from(digit(byte)?)).min(MAX_EXPONENT)))?;
    Some(if negative { -magnitude } else { magnitude })
}

/// Returns `value · 10^exponent`. Dividing by an exact power rounds once; multiplying by its
/// reciprocal would round twice.
fn scale(mut value: f64, exponent: i32) -> f64 {
    let mut left = exponent.unsigned_abs().min(2 * MAX_EXPONENT as u32);
    while left > 0 {
        let step = left.min(EXACT_POWER);
        let power = (0..step).fold(1.0, |power, _| power * 10.0);
        value = if exponent < 0 { value / power } else { value * power };
        left -= step;
    }
    value
}

/// Formats a positive number below 1 with up to ten significant digits, as `3.33e-7`. The tables'
/// probabilities are reported in this form, and [`decimal`] reads it back.
pub fn scientific(value: f64) -> String<20> {
    const DECIMALS: u8 = 9;
    const UNIT: u32 = 10_u32.pow(DECIMALS as u32);
    let mut exponent = (1..=MAX_EXPONENT).find(|exponent| scale(value, *exponent) >= 1.0).unwrap_or(0);
    let mut digits = libm::round(scale(value, exponent + i32::from(DECIMALS))) as u64;
    if digits >= 10 * u64::from(UNIT) {
        (digits, _) = divided(digits, 10);
        exponent -= 1;
    }
    let mut text = String::new();
    // Never longer than d.ddddddddde-ddd.
    push_decimals(&mut text, digits, UNIT);
    let _ = text.push_str("e-");
    push_whole(&mut text, exponent.unsigned_abs().into());
    text
}

/// Formats a number of either sign, or zero: as [`scientific`] if its magnitude is below 1, else as
/// [`plain`].
pub(super) fn signed_scientific(value: f64) -> String<24> {
    let mut text = String::new();
    let magnitude = libm::fabs(value);
    if value < 0.0 {
        // Twenty characters and a sign fit.
        let _ = text.push('-');
    }
    let digits: &str =
        if magnitude > 0.0 && magnitude < 1.0 { &scientific(magnitude) } else { &plain(magnitude) };
    let _ = text.push_str(digits);
    text
}

/// Formats a number below 10⁹ in plain decimals, at most six, without trailing zeros.
pub(super) fn plain(value: f64) -> String<24> {
    const DECIMALS: u32 = 6;
    const UNIT: u32 = 10_u32.pow(DECIMALS);
    let scaled = libm::round(libm::fabs(value) * f64::from(UNIT)) as u64;
    let mut text = String::new();
    // A sign, twenty digits at most in all, and a point.
    if value < 0.0 && scaled > 0 {
        let _ = text.push('-');
    }
    push_decimals(&mut text, scaled, UNIT);
    text
}

/// Formats eight hexadecimal digits.
pub(crate) fn hexadecimal(value: u32) -> String<8> {
    let mut text = String::new();
    for shift in (0..8).rev() {
        let digit = char::from_digit(value >> (4 * shift) & 0xF, 16).unwrap_or('0');
        // Eight fit.
        let _ = text.push(digit.to_ascii_uppercase());
    }
    text
}

/// Appends `parts / unit` without trailing zeros. Digits that do not fit are dropped, here and in
/// `push_whole`.
#[inline(never)]
fn push_decimals(text: &mut StringView, parts: u64, unit: u32) {
    let (mut whole, mut rest) = divided(parts, unit);
    push_whole(text, whole);
    if rest > 0 {
        let _ = text.push('.');
    }
    while rest > 0 {
        (whole, rest) = divided(u64::from(rest) * 10, unit);
        push_whole(text, whole);
    }
}

#[inline(never)]
fn push_whole(text: &mut StringView, mut number: u64) {
    let mut digits = [b'0'; 20];
    let mut many = 0;
    for digit in digits.iter_mut().rev() {
        let (left, last) = divided(number, 10);
        *digit += last as u8;
        number = left;
        many += 1;
        if number == 0 {
            break;
        }
    }
    for digit in digits.iter().skip(20 - many) {
        let _ = text.push(char::from(*digit));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn what_is_no_number_is_refused() {
        for text in [
            "",
            "-",
            "+",
            ".",
            "e5",
            "1e",
            "1e+",
            "nan",
            "NaN",
            "inf",
            "-inf",
            "infinity",
            "0x10",
            "1 ",
            " 1",
            "1.2.3",
            "1e5e5",
            "--1",
            "+-1",
            "1e400",
            "-1e400",
            "1e99999999999999999999",
            "1,5",
            "1_000",
            "\u{0}",
            "é",
        ] {
            assert_eq!(decimal(text), None, "{text:?}");
        }
    }

    #[test]
    fn what_is_a_number_is_read() {
        let cases = [
            ("0", 0.0),
            ("-0.5", -0.5),
            ("+3", 3.0),
            (".5", 0.5),
            ("5.", 5.0),
            ("3.33e-7", 3.33e-7),
            ("1.0245E-08", 1.0245e-8),
            ("-5.9605e-08", -5.9605e-8),
            ("8.8064e+04", 88064.0),
            ("1e-400", 0.0),
            ("0e999", 0.0),
            ("00000000000000000000000000012", 12.0),
            ("0.000000000000000000001", 1e-21),
        ];
        for (text, want) in cases {
            assert_eq!(decimal(text), Some(want), "{text}");
        }
    }

    #[test]
    fn small_numbers_are_named_with_their_digits() {
        let cases =
            [(1e-3, "1e-3"), (3.33e-7, "3.33e-7"), (1.0 / 15000.0, "6.666666667e-5"), (0.005, "5e-3")];
        for (value, want) in cases {
            assert_eq!(scientific(value), want);
        }
    }

    #[test]
    fn settings_are_said_without_zeros_at_the_end() {
        let cases = [
            (556.0, "556"),
            (35.5, "35.5"),
            (-500.0, "-500"),
            (0.0, "0"),
            (-1e-9, "0"),
            (99_999.9, "99999.9"),
        ];
        for (value, want) in cases {
            assert_eq!(plain(value), want);
        }
        for (value, want) in [(-5.9605e-8, "-5.9605e-8"), (88_064.0, "88064"), (0.0, "0")] {
            assert_eq!(signed_scientific(value), want);
        }
    }

    proptest! {
        #[test]
        fn numbers_agree_with_the_standard_library(value in proptest::num::f64::NORMAL) {
            for text in [std::format!("{value:e}"), std::format!("{value}")] {
                let have = decimal(&text).unwrap_or(f64::NAN);
                prop_assert!((have / value - 1.0).abs() <= 1e-14, "{} {}", have, text);
            }
        }

        #[test]
        fn short_numbers_are_the_nearest(digits in 0..1_000_000_000_000_000_u64, exponent in -22..=0_i32) {
            let text = std::format!("{digits}e{exponent}");
            prop_assert_eq!(decimal(&text), text.parse::<f64>().ok());
        }

        #[test]
        fn any_text_is_a_finite_number_or_none(text in "[-+0-9.eE]{0,40}|\\PC*") {
            prop_assert!(decimal(&text).is_none_or(f64::is_finite));
        }

        #[test]
        fn what_is_named_is_understood(value in 1e-12..0.5_f64) {
            let have = decimal(&scientific(value)).unwrap_or(f64::NAN);
            prop_assert!((have / value - 1.0).abs() < 1e-9);
        }
    }
}
