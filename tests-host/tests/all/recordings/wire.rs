//! The values encoded into messages are those decoded from them.

use std::collections::BTreeMap;

use raim::signal::encode::{Encoder, Frequency, Selection};
use raim::signal::measurement::{MeasuredEpoch, MeasuredSatellite, MeasuredSignal};
use raim_core::frame::SPEED_OF_LIGHT_M_S;
use raim_core::satellite::{Constellation, SatelliteId};
use raim_firmware::time::GpsTime;
use rtcm_rs::{Message, MsgFrameIter};

use super::quirks::{NAVIGATION_3, OBSERVATIONS_3};
use super::{DGAR, ESBC, Files, KMS3, STATIC1HZ, TLSE, lumps, read};

/// Pseudoranges in metres by satellite, band and attribute.
type Ranges = BTreeMap<(SatelliteId, u8, char), f64>;

/// One MSM7.
struct Msm {
    /// Time in the system's own week, ms.
    time_ms: u32,
    more: bool,
    ranges: Ranges,
}

fn messages(bytes: &[u8]) -> Vec<Message> {
    let mut frames = MsgFrameIter::new(bytes);
    let messages = (&mut frames).map(|frame| frame.get_message()).collect();
    assert_eq!(frames.consumed(), bytes.len(), "bytes that are no frame");
    messages
}

macro_rules! msm {
    ($message:expr, $system:ident, $time:ident) => {{
        let segment = &$message.data_segment;
        let ranges = segment.signal_data.iter().map(|signal| {
            let rough =
                segment.satellite_data.iter().find(|of| of.satellite_id == signal.satellite_id).unwrap();
            let range_ms = f64::from(rough.gnss_satellite_rough_range_integer_ms.unwrap())
                + rough.gnss_satellite_rough_range_mod1ms_ms
                + signal.gnss_signal_fine_pseudorange_ext_ms.unwrap();
            let satellite = SatelliteId::new(Constellation::$system, signal.satellite_id).unwrap();
            let key = (satellite, signal.signal_id.band(), signal.signal_id.attribute());
            (key, range_ms * 1e-3 * SPEED_OF_LIGHT_M_S)
        });
        let more = $message.msm_multiple_message_flag == 1;
        Some(Msm { time_ms: $message.$time, more, ranges: ranges.collect() })
    }};
}

fn msm(message: &Message) -> Option<Msm> {
    match message {
        Message::Msg1077(message) => msm!(message, Gps, gps_epoch_time_ms),
        Message::Msg1097(message) => msm!(message, Galileo, gal_epoch_time_ms),
        Message::Msg1127(message) => msm!(message, Beidou, bds_epoch_time_ms),
        _ => None,
    }
}

fn selection(letters: &str, frequency: Frequency) -> Selection {
    Selection::new(letters, frequency).unwrap()
}

/// Returns a satellite whose signals, RINEX codes without the C, all have one range.
fn satellite(
    constellation: Constellation,
    number: u8,
    codes: &[&str],
    pseudorange_m: f64,
) -> MeasuredSatellite {
    let signal = |code: &&str| MeasuredSignal {
        band: code[..1].parse().unwrap(),
        attribute: code.chars().nth(1).unwrap(),
        pseudorange_m,
        carrier_cycles: None,
        cn0_dbhz: Some(45.0),
        doppler_hz: None,
    };
    let satellite = SatelliteId::new(constellation, number).unwrap();
    MeasuredSatellite { satellite, signals: codes.iter().map(signal).collect() }
}

fn epoch(satellites: Vec<MeasuredSatellite>) -> MeasuredEpoch {
    MeasuredEpoch { time: GpsTime { week: 2320, tow_ms: 5_000 }, satellites }
}

fn encoded(epoch: &MeasuredEpoch, selection: Selection) -> (Vec<Msm>, u64) {
    let mut encoder = Encoder::new(&[], selection);
    let bytes = encoder.epoch(epoch).unwrap();
    (messages(&bytes).iter().filter_map(msm).collect(), encoder.unsendable())
}

#[test]
fn every_range_of_the_recordings_comes_back_within_a_millimetre() {
    for files in [ESBC, STATIC1HZ, TLSE, KMS3, DGAR] {
        let Some(mut recording) = files.load() else { continue };
        recording.epochs.truncate(400);
        let lumps = lumps(&recording, selection("GCE", Frequency::Dual));
        let mut count = 0;
        for (epoch, lump) in recording.epochs.iter().zip(lumps) {
            count += compare(epoch, &messages(&lump));
        }
        let satellites: usize = recording.epochs.iter().map(|epoch| epoch.satellites.len()).sum();
        println!("{}: {count} ranges of {satellites} satellites", files.0);
        assert!(count > satellites, "{}: {count} ranges of {satellites} satellites", files.0);
    }
}

