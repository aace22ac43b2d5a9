//! The board against the host: the same input gives the same output with every named image, and an
//! epoch stays within its cost.

use std::path::Path;
use std::time::Duration;

use raim::replay::{self, Window};
use raim::signal::encode::{Frequency, Selection};
use raim::signal::fault::Fault;
use raim::signal::sky::raw::Simulation;
use raim_firmware::output::schedule::Item;
use raim_firmware::pin::MemoryPin;
use raim_firmware::receiver::{Boot, Receiver};
use rig::board::{EmulatedBoard, is_installed};
use rig::image::{CompiledFor, NAMED, Named};
use rig::lockstep::is_said_by_the_clock;

const PATIENCE: Duration = Duration::from_mins(1);
/// Number of epochs, of which the middle ones have a faulty satellite.
const EPOCHS: u32 = 20;

/// Returns the largest cost of an epoch on the chip, instructions. The first one, with the
/// ephemerides, costs three times the others.
const fn most_instructions(compiled_for: CompiledFor) -> u64 {
    match compiled_for {
        CompiledFor::Speed => 1_000_000,
        CompiledFor::Size => 1_500_000,
    }
}

/// Returns epochs above one place, a lump of bytes for each epoch: of GPS and `BeiDou` with twenty
/// satellites if the image has room for them, otherwise of GPS.
fn lumps(satellites: usize) -> Vec<Vec<u8>> {
    let simulation = Simulation::above_xian(0.0, EPOCHS, 7);
    let faulty = simulation.sights_at(0).first().expect("a satellite in view").satellite;
    let fault = Fault::parse_inject(&format!("{faulty}:+150@8..13")).expect("a fault");
    let systems = if satellites < 20 { "G" } else { "GC" };
    let selection = Selection::new(systems, Frequency::Dual).expect("systems");
    let lumps = replay::encode(&simulation.record(), &selection, &[fault], &Window::ALL);
    lumps.expect("epochs that can be sent").into_iter().map(|lump| lump.bytes).collect()
}

/// Returns the sentences of the host, and the level of its pin after each lump.
///
/// The host has every part. It sends no sentence that a small image lacks.
fn on_host(named: &Named, lumps: &[Vec<u8>]) -> (String, Vec<bool>) {
    let boot = Boot::on_host("parity");
    let mut receiver = Receiver::new(MemoryPin::default(), boot).expect("a receiver");
    let others = Item::NAMES.iter().filter(|name| !named.is_whole() && !["RMC", "GGA"].contains(name));
    for name in others {
        let rate = format!("{name},0");
        receiver.set("OUTPUT", Some(&rate), &mut Vec::new()).expect("a rate of an item");
    }
    let mut sentences = Vec::new();
    let levels = lumps.iter().map(|lump| {
        receiver.gnss(lump, 0, &mut sentences);
        receiver.pin().high
    });
    let levels = levels.collect();
    (String::from_utf8(sentences).expect("ASCII"), levels)
}

#[test]
fn every_named_image_says_what_the_host_says_within_its_budget() {
    if is_installed() {
        NAMED.iter().for_each(says_what_the_host_says);
    }
}

/// Feeds the lumps to an image, and returns its sentences and the board as it is then.
fn on_board(image: &Path, lumps: &[Vec<u8>]) -> (String, EmulatedBoard) {
    let mut board = EmulatedBoard::start(image).expect("the board starts");
    board.read_through("$PRAIV", PATIENCE).expect("the board greets");
    let mut have = String::new();
    for lump in lumps {
        board.feed(lump).expect("the board takes an epoch");
        let lines = board.read_through("$PRAIN", PATIENCE).expect("the board judges an epoch");
        have.extend(lines.into_iter().filter(|line| !is_said_by_the_clock(line)));
    }
    (have, board)
}

/// The host has room for 48 satellites and all features. The bytes of a smaller image are the same.
/// An image without a log is replayed as it is, and again with a log, which shows the rest.
fn says_what_the_host_says(named: &Named) {
    println!("image {}", named.name);
    let lumps = lumps(named.satellites);
    let (want, pin_levels) = on_host(named, &lumps);
    let start = std::time::Instant::now();
    let image = named.build_with_log().expect("the image builds");
    let (have, mut board) = on_board(&image, &lumps);
    // `small` does not learn the noise of the receiver, so that later epochs have other levels.
    let compared = |reported: &str| {
        let first = reported.split_inclusive("$PRAIN").next().unwrap_or_default();
        if named.is_whole() { reported.to_owned() } else { first.to_owned() }
    };
    assert_eq!(compared(&have), compared(&want), "image {}", named.name);
    assert!(want.contains("$PRAIX") && want.contains(",P,OK,"), "a satellite is excluded, then used again");
    assert!(pin_levels.contains(&true), "a healthy sky raises the pin on the host");
    board
        .log_with(&format!("epoch {} took", lumps.len()), 0, PATIENCE)
        .expect("the last epoch's cost is logged");
    assert_eq!(Some(&board.pin_is_high()), pin_levels.last(), "the pin, board and host");
    // Building may take longer than the time to alert, after which the board that waits lowers its pin.
    if !named.is_whole() {
        let (have, _) = on_board(&named.build().expect("the image builds"), &lumps);
        assert_eq!(compared(&have), compared(&want), "image {} without a log", named.name);
    }
    let cost = board.epoch_instructions();
    let worst = cost.iter().max().copied().unwrap_or(u64::MAX);
    let mean = cost.iter().sum::<u64>() / cost.len() as u64;
    println!("{:.1} kB in {:.1} s", lumps.concat().len() as f64 / 1e3, start.elapsed().as_secs_f64());
    println!("instructions per epoch: {mean} in the mean, {worst} at most, over {}", cost.len());
    assert!(worst <= most_instructions(named.compiled_for), "{cost:?}");
    let stack =
        board.log().iter().filter_map(rig::board::LogLine::stack_bytes).max().expect("a stack report");
    println!("stack high water: {stack} bytes");
    assert!(stack <= named.stack_bytes, "{stack} bytes");
    assert!(!board.log().iter().any(|line| line.text.contains("lost")), "{:?}", board.log());
}
