//! The receiver as a whole, and the loop around it.

use embedded_hal::digital::OutputPin;
use raim_firmware::bit_rate::BitRate;
use raim_firmware::board::PortLosses;
use raim_firmware::board::reset::{self, Record, ResetCause};
use raim_firmware::epoch_loop::EpochLoop;
use raim_firmware::pin::MemoryPin;
use raim_firmware::receiver::{Boot, Receiver};
use raim_firmware::selftest::{self, Failure};

use super::stand_in::{AnyBoard, Host, Pin};
use crate::{exhaust, reach};

pub(super) fn the_loop() {
    reach!(
        Boot::on_host as fn(_) -> _,
        Receiver::<Pin>::new as fn(_, _) -> _,
        Receiver::<Pin>::place as fn(_, _, _) -> _,
        Receiver::<Pin>::greet::<Host> as fn(_, _),
        Receiver::<Pin>::gnss::<Host> as fn(_, _, _, _) -> _,
        Receiver::<Pin>::gnss_since::<Host> as fn(_, _, _, _, _) -> _,
        Receiver::<Pin>::restore as fn(_, _, _),
        Receiver::<Pin>::seal as fn(_, _),
        Receiver::<Pin>::interrupt as fn(_),
        Receiver::<Pin>::authentication as fn(_) -> _,
        Receiver::<Pin>::frames as fn(_) -> _,
        <BitRate as Default>::default as fn() -> _,
        BitRate::new as fn() -> _,
        BitRate::hear as fn(_, _),
        BitRate::next as fn(_, _, _) -> _,
        Receiver::<Pin>::note_losses as fn(_, _),
        Receiver::<Pin>::losses as fn(_) -> _,
        Receiver::<Pin>::tick::<Host> as fn(_, _, _) -> _,
        Receiver::<Pin>::command::<Host> as fn(_, _, _),
        Receiver::<Pin>::command_byte::<Host> as fn(_, _, _) -> _,
        Receiver::<Pin>::set::<Host> as fn(_, _, _, _) -> _,
        Receiver::<Pin>::has_more_to_say as fn(_) -> _,
        Receiver::<Pin>::go_on::<Host> as fn(_, _),
        EpochLoop::new as fn() -> _,
        <EpochLoop as Default>::default as fn() -> _,
        EpochLoop::run::<AnyBoard, ()> as fn(_, _, _),
        EpochLoop::pass::<AnyBoard, ()> as fn(_, _, _),
        (|losses| exhaust(PortLosses::iter(losses))) as fn(_),
        Receiver::<Pin>::reset_requested as fn(_) -> _,
        Receiver::<Pin>::last_report as fn(_) -> _,
        Receiver::<Pin>::last_verdict as fn(_) -> _,
        Receiver::<Pin>::configuration as fn(_) -> _,
        Receiver::<Pin>::interference as fn(_) -> _,
        Receiver::<Pin>::leap_second as fn(_) -> _,
        Receiver::<Pin>::velocity as fn(_) -> _,
        Receiver::<Pin>::last_epoch as fn(_) -> _,
        Receiver::<Pin>::statistic as fn(_, _) -> _,
        Receiver::<Pin>::pin as fn(_) -> _,
        (|receiver| exhaust(Receiver::<Pin>::statistics(receiver))) as fn(_),
        selftest::run as fn(_) -> _,
        Failure::name as fn(_) -> _,
        reset::hash as fn(_) -> _,
        ResetCause::word as fn(_) -> _,
        Record::of as fn(_) -> _,
        Record::fault as fn(_) -> _,
        <MemoryPin as OutputPin>::set_low as fn(_) -> _,
        <MemoryPin as OutputPin>::set_high as fn(_) -> _,
    );
}
