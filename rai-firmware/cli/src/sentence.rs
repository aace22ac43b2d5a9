//! The module's sentences, parsed as a program behind the host port would: for a module behind a wire,
//! and for tests of what it sends. A program with the module in process reads
//! [`crate::verdict`] instead.
//!
//! | sentence | becomes |
//! |---|---|
//! | `GNS`, `GGA` | [`Sentence::Position`]: a position, or none |
//! | `PRAIS` | [`Sentence::State`]: verdict, test, protection levels |
//! | `PRAIX` | [`Sentence::Excluded`]: one satellite left out |
//! | `PRAIO` | [`Sentence::Authentication`]: what is known of Galileo's ephemerides |
//! | others | [`Sentence::Other`] |
//!
//! [`epochs`] combines them again: an epoch begins with what is known of its ephemerides, if there is a
//! key, and its position. A module that says both `GNS`
//! and `GGA` says the same in them; the small one has `GGA` alone.

use anyhow::{Context, bail, ensure};
use raim_core::frame::Geodetic;

use crate::signal::fault::satellite;
use crate::verdict::{Authentication, EpochOutput, Excluded, State};

/// One sentence.
#[derive(Clone, Debug, PartialEq)]
pub enum Sentence {
    /// `GNS` or `GGA`: the position, `None` without a fix.
    Position(Option<Geodetic>),
    /// `PRAIS`.
    State(State),
    /// `PRAIX`.
    Excluded(Excluded),
    /// `PRAIO`.
    Authentication(Authentication),
    /// A valid sentence of another kind.
    Other,
}

/// Returns the command `$PRAIC,{text}` with its checksum and line end, for instance for
/// `PHASE,NPA`.
pub fn command(text: &str) -> String {
    let body = format!("PRAIC,{text}");
    let checksum = body.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${body}*{checksum:02X}\r\n")
}

/// Begin of a `MAVLink` 2 frame, which is no character of a sentence.
pub const FRAME_BEGIN: u8 = 0xFD;

/// Bytes of a `MAVLink` 2 frame around its payload: ten before it, two of checksum behind it.
pub const FRAME_AROUND: usize = 12;

/// Returns the sentences of the host port, without the `MAVLink` frames between them.
///
/// # Errors
/// Fails if the rest is not UTF-8, or if a frame is cut off.
pub fn sentences(reported: &[u8]) -> anyhow::Result<String> {
    const NEITHER: &str = "the module sent bytes that are neither text nor a MAVLink frame";
    // The usual case, in a fraction of the time.
    if !reported.contains(&FRAME_BEGIN) {
        return String::from_utf8(reported.to_vec()).context(NEITHER);
    }
    let (mut text, mut rest) = (Vec::new(), reported);
    while let Some(begin) = rest.iter().position(|&byte| byte == FRAME_BEGIN) {
        text.extend_from_slice(&rest[..begin]);
        let payload = rest.get(begin + 1).copied().context("a MAVLink frame is cut off")?;
        let end = begin + FRAME_AROUND + usize::from(payload);
        rest = rest.get(end..).context("a MAVLink frame is cut off")?;
    }
    text.extend_from_slice(rest);
    String::from_utf8(text).context(NEITHER)
}

/// Parses one sentence and checks its checksum.
///
/// # Errors
/// If it is not a valid sentence; the error says why.
pub fn parse(line: &str) -> anyhow::Result<Sentence> {
    let line = line.trim_end();
    let (body, checksum) = line
        .strip_prefix('$')
        .and_then(|line| line.rsplit_once('*'))
        .with_context(|| format!("not a sentence: {line:?}"))?;
    let have = body.bytes().fold(0u8, |sum, byte| sum ^ byte);
    ensure!(u8::from_str_radix(checksum, 16) == Ok(have), "wrong checksum: {line:?}");
    let fields = || {
        // As many as the longest sentence that is read, so that the list does not grow.
        let mut fields: Vec<&str> = Vec::with_capacity(16);
        fields.extend(body.split(','));
        fields
    };
    let read = match body.split(',').next() {
        Some("GNGNS") => position(&fields(), [9, 10]).map(Sentence::Position),
        Some("GNGGA") => position(&fields(), [9, 11]).map(Sentence::Position),
        Some("PRAIS") => state(&fields()).map(Sentence::State),
        Some("PRAIX") => excluded(&fields()).map(Sentence::Excluded),
        Some("PRAIO") => authentication(&fields()).map(Sentence::Authentication),
        _ => Ok(Sentence::Other),
    };
    read.with_context(|| format!("in {line:?}"))
}

