//! One sentence: `$address,field,…*CS` CR LF, built field by field in a fixed buffer.
//!
//! The checksum is the exclusive or of all characters between `$` and `*`. Each method of
//! [`Sentence`] appends one field with its leading comma and returns the sentence. A sentence that
//! exceeds 82 characters is not sent. Callers therefore choose fields that always fit, or try a
//! coarser form.
//!
//! Numbers are rounded to the nearest, ties to even. They are written by 32-bit divisions if they
//! fit: the processor divides 32 bits in hardware, but 64 bits by long calls.

use embedded_io::Write;
use raim_core::satellite::SatelliteId;

use super::TimeOfDay;
use super::digits::{Digits, SCALE, digits, low_digits};
use crate::division::divided;

/// Longest sentence, `$` and CR LF included ([NMEA-0183] v4.11 §5.3).
///
/// [NMEA-0183]: crate#references
pub const MAX_LENGTH: usize = 82;

/// Length of checksum and line end: `*CS` CR LF.
pub(super) const ENDING: usize = 5;

/// Limit of a number times its scale. Larger numbers are not formatted, because no field is wide
/// enough for them anyway.
const SCALED_LIMIT: f64 = 1e15;

/// Sentence that is being built.
#[derive(Clone, Debug)]
pub struct Sentence {
    /// Characters, of which the first `length` are written.
    text: [u8; MAX_LENGTH],
    length: usize,
    overflown: bool,
}

/// Number rounded to a fixed count of decimals, in integers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Fixed {
    negative: bool,
    whole: u64,
    fraction: u32,
    /// Number of digits of `whole`.
    digits: usize,
    /// Number of digits of `fraction`.
    decimals: usize,
}

impl Fixed {
    /// Rounds a value; `None` if it is not finite or exceeds [`SCALED_LIMIT`]. A value that rounds
    /// to zero has no sign.
    fn new(value: f64, decimals: usize) -> Option<Self> {
        let scale = *SCALE.get(decimals)?;
        let scaled = nearest_integer(libm::fabs(value) * f64::from(scale))?;
        let (whole, fraction) = divided(scaled, scale);
        let negative = value.is_sign_negative() && scaled > 0;
        Some(Self { negative, whole, fraction, digits: digits(whole), decimals })
    }

    /// Rounds in single precision, which the processor supports. The result can differ from
    /// [`Self::new`] only for values within 1e-4 of a tie. Returns `None` if seven digits are too
    /// few.
    fn short(value: f64, decimals: usize) -> Option<Self> {
        const LIMIT: u64 = 512_f64.to_bits();
        // From 2²³ on, single precision has no bits for a fraction, so that adding 2²³ rounds to an
        // integer.
        const NO_FRACTION: f32 = (1_u32 << 23) as f32;
        let scale = *SCALE.get(decimals).filter(|_| decimals <= 3)?;
        if libm::fabs(value).to_bits() >= LIMIT {
            return None;
        }
        let scaled =
            (libm::fabsf(value as f32) * scale as f32 + NO_FRACTION).to_bits() - NO_FRACTION.to_bits();
        let (whole, fraction) = (scaled / scale, scaled % scale);
        let (negative, digits) = (value.is_sign_negative() && scaled > 0, low_digits(whole));
        Some(Self { negative, whole: u64::from(whole), fraction, digits, decimals })
    }

    /// Returns the value with as many decimals, up to `decimals`, as fit into `width` characters.
    fn fitting(value: f64, decimals: usize, width: usize) -> Option<Self> {
        let fits = |fixed: &Self| fixed.width() <= width;
        let long = || (0..=decimals).rev().filter_map(|count| Self::new(value, count)).find(fits);
        Self::short(value, decimals).filter(fits).or_else(long)
    }

    fn width(self) -> usize {
        let point = if self.decimals > 0 { self.decimals + 1 } else { 0 };
        usize::from(self.negative) + self.digits + point
    }
}

#[cfg(feature = "observer")]
impl Fixed {
    /// Returns the number that a reader of the digits gets.
    fn value(self) -> f64 {
        let scale = SCALE.get(self.decimals).map_or(1, |scale| u64::from(*scale));
        let value = (self.whole * scale + u64::from(self.fraction)) as f64 / scale as f64;
        if self.negative { -value } else { value }
    }
}

/// Returns a number as a reader of [`Sentence::number`] gets it; `None` for an empty field.
#[cfg(feature = "observer")]
pub(super) fn rounded(value: f64, decimals: usize, width: usize) -> Option<f64> {
    Fixed::fitting(value, decimals, width).map(Fixed::value)
}

