//! A host that reads too slowly: it misses whole sentences, never half of one, and the pin is not
//! affected.

use std::cell::{Cell, RefCell};

use raim::sentence::{self, Sentence};
use raim_firmware::outlet::Outlet;
use raim_firmware::output::nmea::MAX_LENGTH;
use raim_firmware::pin::MemoryPin;
use raim_firmware::receiver::{Boot, Receiver};
use raim_firmware::ring::Ring;

use super::module::Sky;

/// A wire that takes this many bytes a millisecond out of the ring, and keeps them.
struct Wire<'r> {
    ring: &'r Ring<4096>,
    bytes_per_ms: Cell<usize>,
    now_ms: Cell<u64>,
    taken: RefCell<Vec<u8>>,
}

impl Wire<'_> {
    /// Lets a millisecond pass.
    fn tick(&self) {
        let mut chunk = vec![0; self.bytes_per_ms.get()];
        let count = self.ring.read_into(&mut chunk);
        self.taken.borrow_mut().extend(&chunk[..count]);
        self.now_ms.set(self.now_ms.get() + 1);
    }
}

/// Counts the sentences read, after a check that each is valid: verdicts, and all.
fn verdicts(taken: &[u8]) -> (usize, usize) {
    let text = std::str::from_utf8(taken).expect("sentences are ASCII");
    let read: Vec<Sentence> =
        text.lines().map(|line| sentence::parse(line).expect("no half sentence")).collect();
    (read.iter().filter(|read| matches!(read, Sentence::State(_))).count(), read.len())
}

#[test]
fn a_starved_host_misses_whole_sentences_and_the_pin_does_not_suffer() {
    const STARVED: std::ops::Range<usize> = 10..40;
    let sky = Sky::quiet(60);
    let ring = Ring::<4096>::new();
    let wire =
        Wire { ring: &ring, bytes_per_ms: Cell::new(11), now_ms: Cell::new(0), taken: RefCell::default() };
    let boot = Boot::on_host("slow");
    let mut receiver = Receiver::new(MemoryPin::default(), boot).unwrap();
    let mut outlet = Outlet::new(&ring, || ());
    for (turn, lump) in sky.lumps.iter().enumerate() {
        // 115200 baud are 11 bytes a millisecond; a busy host takes none.
        wire.bytes_per_ms.set(if STARVED.contains(&turn) { 0 } else { 11 });
        receiver.gnss(lump, wire.now_ms.get(), &mut outlet);
        assert!(receiver.pin().high, "epoch {turn} is healthy, whoever listens");
        for _ in 0..600 {
            wire.tick();
        }
    }
    let (verdicts, sentences) = verdicts(&wire.taken.borrow());
    assert!(ring.dropped() > 0 && verdicts < sky.lumps.len(), "{} bytes dropped", ring.dropped());
    // The ring holds some epochs of the starvation; those before and after it are complete.
    assert!(verdicts >= sky.lumps.len() - STARVED.len(), "{verdicts} verdicts in {sentences} sentences");
    assert!(ring.high_water() > 4096 - MAX_LENGTH, "the ring was full: {}", ring.high_water());
}
