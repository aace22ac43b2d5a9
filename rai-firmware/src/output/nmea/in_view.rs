//! Satellites in view: `GSV`.
//!
//! ```text
//! el = atan2(u, √(e² + n²))        az = atan2(e, n)
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | `e`, `n`, `u` | way to the satellite: east, north, up | m |
//! | `el` | elevation, empty below the horizon | ° |
//! | `az` | azimuth from true north over east | ° |
//!
//! Each satellite is listed once, with the first of its bands and the C/N0 there. Each system has
//! its talker, and each of its bands has a group of sentences with the band's signal id. The first
//! group is always that of GPS on L1, also without a satellite, because gpsd begins a new sky with
//! it. A value that is unknown is an empty field.
//!
//! Directions need a place that is accurate to some kilometres. In an alert they are computed from
//! the last place that was not contradicted, which no sentence carries.
//!
//! References: [NMEA-0183] v4.11, tables 19 and 20; [GPSD-NMEA].
//!
//! [GPSD-NMEA]: crate#references
//! [NMEA-0183]: crate#references

use embedded_io::Write;
use raim_core::internals::numeric::sqrt;

use super::{Sentence, write_sentence};
use crate::output::in_view::{Horizon, InView};
use crate::raw::{Band, RawSatellite, RawSignal};

/// Number of satellites in one sentence.
const PER_SENTENCE: usize = 4;

/// Most satellites of a group, because the number of a sentence has one digit. No system has so
/// many satellites above one horizon.
const MOST: usize = 9 * PER_SENTENCE;

/// Satellites of one system that are listed with one band.
struct Group {
    letter: char,
    address: &'static str,
    band: Band,
    /// Signal id of the code of this band that receivers usually track.
    signal: u8,
}

const fn group(letter: char, address: &'static str, band: Band, signal: u8) -> Group {
    Group { letter, address, band, signal }
}

/// All groups, in the order of the sentences.
const GROUPS: [Group; 16] = [
    group('G', "GPGSV", Band::L1, b'1'),
    group('G', "GPGSV", Band::L2, b'6'),
    group('G', "GPGSV", Band::L5, b'8'),
    group('R', "GLGSV", Band::G1, b'1'),
    group('R', "GLGSV", Band::G2, b'3'),
    group('E', "GAGSV", Band::E1, b'7'),
    group('E', "GAGSV", Band::E5a, b'1'),
    group('E', "GAGSV", Band::E5b, b'2'),
    group('C', "GBGSV", Band::B1I, b'1'),
    group('C', "GBGSV", Band::B1C, b'3'),
    group('C', "GBGSV", Band::B2a, b'5'),
    group('C', "GBGSV", Band::B2I, b'B'),
    group('C', "GBGSV", Band::B3I, b'8'),
    group('J', "GQGSV", Band::L1, b'1'),
    group('J', "GQGSV", Band::L2, b'6'),
    group('J', "GQGSV", Band::L5, b'8'),
];

impl Group {
    fn satellites<'r>(&self, view: &InView<'r>) -> impl Iterator<Item = &'r RawSatellite> {
        let (letter, band) = (self.letter, self.band);
        let is_member = move |satellite: &&RawSatellite| {
            satellite.satellite.name().0 == letter
                && first(satellite).is_some_and(|signal| signal.carrier.band == band)
        };
        view.raw.satellites.iter().filter(is_member).take(MOST)
    }
}

/// Returns the signal on the first band of a satellite.
fn first(satellite: &RawSatellite) -> Option<&RawSignal> {
    satellite.signals.iter().min_by_key(|signal| signal.carrier.band as u8)
}

/// Writes `GSV`: the satellites in view, by system and band.
// Not inlined, so that an epoch without `GSV` does not need its stack.
#[inline(never)]
pub(super) fn write_in_view<W: Write>(view: &InView<'_>, out: &mut W) -> Result<(), W::Error> {
    let horizon = view.place.map(Horizon::at);
    for (index, group) in GROUPS.iter().enumerate() {
        let many = group.satellites(view).count();
        let sentences = many.div_ceil(PER_SENTENCE).max(usize::from(index == 0));
        for number in 0..sentences {
            let mut sentence = Sentence::new(group.address);
            sentence.integer(sentences as u32, 1).integer(number as u32 + 1, 1).integer(many as u32, 2);
            for satellite in group.satellites(view).skip(number * PER_SENTENCE).take(PER_SENTENCE) {
                let position = view.satellites.place_of(satellite.satellite);
                let way = horizon.as_ref().zip(position).map(|(horizon, point)| horizon.way_to(point));
                list(&mut sentence, satellite, way);
            }
            write_sentence(sentence.ready(&[group.signal]), out)?;
        }
    }
    Ok(())
}

/// Appends a satellite: number, elevation, azimuth and C/N0.
fn list(sentence: &mut Sentence, satellite: &RawSatellite, way: Option<[f32; 3]>) {
    let [elevation_deg, azimuth_deg] = way.map_or([f32::NAN; 2], angles_deg);
    let cn0_dbhz = first(satellite).and_then(RawSignal::cn0_dbhz).unwrap_or(f32::NAN);
    sentence.satellite_number(satellite.satellite);
    whole(sentence, elevation_deg, 2, 90);
    // 359.5° and more round to north.
    whole(sentence, if azimuth_deg >= 359.5 { 0.0 } else { azimuth_deg }, 3, 359);
    whole(sentence, cn0_dbhz, 2, 99);
}

