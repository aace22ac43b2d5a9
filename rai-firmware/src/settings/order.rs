//! Orders: commands that change no setting and that the receiver carries out.

use super::place::{HEIGHT_M, PLACE_SIGMA_M};
use super::read::{next_number, none};
use super::refusal::Refusal;

/// Makes the orders from their keys. An order with numbers states the type and range of each behind
/// its name, and one that a small build lacks its feature.
macro_rules! orders {
    ($($(#[cfg($condition:meta)])? $key:literal $order:ident $(($($of:ident in $range:expr),+))? $(if $feature:literal)?: $text:literal,)*) => {
        /// Order of the host.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum Order {
            $($(#[cfg($condition)])? #[doc = $text] $order $(($($of),+))?,)*
        }

        impl Order {
            /// Key of every order, its values, and one line for INTERFACES.md, which a test
            /// compares.
            pub const ALL: &'static [[&'static str; 3]] =
                &[$($(#[cfg($condition)])? [$key, orders!(@values $($($of)+)?), $text],)*];

            /// Reads the order with this key and its values; `None` if no order has it.
            pub fn read<'v>(
                key: &str,
                mut values: impl Iterator<Item = &'v str>,
            ) -> Option<Result<Self, Refusal>> {
                match key {
                    $($($key if !cfg!(feature = $feature) => Some(Err(Refusal::NotInBuild)),)?)*
                    $($(#[cfg($condition)])? $key => Some(orders!(@read values, $order $(($($of in $range),+))?)),)*
                    _ => None,
                }
            }
        }
    };
    (@values) => { "none" };
    (@values $of:ident) => { "one number" };
    (@values $first:ident $second:ident) => { "two numbers" };
    (@read $values:ident, $order:ident) => {
        none(&mut $values).map(|()| Self::$order)
    };
    (@read $values:ident, $order:ident ($($of:ident in $range:expr),+)) => {
        (|| {
            let order = Self::$order($(next_number(&mut $values, $range)? as $of),+);
            none(&mut $values).map(|()| order)
        })()
    };
}

/// Range of full GPS weeks, up to the end of the eighth cycle in 2137.
const WEEKS: (f64, f64) = (0.0, 8191.0);

/// Seconds of UNIX time from 2001 to 2103.
#[cfg(feature = "osnma")]
const UTC_S: (f64, f64) = (1e9, 4.2e9);

/// Bounds of a time from the host, s.
#[cfg(feature = "osnma")]
const BOUND_S: (f64, f64) = (1.0, 3600.0);

orders! {
    "STATS" Statistics: "[Counters](#counters) by name, in as many answers as they need",
    "SELFTEST" SelfTest: "[Known answers](#self-test) are computed again",
    "CONFIRM" Confirm: "The settings in force are meant",
    "FORGET" Forget: "The module forgets the last position, the delays of epochs, the time, the source of the ranges, and the receiver's word on jamming and spoofing",
    "WEEK" Week(u16 in WEEKS): "The next epoch is of this GPS week, 0 to 8191, not rolled over: the date of a recording, or of GPS alone after November 2038",
    "HEIGHTAID" Height(f64 in HEIGHT_M, f64 in PLACE_SIGMA_M) if "aiding": "The antenna is now at this height above the ellipsoid, m, known to this standard deviation, m: from a barometer, a map or a deck. For 10 s it adds a row to those of the satellites, with a standard deviation of at least 3 m that grows by 3 m/s and the vertical speed",
    #[cfg(feature = "osnma")]
    "TRUST" Trust(f64 in UTC_S, f64 in BOUND_S): "It is now this time, in UTC seconds since 1970, to within this bound, s, which also covers the delay of the command and that of an epoch. The module carries it on with 250 ppm. An epoch of another time is an alert (`REPLAY`), whatever the systems. Tags of OSNMA are proof within 30 s, those with a later key within 330 s",
    "RESET" Reset: "The module starts again, with the pin low",
}
