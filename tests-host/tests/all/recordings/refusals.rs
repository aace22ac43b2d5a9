//! Refused input: each error names the defect, the place and the remedy.

use std::io::Write as _;
use std::path::Path;

use flate2::write::GzEncoder;
use tests_host::encode::{Frequency, Selection};
use tests_host::recording::Recording;

use super::quirks::{NAVIGATION_3, OBSERVATIONS_3};
use super::read;

/// Returns the line that a user sees.
fn refusal<T>(result: anyhow::Result<T>) -> String {
    format!("{:#}", result.err().expect("refused"))
}

#[test]
fn a_missing_file_is_named() {
    let have = refusal(Recording::load(&["no/such.obs".into()], &["no/such.nav".into()]));
    assert!(have.contains("observation file no/such.obs: cannot be read"), "{have}");
}

#[test]
fn unreadable_files_say_what_they_are() {
    let half = OBSERVATIONS_3.find("END OF HEADER").unwrap();
    for (observations, navigation, want) in [
        ("", NAVIGATION_3, "made.obs: is empty"),
        (" \n\n", NAVIGATION_3, "made.obs: is empty"),
        ("hello\nworld\n", NAVIGATION_3, "made.obs: is not RINEX: line 1"),
        (NAVIGATION_3, NAVIGATION_3, "made.obs: holds ephemerides: give it as navigation file"),
        (OBSERVATIONS_3, OBSERVATIONS_3, "made.nav: holds observations: give it as observation file"),
        (&OBSERVATIONS_3[..half], NAVIGATION_3, "made.obs: END OF HEADER is missing"),
        (
            &OBSERVATIONS_3.replacen("3.02", "9.00", 1),
            NAVIGATION_3,
            "RINEX 9 is not supported, only 2, 3 and 4",
        ),
        (
            &OBSERVATIONS_3.replacen("24503597.381", "24503597x381", 1),
            NAVIGATION_3,
            "`24503597x381` is not a number",
        ),
        (&OBSERVATIONS_3.replacen("2024 06 24 08", "2024 06 24 48", 1), NAVIGATION_3, "is not a date"),
        (&OBSERVATIONS_3.replacen("G 2", "G??", 1), NAVIGATION_3, "`G??` is not a satellite"),
        (&OBSERVATIONS_3.replacen("  1  1", "  1 77", 1), NAVIGATION_3, "the file ends inside an epoch"),
        (OBSERVATIONS_3, "", "made.nav: is empty"),
        (
            OBSERVATIONS_3,
            &NAVIGATION_3.replacen("5.153635631561E+03", "5.153635631561E+ab", 1),
            "ephemeris of G05",
        ),
    ] {
        let have = refusal(read(observations, navigation));
        assert!(have.contains(want), "have {have}, want {want}");
    }
}

#[test]
fn a_navigation_file_of_another_day_is_refused_with_both_times() {
    let tuesday =
        NAVIGATION_3.replace("2024 06 24", "2024 06 25").replace("1.224000000000E+05", "2.088000000000E+05");
    let have = refusal(read(OBSERVATIONS_3, &tuesday));
    assert!(have.contains("no ephemeris is of the time of the observations (2024-06-24 08:00:33"), "{have}");
    assert!(have.contains("all are for 2024-06-25 08:15:18 to 2024-06-25 10:00:00"), "{have}");
    assert!(have.contains("take the navigation file of that day"), "{have}");
}

#[test]
fn a_damaged_archive_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cut.obs.gz");
    let mut packed = GzEncoder::new(Vec::new(), flate2::Compression::fast());
    packed.write_all(OBSERVATIONS_3.as_bytes()).unwrap();
    let packed = packed.finish().unwrap();
    std::fs::write(&path, &packed[..packed.len() / 2]).unwrap();
    let have = refusal(Recording::load(&[path], &[]));
    assert!(have.contains("cut.obs.gz: is damaged gzip"), "{have}");
}

#[test]
fn compact_files_that_are_cut_or_changed_are_refused_with_the_line() {
    let compact = include_str!("compact.crx");
    for (text, want) in [
        (compact.replacen("1.0  ", "7.0  ", 1), "compact RINEX `7.0` is not supported"),
        (compact.lines().take(9).collect::<Vec<_>>().join("\n"), "the file ends inside an epoch"),
        (compact.replacen("3&40000", "x&40000", 1), "satellite G21: `x&40000` does not begin with an order"),
        (compact.replacen("3&40000", "40000", 1), "`40000` continues an observation that never began"),
    ] {
        let have = refusal(read(&text, NAVIGATION_3));
        assert!(have.contains(want), "have {have}, want {want}");
    }
}

#[test]
fn any_cut_of_a_file_is_read_or_refused_but_never_a_panic() {
    for text in [OBSERVATIONS_3, include_str!("compact.crx"), include_str!("compact.obs")] {
        for end in (0..text.len()).step_by(7) {
            let _ = read(&text[..end], NAVIGATION_3);
            let _ = read(OBSERVATIONS_3, &NAVIGATION_3[..end.min(NAVIGATION_3.len())]);
        }
    }
}

#[test]
fn an_unknown_system_is_named() {
    for (letters, want) in [("GX", "system `X` of `GX`"), ("", "no system is selected"), ("J", "system `J`")]
    {
        let have = refusal(Selection::new(letters, Frequency::Dual));
        assert!(have.contains(want), "{have}");
    }
}

#[test]
fn the_sample_needs_a_folder_that_can_be_written() {
    let have = refusal(tests_host::sample::fetch(Path::new("/dev/null")));
    assert!(have.contains("sample"), "{have}");
}
