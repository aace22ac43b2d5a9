//! Smallest program around the module: reads a receiver's bytes from standard input and writes
//! sentences to standard output.
//!
//! `cargo run --package raim-firmware --example stream < capture.rtcm3`
//!
//! A thread reads, because the module must check the clock while the line is silent: without a byte
//! it reports `STALE` and sets the pin low.

use std::io::{self, Read as _, Write as _};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::{Duration, Instant};

use raim_firmware::pin::MemoryPin;
use raim_firmware::receiver::{Boot, Receiver};

/// Interval between two ticks of the module.
const TICK: Duration = Duration::from_millis(100);

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut receiver = Receiver::new(MemoryPin::default(), Boot::on_host("example"))?;
    let (start, mut sentences) = (Instant::now(), Vec::new());
    receiver.greet(&mut sentences);
    let (send, arrivals) = channel();
    thread::spawn(move || {
        let mut bytes = [0; 1024];
        // The channel closes with this thread, and the program ends with the channel.
        while let Ok(count @ 1..) = io::stdin().read(&mut bytes) {
            if send.send((bytes[..count].to_vec(), start.elapsed())).is_err() {
                return;
            }
        }
    });
    loop {
        let arrival = arrivals.recv_timeout(TICK);
        let now_ms = start.elapsed().as_millis() as u64;
        match &arrival {
            Ok((bytes, came)) => {
                receiver.gnss_since(bytes, came.as_millis() as u64, now_ms, &mut sentences);
            }
            Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => {}
        }
        receiver.tick(now_ms, &mut sentences);
        io::stdout().write_all(&sentences)?;
        sentences.clear();
        if arrival == Err(RecvTimeoutError::Disconnected) {
            return Ok(());
        }
    }
}
