//! Every public function of the receiver around the core: wire parsers, orbits, corrections,
//! sentences, the epoch loop.

use core::fmt::{Debug, Display};

use embedded_hal::digital::{self, OutputPin};
use embedded_io::Write;
use raim_core::integrity::raim::detection::threshold::ThresholdError;
use raim_firmware::bit_rate::BitRate;
use raim_firmware::board::reset::{self, Record, ResetCause};
use raim_firmware::board::{Board, Note, PortLosses, SEALED_BYTES};
use raim_firmware::correction::{
    self, CAPACITY as N, Klobuchar, Place, Preference, Ranges, Site, Spread, Troposphere,
};
use raim_firmware::division;
use raim_firmware::ephemeris::{
    self, BroadcastError, Elapsed, Ephemeris, EphemerisError, GroupDelay, Health, Refusals, Source,
    StateVector, Store,
};
use raim_firmware::epoch_loop::EpochLoop;
use raim_firmware::input::{Counters, Event, Input};
use raim_firmware::input::{Suspicion, Suspicions};
use raim_firmware::navigator::Navigator;
use raim_firmware::outlet::Outlet;
use raim_firmware::output::geoid::Altitude;
use raim_firmware::output::mavlink::{Sender, dialect};
use raim_firmware::output::nmea::{self, Sentence, TimeOfDay};
use raim_firmware::output::schedule::{Due, Item, Schedule};
use raim_firmware::output::{InView, Interference, Motion, Places, nic};
use raim_firmware::pin::MemoryPin;
use raim_firmware::publisher::Publisher;
use raim_firmware::rates::{RateTally, Rates};
use raim_firmware::raw::{Band, Carrier, RawEpoch, RawSignal};
use raim_firmware::receiver::{Boot, Receiver, Verdicts};
use raim_firmware::ring::Ring;
use raim_firmware::selftest::{self, Failure};
use raim_firmware::settings::{self, CommandPort, Configuration, Order, Phase, Refusal, Setting};
use raim_firmware::time::{self, GpsTime};
use raim_firmware::timed_ring::{Taken, TimedRing};

use crate::{exhaust, reach};

/// Reaches all functions, in the order of the data.
pub fn reach_all() {
    bytes();
    wire();
    ephemerides();
    corrections();
    sentences();
    commands();
    the_loop();
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
        GpsTime::to_ms as fn(_) -> _,
        GpsTime::from_ms as fn(_) -> _,
        GpsTime::since_ms as fn(_, _) -> _,
        GpsTime::to_s as fn(_) -> _,
        GpsTime::nearest as fn(_, _) -> _,
        GpsTime::later_by_weeks as fn(_, _) -> _,
        time::glonass_time as fn(_, _, _) -> _,
        division::divided as fn(_, _) -> _,
    );
}

fn wire() {
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
        Suspicions::hear as fn(_, _, _),
        Suspicions::age as fn(_, _),
        Suspicions::is_sure as fn(_) -> _,
        Suspicions::confirms as fn(_, _, _) -> _,
        Suspicions::authenticated as fn(_) -> _,
        Suspicions::levels as fn(_) -> _,
        Interference::of as fn(_) -> _,
        Suspicion::from_number as fn(_) -> _,
        (|counters| exhaust(Counters::iter(counters))) as fn(_),
        Band::frequency_hz as fn(_) -> _,
        Band::is_spare as fn(_) -> _,
        Carrier::of as fn(_) -> _,
        Carrier::frequency_hz as fn(_) -> _,
        RawSignal::new as fn(_, _) -> _,
        RawSignal::with_cn0_dbhz as fn(_, _) -> _,
        RawSignal::codeless as fn(_) -> _,
        RawSignal::is_codeless as fn(_) -> _,
        RawSignal::with_doppler_hz as fn(_, _) -> _,
        RawSignal::cn0_dbhz as fn(_) -> _,
        RawSignal::doppler_hz as fn(_) -> _,
        RawEpoch::new as fn(_) -> _,
    );
}

