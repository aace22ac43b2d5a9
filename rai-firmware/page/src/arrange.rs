//! Arguments of `rai replay` for files that were dropped together, by what they hold.

use std::path::Path;

use anyhow::{Result, bail, ensure};
use raim::signal::sort::{Kind, kind_of};
use serde_json::{Value, json};

/// Returns the arguments and the notes about files that take no part.
///
/// # Errors
/// The files do not make one recording; the message says what to do.
pub(crate) fn arguments(files: &[&str]) -> Result<Value> {
    let of = |wanted: Kind| -> Vec<&str> {
        files.iter().copied().filter(|name| kind_of(Path::new(name)) == wanted).collect()
    };
    let [captures, observations, navigation] = [Kind::Capture, Kind::Observations, Kind::Navigation].map(of);
    let (positions, unknown) = (of(Kind::Positions), of(Kind::Unknown));
    let names = |files: &[&str]| files.join(", ");
    ensure!(!files.is_empty(), "no file was given: drop a recording of a receiver");
    if let ([capture, ..], [observation, ..]) = (captures.as_slice(), observations.as_slice()) {
        bail!(
            "{capture} is a capture of a receiver and {observation} holds RINEX observations: drop one of the two"
        );
    }
    ensure!(
        observations.is_empty() || !navigation.is_empty(),
        "{} holds observations and no orbits: drop the navigation file of that day beside it, that of your receiver or one \
         of a network, such as BRDC….rnx.gz",
        names(&observations)
    );
    let is_without_ranges = captures.is_empty() && observations.is_empty();
    if is_without_ranges && !navigation.is_empty() {
        bail!(
            "{} holds orbits and no ranges: drop the observation file of that day beside it",
            names(&navigation)
        );
    }
    let mut notes = Vec::new();
    let first = match unknown.first().or(positions.first()) {
        // The replay says what it is, and what a receiver must send in its place.
        Some(first) if is_without_ranges => vec![*first],
        _ => captures,
    };
    let option = |name: &'static str, files: &[&str]| -> Vec<String> {
        let name = (!files.is_empty()).then_some(name);
        name.into_iter().chain(files.iter().copied()).map(str::to_owned).collect()
    };
    let first: Vec<String> = first.into_iter().map(str::to_owned).collect();
    let mut all = [first, option("--obs", &observations), option("--nav", &navigation)].concat();
    if !is_without_ranges {
        if let Some(truth) = positions.first() {
            all.extend(["--truth".to_owned(), (*truth).to_owned()]);
            notes.push(format!("{truth} holds positions, which are taken as the truth"));
        }
        let others = positions.iter().skip(1).chain(&unknown);
        notes.extend(
            others.map(|name| format!("{name} takes no part: nothing in it belongs to the recording")),
        );
    }
    Ok(json!({ "arguments": all, "notes": notes }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample;

    /// Writes files of every kind; returns what is made of some of them.
    fn arranged(wanted: &[&str]) -> String {
        let folder = tempfile::tempdir().unwrap();
        let rinex = |letter: char| {
            format!(
                "{:9}{:11}{letter:<20}{:20}RINEX VERSION / TYPE\n{:60}END OF HEADER\n",
                "     3.04", "", "M", ""
            )
        };
        let paths: Vec<String> = wanted
            .iter()
            .map(|name| {
                let path = folder.path().join(name);
                let content = match *name {
                    "capture" => sample::bytes().unwrap(),
                    "obs" => rinex('O').into_bytes(),
                    "nav" => rinex('N').into_bytes(),
                    "truth" => b"week,tow,x_m,y_m,z_m\n".to_vec(),
                    _ => b"\xFF\xD8\xFF\xE0".to_vec(),
                };
                std::fs::write(&path, content).unwrap();
                path.display().to_string()
            })
            .collect();
        let paths: Vec<&str> = paths.iter().map(String::as_str).collect();
        let have = match arguments(&paths) {
            Ok(value) => {
                let words: Vec<&str> = value["arguments"]
                    .as_array()
                    .unwrap()
                    .iter()
                    .map(|word| word.as_str().unwrap())
                    .collect();
                format!("{} [{}]", words.join(" "), value["notes"].as_array().unwrap().len())
            }
            Err(error) => error.to_string(),
        };
        have.replace(&format!("{}/", folder.path().display()), "")
    }

    #[test]
    fn files_find_their_places_whatever_their_order() {
        for (files, want) in [
            (&["capture"][..], "capture [0]"),
            (&["nav", "capture"], "capture --nav nav [0]"),
            (&["nav", "obs"], "--obs obs --nav nav [0]"),
            (&["truth", "obs", "nav"], "--obs obs --nav nav --truth truth [1]"),
            (&["photo", "capture"], "capture [1]"),
            (&["photo"], "photo [0]"),
            (&["truth"], "truth [0]"),
        ] {
            assert_eq!(arranged(files), want, "{files:?}");
        }
        for (files, want) in [
            (&[][..], "no file was given"),
            (&["obs"], "obs holds observations and no orbits: drop the navigation file"),
            (&["nav"], "nav holds orbits and no ranges"),
            (&["obs", "nav", "capture"], "drop one of the two"),
        ] {
            assert!(arranged(files).contains(want), "{files:?}: {}", arranged(files));
        }
    }
}
