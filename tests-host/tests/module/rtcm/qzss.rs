//! QZSS: 1044 at the borders of each field, and ranges in 1114 to 1117.

use raim_core::satellite::SatelliteId;
use raim_firmware::ephemeris::{Broadcast, Ephemeris, GroupDelay, Health, Source, ura_m};
use raim_firmware::raw::Band;
use raim_firmware::time::GpsTime;

use super::{TOW_MS, knowing, names_of_nonzero};
use crate::wire::{Bits, Cell, L1C, Seen, epochs, feed, frame, msm};

/// Fields behind the message number, in the order of [RTCM-10403.3] table 3.5-22: width, and true
/// for a signed field.
const FIELDS: [(u32, bool); 29] = [
    (4, false),
    (16, false),
    (8, true),
    (16, true),
    (22, true),
    (8, false),
    (16, true),
    (16, true),
    (32, true),
    (16, true),
    (32, false),
    (16, true),
    (32, false),
    (16, false),
    (16, true),
    (32, true),
    (16, true),
    (32, true),
    (16, true),
    (32, true),
    (24, true),
    (14, true),
    (2, false),
    (10, false),
    (4, false),
    (6, false),
    (8, true),
    (10, false),
    (1, false),
];

/// Indices of fields that tests choose.
const SATELLITE: usize = 0;
const HEALTH: usize = 25;
const TGD: usize = 26;

/// Fields of an orbit like that of J02, at the time of the other tests.
const ORDINARY: [i64; 29] = {
    let mut fields = [1; 29];
    fields[SATELLITE] = 2;
    fields[1] = TOW_MS as i64 / 16_000;
    // e = 0.0745 and √a = 6493 √m.
    fields[10] = 639_950_000;
    fields[12] = 3_404_201_984;
    fields[13] = TOW_MS as i64 / 16_000;
    // 40°.
    fields[17] = 477_218_588;
    fields[23] = 2111 % 1024;
    fields[HEALTH] = 1;
    fields
};

fn message(fields: &[i64; 29]) -> Vec<u8> {
    let widths = FIELDS.iter().map(|(width, _)| *width);
    let bits = fields
        .iter()
        .zip(widths)
        .fold(Bits::default().put(12, 1044), |bits, (&field, width)| bits.put(width, field));
    frame(&bits.bytes())
}

/// Returns the message with these fields, by the interface documents.
fn broadcast(fields: &[i64; 29]) -> Option<Broadcast> {
    let [number, toc, af2, af1, af0, _, crs, delta_n, m0, cuc, e, cus, sqrt_a, toe, cic, rest @ ..] = *fields;
    let [omega0, cis, i0, crc, omega, omegadot, idot, _, week, ura, health, tgd, _, _] = rest;
    let in_units = |field: i64, exponent: i32| field as f64 * 2f64.powi(exponent);
    // The week with that number is in the cycle nearest to the known one.
    let week = (0..4).map(|cycle| 1024 * cycle + week).min_by_key(|week| (week - 2111).abs())?;
    let instant =
        |field: i64| (field < 37_800).then_some(GpsTime { week: week as u16, tow_ms: 16_000 * field as u32 });
    Some(Broadcast {
        satellite: SatelliteId::qzss(number as u8)?,
        source: Source::QzssLnav,
        // The last bit is of an unused signal.
        health: Health::of_satellite(health & !1 == 0),
        accuracy_m: ura_m(ura as u8),
        toe: instant(toe)?,
        toc: instant(toc)?,
        sqrt_a_sqrt_m: in_units(sqrt_a, -19),
        eccentricity: in_units(e, -33),
        m0_sc: in_units(m0, -31),
        omega0_sc: in_units(omega0, -31),
        i0_sc: in_units(i0, -31),
        omega_sc: in_units(omega, -31),
        delta_n_sc_s: in_units(delta_n, -43),
        omegadot_sc_s: in_units(omegadot, -43),
        idot_sc_s: in_units(idot, -43),
        cuc_rad: in_units(cuc, -29) as f32,
        cus_rad: in_units(cus, -29) as f32,
        crc_m: in_units(crc, -5) as f32,
        crs_m: in_units(crs, -5) as f32,
        cic_rad: in_units(cic, -29) as f32,
        cis_rad: in_units(cis, -29) as f32,
        af0_s: in_units(af0, -31),
        af1_s_s: in_units(af1, -43),
        af2_s_s2: in_units(af2, -55),
        group_delays_s: [in_units(tgd, -31) as f32, 0.0],
    })
}

