//! Refused input: each error names the defect, the place and the remedy.

use std::io::Write as _;
use std::path::Path;

use flate2::write::GzEncoder;
use raim::signal::encode::{Frequency, Selection};
use raim::signal::recording::Recording;

use super::quirks::{NAVIGATION_3, OBSERVATIONS_3};
use super::read;

/// Returns the line that a user sees.
pub(crate) fn refusal<T>(result: anyhow::Result<T>) -> String {
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
            &OBSERVATIONS_3.replacen("2024 06 24 08", "2024 06 24 48", 1),
            NAVIGATION_3,
            "4 of 17 lines cannot be read, at most a tenth may be lost; the first is line 9",
        ),
        (OBSERVATIONS_3, "", "made.nav: is empty"),
        (
            OBSERVATIONS_3,
            &NAVIGATION_3.replacen("5.153635631561E+03", "5.153635631561E+ab", 1),
            "made.nav: 8 of 18 lines cannot be read, at most a tenth may be lost; the first is line 7",
        ),
    ] {
        let have = refusal(read(observations, navigation));
        assert!(have.contains(want), "have {have}, want {want}");
    }
}

/// Returns a file with epochs at these seconds.
fn epochs_at(seconds: impl Iterator<Item = u32>) -> String {
    let (header, _) = OBSERVATIONS_3.split_once("> ").unwrap();
    let epoch = |second: u32| format!("> 2024 06 24 08 00 {second:2}.0000000  0  1\nG12  20000000.001\n");
    header.to_owned() + &seconds.map(epoch).collect::<String>()
}

#[test]
fn a_file_whose_time_goes_back_is_refused_for_that_reason() {
    let have = refusal(read(&epochs_at((0..20).chain(0..20)), NAVIGATION_3));
    assert!(have.contains("time goes back or stands still in 20 epochs"), "{have}");
    assert!(have.contains("two recordings in one file"), "{have}");
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
    let path = folder.path().join("bad.obs.gz");
    let mut packed = GzEncoder::new(Vec::new(), flate2::Compression::fast());
    packed.write_all(OBSERVATIONS_3.as_bytes()).unwrap();
    let mut packed = packed.finish().unwrap();
    // Cut off in its header, which is then not whole.
    std::fs::write(&path, &packed[..packed.len() / 2]).unwrap();
    let have = refusal(Recording::load(std::slice::from_ref(&path), &[]));
    assert!(have.contains("bad.obs.gz: END OF HEADER is missing"), "{have}");
    // The sum of its bytes stands in front of their number, which has four.
    let sum = packed.len() - 5;
    packed[sum] ^= 1;
    std::fs::write(&path, &packed).unwrap();
    let have = refusal(Recording::load(&[path], &[]));
    assert!(have.contains("bad.obs.gz: is damaged gzip"), "{have}");
}

#[test]
fn an_archive_that_is_cut_off_is_read_as_far_as_it_goes() {
    let Some((observations, navigation)) = super::STATIC1HZ.paths() else { return };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cut.obs.gz");
    let packed = std::fs::read(&observations).unwrap();
    std::fs::write(&path, &packed[..packed.len() / 3]).unwrap();
    let whole = Recording::load(&[observations], std::slice::from_ref(&navigation)).unwrap();
    let have = Recording::load(&[path], &[navigation]).unwrap();
    let count = have.epochs.len();
    assert!((50..whole.epochs.len() / 2).contains(&count), "{count} of {}", whole.epochs.len());
    // The epoch in which it ends may have lost satellites.
    assert_eq!(have.epochs[..count - 1], whole.epochs[..count - 1]);
    assert!(have.skipped.cut > 0, "{}", have.skipped);
}

#[test]
fn compact_files_of_another_version_or_without_a_whole_epoch_are_refused() {
    let compact = include_str!("compact.crx");
    for (text, want) in [
        (compact.replacen("1.0  ", "7.0  ", 1), "compact RINEX `7.0` is not supported"),
        (compact.lines().take(9).collect::<Vec<_>>().join("\n"), "the observation files hold no epoch"),
        (compact.lines().take(4).collect::<Vec<_>>().join("\n"), "END OF HEADER is missing"),
    ] {
        let have = refusal(read(&text, NAVIGATION_3));
        assert!(have.contains(want), "have {have}, want {want}");
    }
}

#[test]
fn a_file_of_another_packer_is_refused_with_the_command_that_unpacks_it() {
    let folder = tempfile::tempdir().unwrap();
    // First bytes by the formats' own documents.
    for (name, bytes, want) in [
        ("day.obs.bz2", &b"BZh91AY&SY"[..], "packed by bzip2: unpack it first, `bunzip2 -k "),
        ("day.zip", b"PK\x03\x04\x14\0", "packed by zip: unpack it first, `unzip "),
        ("day.24o.Z", b"\x1f\x9d\x90", "packed by compress: unpack it first, `gzip -dk "),
        ("day.obs.xz", b"\xfd7zXZ\0\0", "packed by xz: unpack it first, `xz -dk "),
        ("day.obs.zst", b"\x28\xb5\x2f\xfd\0", "packed by zstd: unpack it first, `zstd -d "),
    ] {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        let have = refusal(Recording::load(std::slice::from_ref(&path), &[]));
        assert!(have.contains(want) && have.ends_with(&format!("{name}`")), "have {have}, want {want}");
        let have = refusal(Recording::of_navigation(&[path]));
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
    for (letters, want) in [("GX", "system `X` of `GX`"), ("", "no system is selected"), ("S", "system `S`")]
    {
        let have = refusal(Selection::new(letters, Frequency::Dual));
        assert!(have.contains(want), "{have}");
    }
}

#[test]
fn the_sample_needs_a_folder_that_can_be_written() {
    let have = refusal(raim::signal::sample::fetch(Path::new("/dev/null")));
    assert!(have.contains("sample"), "{have}");
}
