//! The second board: a Cortex-M7 with doubles in hardware sends the host's sentences, byte for
//! byte.

use std::time::Duration;

use raim::signal::encode::{Encoder, Frequency, Selection};
use raim::signal::sky::raw::Simulation;
use raim_firmware::pin::MemoryPin;
use raim_firmware::receiver::{Boot, Receiver};
use rig::board::{EmulatedBoard, LogLine, Machine, Settings, is_installed};
use rig::image;

const PATIENCE: Duration = Duration::from_mins(2);

fn lumps(epochs: u32) -> Vec<Vec<u8>> {
    let recording = Simulation::above_xian(3600.0, epochs, 11).record();
    let mut encoder = Encoder::new(&recording.ephemerides, Selection::new("GC", Frequency::Dual).unwrap());
    recording.epochs.iter().map(|epoch| encoder.epoch(epoch).unwrap()).collect()
}

/// Returns the verdicts of the module in process.
fn on_host(lumps: &[Vec<u8>]) -> Vec<String> {
    let boot = Boot::on_host("host");
    let mut receiver = Receiver::new(MemoryPin::default(), boot).expect("the module starts");
    let mut reported = Vec::new();
    for lump in lumps {
        receiver.gnss(lump, 0, &mut reported);
    }
    of_epochs(String::from_utf8(reported).expect("sentences are ASCII").lines())
}

/// Returns only the sentences of epochs, because the timing of the others depends on the start of
/// the board.
fn of_epochs<'l>(lines: impl Iterator<Item = &'l str>) -> Vec<String> {
    const KINDS: [&str; 7] = ["$GNRMC", "$GNGGA", "$GNGNS", "$GNGST", "$GNGBS", "$PRAIS", "$PRAIX"];
    lines.filter(|line| KINDS.iter().any(|kind| line.starts_with(kind))).map(str::to_owned).collect()
}

fn on_board(machine: Machine, lumps: &[Vec<u8>]) -> (Vec<String>, Vec<u64>) {
    let image = image::build_for(machine).expect("an image");
    let settings = Settings { machine, ..Settings::default() };
    let mut board = EmulatedBoard::start_with(&image, &settings).expect("the emulator starts");
    board.read_through("$PRAIV", PATIENCE).expect("the board greets");
    let mut reported = Vec::new();
    for lump in lumps {
        board.feed(lump).expect("the board takes bytes");
        reported.extend(board.read_through("$PRAIS", PATIENCE).expect("the board judges an epoch"));
    }
    board.log_with(&format!("epoch {} took", lumps.len()), 0, PATIENCE).expect("the cost is logged");
    let ticks: Vec<u64> = board.log().iter().filter_map(LogLine::epoch_ticks).collect();
    board.stop().expect("the board ran to its end");
    let instructions = ticks.iter().map(|ticks| ticks * 1_000_000_000 / machine.tick_hz()).collect();
    (of_epochs(reported.iter().map(|line| line.trim_end())), instructions)
}

#[test]
fn a_replay_over_the_second_board_gives_the_same_bytes() {
    if !is_installed() {
        return;
    }
    let lumps = lumps(20);
    let want = on_host(&lumps);
    let (have, instructions) = on_board(Machine::Mps2An500, &lumps);
    assert!(want.iter().any(|line| line.contains(",P,OK,")), "{want:?}");
    assert_eq!(have, want);
    let largest = instructions.iter().skip(1).max().copied().unwrap_or(0);
    println!("instructions of an epoch on the Cortex-M7: at most {largest} after the first");
    assert!(largest > 10_000, "an epoch costs something: {instructions:?}");
}