/// Combines the sentences of a stream, epoch by epoch.
///
/// # Errors
/// If a line is not a sentence; the error shows the first one.
pub fn epochs(text: &str) -> anyhow::Result<Vec<EpochOutput>> {
    let mut epochs: Vec<EpochOutput> = Vec::new();
    let (mut position, mut authentication) = (None, None);
    for line in text.lines() {
        match parse(line)? {
            Sentence::Authentication(found) => authentication = Some(found),
            Sentence::Position(found) => position = found,
            Sentence::State(state) => {
                let (position, authentication) = (position.take(), authentication.take());
                epochs.push(EpochOutput { position, state, excluded: Vec::new(), authentication });
            }
            Sentence::Excluded(satellite) => {
                epochs.last_mut().context("PRAIX before PRAIS")?.excluded.push(satellite);
            }
            Sentence::Other => {}
        }
    }
    Ok(epochs)
}

/// Parses a field that may be empty.
fn optional<T: std::str::FromStr>(fields: &[&str], index: usize) -> anyhow::Result<Option<T>> {
    match fields.get(index) {
        None => bail!("field {index} is missing"),
        Some(&"") => Ok(None),
        Some(text) => match text.parse() {
            Ok(value) => Ok(Some(value)),
            Err(_) => bail!("field {index}, {text:?}, is not a number"),
        },
    }
}

fn required<T: std::str::FromStr>(fields: &[&str], index: usize) -> anyhow::Result<T> {
    optional(fields, index)?.with_context(|| format!("field {index} is empty"))
}

fn text(fields: &[&str], index: usize) -> anyhow::Result<String> {
    fields.get(index).map(|&text| text.to_owned()).with_context(|| format!("field {index} is missing"))
}

/// Parses `hhmmss.ss` to seconds of the day, exact to their last digit.
fn time_of_day_s(fields: &[&str]) -> anyhow::Result<Option<f64>> {
    Ok(optional::<f64>(fields, 1)?.map(|clock| {
        let digits = (clock * 100.0).round() as u32;
        let (hours, minutes, centiseconds) = (digits / 1_000_000, digits / 10_000 % 100, digits % 10_000);
        f64::from(hours * 360_000 + minutes * 6000 + centiseconds) / 100.0
    }))
}

/// Parses degrees and minutes written together, with a hemisphere, to radians.
fn angle_rad(fields: &[&str], index: usize, negative: &str) -> anyhow::Result<Option<f64>> {
    let Some(value) = optional::<f64>(fields, index)? else { return Ok(None) };
    let degrees = (value / 100.0).floor();
    let angle_deg = degrees + (value - degrees * 100.0) / 60.0;
    let sign = if text(fields, index + 1)? == negative { -1.0 } else { 1.0 };
    Ok(Some(sign * angle_deg.to_radians()))
}

/// Parses a position. The indices are of the fields of its altitude and separation of the geoid.
fn position(fields: &[&str], heights: [usize; 2]) -> anyhow::Result<Option<Geodetic>> {
    let (latitude, longitude) = (angle_rad(fields, 2, "S")?, angle_rad(fields, 4, "W")?);
    let [altitude, separation] = heights.map(|index| optional::<f64>(fields, index));
    let (altitude, separation) = (altitude?, separation?);
    let (Some(latitude_rad), Some(longitude_rad), Some(altitude)) = (latitude, longitude, altitude) else {
        return Ok(None);
    };
    Ok(Some(Geodetic { latitude_rad, longitude_rad, height_m: altitude + separation.unwrap_or(0.0) }))
}

fn state(fields: &[&str]) -> anyhow::Result<State> {
    let state = text(fields, 2)?;
    let reason = text(fields, 3)?;
    ensure!(matches!(state.as_str(), "P" | "A" | "U"), "state {state:?} must be P, A or U");
    Ok(State {
        time_s: time_of_day_s(fields)?,
        state: state.chars().next().unwrap_or('U'),
        reason,
        tracked: required(fields, 4)?,
        used: required(fields, 5)?,
        dof: optional(fields, 6)?,
        statistic: optional(fields, 7)?,
        threshold: optional(fields, 8)?,
        hpl_m: optional(fields, 9)?,
        vpl_m: optional(fields, 10)?,
        hal_m: optional(fields, 11)?,
        val_m: optional(fields, 12)?,
    })
}

