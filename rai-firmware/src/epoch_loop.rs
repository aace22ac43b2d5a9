//! The loop around the receiver: GNSS bytes first, everything else as far as it makes nobody wait.
//!
//! ```text
//! GNSS bytes ─► receiver ─► pin, sentences      one chunk of bytes that came together
//! host bytes ─► one command                     or one sentence of a long answer, if there is room for it
//! time ─► watchdog ─► sleep
//! ```
//!
//! A pass is short whatever the host does: it takes one command, or sends one sentence of an answer
//! that needs many. It does so only while the way out has room for the sentences of an epoch beside
//! it: a host that sends commands faster than its line carries answers costs its own commands, and
//! no epoch its sentences. Nothing waits for the host. Only a loop that comes round feeds the
//! watchdog.
//!
//! What an epoch costs is noted with it: ticks that the receiver was busy since the last epoch, and
//! ticks from its last byte to the pin. That byte came no earlier than the loop last found nothing
//! waiting or was first woken.

use crate::bit_rate::BitRate;
use crate::board::{Board, Note, PortLosses};
use crate::receiver::Receiver;
use crate::timed_ring::Taken;

/// GNSS bytes for which the loop goes round before a millisecond is over. With a pass for each byte
/// the passes of an epoch would cost more than it does.
pub const WORTH_A_PASS_BYTES: usize = 64;

/// GNSS bytes handed to the receiver at once.
const CHUNK_BYTES: usize = 256;

/// Bytes of the host port that one pass takes at most, where they make no command.
const COMMAND_BYTES: usize = 128;

/// Room that an answer leaves: the sentences of an epoch.
const RESERVE_BYTES: usize = 1536;

/// Epochs between two looks at the stack, which take longer than an epoch's share.
const EPOCHS_PER_HIGH_WATER: u32 = 60;

/// What the loop remembers.
#[derive(Debug)]
pub struct EpochLoop {
    /// Kept from pass to pass, most of which find nothing: clearing it would be a fifth of such a
    /// pass.
    chunk: [u8; CHUNK_BYTES],
    busy_ticks: u64,
    epochs: u32,
    /// What waits came after this instant.
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
    /// A loop before its first pass.
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

    /// Goes round until the host asks for a reset.
    pub fn run<B: Board>(&mut self, board: &mut B, receiver: &mut Receiver<B::Pin>) {
        while !receiver.reset_requested() {
            self.pass(board, receiver);
        }
    }

    /// Goes round once.
    pub fn pass<B: Board>(&mut self, board: &mut B, receiver: &mut Receiver<B::Pin>) {
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

    /// Hands over one chunk.
    fn take_gnss<B: Board>(&mut self, board: &mut B, receiver: &mut Receiver<B::Pin>) {
        let start_ticks = board.now_ticks();
        match board.gnss(&mut self.chunk) {
            Taken::Nothing => self.silent_until_ticks = start_ticks,
            Taken::Lost => {
                self.rate.hear(board.now_ms());
                receiver.interrupt();
            }
            Taken::Bytes { count, came_ms } => {
                let now_ms = board.now_ms();
                self.rate.hear(now_ms);
                let bytes = self.chunk.get(..count).unwrap_or_default();
                let judged = receiver.gnss_since(bytes, came_ms, now_ms, board.host());
                self.busy_ticks += board.now_ticks().saturating_sub(start_ticks);
                if judged {
                    self.close(board, receiver);
                }
            }
        }
    }

    fn close<B: Board>(&mut self, board: &mut B, receiver: &Receiver<B::Pin>) {
        if self.epochs.is_multiple_of(EPOCHS_PER_HIGH_WATER) {
            board.note(Note::HighWater);
        }
        let to_pin_ticks = board.driven_ticks(receiver.pin()).saturating_sub(self.silent_until_ticks);
        board.note(Note::Judged(receiver.last_verdict(), to_pin_ticks));
        self.epochs = self.epochs.wrapping_add(1);
        board.note(Note::Epoch(self.epochs, self.busy_ticks));
        self.busy_ticks = 0;
    }

    /// Lets the GNSS port listen at another rate, where a command wants it or nothing can be read
    /// at this one.
    fn set_rate<B: Board>(&mut self, board: &mut B, receiver: &mut Receiver<B::Pin>) {
        if let Some(baud) = self.rate.next(receiver.frames(), receiver.configuration().bit_rate.rate()) {
            board.set_gnss_rate(baud);
            board.note(Note::GnssRate(baud));
            receiver.interrupt();
        }
    }

    fn note_losses<B: Board>(&mut self, board: &mut B, receiver: &mut Receiver<B::Pin>) {
        let losses = board.losses();
        if losses != self.losses {
            receiver.note_losses(&losses);
            board.note(Note::Lost(losses));
            self.losses = losses;
        }
    }
}

/// Lets time pass for the receiver. What it says then it says without a byte having come: that the
/// line is silent, or what it makes of an epoch that a damaged frame had held back.
fn look_at_clock<B: Board>(board: &mut B, receiver: &mut Receiver<B::Pin>) {
    let now_ms = board.now_ms();
    if receiver.tick(now_ms, board.host()) {
        board.note(Note::Stale(receiver.last_verdict()));
    }
}

/// Takes bytes of the host port up to the end of one command, or sends one sentence of a long
/// answer. While one is under way, or an epoch would find no room for its sentences, no other
/// command is taken.
// Not inlined: what a command needs of the stack an epoch need not have beside it.
#[inline(never)]
fn take_command<B: Board>(board: &mut B, receiver: &mut Receiver<B::Pin>) {
    if receiver.has_more_to_say() {
        if may_answer(board, receiver) {
            receiver.go_on(board.host());
        }
        return;
    }
    for _ in 0..COMMAND_BYTES {
        // Each byte may end a line that is answered, refused ones too.
        if board.host_room() < RESERVE_BYTES {
            break;
        }
        let Some(byte) = board.command() else { break };
        if receiver.command_byte(byte, board.host()) {
            break;
        }
    }
}

/// Whether a long answer can go on now.
fn may_answer<B: Board>(board: &B, receiver: &Receiver<B::Pin>) -> bool {
    receiver.has_more_to_say() && board.host_room() >= RESERVE_BYTES
}
