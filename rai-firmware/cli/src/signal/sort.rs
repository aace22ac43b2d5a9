//! What a file holds, by its content: so that nobody has to say it of a file that is dropped on a page.
//!
//! | file | recognised by |
//! |---|---|
//! | capture | frames of UBX, SBF or RTCM 3 among its first 64 KiB |
//! | observations, navigation | the first line of RINEX, plain or packed |
//! | positions | lines of NMEA, a solution of RTKLIB, or a table with `week` and `tow` |
//!
//! What is none of these is unknown, and its reader says why.

use std::path::Path;

use super::capture::{Bytes, has_frames};
use super::recording;

/// Kind of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Bytes of a receiver.
    Capture,
    /// RINEX observations.
    Observations,
    /// RINEX ephemerides.
    Navigation,
    /// Positions over time.
    Positions,
    /// None of the others.
    Unknown,
}

/// Returns the kind of a file; an unreadable one is unknown.
pub fn kind_of(path: &Path) -> Kind {
    if let Some(is_navigation) = recording::is_navigation(path) {
        return if is_navigation { Kind::Navigation } else { Kind::Observations };
    }
    let name = path.display().to_string();
    let Ok(bytes) = Bytes::open(&name, f64::INFINITY) else { return Kind::Unknown };
    match bytes.head() {
        head if has_frames(head) => Kind::Capture,
        head if is_positions(head) => Kind::Positions,
        _ => Kind::Unknown,
    }
}

/// Returns true for the first lines of a file with positions over time.
fn is_positions(head: &[u8]) -> bool {
    let text = String::from_utf8_lossy(head);
    let is_row = |line: &str| {
        let is_sentence = line.starts_with('$') && line.get(3..7).is_some_and(|name| name == "GGA,");
        let names = || line.split(',').map(|name| name.trim().to_lowercase()).collect::<Vec<_>>();
        let is_heading = || ["week", "tow"].iter().all(|wanted| names().iter().any(|name| name == wanted));
        let is_solution = line.starts_with('%') && line.contains("GPST") | line.contains("UTC");
        is_sentence || is_solution || is_heading()
    };
    text.trim_start_matches('\u{feff}').lines().take(200).any(is_row)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_told_apart_by_their_content() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        let kind = |content: &[u8]| {
            std::fs::write(&path, content).unwrap();
            kind_of(&path)
        };
        let rinex = |letter: char| {
            format!(
                "{:9}{:11}{letter:<20}{:20}RINEX VERSION / TYPE\n{:60}END OF HEADER\n",
                "     3.04", "", "M", ""
            )
        };
        assert_eq!(kind(rinex('O').as_bytes()), Kind::Observations);
        assert_eq!(kind(rinex('N').as_bytes()), Kind::Navigation);
        // UBX-MON-VER, as its standard prints the poll.
        assert_eq!(kind(&[0xB5, 0x62, 0x0A, 0x04, 0x00, 0x00, 0x0E, 0x34].repeat(3)), Kind::Capture);
        assert_eq!(
            kind(b"$GNGGA,120000.00,4703.6,N,00121.0,W,1,12,0.6,37.5,M,47.4,M,,*00\r\n"),
            Kind::Positions
        );
        assert_eq!(kind(b"week,tow,x_m,y_m,z_m\n"), Kind::Positions);
        assert_eq!(kind(b"%  GPST  latitude(deg) longitude(deg)\n"), Kind::Positions);
        for unknown in [&b""[..], b"\xFF\xD8\xFF\xE0\0\x10JFIF", b"\x1f\x8b\x08", b"words"] {
            assert_eq!(kind(unknown), Kind::Unknown);
        }
        assert_eq!(kind_of(&folder.path().join("none")), Kind::Unknown);
    }
}
