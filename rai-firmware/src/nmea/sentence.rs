//! One sentence: `$address,field,…*CS` CR LF, built field by field in a fixed buffer.
//!
//! The checksum is the exclusive or of all characters between `$` and `*`. Each method of [`Sentence`] appends one
//! field with its leading comma. A sentence that outgrows 82 characters remembers it and is not sent: whoever
//! builds one chooses its fields so that it cannot, or falls back to a coarser form.

use embedded_io::Write;
use heapless::Vec;
use rai_core::satellite::{Constellation, SatelliteId};

use super::TimeOfDay;

/// Longest sentence, `$` and CR LF included (NMEA 0183 v4.11 §5.3).
pub const MAX_LENGTH: usize = 82;

/// Powers of ten up to the largest number of decimals that a field has.
const SCALE: [u64; 10] =
    [1, 10, 100, 1000, 10_000, 100_000, 1_000_000, 10_000_000, 100_000_000, 1_000_000_000];

/// Scaled numbers beyond this are not representable as integers; every field ends far below.
const SCALED_LIMIT: f64 = 1e15;

/// A sentence in the making.
#[derive(Clone, Debug)]
pub struct Sentence {
    bytes: Vec<u8, MAX_LENGTH>,
    checksum: u8,
    overflown: bool,
}

/// A number rounded to a fixed count of decimals, as an integer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Fixed {
    negative: bool,
    scaled: u64,
    decimals: usize,
}

impl Fixed {
    /// `None` where the value is not finite or beyond [`SCALED_LIMIT`]. What rounds to zero has no sign.
    fn new(value: f64, decimals: usize) -> Option<Self> {
        let scale = *SCALE.get(decimals)? as f64;
        let scaled = libm::round(libm::fabs(value) * scale);
        // A NaN fails the comparison.
        (scaled < SCALED_LIMIT).then_some(Self {
            negative: value < 0.0 && scaled > 0.0,
            scaled: scaled as u64,
            decimals,
        })
    }

    /// The value with as many decimals, up to `decimals`, as leave it within `width` characters.
    fn fitting(value: f64, decimals: usize, width: usize) -> Option<Self> {
        (0..=decimals).rev().filter_map(|count| Self::new(value, count)).find(|fixed| fixed.width() <= width)
    }

    fn width(self) -> usize {
        let point = if self.decimals > 0 { self.decimals + 1 } else { 0 };
        usize::from(self.negative) + digits(self.whole()) + point
    }

    fn whole(self) -> u64 {
        SCALE.get(self.decimals).map_or(0, |scale| self.scaled / scale)
    }

    fn fraction(self) -> u64 {
        SCALE.get(self.decimals).map_or(0, |scale| self.scaled % scale)
    }
}

/// How many digits a number has.
fn digits(mut value: u64) -> usize {
    let mut count = 1;
    while value >= 10 {
        value /= 10;
        count += 1;
    }
    count
}

/// True for a character that may stand inside a field: printable, and not one that the format reserves.
pub(crate) fn is_field_character(byte: u8) -> bool {
    matches!(byte, b' '..=b'~') && !matches!(byte, b'!' | b'$' | b'*' | b',' | b'\\' | b'^' | b'~')
}

impl Sentence {
    /// A sentence with its address (talker and formatter), without fields.
    pub fn new(address: &str) -> Self {
        let mut sentence = Self { bytes: Vec::new(), checksum: 0, overflown: false };
        sentence.push_raw(b'$');
        address.bytes().for_each(|byte| sentence.push(byte));
        sentence
    }

    /// A field of text; characters that the format reserves are left out.
    #[must_use]
    pub fn text(self, text: &str) -> Self {
        self.clipped(text, MAX_LENGTH)
    }

    /// As [`Sentence::text`], cut to `width` characters.
    #[must_use]
    pub fn clipped(mut self, text: &str, width: usize) -> Self {
        self.push(b',');
        let kept = text.bytes().filter(|byte| is_field_character(*byte)).take(width);
        kept.for_each(|byte| self.push(byte));
        self
    }

    /// A field without content: not known or not defined.
    #[must_use]
    pub fn empty(self) -> Self {
        self.text("")
    }

    /// A whole number, with leading zeros up to `width` digits.
    #[must_use]
    pub fn integer(mut self, value: u32, width: usize) -> Self {
        self.push(b',');
        self.push_digits(u64::from(value), width);
        self
    }

    /// A number with as many decimals, up to `decimals`, as leave it within `width` characters; an empty field where
    /// even its whole part does not fit, or where it is infinite.
    #[must_use]
    pub fn number(mut self, value: f64, decimals: usize, width: usize) -> Self {
        self.push(b',');
        if let Some(fixed) = Fixed::fitting(value, decimals, width) {
            self.push_fixed(fixed);
        }
        self
    }

    /// As [`Sentence::number`], and empty where there is none.
    #[must_use]
    pub fn optional(self, value: Option<f64>, decimals: usize, width: usize) -> Self {
        match value {
            Some(value) => self.number(value, decimals, width),
            None => self.empty(),
        }
    }

    /// A probability in plain decimals, nine at most and no zeros at the end: readers know no exponents.
    #[must_use]
    pub fn probability(mut self, value: f64) -> Self {
        self.push(b',');
        if let Some(mut fixed) = Fixed::new(value, SCALE.len() - 1) {
            while fixed.decimals > 1 && fixed.scaled.is_multiple_of(10) {
                fixed.scaled /= 10;
                fixed.decimals -= 1;
            }
            self.push_fixed(fixed);
        }
        self
    }