/// Compares the sent ranges with the measured ones; returns their number.
fn compare(epoch: &MeasuredEpoch, messages: &[Message]) -> usize {
    let sent: Vec<Msm> = messages.iter().filter_map(msm).collect();
    let more: Vec<bool> = sent.iter().map(|msm| msm.more).collect();
    let (last, others) = more.split_last().unwrap();
    assert!(!last && others.iter().all(|more| *more), "{more:?}");
    let ranges = || sent.iter().flat_map(|msm| &msm.ranges);
    for ((satellite, band, attribute), have_m) in ranges() {
        let measured = epoch.satellites.iter().find(|of| of.satellite == *satellite).unwrap();
        let signal =
            measured.signals.iter().find(|of| of.band == *band && of.attribute == *attribute).unwrap();
        let want_m = signal.pseudorange_m;
        assert!(
            (have_m - want_m).abs() < 1e-3,
            "{satellite} {band}{attribute}: have {have_m}, want {want_m}"
        );
    }
    ranges().count()
}

#[test]
fn each_system_tells_its_own_time() {
    let seen = [Constellation::Gps, Constellation::Galileo, Constellation::Beidou]
        .map(|system| satellite(system, 7, &["1C", "2I"], 2.2e7));
    let (have, _) = encoded(&epoch(seen.to_vec()), selection("GEC", Frequency::Single));
    let times: Vec<u32> = have.iter().map(|msm| msm.time_ms).collect();
    // 5 s after the beginning of the GPS week it is 9 s before the end of BeiDou's.
    assert_eq!(times, [5_000, 5_000, 604_791_000]);
}

#[test]
fn the_pair_is_the_one_that_the_receiver_combines() {
    use Constellation::{Beidou, Galileo, Gps};
    for (system, codes, dual, single) in [
        (Gps, &["1C", "2L", "2W", "5Q"][..], &["1C", "2W"][..], "1C"),
        (Gps, &["1W", "1C", "2W"], &["1C", "1W", "2W"], "1C"),
        (Gps, &["1W", "2W"], &["1W", "2W"], "1W"),
        (Gps, &["1C", "5X"], &["1C", "5X"], "1C"),
        (Gps, &["1C"], &["1C"], "1C"),
        (Galileo, &["1X", "5X", "6X", "7X"], &["1X", "5X"], "1X"),
        (Galileo, &["1C", "7Q", "8Q"], &["1C", "7Q"], "1C"),
        (Beidou, &["2I", "6I", "7I"], &["2I", "6I"], "2I"),
        (Beidou, &["2I", "7I"], &["2I", "7I"], "2I"),
        (Beidou, &["1P", "5P"], &["1P", "5P"], "1P"),
        (Beidou, &["1P", "2I", "5P"], &["1P", "5P"], "2I"),
    ] {
        for (frequency, want) in [(Frequency::Dual, dual), (Frequency::Single, &[single])] {
            let (have, _) =
                encoded(&epoch(vec![satellite(system, 3, codes, 2.4e7)]), selection("GCE", frequency));
            let have: Vec<String> =
                have[0].ranges.keys().map(|(_, band, attribute)| format!("{band}{attribute}")).collect();
            assert_eq!(have, want, "{system:?} {codes:?} {frequency:?}");
        }
    }
}

#[test]
fn more_cells_than_a_message_holds_go_into_several() {
    // 32 satellites with three different signals are 96 cells.
    let codes: [&[&str]; 2] = [&["1C", "2W"], &["1C", "5Q"]];
    let seen =
        (1..=32).map(|number| satellite(Constellation::Gps, number, codes[usize::from(number % 2)], 2.3e7));
    let (have, unsendable) = encoded(&epoch(seen.collect()), selection("G", Frequency::Dual));
    let more: Vec<bool> = have.iter().map(|msm| msm.more).collect();
    assert_eq!((more, unsendable), (vec![true, false], 0));
    assert_eq!(have.iter().map(|msm| msm.ranges.len()).sum::<usize>(), 64);
}

#[test]
fn an_epoch_in_which_nothing_is_seen_says_nothing() {
    let mut encoder = Encoder::new(&[], selection("CE", Frequency::Dual));
    assert!(encoder.epoch(&epoch(Vec::new())).unwrap().is_empty());
}

