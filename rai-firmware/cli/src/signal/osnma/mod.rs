//! A Galileo sky that signs its navigation data (OSNMA) with a key of its own.
//!
//! No recording holds an attack with signed data, and forged words with right tags cannot be recorded.
//! This system makes them: pages of all satellites, with `HKROOT` and `MACK`.
//!
//! ```text
//! secret ─► signature of the root key ─► HKROOT ─┐
//! chain  ─► key of each subframe ─────┐          ├─► pages of 2 s, 15 a subframe
//! words  ─► tags, with a later key ───┴─► MACK ──┘
//! ```
//!
//! | module | content |
//! |---|---|
//! | [`words`] | navigation words: arbitrary ones, or those of broadcast ephemerides |
//! | `secret` | keys of the curve P-256, and their signatures |
//! | `chain` | keys of the subframes |
//! | `message` | root key, new public key and alert, as blocks |
//! | `mack` | tags |
//!
//! A system goes through [`Phase`]s: the end of a chain, the revocation of a chain or a key, a new key,
//! an alert. It is written from the interface document beside the module's reader, with other crates
//! for the codes and the curve, and two other verifiers accept what it makes.
//!
//! **The test key** ([`Secret::test`]) stands here for everybody to read. A module takes it only if it
//! is built with the feature `test-key`, which no image and no release is.
//!
//! Reference: [OSNMA-ICD].
//!
//! [OSNMA-ICD]: raim_firmware#references

mod bits;
mod chain;
mod mack;
mod message;
mod secret;
pub mod words;

use std::ops::Range;

use raim_core::satellite::{Constellation, SatelliteId};

use self::bits::Bits;
pub use self::chain::Chain;
use self::chain::KEYS;
use self::message::Tree;
pub use self::secret::Secret;
use self::words::{Arbitrary, Words};
use crate::signal::encode::ubx;

/// Subframes of a week.
const WEEK: u32 = 20_160;

/// Seconds of a subframe, and of its pages.
const SUBFRAME_S: u32 = 30;
const PAGE_S: u32 = 2;

/// Subframes for which one of several messages is sent.
const TURN: u32 = 10;

/// Types of the words of a subframe. 7 stands for word 10 in each second one; 7 and 8 are of no use
/// else.
const KINDS: [u8; 15] = [2, 4, 6, 7, 8, 0, 0, 0, 0, 0, 1, 3, 5, 0, 0];

/// Type of a word without content.
const DUMMY: u8 = 63;

/// Number of the next public key.
const NEXT_KEY: u8 = 2;

/// Subframe of the root key of [`System::new`].
pub const ROOT: u32 = Chain::root(1339, 120);

/// A page, as a receiver passes it on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Page {
    /// Number of the satellite.
    pub satellite: u8,
    /// Second since the start of Galileo system time at which it begins.
    pub begin_s: u32,
    /// The word, its first bit highest.
    pub word: [u8; 16],
    /// Bits for authentication: one byte of `HKROOT`, four of `MACK`.
    pub bits: [u8; 5],
}

impl Page {
    /// Returns the second at which the page has come.
    pub const fn end_s(&self) -> u32 {
        self.begin_s + PAGE_S
    }

    /// Returns the frame in which a u-blox receiver sends it, with its check; `None` if there is no such
    /// satellite.
    pub fn frame(&self) -> Option<Vec<u8>> {
        let satellite = SatelliteId::new(Constellation::Galileo, self.satellite)?;
        Some(ubx::inav_page(satellite, &self.word, self.bits))
    }

    /// Returns the line that other verifiers read: week, second of the week, satellite, word,
    /// authentication, band.
    pub fn line(&self) -> String {
        let digits =
            |bytes: &[u8]| bytes.iter().map(|byte| format!("{byte:02x}")).collect::<Vec<_>>().concat();
        let Self { satellite, begin_s, word, bits } = self;
        let (week, second) = (begin_s / (WEEK * SUBFRAME_S), begin_s % (WEEK * SUBFRAME_S));
        format!("{week} {second} {satellite} {} {} 1", digits(word), digits(bits))
    }
}

