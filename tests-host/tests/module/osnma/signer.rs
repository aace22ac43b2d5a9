//! A system that signs its navigation data as Galileo does, with a key of its own.
//!
//! It is written from the interface document beside the module's reader, with other crates for the
//! codes and the curve. That the format is right is shown by recordings and official vectors; this sky
//! shows the rules.

use hmac::{Hmac, Mac as _};
use p256::elliptic_curve::PrimeField as _;
use p256::elliptic_curve::ops::Reduce;
use p256::elliptic_curve::sec1::ToEncodedPoint as _;
use p256::{ProjectivePoint, Scalar, U256};
use sha2::{Digest as _, Sha256};

/// Week and hour of the root key.
const WEEK: u32 = 1339;
const HOUR: u32 = 120;

/// Subframe of the root key, half minutes since the start of Galileo system time.
pub(super) const ROOT: u32 = WEEK * 20_160 + HOUR * 120 - 1;

/// Number of keys behind the root key.
const KEYS: u32 = 400;

/// Sequence 34: the slots behind the first, by half of the minute.
const SLOTS: [[&str; 5]; 2] = [["FLX", "04S", "FLX", "12S", "00E"], ["FLX", "00E", "12S", "00E", "12E"]];

/// Types of the words of a subframe.
const WORDS: [u8; 15] = [2, 4, 6, 7, 8, 0, 0, 0, 0, 0, 1, 3, 5, 0, 0];

/// Bits of an unsigned number, appended to others.
#[derive(Clone, Default)]
struct Bits(Vec<bool>);

impl Bits {
    fn put(mut self, value: u64, width: usize) -> Self {
        self.0.extend((0..width).rev().map(|bit| value >> bit & 1 == 1));
        self
    }

    fn bytes(&self) -> Vec<u8> {
        let byte = |bits: &[bool]| {
            bits.iter().enumerate().fold(0, |byte, (place, bit)| byte | u8::from(*bit) << (7 - place))
        };
        self.0.chunks(8).map(byte).collect()
    }
}

/// A page, as a receiver passes it on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Page {
    pub(super) satellite: u8,
    /// Second since the start of Galileo system time at which it begins.
    pub(super) begin_s: u32,
    pub(super) word: [u8; 16],
    pub(super) bits: [u8; 5],
}

/// The system.
pub(super) struct System {
    secret: Scalar,
    pub(super) satellites: Vec<u8>,
    /// Header of every subframe.
    pub(super) header: u8,
    pub(super) message: Vec<u8>,
    alpha: [u8; 6],
    keys: Vec<[u8; 16]>,
    seed: u8,
}

impl System {
    /// Returns a system whose numbers follow from a seed.
    pub(super) fn new(seed: u8) -> Self {
        let secret = <Scalar as Reduce<U256>>::reduce_bytes(&Sha256::digest([seed, 1]));
        let alpha = [seed, 2, 3, 4, 5, 6];
        let mut keys = vec![Sha256::digest([seed, 2])[..16].try_into().expect("16 bytes")];
        for subframe in (ROOT..ROOT + KEYS).rev() {
            let last: &[u8; 16] = keys.last().expect("a key");
            let hash =
                Sha256::new().chain_update(last).chain_update(gst(subframe)).chain_update(alpha).finalize();
            keys.push(hash[..16].try_into().expect("16 bytes"));
        }
        keys.reverse();
        let mut system = Self {
            secret,
            satellites: vec![2, 5, 11, 19, 24, 30],
            header: 0b1000_0010,
            message: Vec::new(),
            alpha,
            keys,
            seed,
        };
        system.sign();
        system
    }

    /// Returns the public key.
    pub(super) fn public(&self) -> [u8; 33] {
        let point = (ProjectivePoint::GENERATOR * self.secret).to_affine().to_encoded_point(true);
        point.as_bytes().try_into().expect("33 bytes")
    }

