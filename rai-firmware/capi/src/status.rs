//! Status of a call.

use core::ffi::{CStr, c_char};

use raim_core::epoch::EpochError;
#[cfg(feature = "receiver")]
use raim_firmware::settings::Refusal;

/// Status of a call: `RAI_STATUS_OK`, or the reason of its refusal.
pub type rai_status_t = u8;

/// Success.
pub const RAI_STATUS_OK: rai_status_t = 0;
/// A pointer must not be null.
pub const RAI_STATUS_NULL: rai_status_t = 1;
/// A pointer must be aligned for its type.
pub const RAI_STATUS_MISALIGNED: rai_status_t = 2;
/// The memory is shorter than the object.
pub const RAI_STATUS_SHORT: rai_status_t = 3;
/// The object was not initialised, or by another version.
pub const RAI_STATUS_NOT_INITIALISED: rai_status_t = 4;
/// The size at the start of a struct belongs to no version known here.
pub const RAI_STATUS_SIZE: rai_status_t = 5;
/// A time must be finite.
pub const RAI_STATUS_TIME: rai_status_t = 6;
/// A count or length is out of bounds.
pub const RAI_STATUS_COUNT: rai_status_t = 7;
/// A text must be printable ASCII without `$` and `*`, and of at most 192 characters; a key has no
/// comma.
pub const RAI_STATUS_TEXT: rai_status_t = 8;
/// The phase of flight is unknown.
pub const RAI_STATUS_PHASE: rai_status_t = 16;
/// The horizontal alert limit must be in (0, 1e6] m.
pub const RAI_STATUS_HAL: rai_status_t = 17;
/// The vertical alert limit must be in (0, 1e6] m.
pub const RAI_STATUS_VAL: rai_status_t = 18;
/// The probability of false alarm must be in the committed tables.
pub const RAI_STATUS_FALSE_ALARM: rai_status_t = 19;
/// The probability of missed detection must be in the committed tables.
pub const RAI_STATUS_MISSED_DETECTION: rai_status_t = 20;
/// The policy is unknown.
pub const RAI_STATUS_POLICY: rai_status_t = 21;
/// The method is unknown in this library.
pub const RAI_STATUS_METHOD: rai_status_t = 22;
/// The kind of protection levels is unknown.
pub const RAI_STATUS_LEVELS: rai_status_t = 23;
/// A setting is out of its range.
pub const RAI_STATUS_SETTING: rai_status_t = 24;
/// The highest speed must be in [0, 1e5] m/s.
pub const RAI_STATUS_SPEED: rai_status_t = 25;
/// The heights must be in [−1.2e4, 1e8] m, the least below the greatest.
pub const RAI_STATUS_HEIGHT: rai_status_t = 26;
/// The recovery must be of at least one epoch and in [0, 3600] s.
pub const RAI_STATUS_RECOVERY: rai_status_t = 27;
/// The satellite is unknown.
pub const RAI_STATUS_SATELLITE: rai_status_t = 32;
/// A range must be finite and within that of receiver clocks.
pub const RAI_STATUS_RANGE: rai_status_t = 33;
/// A satellite's position must be finite, above the earth and within 100,000 km.
pub const RAI_STATUS_POSITION: rai_status_t = 34;
/// A standard deviation must be finite and in 1 mm to 1,000 km.
pub const RAI_STATUS_SIGMA: rai_status_t = 35;
/// A satellite appears twice.
pub const RAI_STATUS_DUPLICATE: rai_status_t = 36;
/// The epoch has more satellites than the library was built for.
pub const RAI_STATUS_FULL: rai_status_t = 37;
/// No setting and no order has this key.
pub const RAI_STATUS_KEY: rai_status_t = 48;
/// The key needs a value more.
pub const RAI_STATUS_VALUE_MISSING: rai_status_t = 49;
/// The key takes fewer values.
pub const RAI_STATUS_VALUE_EXTRA: rai_status_t = 50;
/// The value must be one of the key's words.
pub const RAI_STATUS_WORD: rai_status_t = 51;
/// The library was built without this key or word.
pub const RAI_STATUS_NOT_IN_BUILD: rai_status_t = 52;
/// The value must be a decimal number.
pub const RAI_STATUS_NUMBER: rai_status_t = 53;
/// Ionospheric coefficients must not all be zero.
pub const RAI_STATUS_ALL_ZERO: rai_status_t = 54;
/// The probability must be in the committed tables; the answer names the nearest.
pub const RAI_STATUS_PROBABILITY: rai_status_t = 55;

