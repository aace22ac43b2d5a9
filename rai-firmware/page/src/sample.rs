//! A minute of a simulated receiver, for whoever has no recording at hand.
//!
//! Three systems above Xi'an, two frequencies, 1 Hz, RTCM 3. A simulated sky needs nobody's licence,
//! and gives the same bytes in every build.

use anyhow::Result;
use raim::replay::{Window, encode};
use raim::signal::encode::{Frequency, Selection};
use raim::signal::sky::Fleet;
use raim::signal::sky::raw::Simulation;

/// Name of the file.
pub(crate) const NAME: &str = "sample.rtcm3";

/// Number of epochs, one a second.
const EPOCHS: u32 = 60;

/// Returns the bytes of the receiver.
///
/// # Errors
/// A number does not fit its message.
pub(crate) fn bytes() -> Result<Vec<u8>> {
    let fleets = [Fleet::Gps31, Fleet::Galileo24, Fleet::Beidou24];
    let satellites = fleets.into_iter().flat_map(Fleet::satellites).collect();
    let recording = Simulation { satellites, ..Simulation::above_xian(3600.0, EPOCHS, 5) }.record();
    let lumps = encode(&recording, &Selection::new("GCE", Frequency::Dual)?, &[], &Window::ALL)?;
    Ok(lumps.into_iter().flat_map(|lump| lump.bytes).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sample_is_a_capture_of_a_few_kilobytes() {
        let bytes = bytes().unwrap();
        assert!(raim::signal::capture::has_frames(&bytes));
        assert!(bytes.len() < 200_000, "{}", bytes.len());
    }
}
