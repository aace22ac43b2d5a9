//! Files and logs that are no capture, by their first bytes.
//!
//! | log | mark |
//! |---|---|
//! | NovAtel | binary `AA 44 12` and a header of 28 bytes, or `AA 44 13`; text `#RANGEA,` and others |
//! | Unicore | binary `AA 44 B5`; text `#OBSVMA,` and others |
//! | Javad, Topcon (GREIS) | two characters and three hexadecimal digits of the length: `~~005`, or the file's `JP055RLOGF` |
//! | Trimble | `02`, status, `57`, `55` or `40`, length, that many bytes, their sum, `03` |
//! | Quectel | lines `$PQTM`, `$PAIR` |
//! | RTCM 2 | bytes from 40 to 7F that contain the preamble of 8 bits, six bits in each byte |

/// A native log: its name and the remedy.
struct Native {
    name: &'static str,
    has: fn(&[u8]) -> bool,
    remedy: &'static str,
}

const NATIVE: [Native; 6] = [
    Native {
        name: "a log of a NovAtel receiver",
        has: is_novatel,
        remedy: "LOG RTCM1077 ONTIME 1, RTCM1097, RTCM1127, and RTCM1019, RTCM1046, RTCM1042",
    },
    Native {
        name: "a log of a Unicore receiver",
        has: is_unicore,
        remedy: "RTCM1077 COM1 1, RTCM1097, RTCM1127, and RTCM1019, RTCM1046, RTCM1042",
    },
    Native {
        name: "a log of a Javad or Topcon receiver (GREIS)",
        has: is_greis,
        remedy: "messages /msg/rtcm3/1077, 1097, 1127, and 1019, 1046, 1042",
    },
    Native {
        name: "a log of a Trimble receiver (RT17, RT27 or GSOF)",
        has: is_trimble,
        remedy: "RTCM 3 with MSM4 to MSM7 and 1019, 1046, 1042",
    },
    Native {
        name: "lines of a Quectel receiver",
        has: is_quectel,
        remedy: "RTCM 3 with MSM4 to MSM7 and 1019, 1046, 1042",
    },
    Native {
        name: "RTCM 2",
        has: is_rtcm_2,
        remedy: "RTCM 3 with MSM4 to MSM7 and 1019, 1046, 1042: version 2 has corrections and no orbits",
    },
];

/// Returns the name of the native log among some bytes, which is not read, with what to send in its
/// place.
pub(super) fn native(bytes: &[u8]) -> Option<String> {
    let native = NATIVE.iter().find(|native| (native.has)(bytes))?;
    Some(format!("{}, which is not read; let the receiver send {}", native.name, native.remedy))
}

/// Returns true if a text has a line that begins with one of these words.
fn has_line(bytes: &[u8], words: &[&str]) -> bool {
    bytes.split(|byte| *byte == b'\n').any(|line| words.iter().any(|word| line.starts_with(word.as_bytes())))
}

fn is_novatel(bytes: &[u8]) -> bool {
    const LINES: [&str; 9] = [
        "#RANGEA,",
        "#RANGECMPA,",
        "#RANGECMP4A,",
        "#RAWEPHEMA,",
        "#GPSEPHEMA,",
        "#BESTPOSA,",
        "#BESTGNSSPOSA,",
        "#VERSIONA,",
        "%RAWIMUSA,",
    ];
    let is_header = |four: &[u8]| matches!(four, [0xAA, 0x44, 0x12, 28] | [0xAA, 0x44, 0x13, _]);
    bytes.windows(4).any(is_header) || has_line(bytes, &LINES)
}

fn is_unicore(bytes: &[u8]) -> bool {
    const LINES: [&str; 6] =
        ["#OBSVMA,", "#OBSVMCMPA,", "#OBSVHA,", "#BESTNAVA,", "#UNIHEADINGA,", "$command,"];
    bytes.windows(3).any(|three| three == [0xAA, 0x44, 0xB5]) || has_line(bytes, &LINES)
}

fn is_greis(bytes: &[u8]) -> bool {
    // The time of the receiver has five bytes, and ends each epoch's messages.
    let has = |mark: &[u8]| bytes.windows(mark.len()).any(|window| window == mark);
    has(b"RLOGF JPS") || bytes.starts_with(b"JP055RLOGF") || has(b"~~005") || has(b"::005") && has(b"[rc]")
}

fn is_trimble(bytes: &[u8]) -> bool {
    let is_packet = |from: &[u8]| match from {
        [0x02, _, 0x57 | 0x55 | 0x40, length, rest @ ..] => {
            let length = usize::from(*length);
            let sum = |bytes: &[u8]| bytes.iter().fold(0_u8, |sum, byte| sum.wrapping_add(*byte));
            let head = sum(&from[1..4]);
            let body = rest.get(..length).map(sum);
            body.is_some_and(|body| rest.get(length..length + 2) == Some(&[head.wrapping_add(body), 0x03]))
        }
        _ => false,
    };
    (0..bytes.len()).any(|at| bytes.get(at..).is_some_and(is_packet))
}

fn is_quectel(bytes: &[u8]) -> bool {
    has_line(bytes, &["$PQTM", "$PAIR"])
}

