//! Each message against a library of RTCM: what it reads are the values that were sent, and what it
//! writes of them are the same bits.

use std::collections::BTreeMap;

use raim_firmware::time::GpsTime;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt as _, SeedableRng as _};
use rtcm_rs::msg::Msg1020T;
use rtcm_rs::{Message, MessageBuilder, MsgFrameIter};

use super::*;
use crate::signal::measurement::{Ephemeris, TimedEphemeris};

/// Ranges, m, C/N0, dBHz, and range rates, m/s, by satellite, band and attribute.
type Sent = BTreeMap<(u8, u8, char), (f64, Option<f64>, Option<f64>)>;

/// Adds the signals of a message as the library reads them.
macro_rules! add_read {
    ($sent:expr, $message:expr) => {
        for signal in $message.data_segment.signal_data.iter() {
            let satellites = &$message.data_segment.satellite_data;
            let rough = satellites.iter().find(|of| of.satellite_id == signal.satellite_id).unwrap();
            let range_ms = f64::from(rough.gnss_satellite_rough_range_integer_ms.unwrap())
                + rough.gnss_satellite_rough_range_mod1ms_ms
                + signal.gnss_signal_fine_pseudorange_ext_ms.unwrap();
            let rate_m_s = signal
                .gnss_signal_fine_phaserange_rate_m_s
                .zip(rough.gnss_satellite_rough_phaserange_rates_m_s)
                .map(|(fine, rough)| fine + f64::from(rough));
            let key = (signal.satellite_id, signal.signal_id.band(), signal.signal_id.attribute());
            assert!(signal.gnss_signal_fine_phaserange_ext_ms.is_none(), "no phase is sent");
            $sent.insert(key, (range_ms * M_PER_MS, signal.gnss_signal_cnr_ext_dbhz, rate_m_s));
        }
    };
}

/// Returns the frequency slot of a GLONASS satellite.
fn slot_of(number: u8) -> i8 {
    (number % 14).cast_signed() - 7
}

/// Returns an ephemeris that states the slot of a GLONASS satellite.
fn in_slot(number: u8) -> TimedEphemeris {
    let time = GpsTime { week: 2300, tow_ms: 0 };
    let message = Msg1020T {
        glo_satellite_id: number,
        glo_satellite_freq_chan_number: slot_of(number),
        ..Msg1020T::default()
    };
    let satellite = SatelliteId::from_name('R', number).unwrap();
    TimedEphemeris { satellite, toe: time, sent: time, message: Ephemeris::Glonass(message) }
}

/// Returns an epoch of satellites of one system, each with signals of two bands or with all codes.
fn epoch(random: &mut ChaCha8Rng, letter: char) -> MeasuredEpoch {
    let codes: &[(u8, &str)] = match letter {
        'G' => &[(1, "CPWSLX"), (2, "CPWSLX"), (5, "IQX")],
        'E' => &[(1, "CABXZ"), (5, "IQX"), (7, "IQX")],
        'C' => &[(2, "IQX"), (6, "IQX"), (7, "IQX"), (1, "DPX"), (5, "DPX")],
        'R' => &[(1, "CP"), (2, "CP")],
        _ => &[(1, "CSLX"), (2, "SLX"), (5, "IQX")],
    };
    let most = if letter == 'J' { 7 } else { 24 };
    let mut satellites = Vec::new();
    for number in (1..=most).filter(|_| random.random_bool(0.7)).collect::<Vec<_>>() {
        let range_m = random.random_range(1.9e7..4.0e7);
        let signals = codes
            .iter()
            .filter_map(|(band, attributes)| {
                let place = random.random_range(0..=attributes.len());
                Some(MeasuredSignal {
                    band: *band,
                    attribute: attributes.chars().nth(place)?,
                    pseudorange_m: range_m + random.random_range(-70.0..70.0),
                    carrier_cycles: None,
                    cn0_dbhz: random.random_bool(0.9).then(|| random.random_range(0.07..63.9)),
                    doppler_hz: random.random_bool(0.9).then(|| random.random_range(-5e3..5e3)),
                })
            })
            .collect();
        satellites
            .push(MeasuredSatellite { satellite: SatelliteId::from_name(letter, number).unwrap(), signals });
    }
    MeasuredEpoch { time: GpsTime { week: 2300, tow_ms: 1000 * random.random_range(0..604_800) }, satellites }
}

