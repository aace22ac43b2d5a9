//! Lines changed at random: never a panic, never a range of another satellite, and no more lost
//! than is counted.

use proptest::prelude::*;
use raim::signal::recording::Recording;

use super::made::{
    EPOCH_2, EPOCH_3, HEADER_2, HEADER_3, NAMES, all_ranges, compact, navigation, ranges, version_2,
    version_3,
};
use super::read;

const EPOCHS: usize = 24;

/// One change of a text, of the kinds that transfers, editors and dying disks make.
#[derive(Clone, Debug)]
enum Change {
    Character { line: usize, column: usize, to: char },
    DeletedCharacter { line: usize, column: usize },
    Deleted { line: usize },
    Doubled { line: usize },
    Split { line: usize, column: usize },
    Cut { line: usize, column: usize },
}

impl Change {
    fn apply(&self, text: &str, header: usize) -> String {
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        let body = lines.len() - header;
        let at = |line: usize| header + line % body;
        match *self {
            Self::Character { line, column, to } => {
                let line = &mut lines[at(line)];
                if !line.is_empty() {
                    let column = column % line.len();
                    line.replace_range(column..=column, &to.to_string());
                }
            }
            Self::DeletedCharacter { line, column } => {
                let line = &mut lines[at(line)];
                if !line.is_empty() {
                    let column = column % line.len();
                    line.remove(column);
                }
            }
            Self::Deleted { line } => drop(lines.remove(at(line))),
            Self::Doubled { line } => {
                let line = at(line);
                lines.insert(line, lines[line].clone());
            }
            Self::Split { line, column } => {
                let line = at(line);
                let column = column % (lines[line].len() + 1);
                let rest = lines[line].split_off(column);
                lines.insert(line + 1, rest);
            }
            Self::Cut { line, column } => {
                lines.truncate(at(line) + 1);
                let last = lines.last_mut().unwrap();
                let column = column % (last.len() + 1);
                last.truncate(column);
                return lines.join("\n");
            }
        }
        lines.join("\n") + "\n"
    }
}

fn change() -> impl Strategy<Value = Change> {
    let (line, column) = (0..2000_usize, 0..90_usize);
    let to = prop::sample::select(" 0123456789.-+#&>GRECJSxD\u{7f}".chars().collect::<Vec<_>>());
    prop_oneof![
        (line.clone(), column.clone(), to).prop_map(|(line, column, to)| Change::Character {
            line,
            column,
            to
        }),
        (line.clone(), column.clone()).prop_map(|(line, column)| Change::DeletedCharacter { line, column }),
        line.clone().prop_map(|line| Change::Deleted { line }),
        line.clone().prop_map(|line| Change::Doubled { line }),
        (line.clone(), column.clone()).prop_map(|(line, column)| Change::Split { line, column }),
        (line, column).prop_map(|(line, column)| Change::Cut { line, column }),
    ]
}

/// Ranges that are missing without being counted.
///
/// Lines behind a cut are not in the file, so that nothing can count them.
fn uncounted(have: &Recording, text: &str, header: usize, lines_of_epoch: usize) -> i64 {
    let epochs = (text.lines().count() - header) / lines_of_epoch;
    let skipped = &have.skipped;
    let counted = skipped.lost_lines + skipped.other_kinds + skipped.cut * NAMES.len() as u64;
    signed(epochs * NAMES.len()) - signed(ranges(have).len()) - counted.cast_signed()
}

fn signed(count: usize) -> i64 {
    count.cast_signed() as i64
}

/// Ranges that no satellite has at that time.
fn invented(have: &Recording) -> usize {
    let all = all_ranges(EPOCHS);
    ranges(have).iter().filter(|range| !all.contains(range)).count()
}

/// Epochs whose own line says another time than it did: their ranges cannot be held against
/// anything.
fn with_a_time_of_the_file(mut have: Recording) -> Recording {
    let all = all_ranges(EPOCHS);
    have.epochs.retain(|epoch| all.iter().any(|(time, ..)| *time == epoch.time));
    have
}

