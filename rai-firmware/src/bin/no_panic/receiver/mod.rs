//! Every public function of the receiver around the core, in the order of the data.

mod input;
mod orbits;
mod output;
mod stand_in;
mod whole;

/// Reaches all functions.
pub fn reach_all() {
    input::bytes();
    input::authentication();
    input::wire();
    orbits::ephemerides();
    orbits::corrections();
    output::sentences();
    output::commands();
    whole::the_loop();
}
