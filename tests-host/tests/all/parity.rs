//! The board against the host: the same input gives the same output, and an epoch stays within its
//! cost.

use std::time::Duration;

use raim::pin::Pin;
use raim::signal::encode::{Encoder, Frequency, Selection};
use raim::signal::sky::raw::Simulation;
use raim_firmware::receiver::{Boot, Receiver};
use rig::board::{EmulatedBoard, is_installed};
use rig::image::{self, CompiledFor};
use rig::lockstep::is_said_by_the_clock;

const PATIENCE: Duration = Duration::from_mins(1);
/// Largest cost of an epoch of twenty satellites on the chip, instructions.
const EPOCH_INSTRUCTIONS: u64 = 4_000_000;
/// The same if it is compiled for size: the first, with the ephemerides, costs three times the
/// others.
const EPOCH_INSTRUCTIONS_FOR_SIZE: u64 = 1_500_000;
/// Largest stack, bytes: half of what the image must leave for it.
const STACK_BYTES: u64 = image::STACK_BUDGET_BYTES / 2;

/// Returns epochs of GPS and `BeiDou` above one place, a lump of bytes for each epoch.
fn lumps(epochs: u32) -> Vec<Vec<u8>> {
    let recording = Simulation::above_xian(0.0, epochs, 7).record();
    let selection = Selection::new("GC", Frequency::Dual).expect("two systems");
    let mut encoder = Encoder::new(&recording.ephemerides, selection);
    recording.epochs.iter().map(|epoch| encoder.epoch(epoch).expect("an epoch that can be sent")).collect()
}

fn on_host(lumps: &[Vec<u8>]) -> (Vec<u8>, Vec<bool>) {
    let boot = Boot::on_host("parity");
    let mut receiver = Receiver::new(Pin::default(), boot).expect("a receiver");
    let mut sentences = Vec::new();
    let levels = lumps.iter().map(|lump| {
        receiver.gnss(lump, 0, &mut sentences);
        receiver.pin().high
    });
    let levels = levels.collect();
    (sentences, levels)
}

#[test]
fn board_says_what_the_host_says_within_its_budget() {
    says_what_the_host_says_within(EPOCH_INSTRUCTIONS, CompiledFor::Speed);
}

#[test]
fn image_for_size_says_what_the_host_says_within_its_budget() {
    says_what_the_host_says_within(EPOCH_INSTRUCTIONS_FOR_SIZE, CompiledFor::Size);
}

fn says_what_the_host_says_within(epoch_instructions: u64, compiled_for: CompiledFor) {
    if !is_installed() {
        return;
    }
    let lumps = lumps(20);
    let (want, pin_levels) = on_host(&lumps);
    let image = image::build_compiled_for(compiled_for).expect("the image builds");
    let mut board = EmulatedBoard::start(&image).expect("the board starts");
    board.read_through("$PRAIV", PATIENCE).expect("the board greets");
    let start = std::time::Instant::now();
    let mut have = Vec::new();
    for lump in &lumps {
        board.feed(lump).expect("the board takes an epoch");
        let lines = board.read_through("$PRAIN", PATIENCE).expect("the board judges an epoch");
        have.extend(lines.into_iter().filter(|line| !is_said_by_the_clock(line)));
    }
    assert_eq!(have.concat(), String::from_utf8_lossy(&want));
    assert!(pin_levels.contains(&true), "a healthy sky raises the pin on the host");
    board
        .log_with(&format!("epoch {} took", lumps.len()), 0, PATIENCE)
        .expect("the last epoch's cost is logged");
    assert_eq!(Some(&board.pin_is_high()), pin_levels.last(), "the pin, board and host");
    let cost = board.epoch_instructions();
    let worst = cost.iter().max().copied().unwrap_or(u64::MAX);
    let mean = cost.iter().sum::<u64>() / cost.len() as u64;
    println!("{:.1} kB in {:.1} s", lumps.concat().len() as f64 / 1e3, start.elapsed().as_secs_f64());
    println!("instructions per epoch: {mean} in the mean, {worst} at most, over {}", cost.len());
    assert!(worst <= epoch_instructions, "{cost:?}");
    let stack =
        board.log().iter().filter_map(rig::board::LogLine::stack_bytes).max().expect("a stack report");
    println!("stack high water: {stack} bytes");
    assert!(stack <= STACK_BYTES, "{stack} bytes");
    assert!(!board.log().iter().any(|line| line.text.contains("lost")), "{:?}", board.log());
}
