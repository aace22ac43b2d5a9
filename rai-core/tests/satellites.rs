//! Names of satellites and constellations, as they are read and written.
#![allow(clippy::unwrap_used)]

use rai_core::satellite::{Constellation, SatelliteId};

#[test]
fn letters_are_those_of_rinex() {
    use Constellation::{Beidou, Galileo, Glonass, Gps};
    for (letter, constellation) in [('G', Gps), ('C', Beidou), ('E', Galileo), ('R', Glonass)] {
        assert_eq!(Constellation::from_letter(letter), Some(constellation));
        assert_eq!(constellation.letter(), letter);
    }
    assert_eq!(Constellation::from_letter('J'), None);
}

#[test]
fn satellite_is_written_with_two_digits() {
    for (constellation, number, want) in [
        (Constellation::Gps, 7, "G07"),
        (Constellation::Beidou, 61, "C61"),
        (Constellation::Galileo, 1, "E01"),
    ] {
        let satellite = SatelliteId::new(constellation, number).unwrap();
        assert_eq!(satellite.to_string(), want);
        assert_eq!((satellite.constellation(), satellite.number()), (constellation, number));
    }
}
