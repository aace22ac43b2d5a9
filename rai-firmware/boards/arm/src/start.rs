//! Start of a board: builds the receiver and runs the epoch loop, which never returns.

use core::mem::MaybeUninit;

use raim_firmware::board::reset::{Fault, ResetCause};
use raim_firmware::board::{Board, SEALED_BYTES};
use raim_firmware::epoch_loop::EpochLoop;
use raim_firmware::receiver::{Boot, Receiver};
use raim_firmware::settings::{Configuration, Unsealed};

use crate::board::CortexBoard;
use crate::pin::IntegrityPin;
use crate::{Chip, fault, log, rings};

/// A place for the receiver of a chip among the statics.
pub type Place<C> = MaybeUninit<Receiver<IntegrityPin<<C as Chip>::Output>>>;

/// Announces the start to the host and runs the loop until the host requests a reset.
pub fn run<C: Chip>(
    mut board: CortexBoard<C>,
    place: &'static mut Place<C>,
    pin: IntegrityPin<C::Output>,
) -> ! {
    let board = &mut board;
    let cause = board.reset_cause();
    let (version, git) = (env!("CARGO_PKG_VERSION"), env!("RAI_GIT"));
    log!(info, "start: {=str} {=str}, reset cause {=str}", version, git, cause.word());
    if let ResetCause::Fault(Fault::Panic { file, line }) = cause {
        log!(error, "the program before panicked: file {=u32:08x}, line {=u32}", file, line);
    }
    board.feed_watchdog();
    let Some(receiver) = settle(place, pin, boot(board, cause)) else { fault::reset_on_request::<C>() };
    let after_power_on = is_after_power_on(cause, board.sealed());
    receiver.restore(board.sealed(), after_power_on);
    receiver.greet(board.host());
    EpochLoop::new().run(board, receiver);
    rings::drain();
    fault::reset_on_request::<C>()
}

/// Returns true if the default settings apply: after power-on, or if the chip reports no cause and
/// its memory has no settings.
fn is_after_power_on(cause: ResetCause, memory: &[u8; SEALED_BYTES]) -> bool {
    match cause {
        ResetCause::PowerOn => true,
        ResetCause::Unknown => Configuration::unseal(memory) == Unsealed::Nothing,
        _ => false,
    }
}

/// Builds the receiver in its place among the statics.
#[inline(never)]
fn settle<P: embedded_hal::digital::OutputPin>(
    place: &'static mut MaybeUninit<Receiver<P>>,
    pin: P,
    boot: Boot,
) -> Option<&'static mut Receiver<P>> {
    let made = Receiver::place(place, pin, boot);
    if made.is_err() {
        log!(error, "the requirements at start are not in the threshold tables");
    }
    made.ok()
}

fn boot<B: Board>(board: &B, cause: ResetCause) -> Boot {
    let clock_error_ppm = board.clock_error_ppm();
    let mut boot = Boot::on_host(env!("RAI_GIT"));
    (boot.reset_cause, boot.clock_error_ppm) = (cause.word(), clock_error_ppm);
    boot
}
