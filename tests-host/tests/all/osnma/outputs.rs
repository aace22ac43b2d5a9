//! What those read who read no sentences: the table and the summary of `rai replay`.

use raim::replay::{Lump, Pace, Rows, Summary, on_host, track};
use raim::signal::osnma::Secret;

use super::*;
use crate::pin_in_time::{SignedLumps, signed_lumps};

/// A sky of eight satellites, of which one sends a false orbit.
#[test]
fn table_and_summary_of_a_replay_have_what_is_known_of_ephemerides() {
    let SignedLumps { start, lumps, key } = signed_lumps(Secret::test(), 8, Some(3));
    let lump = |(second, bytes): (u32, Vec<u8>)| Lump {
        time: GpsTime::from_ms(start.to_ms() + 1000 * u64::from(second)),
        elapsed_s: f64::from(second),
        bytes,
    };
    let lumps: Vec<Lump> = (0..).zip(lumps).map(lump).collect();
    let table = |setup: &[String]| {
        let run = on_host(&lumps, setup, Pace::Recorded, |_| ()).expect("a run");
        let track = track(&lumps, &run, None);
        let mut table = Vec::new();
        let mut rows = Rows::begin(&mut table).expect("room");
        for moment in &track {
            rows.write(moment).expect("room");
        }
        rows.end().expect("room");
        let summary = Summary::of(&track, &[], false);
        let json = serde_json::to_value(&summary).expect("JSON");
        (String::from_utf8(table).expect("text"), json, summary.to_string())
    };
    let (with_key, json, words) = table(&[key]);
    let lines: Vec<Vec<&str>> = with_key.lines().map(|line| line.split(',').collect()).collect();
    let column = |name| lines[0].iter().position(|column| *column == name).expect("a column");
    let names = ["osnma_state", "osnma_proved", "osnma_unproved", "osnma_false", "osnma_oldest_proof_s"];
    let of = |line: &Vec<&str>| names.map(|name| line[column(name)].to_owned());
    println!("{:?}\n{words}", of(&lines[lines.len() - 1]));
    let [state, counts @ .., oldest_s] = of(&lines[lines.len() - 1]);
    assert_eq!((state.as_str(), counts), ("UNDATED", ["7", "0", "1"].map(str::to_owned)));
    // Proofs come at most once a subframe.
    assert!(oldest_s.parse::<u32>().is_ok_and(|oldest_s| (1..120).contains(&oldest_s)), "{oldest_s}");
    // Before the root key nothing is proved.
    assert_eq!(of(&lines[30]), ["WAIT", "0", "8", "0", ""].map(str::to_owned));
    assert!(lines.iter().all(|line| line.len() == lines[0].len()));
    assert_eq!(json["osnma_last"]["proved"], 7);
    assert_eq!((&json["osnma_last"]["false"], &json["osnma_most_false"]), (&1.into(), &1.into()));
    assert_eq!(json["osnma_last"]["state"], "UNDATED");
    assert!(words.contains("UNDATED: ephemerides of 7 proved, 0 not, 1 false, oldest proof "), "{words}");
    let (without, json, words) = table(&[]);
    assert!(without.lines().skip(1).all(|line| line.ends_with(",,,,,")), "{without}");
    assert!(json["osnma_last"].is_null() && !words.contains("OSNMA"), "{words}");
}
