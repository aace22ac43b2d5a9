//! Streams in which every message announces that more of its epoch follow, as casters of a single
//! system send them: a silent line completes the epoch.

use raim::replay::{self, Pace, Window};
use raim::sentence;
use raim::signal::capture::Capture;
use raim::signal::checksum::crc24q;
use raim::signal::encode::{Encoder, Frequency, Selection};
use raim::signal::pieces::pieces;
use raim::signal::sky::Fleet;
use raim::signal::sky::raw::Simulation;
use raim::verdict::EpochOutput;
use raim_firmware::pin::MemoryPin;
use raim_firmware::receiver::{Boot, Receiver};

/// Interval between two ticks of the module, ms.
const TICK_MS: u64 = 100;

/// Number of epochs of each stream.
const EPOCHS: u32 = 8;

/// Returns the bytes of each epoch of GPS and Galileo, as frames that all announce more.
fn stream(step_s: f64) -> Vec<Vec<Vec<u8>>> {
    let simulation = Simulation {
        satellites: [Fleet::Gps31, Fleet::Galileo24].iter().flat_map(|fleet| fleet.satellites()).collect(),
        step_s,
        ..Simulation::above_xian(3600.0, EPOCHS, 5)
    };
    let recording = simulation.record();
    let selection = Selection::new("GE", Frequency::Dual).unwrap();
    let mut encoder = Encoder::new(&recording.ephemerides, selection);
    let frames = |bytes: &[u8]| {
        pieces(bytes)
            .map(|piece| if piece.kind.has_ranges() { announcing(piece.bytes) } else { piece.bytes.to_vec() })
            .collect()
    };
    recording.epochs.iter().map(|epoch| frames(&encoder.epoch(epoch).unwrap())).collect()
}

/// Returns an MSM with its multiple message bit set, which is the 55th of the payload.
fn announcing(frame: &[u8]) -> Vec<u8> {
    let mut frame = frame.to_vec();
    frame[3 + 54 / 8] |= 0x80 >> (54 % 8);
    let check = frame.len() - 3;
    let parity = crc24q(&frame[..check]);
    frame[check..].copy_from_slice(&parity);
    frame
}

/// The module on a line: bytes in time, and ticks.
struct Line {
    receiver: Receiver<MemoryPin>,
    reported: Vec<u8>,
    now_ms: u64,
}

impl Line {
    fn new() -> Self {
        let receiver = Receiver::new(MemoryPin::default(), Boot::on_host("open epochs")).unwrap();
        Self { receiver, reported: Vec::new(), now_ms: 0 }
    }

    /// Lets time pass until an instant, with ticks.
    fn wait_until(&mut self, until_ms: u64) {
        while self.now_ms < until_ms {
            self.now_ms = until_ms.min((self.now_ms / TICK_MS + 1) * TICK_MS);
            if self.now_ms.is_multiple_of(TICK_MS) {
                self.receiver.tick(self.now_ms, &mut self.reported);
            }
        }
    }

    fn receive(&mut self, bytes: &[u8]) {
        self.receiver.gnss(bytes, self.now_ms, &mut self.reported);
    }

    /// Returns the epochs judged since the last call.
    fn judged(&mut self) -> Vec<EpochOutput> {
        let text = String::from_utf8(std::mem::take(&mut self.reported)).unwrap();
        let epochs = sentence::epochs(&text).unwrap();
        epochs.into_iter().filter(|epoch| epoch.state.has_epoch()).collect()
    }
}

#[test]
fn each_epoch_is_promised_before_the_next_one_comes_a_minute_later() {
    let mut line = Line::new();
    for (index, frames) in stream(60.0).iter().enumerate() {
        let begin_ms = 60_000 * index as u64;
        line.wait_until(begin_ms);
        assert!(line.judged().is_empty(), "epoch {index}");
        line.receive(&frames.concat());
        line.wait_until(begin_ms + 400);
        assert!(line.judged().is_empty(), "epoch {index} may go on");
        line.wait_until(begin_ms + 600);
        let judged = line.judged();
        assert!(
            matches!(judged.as_slice(), [epoch] if epoch.state.is_protected()),
            "epoch {index}: {judged:?}"
        );
        assert!(line.receiver.pin().high);
    }
}

