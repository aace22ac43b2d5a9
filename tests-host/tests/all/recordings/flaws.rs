//! A flaw costs its record and is counted; the rest of the file is read.

use raim::signal::recording::Recording;
use raim::signal::skipped::Skipped;
use raim_firmware::time::GpsTime;

use super::made::{
    EPOCH_2, EPOCH_3, HEADER_2, HEADER_3, NAMES, all_ranges, compact, id, navigation, ranges, version_2,
    version_3, with_line, without_line,
};
use super::quirks::NAVIGATION_3;
use super::{read, refusals};

const EPOCHS: usize = 6;

fn observed(text: &str) -> Recording {
    read(text, &navigation(2)).unwrap()
}

/// Returns the counts, and the line of the first flaw.
fn counts(recording: &Recording) -> (Skipped, u64) {
    let mut skipped = recording.skipped.clone();
    let line = skipped.first.take().map_or(0, |first| first.line);
    skipped.lost_lines = 0;
    (skipped, line)
}

/// Returns all ranges but those of some epochs, and of one satellite of an epoch.
fn all_but(epochs: &[usize], satellite: Option<(usize, &str)>) -> Vec<super::made::Range> {
    let mut all = all_ranges(EPOCHS);
    let time = |epoch: usize| all_ranges(EPOCHS)[epoch * NAMES.len()].0;
    all.retain(|(of, ..)| !epochs.iter().any(|epoch| time(*epoch) == *of));
    if let Some((epoch, name)) = satellite {
        all.retain(|(of, sat, _)| !(*of == time(epoch) && *sat == id(name)));
    }
    all
}

#[test]
fn files_without_a_flaw_are_read_whole_and_nothing_is_counted() {
    for text in [version_3(EPOCHS), version_2(EPOCHS), compact(EPOCHS, 3), compact(EPOCHS, 100)] {
        let have = observed(&text);
        assert_eq!(ranges(&have), all_ranges(EPOCHS));
        assert!(have.skipped.is_empty(), "{}", have.skipped);
    }
}

#[test]
fn comments_and_header_lines_between_records_are_passed_over() {
    let comment = format!("{:60}COMMENT", "left by an archive");
    for (text, header, epoch) in
        [(version_3(EPOCHS), HEADER_3, EPOCH_3), (version_2(EPOCHS), HEADER_2, EPOCH_2)]
    {
        let at = header + 2 * epoch;
        let have = observed(&with_line(&text, at, |line| format!("{comment}\n{line}")));
        assert_eq!(ranges(&have), all_ranges(EPOCHS));
        assert_eq!(counts(&have), (Skipped { comments: 1, ..Skipped::default() }, at as u64 + 1));
        // A second file behind the first, with its own header.
        let lines: Vec<&str> = text.lines().collect();
        let spliced = [&lines[..at], &lines[..header], &lines[at..]].concat().join("\n") + "\n";
        let have = observed(&spliced);
        assert_eq!(ranges(&have), all_ranges(EPOCHS));
        assert_eq!(have.skipped.comments, header as u64);
    }
}

#[test]
fn a_header_that_lists_other_observations_between_records_is_obeyed() {
    let list = format!("{:60}SYS / # / OBS TYPES", "G    2 S1C C1C");
    let text = with_line(&version_3(EPOCHS), HEADER_3 + EPOCH_3, |line| format!("{list}\n{line}"));
    let have = observed(&text);
    let g01 = have.epochs[1].satellites.iter().find(|of| of.satellite == id("G01")).unwrap();
    assert_eq!(g01.signals[0].pseudorange_m.to_bits(), 45.0_f64.to_bits());
}

#[test]
fn a_header_of_another_version_between_records_ends_the_file() {
    let other = version_3(1) + &version_2(EPOCHS);
    let have = refusals::refusal(read(&other, &navigation(2)));
    assert!(have.contains("line 23: a header of another version"), "{have}");
}

#[test]
fn a_bad_character_in_a_range_costs_the_satellite() {
    for bad in ["#", "x", "-", "E"] {
        let text = with_line(&version_3(EPOCHS), HEADER_3 + EPOCH_3 + 2, |line| line.replacen('5', bad, 1));
        let have = observed(&text);
        assert_eq!(ranges(&have), all_but(&[], Some((1, "G02"))), "{bad}");
        let want = Skipped { damaged: 1, ..Skipped::default() };
        assert_eq!(counts(&have), (want, (HEADER_3 + EPOCH_3 + 3) as u64));
    }
}