/// The bytes of RTCM 2 carry six bits each, the first one lowest, of words as GPS sends them; each
/// message begins with the preamble 01100110, inverted if the bit before its word is 1.
fn is_rtcm_2(bytes: &[u8]) -> bool {
    const PREAMBLE: u8 = 0b0110_0110;
    let is_data = |byte: &u8| (0x40..0x80).contains(byte);
    let lines = bytes.iter().filter(|byte| matches!(**byte, b'\r' | b'\n')).count();
    if bytes.len() < 60 || bytes.iter().filter(|byte| is_data(byte)).count() + lines < bytes.len() {
        return false;
    }
    let bits =
        bytes.iter().filter(|byte| is_data(byte)).flat_map(|byte| (0..6).map(move |bit| byte >> bit & 1));
    let mut eight = 0_u8;
    bits.enumerate().any(|(count, bit)| {
        eight = eight << 1 | bit;
        count >= 7 && (eight == PREAMBLE || eight == !PREAMBLE)
    })
}

/// What to give instead of a file in which there is nothing to read.
pub(super) const GIVE: &str =
    "give what a receiver sent (UBX, SBF or RTCM 3), or RINEX observations with their navigation file";

/// Returns the kind of a file that is not a capture, from its first bytes, and what to do with it or
/// instead.
pub(super) fn foreign(bytes: &[u8]) -> String {
    let start = bytes.get(..bytes.len().min(4096)).unwrap_or_default();
    let text = String::from_utf8_lossy(start);
    let line = text.lines().next().unwrap_or("");
    let is = |magic: &[u8]| start.starts_with(magic);
    let is_text = !text.chars().any(|letter| letter.is_control() && !"\t\r\n".contains(letter));
    if line.contains("RINEX VERSION") || line.contains("CRINEX VERS") {
        let kind = match (line.contains("CRINEX"), line.get(20..21)) {
            (true, _) | (_, Some("O")) => {
                "a RINEX observation file: give it with --obs, and a navigation file with --nav"
            }
            _ => "a RINEX navigation file: give it with --nav, beside a capture or observations",
        };
        return kind.to_owned();
    }
    let kind = match () {
        () if is(b"\x89PNG") || is(b"\xff\xd8\xff") || is(b"GIF8") || is(b"BM") => "a picture",
        () if is(b"%PDF") => "a PDF",
        () if is(b"\x7fELF") => "a program",
        () if is(b"<") => "a page or XML",
        () if is(b"{") || is(b"[") => "JSON",
        () if text.contains("$PRAI") => return "what a module said: monitor --file shows it".to_owned(),
        () => match native(start) {
            Some(native) => return native,
            None if is_text => "text",
            None => "nothing that is known",
        },
    };
    format!("{kind}: {GIVE}")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bytes as the makers' documents and the readers of RTKLIB have them.
    #[test]
    fn native_logs_are_named() {
        let trimble = |kind: u8| {
            let mut bytes = vec![0x02, 0x28, kind, 3, 1, 2, 3];
            bytes.push(bytes[1..].iter().sum());
            [&bytes[..], &[0x03]].concat()
        };
        // Words of RTCM 2 with the preamble, type 1 and station 0, six bits in a byte.
        let word = 0b01_1001_1000_0001_0000_0000_0000_0000_u32;
        let rolled = (0..5).map(|byte| {
            let six = word >> (24 - 6 * byte) & 0x3F;
            0x40 | (0..6).fold(0_u8, |bits, bit| bits | ((six >> (5 - bit) & 1) as u8) << bit)
        });
        let rtcm_2: Vec<u8> = rolled.cycle().take(90).collect();
        for (bytes, want) in [
            (vec![9, 0xAA, 0x44, 0x12, 28, 43, 0, 0, 0x20], Some("NovAtel")),
            (b"#BESTPOSA,COM1,0,90.5,FINESTEERING,2209,1,0;".to_vec(), Some("NovAtel")),
            (vec![0xAA, 0x44, 0xB5, 30, 12, 0], Some("Unicore")),
            (b"\r\n#OBSVMA,97,GPS,FINE,2190".to_vec(), Some("Unicore")),
            (b"JP055RLOGF JPS ALPHA Receiver Log File".to_vec(), Some("Javad")),
            (b"xx~~005\x01\x02\x03\x04\x05".to_vec(), Some("Javad")),
            (trimble(0x57), Some("Trimble")),
            (trimble(0x40), Some("Trimble")),
            (b"$PQTMVERNO,LG290P03*00\r\n".to_vec(), Some("Quectel")),
            (rtcm_2, Some("RTCM 2")),
            (trimble(0x33), None),
            (b"plain words of a letter to nobody".repeat(9), None),
            (vec![0; 4096], None),
        ] {
            let have = native(&bytes);
            let is_as_wanted = match (&have, want) {
                (Some(have), Some(want)) => have.contains(want) && have.contains("which is not read"),
                (None, None) => true,
                _ => false,
            };
            assert!(is_as_wanted, "{bytes:?}: {have:?}, not {want:?}");
        }
    }
}
