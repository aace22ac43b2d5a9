//! Numbers with a unit in a text.

/// Units of figures.
const UNITS: [&str; 36] = [
    "m",
    "km",
    "mm",
    "cm",
    "s",
    "ms",
    "µs",
    "min",
    "minutes",
    "h",
    "hours",
    "MHz",
    "Hz",
    "kΩ",
    "KiB",
    "MiB",
    "kB",
    "MB",
    "byte",
    "bytes",
    "baud",
    "%",
    "°",
    "TECU",
    "M",
    "million",
    "instructions",
    "epochs",
    "satellites",
    "attacks",
    "cuts",
    "kills",
    "dead",
    "values",
    "pixels",
    "figures",
];

/// Returns the numbers with a unit outside code, each by its place and its text.
pub(crate) fn with_unit(text: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    let mut last: Option<(usize, &str)> = None;
    for (start, word) in words_outside_code(text) {
        let unit =
            word.trim_matches(|letter: char| "().,;:|*/]".contains(letter)).split('/').next().unwrap_or("");
        if let Some((at, number)) = last.take().filter(|_| UNITS.contains(&unit)) {
            found.push((at, format!("{number} {unit}")));
        }
        last = number(word).map(|number| (start, number));
    }
    found
}

/// Returns the numbers in the row of a table outside code, with or without a unit.
pub(crate) fn in_row(row: &str) -> Vec<(usize, String)> {
    let trim = |word| str::trim_matches(word, |letter: char| "*()[]−–,;:.".contains(letter));
    let numbers = words_outside_code(row).filter_map(|(at, word)| Some((at, number(trim(word))?.to_owned())));
    numbers.collect()
}

/// Returns the words outside code, each by its place.
fn words_outside_code(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let (mut is_code, mut start) = (false, 0);
    text.split(' ').filter_map(move |word| {
        let at = start;
        start += word.len() + 1;
        let ticks = word.matches('`').count();
        let is_outside = !is_code && ticks == 0;
        is_code ^= ticks % 2 == 1;
        is_outside.then_some((at, word))
    })
}

/// Returns the number that a word is, without a bracket before it.
fn number(word: &str) -> Option<&str> {
    let number = word.trim_start_matches(['(', '|', '*', '[']).trim_end_matches("**");
    let is_number = number.starts_with(|first: char| first.is_ascii_digit())
        && number.chars().all(|letter| letter.is_ascii_digit() || ".,".contains(letter))
        && number.ends_with(|last: char| last.is_ascii_digit());
    is_number.then_some(number)
}

#[test]
fn number_with_a_unit_is_found_in_prose_and_not_in_code() {
    let text = "a fault of 80 m (or 1,140 epochs), `--bias 80 m`, 2.2 to 3.5 ms; version 3 of G06 | 62 KiB |";
    let have: Vec<_> = with_unit(text).into_iter().map(|(_, figure)| figure).collect();
    assert_eq!(have, ["80 m", "1,140 epochs", "3.5 ms", "62 KiB"]);
}

#[test]
fn numbers_of_a_row_need_no_unit() {
    let have: Vec<_> = in_row("| `a 7` | G03 | **0.23 M** | 1,880 / (2.5) |").into_iter().collect();
    assert_eq!(have.iter().map(|(_, figure)| figure.as_str()).collect::<Vec<_>>(), ["0.23", "1,880", "2.5"]);
}