/// Returns elevation and azimuth of a direction, the azimuth from 0 to 360.
fn angles_deg([east, north, up]: [f32; 3]) -> [f32; 2] {
    let elevation_deg = libm::atan2f(up, sqrt(east * east + north * north)).to_degrees();
    let azimuth_deg = libm::atan2f(east, north).to_degrees();
    [elevation_deg, if azimuth_deg < 0.0 { azimuth_deg + 360.0 } else { azimuth_deg }]
}

/// Appends a value as a whole number, or an empty field if it is negative, too large or NaN.
fn whole(sentence: &mut Sentence, value: f32, digits: usize, largest: u32) {
    let rounded = (value + 0.5) as u32;
    if value > -0.5 && rounded <= largest {
        sentence.integer(rounded, digits);
    } else {
        sentence.empty();
    }
}

#[cfg(test)]
mod tests {
    use crate::output::Places;
    use std::string::String;
    use std::vec::Vec;

    use embedded_io::ErrorType;
    use raim_core::frame::Ecef;
    use raim_core::satellite::{Constellation, SatelliteId};

    use super::*;
    use crate::raw::{Carrier, RawEpoch};
    use crate::time::GpsTime;

    /// Place where east is y, north is z, and up is x.
    const ORIGIN: Ecef = Ecef::new(6_378_137.0, 0.0, 0.0);

    struct Lines(Vec<u8>);

    impl ErrorType for Lines {
        type Error = core::convert::Infallible;
    }

    impl Write for Lines {
        fn write(&mut self, bytes: &[u8]) -> Result<usize, Self::Error> {
            self.0.extend_from_slice(bytes);
            Ok(bytes.len())
        }

        fn flush(&mut self) -> Result<(), Self::Error> {
            Ok(())
        }
    }

    fn signal(band: Band, cn0_dbhz: f32) -> RawSignal {
        RawSignal::new(Carrier::of(band), 2.2e7).with_cn0_dbhz(cn0_dbhz)
    }

    fn epoch(satellites: &[(&str, &[RawSignal])]) -> RawEpoch {
        let mut raw = RawEpoch::new(GpsTime { week: 2400, tow_ms: 0 });
        for (name, signals) in satellites {
            let satellite: SatelliteId = name.parse().expect("a satellite");
            let signals = signals.iter().copied().collect();
            raw.satellites.push(RawSatellite { satellite, signals }).expect("room");
        }
        raw
    }

    /// Places by a function.
    struct Given<F>(F);

    impl<F: Fn(SatelliteId) -> Option<Ecef>> Places for Given<F> {
        fn place_of(&self, satellite: SatelliteId) -> Option<Ecef> {
            self.0(satellite)
        }
    }

    /// Returns the bodies of the sentences, whose checksums and lengths are right.
    fn sentences(
        raw: &RawEpoch,
        place: Option<Ecef>,
        position: impl Fn(SatelliteId) -> Option<Ecef>,
    ) -> Vec<String> {
        let mut lines = Lines(Vec::new());
        let Ok(()) = write_in_view(&InView { raw, satellites: &Given(position), place }, &mut lines);
        let text = String::from_utf8(lines.0).expect("ASCII");
        let body = |line: &str| {
            assert!(line.len() + 2 <= super::super::MAX_LENGTH, "{line}");
            let (body, checksum) = line[1..].split_once('*').expect("a checksum");
            let want = body.bytes().fold(0, |sum, byte| sum ^ byte);
            assert_eq!(u8::from_str_radix(checksum, 16), Ok(want), "{line}");
            String::from(body)
        };
        text.split_terminator("\r\n").map(body).collect()
    }

    /// Returns the point at a distance of 22,000 km in a direction from [`ORIGIN`].
    fn toward(elevation_deg: f64, azimuth_deg: f64) -> Ecef {
        let (elevation, azimuth) = (elevation_deg.to_radians(), azimuth_deg.to_radians());
        let [east, north] = [azimuth.sin(), azimuth.cos()].map(|part| 22e6 * elevation.cos() * part);
        Ecef::new(ORIGIN.x_m + 22e6 * elevation.sin(), east, north)
    }

