//! A serial line, and the bytes that a port with another bit rate than the sender's reads on it.
//!
//! The idle line is high. A byte is a low bit, eight bits from the lowest on, and a high bit. A
//! port waits for the line to fall and then samples the middle of each of its own bits. Like the
//! ports of the boards, it does not check that the last bit is high.

/// A byte on the line: start of its first bit, ns; true if an epoch ends with it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sent {
    pub(super) start_ns: u64,
    pub(super) byte: u8,
    pub(super) is_end: bool,
}

/// Number of bits of a byte on the line.
const FRAME_BITS: u64 = 10;

const NS_PER_S: u64 = 1_000_000_000;

/// Returns the time of one byte, ns.
pub(super) const fn byte_ns(baud: u64) -> u64 {
    FRAME_BITS * NS_PER_S / baud
}

/// The line, and the position of its reader.
#[derive(Debug)]
pub(super) struct Wire {
    sent: Vec<Sent>,
    /// Rate of the sender, bit/s.
    baud: u64,
    /// Index of the first byte whose bits are not all past.
    at: usize,
    /// Time at which the port starts waiting for the line to fall, ns.
    from_ns: u64,
}

impl Wire {
    /// Returns a line with bytes in the order of time, none starting before the end of the one
    /// before it.
    pub(super) fn new(sent: Vec<Sent>, baud: u64) -> Self {
        Self { sent, baud, at: 0, from_ns: 0 }
    }

    /// Returns the end of the last byte, ns.
    pub(super) fn end_ns(&self) -> u64 {
        self.sent.last().map_or(0, |last| last.start_ns + byte_ns(self.baud))
    }

    /// Returns the next byte that a port at this rate reads, and its time, ns. At the right rate
    /// the end of an epoch is known.
    pub(super) fn next(&self, port_baud: u64) -> Option<(u64, u8, bool)> {
        let next = self.sent.get(self.at)?;
        if port_baud == self.baud {
            return Some((next.start_ns + byte_ns(self.baud), next.byte, next.is_end));
        }
        let edge_ns = self.next_fall_ns()?;
        let middle_ns = |bit: u64| edge_ns + (2 * bit + 1) * NS_PER_S / (2 * port_baud);
        let byte = (1..9).fold(0, |byte, bit| byte | u8::from(self.is_high(middle_ns(bit))) << (bit - 1));
        Some((edge_ns + byte_ns(port_baud), byte, false))
    }

    /// Advances past a byte that the port has read.
    pub(super) fn pass(&mut self, port_baud: u64) {
        if port_baud == self.baud {
            self.at += 1;
            return;
        }
        if let Some(edge_ns) = self.next_fall_ns() {
            // From the middle of the last bit on, it waits for the next byte to begin.
            self.from_ns = edge_ns + 19 * NS_PER_S / (2 * port_baud);
            let byte_ns = byte_ns(self.baud);
            let behind =
                self.sent[self.at..].iter().take_while(|sent| sent.start_ns + byte_ns <= self.from_ns);
            self.at += behind.count();
        } else {
            self.at = self.sent.len();
        }
    }

    /// Returns the time at which the line falls next, ns.
    fn next_fall_ns(&self) -> Option<u64> {
        let bit_ns = NS_PER_S / self.baud;
        self.sent.get(self.at..)?.iter().take(2).find_map(|sent| {
            let falls = (0..FRAME_BITS)
                .filter(|&bit| !level(sent.byte, bit) && (bit == 0 || level(sent.byte, bit - 1)));
            falls.map(|bit| sent.start_ns + bit * bit_ns).find(|&fall_ns| fall_ns >= self.from_ns)
        })
    }

    fn is_high(&self, at_ns: u64) -> bool {
        let sent = self.sent[self.at..].iter().take(64).take_while(|sent| sent.start_ns <= at_ns).last();
        sent.is_none_or(|sent| level(sent.byte, (at_ns - sent.start_ns) * self.baud / NS_PER_S))
    }
}

/// Returns the level of the line during a bit of a byte; high after the last.
fn level(byte: u8, bit: u64) -> bool {
    match bit {
        0 => false,
        1..9 => byte >> (bit - 1) & 1 == 1,
        _ => true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wire(bytes: &[u8], baud: u64) -> Wire {
        let sent = bytes.iter().enumerate().map(|(index, &byte)| Sent {
            start_ns: index as u64 * byte_ns(baud),
            byte,
            is_end: false,
        });
        Wire::new(sent.collect(), baud)
    }

    fn read(mut wire: Wire, port_baud: u64) -> Vec<u8> {
        let mut bytes = Vec::new();
        while let Some((_, byte, _)) = wire.next(port_baud) {
            bytes.push(byte);
            wire.pass(port_baud);
        }
        bytes
    }

    #[test]
    fn at_the_same_rate_all_is_read() {
        assert_eq!(read(wire(b"RAI", 38_400), 38_400), b"RAI");
    }

    #[test]
    fn a_port_twice_as_fast_reads_every_bit_twice() {
        // 0x55 is sent as 0 1010 1010 1. At twice the rate that is 00 11 00 11 00, whose eight bits
        // after the first are 0 11 00 11 0. The port then waits for the line to fall again: 0 11 00
        // 11 1 with the idle line.
        assert_eq!(read(wire(&[0x55], 9_600), 19_200), [0b0110_0110, 0b1110_0110]);
        // A byte of ones is a short low level and nothing else.
        assert_eq!(read(wire(&[0xFF], 9_600), 19_200), [0b1111_1110]);
    }

    #[test]
    fn a_slower_port_reads_fewer_bytes() {
        let have = read(wire(&[0xA7; 1000], 115_200), 38_400);
        assert!((200..=450).contains(&have.len()), "{}", have.len());
    }
}
