//! What the module does with skies, recordings, faults and attacks, on the host and on the emulated board.
//!
//! One program for all: what they have in common is compiled and linked once.

mod accuracy;
mod araim;
mod araim_constellation;
mod attack;
mod board;
mod board_clock_aid;
mod board_recording;
mod campaign;
mod capi;
mod capi_bits;
mod capture;
mod consumers;
mod dashboard;
mod demo;
mod evaluate;
mod faults;
mod full_sky;
mod fuzz_corpus;
mod gnss_port;
mod gpsd;
mod host_and_target;
mod hostile;
mod injection;
mod moving_receiver;
mod no_panic;
mod parity;
mod peers;
mod pin_in_time;
mod precision;
mod recordings;
mod second_board;
mod settings;
mod sky;
mod smaller_msm;
mod soak;
mod tables;
mod threshold_vectors;
mod ubx;
mod vectors;
mod velocity;