/// Returns what a reader of [`Sentence::angle`] gets, without sign: whole degrees, and degrees and
/// minutes in one number; `None` for an empty field.
#[cfg(feature = "observer")]
pub(super) fn rounded_minutes(degrees: f64) -> Option<[f64; 2]> {
    let minutes = Fixed { negative: false, ..Fixed::new(degrees * 60.0, 7)? };
    let (whole, rest) = (minutes.whole / 60, minutes.whole % 60);
    Some([whole as f64, Fixed { whole: 100 * whole + rest, ..minutes }.value()])
}

/// Returns the integer nearest to a number from 0 to [`SCALED_LIMIT`], ties to even; `None` beyond.
///
/// Both steps work on the bits, because comparing and converting doubles are calls on this
/// processor. The bits of positive numbers have the order of the numbers, with NaN at the end. From
/// 2⁵² on, a double has no bits for a fraction, so that adding 2⁵² rounds to an integer.
fn nearest_integer(value: f64) -> Option<u64> {
    const NO_FRACTION: f64 = (1_u64 << 52) as f64;
    let is_within = value.to_bits() < SCALED_LIMIT.to_bits();
    is_within.then(|| (value + NO_FRACTION).to_bits() - NO_FRACTION.to_bits())
}

/// Returns true for a character that may stand inside a field: printable, and not reserved by the
/// format.
pub(crate) fn is_field_character(byte: u8) -> bool {
    matches!(byte, b' '..=b'~') && !matches!(byte, b'!' | b'$' | b'*' | b',' | b'\\' | b'^' | b'~')
}

impl Sentence {
    /// Begins a sentence with its address (talker and formatter).
    // Not inlined, so that its many callers share one copy.
    #[inline(never)]
    pub fn new(address: &str) -> Self {
        let mut sentence = Self { text: [0; MAX_LENGTH], length: 0, overflown: false };
        sentence.push_one(b'$');
        sentence.push(address.as_bytes());
        sentence
    }

    /// Appends a text; reserved characters are left out.
    pub fn text(&mut self, text: &str) -> &mut Self {
        self.clipped(text, MAX_LENGTH)
    }

    /// Appends a text as [`Sentence::text`], cut to `width` characters.
    pub fn clipped(&mut self, text: &str, width: usize) -> &mut Self {
        self.push_one(b',');
        let kept = text.bytes().filter(|byte| is_field_character(*byte)).take(width);
        kept.for_each(|byte| self.push_one(byte));
        self
    }

    /// Appends one or several fields that are ready: they contain no reserved character except the
    /// commas between them.
    // Not inlined, so that its many callers share one copy.
    pub(crate) fn ready(&mut self, fields: &[u8]) -> &mut Self {
        self.push_one(b',');
        self.push(fields);
        self
    }

    /// Appends an empty field: unknown or undefined.
    pub fn empty(&mut self) -> &mut Self {
        self.push_one(b',');
        self
    }

    /// Appends a whole number, with leading zeros up to `width` digits.
    pub fn integer(&mut self, value: u32, width: usize) -> &mut Self {
        let count = low_digits(value).max(width);
        self.field(count).low(value, count);
        self
    }

    /// Appends eight hexadecimal digits.
    pub fn hexadecimal(&mut self, value: u32) -> &mut Self {
        let digits = [28, 24, 20, 16, 12, 8, 4, 0].map(|shift| hexadecimal((value >> shift) as u8 & 0xF));
        self.ready(&digits)
    }

    /// Appends a number with as many decimals, up to `decimals`, as fit into `width` characters.
    /// The field is empty if the whole part does not fit or the number is not finite.
    pub fn number(&mut self, value: f64, decimals: usize, width: usize) -> &mut Self {
        self.fixed(Fixed::fitting(value, decimals, width))
    }

    /// Appends a number as [`Sentence::number`], or an empty field for `None`.
    pub fn optional(&mut self, value: Option<f64>, decimals: usize, width: usize) -> &mut Self {
        match value {
            Some(value) => self.number(value, decimals, width),
            None => self.empty(),
        }
    }

    /// Appends a probability in plain decimals, at most nine, without trailing zeros, because
    /// readers do not accept exponents.
    pub fn probability(&mut self, value: f64) -> &mut Self {
        let Some(mut fixed) = Fixed::new(value, SCALE.len() - 1) else { return self.empty() };
        while fixed.decimals > 1 && fixed.fraction.is_multiple_of(10) {
            fixed.fraction /= 10;
            fixed.decimals -= 1;
        }
        self.fixed(Some(fixed))
    }

    /// Appends `hhmmss.ss`, or an empty field.
    pub fn time(&mut self, time: Option<TimeOfDay>) -> &mut Self {
        match time {
            Some(time) => self.ready(time.text()),
            None => self.empty(),
        }
    }

