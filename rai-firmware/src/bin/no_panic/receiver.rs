//! Every public function of the receiver around the core: wire parsers, orbits, corrections, sentences, the epoch loop.

use core::fmt::Display;

use embedded_hal::digital::{self, OutputPin};
use embedded_io::Write;
use rai_core::threshold::ThresholdError;
use rai_firmware::atmosphere::{Klobuchar, Troposphere};
use rai_firmware::config::{self, Command, CommandPort, Configuration, Phase, Refusal};
use rai_firmware::correction::{self, CAPACITY as N, Site};
use rai_firmware::ephemeris::{
    self, BroadcastError, Ephemeris, EphemerisError, GroupDelay, Refusals, Source, Store,
};
use rai_firmware::navigator::Navigator;
use rai_firmware::nmea::{self, Sentence, TimeOfDay};
use rai_firmware::outlet::Outlet;
use rai_firmware::receiver::{Receiver, Verdicts};
use rai_firmware::reset::{self, Record, ResetCause};
use rai_firmware::ring::Ring;
use rai_firmware::rtcm::{self, Decoder, RawEpoch};
use rai_firmware::selftest::{self, Failure};
use rai_firmware::signal::{self, Band};
use rai_firmware::time::GpsTime;

use crate::{exhaust, reach};

/// All of them, in the order of the data.
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
        Outlet::<64, Clock, Wake>::new as fn(_, _, _) -> _,
        Outlet::<64, Clock, Wake>::lines as fn(_) -> _,
        <Outlet<'_, 64, Clock, Wake> as Write>::write as fn(_, _) -> _,
        <Outlet<'_, 64, Clock, Wake> as Write>::flush as fn(_) -> _,
        GpsTime::to_ms as fn(_) -> _,
        GpsTime::from_ms as fn(_) -> _,
        GpsTime::since_ms as fn(_, _) -> _,
        GpsTime::to_s as fn(_) -> _,
        GpsTime::nearest as fn(_, _) -> _,
    );
}

fn wire() {
    reach!(
        Decoder::new as fn() -> _,
        <Decoder as Default>::default as fn() -> _,
        Decoder::push as fn(_, _) -> _,
        Decoder::pending as fn(_) -> _,
        Decoder::silence as fn(_) -> _,
        Decoder::is_between_frames as fn(_) -> _,
        Decoder::is_within_epoch as fn(_) -> _,
        Decoder::counters as fn(_) -> _,
        Decoder::time as fn(_) -> _,
        RawEpoch::new as fn(_) -> _,
        (|counters| exhaust(rtcm::Counters::iter(counters))) as fn(_),
    );
}

fn ephemerides() {
    reach!(
        ephemeris::ura_m as fn(_) -> _,
        ephemeris::galileo_sisa_m as fn(_) -> _,
        Source::constellation as fn(_) -> _,
        Refusals::count as fn(_, _),
        (|refusals| exhaust(Refusals::iter(refusals))) as fn(_),
        GroupDelay::seconds as fn(_) -> _,
        GroupDelay::uncalibrated_m as fn(_) -> _,
        Ephemeris::new as fn(_) -> _,
        Ephemeris::satellite as fn(_) -> _,
        Ephemeris::source as fn(_) -> _,
        Ephemeris::toe as fn(_) -> _,
        Ephemeris::accuracy_m as fn(_) -> _,
        Ephemeris::usable_at as fn(_, _) -> _,
        Ephemeris::at as fn(_, _, _) -> _,
        Ephemeris::group_delay as fn(_, _) -> _,
        Store::new as fn() -> _,
        Store::insert as fn(_, _, _) -> _,
        Store::get as fn(_, _, _) -> _,
        Store::len as fn(_) -> _,
        Store::is_empty as fn(_) -> _,
        <BroadcastError as Display>::fmt as fn(_, _) -> _,
        <EphemerisError as Display>::fmt as fn(_, _) -> _,
    );
}

