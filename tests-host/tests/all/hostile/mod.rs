//! A healthy sky in which something hostile happens: the module counts it by name, promises nothing wrong, says no
//! number that is none, and goes on with the next healthy epoch.
//!
//! | bad input | where |
//! |---|---|
//! | random bytes, wrong CRC, cut frames, longest frame, messages that lie about their length | [`wire`] |
//! | beginnings of frames that are none, at 1 to 20 Hz | [`beginnings`] |
//! | an epoch that goes back, the roll-over of the week | [`time`] |
//! | two satellites with one id, 64 satellites, ranges of 0, negative and 1e12 m | [`satellites`] |
//! | ephemerides that are impossible, stale, unhealthy, or change in the middle of a pass | [`ephemerides`] |
//! | a silent line, bad commands | [`port`] |
//! | a host that reads too slowly | [`host`] |
//!
//! [`module::Module`] holds every sentence and the pin to what must always hold, whatever came in.

mod beginnings;
mod ephemerides;
mod frames;
mod host;
mod module;
mod port;
mod satellites;
mod time;
mod wire;
