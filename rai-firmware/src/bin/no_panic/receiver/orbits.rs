//! Orbits, corrections of the ranges, and the navigator over them.

use core::fmt::{Debug, Display};

use raim_firmware::correction::{self, Klobuchar, Place, Preference, Ranges, Site, Troposphere};
use raim_firmware::ephemeris::{
    self, BroadcastError, Elapsed, Ephemeris, EphemerisError, GroupDelay, Health, Refusals, Source,
    StateVector, Store,
};
use raim_firmware::navigator::Navigator;
use raim_firmware::output::{InView, Places};
use raim_firmware::rates::{RateTally, Rates};

use crate::{exhaust, reach};

pub(super) fn ephemerides() {
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
        <Ephemeris as PartialEq>::eq as fn(_, _) -> _,
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

pub(super) fn corrections() {
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
        (|preference, noise, cost| Preference::weigh(preference, noise, cost))
            as fn(_, f32, fn(Ranges, f32) -> Option<f32>) -> _,
        Site::with_ranges as fn(_, _) -> _,
        Site::weighted_by as fn(_, _) -> _,
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