fn ephemerides() {
    reach!(
        ephemeris::ura_m as fn(_) -> _,
        ephemeris::galileo_sisa_m as fn(_) -> _,
        ephemeris::glonass_accuracy_m as fn(_) -> _,
        Source::constellation as fn(_) -> _,
        Health::of_satellite as fn(_) -> _,
        Health::of_qzss as fn(_) -> _,
        Health::with as fn(_, _, _) -> _,
        Health::over as fn(_, _) -> _,
        Health::with_galileo as fn(_, _, _, _) -> _,
        Health::bad_alone as fn(_) -> _,
        Health::mentions as fn(_, _) -> _,
        Health::serves as fn(_, _) -> _,
        Health::is_bad as fn(_) -> _,
        Refusals::count as fn(_, _),
        Refusals::without_orbit as fn(_) -> _,
        (|refusals| exhaust(Refusals::iter(refusals))) as fn(_),
        GroupDelay::seconds as fn(_) -> _,
        GroupDelay::uncalibrated_m as fn(_) -> _,
        Ephemeris::new as fn(_) -> _,
        Ephemeris::of_state as fn(_) -> _,
        Ephemeris::satellite as fn(_) -> _,
        Ephemeris::source as fn(_) -> _,
        Ephemeris::toe as fn(_) -> _,
        Ephemeris::accuracy_m as fn(_, _) -> _,
        Ephemeris::usable_at as fn(_, _) -> _,
        Ephemeris::serves as fn(_, _) -> _,
        Ephemeris::at as fn(_, _, _) -> _,
        Elapsed::to_s as fn(_) -> _,
        Ephemeris::group_delay as fn(_, _) -> _,
        <StateVector as PartialEq>::eq as fn(_, _) -> _,
        Store::new as fn() -> _,
        Store::insert as fn(_, _, _) -> _,
        (|store, satellites| Store::observe(store, satellites)) as fn(_, core::array::IntoIter<_, 4>),
        Store::look_from as fn(_, _, _, _) -> _,
        Store::forget_position as fn(_) -> _,
        Store::displaced as fn(_) -> _,
        Store::advance as fn(_, _) -> _,
        Store::redate as fn(_, _) -> _,
        Store::forget as fn(_, _),
        Store::get as fn(_, _, _) -> _,
        Store::len as fn(_) -> _,
        Store::is_empty as fn(_) -> _,
        <BroadcastError as Display>::fmt as fn(_, _) -> _,
        <EphemerisError as Display>::fmt as fn(_, _) -> _,
    );
}

fn corrections() {
    reach!(
        correction::choose as fn(_, _, _, _) -> _,
        correction::ionosphere_free as fn(_, _) -> _,
        Troposphere::above as fn(_, _) -> _,
        Troposphere::zenith_m as fn(_) -> _,
        Troposphere::delay_m as fn(_, _) -> _,
        Klobuchar::new as fn(_) -> _,
        Klobuchar::of_beidou as fn(_) -> _,
        Klobuchar::slant as fn(_, _, _) -> _,
        Place::at as fn(_, _, _) -> _,
        Preference::new as fn() -> _,
        <Preference as Default>::default as fn() -> _,
        Preference::ranges as fn(_) -> _,
        (|preference, cost| Preference::weigh(preference, cost)) as fn(_, fn(Ranges) -> Option<f32>) -> _,
        Site::with_ranges as fn(_, _) -> _,
        Site::weighted_by as fn(_, _) -> _,
        Site::spread as fn(_, _, _) -> _,
        Spread::cost as fn(_, _, _) -> _,
        correction::Choices::preferred as fn(_) -> _,
        correction::Located::has_pair as fn(_) -> _,
        correction::locate as fn(_, _, _, _, _, _),
        correction::coarse as fn(_, _, _),
        Site::new as fn(_, _, _, _) -> _,
        Site::correct as fn(_, _, _, _),
        (|refusals| exhaust(correction::Refusals::iter(refusals))) as fn(_),
        Navigator::new as fn(_) -> _,
        Navigator::learn as fn(_, _, _) -> _,
        Navigator::guess as fn(_, _),
        Navigator::hear_ionosphere as fn(_, _, _, _),
        Navigator::configure as fn(_, _) -> _,
        Navigator::requirements as fn(_) -> _,
        Navigator::tally as fn(_) -> _,
        Navigator::judge as fn(_, _, _, _) -> _,
        Navigator::report as fn(_) -> _,
        Navigator::forget_position as fn(_),
        Navigator::interrupt as fn(_),
        Navigator::correct_utc as fn(_),
        Navigator::redate as fn(_, _) -> _,
        Navigator::distrust as fn(_, _),
        Navigator::know_height as fn(_, _),
        Navigator::velocity as fn(_) -> _,
        Navigator::epoch as fn(_) -> _,
        Navigator::rate_tally as fn(_) -> _,
        <Navigator as Places>::place_of as fn(_, _) -> _,
        <InView<'_> as Debug>::fmt as fn(_, _) -> _,
        Rates::new as fn() -> _,
        <Rates as Default>::default as fn() -> _,
        Rates::tally as fn(_) -> _,
        Rates::velocity as fn(_, _, _, _, _, _) -> _,
        Rates::of_satellite as fn(_, _, _, _) -> _,
        (|tally| exhaust(RateTally::iter(tally))) as fn(_),
    );
}