fn text(status: rai_status_t) -> &'static CStr {
    match status {
        RAI_STATUS_OK => c"done",
        RAI_STATUS_NULL => c"null pointer",
        RAI_STATUS_MISALIGNED => c"misaligned pointer",
        RAI_STATUS_SHORT => c"memory too short for the object",
        RAI_STATUS_NOT_INITIALISED => c"object not initialised",
        RAI_STATUS_SIZE => c"unknown size at the start of a struct",
        RAI_STATUS_TIME => c"time not finite",
        RAI_STATUS_COUNT => c"count out of bounds",
        RAI_STATUS_TEXT => c"text too long, or with a character that no command has",
        RAI_STATUS_PHASE => c"unknown phase",
        RAI_STATUS_HAL => c"horizontal alert limit outside (0, 1e6] m",
        RAI_STATUS_VAL => c"vertical alert limit outside (0, 1e6] m",
        RAI_STATUS_FALSE_ALARM => c"probability of false alarm not in the tables",
        RAI_STATUS_MISSED_DETECTION => c"probability of missed detection not in the tables",
        RAI_STATUS_POLICY => c"unknown policy",
        RAI_STATUS_METHOD => c"no such method in this library",
        RAI_STATUS_LEVELS => c"unknown kind of protection levels",
        RAI_STATUS_SETTING => c"setting out of its range",
        RAI_STATUS_SPEED => c"highest speed outside [0, 1e5] m/s",
        RAI_STATUS_HEIGHT => c"heights outside [-1.2e4, 1e8] m, or the least not below the greatest",
        RAI_STATUS_RECOVERY => c"recovery of no epoch, or outside [0, 3600] s",
        RAI_STATUS_SATELLITE => c"no such satellite",
        RAI_STATUS_RANGE => c"range not finite or out of bounds",
        RAI_STATUS_POSITION => c"satellite position not finite or out of bounds",
        RAI_STATUS_SIGMA => c"sigma not finite or out of bounds",
        RAI_STATUS_DUPLICATE => c"satellite appears twice",
        RAI_STATUS_FULL => c"more satellites than the library was built for",
        RAI_STATUS_KEY => c"unknown key",
        RAI_STATUS_VALUE_MISSING => c"missing value",
        RAI_STATUS_VALUE_EXTRA => c"extra value",
        RAI_STATUS_WORD => c"unknown value",
        RAI_STATUS_NOT_IN_BUILD => c"not in this build",
        RAI_STATUS_NUMBER => c"not a number",
        RAI_STATUS_ALL_ZERO => c"coefficients all zero",
        RAI_STATUS_PROBABILITY => c"probability not in the tables",
        _ => c"unknown status",
    }
}

/// Returns a status in lower-case words, a string that lives as long as the program.
#[unsafe(no_mangle)]
pub extern "C" fn rai_status_text(status: rai_status_t) -> *const c_char {
    text(status).as_ptr()
}

/// Returns the status of a core's refusal of one range.
pub(crate) fn of_refused_range(error: EpochError) -> rai_status_t {
    match error {
        EpochError::Range { .. } => RAI_STATUS_RANGE,
        EpochError::Position { .. } => RAI_STATUS_POSITION,
        EpochError::Sigma { .. } => RAI_STATUS_SIGMA,
        EpochError::Duplicate => RAI_STATUS_DUPLICATE,
        EpochError::Full => RAI_STATUS_FULL,
        _ => RAI_STATUS_SETTING,
    }
}

/// Returns the status of a module's refusal of a command.
#[cfg(feature = "receiver")]
pub(crate) fn of_refused_command(refusal: Refusal) -> rai_status_t {
    match refusal {
        // A call has no checksum, and its text has been measured.
        Refusal::Checksum | Refusal::TooLong => RAI_STATUS_TEXT,
        Refusal::UnknownKey => RAI_STATUS_KEY,
        Refusal::MissingValue => RAI_STATUS_VALUE_MISSING,
        Refusal::ExtraValue => RAI_STATUS_VALUE_EXTRA,
        Refusal::UnknownValue => RAI_STATUS_WORD,
        Refusal::NotInBuild => RAI_STATUS_NOT_IN_BUILD,
        Refusal::NotANumber => RAI_STATUS_NUMBER,
        Refusal::AllZero => RAI_STATUS_ALL_ZERO,
        Refusal::NotInTables { .. } => RAI_STATUS_PROBABILITY,
        // Out of range, or for a reason that has no number here yet.
        _ => RAI_STATUS_SETTING,
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn every_status_has_words_of_its_own() {
        let words: BTreeSet<_> = (0..=u8::MAX).map(text).collect();
        let want = include_str!("status.rs").matches("\npub const RAI_STATUS_").count();
        // One more for an unknown status.
        assert_eq!(words.len(), want + 1);
    }
}
