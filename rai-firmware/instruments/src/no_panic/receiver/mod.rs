//! The documented interface of the module around the core.

mod stand_in;

use embedded_hal::digital::OutputPin;
use embedded_io::Write;
use raim_core::internals::integrity::raim::detection::threshold::ThresholdError;
use raim_firmware::bit_rate::BitRate;
use raim_firmware::board::reset::{self, Record, ResetCause};
use raim_firmware::epoch_loop::EpochLoop;
use raim_firmware::input::Input;
use raim_firmware::input::{Suspicion, Suspicions};
use raim_firmware::observer::{Judged, Observer};
use raim_firmware::osnma::Standing;
use raim_firmware::outlet::Outlet;
use raim_firmware::pin::MemoryPin;
use raim_firmware::receiver::{Boot, Receiver};
use raim_firmware::ring::Ring;
use raim_firmware::settings::{self, CommandPort, Configuration, Phase, Refusal, Setting};
use raim_firmware::timed_ring::TimedRing;

use crate::{exhaust, reach};
use stand_in::{AnyBoard, Host, Pin, Tell, Wake};

/// Reaches all functions.
pub fn reach_all() {
    the_loop();
    bytes();
    input();
    settings_and_commands();
}

fn the_loop() {
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
        Receiver::<Pin>::standing as fn(_) -> _,
        Standing::word as fn(_) -> _,
        Receiver::<Pin>::frames as fn(_) -> _,
        <BitRate as Default>::default as fn() -> _,
        BitRate::new as fn() -> _,
        BitRate::receive as fn(_, _),
        BitRate::next as fn(_, _, _) -> _,
        Receiver::<Pin>::note_losses as fn(_, _),
        Receiver::<Pin>::losses as fn(_) -> _,
        Receiver::<Pin>::tick::<Host> as fn(_, _, _) -> _,
        Receiver::<Pin>::command::<Host> as fn(_, _, _),
        Receiver::<Pin>::command_byte::<Host> as fn(_, _, _) -> _,
        Receiver::<Pin>::set::<Host> as fn(_, _, _, _) -> _,
        Receiver::<Pin>::has_more_to_say as fn(_) -> _,
        Receiver::<Pin>::go_on::<Host> as fn(_, _),
        <() as Observer>::epoch as fn(_, _),
        <() as Observer>::without_epoch as fn(_, _),
        Judged::time as fn(_) -> _,
        Judged::report as fn(_) -> _,
        EpochLoop::new as fn() -> _,
        <EpochLoop as Default>::default as fn() -> _,
        EpochLoop::run::<AnyBoard, ()> as fn(_, _, _),
        EpochLoop::pass::<AnyBoard, ()> as fn(_, _, _),
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
        reset::hash as fn(_) -> _,
        ResetCause::word as fn(_) -> _,
        Record::of as fn(_) -> _,
        Record::fault as fn(_) -> _,
        <MemoryPin as OutputPin>::set_low as fn(_) -> _,
        <MemoryPin as OutputPin>::set_high as fn(_) -> _,
    );
}

fn bytes() {
    reach!(
        Ring::<64>::new as fn() -> _,
        <Ring<64> as Default>::default as fn() -> _,
        Ring::<64>::len as fn(_) -> _,
        Ring::<64>::is_empty as fn(_) -> _,
        Ring::<64>::dropped as fn(_) -> _,
        Ring::<64>::high_water as fn(_) -> _,
        Ring::<64>::push as fn(_, _) -> _,
        Ring::<64>::offer as fn(_, _) -> _,
        Ring::<64>::push_whole as fn(_, _) -> _,
        Ring::<64>::drop_whole as fn(_, _),
        Ring::<64>::pop as fn(_) -> _,
        Ring::<64>::read_into as fn(_, _) -> _,
        Ring::<64>::room as fn(_) -> _,
        Outlet::<64, Wake>::new as fn(_, _) -> _,
        Outlet::<64, Wake>::lost as fn(_) -> _,
        Outlet::<64, Wake>::room as fn(_) -> _,
        <Outlet<'_, 64, Wake> as Write>::write as fn(_, _) -> _,
        <Outlet<'_, 64, Wake> as Write>::flush as fn(_) -> _,
        TimedRing::<64, 8>::new as fn() -> _,
        <TimedRing<64, 8> as Default>::default as fn() -> _,
        TimedRing::<64, 8>::push as fn(_, _, _),
        TimedRing::<64, 8>::lose as fn(_),
        TimedRing::<64, 8>::len as fn(_) -> _,
        TimedRing::<64, 8>::is_empty as fn(_) -> _,
        TimedRing::<64, 8>::lost as fn(_) -> _,
        TimedRing::<64, 8>::given_up as fn(_) -> _,
        TimedRing::<64, 8>::high_water as fn(_) -> _,
        TimedRing::<64, 8>::take as fn(_, _, _) -> _,
    );
}