/// What the system says from a subframe on.
#[derive(Clone, Debug)]
pub struct Phase {
    /// First subframe.
    from: u32,
    /// Number of the message of the root key.
    id: u8,
    /// Header: status in 2 bits, chain in force in 2, status of chain and key in 3, one reserved.
    pub header: u8,
    /// Number of the chain whose root key is sent.
    pub root_of: u8,
    /// True if the root key is signed by the next public key.
    pub is_next_key: bool,
    /// Message beside the root key.
    pub renewal: Renewal,
    messages: Vec<Vec<u8>>,
}

/// Message beside the root key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Renewal {
    /// None.
    None,
    /// The next public key.
    Key,
    /// The end of all authentication.
    Alert,
}

impl Phase {
    /// Replaces the status, the number of the chain in force, and the status of chain and key.
    fn head(&mut self, status: u8, chain: u8, special: u8) {
        self.header = status << 6 | chain << 4 | special << 1;
    }

    const fn chain(&self) -> u8 {
        self.header >> 4 & 3
    }

    /// Announces the chain that follows the one in force.
    pub fn chain_ends(&mut self) {
        self.root_of = self.chain() + 1;
        self.head(2, self.chain(), 2);
    }

    /// Brings the announced chain into force.
    pub fn next_chain(&mut self) {
        self.head(2, self.root_of, 1);
    }

    /// Revokes the chain in force.
    pub fn chain_revoked(&mut self) {
        self.root_of = self.chain() + 1;
        self.head(3, self.chain(), 3);
    }

    /// Goes on with the next chain behind a revocation.
    pub fn chain_replaced(&mut self) {
        self.head(2, self.root_of, 3);
    }

    /// Announces the next public key.
    pub fn key_comes(&mut self) {
        self.renewal = Renewal::Key;
        self.head(2, self.chain(), 4);
    }

    /// Signs with the next public key.
    pub fn key_follows(&mut self) {
        self.is_next_key = true;
    }

    /// Revokes the first public key, and with it its chain.
    pub fn key_revoked(&mut self) {
        (self.renewal, self.is_next_key) = (Renewal::Key, true);
        self.root_of = self.chain() + 1;
        self.head(3, self.chain(), 5);
    }

    /// Goes on behind the revocation of the key.
    pub fn key_replaced(&mut self) {
        self.head(2, self.root_of, 5);
    }

    /// Ends all authentication.
    pub fn alert(&mut self) {
        self.renewal = Renewal::Alert;
        self.head(3, self.chain(), 7);
    }
}

/// The system.
pub struct System {
    secret: Secret,
    next_secret: Secret,
    tree: Tree,
    chains: Vec<Chain>,
    phases: Vec<Phase>,
    words: Box<dyn Words>,
    seed: u8,
    /// Satellites that send.
    pub satellites: Vec<u8>,
}

impl System {
    /// Returns a system with the test key, whose other numbers follow from a seed, with arbitrary words.
    pub fn new(seed: u8) -> Self {
        Self::of(Secret::test(), seed)
    }

    /// Returns the same with another key.
    pub fn of(secret: Secret, seed: u8) -> Self {
        Self::with(secret, seed, ROOT, vec![2, 5, 11, 19, 24, 30], Box::new(Arbitrary { seed }))
    }

    /// Returns a system with a root key of this subframe, and the words of these satellites.
    pub fn with(secret: Secret, seed: u8, root: u32, satellites: Vec<u8>, words: Box<dyn Words>) -> Self {
        Self::with_keys(KEYS, secret, seed, root, satellites, words)
    }

    /// Returns the same with so many keys behind the root key. A module that has heard nothing yet
    /// follows the chain from there.
    pub fn with_keys(
        keys_behind: u32,
        secret: Secret,
        seed: u8,
        root: u32,
        satellites: Vec<u8>,
        words: Box<dyn Words>,
    ) -> Self {
        let next_secret = Secret::of(&[seed, 4]);
        let first = Phase {
            from: 0,
            id: 1,
            header: 0b1000_0010,
            root_of: 0,
            is_next_key: false,
            renewal: Renewal::None,
            messages: Vec::new(),
        };
        let mut system = Self {
            tree: Tree::new((NEXT_KEY, next_secret.public())),
            secret,
            next_secret,
            // The root key of the second is an hour later.
            chains: (0..2)
                .map(|number| Chain::new(seed, number, root + 120 * u32::from(number), keys_behind))
                .collect(),
            phases: Vec::new(),
            words,
            seed,
            satellites,
        };
        system.add(first);
        system
    }

