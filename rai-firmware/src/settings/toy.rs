//! A toy setting: this file and one row of the table are all that a setting takes.

use std::string::String;
use std::vec::Vec;

use super::read::{Values, next_whole};
use super::value::{Ranges, Spelled, Take, Value, range};
use super::{Configuration, Refusal, SEALED_BYTES, Setting, Unsealed};

/// Number of a setting that only unit tests have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Toy(u8);

impl Toy {
    pub(super) const AT_START: Self = Self(3);
}

impl Spelled for Toy {
    const RANGES: usize = 1;
    const WORDS: &'static [&'static str] = &[];
}

impl Value for Toy {
    fn change(&mut self, values: Values<'_, '_>, ranges: &Ranges) -> Result<(), Refusal> {
        self.0 = next_whole(values, range(ranges, 0))?;
        Ok(())
    }

    fn say(&self, take: Take<'_>) {
        take(["0", "1", "2", "3", "4", "5", "6", "7", "8", "9"].get(usize::from(self.0)).unwrap_or(&""));
    }
}

fn with_seven() -> Configuration {
    Configuration::at_start().with("TOY", ["7"].into_iter()).expect("a setting like any other")
}

#[test]
fn a_toy_setting_is_read_within_its_range() {
    assert_eq!(with_seven().toy, Toy(7));
    for (value, want) in
        [("10", Refusal::OutOfRange), ("x", Refusal::NotANumber), ("", Refusal::MissingValue)]
    {
        assert_eq!(Configuration::at_start().with("TOY", [value].into_iter()), Err(want));
    }
}

#[test]
fn a_toy_setting_changes_both_hashes() {
    let at_start = Configuration::at_start();
    assert_ne!(with_seven().hash(), at_start.hash());
    assert_ne!(with_seven().promise_hash(), at_start.promise_hash());
}

#[test]
fn a_toy_setting_is_reported() {
    let mut reported = Vec::new();
    with_seven().write(&mut reported).expect("a vector takes all");
    let text = String::from_utf8(reported).expect("ASCII");
    let fields: Vec<&str> = text.lines().flat_map(|line| line.split(',').skip(2)).collect();
    // The number of the sentence and the number of sentences follow.
    assert_eq!(fields.get(fields.len() - 3), Some(&"7"), "{text}");
    let mut told = Vec::new();
    with_seven().answer(Setting::Toy, &mut told).expect("a vector takes all");
    assert!(told.starts_with(b"$PRAIA,TOY,7,OK*"));
}

#[test]
fn a_toy_setting_is_sealed() {
    let mut memory = [0; SEALED_BYTES];
    with_seven().seal(&mut memory);
    assert_eq!(Configuration::unseal(&memory), Unsealed::Settings(with_seven()));
}