    /// Makes the message of the root key anew, with the present header.
    pub(super) fn sign(&mut self) {
        let head = Bits::default()
            .put(2, 4) // eight blocks
            .put(1, 4) // key 1
            .put(u64::from(self.header >> 4 & 3), 2)
            .put(0, 6)
            .put(4, 4) // keys of 128 bits
            .put(9, 4) // tags of 40 bits
            .put(34, 8)
            .put(0, 4)
            .put(WEEK.into(), 12)
            .put(HOUR.into(), 8);
        let mut message = head.bytes();
        message.extend(self.alpha);
        message.extend(self.keys[0]);
        let signed = Sha256::new().chain_update([self.header]).chain_update(&message[1..]);
        let z = <Scalar as Reduce<U256>>::reduce_bytes(&signed.clone().finalize());
        let nonce = <Scalar as Reduce<U256>>::reduce_bytes(&Sha256::digest([self.seed, 3, self.header]));
        let point = (ProjectivePoint::GENERATOR * nonce).to_affine().to_encoded_point(false);
        let r = <Scalar as Reduce<U256>>::reduce_bytes(point.x().expect("a coordinate"));
        let s = nonce.invert().expect("not zero") * (z + r * self.secret);
        let signature = [r.to_repr(), s.to_repr()].concat();
        message.extend(&signature);
        let padding = signed.chain_update(&signature).finalize();
        message.extend(&padding[..11]);
        self.message = message;
    }

    /// Returns the key of a subframe.
    pub(super) fn key(&self, subframe: u32) -> &[u8; 16] {
        &self.keys[(subframe - ROOT) as usize]
    }

    /// Returns the word of a type, which changes every twenty subframes but for its time.
    fn word(&self, satellite: u8, kind: u8, begin_s: u32) -> [u8; 16] {
        let issue = begin_s / 600;
        let content = Sha256::digest([self.seed, satellite, kind, issue as u8]);
        let mut bits = Bits::default().put(kind.into(), 6);
        if (1..=4).contains(&kind) {
            bits = bits.put(u64::from(issue % 1024), 10);
        }
        for byte in content.iter().chain(&content) {
            bits = bits.put((*byte).into(), 8);
        }
        bits.0.truncate(128);
        if kind == 5 {
            bits.0.truncate(73);
            bits = bits.put((begin_s / 604_800).into(), 12).put((begin_s % 604_800).into(), 20).put(0, 23);
        }
        bits.bytes().try_into().expect("16 bytes")
    }

    /// Returns the bits that a tag is about.
    fn about(&self, satellite: u8, adkd: u8, subframe: u32) -> Vec<bool> {
        let places: &[(u8, usize, usize)] = if adkd == 4 {
            &[(6, 6, 99), (10, 86, 42)]
        } else {
            &[(1, 6, 120), (2, 6, 120), (3, 6, 122), (4, 6, 120), (5, 6, 67)]
        };
        let mut all = Vec::new();
        for &(kind, start, count) in places {
            let word = self.word(satellite, kind, subframe * 30 + 1);
            let bits = word.iter().fold(Bits::default(), |bits, byte| bits.put((*byte).into(), 8));
            all.extend(&bits.0[start..start + count]);
        }
        all
    }

    fn tag(&self, sender: u8, subject: u8, adkd: u8, slot: u64, subframe: u32) -> u64 {
        let mut message = Bits::default();
        if slot > 1 {
            message = message.put(subject.into(), 8);
        }
        message = message.put(sender.into(), 8);
        for byte in gst(subframe) {
            message = message.put(byte.into(), 8);
        }
        message = message.put(slot, 8).put((self.header >> 6).into(), 2);
        message.0.extend(self.about(subject, adkd, subframe - 1));
        let delay = if adkd == 12 { 11 } else { 1 };
        first_40(&code(self.key(subframe + delay), &message.bytes()))
    }

