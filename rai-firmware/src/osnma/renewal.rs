//! Slices of the work that lead to a proved chain: signed messages, and their signatures.

use super::chain::Chain;
use super::dsm;
use super::merkle::{self, KEY, Proved};
use super::queue::DONT_USE;
use super::root::{NoRoot, Root};
use super::signature::Verification;
use super::{Keys, Osnma, Pending, SIGNATURES, State, TRIED};
use crate::counters::count;

/// Combinations of blocks that one slice compares.
const COMBINATIONS: usize = 3;

/// Status of chain and public key, as the header states it.
const NOMINAL: u8 = 1;
const CHAIN_REVOKED: u8 = 3;
const KEY_REVOKED: u8 = 5;
const ALERT: u8 = 7;

/// Power of two that is an hour, ms: 70 minutes.
const HOUR_POWER: u32 = 22;

impl<const S: usize, const R: usize, const L: usize> Osnma<S, R, L> {
    /// Returns true if the proved header reports nothing special.
    pub(super) fn is_nominal(&self) -> bool {
        self.header.is_some_and(|header| header >> 1 & 7 == NOMINAL && header >> 6 != 3)
    }

    /// Returns the state.
    pub(super) fn state(&self, keys: &Keys) -> State {
        if self.is_stopped {
            return State::Stopped;
        }
        if keys.key.is_none() && self.learned.is_none() {
            return State::NoKey;
        }
        match self.header {
            Some(header) if header >> 6 == 3 => State::DontUse,
            Some(_) if self.chains.iter().any(Option::is_some) => State::Running,
            _ => self.note.unwrap_or(State::Waiting),
        }
    }

    /// Reads the next combination of a message that is complete.
    pub(super) fn read_message(&mut self, keys: &Keys, now_ms: u64) -> bool {
        let mut message = [0; dsm::BYTES];
        let mut has_worked = false;
        for _ in 0..COMBINATIONS {
            if self.pending.is_none()
                && let Some(collector) = self.roots.0.iter_mut().find(|collector| collector.has_more())
            {
                if let Some((length, header)) = collector.combination(&mut message) {
                    self.read_root(message.get(..length).unwrap_or_default(), header, keys, now_ms);
                }
                has_worked = true;
            }
        }
        let renewal = self.renewals.0.iter_mut().find(|collector| collector.has_more());
        if !has_worked && let Some(collector) = renewal {
            has_worked = true;
            if let (Some((length, _)), Some(root)) = (collector.combination(&mut message), &keys.root) {
                let proved = merkle::read(message.get(..length).unwrap_or_default(), root);
                if let Some(proved) = proved {
                    self.renew(proved, keys);
                }
            }
        }
        has_worked
    }

    fn renew(&mut self, proved: Proved, keys: &Keys) {
        match proved {
            Proved::Key(pkid, key) => {
                if keys.key != Some((pkid, key)) && self.learned != Some((pkid, key)) {
                    count(&mut self.tally.osnma_renewals);
                    self.learned = Some((pkid, key));
                    // A root key that the new key has signed may have come before it.
                    self.roots.read_again();
                }
            }
            Proved::Alert => {
                count(&mut self.tally.osnma_renewals);
                self.stop();
            }
            Proved::Unsupported => self.note = Some(State::Unsupported),
        }
    }

    /// Stops authentication until the owner gives another key.
    fn stop(&mut self) {
        self.forget_keys();
        self.is_stopped = true;
    }

    /// Begins to verify the signature of a root key that was not tried yet.
    fn read_root(&mut self, message: &[u8], header: u8, keys: &Keys, now_ms: u64) {
        let (root, signed) = match Root::read(message, header) {
            Ok(read) => read,
            Err(NoRoot::Invalid) => return,
            Err(NoRoot::Unsupported) => return self.note = Some(State::Unsupported),
        };
        let Some((_, key)) = self.key_of(root.pkid, keys) else {
            return self.note = Some(State::OtherKey);
        };
        let hour = (now_ms >> HOUR_POWER) as u32;
        if core::mem::replace(&mut self.hour, hour) != hour {
            self.signatures = 0;
        }
        if self.tried.contains(&signed.mark) || self.signatures >= SIGNATURES {
            return;
        }
        self.signatures += 1;
        if let Some(place) = self.tried.get_mut(usize::from(self.next_tried)) {
            *place = signed.mark;
        }
        self.next_tried = (self.next_tried + 1) % TRIED;
        self.pending =
            Some(Pending { root, verification: Verification::new(&key, signed.hash, &signed.signature) });
    }

    fn key_of(&self, pkid: u8, keys: &Keys) -> Option<(u8, [u8; KEY])> {
        [self.learned, keys.key.filter(|_| !self.is_key_revoked)]
            .into_iter()
            .flatten()
            .find(|(known, _)| *known == pkid)
    }

    /// Takes a step of the signature.
    pub(super) fn work_on_signature(&mut self) -> bool {
        let Some(pending) = &mut self.pending else { return false };
        if let Some(is_right) = pending.verification.go_on() {
            let root = pending.root;
            self.pending = None;
            if is_right {
                count(&mut self.tally.osnma_roots_right);
                self.accept(&root);
            } else {
                count(&mut self.tally.osnma_roots_wrong);
            }
        }
        true
    }

    /// Takes a root key whose signature is right.
    fn accept(&mut self, root: &Root) {
        let (status, in_force, special) = (root.header >> 6, root.header >> 4 & 3, root.header >> 1 & 7);
        // One from before is only sent again.
        if root.subframe < self.forbidden {
            return;
        }
        if status == DONT_USE {
            self.forbidden = root.subframe;
        }
        (self.header, self.pkid, self.note) = (Some(root.header), root.pkid, None);
        if special == ALERT {
            return self.stop();
        }
        if special == KEY_REVOKED && self.learned.is_some_and(|(pkid, _)| pkid == root.pkid) {
            // The older key has signed nothing that may be believed any more.
            self.is_key_revoked = true;
            self.chains = [None; 2];
        }
        let parameters = root.parameters;
        let is_same = |chain: &Chain| chain.parameters == parameters && chain.newest >= root.subframe;
        if !self.chains.iter().flatten().any(is_same) {
            let of_this = |chain: &Option<Chain>| {
                chain.as_ref().is_some_and(|chain| chain.parameters.chain == parameters.chain)
            };
            let not_in_force =
                |chain: &Option<Chain>| chain.as_ref().is_none_or(|chain| chain.parameters.chain != in_force);
            let index = self.chains.iter().position(of_this);
            let index = index.or_else(|| self.chains.iter().position(Option::is_none));
            let index = index.or_else(|| self.chains.iter().position(not_in_force)).unwrap_or(0);
            if let Some(place) = self.chains.get_mut(index) {
                *place = Some(Chain::new(parameters, root.subframe, root.key));
                self.link = None;
            }
        }
        if status == DONT_USE && special == CHAIN_REVOKED {
            let is_revoked = |chain: &Chain| chain.parameters.chain == in_force;
            self.chains.iter_mut().for_each(|chain| *chain = chain.filter(|chain| !is_revoked(chain)));
            self.satellites.iter_mut().for_each(super::Satellite::forget_verdict);
        }
    }
}
