//! Invalid bytes and frames.

use raim::signal::checksum::rtcm_frame;
use rand::rngs::ChaCha8Rng;
use rand::{Rng, SeedableRng};

use super::frames::{claiming, frames, payload};
use super::module::{Module, Sky};

fn noise(rng: &mut ChaCha8Rng, length: usize) -> Vec<u8> {
    let mut bytes = vec![0; length];
    rng.fill_bytes(&mut bytes);
    bytes
}

#[test]
fn random_bytes_between_frames_cost_no_frame() {
    let sky = Sky::quiet(40);
    let mut module = Module::after(&sky, 3);
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    for lump in &sky.lumps[3..] {
        let length = rng.next_u32() as usize % 900;
        let among = |frame: Vec<u8>| [noise(&mut rng, length), frame].concat();
        module.recovers(&frames(lump).into_iter().flat_map(among).collect::<Vec<u8>>());
    }
    assert!(module.grown("bytes_skipped") > 0);
    assert_eq!(module.grown("epochs_protected") as usize, sky.lumps.len() - 3);
}

#[test]
fn a_wrong_crc_costs_its_frame_only() {
    let sky = Sky::quiet(20);
    let mut module = Module::after(&sky, 3);
    let mut turn = 3;
    for spoiled in 0..frames(&sky.lumps[3]).len() {
        module.note();
        let mut bytes = frames(&sky.lumps[turn]);
        let middle = bytes[spoiled].len() / 2;
        bytes[spoiled][middle] ^= 0x10;
        module.receive(&bytes.concat());
        assert_eq!(module.grown("crc_failures"), 1, "frame {spoiled}");
        module.recovers(&sky.lumps[turn + 1]);
        turn += 2;
    }
}

#[test]
fn a_frame_cut_anywhere_costs_its_epoch_only() {
    const STEP: usize = 7;
    let sky = Sky::quiet(240);
    let mut module = Module::after(&sky, 3);
    for (turn, pair) in sky.lumps[3..].chunks_exact(2).enumerate() {
        let Some((cut, rest)) = pair[0].split_at_checked(1 + turn * STEP) else { break };
        module.note();
        module.receive(cut);
        let at_border = rest.first().is_none_or(|byte| *byte == 0xD3) && module.grown("bytes_skipped") == 0;
        assert!(module.grown("frames_cut") > 0 || at_border, "cut after {}", cut.len());
        module.recovers(&pair[1]);
    }
}

#[test]
fn a_cut_frame_does_not_swallow_the_next_epoch() {
    let sky = Sky::quiet(5);
    let mut module = Module::after(&sky, 3);
    // Without a pause the length that the cut frame announces reaches into the good ones.
    let half = sky.lumps[3].len() / 2;
    module.recovers(&[&sky.lumps[3][..half], &sky.lumps[4]].concat());
    assert_eq!(module.grown("crc_failures") + module.grown("frames_cut"), 1);
}

#[test]
fn the_longest_frame_is_read_through_whatever_it_claims_to_be() {
    let sky = Sky::quiet(24);
    let mut module = Module::after(&sky, 3);
    let cases = [
        (4095, 0xD3, "messages_other"),
        (1077, 0xFF, "messages_malformed"),
        (1077, 0x00, "epochs_backwards"),
        (1127, 0xFF, "messages_malformed"),
        (1019, 0xFF, "ephemerides_invalid"),
        (1042, 0xFF, "ephemerides_invalid"),
        (1046, 0xFF, "ephemerides_invalid"),
        // The offset of GLONASS time from GPS time is unknown.
        (1087, 0x00, "leap_unknown"),
        (1107, 0x00, "observations_other"),
        (1005, 0x00, "positions_invalid"),
    ];
    for (number, fill, counter) in cases {
        module.note();
        let reported = module.receive(&rtcm_frame(&claiming(number, 1023, fill)));
        assert!(reported.is_empty(), "{number}: {reported:?}");
        assert_eq!(module.grown(counter), 1, "{number} of {fill:#x}");
        module.recovers(&sky.lumps[module.second()]);
    }
}

#[test]
fn messages_shorter_than_their_type_are_malformed() {
    const TYPES: [u16; 12] = [1005, 1006, 1019, 1042, 1045, 1046, 1074, 1075, 1076, 1077, 1097, 1127];
    let sky = Sky::quiet(32);
    let mut module = Module::after(&sky, 3);
    for number in TYPES {
        module.note();
        let short = [2, 3, 7, 9].map(|length| rtcm_frame(&claiming(number, length, 0)));
        assert!(module.receive(&short.concat()).is_empty());
        assert_eq!(module.grown("messages_malformed") as usize, short.len(), "{number}");
        module.recovers(&sky.lumps[module.second()]);
    }
    module.note();
    let halves: Vec<Vec<u8>> = frames(&sky.lumps[18])
        .iter()
        .map(|frame| rtcm_frame(&payload(frame)[..payload(frame).len() / 2]))
        .collect();
    assert!(module.receive(&halves.concat()).is_empty(), "half a message is no epoch");
    assert_eq!(module.grown("messages_malformed") as usize, halves.len());
    module.recovers(&sky.lumps[module.second()]);
}

#[test]
fn an_empty_frame_is_malformed() {
    let sky = Sky::quiet(4);
    let mut module = Module::after(&sky, 3);
    assert!(module.receive(&[rtcm_frame(&[]), rtcm_frame(&[0x43])].concat()).is_empty());
    assert_eq!(module.grown("messages_malformed"), 2);
    module.recovers(&sky.lumps[3]);
}