    /// `hhmmss.ss`, or an empty field.
    #[must_use]
    pub fn time(mut self, time: Option<TimeOfDay>) -> Self {
        self.push(b',');
        if let Some([hours, minutes, seconds, hundredths]) = time.map(TimeOfDay::parts) {
            for part in [hours, minutes, seconds] {
                self.push_digits(u64::from(part), 2);
            }
            self.push(b'.');
            self.push_digits(u64::from(hundredths), 2);
        }
        self
    }

    /// Degrees and minutes to seven decimals (0.2 mm), then the hemisphere: two fields.
    #[must_use]
    pub fn angle(mut self, degrees: f64, degree_digits: usize, hemispheres: [&str; 2]) -> Self {
        /// Units of 1e-7 minutes in a degree.
        const PER_DEGREE: u64 = 600_000_000;
        let Some(minutes) = Fixed::new(degrees * 60.0, 7) else { return self.empty().empty() };
        self.push(b',');
        self.push_digits(minutes.scaled / PER_DEGREE, degree_digits);
        let minutes_left = minutes.scaled % PER_DEGREE;
        self.push_digits(minutes_left / 10_000_000, 2);
        self.push(b'.');
        self.push_digits(minutes_left % 10_000_000, 7);
        let [positive, negative] = hemispheres;
        self.text(if minutes.negative { negative } else { positive })
    }

    /// A satellite as in RINEX: `G05`.
    #[must_use]
    pub fn satellite(mut self, satellite: SatelliteId) -> Self {
        self.push(b',');
        self.push(satellite.constellation().letter() as u8);
        self.push_digits(u64::from(satellite.number()), 2);
        self
    }

    /// A satellite's number in the numbering of NMEA 0183 v4.11, which goes with a system id.
    #[must_use]
    pub fn satellite_number(self, satellite: SatelliteId) -> Self {
        let offset = if satellite.constellation() == Constellation::Glonass { 64 } else { 0 };
        self.integer(u32::from(satellite.number()) + offset, 2)
    }

    /// The sentence with checksum and line end; `None` if it would exceed [`MAX_LENGTH`].
    pub fn finish(mut self) -> Option<Vec<u8, MAX_LENGTH>> {
        let checksum = self.checksum;
        self.push_raw(b'*');
        for nibble in [checksum >> 4, checksum & 0xF] {
            self.push_raw(hexadecimal(nibble));
        }
        self.push_raw(b'\r');
        self.push_raw(b'\n');
        (!self.overflown).then_some(self.bytes)
    }

    fn push_fixed(&mut self, fixed: Fixed) {
        if fixed.negative {
            self.push(b'-');
        }
        self.push_digits(fixed.whole(), 1);
        if fixed.decimals > 0 {
            self.push(b'.');
            self.push_digits(fixed.fraction(), fixed.decimals);
        }
    }

    fn push_digits(&mut self, mut value: u64, width: usize) {
        let mut reversed = Vec::<u8, 20>::new();
        while value > 0 || reversed.len() < width.max(1) {
            if reversed.push(b'0' + (value % 10) as u8).is_err() {
                break;
            }
            value /= 10;
        }
        reversed.iter().rev().for_each(|digit| self.push(*digit));
    }

    fn push(&mut self, byte: u8) {
        self.checksum ^= byte;
        self.push_raw(byte);
    }

    fn push_raw(&mut self, byte: u8) {
        self.overflown |= self.bytes.push(byte).is_err();
    }
}

const fn hexadecimal(nibble: u8) -> u8 {
    if nibble < 10 { b'0' + nibble } else { b'A' + (nibble - 10) }
}

/// Sends a finished sentence; one that did not fit is not sent.
///
/// # Errors
/// The writer's own. A writer that takes nothing and calls it success ends the sentence: the contract of
/// [`Write`] forbids it, and waiting for it would have no bound.
pub fn write_sentence<W: Write>(sentence: Sentence, out: &mut W) -> Result<(), W::Error> {
    let Some(bytes) = sentence.finish() else { return Ok(()) };
    let mut rest = bytes.as_slice();
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

    fn body(sentence: Sentence) -> String {
        let bytes = sentence.finish().expect("fits");
        let text = std::str::from_utf8(&bytes).expect("ASCII");
        String::from(text.split('*').next().unwrap_or_default())
    }

    #[test]
    fn checksum_of_a_printed_example() {
        // GNGST of a receiver log, quoted in ros-drivers/nmea_navsat_driver#86.
        let fields = ["130358.60", "36", "", "", "", "0.046", "0.041", "0.057"];
        let sentence = fields.into_iter().fold(Sentence::new("GNGST"), Sentence::text);
        let want = b"$GNGST,130358.60,36,,,,0.046,0.041,0.057*43\r\n";
        assert_eq!(sentence.finish().as_deref(), Some(want.as_slice()));
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
        let sentence = Sentence::new("TEST").text(&"x".repeat(80));
        assert_eq!(sentence.finish(), None);
    }

    #[test]
    fn reserved_characters_cannot_break_the_frame() {
        assert_eq!(body(Sentence::new("T").text("a,b*c$d\r\ne")), "$T,abcde");
    }
}