#[test]
fn a_bad_character_beside_a_range_costs_that_value() {
    let text = with_line(&version_3(EPOCHS), HEADER_3 + 1, |line| line.replace("45.000", "45x000"));
    let have = observed(&text);
    assert_eq!(ranges(&have), all_ranges(EPOCHS));
    assert_eq!(have.epochs[0].satellites[0].signals[0].cn0_dbhz, None);
    assert_eq!(counts(&have).0, Skipped { damaged: 1, ..Skipped::default() });
}

#[test]
fn a_satellite_that_no_system_has_is_counted_and_left_out() {
    for unknown in ["R00", "G00", "J00", "J11"] {
        let text = version_3(EPOCHS).replace("R07", unknown);
        let have = observed(&text);
        assert!(ranges(&have).iter().all(|(_, satellite, _)| *satellite != id("R07")));
        assert_eq!(ranges(&have).len(), EPOCHS * (NAMES.len() - 1));
        let want = Skipped { unknown_satellites: EPOCHS as u64, ..Skipped::default() };
        assert_eq!(counts(&have).0, want, "{unknown}");
    }
    for unknown in ["R00", "J11"] {
        let have = observed(&version_2(EPOCHS).replace("R07", unknown));
        assert_eq!(ranges(&have).len(), EPOCHS * (NAMES.len() - 1));
        assert_eq!(have.skipped.unknown_satellites, EPOCHS as u64, "{unknown}");
    }
}

#[test]
fn a_file_that_ends_inside_an_epoch_loses_that_epoch() {
    for (text, header, epoch) in
        [(version_3(EPOCHS), HEADER_3, EPOCH_3), (version_2(EPOCHS), HEADER_2, EPOCH_2)]
    {
        let lines: Vec<&str> = text.lines().collect();
        let begin = header + (EPOCHS - 1) * epoch;
        for end in begin + 1..begin + epoch {
            let have = observed(&(lines[..end].join("\n") + "\n"));
            assert_eq!(ranges(&have), all_ranges(EPOCHS - 1), "{end} lines");
            assert_eq!(counts(&have), (Skipped { cut: 1, ..Skipped::default() }, begin as u64 + 1));
        }
    }
    // Inside the last range of the file.
    let text = version_3(EPOCHS);
    let end = text.trim_end().len() - "123        45.000".len() - 3;
    assert_eq!(ranges(&observed(&text[..end])), all_ranges(EPOCHS - 1));
}

#[test]
fn a_byte_order_mark_is_no_part_of_the_first_line() {
    for text in [version_3(EPOCHS), version_2(EPOCHS), compact(EPOCHS, 3)] {
        let have = observed(&format!("\u{feff}{text}"));
        assert_eq!(ranges(&have), all_ranges(EPOCHS));
        assert_eq!(counts(&have), (Skipped { header_fields: 1, ..Skipped::default() }, 1));
    }
}

#[test]
fn a_header_field_that_is_not_needed_may_be_misaligned() {
    let fields = [
        "   3582104.9254    532590.2381    5232755.2669              APPROX POSITION XYZ",
        "GPSA     1.8626E-08  2.2352E-08 -1.1921E-07 -5.9605E-08     IONOSPHERIC CORR",
        "  eighteen                                                  LEAP SECONDS",
    ];
    for field in fields {
        let have = observed(&with_line(&version_3(EPOCHS), 1, |line| format!("{field}\n{line}")));
        assert_eq!(ranges(&have), all_ranges(EPOCHS));
        assert_eq!(counts(&have), (Skipped { header_fields: 1, ..Skipped::default() }, 2), "{field}");
        assert_eq!(have.approximate_position, None);
    }
}

#[test]
fn a_missing_line_costs_a_satellite_of_version_3_and_an_epoch_of_version_2() {
    let have = observed(&without_line(&version_3(EPOCHS), HEADER_3 + EPOCH_3 + 3));
    assert_eq!(ranges(&have), all_but(&[], Some((1, "G05"))));
    assert_eq!(counts(&have).0, Skipped { damaged: 1, ..Skipped::default() });
    // Without names beside the ranges, those of the satellites behind the gap would move up.
    for line in 1..EPOCH_2 {
        let have = observed(&without_line(&version_2(12), HEADER_2 + EPOCH_2 + line));
        let epoch = all_ranges(12)[NAMES.len()].0;
        let mut want = all_ranges(12);
        want.retain(|(time, ..)| *time != epoch);
        assert_eq!(ranges(&have), want, "line {line}");
        assert_eq!(have.skipped.damaged, 1, "line {line}");
    }
}

