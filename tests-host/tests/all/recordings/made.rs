//! Files made by the rules of RINEX, with known values, which the tests of flaws damage.

use std::fmt::Write as _;

use raim::signal::recording::Recording;
use raim_core::satellite::SatelliteId;
use raim_firmware::time::GpsTime;

use super::quirks::NAVIGATION_3;

/// Satellites in the order of the file; they exceed a line of RINEX 2.
pub(crate) const NAMES: [&str; 14] =
    ["G01", "G02", "G05", "G12", "G32", "E01", "E02", "E24", "E33", "C06", "C20", "C30", "R07", "J02"];

/// Number of lines before the first epoch of [`version_3`] and of [`version_2`].
pub(crate) const HEADER_3: usize = 7;
pub(crate) const HEADER_2: usize = 3;

/// Number of lines in an epoch of [`version_3`] and of [`version_2`].
pub(crate) const EPOCH_3: usize = 1 + NAMES.len();
pub(crate) const EPOCH_2: usize = 2 + 2 * NAMES.len();

/// Returns the pseudorange of a satellite, mm.
fn range_mm(epoch: usize, index: usize) -> i64 {
    (20_000_000_123 + 500_000_000 * index + 12_345 * epoch).cast_signed() as i64
}

fn metres(mm: i64) -> String {
    format!("{}.{:03}", mm / 1000, mm % 1000)
}

/// Returns epochs every 30 s from 2024-06-24 08:00 on, in RINEX 3.04.
pub(crate) fn version_3(epochs: usize) -> String {
    let mut text = line("     3.04           OBSERVATION DATA    M: Mixed", "RINEX VERSION / TYPE");
    for codes in ["G    2 C1C S1C", "E    2 C1C S1C", "C    2 C2I S2I", "R    2 C1C S1C", "J    2 C1C S1C"] {
        text += &line(codes, "SYS / # / OBS TYPES");
    }
    text += &line("", "END OF HEADER");
    for epoch in 0..epochs {
        let (minute, second) = (epoch / 2, epoch % 2 * 30);
        let _ = writeln!(text, "> 2024 06 24 08 {minute:02} {second:2}.0000000  0 {:2}", NAMES.len());
        for (index, name) in NAMES.iter().enumerate() {
            let _ = writeln!(text, "{name}{:>14}  {:>14}", metres(range_mm(epoch, index)), "45.000");
        }
    }
    text
}

/// Returns the same epochs in RINEX 2.11: the range is in the first line of a satellite, the ratio
/// in the second.
pub(crate) fn version_2(epochs: usize) -> String {
    let mut text = line("     2.11           OBSERVATION DATA    M (MIXED)", "RINEX VERSION / TYPE");
    text += &line("     6    C1    L1    P2    L2    D1    S1", "# / TYPES OF OBSERV");
    text += &line("", "END OF HEADER");
    for epoch in 0..epochs {
        let (minute, second) = (epoch / 2, epoch % 2 * 30);
        let (first, rest) = NAMES.split_at(12);
        let opening = format!(" 24  6 24  8 {minute:2} {second:2}.0000000  0 {:2}", NAMES.len());
        let _ = writeln!(text, "{opening:32}{}\n{:32}{}", first.concat(), "", rest.concat());
        for index in 0..NAMES.len() {
            let _ = writeln!(text, "{:>14}\n{:>14}", metres(range_mm(epoch, index)), "45.000");
        }
    }
    text
}

/// Returns the same epochs in compact RINEX 3; every epoch whose number `full` divides is given in
/// full.
pub(crate) fn compact(epochs: usize, full: usize) -> String {
    let plain = version_3(epochs);
    let lines: Vec<&str> = plain.lines().collect();
    let mut text = line("3.0                 COMPACT RINEX FORMAT", "CRINEX VERS   / TYPE");
    text += &line("a test", "CRINEX PROG / DATE");
    for header in &lines[..HEADER_3] {
        let _ = writeln!(text, "{header}");
    }
    let opening = |epoch: usize| format!("{:41}{}", lines[HEADER_3 + epoch * EPOCH_3], NAMES.concat());
    for epoch in 0..epochs {
        let is_full = epoch % full == 0;
        let change = |(new, old): (char, char)| match new {
            _ if new == old => ' ',
            ' ' => '&',
            _ => new,
        };
        let difference =
            || opening(epoch).chars().zip(opening(epoch - 1).chars()).map(change).collect::<String>();
        let _ =
            writeln!(text, "{}\n", if is_full { opening(epoch) } else { difference().trim_end().to_owned() });
        for index in 0..NAMES.len() {
            let value = range_mm(epoch, index);
            if is_full {
                let _ = writeln!(text, "1&{value} 1&45000");
            } else {
                let _ = writeln!(text, "{} 0", value - range_mm(epoch - 1, index));
            }
        }
    }
    text
}

/// Returns ephemerides of this number of GPS satellites, of the time of the observations.
pub(crate) fn navigation(satellites: usize) -> String {
    let begin = NAVIGATION_3.find("G05").unwrap();
    let end = NAVIGATION_3.find("R07").unwrap();
    let (header, record) = (&NAVIGATION_3[..begin], &NAVIGATION_3[begin..end]);
    let records = (1..=satellites).map(|number| record.replacen("G05", &format!("G{number:02}"), 1));
    header.to_owned() + &records.collect::<String>()
}

fn line(content: &str, label: &str) -> String {
    format!("{content:60}{label}\n")
}

/// One pseudorange: time, satellite, mm.
pub(crate) type Range = (GpsTime, SatelliteId, i64);

/// Returns all pseudoranges of a recording.
pub(crate) fn ranges(recording: &Recording) -> Vec<Range> {
    let of_epoch = |epoch: &raim::signal::measurement::MeasuredEpoch| {
        let time = epoch.time;
        let range = move |of: &raim::signal::measurement::MeasuredSatellite| {
            (time, of.satellite, (of.signals[0].pseudorange_m * 1e3).round() as i64)
        };
        epoch.satellites.iter().map(range).collect::<Vec<_>>()
    };
    recording.epochs.iter().flat_map(of_epoch).collect()
}

/// Returns the expected [`ranges`] of this number of epochs.
pub(crate) fn all_ranges(epochs: usize) -> Vec<Range> {
    let of = |epoch: usize| {
        // 2024-06-24 is the Monday of week 2320.
        let time = GpsTime { week: 2320, tow_ms: (86_400 + 8 * 3600 + 30 * epoch as u32) * 1000 };
        NAMES.iter().enumerate().map(move |(index, name)| (time, id(name), range_mm(epoch, index)))
    };
    (0..epochs).flat_map(of).collect()
}

pub(crate) fn id(name: &str) -> SatelliteId {
    SatelliteId::from_name(name.chars().next().unwrap(), name[1..].parse().unwrap()).unwrap()
}

/// Returns a text with one line changed; lines count from 0.
pub(crate) fn with_line(text: &str, number: usize, change: impl FnOnce(&str) -> String) -> String {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    lines[number] = change(&lines[number]);
    lines.join("\n") + "\n"
}

/// Returns a text without a line.
pub(crate) fn without_line(text: &str, number: usize) -> String {
    let mut lines: Vec<&str> = text.lines().collect();
    lines.remove(number);
    lines.join("\n") + "\n"
}
