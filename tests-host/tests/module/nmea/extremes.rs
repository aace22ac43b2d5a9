//! Sentences without an epoch, and sentences with extreme numbers.

use nmea::parse_str;
use raim_core::report::{Alert, ProtectionLevels, TestStatistic, Unavailable, Verdict};
use raim_firmware::output::nmea::{
    GPS_MINUS_UTC_S, Losses, write_counters, write_losses, write_version, write_without_epoch,
};
use raim_firmware::output::schedule::Schedule;
use raim_firmware::output::{Motion, Statement};

use super::{Growing, NOON, bodies, fields, lines, npa, report, sentences, solution, statement, told};

#[test]
fn losses_are_said_in_their_order() {
    let mut out = Vec::new();
    let losses = Losses { gnss_bytes: 1, host_bytes: 2, frames_refused: 3, epochs_late: u32::MAX };
    write_losses(&losses, &mut Growing(&mut out)).expect("a vector takes all");
    assert_eq!(bodies(&lines(&out)), ["$PRAIL,1,2,3,4294967295"]);
}

/// Each sentence has its greatest length here.
#[test]
fn the_fastest_lowest_and_farthest_receiver_fits_every_sentence() {
    let mut report = report();
    report.solution = Some(solution(-89.999_999_999_9, -179.999_999_999_9, -12_345.678));
    if let Some(solution) = &mut report.solution {
        (solution.hdop, solution.vdop) = (1e9, 1e9);
    }
    let motion = Some(Motion { east_m_s: -9999.0, north_m_s: 0.01, up_m_s: 0.0, sigma_m_s: 1.0 });
    let npa = npa();
    let lines = told(&Statement { motion, ..statement(&report, &npa) }, Schedule::AT_START.due(0));
    for address in ["GNRMC", "GNGGA", "GNGNS", "GNVTG", "GNZDA", "GNGST", "PRAIS", "PRAIN"] {
        assert!(lines.iter().any(|line| line[1..].starts_with(address)), "{address} was too long");
    }
}

#[test]
fn extreme_numbers_shorten_the_sentence_and_never_break_it() {
    let mut report = report();
    report.verdict = Verdict::Unavailable(Unavailable::Redundancy);
    report.solution = Some(solution(-89.999_999_999_9, -179.999_999_999_9, -99_999.9));
    report.tracked = 255;
    report.test = Some(TestStatistic::new(1e9, 31.623, 61));
    report.protection = Some(ProtectionLevels::new(123_456.7, 654_321.9));
    let requirements = npa().with_hal_m(99_999.9).with_val_m(Some(99_999.9));
    let lines = sentences(&report, &requirements);
    let want =
        ["12", "U", "REDUNDANCY", "99", "16", "61", "99999", "31.6", "123457", "654322", "100000", "100000"];
    assert_eq!(fields(&lines, "PRAIS")[1..], want[1..]);
    let position = &fields(&lines, "GNGNS")[1..5];
    assert_eq!(position, ["9000.0000000", "S", "18000.0000000", "W"]);
    // The geoid at the south pole is 30 m below the ellipsoid, by the table.
    assert_eq!(fields(&lines, "GNGNS")[8..10], ["-99969.90", "-30.0"]);
}

#[test]
fn a_protection_level_without_bound_is_an_empty_field() {
    let mut report = report();
    report.protection = Some(ProtectionLevels::new(f64::INFINITY, 18.26));
    assert_eq!(fields(&sentences(&report, &npa()), "PRAIS")[8..10], ["", "18.3"]);
}

#[test]
fn staleness_says_the_time_of_the_last_epoch_if_there_was_one() {
    let cases =
        [(Some(NOON), "$PRAIS,120000.00,A,STALE,0,0,,,,,,556.0,"), (None, "$PRAIS,,A,STALE,0,0,,,,,,556.0,")];
    for (last, want) in cases {
        let mut out = Vec::new();
        let stale = Verdict::Alert(Alert::Stale);
        write_without_epoch(stale, last, GPS_MINUS_UTC_S, &npa(), &mut Growing(&mut out))
            .expect("a vector takes all");
        assert_eq!(lines(&out)[0].split('*').next(), Some(want));
    }
}

#[test]
fn the_version_line_survives_any_text() {
    let cases = [
        (["0.1.0", "6e909fb", "power-on", "PASS"], "$PRAIV,0.1.0,6e909fb,power-on,PASS"),
        (["a,b*c", "0123456789abcdefXYZ", "\r\n$", "é"], "$PRAIV,abc,0123456789abcdef,,"),
    ];
    for ([version, git, cause, selftest], want) in cases {
        let mut out = Vec::new();
        write_version(version, git, cause, selftest, &mut Growing(&mut out)).expect("a vector takes all");
        assert_eq!(lines(&out)[0].split('*').next(), Some(want));
    }
}

#[test]
fn counters_are_said_with_their_whole_names_and_as_many_as_fit() {
    // The longest names, with the largest values.
    let counters = [
        ("travel_time_out_of_bounds", u32::MAX),
        ("observations_after_end", u32::MAX),
        ("crc", 7),
        ("skipped", 0),
    ];
    let (mut out, mut next) = (Vec::new(), 0);
    while let Ok(many @ 1..) = write_counters(counters.into_iter().skip(next), &mut Growing(&mut out)) {
        next += many;
    }
    let have = lines(&out);
    let want = [
        "$PRAIA,STATS,travel_time_out_of_bounds,4294967295,OK",
        "$PRAIA,STATS,observations_after_end,4294967295,crc,7,skipped,0,OK",
    ];
    assert_eq!(have.iter().filter_map(|line| line.split('*').next()).collect::<Vec<_>>(), want);
}

/// Version 0.8 of the crate reads the two errors of `GBS` as a latitude and a longitude with
/// hemispheres. It refuses even a receiver maker's own examples, and thus cannot judge ours. gpsd
/// does, and this test checks the frame.
#[test]
fn the_crate_refuses_the_textbook_gbs_and_reads_the_frame_of_ours() {
    // u-blox's protocol specification: as before NMEA 4.1, and with the system and signal of 4.1.
    let textbook = [
        "$GPGBS,235458.00,1.4,1.3,3.1,03,,-21.4,3.8*5B",
        "$GPGBS,235458.00,1.4,1.3,3.1,03,,-21.4,3.8,1,0*5A",
    ];
    for line in textbook {
        let frame = nmea::parse_nmea_sentence(line).expect("a frame");
        assert_eq!(frame.checksum, frame.calc_checksum(), "{line}");
        assert!(parse_str(line).is_err(), "the crate has learnt GBS: let it read ours");
    }

    let lines = sentences(&report(), &npa());
    let line = lines.iter().find(|line| line.contains("GBS")).expect("a GBS");
    let frame = nmea::parse_nmea_sentence(line).expect("a frame");
    assert_eq!((frame.talker_id, frame.checksum), ("GN", frame.calc_checksum()));
    assert_eq!(frame.data.split(',').count(), textbook[1].split(',').count() - 1);
}