    /// Returns the MACK message of a satellite.
    fn mack(&self, sender: u8, subframe: u32) -> Vec<u8> {
        let other = |by: usize| {
            let place =
                self.satellites.iter().position(|satellite| *satellite == sender).expect("one of them");
            self.satellites[(place + by) % self.satellites.len()]
        };
        let mut infos = Vec::new();
        let mut flexible = Vec::new();
        let mut tags = Vec::new();
        for (index, slot) in SLOTS[(subframe % 2) as usize].iter().enumerate() {
            let (subject, adkd) = match *slot {
                "FLX" => (other(index + 1), 0),
                "04S" => (sender, 4),
                "12S" => (sender, 12),
                "12E" => (other(2), 12),
                _ => (other(index), 0),
            };
            // Words may be missed in the subframes since the last change but one.
            let cop = if adkd == 4 { 2 } else { 1 };
            let info = Bits::default().put(subject.into(), 8).put(adkd.into(), 4).put(cop, 4);
            if *slot == "FLX" {
                flexible.extend(info.bytes());
            }
            tags.push(self.tag(sender, subject, adkd, index as u64 + 2, subframe));
            infos.push(info);
        }
        let mut sequence = vec![sender];
        sequence.extend(gst(subframe));
        sequence.extend(flexible);
        let sequence = first_40(&code(self.key(subframe + 1), &sequence)) >> 28;
        let mut mack =
            Bits::default().put(self.tag(sender, sender, 0, 1, subframe), 40).put(sequence, 12).put(1, 4);
        for (tag, info) in tags.into_iter().zip(infos) {
            mack = mack.put(tag, 40);
            mack.0.extend(info.0);
        }
        for byte in self.key(subframe) {
            mack = mack.put((*byte).into(), 8);
        }
        mack.put(0, 16).bytes()
    }

    /// Returns the pages of all satellites in some subframes, in order of time.
    pub(super) fn pages(&self, subframes: std::ops::Range<u32>) -> Vec<Page> {
        let mut pages = Vec::new();
        for subframe in subframes {
            let of_subframe: Vec<(u8, Vec<u8>)> = self
                .satellites
                .iter()
                .map(|satellite| (*satellite, self.mack(*satellite, subframe)))
                .collect();
            for index in 0..15 {
                for (place, (satellite, mack)) in of_subframe.iter().enumerate() {
                    pages.push(self.page(*satellite, mack, subframe, index, place));
                }
            }
        }
        pages
    }

    fn page(&self, satellite: u8, mack: &[u8], subframe: u32, index: usize, place: usize) -> Page {
        let begin_s = subframe * 30 + 1 + 2 * index as u32;
        let block = (subframe as usize + place) % 8;
        let head = match index {
            0 => self.header,
            1 => 1 << 4 | block as u8,
            _ => self.message[13 * block + index - 2],
        };
        let mut bits = [head; 5];
        bits[1..].copy_from_slice(&mack[4 * index..4 * index + 4]);
        let kind = match WORDS[index] {
            7 if subframe % 2 == 1 => 10,
            kind => kind,
        };
        let kind = if kind == 7 || kind == 8 { 63 } else { kind };
        // A word 0 without a time.
        let word = if kind == 0 { [0; 16] } else { self.word(satellite, kind, begin_s) };
        Page { satellite, begin_s, word, bits }
    }
}

fn gst(subframe: u32) -> [u8; 4] {
    ((subframe / 20_160) << 20 | (subframe % 20_160 * 30)).to_be_bytes()
}

fn code(key: &[u8], message: &[u8]) -> Vec<u8> {
    let mut mac = Hmac::<Sha256>::new_from_slice(key).expect("any key");
    mac.update(message);
    mac.finalize().into_bytes().to_vec()
}

fn first_40(code: &[u8]) -> u64 {
    code[..5].iter().fold(0, |value, byte| value << 8 | u64::from(*byte))
}