    /// Appends degrees and minutes to seven decimals (0.2 mm), then the hemisphere: two fields.
    pub fn angle(&mut self, degrees: f64, degree_digits: usize, hemispheres: [&str; 2]) -> &mut Self {
        let Some(minutes) = Fixed::new(degrees * 60.0, 7) else { return self.empty().empty() };
        // 180° is 10,800 minutes, which fits into 32 bits.
        let whole_minutes = minutes.whole as u32;
        let mut field = self.field(degree_digits + "mm.0123456".len());
        field.low(minutes.fraction, 7);
        field.put(b'.');
        field.low(whole_minutes % 60, 2);
        field.low(whole_minutes / 60, degree_digits);
        let [positive, negative] = hemispheres;
        self.ready(if minutes.negative { negative } else { positive }.as_bytes())
    }

    /// Returns the text behind the address, so that other sentences can reuse the same fields.
    pub(super) fn fields(&self) -> &[u8] {
        let text = self.written();
        let from = text.iter().position(|byte| *byte == b',').map_or(text.len(), |comma| comma + 1);
        text.get(from..).unwrap_or_default()
    }

    /// Appends a satellite as in RINEX: `G05`.
    pub fn satellite(&mut self, satellite: SatelliteId) -> &mut Self {
        let (letter, number) = satellite.name();
        let mut field = self.field("G05".len());
        field.low(u32::from(number), 2);
        field.put(letter as u8);
        self
    }

    /// Appends a satellite's number in the numbering of [NMEA-0183] v4.11, which needs a system id.
    ///
    /// [NMEA-0183]: crate#references
    pub fn satellite_number(&mut self, satellite: SatelliteId) -> &mut Self {
        let (letter, number) = satellite.name();
        let offset = if letter == 'R' { 64 } else { 0 };
        self.integer(u32::from(number) + offset, 2)
    }

    /// Ends the sentence with checksum and line end and returns it; `None` if it would exceed
    /// [`MAX_LENGTH`]. A finished sentence takes no more fields.
    pub fn finish(&mut self) -> Option<&[u8]> {
        if !self.fits() {
            return None;
        }
        // The `$` does not count.
        let checksum = exclusive_or(self.written()) ^ b'$';
        let [high, low] = [checksum >> 4, checksum & 0xF].map(hexadecimal);
        self.push(&[b'*', high, low, b'\r', b'\n']);
        Some(self.written())
    }

    /// Returns the number of characters that still fit before checksum and line end.
    pub(super) fn room(&self) -> usize {
        (MAX_LENGTH - ENDING).saturating_sub(self.length)
    }

    /// Returns true if checksum and line end fit.
    pub(super) fn fits(&self) -> bool {
        !self.overflown && self.length + ENDING <= MAX_LENGTH
    }

    /// Appends a rounded number, or an empty field for `None`.
    fn fixed(&mut self, fixed: Option<Fixed>) -> &mut Self {
        let Some(fixed) = fixed else { return self.empty() };
        let mut field = self.field(fixed.width());
        if fixed.decimals > 0 {
            field.low(fixed.fraction, fixed.decimals);
            field.put(b'.');
        }
        field.number(fixed.whole, fixed.digits);
        if fixed.negative {
            field.put(b'-');
        }
        self
    }

    /// Opens a field of this many characters, with its comma.
    fn field(&mut self, length: usize) -> Digits<'_> {
        match self.place(1 + length) {
            [comma, field @ ..] => {
                *comma = b',';
                Digits(field)
            }
            [] => Digits(&mut []),
        }
    }

    // Neither this function nor those below are inlined: they have many callers, and flash is
    // scarcer than time here.
    #[inline(never)]
    fn push_one(&mut self, byte: u8) {
        if let [place] = self.place(1) {
            *place = byte;
        }
    }

    #[inline(never)]
    fn push(&mut self, bytes: &[u8]) {
        for (place, byte) in self.place(bytes.len()).iter_mut().zip(bytes) {
            *place = *byte;
        }
    }

    /// Returns the place of the next characters; no place if they do not fit.
    #[inline(never)]
    fn place(&mut self, length: usize) -> &mut [u8] {
        let end = self.length + length;
        if let Some(place) = self.text.get_mut(self.length..end) {
            self.length = end;
            place
        } else {
            self.overflown = true;
            &mut []
        }
    }

    /// Returns what was written.
    fn written(&self) -> &[u8] {
        self.text.get(..self.length).unwrap_or_default()
    }
}

