//! Bytes in: rings, time, and the parsers of the wire.

use embedded_io::Write;
use raim_firmware::division;
use raim_firmware::input::{Counters, Input, Suspicion, Suspicions};
use raim_firmware::osnma::{Osnma, Tally, Verdict};
use raim_firmware::outlet::Outlet;
use raim_firmware::output::Interference;
use raim_firmware::raw::{Band, Carrier, RawEpoch, RawSignal};
use raim_firmware::ring::Ring;
use raim_firmware::time::{self, GpsTime};
use raim_firmware::timed_ring::TimedRing;

use super::stand_in::{Tell, Wake};
use crate::{exhaust, reach};

pub(super) fn bytes() {
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

pub(super) fn authentication() {
    reach!(
        Osnma::<36, 16, 72>::new as fn() -> _,
        Osnma::<36, 16, 72>::hear as fn(_, _, _, _, _, _),
        Osnma::<36, 16, 72>::work as fn(_, _, _) -> _,
        Osnma::<36, 16, 72>::seal_of as fn(_, _) -> _,
        Osnma::<36, 16, 72>::summary as fn(_, _, _) -> _,
        Osnma::<36, 16, 72>::tally as fn(_) -> _,
        Osnma::<36, 16, 72>::forget_keys as fn(_),
        Verdict::is_proved as fn(_) -> _,
        (|tally| exhaust(Tally::iter(tally))) as fn(_),
    );
}

pub(super) fn wire() {
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
        RawSignal::with_code as fn(_, _) -> _,
        RawSignal::codeless as fn(_) -> _,
        RawSignal::is_codeless as fn(_) -> _,
        RawSignal::with_doppler_hz as fn(_, _) -> _,
        RawSignal::cn0_dbhz as fn(_) -> _,
        RawSignal::doppler_hz as fn(_) -> _,
        RawEpoch::new as fn(_) -> _,
    );
}