#[test]
fn a_line_too_many_costs_an_epoch_of_version_2() {
    for line in 2..EPOCH_2 {
        let at = HEADER_2 + EPOCH_2 + line;
        let have = observed(&with_line(&version_2(12), at, |line| format!("{line}\n{line}")));
        let epoch = all_ranges(12)[NAMES.len()].0;
        let mut want = all_ranges(12);
        want.retain(|(time, ..)| *time != epoch);
        assert_eq!(ranges(&have), want, "line {line}");
    }
}

#[test]
fn an_epoch_with_a_date_that_is_none_is_passed_over() {
    for bad in ["> 2024 06 31", "> 2024 13 24", "> 2024 06 2x", "> 1924 06 24"] {
        let text =
            with_line(&version_3(12), HEADER_3 + EPOCH_3, |line| line.replacen("> 2024 06 24", bad, 1));
        let have = observed(&text);
        let epoch = all_ranges(12)[NAMES.len()].0;
        assert!(ranges(&have).iter().all(|(time, ..)| *time != epoch));
        assert_eq!(ranges(&have).len(), 11 * NAMES.len());
        let want = Skipped { damaged: 1, ..Skipped::default() };
        assert_eq!(counts(&have), (want, (HEADER_3 + EPOCH_3 + 1) as u64), "{bad}");
    }
}

#[test]
fn an_epoch_out_of_order_does_not_take_the_others_with_it() {
    let places = [("> 2034 06 24", 0), ("> 2034 06 24", 5), ("> 2024 06 25", 5), ("> 2024 05 24", 5)];
    for (wrong, epoch) in places {
        let at = HEADER_3 + epoch * EPOCH_3;
        let have = observed(&with_line(&version_3(12), at, |line| line.replacen("> 2024 06 24", wrong, 1)));
        assert_eq!(ranges(&have).len(), 11 * NAMES.len(), "{wrong}");
        let want = Skipped { out_of_order: 1, ..Skipped::default() };
        assert_eq!(counts(&have), (want, at as u64 + 1), "{wrong}");
        assert!(have.epochs.iter().all(|epoch| epoch.time < GpsTime { week: 2321, tow_ms: 0 }));
    }
}

#[test]
fn a_file_of_which_more_than_a_tenth_is_lost_is_refused() {
    // 7 lines of header and 90 of six epochs: nine may be lost.
    let damaged = |count: usize| {
        let bad = |text: String, index: usize| {
            let line = HEADER_3 + index % EPOCHS * EPOCH_3 + 2 + index / EPOCHS;
            with_line(&text, line, |line| line.replacen('.', "#", 1))
        };
        (0..count).fold(version_3(EPOCHS), bad)
    };
    assert_eq!(observed(&damaged(9)).skipped.damaged, 9);
    let have = refusals::refusal(read(&damaged(10), &navigation(2)));
    let want = "made.obs: 10 of 97 lines cannot be read, at most a tenth may be lost; the first is line 10";
    assert!(have.ends_with(want), "{have}");
}

#[test]
fn damage_to_a_satellite_of_a_compact_file_costs_it_until_its_arcs_begin_again() {
    // Full epochs are 0, 3, 6 and 9; the second line of an epoch is the clock's.
    let epoch_lines = EPOCH_3 + 1;
    let text = with_line(&compact(12, 3), 2 + HEADER_3 + 4 * epoch_lines + 2 + 1, |_| "12x45 0".to_owned());
    let have = observed(&text);
    let mut want = all_ranges(12);
    let times: Vec<GpsTime> = [4, 5].map(|epoch| all_ranges(12)[epoch * NAMES.len()].0).to_vec();
    want.retain(|(time, satellite, _)| !(times.contains(time) && *satellite == id("G02")));
    assert_eq!(ranges(&have), want);
    let line = (2 + HEADER_3 + 4 * epoch_lines + 2 + 2) as u64;
    assert_eq!(counts(&have), (Skipped { damaged: 2, ..Skipped::default() }, line));
}

#[test]
fn a_compact_file_with_a_line_missing_or_too_many_goes_on_at_the_next_full_epoch() {
    let epoch_lines = EPOCH_3 + 1;
    let text = compact(60, 3);
    let at = |line: usize| 2 + HEADER_3 + 4 * epoch_lines + line;
    for line in 0..epoch_lines {
        for damaged in
            [without_line(&text, at(line)), with_line(&text, at(line), |line| format!("{line}\n{line}"))]
        {
            let have = observed(&damaged);
            // The epoch before the gap may go with it: whether its last line is the one that is
            // missing cannot be told.
            let lost: Vec<GpsTime> = [3, 4, 5].map(|epoch| all_ranges(60)[epoch * NAMES.len()].0).to_vec();
            let all = all_ranges(60);
            assert!(ranges(&have).iter().all(|range| all.contains(range)), "line {line}");
            let kept = all.iter().filter(|(time, ..)| !lost.contains(time)).count();
            assert!(ranges(&have).len() >= kept, "line {line}: {} of {kept}", ranges(&have).len());
            assert!(have.skipped.damaged > 0 || ranges(&have).len() == all.len(), "line {line}");
        }
    }
}