/// Returns the exclusive or of all bytes, four at a time.
fn exclusive_or(bytes: &[u8]) -> u8 {
    let (words, rest) = bytes.as_chunks::<4>();
    let sum = words.iter().fold(0, |sum, word| sum ^ u32::from_ne_bytes(*word));
    sum.to_ne_bytes().iter().chain(rest).fold(0, |sum, byte| sum ^ byte)
}

const fn hexadecimal(nibble: u8) -> u8 {
    if nibble < 10 { b'0' + nibble } else { b'A' + (nibble - 10) }
}

/// Sends a finished sentence; does not send one that exceeds its length.
///
/// # Errors
/// The writer's own. A writer that reports success without taking a byte loses one byte per call:
/// the contract of [`Write`] forbids this, and waiting for it would have no bound.
pub fn write_sentence<W: Write>(sentence: &mut Sentence, out: &mut W) -> Result<(), W::Error> {
    let Some(mut rest) = sentence.finish() else { return Ok(()) };
    while !rest.is_empty() {
        let taken = out.write(rest)?;
        rest = rest.get(taken.max(1)..).unwrap_or_default();
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::GpsTime;
    use std::string::String;

    fn body(sentence: &mut Sentence) -> String {
        let bytes = sentence.finish().expect("fits");
        let text = std::str::from_utf8(bytes).expect("ASCII");
        String::from(text.split('*').next().unwrap_or_default())
    }

    #[test]
    fn checksum_of_a_printed_example() {
        // GNGST of a receiver log, quoted in ros-drivers/nmea_navsat_driver#86.
        let fields = ["130358.60", "36", "", "", "", "0.046", "0.041", "0.057"];
        let mut sentence = Sentence::new("GNGST");
        fields.into_iter().fold(&mut sentence, |sentence, field| sentence.text(field));
        let want = b"$GNGST,130358.60,36,,,,0.046,0.041,0.057*43\r\n";
        assert_eq!(sentence.finish(), Some(want.as_slice()));
    }

    #[test]
    fn numbers_lose_decimals_before_they_leave_the_field_empty() {
        let cases = [
            (1.0, "$T,1.000"),
            (-1.2346, "$T,-1.235"),
            (-0.0004, "$T,0.000"),
            (9999.9999, "$T,10000.000"),
            (1_234_567.0, "$T,1234567.0"),
            (99_999_999.4, "$T,99999999"),
            (99_999_999.6, "$T,100000000"),
            (1e12, "$T,"),
            (f64::INFINITY, "$T,"),
            (f64::NAN, "$T,"),
        ];
        for (value, want) in cases {
            assert_eq!(body(Sentence::new("T").number(value, 3, 9)), want, "{value}");
        }
    }

    #[test]
    fn angles_carry_into_the_degree_and_keep_their_hemisphere() {
        let latitude = |degrees| body(Sentence::new("T").angle(degrees, 2, ["N", "S"]));
        assert_eq!(latitude(89.999_999_999_99), "$T,9000.0000000,N");
        assert_eq!(latitude(-0.5), "$T,0030.0000000,S");
        assert_eq!(latitude(-1e-12), "$T,0000.0000000,N");
        assert_eq!(latitude(f64::NAN), "$T,,");
        let longitude = body(Sentence::new("T").angle(-180.0, 3, ["E", "W"]));
        assert_eq!(longitude, "$T,18000.0000000,W");
    }

    #[test]
    fn probabilities_end_at_their_last_digit() {
        let have = |value| body(Sentence::new("T").probability(value));
        assert_eq!(have(1e-3), "$T,0.001");
        assert_eq!(have(1.0 / 15000.0), "$T,0.000066667");
        assert_eq!(have(0.0), "$T,0.0");
    }

    #[test]
    fn time_of_day_rounds_into_the_next_day() {
        let midnight_utc = GpsTime { week: 2400, tow_ms: 18_000 };
        let at = |ms| GpsTime::from_ms(midnight_utc.to_ms().saturating_add_signed(ms));
        let have = |ms| body(Sentence::new("T").time(Some(TimeOfDay::new(at(ms), 18))));
        assert_eq!(have(0), "$T,000000.00");
        assert_eq!(have(-6), "$T,235959.99");
        assert_eq!(have(-5), "$T,000000.00");
        assert_eq!(have(43_200_970), "$T,120000.97");
        assert_eq!(have(86_399_994), "$T,235959.99");
    }

    #[test]
    fn what_outgrows_a_sentence_is_not_sent() {
        assert_eq!(Sentence::new("TEST").text(&"x".repeat(80)).finish(), None);
    }

    #[test]
    fn reserved_characters_cannot_break_the_frame() {
        assert_eq!(body(Sentence::new("T").text("a,b*c$d\r\ne")), "$T,abcde");
    }
}