fn excluded(fields: &[&str]) -> anyhow::Result<Excluded> {
    let name = text(fields, 3)?;
    Ok(Excluded {
        satellite: satellite(&name).with_context(|| format!("{name:?} is not a satellite"))?,
        w_test: required(fields, 4)?,
        bias_m: required(fields, 5)?,
    })
}

fn authentication(fields: &[&str]) -> anyhow::Result<Authentication> {
    Ok(Authentication {
        state: text(fields, 2)?,
        proved: required(fields, 5)?,
        unproved: required(fields, 6)?,
        wrong: required(fields, 7)?,
        oldest_proof_s: optional(fields, 8)?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::checksum::nmea_line;

    #[test]
    fn an_epoch_is_put_together_from_its_sentences() {
        let stream = [
            nmea_line("GNGNS,120000.50,5530.00000000,S,00829.00000000,W,A,20,0.70,53.100,0.5,,,S"),
            nmea_line("GNGST,120000.50,1.0,,,,1.0,1.0,2.0"),
            nmea_line("PRAIS,120000.50,P,EXCLUDED,21,20,15,0.912,1.764,12.3,,556.0,"),
            nmea_line("PRAIX,120000.50,1,G05,-23.400,81.2"),
        ]
        .concat();
        let have = epochs(&stream).unwrap();
        assert_eq!(have.len(), 1);
        let position = have[0].position.unwrap();
        assert!((position.latitude_rad.to_degrees() + 55.5).abs() < 1e-12);
        assert!((position.longitude_rad.to_degrees() + 8.0 + 29.0 / 60.0).abs() < 1e-12);
        assert!((position.height_m - 53.6).abs() < 1e-9);
        let state = &have[0].state;
        assert_eq!((state.time_s, state.state, state.reason.as_str()), (Some(43_200.5), 'P', "EXCLUDED"));
        assert_eq!((state.hpl_m, state.vpl_m, state.val_m), (Some(12.3), None, None));
        assert_eq!(have[0].excluded[0].satellite.to_string(), "G05");
        assert!((have[0].excluded[0].bias_m - 81.2).abs() < 1e-12);
    }

    #[test]
    fn what_is_known_of_ephemerides_is_of_the_epoch_behind_it() {
        let stream = [
            nmea_line("PRAIO,120000.00,DATED,1,0,6,2,1,31,5.0,12.3"),
            nmea_line("PRAIS,120000.00,U,NOFIX,9,0,,,,,,556.0,"),
            nmea_line("PRAIS,120001.00,A,STALE,0,0,,,,,,556.0,"),
            nmea_line("PRAIO,120002.00,WAIT,,,0,8,0,,,"),
            nmea_line("PRAIS,120002.00,U,NOFIX,8,0,,,,,,556.0,"),
        ]
        .concat();
        let of = |state: &str, [proved, unproved, wrong]: [u32; 3], oldest_proof_s| {
            Some(Authentication { state: state.to_owned(), proved, unproved, wrong, oldest_proof_s })
        };
        let have = epochs(&stream).unwrap().into_iter().map(|epoch| epoch.authentication);
        let want = [of("DATED", [6, 2, 1], Some(31)), None, of("WAIT", [0, 8, 0], None)];
        assert_eq!(have.collect::<Vec<_>>(), want);
    }

    #[test]
    fn a_position_is_read_from_gga_too() {
        // The example that descriptions of NMEA 0183 give: 545.4 m above the sea, geoid 46.9 m.
        let line = nmea_line("GNGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,");
        let Ok(Sentence::Position(Some(position))) = parse(line.trim_end()) else { panic!("{line}") };
        assert!((position.latitude_rad.to_degrees() - (48.0 + 7.038 / 60.0)).abs() < 1e-12);
        assert!((position.longitude_rad.to_degrees() - (11.0 + 31.0 / 60.0)).abs() < 1e-12);
        assert!((position.height_m - 592.3).abs() < 1e-9);
        let without = nmea_line("GNGGA,123519,,,,,0,00,,,M,,M,,");
        assert_eq!(parse(without.trim_end()).unwrap(), Sentence::Position(None));
    }

    #[test]
    fn a_damaged_sentence_is_an_error() {
        assert!(parse("$PRAIS,1*00").unwrap_err().to_string().contains("checksum"));
        assert!(parse("PRAIS").is_err());
    }
}