/// Returns the ephemeris that the module reads in a message, and the counters if it reads none.
fn read(fields: &[i64; 29]) -> (Option<Ephemeris>, Vec<(&'static str, u32)>) {
    let mut input = knowing();
    let seen = feed(&mut input, &message(fields));
    let ephemeris = seen.into_iter().find_map(|seen| match seen {
        Seen::Ephemeris(ephemeris) => Some(ephemeris),
        _ => None,
    });
    (ephemeris, names_of_nonzero(input.counters()))
}

#[test]
fn every_field_of_1044_is_read_up_to_its_borders() {
    let (mut taken, mut refused) = (0, 0);
    for (index, (width, has_sign)) in FIELDS.into_iter().enumerate() {
        let half = 1_i64 << (width - 1);
        let borders = if has_sign { [-half, -1, 0, half - 1] } else { [0, 1, half, 2 * half - 1] };
        for border in borders {
            let mut fields = ORDINARY;
            fields[index] = border;
            let want = broadcast(&fields).and_then(|broadcast| Ephemeris::new(&broadcast).ok());
            let (have, counted) = read(&fields);
            // Compared as text, because an accuracy that is not promised is NaN, which equals
            // nothing.
            assert_eq!(format!("{have:?}"), format!("{want:?}"), "field {index}: {border}");
            if want.is_some() {
                taken += 1;
            } else {
                let name = if index == SATELLITE { "satellites_unknown" } else { "ephemerides_invalid" };
                assert_eq!(counted, [(name, 1)], "field {index}: {border}");
                refused += 1;
            }
        }
    }
    assert!(taken > 80 && refused > 9, "{taken} taken, {refused} refused");
}

#[test]
fn a_message_too_short_is_malformed() {
    let whole = message(&ORDINARY);
    let mut input = knowing();
    assert!(feed(&mut input, &frame(&whole[3..whole.len() - 4])).is_empty());
    assert_eq!(names_of_nonzero(input.counters()), [("messages_malformed", 1)]);
}

#[test]
fn only_the_last_bit_of_health_says_nothing() {
    for bit in 0..6 {
        let mut fields = ORDINARY;
        fields[HEALTH] = 1 << bit;
        let (ephemeris, _) = read(&fields);
        assert_eq!(ephemeris.unwrap().serves(Band::L1), bit == 0, "bit {bit}");
    }
}

#[test]
fn a_group_delay_that_the_satellite_does_not_know_is_uncalibrated() {
    for (field, want) in
        [(-128, GroupDelay::Uncalibrated(0.0)), (-127, GroupDelay::Known(-127.0 / 2f32.powi(31)))]
    {
        let mut fields = ORDINARY;
        fields[TGD] = field;
        assert_eq!(read(&fields).0.unwrap().group_delay(Band::L1), Some(want), "{field}");
    }
}

/// Signals of QZSS in [RTCM-10403.3] table 3.5-105: C/A, L2C M+L, L5 I+Q; the ninth is of L6.
#[test]
fn ranges_of_every_level_are_read_and_named_as_in_rinex() {
    const L6S: u8 = 9;
    const L2X: u8 = 17;
    const L5X: u8 = 24;
    for level in 4..=7 {
        let cells = [
            Cell(1, L1C, 3.8e7, 41.0),
            Cell(10, L1C, 3.9e7, 44.0),
            Cell(10, L6S, 3.9e7 + 2.0, 44.0),
            Cell(10, L2X, 3.9e7 + 4.0, 43.0),
            Cell(10, L5X, 3.9e7 + 6.0, 48.0),
        ];
        let mut input = knowing();
        let have = epochs(feed(&mut input, &msm(1110 + level, TOW_MS, false, &cells)));
        assert_eq!(have.len(), 1, "{level}");
        let bands = have[0].satellites.iter().map(|raw| {
            let bands: Vec<_> = raw.signals.iter().map(|signal| signal.carrier.band).collect();
            (raw.satellite.to_string(), bands)
        });
        let want =
            [("J01".to_owned(), vec![Band::L1]), ("J10".to_owned(), vec![Band::L1, Band::L2, Band::L5])];
        assert_eq!(bands.collect::<Vec<_>>(), want);
        let range_m = have[0].satellites[1].signals[2].range_m;
        assert!((range_m - (3.9e7 + 6.0)).abs() < 9e-3, "{range_m}");
        assert_eq!(names_of_nonzero(input.counters()), [("signals_other", 1)]);
    }
}

#[test]
fn a_number_that_no_satellite_has_is_unknown() {
    let mut input = knowing();
    let have = epochs(feed(&mut input, &msm(1117, TOW_MS, false, &[Cell(11, L1C, 3.8e7, 41.0)])));
    assert!(have[0].satellites.is_empty());
    assert_eq!(names_of_nonzero(input.counters()), [("satellites_unknown", 1)]);
}
