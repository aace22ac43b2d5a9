//! Invariants of every output of the module.
//!
//! - Printable ASCII only, lines of at most 82 characters, each with its checksum, no NaN and no
//!   infinity.
//! - A protected epoch has a position, a passed test, and protection levels within the alert
//!   limits.
//! - The integrity pin agrees with the last epoch.

use raim::sentence;
use raim::verdict::EpochOutput;
use raim_firmware::output::nmea::MAX_LENGTH;

/// Rounding of `PRAIS`, m: half of its last digit for the level and for the limit, in the coarse
/// form.
const ROUNDED_M: f64 = 1.0;

/// Checks all invariants of an output; returns its epochs.
pub fn check(reported: &[u8]) -> Vec<EpochOutput> {
    let text = std::str::from_utf8(reported).expect("sentences are ASCII");
    for line in text.split_inclusive('\n') {
        check_line(line);
    }
    let outputs = sentence::epochs(text).expect("sentences can be read");
    outputs.iter().for_each(check_epoch);
    outputs
}

fn check_line(line: &str) {
    let body = line.strip_suffix("\r\n").unwrap_or_else(|| panic!("unfinished line {line:?}"));
    assert!(line.len() <= MAX_LENGTH, "{} characters: {line:?}", line.len());
    assert!(body.bytes().all(|byte| matches!(byte, b' '..=b'~')), "unprintable: {line:?}");
    // A refusal repeats the key as received, which may be anything. A hash may look like a number
    // of any size.
    let is_none = |field: &str| field.parse::<f64>().is_ok_and(|number| !number.is_finite());
    let is_hashed = body.starts_with("$PRAIN") || body.starts_with("$PRAIQ");
    let own = if body.contains(",ERR,") || is_hashed { "" } else { body };
    assert!(!own.split([',', '*']).any(is_none), "a number that is none: {line:?}");
}

fn check_epoch(output: &EpochOutput) {
    let state = &output.state;
    let listed = output.excluded.len();
    assert!(state.used as usize + listed <= state.tracked as usize, "more used than tracked: {output:?}");
    if !state.is_protected() {
        return;
    }
    assert_eq!(["EXCLUDED", "COVERED"].contains(&&*state.reason), listed > 0, "{output:?}");
    let position = output.position.unwrap_or_else(|| panic!("protected without a position: {output:?}"));
    let (latitude_deg, longitude_deg) =
        (position.latitude_rad.to_degrees(), position.longitude_rad.to_degrees());
    assert!(latitude_deg.abs() <= 90.01 && longitude_deg.abs() <= 180.01, "nowhere on earth: {output:?}");
    assert!(state.dof.is_some_and(|dof| dof > 0), "protected without redundancy: {output:?}");
    assert!(state.statistic.zip(state.threshold).is_some_and(|(have, limit)| have <= limit), "{output:?}");
    assert!(is_within(state.hpl_m, state.hal_m), "HPL beyond its limit: {output:?}");
    assert!(state.val_m.is_none() || is_within(state.vpl_m, state.val_m), "VPL beyond its limit: {output:?}");
}

/// Returns true if a level is within its limit. A missing level is not.
fn is_within(level_m: Option<f64>, limit_m: Option<f64>) -> bool {
    level_m.zip(limit_m).is_some_and(|(level_m, limit_m)| level_m <= limit_m + ROUNDED_M)
}

#[cfg(test)]
mod tests {
    use super::check;

    /// Returns the sentences of an epoch.
    fn reported(state: &str) -> Vec<u8> {
        let bodies = ["GNGNS,120000.00,3410.2,N,10834.2,E,A,09,1.00,400.0,0.0,,,S", state];
        let sealed =
            |body: &&str| format!("${body}*{:02X}\r\n", body.bytes().fold(0_u8, |sum, byte| sum ^ byte));
        bodies.iter().map(sealed).collect::<String>().into_bytes()
    }

    #[test]
    fn a_sound_epoch_passes() {
        assert_eq!(check(&reported("PRAIS,120000.00,P,OK,10,9,5,0.912,1.764,12.3,,556.0,")).len(), 1);
    }

    #[test]
    #[should_panic(expected = "HPL beyond its limit")]
    fn a_promise_without_a_level_is_noticed() {
        check(&reported("PRAIS,120000.00,P,OK,10,9,5,0.912,1.764,,,556.0,"));
    }

    #[test]
    #[should_panic(expected = "HPL beyond its limit")]
    fn a_level_beyond_its_limit_is_noticed() {
        check(&reported("PRAIS,120000.00,P,OK,10,9,5,0.912,1.764,600.0,,556.0,"));
    }

    #[test]
    #[should_panic(expected = "a number that is none")]
    fn an_infinite_number_is_noticed() {
        check(&reported("PRAIS,120000.00,U,HPL,10,9,5,0.912,1.764,inf,,556.0,"));
    }

    #[test]
    #[should_panic(expected = "more used than tracked")]
    fn a_satellite_from_nowhere_is_noticed() {
        check(&reported("PRAIS,120000.00,U,HPL,8,9,5,0.912,1.764,600.0,,556.0,"));
    }
}