fn corrections() {
    reach!(
        Band::frequency_hz as fn(_) -> _,
        Band::from_msm as fn(_, _) -> _,
        signal::choose as fn(_, _) -> _,
        signal::ionosphere_free as fn(_, _) -> _,
        Troposphere::above as fn(_, _) -> _,
        Troposphere::zenith_m as fn(_) -> _,
        Troposphere::delay_m as fn(_, _) -> _,
        Klobuchar::new as fn(_) -> _,
        Klobuchar::delay_m as fn(_, _, _, _, _) -> _,
        correction::locate as fn(_, _, _) -> _,
        correction::coarse as fn(_, _) -> _,
        Site::new as fn(_, _, _, _) -> _,
        Site::correct as fn(_, _, _) -> _,
        (|refusals| exhaust(correction::Refusals::iter(refusals))) as fn(_),
        Navigator::new as fn(_) -> _,
        Navigator::learn as fn(_, _, _) -> _,
        Navigator::guess as fn(_, _),
        Navigator::configure as fn(_, _) -> _,
        Navigator::requirements as fn(_) -> _,
        Navigator::tally as fn(_) -> _,
        Navigator::judge as fn(_, _, _) -> _,
    );
}

fn sentences() {
    reach!(
        TimeOfDay::new as fn(_, _) -> _,
        TimeOfDay::parts as fn(_) -> _,
        Sentence::new as fn(_) -> _,
        Sentence::text as fn(_, _) -> _,
        Sentence::clipped as fn(_, _, _) -> _,
        Sentence::empty as fn(_) -> _,
        Sentence::integer as fn(_, _, _) -> _,
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
        nmea::write_epoch::<Host, N> as fn(_, _, _, _, _) -> _,
        nmea::write_stale::<Host> as fn(_, _, _, _) -> _,
        nmea::write_version::<Host> as fn(_, _, _, _, _) -> _,
        (|key, values, host| nmea::write_answer(key, values.iter().copied(), host))
            as fn(_, &[&str], &mut Host) -> _,
        nmea::write_refusal::<Host> as fn(_, _, _) -> _,
        (|counters, host| nmea::write_counters(Verdicts::iter(counters), host)) as fn(_, &mut Host) -> _,
    );
}

fn commands() {
    reach!(
        config::decimal as fn(_) -> _,
        config::scientific as fn(_) -> _,
        (|key, values| Command::read(key, values.iter().copied())) as fn(_, &[&str]) -> _,
        <Refusal as From<ThresholdError>>::from as fn(_) -> _,
        Phase::requirements as fn(_) -> _,
        Configuration::at_start as fn() -> _,
        Configuration::with as fn(_, _) -> _,
        Configuration::strategy as fn(_) -> _,
        CommandPort::new as fn() -> _,
        CommandPort::push::<Host> as fn(_, _, _, _) -> _,
        (|port| exhaust(CommandPort::counters(port))) as fn(_),
    );
}

fn the_loop() {
    reach!(
        Receiver::<Pin>::new as fn(_, _) -> _,
        Receiver::<Pin>::greet::<Host> as fn(_, _),
        Receiver::<Pin>::gnss::<Host> as fn(_, _, _, _),
        Receiver::<Pin>::tick::<Host> as fn(_, _, _),
        Receiver::<Pin>::command::<Host> as fn(_, _, _),
        Receiver::<Pin>::reset_requested as fn(_) -> _,
        Receiver::<Pin>::last_verdict as fn(_) -> _,
        Receiver::<Pin>::configuration as fn(_) -> _,
        Receiver::<Pin>::pin as fn(_) -> _,
        (|receiver| exhaust(Receiver::<Pin>::statistics(receiver))) as fn(_),
        selftest::run as fn() -> _,
        Failure::name as fn(_) -> _,
        reset::hash as fn(_) -> _,
        ResetCause::from_flags as fn(_) -> _,
        <ResetCause as Display>::fmt as fn(_, _) -> _,
        Record::of as fn(_) -> _,
        Record::fault as fn(_) -> _,
    );
}

/// What an outlet asks for the time, ms.
type Clock = fn() -> u64;

/// Whom an outlet tells that there is something to send.
type Wake = fn();

/// A host port that does anything a writer may do, and some that it may not.
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
