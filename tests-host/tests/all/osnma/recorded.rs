//! Recorded devices that hear a signed sky: their own frames, to the bit.

use raim::signal::pieces::{Kind, pieces};

use super::*;

/// Key of the recordings of 2023.
const KEY_2023: &str = "KEY,1,0374A925CFA0FF1805E5C5A58FDBA31BF0145D5B5BE2F062D3F8BB2EE98F0F6DB0";

/// Returns a module that has heard a recording, with ticks of 20 ms between its frames. `time_ms` is
/// the time of week that a frame states, ms; the others come with the one before them.
fn heard(path: &str, key: &str, time_ms: fn(Kind, &[u8]) -> Option<u64>) -> Option<Module> {
    let path = shared::path_or_skip(path)?;
    let mut bytes = Vec::new();
    MultiGzDecoder::new(std::fs::File::open(path).expect("a file")).read_to_end(&mut bytes).expect("bytes");
    let mut module = Module::new(&[key]);
    let (mut first_ms, mut now_ms) = (None, 0);
    for piece in pieces(&bytes) {
        if let Some(time_ms) = time_ms(piece.kind, piece.bytes) {
            let came_ms = time_ms - *first_ms.get_or_insert(time_ms);
            while now_ms < came_ms {
                now_ms = (now_ms + 20).min(came_ms);
                module.receiver.tick(now_ms, &mut module.reported);
            }
        }
        module.receiver.gnss(piece.bytes, now_ms, &mut module.reported);
        let summary = module.receiver.authentication();
        let is_false = summary.is_some_and(|summary| summary.false_ > 0 || summary.is_alarm);
        assert!(!is_false, "false at {now_ms} ms: {summary:?}");
    }
    for _ in 0..1000 {
        now_ms += 20;
        module.receiver.tick(now_ms, &mut module.reported);
    }
    Some(module)
}

fn count(module: &Module, name: &str) -> u32 {
    module.counter(&format!("osnma_{name}"))
}

#[test]
fn broken_reception_of_a_septentrio_is_never_false() {
    let of_block = |kind, bytes: &[u8]| {
        let tow_ms = u32::from_le_bytes(*bytes.get(8..)?.first_chunk()?);
        matches!(kind, Kind::Sbf(_)).then_some(u64::from(tow_ms))
    };
    let Some(town) = heard("data/osnma/old_town_inav.sbf.gz", KEY_2023, of_block) else { return };
    for name in ["roots", "keys", "sequences", "orbits", "times", "slow"] {
        let (right, wrong) = (count(&town, &format!("{name}_right")), count(&town, &format!("{name}_wrong")));
        println!("{name}: {right} right");
        assert!(right > 1 && wrong == 0, "{name}: {right} right, {wrong} wrong");
    }
}

/// A walk is too short for a root key. All satellites send one key in a subframe, which fills four
/// pages but for 14 bits: their bits for authentication are equal there, and nowhere else.
#[test]
fn satellites_of_an_x20p_send_one_key() {
    let Some(path) = shared::path_or_skip("data/real/x20p_walk.ubx.gz") else { return };
    let mut bytes = Vec::new();
    MultiGzDecoder::new(std::fs::File::open(path).expect("a file")).read_to_end(&mut bytes).expect("bytes");
    let mut windows: Vec<(u64, Vec<[u8; 4]>)> = Vec::new();
    let mut now_ms = 0;
    for piece in pieces(&bytes) {
        match (piece.kind, piece.bytes) {
            (Kind::Ubx([2, 0x15]), frame) => {
                let tow_s = f64::from_le_bytes(*frame[6..].first_chunk().expect("a time"));
                now_ms = (tow_s * 1e3).round() as u64;
            }
            // Galileo, E1-B: 8 words, each the low byte first.
            (Kind::Ubx([2, 0x13]), frame) if frame[6] == 2 && frame[8] == 1 => {
                let words = frame[14..46].as_chunks::<4>().0;
                let upright: Vec<u8> = words.iter().flat_map(|word| word.iter().rev().copied()).collect();
                let half = |from: usize| upright[from..from + 15].to_vec();
                let page = Page {
                    satellite: frame[7],
                    is_e1: true,
                    begin_s: 0,
                    bytes: [half(0), half(16)].concat().try_into().expect("30 bytes"),
                };
                let [_, mack @ ..] = page.authentication();
                let window = now_ms / 2000;
                if windows.last().is_none_or(|(last, _)| *last != window) {
                    windows.push((window, Vec::new()));
                }
                windows.last_mut().expect("a window").1.push(mack);
            }
            _ => {}
        }
    }
    let connected =
        windows.iter().map(|(_, all)| all.iter().copied().filter(|mack| *mack != [0; 4]).collect::<Vec<_>>());
    let several: Vec<_> = connected.filter(|all| all.len() >= 3).collect();
    let equal = several.iter().filter(|all| all.windows(2).all(|pair| pair[0] == pair[1])).count();
    println!("{} pages of several satellites, {equal} of them equal", several.len());
    // Three of the fifteen pages of a subframe are of the key alone.
    assert!(several.len() >= 40 && (several.len() / 8..several.len() / 3).contains(&equal));
}