#[test]
fn a_library_reads_what_was_sent_and_writes_the_same_bits() {
    let mut random = ChaCha8Rng::seed_from_u64(11);
    let channels = Channels::of(&(1..=24).map(in_slot).collect::<Vec<_>>());
    let mut builder = MessageBuilder::new();
    let mut cells = 0;
    for letter in ['G', 'R', 'E', 'C', 'J'].repeat(200) {
        let epoch = epoch(&mut random, letter);
        let selection = Selection::new(&letter.to_string(), Frequency::Dual).unwrap();
        let mut unsendable = 0;
        let bytes: Vec<u8> = frames(&epoch, &selection, &channels, 18, &mut unsendable).flatten().collect();
        assert_eq!(unsendable, 0, "{letter}");
        let mut sent = Sent::new();
        let mut again = Vec::new();
        for frame in &mut MsgFrameIter::new(&bytes) {
            let message = frame.get_message();
            match &message {
                Message::Msg1077(message) => add_read!(sent, message),
                Message::Msg1087(message) => {
                    add_read!(sent, message);
                    for satellite in message.data_segment.satellite_data.iter() {
                        let slot = satellite.glonass_satellite_frequency_channel_number;
                        assert_eq!(slot, Some(slot_of(satellite.satellite_id)));
                    }
                }
                Message::Msg1097(message) => add_read!(sent, message),
                Message::Msg1117(message) => add_read!(sent, message),
                Message::Msg1127(message) => add_read!(sent, message),
                other => panic!("{:?}", other.number()),
            }
            again.extend_from_slice(builder.build_message(&message).unwrap());
        }
        assert!(again == bytes, "{letter}: the library writes other bits");
        let mut want = 0;
        for satellite in &epoch.satellites {
            for signal in chosen(satellite, Frequency::Dual).into_iter().flatten() {
                let key = (satellite.satellite.name().1, signal.band, signal.attribute);
                let (range_m, cn0_dbhz, rate_m_s) =
                    sent.get(&key).unwrap_or_else(|| panic!("{letter} {key:?}"));
                assert!((range_m - signal.pseudorange_m).abs() < 3.1e-4, "{key:?}");
                assert_eq!(cn0_dbhz.is_some(), signal.cn0_dbhz.is_some(), "{key:?}");
                let error_dbhz = cn0_dbhz.zip(signal.cn0_dbhz).map_or(0.0, |(have, want)| have - want);
                assert!(error_dbhz.abs() <= 1.0 / 32.0, "{key:?}");
                // A rate that is too far from that of the satellite's first signal is not sent.
                let want_m_s = super::rate_m_s(satellite.satellite.constellation(), slot_of(key.0), signal);
                let error_m_s = rate_m_s.zip(want_m_s).map_or(0.0, |(have, want)| have - want);
                assert!(error_m_s.abs() < 5.1e-5 && (rate_m_s.is_none() || want_m_s.is_some()), "{key:?}");
                want += 1;
            }
        }
        assert_eq!(sent.len(), want, "{letter}");
        cells += want;
    }
    assert!(cells > 10_000, "{cells}");
}

/// The module uses a satellite by any band of its list, so that a recording of that band is sent.
#[test]
fn satellite_with_any_single_band_of_the_module_is_sent() {
    let channels = Channels::of(&(1..=24).map(in_slot).collect::<Vec<_>>());
    for band in SINGLES {
        let system = system_of(band);
        let satellite = SatelliteId::new(system, 5).unwrap();
        let (number, components) = choice(band);
        for attribute in components.chars() {
            let signal = MeasuredSignal {
                band: number,
                attribute,
                pseudorange_m: 2.3e7,
                carrier_cycles: None,
                cn0_dbhz: Some(40.0),
                doppler_hz: Some(100.0),
            };
            let satellites = vec![MeasuredSatellite { satellite, signals: vec![signal] }];
            let epoch = MeasuredEpoch { time: GpsTime { week: 2300, tow_ms: 0 }, satellites };
            for frequency in [Frequency::Single, Frequency::Dual] {
                let selection = Selection::new("GECR", frequency).unwrap();
                let mut unsendable = 0;
                let sent = frames(&epoch, &selection, &channels, 18, &mut unsendable).count();
                assert_eq!((sent, unsendable), (1, 0), "{band:?}{attribute} {frequency:?}");
                let rate_m_s = super::rate_m_s(system, 0, &signal);
                assert!(rate_m_s.is_some_and(|rate_m_s| rate_m_s < -15.0), "{band:?}: no range rate");
            }
        }
    }
}
