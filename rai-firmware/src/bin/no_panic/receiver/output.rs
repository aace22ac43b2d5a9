//! Sentences out, and commands in.

use raim_core::internals::integrity::raim::detection::threshold::ThresholdError;
use raim_firmware::correction::CAPACITY as N;
use raim_firmware::output::geoid::Altitude;
use raim_firmware::output::mavlink::{Sender, dialect};
use raim_firmware::output::nmea::{self, Sentence, TimeOfDay};
use raim_firmware::output::schedule::{Due, Item, Schedule};
use raim_firmware::output::{Motion, nic};
use raim_firmware::publisher::Publisher;
use raim_firmware::receiver::Verdicts;
use raim_firmware::settings::{self, CommandPort, Configuration, Order, Phase, Refusal, Setting};

use super::stand_in::Host;
use crate::{exhaust, reach};

pub(super) fn sentences() {
    reach!(
        TimeOfDay::new as fn(_, _) -> _,
        TimeOfDay::parts as fn(_) -> _,
        TimeOfDay::date as fn(_) -> _,
        Sentence::new as fn(_) -> _,
        Sentence::text as fn(_, _) -> _,
        Sentence::clipped as fn(_, _, _) -> _,
        Sentence::empty as fn(_) -> _,
        Sentence::integer as fn(_, _, _) -> _,
        Sentence::hexadecimal as fn(_, _) -> _,
        Sentence::number as fn(_, _, _, _) -> _,
        Sentence::optional as fn(_, _, _, _) -> _,
        Sentence::probability as fn(_, _) -> _,
        Sentence::time as fn(_, _) -> _,
        Sentence::angle as fn(_, _, _, _) -> _,
        Sentence::satellite as fn(_, _) -> _,
        Sentence::satellite_number as fn(_, _) -> _,
        Sentence::finish as fn(_) -> _,
    );
    reach!(
        nmea::write_sentence::<Host> as fn(_, _) -> _,
        nmea::write_epoch::<Host, N> as fn(_, _, _) -> _,
        nmea::write_losses::<Host> as fn(_, _) -> _,
        Sender::write_epoch::<Host, N> as fn(_, _, _, _) -> _,
        Sender::write_stale::<Host> as fn(_, _, _, _) -> _,
        dialect::Kind::bytes as fn(_) -> _,
        dialect::Kind::name as fn(_) -> _,
        Altitude::of as fn(_) -> _,
        nic::category as fn(_) -> _,
        Motion::of as fn(_) -> _,
        Motion::speed_m_s as fn(_) -> _,
        Item::named as fn(_) -> _,
        Item::is_built as fn(_) -> _,
        Schedule::with as fn(_, _, _) -> _,
        (|schedule| exhaust(Schedule::rates(schedule))) as fn(_),
        Schedule::due as fn(_, _) -> _,
        Due::has as fn(_, _) -> _,
        Due::without as fn(_, _) -> _,
        Publisher::new as fn(_) -> _,
        Publisher::settings_hash as fn(_) -> _,
        Publisher::reconfigured as fn(_, _),
        Publisher::tell::<Host, N> as fn(_, _, _, _) -> _,
        Publisher::tell_without_epoch::<Host> as fn(_, _, _, _, _, _) -> _,
        Publisher::tick::<Host> as fn(_, _, _, _, _) -> _,
        nmea::write_without_epoch::<Host> as fn(_, _, _, _, _) -> _,
        nmea::write_version::<Host> as fn(_, _, _, _, _) -> _,
        (|key, values, warning, host| nmea::write_answer(key, values.iter().copied(), warning, host))
            as fn(_, &[&str], Option<&str>, &mut Host) -> _,
        nmea::write_refusal::<Host> as fn(_, _, _) -> _,
        (|counters, host| nmea::write_counters(Verdicts::iter(counters), host)) as fn(_, &mut Host) -> _,
    );
}

pub(super) fn commands() {
    reach!(
        settings::decimal as fn(_) -> _,
        settings::scientific as fn(_) -> _,
        <Refusal as From<ThresholdError>>::from as fn(_) -> _,
        Phase::requirements as fn(_) -> _,
        Phase::longest_time_to_alert_s as fn(_) -> _,
        Setting::named as fn(_) -> _,
        Setting::key as fn(_) -> _,
        Setting::row as fn(_) -> _,
        Setting::documentation as fn(_) -> _,
        (|key, values| Order::read(key, values.iter().copied())) as fn(&str, &[&str]) -> _,
        settings::Baud::rate as fn(_) -> _,
        settings::Preset::ism as fn(_) -> _,
        settings::Promises::preset as fn(_) -> _,
        settings::Promises::ism as fn(_) -> _,
        settings::Systems::of as fn(_) -> _,
        settings::Systems::contains as fn(_, _) -> _,
        Configuration::at_start as fn() -> _,
        (|settings, key, values| Configuration::with(settings, key, values.iter().copied()))
            as fn(Configuration, &str, &[&str]) -> _,
        Configuration::requirements as fn(_) -> _,
        Configuration::mask_rad as fn(_) -> _,
        Configuration::promise_hash as fn(_) -> _,
        (|settings, setting| {
            Configuration::fields(settings, setting, &mut |field| {
                core::hint::black_box(field);
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