#[test]
fn a_bad_number_costs_one_ephemeris() {
    for (good, bad) in [
        ("5.153635631561E+03", "5 153635631561E+03"),
        ("1.224000000000E+05", "1.224000000000E+99"),
        // A number that its message has no room for.
        ("3.536250000000E+02", "3.536250000000E+08"),
        ("G05 2024 06 24", "G05 2024 06 44"),
    ] {
        let text = navigation(12);
        let begin = text.find("G05").unwrap();
        let text = text[..begin].to_owned() + &text[begin..].replacen(good, bad, 1);
        let have = read(&version_3(EPOCHS), &text).unwrap();
        let satellites: Vec<_> = have.ephemerides.iter().map(|ephemeris| ephemeris.satellite).collect();
        assert_eq!(satellites.len(), 11, "{bad}");
        assert!(!satellites.contains(&id("G05")), "{bad}");
        let line = (1 + text[..begin].lines().count()) as u64;
        assert_eq!(counts(&have), (Skipped { damaged: 1, ..Skipped::default() }, line), "{bad}");
    }
}

#[test]
fn a_row_missing_or_too_many_costs_one_ephemeris() {
    let text = navigation(12);
    let first = text.lines().position(|line| line.starts_with("G05")).unwrap();
    for row in 1..8 {
        let twice = with_line(&text, first + row, |line| format!("{line}\n{line}"));
        for damaged in [without_line(&text, first + row), twice] {
            let have = read(&version_3(EPOCHS), &damaged).unwrap();
            assert_eq!((have.ephemerides.len(), have.skipped.damaged), (11, 1), "row {row}");
        }
    }
}

#[test]
fn a_navigation_file_that_ends_inside_a_record_loses_that_record() {
    let text = navigation(3);
    let whole = text.trim_end().len();
    let last = text.rfind("G03").unwrap();
    for end in (last + 24..whole - 1).step_by(5) {
        let have = read(&version_3(EPOCHS), &text[..end]).unwrap();
        assert_eq!((have.ephemerides.len(), have.skipped.cut), (2, 1), "{end} of {whole}");
    }
}

#[test]
fn records_of_other_kinds_and_systems_are_counted_apart() {
    let records = "> STO G01 LNAV
    2024 06 24 08 00 00 GPUT                                  UTC(USNO)
     1.000000000000E+00 1.000000000000E+00 1.000000000000E+00 1.000000000000E+00
> EPH C20 CNV1
C20 2024 06 24 10 00 00 rows of another message
> XYZ of a version to come
     1.000000000000E+00
> EPH S23 SBAS
S23 2024 06 24 10 00 00 1.000000000000E+00 1.000000000000E+00 1.000000000000E+00
> EPH G05 LNAV
";
    let text = navigation(1).replacen("3.04", "4.00", 1).replacen("G01", &format!("{records}G05"), 1);
    let have = read(&version_3(EPOCHS), &text).unwrap();
    assert_eq!(have.ephemerides.len(), 1);
    assert_eq!(counts(&have), (Skipped { other_kinds: 4, ..Skipped::default() }, 0));
}

#[test]
fn counts_are_one_line_that_names_the_first_flaw() {
    let text = with_line(&version_3(EPOCHS), HEADER_3 + 1, |line| line.replacen('.', "#", 1));
    let have = observed(&text).skipped.to_string();
    assert!(have.starts_with("1 damaged; first flaw: /"), "{have}");
    assert!(have.ends_with("made.obs, line 9"), "{have}");
}

#[test]
fn a_glonass_record_with_a_number_beyond_its_field_is_passed_over() {
    for (good, bad) in
        [("1.000000000000E+04", "4.000000000000E+04"), ("1.000000000000E-05", "1.000000000000E+05")]
    {
        let begin = NAVIGATION_3.find("R07").unwrap();
        let glonass = &NAVIGATION_3[begin..];
        let text = navigation(12) + &glonass.replacen(good, bad, 1) + glonass;
        let have = read(&version_3(EPOCHS), &text).unwrap();
        assert_eq!((have.ephemerides.len(), have.skipped.damaged), (13, 1), "{bad}");
    }
}
