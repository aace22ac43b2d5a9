//! Every kind of message in the recordings at hand has a row in INTERFACES.md, and is read or
//! dropped as that row says.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use flate2::read::GzDecoder;
use raim::signal::pieces::{Kind, Piece, pieces};
use raim_firmware::input::Input;
use rig::shared;

/// Endings of captures, plain or packed.
const CAPTURES: [&str; 5] = [".ubx", ".rtcm3", ".log", ".nmea", ".sbf"];

fn files_below(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(files_below(&path));
        } else if CAPTURES
            .iter()
            .any(|ending| path.to_string_lossy().trim_end_matches(".gz").ends_with(ending))
        {
            files.push(path);
        }
    }
    files.sort();
    files
}

fn bytes_of(path: &Path) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut file = File::open(path).unwrap();
    if path.extension().is_some_and(|ending| ending == "gz") {
        GzDecoder::new(file).read_to_end(&mut bytes).unwrap();
    } else {
        file.read_to_end(&mut bytes).unwrap();
    }
    bytes
}

/// Returns the names of the kinds in a piece, as INTERFACES.md writes them.
fn kinds(piece: &Piece<'_>) -> Vec<String> {
    let byte = |at: usize| piece.bytes.get(at).copied();
    match piece.kind {
        Kind::Rtcm(number) => vec![format!("RTCM {number}")],
        Kind::SFRBX => {
            let signal = byte(6).zip(byte(8)).map(|(system, signal)| format!("SFRBX {system} {signal}"));
            signal.into_iter().chain(["UBX 02 13".to_owned()]).collect()
        }
        Kind::RAWX => {
            let measurements =
                piece.bytes.get(6 + 16..piece.bytes.len() - 2).unwrap_or_default().chunks_exact(32);
            let signals = measurements.map(|one| format!("RAWX {} {}", one[20], one[22]));
            signals.chain(["UBX 02 15".to_owned()]).collect()
        }
        Kind::MEAS_EPOCH => signals(piece.bytes).chain(["SBF 4027".to_owned()]).collect(),
        Kind::Sbf(number) => vec![format!("SBF {number}")],
        Kind::Ubx([class, id]) => vec![format!("UBX {class:02X} {id:02X}")],
        Kind::Line => {
            let text = String::from_utf8_lossy(piece.bytes);
            text.get(3..6).map(|name| format!("NMEA {name}")).into_iter().collect()
        }
        Kind::Rest => Vec::new(),
    }
}

/// Returns the signals of an epoch of SBF, each as the letter of its system and its number.
fn signals(block: &[u8]) -> impl Iterator<Item = String> + '_ {
    let (first_bytes, further_bytes) = (usize::from(block[15]), usize::from(block[16]));
    let mut at = 20;
    (0..block[14]).flat_map(move |_| {
        let first = &block[at..];
        let further = usize::from(first[19]);
        at += first_bytes + further * further_bytes;
        let system = match first[2] {
            1..=37 => 'G',
            38..=68 => 'R',
            71..=106 => 'E',
            141..=180 | 223..=245 => 'C',
            181..=190 => 'J',
            _ => 'S',
        };
        let name = move |kind: u8, information: u8| match kind & 31 {
            31 => format!("MeasEpoch {system} {}", 32 + (information >> 3)),
            number => format!("MeasEpoch {system} {number}"),
        };
        let others = first[first_bytes..].chunks(further_bytes).take(further);
        let others = others.map(|other| name(other[0], other[5]));
        [name(first[1], first[18])].into_iter().chain(others).collect::<Vec<_>>()
    })
}

/// Returns the kinds that a first cell names, with those between two that `to` joins.
fn named(cell: &str) -> Vec<String> {
    let codes: Vec<&str> = cell.split('`').skip(1).step_by(2).collect();
    let joints: Vec<&str> = cell.split('`').step_by(2).collect();
    let mut names: Vec<String> = Vec::new();
    for (index, code) in codes.iter().enumerate() {
        let last = |text: &str| text.rsplit(' ').next().and_then(|number| number.parse::<u32>().ok());
        if joints[index].trim() == "to"
            && let Some((from, to)) = last(codes[index - 1]).zip(last(code))
        {
            let (stem, _) = code.rsplit_once(' ').unwrap();
            names.extend((from + 1..to).map(|number| format!("{stem} {number}")));
        }
        names.push((*code).to_owned());
    }
    names
}

/// Returns each kind of the table, and whether something of it is read.
fn table() -> BTreeMap<String, bool> {
    let text = include_str!("../../../INTERFACES.md");
    let (_, section) = text.split_once("### Everything that receivers send").expect("the section");
    let (section, _) = section.split_once("\n### ").expect("its end");
    let mut rows = BTreeMap::new();
    for line in section.lines().filter(|line| line.starts_with("| `")) {
        let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
        let [kinds, read, dropped] = cells[..] else { panic!("{line}") };
        assert!(read != "–" || dropped != "–", "{line}: neither read nor dropped");
        for kind in named(kinds) {
            assert!(rows.insert(kind.clone(), read != "–").is_none(), "{kind} has two rows");
        }
    }
    rows
}

/// Counter of what the module leaves aside because of its kind, after one frame.
fn is_left_aside(piece: &Piece<'_>) -> bool {
    let mut input = Input::new();
    input.feed(piece.bytes, 0, |_| ());
    input.silence(|_| ());
    let counters = input.counters();
    counters.messages_other + counters.subframes_other > 0
}

#[test]
fn every_kind_in_the_recordings_has_a_row_and_is_read_as_it_says() {
    let Some(folder) = shared::path_or_skip("data") else { return };
    let rows = table();
    let (mut without, mut wrong, mut seen) = (BTreeSet::new(), BTreeSet::new(), BTreeSet::new());
    let mut note = |kind: String, place: &Path| {
        if !rows.contains_key(&kind) {
            without.insert(format!("{kind} in {}", place.display()));
        }
    };
    for path in files_below(&folder) {
        for piece in pieces(&bytes_of(&path)) {
            for kind in kinds(&piece) {
                // A message of ranges is read whatever its signals, and each once is enough.
                if !seen.insert(kind.clone()) {
                    continue;
                }
                note(kind.clone(), &path);
                let is_whole = !matches!(piece.kind, Kind::Line | Kind::Rest)
                    && !kind.starts_with("RAWX")
                    && !kind.starts_with("MeasEpoch");
                let has_signal = piece.kind != Kind::SFRBX || kind.starts_with("SFRBX");
                if is_whole && has_signal && rows.get(&kind) == Some(&is_left_aside(&piece)) {
                    wrong.insert(kind);
                }
            }
        }
    }
    assert!(without.is_empty(), "no row in INTERFACES.md: {without:#?}");
    assert!(wrong.is_empty(), "read or dropped otherwise than INTERFACES.md says: {wrong:#?}");
    assert!(seen.len() > 60, "{} kinds", seen.len());
}
