//! A receiver's stream from standard input through the module; its sentences to standard output.
//!
//! `cargo run --package rai-firmware --example stream < capture.rtcm3`

use std::convert::Infallible;
use std::io::{self, Read as _, Write as _};
use std::time::Instant;

use embedded_hal::digital::{ErrorType, OutputPin};
use rai_firmware::receiver::{Boot, Receiver};

/// The integrity pin of a machine that has no pins.
#[derive(Default)]
struct Pin;

impl ErrorType for Pin {
    type Error = Infallible;
}

impl OutputPin for Pin {
    fn set_low(&mut self) -> Result<(), Infallible> {
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let boot = Boot::on_host("example");
    let mut receiver = Receiver::new(Pin, boot)?;
    let (start, mut said) = (Instant::now(), Vec::new());
    receiver.greet(&mut said);
    let mut bytes = [0; 1024];
    loop {
        let count = io::stdin().read(&mut bytes)?;
        let now_ms = start.elapsed().as_millis() as u64;
        receiver.gnss(bytes.get(..count).unwrap_or(&[]), now_ms, &mut said);
        // A silent line is noticed by the clock; a board calls this ten times a second.
        receiver.tick(now_ms, &mut said);
        io::stdout().write_all(&said)?;
        said.clear();
        if count == 0 {
            return Ok(());
        }
    }
}
