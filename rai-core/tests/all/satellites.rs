//! Names of satellites and constellations, parsed and printed.
#![allow(clippy::unwrap_used)]

use raim_core::satellite::{Constellation, SatelliteId};

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
        (Constellation::Gps, 193, "J01"),
        (Constellation::Gps, 202, "J10"),
    ] {
        let satellite = SatelliteId::new(constellation, number).unwrap();
        assert_eq!(satellite.to_string(), want);
        assert_eq!((satellite.constellation(), satellite.number()), (constellation, number));
        let (letter, number) = satellite.name();
        assert_eq!(SatelliteId::from_name(letter, number), Some(satellite));
    }
}

#[test]
fn numbers_that_no_system_has_are_none() {
    for (constellation, number) in
        [(Constellation::Gps, 192), (Constellation::Gps, 203), (Constellation::Galileo, 193)]
    {
        assert_eq!(SatelliteId::new(constellation, number), None, "{constellation:?} {number}");
    }
    for (letter, number) in [('J', 0), ('J', 11), ('J', 193), ('G', 193), ('G', 0), ('S', 20)] {
        assert_eq!(SatelliteId::from_name(letter, number), None, "{letter} {number}");
    }
}

#[test]
fn name_is_parsed_as_it_is_printed() {
    for letter in ['G', 'C', 'E', 'R', 'J'] {
        for number in 1..=99 {
            let name = format!("{letter}{number:02}");
            let want = SatelliteId::from_name(letter, number);
            assert_eq!(name.parse().ok(), want, "{name}");
        }
    }
    assert_eq!("E5".parse().ok(), SatelliteId::new(Constellation::Galileo, 5));
    for name in ["", "G", "G00", "G0", "G100", "g05", "X05", "G-5", "G 5", "G5 ", "J11", "05", "G٥"] {
        assert!(name.parse::<SatelliteId>().is_err(), "{name:?}");
    }
}