fn input() {
    reach!(
        Input::new as fn() -> _,
        <Input as Default>::default as fn() -> _,
        (|input, bytes, came_ms, tell| Input::feed(input, bytes, came_ms, tell)) as fn(_, _, _, Tell),
        (|input, tell| Input::silence(input, tell)) as fn(_, Tell),
        (|input, tell| Input::pause(input, tell)) as fn(_, Tell),
        (|input, tell| Input::end_epoch(input, tell)) as fn(_, Tell),
        Input::has_open_epoch as fn(_) -> _,
        Input::interrupt as fn(_),
        Input::confirm as fn(_, _, _),
        Input::assume as fn(_, _),
        Input::hears_others as fn(_) -> _,
        Input::forget as fn(_),
        Input::counters as fn(_) -> _,
        Input::time as fn(_) -> _,
        Input::leap_second as fn(_) -> _,
        Suspicion::number as fn(_) -> _,
        Suspicions::receive as fn(_, _, _),
        Suspicions::age as fn(_, _),
        Suspicions::is_sure as fn(_) -> _,
        Suspicions::confirms as fn(_, _, _) -> _,
        Suspicions::authenticated as fn(_) -> _,
        Suspicions::levels as fn(_) -> _,
        Suspicion::from_number as fn(_) -> _,
    );
}

fn settings_and_commands() {
    reach!(
        settings::decimal as fn(_) -> _,
        settings::scientific as fn(_) -> _,
        <Refusal as From<ThresholdError>>::from as fn(_) -> _,
        Phase::requirements as fn(_) -> _,
        Phase::longest_time_to_alert_s as fn(_) -> _,
        Setting::named as fn(_) -> _,
        Setting::key as fn(_) -> _,
        settings::Baud::rate as fn(_) -> _,
        settings::Preset::ism as fn(_) -> _,
        settings::Promises::preset as fn(_) -> _,
        settings::Promises::ism as fn(_) -> _,
        settings::Systems::of as fn(_) -> _,
        settings::Systems::contains as fn(_, _) -> _,
        (|settings, key, values| Configuration::with(settings, key, values.iter().copied()))
            as fn(Configuration, &str, &[&str]) -> _,
        Configuration::requirements as fn(_) -> _,
        Configuration::mask_rad as fn(_) -> _,
        Configuration::promise_hash as fn(_) -> _,
        (|settings, setting| {
            Configuration::fields(settings, setting, &mut |field| {
                ::core::hint::black_box(field);
            });
        }) as fn(&Configuration, Setting),
        Configuration::seal as fn(_, _),
        Configuration::unseal as fn(_) -> _,
        Configuration::strategy as fn(_) -> _,
        Configuration::warning as fn(_) -> _,
        Configuration::continuity as fn(_) -> _,
        Configuration::hash as fn(_) -> _,
        Configuration::write::<Host> as fn(_, _) -> _,
        CommandPort::new as fn() -> _,
        CommandPort::push::<Host> as fn(_, _, _, _) -> _,
        CommandPort::set::<Host> as fn(_, _, _, _, _) -> _,
        (|port| exhaust(CommandPort::counters(port))) as fn(_),
    );
}
