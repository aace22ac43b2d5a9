//! The evidence for every message that the module reads, from outside this project.
//!
//! A format rule that only the project's own encoder confirms is unconfirmed: encoder and reader
//! can share a mistake. Evidence is a recorded device, or another program that checks the rule in
//! question. RTKLIB reads elements and never checks the parity of GPS words, so it is no evidence
//! for that parity.
//!
//! [`ROWS`] is compared with the messages that the module reads, found by probing, with the flags
//! in the documentation of `ephemeris/health.rs`, and with the list of unconfirmed rows in
//! INTERFACES.md.

use std::collections::{BTreeMap, BTreeSet};
use std::io::Read as _;
use std::path::Path;

use flate2::read::GzDecoder;
use raim::signal::checksum::crc24q;
use raim::signal::encode::{sbf, ubx};
use raim::signal::pieces::{Kind, pieces};
use raim_firmware::input::{Counters, Event, Input};
use raim_firmware::osnma::Authentication;
use raim_firmware::time::GpsTime;
use rig::shared;

/// A rule of a wire format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Rule {
    /// A message of RTCM 3, by its number.
    Rtcm(u16),
    /// A message of UBX, by class and number.
    Ubx(u8, u8),
    /// A block of SBF, by its number.
    Sbf(u16),
    /// Navigation bits in RXM-SFRBX, by system and signal in the numbers of UBX.
    Bits(u8, u8),
    /// A flag of health; the text is the first cell of its row in `ephemeris/health.rs`.
    Flag(&'static str),
    /// Another field that changes a verdict.
    Field(&'static str),
    /// What a counter of OSNMA counts, without `_right`.
    Osnma(&'static str),
    /// A sequence of OSNMA's tags, by its number in `osnma/table.rs`.
    Sequence(u8),
}

use Rule::{Bits, Field, Flag, Osnma, Rtcm, Sbf, Sequence, Ubx};

/// The evidence for a rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Evidence {
    /// A device sent it; the capture lies below `data` of the reference folder.
    Recorded(&'static str),
    /// Another program checks it, as named.
    Program(&'static str),
    /// Nothing outside this project.
    Unconfirmed,
}

use Evidence::{Program, Recorded, Unconfirmed};

/// A ZED-F9R at rest, its own RTCM and UBX.
const F9R: &str = "real/f9r_rtcm_ubx.log.gz";
/// A Japanese station of 2012.
const GMSD7: &str = "real/gmsd7_2012.rtcm3.gz";
/// Navigation bits of a ZED-F9P.
const F9P: &str = "real/f9p_sfrbx.ubx";
/// A mosaic, with all its blocks.
const MOSAIC: &str = "sbf/mosaic_12s.sbf.gz";
/// Ranges and bits of an X20P on foot.
const X20P: &str = "real/x20p_walk.ubx.gz";
/// Frames of L2C and L5 of a Septentrio, without their blocks; `cnav::recorded` puts them into
/// blocks of `pysbf2`'s layout.
const SEPTENTRIO: Evidence = Program("frames of a Septentrio receiver; layout pysbf2");
/// Fields at the places of GNSS-SDR and of an independent reader; `cnav::recorded` compares them.
const GNSS_SDR: Evidence = Program("GNSS-SDR");
/// Streams of the same program as SBF; `sbf::streams` judges them as their UBX.
const SBF_STREAMS: Evidence = Program("independent SBF writer, read back by RTKLIB");
/// Streams that another program wrote and RTKLIB and `pyubx2` read back; `ubx::streams` compares
/// them.
const STREAMS: Evidence = Program("independent UBX writer, read back by RTKLIB and pyubx2");
/// `rtcm-rs` writes them from a table of its own.
const RTCM_RS: Evidence = Program("rtcm-rs");
/// `pyubx2` writes the messages from its own table; `ubx::own_reports` reads them.
const PYUBX2: Evidence = Program("pyubx2");
/// RTKLIB's `convbin` gives the same values for the same bits; `ubx::rtklib` compares them.
const RTKLIB: Evidence = Program("RTKLIB");
/// It agrees page by page on a recording, on the official vectors and on the sky of a test key;
/// `osnma::second` compares them.
const GALILEO_OSNMA: Evidence = Program("galileo-osnma, page by page");
/// The official vectors of the service centre end as their names say; `osnma::at_length` runs them.
const VECTORS: Evidence = Program("official test vectors");
/// A script of the reference folder has the same table; `sequences_are_those_of_another_program`
/// compares them.
const SCRIPT: Evidence = Program("a script of the reference folder");
/// `osnma::recorded` has the tags that they prove.
const OLD_TOWN: &str = "osnma/old_town_inav.sbf.gz";

const ROWS: [(Rule, &str, Evidence); 144] = [
    (Rtcm(1005), "1005", Program("example frame of RTCM 10403.3, 4.2")),
    (Rtcm(1006), "1006", Recorded(F9R)),
    (Rtcm(1013), "1013", Program("pyrtcm")),
    (Rtcm(1019), "1019", Recorded(F9R)),
    (Rtcm(1020), "1020", Recorded(F9R)),
    (Rtcm(1042), "1042", Recorded(F9R)),
    (Rtcm(1044), "1044", Unconfirmed),
    (Rtcm(1045), "1045", Recorded(F9R)),
    (Rtcm(1046), "1046", Recorded(F9R)),
    (Rtcm(1074), "1074", Unconfirmed),
    (Rtcm(1075), "1075", Recorded(F9R)),
    (Rtcm(1076), "1076", Unconfirmed),
    (Rtcm(1077), "1077", Recorded(GMSD7)),
    (Rtcm(1084), "1084", Recorded("cases/glonass-day-7.rtcm3")),
    (Rtcm(1085), "1085", Recorded(F9R)),
    (Rtcm(1086), "1086", Unconfirmed),
    (Rtcm(1087), "1087", Recorded(GMSD7)),
    (Rtcm(1094), "1094", Unconfirmed),
    (Rtcm(1095), "1095", Recorded(F9R)),
    (Rtcm(1096), "1096", Unconfirmed),
    (Rtcm(1097), "1097", RTCM_RS),
    (Rtcm(1114), "1114", Unconfirmed),
    (Rtcm(1115), "1115", Unconfirmed),
    (Rtcm(1116), "1116", Unconfirmed),
    (Rtcm(1117), "1117", Recorded(GMSD7)),
    (Rtcm(1124), "1124", Unconfirmed),
    (Rtcm(1125), "1125", Recorded(F9R)),
    (Rtcm(1126), "1126", Unconfirmed),
    (Rtcm(1127), "1127", Recorded(GMSD7)),
    (Ubx(0x02, 0x15), "RXM-RAWX", STREAMS),
    (Ubx(0x02, 0x13), "RXM-SFRBX", Recorded(F9P)),
    (Ubx(0x27, 0x09), "SEC-SIG", PYUBX2),
    (Ubx(0x27, 0x10), "SEC-SIGLOG", PYUBX2),
    (Ubx(0x0A, 0x38), "MON-RF", Recorded(F9R)),
    (Ubx(0x01, 0x03), "NAV-STATUS", PYUBX2),
    (Ubx(0x01, 0x43), "NAV-SIG", Recorded(F9R)),
    (Ubx(0x01, 0x62), "NAV-PL", PYUBX2),
    (Sbf(4027), "SBF 4027", Recorded(MOSAIC)),
    (Sbf(4017), "SBF 4017", Recorded(MOSAIC)),
    (Sbf(4018), "SBF 4018", SEPTENTRIO),
    (Sbf(4019), "SBF 4019", SEPTENTRIO),
    (Sbf(4067), "SBF 4067", Unconfirmed),
    (Sbf(4068), "SBF 4068", Unconfirmed),
    (Sbf(4022), "SBF 4022", SBF_STREAMS),
    (Sbf(4023), "SBF 4023", Recorded(MOSAIC)),
    (Sbf(4026), "SBF 4026", Recorded(MOSAIC)),
    (Sbf(4047), "SBF 4047", Recorded(MOSAIC)),
    (Sbf(4066), "SBF 4066", SBF_STREAMS),
    (Sbf(5891), "SBF 5891", Recorded(MOSAIC)),
    (Sbf(4002), "SBF 4002", Recorded(MOSAIC)),
    (Sbf(4081), "SBF 4081", Recorded(MOSAIC)),
    (Sbf(4004), "SBF 4004", Recorded(MOSAIC)),
    (Sbf(5893), "SBF 5893", Recorded(MOSAIC)),
    (Sbf(4120), "SBF 4120", Recorded(MOSAIC)),
    (Sbf(5894), "SBF 5894", Recorded(MOSAIC)),
    (Sbf(4031), "SBF 4031", Recorded(MOSAIC)),
    (Sbf(4092), "SBF 4092", Recorded(MOSAIC)),
    (Sbf(4245), "SBF 4245", Recorded(MOSAIC)),
    (Sbf(4001), "SBF 4001", Recorded(MOSAIC)),
    (Sbf(4011), "SBF 4011", Unconfirmed),
    (Field("flags of RFStatus and GALAuthStatus"), "flags of RFStatus and GALAuthStatus", Unconfirmed),
    (Bits(0, 0), "GPS LNAV", Recorded(F9P)),
    (Bits(0, 3), "GPS CNAV under signal 3", Unconfirmed),
    (Bits(0, 4), "GPS CNAV of L2C", Recorded(X20P)),
    (Bits(0, 6), "GPS CNAV of L5", Recorded(X20P)),
    (Bits(0, 7), "GPS CNAV under signal 7", Unconfirmed),
    (Bits(2, 0), "Galileo I/NAV under signal 0", Unconfirmed),
    (Bits(2, 1), "Galileo I/NAV", Recorded(F9P)),
    (Bits(2, 3), "Galileo F/NAV", STREAMS),
    (Bits(2, 4), "Galileo F/NAV under signal 4", Unconfirmed),
    (Bits(2, 5), "Galileo I/NAV under signal 5", Recorded(F9P)),
    (Bits(2, 6), "Galileo I/NAV under signal 6", Unconfirmed),
    (Bits(3, 0), "BeiDou D1 of B1I", Recorded(F9P)),
    (Bits(3, 1), "BeiDou D2 of B1I", RTKLIB),
    (Bits(3, 2), "BeiDou D1 of B2I", Unconfirmed),
    (Bits(3, 3), "BeiDou D2 of B2I", Unconfirmed),
    (Bits(3, 4), "BeiDou D1 of B3I", Unconfirmed),
    (Bits(3, 10), "BeiDou D2 of B3I", Unconfirmed),
    (Bits(5, 0), "QZSS LNAV", STREAMS),
    (Bits(5, 4), "QZSS CNAV under signal 4", Unconfirmed),
    (Bits(5, 5), "QZSS CNAV under signal 5", Unconfirmed),
    (Bits(5, 8), "QZSS CNAV under signal 8", Unconfirmed),
    (Bits(5, 9), "QZSS CNAV under signal 9", Unconfirmed),
    (Bits(6, 0), "GLONASS strings of L1", Recorded(F9P)),
    (Bits(6, 2), "GLONASS strings of L2", Recorded(F9P)),
    (Flag("GPS LNAV, 1019: SV health (6 bits) not 0"), "SV health of GPS", RTKLIB),
    (Flag("GPS LNAV: alert flag of a subframe 1 to 3"), "alert flag of LNAV", Unconfirmed),
    (Flag("GPS, QZSS, `BeiDou`: URA or URAI 15"), "URA, URAI", RTKLIB),
    (Flag("QZSS LNAV, 1044: health (6 bits, without the last) not 0"), "health of QZSS", STREAMS),
    (Flag("GPS, QZSS CNAV: alert flag of any frame"), "alert flag of CNAV", GNSS_SDR),
    (Flag("GPS, QZSS CNAV: L1, L2, L5 health of type 10 is 1"), "health of CNAV", Recorded(X20P)),
    (Flag("Galileo I/NAV, 1046: `E1B` or `E5b` HS not 0"), "HS of I/NAV", RTKLIB),
    (Flag("Galileo F/NAV, 1045: `E5a` HS not 0"), "HS of F/NAV", STREAMS),
    (Flag("Galileo I/NAV, F/NAV, 1045, 1046: DVS of any signal is 1"), "DVS", STREAMS),
    (Flag("Galileo I/NAV, 1046: SISA is NAPA (126 to 255)"), "SISA of I/NAV", RTKLIB),
    (Flag("Galileo F/NAV, 1045: SISA is NAPA (126 to 255)"), "SISA of F/NAV", STREAMS),
    (Flag("`BeiDou` D1, D2, 1042: `SatH1` is 1"), "SatH1", RTKLIB),
    (Flag("GLONASS strings, 1020: first bit of `B_n` or `l_n` is 1"), "l_n of GLONASS", Unconfirmed),
    (Flag("GLONASS strings, 1020: `F_T` is 15"), "F_T of GLONASS", RTKLIB),
    (Field("parity of GPS LNAV"), "parity of GPS LNAV", Recorded("cases/lnav-as-sent.ubx")),
    (Field("CRC of Galileo I/NAV"), "CRC of Galileo I/NAV", Recorded(F9P)),
    (Field("CRC of Galileo F/NAV"), "CRC of Galileo F/NAV", STREAMS),
    (Field("CRC of CNAV"), "CRC of CNAV", Recorded(X20P)),
    (Field("inter-signal corrections of CNAV"), "inter-signal corrections of CNAV", Recorded(X20P)),
    (Field("parity of BeiDou"), "parity of BeiDou", Recorded(F9P)),
    (Field("parity of GLONASS"), "parity of GLONASS", Recorded(F9P)),
    (Field("orbital elements"), "orbital elements", RTKLIB),
    (Field("group delays"), "group delays", RTKLIB),
    (Field("week of a message"), "week of a message", RTKLIB),
    (Field("time of an MSM"), "time of an MSM", Recorded(F9R)),
    (Field("DF416, day unknown"), "DF416, day unknown", Recorded("cases/glonass-day-7.rtcm3")),
    (Field("more-bit of an MSM"), "more-bit of an MSM", Recorded(F9R)),
    (Field("C/N0"), "C/N0", STREAMS),
    (Field("prValid of RXM-RAWX"), "prValid of RXM-RAWX", STREAMS),
    (Field("leap seconds of RXM-RAWX"), "leap seconds of RXM-RAWX", STREAMS),
    (Field("leap seconds in bits of GPS"), "leap seconds in bits of GPS", RTKLIB),
    (Field("leap seconds in bits of Galileo"), "leap seconds in bits of Galileo", STREAMS),
    (Field("ionosphere of GPS"), "ionosphere of GPS", RTKLIB),
    (Field("ionosphere of BeiDou"), "ionosphere of BeiDou", STREAMS),
    (Osnma("osnma_roots"), "OSNMA: root key, its padding and signature", GALILEO_OSNMA),
    (Osnma("osnma_keys"), "OSNMA: chain of keys", GALILEO_OSNMA),
    (Osnma("osnma_sequences"), "OSNMA: MACSEQ", GALILEO_OSNMA),
    (Osnma("osnma_orbits"), "OSNMA: tags of ADKD 0, cross-authentication, cut-off point", GALILEO_OSNMA),
    (Osnma("osnma_times"), "OSNMA: tags of ADKD 4", GALILEO_OSNMA),
    (Osnma("osnma_slow"), "OSNMA: tags of ADKD 12", GALILEO_OSNMA),
    (Osnma("osnma_renewals"), "OSNMA: new public key and alert by the tree of hashes", VECTORS),
    (Field("OSNMA: end of a chain"), "OSNMA: end of a chain", VECTORS),
    (Field("OSNMA: revocation of a chain"), "OSNMA: revocation of a chain", VECTORS),
    (Field("OSNMA: revocation of a key"), "OSNMA: revocation of a key", GALILEO_OSNMA),
    (Field("OSNMA: do not use"), "OSNMA: do not use", VECTORS),
    (Field("OSNMA: bits in RXM-SFRBX"), "OSNMA: bits in RXM-SFRBX", Recorded(X20P)),
    (Field("OSNMA: bits in SBF 4023"), "OSNMA: bits in SBF 4023", Recorded(OLD_TOWN)),
    (Sequence(27), "OSNMA: sequence 27", SCRIPT),
    (Sequence(28), "OSNMA: sequence 28", SCRIPT),
    (Sequence(31), "OSNMA: sequence 31", SCRIPT),
    (Sequence(33), "OSNMA: sequence 33", SCRIPT),
    (Sequence(34), "OSNMA: sequence 34", SCRIPT),
    (Sequence(35), "OSNMA: sequence 35", SCRIPT),
    (Sequence(36), "OSNMA: sequence 36", SCRIPT),
    (Sequence(37), "OSNMA: sequence 37", SCRIPT),
    (Sequence(38), "OSNMA: sequence 38", SCRIPT),
    (Sequence(39), "OSNMA: sequence 39", SCRIPT),
    (Sequence(40), "OSNMA: sequence 40", SCRIPT),
    (Sequence(41), "OSNMA: sequence 41", SCRIPT),
];

/// Returns the rules of a kind.
fn rules<T: Ord>(pick: impl Fn(Rule) -> Option<T>) -> BTreeSet<T> {
    ROWS.iter().filter_map(|(rule, ..)| pick(*rule)).collect()
}

/// Returns a frame of RTCM 3.
fn rtcm(number: u16) -> Vec<u8> {
    const LENGTH: usize = 200;
    let mut frame = vec![0xD3, 0, LENGTH as u8, (number >> 4) as u8, (number << 4) as u8];
    frame.resize(3 + LENGTH, 0);
    let crc = crc24q(&frame);
    frame.extend_from_slice(&crc);
    frame
}

/// Returns true when the module reads the message in a frame, well or ill.
fn is_read(frame: &[u8]) -> bool {
    let mut input = Input::new();
    input.feed(frame, 0, |_| ());
    let counters = input.counters();
    assert_eq!(counters.frames, 1, "{counters:?}");
    counters.messages_other + counters.observations_other + counters.subframes_other == 0
}

#[test]
fn every_message_that_is_read_has_a_row() {
    let read: BTreeSet<u16> = (0..4096).filter(|number| is_read(&rtcm(*number))).collect();
    assert_eq!(rules(|rule| if let Rtcm(number) = rule { Some(number) } else { None }), read);
    let kinds = (0..=255).flat_map(|class| (0..=255).map(move |number| (class, number)));
    let read: BTreeSet<(u8, u8)> =
        kinds.filter(|(class, number)| is_read(&ubx::frame([*class, *number], &[]))).collect();
    assert_eq!(rules(|rule| if let Ubx(class, number) = rule { Some((class, number)) } else { None }), read);
    let noon = GpsTime { week: 2111, tow_ms: 388_800_000 };
    // Blocks of navigation bits name the signal in their fourth byte.
    let is_read_from = |number, source| {
        let mut body = [0; 160];
        body[3] = source;
        is_read(&sbf::block(number, noon, &body))
    };
    let read: BTreeSet<u16> = (0..8192)
        .filter(|number| [0, 3, 4, 7, 17, 20, 26, 28].iter().any(|source| is_read_from(*number, *source)))
        .collect();
    assert_eq!(rules(|rule| if let Sbf(number) = rule { Some(number) } else { None }), read);
    let is_read_with = |system, signal, words: usize| {
        let mut payload = vec![system, 1, signal, 7, words as u8, 0, 2, 0];
        payload.resize(8 + 4 * words, 0);
        is_read(&ubx::frame([0x02, 0x13], &payload))
    };
    let signals = (0..8).flat_map(|system| (0..16).map(move |signal| (system, signal)));
    let read: BTreeSet<(u8, u8)> = signals
        .filter(|(system, signal)| (1..=16).any(|words| is_read_with(*system, *signal, words)))
        .collect();
    assert_eq!(
        rules(|rule| if let Bits(system, signal) = rule { Some((system, signal)) } else { None }),
        read
    );
}

/// Returns the rows of a table in Markdown below a line, without the two of its head: the text
/// between the first and the last bar.
fn table_below(text: &str, head: &str) -> Vec<String> {
    let below =
        text.lines().map(|line| line.trim_start_matches("//!").trim()).skip_while(|line| *line != head);
    below
        .skip(2)
        .take_while(|line| line.starts_with('|'))
        .map(|line| line.trim_matches('|').trim().to_owned())
        .collect()
}

const HEALTH_HEAD: &str = "| flag | effect | assumed when the flag is absent |";

#[test]
fn flags_of_health_have_rows_and_stand_alike_in_the_code_and_in_the_documentation() {
    let code = table_below(include_str!("../../../rai-firmware/src/ephemeris/health.rs"), HEALTH_HEAD);
    let flags: BTreeSet<&str> = code.iter().filter_map(|row| row.split(" | ").next()).collect();
    assert_eq!(rules(|rule| if let Flag(text) = rule { Some(text) } else { None }), flags);
    assert_eq!(table_below(include_str!("../../../INTERFACES.md"), HEALTH_HEAD), code);
}

#[test]
fn documentation_lists_what_nothing_outside_confirms() {
    let unconfirmed: Vec<&str> =
        ROWS.iter().filter(|(.., evidence)| *evidence == Unconfirmed).map(|(_, name, _)| *name).collect();
    let listed = table_below(include_str!("../../../INTERFACES.md"), "| unconfirmed |");
    assert_eq!(listed, unconfirmed);
}

#[test]
fn every_counter_of_osnma_has_a_row() {
    let osnma = Authentication::new();
    let names = osnma.tally().iter().map(|(name, _)| name);
    // One that is wrong breaks the rule of the right one, and what is unread breaks none.
    let counted: BTreeSet<&str> = names
        .filter(|name| !name.ends_with("_wrong") && !name.ends_with("_unread"))
        .map(|name| name.trim_end_matches("_right"))
        .collect();
    assert_eq!(rules(|rule| if let Osnma(name) = rule { Some(name) } else { None }), counted);
}

/// Sequences by number: the slots of both halves of a minute, without the first, in the letters of
/// `osnma/table.rs`.
type Sequences = BTreeMap<u8, [String; 2]>;

/// Returns the sequences of `osnma/table.rs`: `(27, [b"EEEsE", b"EETsE"]),`.
fn own_sequences() -> Sequences {
    let text = include_str!("../../../rai-firmware/src/osnma/table.rs");
    let of_line = |line: &str| {
        let (number, rest) = line.trim().strip_prefix('(')?.split_once(", [b\"")?;
        let (even, rest) = rest.split_once("\", b\"")?;
        Some((number.parse().ok()?, [even.to_owned(), rest.split_once('"')?.0.to_owned()]))
    };
    text.lines().filter_map(of_line).collect()
}

/// Returns those of a script: `27: ('00S 00E 00E', '00S 04S 12S'), `.
fn sequences_of(script: &str) -> Sequences {
    let letter = |slot: &str| match slot {
        "00S" => 'S',
        "00E" => 'E',
        "04S" => 'T',
        "12S" => 's',
        "12E" => 'e',
        "FLX" => 'x',
        other => panic!("{other} is no slot"),
    };
    let slots = |text: &str| text.split_whitespace().skip(1).map(letter).collect::<String>();
    let table = script.split_once("MACLT = {").expect("a table").1.split_once('}').expect("its end").0;
    let numbers = table.split("),").map(|entry| {
        let (number, both) = entry.split_once(": (").expect("a number");
        let quoted: Vec<&str> = both.split('\'').collect();
        (number.trim().parse().expect("a number"), [slots(quoted[1]), slots(quoted[3])])
    });
    numbers.collect()
}

#[test]
fn sequences_are_those_of_another_program() {
    let own = own_sequences();
    assert_eq!(
        rules(|rule| if let Sequence(number) = rule { Some(number) } else { None }),
        own.keys().copied().collect()
    );
    let Some(script) = shared::path_or_skip("tools/osnma.py") else { return };
    assert_eq!(own, sequences_of(&std::fs::read_to_string(script).expect("text")));
}

/// Returns a capture of the reference folder, unpacked; counts the test as skipped if it is
/// missing.
fn capture(relative: &str) -> Option<Vec<u8>> {
    let bytes = std::fs::read(shared::path_or_skip(&format!("data/{relative}"))?).unwrap();
    if Path::new(relative).extension().is_none_or(|ending| ending != "gz") {
        return Some(bytes);
    }
    let mut unpacked = Vec::new();
    GzDecoder::new(&bytes[..]).read_to_end(&mut unpacked).unwrap();
    Some(unpacked)
}

/// Returns true when a capture holds the rule's message.
fn holds(bytes: &[u8], rule: Rule) -> bool {
    let is_it = |kind: Kind, frame: &[u8]| match rule {
        Rtcm(number) => kind == Kind::Rtcm(number),
        Ubx(class, number) => kind == Kind::Ubx([class, number]),
        Sbf(number) => kind == Kind::Sbf(number),
        Bits(system, signal) => {
            kind == Kind::Ubx([0x02, 0x13]) && frame.get(6) == Some(&system) && frame.get(8) == Some(&signal)
        }
        // A field is in the messages that the capture is named for.
        Flag(_) | Field(_) | Osnma(_) | Sequence(_) => true,
    };
    pieces(bytes).any(|piece| is_it(piece.kind, piece.bytes))
}

/// Returns the counters of input refused for its form, its check or its values.
fn refused(counters: &Counters) -> [u32; 8] {
    [
        counters.messages_malformed,
        counters.ephemerides_invalid,
        counters.positions_invalid,
        counters.times_out_of_range,
        counters.satellites_unknown,
        counters.subframes_malformed,
        counters.subframes_parity,
        counters.subframes_mixed,
    ]
}

#[test]
fn recorded_devices_send_the_messages_and_nothing_of_them_is_refused() {
    let files: BTreeSet<&str> = ROWS
        .iter()
        .filter_map(|(.., evidence)| if let Recorded(file) = evidence { Some(*file) } else { None })
        .collect();
    for file in files {
        let Some(bytes) = capture(file) else { return };
        for (rule, name, evidence) in ROWS {
            assert!(evidence != Recorded(file) || holds(&bytes, rule), "{name} in {file}");
        }
        let (mut input, mut ephemerides, mut epochs) = (Input::new(), 0, 0);
        input.feed(&bytes, 0, |event| match event {
            Event::Ephemeris(_) => ephemerides += 1,
            Event::Epoch(..) => epochs += 1,
            _ => {}
        });
        println!("{file}: {ephemerides} ephemerides, {epochs} epochs, {:?}", input.counters());
        let mut want = [0; 8];
        // C50 flies as the geostationary satellites do, under a number that is none of theirs: no
        // rule says which plane its elements are written in.
        want[1] = u32::from(file == F9R);
        // The mosaic has marked 16 subframes as wrong itself, and does not know the slot of a
        // satellite of GLONASS, whose bits it sends a dozen times.
        if file == MOSAIC {
            (want[4], want[6]) = (12, 16);
        }
        // The receiver has marked 5,512 of 13,527 pages between houses as wrong itself.
        if file == OLD_TOWN {
            want[6] = 5512;
        }
        // Galileo satellites renewed their sets during the recordings.
        want[7] = match file {
            X20P => 8,
            OLD_TOWN => 11,
            _ => 0,
        };
        assert_eq!(refused(input.counters()), want, "{file}: {:?}", input.counters());
    }
}
