//! OSNMA: were the orbits and clocks of Galileo made by the system?
//!
//! ```text
//! pages of E1 ─► subframe ─┬─ HKROOT ─► message ─► root key, by a signature ─► chain
//!                          └─ MACK ─► key of the subframe, by the chain ─► tags of the one before
//! words of E1 and E5b ───────────────────────────────────────────────────► tag right or wrong ─► Verdict
//! ```
//!
//! A satellite sends tags of its own and other satellites' words, and 30 s later the key that they
//! were computed with. The key is the hash of the next one, and a signature proves the first. A right
//! tag therefore proves that the system made the words, if they came before the key was public. It
//! proves neither ranges nor that signals are not relayed.
//!
//! | module | content |
//! |---|---|
//! | [`pages`] | time of a page, and the bits of a subframe |
//! | [`words`] | words that tags are about |
//! | [`dsm`] | blocks of a signed message, from all satellites |
//! | [`root`], [`signature`], [`curve`] | root key, its signature, the curve of the signature |
//! | [`merkle`] | new keys and alerts |
//! | [`hash`] | SHA-256 and HMAC |
//! | [`chain`] | keys of the subframes |
//! | [`tags`], [`table`] | tags, and what each is about |
//! | [`queue`], [`renewal`] | slices of the work |
//! | [`verdicts`] | what tags say of a satellite |
//!
//! **Work** is a queue of slices of at most 60,000 instructions ([`Osnma::work`]), in this order: keys
//! of satellites against the chain, tags whose key is known, messages, signature. Nothing is followed
//! before a root key is proved.
//!
//! **Rules.** A page of zeros means that the satellite was not connected to the ground. It is not
//! taken, so that its subframe stays incomplete and is dropped. A satellite whose own key does not
//! follow from the chain is not believed. A tag that is wrong makes words `FALSE` only if all of them
//! came in the subframe that it is about.
//!
//! **Limits.** SHA-256, HMAC-SHA-256 and P-256 only. A header that forbids use is lifted by no root key
//! that is older than its own. Other headers are not compared by age: an old root key that is sent again
//! renews its own.
//!
//! References: [OSNMA-ICD], [OSNMA-RG].
//!
//! [OSNMA-ICD]: crate#references
//! [OSNMA-RG]: crate#references

mod chain;
mod curve;
mod dsm;
mod gst;
mod hash;
mod held;
mod merkle;
mod pages;
mod queue;
mod renewal;
mod root;
mod signature;
mod standing;
mod table;
mod tags;
mod tally;
mod verdicts;
mod words;

use heapless::Vec;

use chain::{Chain, Link};
use dsm::Collectors;
use gst::Subframe;
use held::{Belief, Held};
use merkle::KEY;
use pages::Collected;
use root::Root;
use signature::Verification;
pub use standing::Standing;
use tags::MACK;
pub use tally::Tally;
use verdicts::{Alarm, Satellite, units};
pub use verdicts::{Proof, Seal, Verdict};
use words::FormerWords;

/// Number of message that is the first of a new key; those below are root keys.
const KEYS_FROM: u8 = 12;

/// Subframes from a tag with a later key to that key.
const SLOW: u8 = 11;

/// Number that no chain has.
const NO_CHAIN: u8 = u8::MAX;

/// Most signatures that are begun in an hour, and messages of which none is verified again.
const SIGNATURES: u8 = 16;
const TRIED: u8 = 8;

/// Keys that the owner gave.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Keys {
    /// Public key with its number.
    pub key: Option<(u8, [u8; KEY])>,
    /// Root of the tree.
    pub root: Option<[u8; 32]>,
}

impl Keys {
    /// No key.
    pub const NONE: Self = Self { key: None, root: None };
}

/// State of the authentication.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// There is no key.
    NoKey,
    /// No root key is proved.
    Waiting,
    /// The root key is signed by a key that is not known.
    OtherKey,
    /// The functions in use are not supported.
    Unsupported,
    /// Tags are checked.
    Running,
    /// The system says that authentication must not be used.
    DontUse,
    /// An alert of the system, or a revocation of everything known, has ended authentication.
    Stopped,
}

/// Tag that waits for its later key.
#[derive(Clone, Copy, Debug)]
struct Slow {
    value: [u8; 5],
    sender: u8,
    subject: u8,
    /// COP in the upper half, slot in the lower one.
    cop_slot: u8,
    status: u8,
    subframe: u8,
}

/// Signature that is being verified, and what it is of.
#[derive(Clone, Copy, Debug)]
struct Pending {
    root: Root,
    verification: Verification,
}