#[test]
fn ranges_that_the_message_has_no_numbers_for_are_counted_and_left_out() {
    // 255 ms are 76,447 km.
    for (range_m, want) in [(0.0, 1), (7.6e7, 1), (7.65e7, 0), (-1.0, 0), (1e12, 0), (f64::NAN, 0)] {
        let seen = vec![satellite(Constellation::Gps, 9, &["1C"], range_m)];
        let (have, unsendable) = encoded(&epoch(seen), selection("G", Frequency::Single));
        let count: usize = have.iter().map(|msm| msm.ranges.len()).sum();
        assert_eq!((count, unsendable), (want, 1 - want as u64), "{range_m} m");
    }
    let mut wide = satellite(Constellation::Gps, 9, &["1C", "2W"], 2.2e7);
    wide.signals[1].pseudorange_m += 500.0;
    let (have, unsendable) = encoded(&epoch(vec![wide]), selection("G", Frequency::Dual));
    assert_eq!((have[0].ranges.len(), unsendable), (1, 1));
}

/// Returns the first ephemeris of a satellite in a recording, read from the first lump that has it.
fn broadcast(files: &Files, want: impl Fn(&Message) -> bool) -> Option<Message> {
    let recording = files.load()?;
    let lumps = lumps(&recording, selection("GCE", Frequency::Single));
    Some(lumps.iter().flat_map(|lump| messages(lump)).find(want).expect("the ephemeris is sent"))
}

/// Checks that every value is within half a unit of its field (plus the error of single precision).
fn hold(rows: &[(&str, f64, f64, f64)]) {
    for (name, have, want, unit) in rows {
        assert!((have - want).abs() <= 0.51 * unit, "{name}: have {have:e}, want {want:e}, unit {unit:e}");
    }
}

fn two_to(power: i32) -> f64 {
    2f64.powi(power)
}

#[test]
fn a_gps_ephemeris_keeps_every_number_within_its_unit() {
    use std::f64::consts::PI;
    let recording = read(OBSERVATIONS_3, NAVIGATION_3).unwrap();
    let lumps = lumps(&recording, selection("G", Frequency::Dual));
    let first = messages(&lumps[0]);
    let Some(Message::Msg1019(have)) = first.first() else { panic!("{first:?}") };
    // The numbers are those of the text; the units those of [IS-GPS-200] tables 20-I and 20-III.
    hold(&[
        ("af0", have.af0_s, -1.774230040610e-4, two_to(-31)),
        ("af1", have.af1_s_s.into(), -1.364242052659e-12, two_to(-43)),
        ("crs", have.crs_m.into(), -98.21875, two_to(-5)),
        ("delta n", f64::from(have.delta_n_sc_s) * PI, 4.293035965037e-9, PI * two_to(-43)),
        ("m0", have.m0_sc * PI, 1.714815412488, PI * two_to(-31)),
        ("cuc", have.cuc_rad.into(), -5.291774868965e-6, two_to(-29)),
        ("e", have.eccentricity, 5.927642923780e-3, two_to(-33)),
        ("cus", have.cus_rad.into(), 1.830980181694e-6, two_to(-29)),
        ("sqrt a", have.sqrt_a_sqrt_m, 5153.635631561, two_to(-19)),
        ("toe", have.toe_s.into(), 122_400.0, 16.0),
        ("toc", have.toc_s.into(), 122_400.0, 16.0),
        ("cic", have.cic_rad.into(), 3.352761268616e-8, two_to(-29)),
        ("omega0", have.omega0_sc * PI, 2.520897825810, PI * two_to(-31)),
        ("cis", have.cis_rad.into(), -5.774199962616e-8, two_to(-29)),
        ("i0", have.i0_sc * PI, 0.9719266524177, PI * two_to(-31)),
        ("crc", have.crc_m.into(), 353.625, two_to(-5)),
        ("omega", have.omega_sc * PI, 1.273307347665, PI * two_to(-31)),
        ("omega dot", have.omegadot_sc_s * PI, -8.275344701323e-9, PI * two_to(-43)),
        ("idot", have.idot_sc_s * PI, -2.610823036973e-10, PI * two_to(-43)),
        ("tgd", have.tgd_s.into(), -1.071020960808e-8, two_to(-31)),
    ]);
    assert_eq!((have.gps_satellite_id, have.iode, have.iodc, have.code_on_l2_ind), (5, 72, 72, 1));
}

#[test]
fn a_beidou_ephemeris_keeps_what_differs_from_gps() {
    let is_c02 = |message: &Message| matches!(message, Message::Msg1042(of) if of.bds_satellite_id == 2);
    let Some(Message::Msg1042(have)) = broadcast(&STATIC1HZ, is_c02) else { return };
    // C02 of 2024-06-24 08:00 in base.nav; units of [BDS-SIS-ICD] tables 5-8 and 5-10.
    hold(&[
        ("a0", have.a0_s, 7.988180732355e-4, two_to(-33)),
        ("a1", have.a1_s_s, 3.065725451279e-11, two_to(-50)),
        ("crs", have.crs_m.into(), 472.28125, two_to(-6)),
        ("cus", have.cus_rad.into(), -1.345621421933e-5, two_to(-31)),
        ("sqrt a", have.sqrt_a_sqrt_m, 6493.453220367, two_to(-19)),
        ("toe", have.toe_s.into(), 115_200.0, 8.0),
        ("toc", have.toc_s.into(), 115_200.0, 8.0),
        ("tgd1", have.tgd1_s.into(), 1.3e-9, 1e-10),
        ("tgd2", have.tgd2_s.into(), -1.4e-8, 1e-10),
    ]);
    assert_eq!((have.bds_week_number, have.aode, have.aodc, have.sv_health_flag), (964, 0, 0, 0));
}