    #[test]
    fn each_satellite_is_listed_once_by_system_and_first_band() {
        let raw = epoch(&[
            ("C12", &[signal(Band::B1I, 41.0), signal(Band::B3I, 44.0)]),
            ("G05", &[signal(Band::L5, 50.0), signal(Band::L1, 45.4)]),
            ("E31", &[signal(Band::E1, 38.5)]),
            ("R07", &[signal(Band::G1, 30.0)]),
            ("J02", &[signal(Band::L1, 0.0)]),
            ("E02", &[signal(Band::E5b, 99.0)]),
            ("G07", &[signal(Band::L1, 47.0).codeless()]),
        ]);
        let known = [("G05", 45.2, 359.4), ("R07", 0.4, 359.6), ("C12", 89.6, 90.0), ("E31", -1.0, 180.0)];
        let position = |satellite: SatelliteId| {
            let one = known.iter().find(|(name, ..)| *name == std::format!("{satellite}"));
            one.map(|(_, elevation_deg, azimuth_deg)| toward(*elevation_deg, *azimuth_deg))
        };
        let want = [
            "GPGSV,1,1,02,05,45,359,45,07,,,,1",
            "GLGSV,1,1,01,71,00,000,30,1",
            "GAGSV,1,1,01,31,,180,39,7",
            "GAGSV,1,1,01,02,,,99,2",
            "GBGSV,1,1,01,12,90,090,41,1",
            "GQGSV,1,1,01,02,,,,1",
        ];
        assert_eq!(sentences(&raw, Some(ORIGIN), position), want);
        let placeless = sentences(&raw, None, position);
        assert_eq!(placeless[0], "GPGSV,1,1,02,05,,,45,07,,,,1");
    }

    #[test]
    fn a_sentence_has_four_satellites_and_the_last_one_the_rest() {
        let names: Vec<String> = (1..=5).map(|number| std::format!("E{number:02}")).collect();
        for (many, want) in [
            (0, &["GPGSV,1,1,00,1"][..]),
            (1, &["GPGSV,1,1,00,1", "GAGSV,1,1,01,01,,,40,7"]),
            (4, &["GPGSV,1,1,00,1", "GAGSV,1,1,04,01,,,40,02,,,40,03,,,40,04,,,40,7"]),
            (
                5,
                &[
                    "GPGSV,1,1,00,1",
                    "GAGSV,2,1,05,01,,,40,02,,,40,03,,,40,04,,,40,7",
                    "GAGSV,2,2,05,05,,,40,7",
                ],
            ),
        ] {
            let signals = [signal(Band::E1, 40.0)];
            let satellites: Vec<_> =
                names.iter().take(many).map(|name| (name.as_str(), &signals[..])).collect();
            assert_eq!(sentences(&epoch(&satellites), Some(ORIGIN), |_| None), want);
        }
    }

    #[test]
    fn forty_satellites_are_all_listed_in_order() {
        let all = [(Constellation::Gps, 14), (Constellation::Galileo, 13), (Constellation::Beidou, 13)];
        let mut raw = epoch(&[]);
        for (constellation, many) in all {
            let band = [Band::L1, Band::B1I, Band::E1][constellation as usize];
            for number in 1..=many {
                let satellite = SatelliteId::new(constellation, number).expect("a satellite");
                let signals = [signal(band, 40.0)].into_iter().collect();
                raw.satellites.push(RawSatellite { satellite, signals }).expect("room");
            }
        }
        let lines = sentences(&raw, Some(ORIGIN), |_| Some(toward(10.0, 120.0)));
        assert_eq!(
            lines.iter().map(|line| &line[..9]).collect::<Vec<_>>(),
            [
                "GPGSV,4,1",
                "GPGSV,4,2",
                "GPGSV,4,3",
                "GPGSV,4,4",
                "GAGSV,4,1",
                "GAGSV,4,2",
                "GAGSV,4,3",
                "GAGSV,4,4",
                "GBGSV,4,1",
                "GBGSV,4,2",
                "GBGSV,4,3",
                "GBGSV,4,4",
            ]
        );
        let listed: usize = lines.iter().map(|line| (line.split(',').count() - 5) / 4).sum();
        assert_eq!(listed, 40);
        assert!(
            lines.iter().all(|line| line.matches(",10,120,40").count() == (line.split(',').count() - 5) / 4)
        );
    }

    #[test]
    fn hostile_values_leave_fields_empty_and_sentences_short() {
        let mut raw = epoch(&[]);
        for number in 1..=63 {
            let satellite = SatelliteId::new(Constellation::Beidou, number).expect("a satellite");
            let signals = [signal(Band::B1I, 4000.0)].into_iter().collect();
            raw.satellites.push(RawSatellite { satellite, signals }).expect("room");
        }
        let without_signal =
            RawSatellite { satellite: "G01".parse().expect("a satellite"), signals: heapless::Vec::new() };
        raw.satellites.push(without_signal).expect("room");
        for point in [
            ORIGIN,
            Ecef::new(f64::NAN, 0.0, 0.0),
            Ecef::new(f64::INFINITY, f64::NEG_INFINITY, 0.0),
            Ecef::new(1e300, -1e300, 1e300),
        ] {
            let lines = sentences(&raw, Some(ORIGIN), |_| Some(point));
            assert_eq!(lines.len(), 10, "{lines:?}");
            assert_eq!(lines[0], "GPGSV,1,1,00,1");
            assert!(lines[9].starts_with("GBGSV,9,9,36,33,"), "{lines:?}");
            for field in lines.iter().flat_map(|line| line.split(',').skip(4)) {
                assert!(field.len() <= 3 && field.bytes().all(|byte| byte.is_ascii_digit()), "{lines:?}");
            }
        }
    }
}
