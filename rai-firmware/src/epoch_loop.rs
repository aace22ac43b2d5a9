//! The loop around the receiver: GNSS bytes first, everything else without delaying them.
//!
//! ```text
//! GNSS bytes ─► receiver ─► pin, sentences      one chunk of bytes with the same arrival time
//! host bytes ─► one command                     or one sentence of a long answer, if there is room for it
//! time ─► watchdog ─► sleep
//! ```
//!
//! A pass is short whatever the host does: it takes one command, or sends one sentence of a long
//! answer. It does either only while the outgoing ring also has room for the sentences of an epoch.
//! If a host sends commands faster than its line carries answers, commands are therefore lost and
//! never the sentences of an epoch. The loop never waits for the host. Only a running loop feeds
//! the watchdog.
//!
//! The log gets two figures for each epoch. One is the ticks that the receiver was busy since the
//! epoch before. The other is the ticks from the last byte of this epoch to the pin, as an upper
//! bound. It counts from the instant at which the loop last found the port empty, or an interrupt
//! woke it.

use crate::bit_rate::BitRate;
use crate::board::{Board, Note, PortLosses};
use crate::observer::Observer;
use crate::receiver::Receiver;
use crate::timed_ring::Taken;

/// Number of waiting GNSS bytes for which the loop runs a pass at once, instead of at the next
/// millisecond. With a pass for each byte, the passes of an epoch would cost more than its
/// computation.
pub const WORTH_A_PASS_BYTES: usize = 64;

/// GNSS bytes handed to the receiver at once.
const CHUNK_BYTES: usize = 256;

/// Largest number of host bytes that a pass takes without completing a command.
const COMMAND_BYTES: usize = 128;

/// Room that an answer leaves for the sentences of an epoch, bytes.
const RESERVE_BYTES: usize = 1536;

/// Epochs between two measurements of the stack, because a measurement takes longer than an epoch.
const EPOCHS_PER_HIGH_WATER: u32 = 60;

/// State of the loop between passes.
#[derive(Debug)]
pub struct EpochLoop {
    /// Buffer of a chunk. It is not cleared, because most passes find no bytes and clearing would
    /// be a fifth of their cost.
    chunk: [u8; CHUNK_BYTES],
    busy_ticks: u64,
    epochs: u32,
    /// Bytes that wait now came at this instant or later.
    silent_until_ticks: u64,
    losses: PortLosses,
    rate: BitRate,
}

impl Default for EpochLoop {
    fn default() -> Self {
        Self::new()
    }
}

impl EpochLoop {
    /// Returns a loop before its first pass.
    pub const fn new() -> Self {
        Self {
            chunk: [0; CHUNK_BYTES],
            busy_ticks: 0,
            epochs: 0,
            silent_until_ticks: 0,
            losses: PortLosses::NONE,
            rate: BitRate::new(),
        }
    }

    /// Runs passes until the host orders a reset.
    pub fn run<B: Board, O: Observer>(&mut self, board: &mut B, receiver: &mut Receiver<B::Pin, O>) {
        while !receiver.reset_requested() {
            self.pass(board, receiver);
        }
    }

    /// Runs one pass.
    pub fn pass<B: Board, O: Observer>(&mut self, board: &mut B, receiver: &mut Receiver<B::Pin, O>) {
        self.take_gnss(board, receiver);
        take_command(board, receiver);
        self.set_rate(board, receiver);
        receiver.seal(board.sealed());
        look_at_clock(board, receiver);
        self.note_losses(board, receiver);
        board.feed_watchdog();
        if !may_answer(board, receiver)
            && let Some(woken_ticks) = board.sleep()
        {
            self.silent_until_ticks = woken_ticks;
        }
    }

    /// Hands one chunk of GNSS bytes to the receiver.
    fn take_gnss<B: Board, O: Observer>(&mut self, board: &mut B, receiver: &mut Receiver<B::Pin, O>) {
        let start_ticks = board.now_ticks();
        match board.gnss(&mut self.chunk) {
            Taken::Nothing => self.silent_until_ticks = start_ticks,
            Taken::Lost => {
                self.rate.receive(board.now_ms());
                receiver.interrupt();
            }
            Taken::Bytes { count, came_ms } => {
                let now_ms = board.now_ms();
                self.rate.receive(now_ms);
                let bytes = self.chunk.get(..count).unwrap_or_default();
                let judged = receiver.gnss_since(bytes, came_ms, now_ms, board.host());
                self.busy_ticks += board.now_ticks().saturating_sub(start_ticks);
                if judged {
                    self.close(board, receiver);
                }
            }
        }
    }

    fn close<B: Board, O: Observer>(&mut self, board: &mut B, receiver: &Receiver<B::Pin, O>) {
        if self.epochs.is_multiple_of(EPOCHS_PER_HIGH_WATER) {
            board.note(Note::HighWater);
        }
        let to_pin_ticks = board.driven_ticks(receiver.pin()).saturating_sub(self.silent_until_ticks);
        board.note(Note::Judged(receiver.last_verdict(), to_pin_ticks));
        self.epochs = self.epochs.wrapping_add(1);
        board.note(Note::Epoch(self.epochs, self.busy_ticks));
        self.busy_ticks = 0;
    }

    /// Sets another rate of the GNSS port, if a command requires it or no frame is valid at this
    /// rate.
    fn set_rate<B: Board, O: Observer>(&mut self, board: &mut B, receiver: &mut Receiver<B::Pin, O>) {
        if let Some(baud) = self.rate.next(receiver.frames(), receiver.configuration().bit_rate.rate()) {
            board.set_gnss_rate(baud);
            board.note(Note::GnssRate(baud));
            receiver.interrupt();
        }
    }

    fn note_losses<B: Board, O: Observer>(&mut self, board: &mut B, receiver: &mut Receiver<B::Pin, O>) {
        let losses = board.losses();
        if losses != self.losses {
            receiver.note_losses(&losses);
            board.note(Note::Lost(losses));
            self.losses = losses;
        }
    }
}

/// Advances the receiver's time. The receiver may then report without a new byte: a silent line, or
/// an epoch that a damaged frame had delayed.
fn look_at_clock<B: Board, O: Observer>(board: &mut B, receiver: &mut Receiver<B::Pin, O>) {
    let now_ms = board.now_ms();
    if receiver.tick(now_ms, board.host()) {
        board.note(Note::Stale(receiver.last_verdict()));
    }
}

/// Takes bytes of the host port up to the end of one command, or sends one sentence of a long
/// answer. It takes no command while an answer is incomplete, or while the ring lacks room for the
/// sentences of an epoch.
// Not inlined, so that its stack frame is gone while an epoch is judged.
#[inline(never)]
fn take_command<B: Board, O: Observer>(board: &mut B, receiver: &mut Receiver<B::Pin, O>) {
    if receiver.has_more_to_say() {
        if may_answer(board, receiver) {
            receiver.go_on(board.host());
        }
        return;
    }
    for _ in 0..COMMAND_BYTES {
        // Each byte may end a line that is answered, even if it is refused.
        if board.host_room() < RESERVE_BYTES {
            break;
        }
        let Some(byte) = board.command() else { break };
        if receiver.command_byte(byte, board.host()) {
            break;
        }
    }
}

/// Returns true if a long answer can continue now.
fn may_answer<B: Board, O: Observer>(board: &B, receiver: &Receiver<B::Pin, O>) -> bool {
    receiver.has_more_to_say() && board.host_room() >= RESERVE_BYTES
}