    /// Returns the public key.
    pub fn public(&self) -> [u8; 33] {
        self.secret.public()
    }

    /// Returns the root of the tree that proves the next public key and the alert.
    pub fn tree_root(&self) -> [u8; 32] {
        self.tree.root()
    }

    /// Begins another phase with a subframe, later than all others.
    pub fn then(&mut self, from: u32, change: impl FnOnce(&mut Phase)) {
        let Some(mut phase) = self.phases.last().cloned() else { return };
        (phase.from, phase.id) = (from, phase.id % 11 + 1);
        change(&mut phase);
        self.add(phase);
    }

    fn add(&mut self, mut phase: Phase) {
        phase.messages = vec![self.root_message(&phase)];
        match phase.renewal {
            Renewal::None => {}
            Renewal::Key => phase.messages.push(self.tree.key()),
            Renewal::Alert => phase.messages.push(self.tree.alert()),
        }
        self.phases.push(phase);
    }

    fn root_message(&self, phase: &Phase) -> Vec<u8> {
        let (number, secret, once) =
            if phase.is_next_key { (NEXT_KEY, &self.next_secret, 5) } else { (1, &self.secret, 3) };
        let chain = &self.chains[usize::from(phase.root_of)];
        message::root_key(phase.header, (number, secret), chain, &[self.seed, once, phase.header])
    }

    fn phase(&self, subframe: u32) -> &Phase {
        let behind = self.phases.partition_point(|phase| phase.from <= subframe);
        &self.phases[behind.saturating_sub(1)]
    }

    /// Returns the key of a subframe: that of the chain then in force.
    fn key(&self, subframe: u32) -> &[u8; 16] {
        self.chains[usize::from(self.phase(subframe).chain())].key(subframe)
    }

    /// Returns the pages of all satellites in some subframes, in order of time.
    pub fn pages(&self, subframes: Range<u32>) -> Vec<Page> {
        let mut pages = Vec::new();
        for subframe in subframes {
            let macks: Vec<_> =
                self.satellites.iter().map(|satellite| self.mack(*satellite, subframe)).collect();
            for index in 0..KINDS.len() {
                for (place, (satellite, mack)) in self.satellites.iter().zip(&macks).enumerate() {
                    pages.push(self.page(*satellite, mack, subframe, index, place));
                }
            }
        }
        pages
    }

    fn page(&self, satellite: u8, mack: &[u8], subframe: u32, index: usize, place: usize) -> Page {
        let begin_s = subframe * SUBFRAME_S + 1 + PAGE_S * index as u32;
        let mut bits = [self.hkroot(subframe, index, place); 5];
        bits[1..].copy_from_slice(&mack[4 * index..4 * index + 4]);
        let kind = match KINDS[index] {
            7 if subframe % 2 == 1 => 10,
            7 | 8 => DUMMY,
            kind => kind,
        };
        // A word 0 without a time.
        let word = if kind == 0 { [0; 16] } else { self.words.word(satellite, kind, begin_s) };
        Page { satellite, begin_s, word, bits }
    }

    /// Returns a byte of `HKROOT`: the header, the place of the block, or the block. The messages come in
    /// turn, each for five minutes, and satellites send different blocks.
    fn hkroot(&self, subframe: u32, index: usize, place: usize) -> u8 {
        let phase = self.phase(subframe);
        let turn = (subframe / TURN) as usize % phase.messages.len();
        let message = &phase.messages[turn];
        let block = (subframe as usize + place) % (message.len() / message::BLOCK);
        let id = if turn == 0 { phase.id } else { message::RENEWAL };
        match index {
            0 => phase.header,
            1 => id << 4 | block as u8,
            _ => message[message::BLOCK * block + index - 2],
        }
    }
}

/// Returns the 32 bits of a subframe's time: the week in 12 bits, the second of the week in 20.
fn gst(subframe: u32) -> [u8; 4] {
    ((subframe / WEEK) << 20 | (subframe % WEEK * SUBFRAME_S)).to_be_bytes()
}