#[test]
fn a_galileo_ephemeris_keeps_what_differs_from_gps() {
    let is_e01 = |message: &Message| matches!(message, Message::Msg1046(of) if of.gal_satellite_id == 1);
    let Some(Message::Msg1046(have)) = broadcast(&ESBC, is_e01) else { return };
    // E01 in force at midnight of 2020-06-25; units of [Galileo-OS-SIS-ICD] tables 61 and 64.
    hold(&[
        ("af0", have.af0_s, -8.846981800161e-4, two_to(-34)),
        ("af1", have.af1_s_s, -7.986500349944e-12, two_to(-46)),
        ("crs", have.crs_m.into(), 19.125, two_to(-5)),
        ("sqrt a", have.sqrt_a_sqrt_m, 5440.601928711, two_to(-19)),
        ("toe", have.toe_s.into(), 344_400.0, 60.0),
        ("toc", have.toc_s.into(), 344_400.0, 60.0),
        ("bgd e5a", have.bgd_e1_e5a_s.into(), -1.862645149231e-9, two_to(-32)),
        ("bgd e5b", have.bgd_e1_e5b_s.into(), -2.095475792885e-9, two_to(-32)),
    ]);
    // 3.12 m are seven steps of 0.16 m above 2 m, which is index 100.
    assert_eq!((have.gal_week_number, have.iodnav, have.sisa_e1_e5b_index), (2111 - 1024, 62, 107));
}

/// Returns a recording of one satellite, received once a minute for three hours.
fn schedule(sent: &[(&str, &str)]) -> Vec<(usize, u8)> {
    let (header, record) = NAVIGATION_3.split_at(NAVIGATION_3.find("G05").unwrap());
    let record = &record[..record.find("R07").unwrap()];
    let records = sent.iter().enumerate().map(|(index, (toe_s, sent_s))| {
        let iode = format!("{index}.200000000000E+01");
        record
            .replacen("1.224000000000E+05", toe_s, 1)
            .replacen("1.152180000000E+05", sent_s, 1)
            .replace("7.200000000000E+01", &iode)
    });
    let mut recording = read(OBSERVATIONS_3, &(header.to_owned() + &records.collect::<String>())).unwrap();
    let start = GpsTime { week: 2320, tow_ms: 115_200_000 };
    let minute = |minute: u64| MeasuredEpoch {
        time: GpsTime::from_ms(start.to_ms() + 60_000 * minute),
        satellites: Vec::new(),
    };
    recording.epochs = (0..180).map(minute).collect();
    let lumps = lumps(&recording, selection("G", Frequency::Dual));
    let sent = lumps
        .iter()
        .enumerate()
        .flat_map(|(minute, lump)| messages(lump).into_iter().map(move |m| (minute, m)));
    sent.filter_map(|(minute, message)| match message {
        Message::Msg1019(ephemeris) => Some((minute, ephemeris.iode)),
        _ => None,
    })
    .collect()
}

#[test]
fn an_ephemeris_is_told_when_it_was_broadcast_and_once() {
    const BEFORE: &str = "1.151000000000E+05"; // 08:00 less 100 s
    const EARLIER: &str = "1.080000000000E+05"; // 06:00
    const HOUR: &str = "1.188000000000E+05"; // 09:00
    const TOE_10: &str = "1.224000000000E+05";
    const TOE_12: &str = "1.296000000000E+05";
    // IODE 2, 12, 22 in the order of the file.
    for (sent, want) in [
        (&[(TOE_10, BEFORE), (TOE_12, HOUR)][..], &[(0, 2), (60, 12)][..]),
        // Of the sets sent before the start only the newest is known, whatever the order of the
        // file.
        (&[(TOE_10, BEFORE), (TOE_10, EARLIER)], &[(0, 2)]),
        // The set sent before the start is missing: the first later set is taken, if it is near.
        (&[(TOE_10, HOUR)], &[(0, 2)]),
        // The first later set is not near, so it is known only when it is sent.
        (&[(TOE_12, HOUR)], &[(60, 2)]),
    ] {
        assert_eq!(schedule(sent), want, "{sent:?}");
    }
}