/// Authentication with room for `S` satellites, `R` of which are connected or have just changed their
/// words, and `L` tags that wait for their later keys.
#[derive(Debug)]
pub struct Osnma<const S: usize, const R: usize, const L: usize> {
    satellites: Vec<Satellite, S>,
    former: FormerWords<R>,
    collected: Vec<Collected, R>,
    held: Vec<Held, R>,
    slow: Vec<Slow, L>,
    roots: Collectors<2, { dsm::OF_ROOT }>,
    renewals: Collectors<1, { dsm::OF_KEY }>,
    chains: [Option<Chain>; 2],
    /// Number of the chain that proved the newest key, or [`NO_CHAIN`]. A root key may be of a time to
    /// come, and proves nothing by itself.
    active: u8,
    link: Option<Link>,
    pending: Option<Pending>,
    learned: Option<(u8, [u8; KEY])>,
    /// Marks of the messages whose signature was begun last.
    tried: [u64; TRIED as usize],
    next_tried: u8,
    /// Hour of the module's clock, and signatures that were begun in it.
    hour: u32,
    signatures: u8,
    /// Header that came with the newest proved root key, and the key that signed it.
    header: Option<u8>,
    pkid: u8,
    /// Subframe of the root key with the last header that forbids use.
    forbidden: Subframe,
    note: Option<State>,
    is_stopped: bool,
    /// True if the owner's key was revoked.
    is_key_revoked: bool,
    /// False while nothing is heard.
    is_on: bool,
    alarm: Alarm,
    tally: Tally,
}

/// What is known at a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Summary {
    /// State of the authentication.
    pub state: State,
    /// Number of the key that signed the root key, and of the chain in force; `None` before a root
    /// key is proved.
    pub key_and_chain: Option<(u8, u8)>,
    /// Number of satellites in view by their verdict.
    pub proved: u8,
    /// Of which nothing is known.
    pub unproved: u8,
    /// Whose words are false.
    pub false_: u8,
    /// Those proved satellites that may decide between systems, because a tag with the next key is
    /// among their proofs; a bit for each number.
    pub witnesses: u64,
    /// Age of the oldest proof, s.
    pub oldest_proof_s: Option<u32>,
    /// True if more than one satellite sent what the system did not make.
    pub is_alarm: bool,
}

impl<const S: usize, const R: usize, const L: usize> Osnma<S, R, L> {
    /// Returns the state before the first page.
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    #[allow(clippy::new_without_default, reason = "it would be made on the stack")]
    pub const fn new() -> Self {
        Self::switched(true)
    }

    /// Returns the same, on or off.
    #[allow(clippy::inline_always, reason = "made where it stays, and not on the stack first")]
    #[inline(always)]
    pub(crate) const fn switched(is_on: bool) -> Self {
        Self {
            satellites: Vec::new(),
            former: FormerWords::NONE,
            collected: Vec::new(),
            held: Vec::new(),
            slow: Vec::new(),
            roots: Collectors::EMPTY,
            renewals: Collectors::EMPTY,
            chains: [None; 2],
            active: NO_CHAIN,
            link: None,
            pending: None,
            learned: None,
            tried: [0; TRIED as usize],
            next_tried: 0,
            hour: 0,
            signatures: 0,
            header: None,
            pkid: 0,
            forbidden: Subframe(0),
            note: None,
            is_stopped: false,
            is_key_revoked: false,
            is_on,
            alarm: Alarm::NONE,
            tally: Tally::NONE,
        }
    }

    /// Forgets everything that rests on a key, because the owner gave another.
    pub fn forget_keys(&mut self) {
        (self.chains, self.link, self.pending, self.learned) = ([None; 2], None, None, None);
        (self.header, self.pkid, self.forbidden, self.note) = (None, 0, Subframe(0), None);
        (self.is_stopped, self.is_key_revoked) = (false, false);
        self.tried = [0; TRIED as usize];
        self.signatures = 0;
        self.held.clear();
        self.slow.clear();
        self.roots = Collectors::EMPTY;
        self.renewals = Collectors::EMPTY;
        self.alarm = Alarm::NONE;
        self.satellites.iter_mut().for_each(Satellite::forget_verdict);
    }

    /// Switches it on or off. Pages are missed meanwhile, so that a change forgets everything.
    pub(crate) fn switch(&mut self, is_on: bool) {
        if core::mem::replace(&mut self.is_on, is_on) != is_on {
            self.forget_keys();
            self.satellites.clear();
            self.former = FormerWords::NONE;
            self.collected.clear();
        }
    }

    /// Takes a page: a word, and the forty bits for authentication, which only E1 has.
    // Not inlined, so that its stack is free again while an epoch is judged.
    #[inline(never)]
    pub fn receive(&mut self, number: u8, word: &[u8; 16], bits: [u8; 5], is_e1: bool, came_ms: u64) {
        if !self.is_on {
            return;
        }
        let Self { satellites, former, collected, .. } = self;
        let Some(satellite) = Satellite::place(satellites, number, came_ms) else { return };
        let Some(begin_s) = satellite.take(word, is_e1, came_ms, former) else { return };
        if !is_e1 || bits == [0; 5] {
            return;
        }
        let subframe = Subframe::of(begin_s);
        let Some(place) = place_of(collected, number, subframe) else { return };
        if place.add((begin_s % 30 / 2) as usize, bits) {
            let complete = *place;
            collected.retain(|collected| collected.satellite != number);
            self.complete(&complete, came_ms);
        }
    }

