//! A receiver that returns as another source, and one that sends everything twice.

use raim::signal::checksum::rtcm_frame;
use raim::signal::encode::{Encoder, Frequency, Selection};
use raim::signal::pieces::{Kind, pieces};
use raim::signal::sky::raw::Simulation;

use super::module::{Module, Sky};

/// Returns the frames with another station number in those of ranges.
fn renumbered(bytes: &[u8], station: u16) -> Vec<u8> {
    let renumber = |frame: &[u8]| {
        let mut payload = frame[3..frame.len() - 3].to_vec();
        payload[1] = payload[1] & 0xF0 | (station >> 8) as u8;
        payload[2] = station as u8;
        rtcm_frame(&payload)
    };
    let altered = pieces(bytes).map(|piece| match piece.kind {
        Kind::Rtcm(1071..=1137) => renumber(piece.bytes),
        _ => piece.bytes.to_vec(),
    });
    altered.flatten().collect()
}

#[test]
fn receiver_that_returns_under_another_number_is_named_and_taken_after_forget() {
    let sky = Sky::quiet(40);
    let mut module = Module::after(&sky, 10);
    let mut reasons = Vec::new();
    for lump in &sky.lumps[10..30] {
        reasons
            .extend(module.receive(&renumbered(lump, 5)).into_iter().map(|reported| reported.state.reason));
    }
    assert_eq!(reasons, ["SOURCE"; 2], "every ten seconds after the last epoch");
    assert!(!module.pin_is_high() && module.grown("observations_doubled") > 0);
    let mut answer = Vec::new();
    module.receiver.command(b"$PRAIC,FORGET*68\r\n", &mut answer);
    assert!(String::from_utf8(answer).unwrap().contains("FORGET,OK"));
    for lump in &sky.lumps[30..] {
        module.recovers(&renumbered(lump, 5));
    }
}

#[test]
fn one_repeat_in_ten_at_ten_hertz_costs_no_promise() {
    let mut simulation = Simulation::above_xian(3600.0, 200, 11);
    simulation.step_s = 0.1;
    let recording = simulation.record();
    let mut encoder = Encoder::new(&recording.ephemerides, Selection::new("GC", Frequency::Dual).unwrap());
    let mut lumps: Vec<Vec<u8>> = Vec::new();
    for (index, epoch) in recording.epochs.iter().enumerate() {
        let mut epoch = epoch.clone();
        if index % 10 == 9 {
            epoch.satellites.clone_from(&recording.epochs[index - 1].satellites);
        }
        lumps.push(encoder.epoch(&epoch).unwrap());
    }
    let mut module = Module::new(&Sky { site: simulation.site, lumps: Vec::new() });
    let (mut reported, mut text) = (0, Vec::new());
    for (index, lump) in lumps.iter().enumerate() {
        text.clear();
        module.receiver.gnss(lump, 100 * index as u64, &mut text);
        let outputs = raim::sentence::epochs(std::str::from_utf8(&text).unwrap()).unwrap();
        assert!(outputs.iter().all(|output| output.state.is_protected()), "epoch {index}: {outputs:?}");
        reported += outputs.len();
    }
    assert_eq!((reported, module.grown("epochs_repeated")), (180, 20));
    assert_eq!(module.grown("epochs_alert") + module.grown("epochs_unavailable"), 0);
}
