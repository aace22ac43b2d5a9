//! Programs for a computer with a GNSS receiver: the library behind the command `rai`.
//!
//! [`run`] is the module itself as a service. A receiver's bytes come in; sentences and a fail-safe
//! pin go out. It runs the firmware's own [`Receiver`](raim_firmware::receiver::Receiver) in the
//! firmware's own [epoch loop](raim_firmware::epoch_loop), so that it prints what the chip prints.

pub mod configure;
pub mod run;