    /// Takes a complete subframe of a satellite.
    fn complete(&mut self, complete: &Collected, came_ms: u64) {
        let &Collected { satellite, subframe, hkroot, .. } = complete;
        let [header, place, ..] = hkroot;
        if place >> 4 < KEYS_FROM {
            self.roots.take(&hkroot, satellite, units(came_ms));
        } else {
            self.renewals.take(&hkroot, satellite, units(came_ms));
        }
        let mut mack = [0; MACK];
        for (place, four) in mack.as_chunks_mut::<4>().0.iter_mut().zip(&complete.mack) {
            *place = *four;
        }
        self.held.retain(|held| held.satellite != satellite || held.subframe == subframe.back(1));
        if self.held.is_full() && !self.give_way(subframe) {
            return;
        }
        let _ = self.held.push(Held {
            satellite,
            header,
            subframe,
            mack,
            belief: Belief::Unknown,
            next: 0,
            is_in_order: false,
        });
    }

    /// Returns the verdict on the words that a satellite sent last.
    pub fn seal_of(&self, number: u8) -> Seal {
        let mut all = self.satellites.iter();
        all.find(|satellite| satellite.number == number).map(Satellite::seal).unwrap_or_default()
    }

    /// Returns the counters.
    pub const fn tally(&self) -> &Tally {
        &self.tally
    }

    /// Returns what is known.
    pub fn summary(&self, keys: &Keys, now_ms: u64) -> Summary {
        let mut summary = Summary {
            state: self.state(keys),
            key_and_chain: self.header.map(|header| (self.pkid, header >> 4 & 3)),
            proved: 0,
            unproved: 0,
            false_: 0,
            witnesses: 0,
            oldest_proof_s: None,
            is_alarm: self.alarm.is_raised(now_ms),
        };
        for satellite in self.satellites.iter().filter(|satellite| satellite.is_in_view(now_ms)) {
            if let Some(age_s) = satellite.proof_age_s(now_ms) {
                summary.proved += 1;
                // A number is at most 36.
                summary.witnesses |= u64::from(satellite.is_witness()) << (satellite.number & 63);
                summary.oldest_proof_s = summary.oldest_proof_s.max(Some(age_s));
            } else if satellite.is_false() {
                summary.false_ += 1;
            } else {
                summary.unproved += 1;
            }
        }
        summary
    }

    /// Does one slice of the work.
    #[inline(never)]
    pub fn work(&mut self, keys: &Keys, now_ms: u64) -> Worked {
        if self.is_stopped || (keys.key.is_none() && self.learned.is_none() && keys.root.is_none()) {
            return Worked::Nothing;
        }
        if let Some(worked) = self.work_on_link(now_ms) {
            return worked;
        }
        self.believe(now_ms);
        if let Some(worked) = self.check_held(now_ms).or_else(|| self.check_slow(now_ms)) {
            return worked;
        }
        if self.begin_link(now_ms) || self.read_message(keys, now_ms) || self.work_on_signature() {
            return Worked::Something;
        }
        Worked::Nothing
    }
}

/// Authentication as images have it.
#[cfg(feature = "satellites-48")]
pub type Authentication = Osnma<36, 16, 72>;

/// Authentication as images with less memory have it.
#[cfg(not(feature = "satellites-48"))]
pub type Authentication = Osnma<24, 14, 72>;

const _: () = assert!(size_of::<Authentication>() <= 12 * 1024);

/// What a slice has led to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Worked {
    /// There was nothing to do.
    Nothing,
    Something,
    /// The words of a satellite have another verdict now.
    Judged(u8, Seal),
}

/// Takes an element out; the last one takes its place.
fn take<T: Copy, const N: usize>(all: &mut Vec<T, N>, index: usize) -> Option<T> {
    let taken = *all.get(index)?;
    let last = all.pop()?;
    if let Some(place) = all.get_mut(index) {
        *place = last;
    }
    Some(taken)
}

/// Returns the place for the bits of a subframe.
fn place_of<const R: usize>(
    collected: &mut Vec<Collected, R>,
    satellite: u8,
    subframe: Subframe,
) -> Option<&mut Collected> {
    let new = Collected::new(satellite, subframe);
    let known = collected.iter().position(|its| its.satellite == satellite);
    if known.is_none() {
        if collected.is_full() {
            // One that cannot become complete any more.
            let lost = collected.iter().position(|its| its.subframe < subframe)?;
            take(collected, lost);
        }
        collected.push(new).ok()?;
    }
    let index = known.unwrap_or(collected.len() - 1);
    let place = collected.get_mut(index)?;
    if place.subframe != subframe {
        *place = new;
    }
    Some(place)
}