#[test]
fn epoch_on_a_slow_line_waits_for_its_last_byte() {
    /// Time of a byte at 9,600 baud, µs.
    const BYTE_US: usize = 1042;
    let mut line = Line::new();
    let mut used = Vec::new();
    for (index, frames) in stream(5.0).iter().enumerate() {
        let (begin_ms, bytes) = (5000 * index as u64, frames.concat());
        for (number, chunk) in bytes.chunks(16).enumerate() {
            line.wait_until(begin_ms + (16 * number * BYTE_US / 1000) as u64);
            line.receive(chunk);
            assert!(line.judged().is_empty(), "epoch {index}, byte {}", 16 * number);
        }
        line.wait_until(line.now_ms + 700);
        let judged = line.judged();
        assert_eq!(judged.len(), 1, "epoch {index}");
        used.push(judged[0].state.tracked);
    }
    let whole: Vec<_> = stream(5.0)
        .iter()
        .map(|frames| {
            let mut line = Line::new();
            line.receive(&stream(5.0)[0].concat());
            line.receive(&frames.concat());
            line.wait_until(700);
            line.judged().last().unwrap().state.tracked
        })
        .collect();
    assert_eq!(used, whole);
}

#[test]
fn packet_that_comes_after_the_silence_is_no_second_epoch() {
    let mut line = Line::new();
    let mut judged = Vec::new();
    for (index, frames) in stream(3.0).iter().enumerate() {
        let begin_ms = 3000 * index as u64;
        line.wait_until(begin_ms);
        let (late, first) = frames.split_last().unwrap();
        line.receive(&first.concat());
        line.wait_until(begin_ms + 900);
        line.receive(late);
        line.wait_until(begin_ms + 2900);
        judged.extend(line.judged());
    }
    let times: Vec<_> = judged.iter().map(|epoch| epoch.state.time_s.unwrap()).collect();
    assert!(times.windows(2).all(|pair| pair[1] > pair[0]), "{times:?}");
    // After the first one, epochs are complete only with the next: the last is still open.
    assert_eq!(times.len(), EPOCHS as usize - 1);
    let tracked: Vec<_> = judged.iter().map(|epoch| epoch.state.tracked).collect();
    let first = tracked[0];
    assert!(tracked[1..].iter().all(|tracked| *tracked > first), "{tracked:?}");
}

#[test]
fn capture_is_replayed_with_every_epoch_in_its_time() {
    for step_s in [1.0, 60.0] {
        let bytes = stream(step_s).concat().concat();
        let capture = Capture::of(bytes, None).unwrap();
        let lumps = capture.lumps(&[], &Window::ALL).unwrap().lumps;
        let elapsed_s: Vec<f64> = lumps.iter().map(|lump| lump.elapsed_s).collect();
        let want_s: Vec<f64> = (0..EPOCHS).map(|index| f64::from(index) * step_s).collect();
        assert_eq!(elapsed_s, want_s);
        let run = replay::on_host(&lumps, &[], Pace::Recorded, |_| ()).unwrap();
        for (index, reported) in run.reported.iter().enumerate() {
            let output = reported.output();
            assert!(
                output.is_some_and(|output| output.state.is_protected()),
                "step {step_s} s, epoch {index}"
            );
        }
        // A capture whose epochs end by silence can be thinned.
        let window = Window { every_s: 2.0 * step_s, ..Window::ALL };
        assert_eq!(capture.lumps(&[], &window).unwrap().lumps.len(), EPOCHS.div_ceil(2) as usize);
    }
}
