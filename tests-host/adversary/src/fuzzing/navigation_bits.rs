//! Target: navigation bits with correct parities.
//!
//! | byte of a page | meaning |
//! |---|---|
//! | 0 | bits 0 to 2: message; bits 3, 4: its parities are kept as they are; bits 5 to 7: seconds since the page before |
//! | 1 | satellite |
//! | 2 … | words of 32 bits, as many as the message has |
//!
//! Invariants: every frame has an outcome, and at most one counter refuses it. A page with
//! corrected parities fails none of them. Output belongs to the satellite of the page and is within
//! the range of its fields, and its orbit stays at plausible radii.

use raim::signal::encode::ubx::{self, Form};
use raim_core::satellite::{Constellation, SatelliteId};
use raim_firmware::ephemeris::{CnavContent, Ephemeris, EphemerisError};
use raim_firmware::input::{Counters, Event, Input};

use super::tape::Tape;

/// Messages with their signal: form, system, UBX's number of the signal, highest satellite.
pub(super) const MESSAGES: [(Form, Constellation, u8, u8); 7] = [
    (Form::Lnav, Constellation::Gps, 0, 32),
    (Form::Inav, Constellation::Galileo, 1, 36),
    (Form::Fnav, Constellation::Galileo, 3, 36),
    (Form::Beidou, Constellation::Beidou, 0, 63),
    (Form::Beidou, Constellation::Beidou, 1, 5),
    (Form::Glonass, Constellation::Glonass, 0, 24),
    (Form::Cnav, Constellation::Gps, 7, 32),
];

/// An epoch without satellites, 2020-06-25 12:00:00. It carries the week and 18 leap seconds.
const DATED: [u8; 16] = [0, 0, 0, 0, 0, 0xBD, 0x17, 0x41, 0x3F, 0x08, 18, 0, 1, 1, 0, 0];

/// Plausible distances of orbits from the centre, m: the range that [`raim_firmware::ephemeris`]
/// accepts, with an eccentricity of 0.2, the harmonics of the widest field and half an hour of a
/// state vector's flight.
const ORBITS_M: std::ops::RangeInclusive<f64> = 1.2e7..=8.0e7;

/// Reads pages until the bytes end.
pub fn run(input: &[u8]) {
    let mut tape = Tape::new(input);
    let mut module = Module { input: Input::new(), now_ms: 0 };
    module.input.feed(&ubx::frame([0x02, 0x15], &DATED), 0, |_| ());
    while !tape.is_over() {
        module.page(&mut tape);
    }
    let counters = module.input.counters();
    let refused = refusals(counters).iter().sum::<u32>();
    // The epoch that carries the time is a frame too, and a judged ephemeris is one that was read.
    let outcomes = counters.subframes + refused + 1;
    let judged = counters.ephemerides + counters.ephemerides_invalid;
    assert!(
        outcomes <= counters.frames && counters.frames <= outcomes + judged,
        "a frame has one outcome: {counters:?}"
    );
}

/// Returns the counters that refuse a frame of navigation bits, except for values that no satellite
/// sends.
fn refusals(counters: &Counters) -> [u32; 8] {
    [
        counters.subframes_other,
        counters.subframes_malformed,
        counters.subframes_parity,
        counters.subframes_mixed,
        counters.subframes_surplus,
        counters.satellites_unknown,
        counters.leap_unknown,
        counters.epochs_without_week,
    ]
}

struct Module {
    input: Input,
    now_ms: u64,
}

impl Module {
    /// Processes one page.
    fn page(&mut self, tape: &mut Tape<'_>) {
        let how = tape.byte();
        let (form, constellation, signal, highest) = MESSAGES[usize::from(how & 7) % MESSAGES.len()];
        let (keeps_parities, pause_ms) = (how >> 3 & 3 == 3, u64::from(how >> 5) * 1000);
        let number = tape.byte() % highest + 1;
        let satellite = SatelliteId::new(constellation, number).expect("from 1");
        let mut words: Vec<u32> = (0..form.words()).map(|_| tape.word()).collect();
        if let (Form::Cnav, Some(first)) = (form, words.first_mut()) {
            // Bits 8 to 13 name the satellite.
            *first = *first & !(63 << 18) | u32::from(number) << 18;
        }
        let words = if keeps_parities { words } else { form.sealed(&words).expect("as many as it has") };
        self.now_ms += pause_ms;
        let before = *self.input.counters();
        let frame = ubx::subframe(satellite, signal, &words);
        self.input.feed(&frame, self.now_ms, |event| check(&event, satellite));
        let after = self.input.counters();
        assert_eq!(after.frames, before.frames + 1, "{frame:02x?}");
        assert!(
            keeps_parities || after.subframes_parity == before.subframes_parity,
            "its own parity: {form:?} {words:08x?}"
        );
        let leap_s = self.input.leap_second().map(|leap| leap.seconds);
        assert!(leap_s.is_none_or(|leap_s| leap_s <= 63), "{leap_s:?}");
    }
}

fn check(event: &Event<'_>, satellite: SatelliteId) {
    match event {
        Event::Ephemeris(ephemeris) => {
            assert_eq!(ephemeris.satellite(), satellite);
            check_orbit(ephemeris);
        }
        Event::Ionosphere(_, coefficients) => {
            // Eight bits in two's complement, in the units of every interface document.
            let units = [-30, -27, -24, -24, 11, 14, 16, 16].map(|exponent| 2f64.powi(exponent));
            let steps = coefficients.iter().zip(units).map(|(coefficient, unit)| coefficient / unit);
            assert!(steps.into_iter().all(|step| (-128.0..128.0).contains(&step)), "{coefficients:?}");
        }
        Event::Cnav(frame) => {
            assert_eq!(frame.satellite, satellite);
            if let CnavContent::Delays(delays) = frame.content {
                assert!(delays.steps.iter().all(|steps| (-4096..4096).contains(steps)), "{delays:?}");
            }
        }
        _ => panic!("not in these bits: {event:?}"),
    }
}

fn check_orbit(ephemeris: &Ephemeris) {
    match ephemeris.at(ephemeris.toe(), 2.2e7) {
        Ok(state) => {
            let radius_m = state.position.radius_m();
            assert!(ORBITS_M.contains(&radius_m), "{radius_m} m: {ephemeris:?}");
            assert!(state.clock_s.abs() < 0.1, "{} s: {ephemeris:?}", state.clock_s);
        }
        Err(reason) => assert_eq!(reason, EphemerisError::Stale, "{ephemeris:?}"),
    }
}
