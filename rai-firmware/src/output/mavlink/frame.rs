//! Frames of `MAVLink` 2: `FD`, length, flags, number, sender, message, payload, checksum.
//!
//! The payload ends with its last nonzero byte, but has at least one byte. The checksum is
//! CRC-16/MCRF4XX of everything behind `FD`, and of one byte that identifies the layout.
//!
//! References: [MAVLINK], the guide.
//!
//! [MAVLINK]: crate#references

use heapless::Vec;

use super::dialect::Layout;

/// Longest payload here (`GPS_INPUT`), bytes.
const MAX_PAYLOAD: usize = 63;

/// Bytes of header and checksum.
const AROUND: usize = 12;

/// Sender: system 1, which is the vehicle, and its component for satellite navigation.
const SYSTEM: u8 = 1;
const COMPONENT_GPS: u8 = 220;

/// Message with its payload.
#[derive(Clone, Debug)]
pub(super) struct Frame {
    id: u32,
    crc_extra: u8,
    payload: Vec<u8, MAX_PAYLOAD>,
}

impl Frame {
    /// Returns a message with these values, one for each field of the layout, in the low bits of
    /// each.
    pub(super) fn of(layout: &Layout, values: &[u64]) -> Self {
        let mut payload = Vec::new();
        for ((_, kind), value) in layout.fields.iter().zip(values) {
            let bytes = value.to_le_bytes();
            // The capacity is that of the longest layout, which a test checks.
            let _ = payload.extend_from_slice(bytes.get(..kind.bytes()).unwrap_or_default());
        }
        Self { id: layout.id, crc_extra: layout.crc_extra, payload }
    }

    /// Returns the bytes of the frame with this sequence number.
    pub(super) fn numbered(&self, sequence: u8) -> Vec<u8, { MAX_PAYLOAD + AROUND }> {
        let length = self.payload.iter().rposition(|byte| *byte != 0).map_or(1, |last| last + 1);
        let [low, middle, high, _] = self.id.to_le_bytes();
        let mut bytes = Vec::new();
        // The capacity holds nine bytes behind the mark, the longest payload and two bytes of
        // checksum.
        let header = [0xFD, length as u8, 0, 0, sequence, SYSTEM, COMPONENT_GPS, low, middle, high];
        let _ = bytes.extend_from_slice(&header);
        let _ = bytes.extend_from_slice(self.payload.get(..length).unwrap_or_default());
        let mut sum = Checksum::new();
        bytes.iter().skip(1).for_each(|byte| sum.push(*byte));
        sum.push(self.crc_extra);
        let _ = bytes.extend_from_slice(&sum.value().to_le_bytes());
        bytes
    }
}

/// CRC-16/MCRF4XX; `MAVLink` calls it X.25.
pub(super) struct Checksum(u16);

impl Checksum {
    pub(super) const fn new() -> Self {
        Self(0xFFFF)
    }

    pub(super) fn push(&mut self, byte: u8) {
        let mixed = byte ^ self.0 as u8;
        let mixed = u16::from(mixed ^ mixed << 4);
        self.0 = self.0 >> 8 ^ mixed << 8 ^ mixed << 3 ^ mixed >> 4;
    }

    pub(super) const fn value(&self) -> u16 {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn checksum_is_that_of_the_catalogue() {
        let mut sum = Checksum::new();
        b"123456789".iter().for_each(|byte| sum.push(*byte));
        assert_eq!(sum.value(), 0x6F91);
    }
}
