//! A healthy sky with a hostile event: the module counts it by name, promises nothing wrong, sends
//! no NaN and no infinity, and continues with the next healthy epoch.
//!
//! | bad input | module |
//! |---|---|
//! | random bytes, wrong CRC, cut frames, longest frame, messages with a false length | [`wire`] |
//! | beginnings of frames that are none, at 1 to 20 Hz | [`beginnings`] |
//! | an epoch that goes back, the roll-over of the week | [`time`] |
//! | two satellites with one id, 64 satellites, ranges of 0, negative and 1e12 m | [`satellites`] |
//! | ephemerides that are impossible, stale, unhealthy, or change in the middle of a pass | [`ephemerides`] |
//! | a silent line, bad commands | [`port`] |
//! | another station number after a break, ranges that come again under a new tag | [`source`] |
//! | a host that reads too slowly | [`host`] |
//!
//! [`module::Module`] checks every sentence and the pin for the invariants of any output.

mod beginnings;
mod ephemerides;
mod frames;
mod host;
mod module;
mod port;
mod satellites;
mod source;
mod time;
mod wire;