fn sentences() {
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

fn commands() {
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
        EpochLoop::run::<AnyBoard> as fn(_, _, _),
        EpochLoop::pass::<AnyBoard> as fn(_, _, _),
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

/// Type of an event handler.
type Tell = fn(Event<'_>);

/// Type of the function that an outlet calls when bytes are ready to send.
type Wake = fn();

/// A host port with any result of a writer, valid or not.
struct Host(Result<usize, embedded_io::ErrorKind>);

impl embedded_io::ErrorType for Host {
    type Error = embedded_io::ErrorKind;
}

impl Write for Host {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Self::Error> {
        core::hint::black_box(bytes);
        core::hint::black_box(self.0)
    }

    fn flush(&mut self) -> Result<(), Self::Error> {
        core::hint::black_box(self.0).map(drop)
    }
}

/// A pin that may refuse.
struct Pin(Result<(), digital::ErrorKind>);

impl digital::ErrorType for Pin {
    type Error = digital::ErrorKind;
}

impl OutputPin for Pin {
    fn set_low(&mut self) -> Result<(), Self::Error> {
        core::hint::black_box(self.0)
    }

    fn set_high(&mut self) -> Result<(), Self::Error> {
        core::hint::black_box(self.0)
    }
}

/// A board with arbitrary results.
struct AnyBoard {
    taken: Taken,
    host: Host,
    number: u64,
    losses: PortLosses,
    cause: ResetCause,
    sealed: [u8; SEALED_BYTES],
}

impl Board for AnyBoard {
    type Pin = Pin;
    type Host = Host;

    fn clock_error_ppm(&self) -> u32 {
        core::hint::black_box(self.number as u32)
    }

    fn gnss(&mut self, chunk: &mut [u8]) -> Taken {
        core::hint::black_box(chunk);
        core::hint::black_box(self.taken)
    }

    fn command(&mut self) -> Option<u8> {
        core::hint::black_box(None)
    }

    fn host(&mut self) -> &mut Host {
        &mut self.host
    }

    fn host_room(&self) -> usize {
        core::hint::black_box(self.number) as usize
    }

    fn now_ms(&self) -> u64 {
        core::hint::black_box(self.number)
    }

    fn now_ticks(&self) -> u64 {
        core::hint::black_box(self.number)
    }

    fn driven_ticks(&self, _: &Pin) -> u64 {
        core::hint::black_box(self.number)
    }

    fn losses(&self) -> PortLosses {
        core::hint::black_box(self.losses)
    }

    fn feed_watchdog(&mut self) {}

    fn sleep(&mut self) -> Option<u64> {
        core::hint::black_box(None)
    }

    fn reset_cause(&self) -> ResetCause {
        core::hint::black_box(self.cause)
    }

    fn sealed(&mut self) -> &mut [u8; SEALED_BYTES] {
        core::hint::black_box(&mut self.sealed)
    }

    fn set_gnss_rate(&mut self, baud: u32) {
        core::hint::black_box(baud);
    }

    fn note(&mut self, note: Note) {
        core::hint::black_box(note);
    }
}
