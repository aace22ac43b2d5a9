//! Tags of a satellite's `MACK` message.
//!
//! `tag₀ 40 | MACSEQ 12 | COP 4 | (tag 40 | PRND 8 | ADKD 4 | COP 4) × 5 | key 128 | zeros 16`
//!
//! ```text
//! tag₀      first bits of HMAC(K, PRNA 8 | GST 32 | 1 | NMAS 2 | words)
//! tag       first bits of HMAC(K, PRND 8 | PRNA 8 | GST 32 | slot 8 | NMAS 2 | words)
//! MACSEQ    first bits of HMAC(K, PRNA 8 | GST 32 | what the flexible slots state)
//! ```
//!
//! `K` is the key of the next subframe, for ADKD 12 of the eleventh behind. The words are those of the
//! subframe before.
//!
//! Reference: [OSNMA-ICD] 3.3, 6.6, 6.7.
//!
//! [OSNMA-ICD]: raim_firmware#references

use hmac::{Hmac, Mac as _};
use sha2::Sha256;

use super::{Bits, SUBFRAME_S, System, gst};

/// Number of the sequence of tags.
pub(super) const SEQUENCE: u64 = 34;

/// Its slots behind the first, by half of the minute.
const SLOTS: [[&str; 5]; 2] = [["FLX", "04S", "FLX", "12S", "00E"], ["FLX", "00E", "12S", "00E", "12E"]];

/// Word, first bit and number of bits that a tag of orbit and clock is about, and of time parameters.
const ORBIT: [(u8, usize, usize); 5] = [(1, 6, 120), (2, 6, 120), (3, 6, 122), (4, 6, 120), (5, 6, 67)];
const TIMING: [(u8, usize, usize); 2] = [(6, 6, 99), (10, 86, 42)];

impl System {
    /// Returns the message of a satellite.
    pub(super) fn mack(&self, sender: u8, subframe: u32) -> Vec<u8> {
        let place = self.satellites.iter().position(|satellite| *satellite == sender).unwrap_or_default();
        let other = |by: usize| self.satellites[(place + by) % self.satellites.len()];
        let (mut infos, mut tags) = (Vec::new(), Vec::new());
        let mut sequence = Bits::default().put(sender.into(), 8).put_all(&gst(subframe));
        for (index, slot) in SLOTS[(subframe % 2) as usize].iter().enumerate() {
            let (subject, adkd) = match *slot {
                "FLX" => (other(index + 1), 0),
                "04S" => (sender, 4),
                "12S" => (sender, 12),
                "12E" => (other(2), 12),
                _ => (other(index), 0),
            };
            // Word 10 comes in every second subframe.
            let cop = if adkd == 4 { 2 } else { 1 };
            let info = Bits::default().put(subject.into(), 8).put(adkd.into(), 4).put(cop, 4);
            if *slot == "FLX" {
                sequence.0.extend(&info.0);
            }
            tags.push(self.tag(sender, subject, adkd, index as u64 + 2, subframe));
            infos.push(info);
        }
        let sequence = first_40(self.key(subframe + 1), &sequence.bytes()) >> 28;
        let mut mack =
            Bits::default().put(self.tag(sender, sender, 0, 1, subframe), 40).put(sequence, 12).put(1, 4);
        for (tag, info) in tags.into_iter().zip(infos) {
            mack = mack.put(tag, 40);
            mack.0.extend(info.0);
        }
        mack.put_all(self.key(subframe)).put(0, 16).bytes()
    }

    fn tag(&self, sender: u8, subject: u8, adkd: u8, slot: u64, subframe: u32) -> u64 {
        let mut message = Bits::default();
        if slot > 1 {
            message = message.put(subject.into(), 8);
        }
        let status = self.phase(subframe).header >> 6;
        message = message.put(sender.into(), 8).put_all(&gst(subframe)).put(slot, 8).put(status.into(), 2);
        message.0.extend(self.about(subject, adkd, subframe - 1));
        let delay = if adkd == 12 { 11 } else { 1 };
        first_40(self.key(subframe + delay), &message.bytes())
    }

    /// Returns the bits that a tag is about.
    fn about(&self, satellite: u8, adkd: u8, subframe: u32) -> Vec<bool> {
        let places: &[_] = if adkd == 4 { &TIMING } else { &ORBIT };
        let bits = |&(kind, start, count): &(u8, usize, usize)| {
            let word = self.words.word(satellite, kind, subframe * SUBFRAME_S + 1);
            Bits::default().put_all(&word).0[start..start + count].to_vec()
        };
        places.iter().flat_map(bits).collect()
    }
}

fn first_40(key: &[u8], message: &[u8]) -> u64 {
    let mut code = Hmac::<Sha256>::new_from_slice(key).expect("any key");
    code.update(message);
    code.finalize().into_bytes()[..5].iter().fold(0, |value, byte| value << 8 | u64::from(*byte))
}
