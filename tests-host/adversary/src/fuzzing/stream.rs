//! Target: the GNSS port.
//!
//! | byte | meaning |
//! |---|---|
//! | 0 | bit 0: frames keep their own checksum; otherwise each receives a correct one |
//! | 1 | pause after each 512 bytes, in 16 ms: up to four seconds |
//! | 2 … | input of the GNSS port |

use super::module::Module;
use super::sealing::seal_frames;
use super::tape::Tape;

/// Bytes between two pauses: an epoch of a few satellites.
const CHUNK: usize = 512;

/// Sends the bytes.
pub fn run(input: &[u8]) {
    let mut tape = Tape::new(input);
    let (keeps_check, pause_ms) = (tape.byte() & 1 == 1, u64::from(tape.byte()) * 16);
    let mut bytes = tape.rest().to_vec();
    if !keeps_check {
        seal_frames(&mut bytes);
    }
    let mut module = Module::new();
    for chunk in bytes.chunks(CHUNK) {
        module.receive(chunk, pause_ms);
    }
    module.receive(&[], 1000);
    module.adds_up();
}