#[test]
fn a_range_without_its_arc_is_counted_although_other_values_of_the_line_stay() {
    // The first satellite of the ninth epoch, in full, loses the mark that begins an arc.
    let text = Change::DeletedCharacter { line: 130, column: 1 }.apply(&compact(EPOCHS, 4), HEADER_3 + 2);
    let have = read(&text, &navigation(2)).expect("a readable file");
    assert_eq!(uncounted(&have, &text, HEADER_3 + 2, EPOCH_3 + 1), 0, "{}", have.skipped);
    assert_eq!(have.skipped.lost_lines, 4, "until the next epoch in full");
}

#[test]
fn a_file_that_ends_behind_the_name_of_a_satellite_is_cut() {
    let text = Change::Cut { line: 104, column: 3 }.apply(&version_3(EPOCHS), HEADER_3);
    assert!(text.ends_with("\nJ02"));
    let have = read(&text, &navigation(2)).expect("a readable file");
    assert_eq!((uncounted(&have, &text, HEADER_3, EPOCH_3), have.skipped.cut), (0, 1), "{}", have.skipped);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn a_change_of_version_3_costs_what_is_counted(change in change()) {
        let text = change.apply(&version_3(EPOCHS), HEADER_3);
        if let Ok(have) = read(&text, &navigation(2)) {
            let lost = uncounted(&have, &text, HEADER_3, EPOCH_3);
            prop_assert!(lost <= 0, "{lost} ranges, {}", have.skipped);
            let have = with_a_time_of_the_file(have);
            prop_assert!(invented(&have) <= 1, "{} ranges, {}", invented(&have), have.skipped);
        }
    }

    #[test]
    fn a_change_of_version_2_costs_what_is_counted(change in change()) {
        let text = change.apply(&version_2(EPOCHS), HEADER_2);
        if let Ok(have) = read(&text, &navigation(2)) {
            let lost = uncounted(&have, &text, HEADER_2, EPOCH_2);
            prop_assert!(lost <= 0, "{lost} ranges, {}", have.skipped);
            let have = with_a_time_of_the_file(have);
            prop_assert!(invented(&have) <= 1, "{} ranges, {}", invented(&have), have.skipped);
        }
    }

    #[test]
    fn a_change_of_a_compact_file_costs_what_is_counted(change in change()) {
        let text = change.apply(&compact(EPOCHS, 4), HEADER_3 + 2);
        if let Ok(have) = read(&text, &navigation(2)) {
            let lost = uncounted(&have, &text, HEADER_3 + 2, EPOCH_3 + 1);
            // A changed blank ends an arc as a word that was left out does.
            prop_assert!(lost <= 1, "{lost} ranges, {}", have.skipped);
            let have = with_a_time_of_the_file(have);
            // Until the next epoch in full a changed difference stays in the sum.
            prop_assert!(invented(&have) <= 4, "{} ranges, {}", invented(&have), have.skipped);
        }
    }

    #[test]
    fn a_change_of_navigation_costs_what_is_counted(change in change()) {
        let text = change.apply(&navigation(24), 6);
        if let Ok(have) = read(&version_3(2), &text) {
            let records = (text.lines().count() - 6) / 8;
            let skipped = &have.skipped;
            let counted = skipped.lost_lines / 8 + skipped.other_kinds + 2 * skipped.cut;
            let lost = signed(records) - signed(have.ephemerides.len()) - counted.cast_signed();
            prop_assert!(lost <= 0, "{lost} ephemerides, {skipped}");
        }
    }

    #[test]
    fn many_changes_of_any_file_are_read_or_refused(changes in prop::collection::vec(change(), 1..40)) {
        let all = [(version_3(EPOCHS), 0), (version_2(EPOCHS), 0), (compact(EPOCHS, 4), 0)];
        for (text, header) in all {
            let text = changes.iter().fold(text, |text, change| change.apply(&(text + "\n"), header));
            let _ = read(&text, &navigation(2));
        }
        let text = changes.iter().fold(navigation(24), |text, change| change.apply(&(text + "\n"), 0));
        let _ = read(&version_3(2), &text);
    }

    #[test]
    fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..2000)) {
        let folder = tempfile::tempdir()?;
        let path = folder.path().join("any");
        let headers = [version_3(0), version_2(0), compact(0, 1), navigation(0)];
        for header in headers {
            std::fs::write(&path, [header.as_bytes(), &bytes].concat())?;
            let _ = Recording::load(std::slice::from_ref(&path), std::slice::from_ref(&path));
            let _ = Recording::of_navigation(std::slice::from_ref(&path));
        }
    }
}
