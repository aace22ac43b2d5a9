//! A real gpsd's result for the module's sentences.
//!
//! gpsd takes position and mode from `GNS` and `GSA`, its `GST` object from `GST`, and the errors
//! `epx`, `epy`, `epv` of its position from `GBS` and from nothing else. Its `SKY` needs `GSV`;
//! `service/consumers.rs` has it.

use std::time::{Duration, SystemTime};

use anyhow::{Context, Result};
use oracle::chrony::{self, Chronyd, Source};
use oracle::gpsd::Gpsd;
use raim::signal::checksum::nmea_line;
use raim_core::frame::Geodetic;
use raim_core::report::{
    Alert, Protected, ProtectionLevels, Report, Solution, Suspect, TestStatistic, Unavailable, Verdict,
};
use raim_core::requirements::Requirements;
use raim_core::satellite::{Constellation, SatelliteId};
use raim_firmware::output::geoid::{Altitude, RMS_ERROR_M};
use raim_firmware::output::nmea::{GPS_MINUS_UTC_S, write_epoch};
use raim_firmware::output::schedule::Schedule;
use raim_firmware::output::{Interference, Motion, Statement};
use raim_firmware::time::GpsTime;
use rig::skip;
use serde_json::Value;

const LATITUDE_DEG: f64 = 55.493_712_345;
const LONGITUDE_DEG: f64 = -8.456_789_012;
const HEIGHT_M: f64 = 59.874;

/// Standard deviations of east, north, up, m: all different, so that they cannot be confused.
const SIGMA_M: [f64; 3] = [0.55, 0.71, 1.43];

/// Time within which gpsd must process one epoch.
const WITHIN: Duration = Duration::from_secs(5);

/// Number of epochs for gpsd, which needs a few to find the end of a cycle.
const EPOCHS: u32 = 40;

/// Returns a report of three systems with redundancy and without a fault.
fn report(verdict: Verdict) -> Report<64> {
    let geodetic = Geodetic {
        latitude_rad: LATITUDE_DEG.to_radians(),
        longitude_rad: LONGITUDE_DEG.to_radians(),
        height_m: HEIGHT_M,
    };
    let systems = [Constellation::Gps, Constellation::Galileo, Constellation::Beidou];
    let used = systems.into_iter().flat_map(|system| (11..17).map(move |number| (system, number)));
    let [east, north, up] = SIGMA_M;
    {
        let mut report = Report::nothing();
        report.verdict = verdict;
        report.solution = Some({
            let mut solution = Solution::at(geodetic.to_ecef(), geodetic);
            solution.covariance_m2 = [east * east, 0.1, 0.0, north * north, 0.0, up * up];
            solution.clocks_m = [Some(0.0), Some(0.0), Some(0.0), None];
            solution.hdop = 0.8;
            solution.vdop = 1.2;
            solution
        });
        report.test = Some(TestStatistic::new(0.912, 1.873, 12));
        report.protection = Some(ProtectionLevels::new(12.3, 18.2));
        report.excluded = heapless::Vec::new();
        report.suspect = SatelliteId::new(Constellation::Beidou, 12)
            .map(|satellite| Suspect::new(satellite, 1.5, -2.345, 1.5));
        report.used = used.filter_map(|(system, number)| SatelliteId::new(system, number)).collect();
        report.residual_rms_m = 0.934;
        report.tracked = 19;
        report
    }
}

fn sentences(report: &Report<64>, second: u32) -> Vec<u8> {
    sentences_at(report, GpsTime { week: 2400, tow_ms: 172_800_000 + second * 1000 })
}

fn sentences_at(report: &Report<64>, time: GpsTime) -> Vec<u8> {
    let mut bytes = Vec::new();
    let statement = Statement {
        report,
        time,
        gps_minus_utc_s: GPS_MINUS_UTC_S,
        requirements: &Requirements::non_precision_approach(),
        motion: Some(Motion { east_m_s: 3.0, north_m_s: 4.0, up_m_s: 0.0, sigma_m_s: 0.1 }),
        interference: Interference::default(),
        settings_hash: 0,
        unhealthy_l5: 0,
        in_view: None,
    };
    write_epoch(&statement, Schedule::AT_START.due(0), &mut bytes).expect("a vector takes all");
    bytes
}

/// Sends epoch after epoch until gpsd returns the wanted object; the error shows its last ones.
fn feed_until(
    gpsd: &mut Gpsd,
    report: &Report<64>,
    first_second: u32,
    wanted: impl Fn(&Value) -> bool,
) -> Result<Value> {
    for second in first_second..first_second + EPOCHS {
        gpsd.feed(&sentences(report, second))?;
        if let Ok(object) = gpsd.wait_for(Duration::from_millis(150), &wanted) {
            return Ok(object);
        }
    }
    gpsd.wait_for(WITHIN, wanted)
}

fn has_position(object: &Value) -> bool {
    object["class"] == "TPV" && object["mode"] == 3 && object["epx"].is_number()
}

#[track_caller]
fn assert_near(object: &Value, field: &str, want: f64, tolerance: f64) {
    let have = object[field].as_f64().unwrap_or(f64::NAN);
    assert!((have - want).abs() <= tolerance, "{field}: have {have}, want {want} in {object}");
}

#[test]
fn gpsd_reports_a_3d_fix_with_position_and_errors() -> Result<()> {
    let Some(mut gpsd) = Gpsd::start_or_skip()? else { return Ok(()) };
    let report = report(Verdict::Protected(Protected::Ok));
    let position = feed_until(&mut gpsd, &report, 0, has_position)?;
    assert_near(&position, "lat", LATITUDE_DEG, 2e-9);
    assert_near(&position, "lon", LONGITUDE_DEG, 2e-9);
    assert_near(&position, "altHAE", HEIGHT_M, 0.001);
    // By EGM96 the geoid is 58.13 m above the ellipsoid there.
    assert_near(&position, "geoidSep", 58.13, RMS_ERROR_M);
    assert_near(&position, "altMSL", HEIGHT_M - 58.13, RMS_ERROR_M);
    let [east, north, up] = SIGMA_M;
    assert_near(&position, "epx", east, 0.001);
    assert_near(&position, "epy", north, 0.001);
    assert_near(&position, "epv", up, 0.001);

    let errors = feed_until(&mut gpsd, &report, 100, |object| object["class"] == "GST")?;
    assert_near(&errors, "rms", 0.934, 0.001);
    assert_near(&errors, "lat", north, 0.001);
    assert_near(&errors, "lon", east, 0.001);
    assert_near(&errors, "alt", up, 0.001);
    Ok(())
}

/// Flat places, as most of the Earth is: latitude and longitude in degrees.
const FLAT: [[f64; 2]; 4] = [[46.5, 102.5], [-23.5, 134.0], [38.5, -90.5], [2.0, 78.5]];

/// A sentence without a separation makes gpsd use its own table, EGM2008 every 5°, which is as
/// coarse as ours.
#[test]
fn separation_of_gpsd_is_ours_within_the_errors_of_both_tables() -> Result<()> {
    let Some(mut gpsd) = Gpsd::start_or_skip()? else { return Ok(()) };
    for (hour, [latitude_deg, longitude_deg]) in FLAT.into_iter().enumerate() {
        let [latitude_rad, longitude_rad] = [latitude_deg, longitude_deg].map(f64::to_radians);
        let ours = Altitude::of(&Geodetic { latitude_rad, longitude_rad, height_m: 0.0 });
        let place =
            [(latitude_deg, 4, "NS"), (longitude_deg, 5, "EW")].map(|(angle_deg, digits, letters)| {
                let minutes = angle_deg.abs().trunc() * 100.0 + angle_deg.abs().fract() * 60.0;
                let letter = letters.get(usize::from(angle_deg < 0.0)..).and_then(|rest| rest.chars().next());
                format!("{minutes:0width$.4},{}", letter.unwrap_or_default(), width = digits + 5)
            });
        let place = place.join(",");
        let theirs = (0..EPOCHS).find_map(|second| {
            let time = format!("{hour:02}00{second:02}.00");
            let lines = [
                nmea_line(&format!("GNRMC,{time},A,{place},0.0,,060126,,,A")),
                nmea_line(&format!("GNGGA,{time},{place},1,09,0.8,100.0,M,,M,,")),
            ];
            gpsd.feed(lines.concat().as_bytes()).ok()?;
            let is_there = |object: &Value| {
                let have_deg = object["lat"].as_f64().unwrap_or(f64::NAN);
                object["geoidSep"].is_number() && (have_deg - latitude_deg).abs() < 1e-6
            };
            gpsd.wait_for(Duration::from_millis(150), is_there).ok()
        });
        let theirs = theirs.with_context(|| format!("gpsd gives no separation at {place}"))?;
        assert_near(&theirs, "geoidSep", ours.separation_m, 2.0 * RMS_ERROR_M);
    }
    Ok(())
}

/// 2026-01-06 00:00:00 GPS time is 18 s earlier in UTC.
#[test]
fn gpsd_knows_date_and_speed() -> Result<()> {
    let Some(mut gpsd) = Gpsd::start_or_skip()? else { return Ok(()) };
    let report = report(Verdict::Protected(Protected::Ok));
    let fix =
        feed_until(&mut gpsd, &report, 0, |object| has_position(object) && object["speed"].is_number())?;
    let time = fix["time"].as_str().unwrap_or_default();
    assert!(time.starts_with("2026-01-05T23:59:") || time.starts_with("2026-01-06T00:00:"), "{fix}");
    assert_near(&fix, "speed", 5.0, 0.01);
    assert_near(&fix, "track", 36.87, 0.01);
    Ok(())
}

#[test]
fn gpsd_drops_the_fix_when_the_module_alarms() -> Result<()> {
    let Some(mut gpsd) = Gpsd::start_or_skip()? else { return Ok(()) };
    feed_until(&mut gpsd, &report(Verdict::Protected(Protected::Ok)), 0, has_position)?;
    let alarm = report(Verdict::Alert(Alert::Fault));
    let no_fix =
        feed_until(&mut gpsd, &alarm, 100, |object| object["class"] == "TPV" && object["mode"] == 1)?;
    assert!(no_fix["lat"].is_null() && no_fix["lon"].is_null(), "{no_fix}");
    Ok(())
}

#[test]
fn gpsd_drops_the_fix_when_there_is_none() -> Result<()> {
    let Some(mut gpsd) = Gpsd::start_or_skip()? else { return Ok(()) };
    let protected = report(Verdict::Protected(Protected::Ok));
    feed_until(&mut gpsd, &protected, 0, has_position)?;
    let mut nothing = report(Verdict::Unavailable(Unavailable::NoFix));
    nothing.solution = None;
    nothing.suspect = None;
    nothing.used.clear();
    feed_until(&mut gpsd, &nothing, 100, |object| object["class"] == "TPV" && object["mode"] == 1)?;
    feed_until(&mut gpsd, &protected, 200, has_position)?;
    Ok(())
}

/// Start of GPS time in Unix time, ms: 1980-01-06 00:00:00 UTC.
const GPS_BEGAN_MS: u64 = 315_964_800_000;

/// Reports each full second as it begins, for at most `seconds` seconds or until chronyd follows
/// its source; returns the state of that source then.
fn tell_the_time(gpsd: &mut Gpsd, chronyd: &Chronyd, report: &Report<64>, seconds: u32) -> Result<Source> {
    let mut told = None;
    for _ in 0..seconds {
        let now_ms = u64::try_from(SystemTime::now().duration_since(SystemTime::UNIX_EPOCH)?.as_millis())?;
        let to_next_ms = 1000 - now_ms % 1000;
        std::thread::sleep(Duration::from_millis(to_next_ms));
        let utc_ms = now_ms + to_next_ms - GPS_BEGAN_MS;
        let time = GpsTime::from_ms(utc_ms + u64::from(GPS_MINUS_UTC_S) * 1000);
        gpsd.feed(&sentences_at(report, time))?;
        let _ = gpsd.objects()?;
        told = chronyd.source()?;
        if told.is_some_and(|told| told.is_followed && told.reach.count_ones() >= 4) {
            break;
        }
    }
    told.context("chronyd does not answer")
}

/// The time goes from the sentences over gpsd and its shared memory to the clock of a server. It
/// does so even under an alert, because gpsd forwards the time of a void `RMC`, and of a `ZDA`,
/// which has no status.
#[test]
fn chrony_follows_the_time_of_the_sentences() -> Result<()> {
    if !chrony::is_possible() {
        skip::say("chrony (apt-get install chrony) and the rights of the superuser");
        return Ok(());
    }
    let Some(mut gpsd) = Gpsd::start_apart_or_skip()? else { return Ok(()) };
    let chronyd = Chronyd::beside(&gpsd)?;
    let told = tell_the_time(&mut gpsd, &chronyd, &report(Verdict::Protected(Protected::Ok)), 14)?;
    assert!(told.is_followed && told.reach.count_ones() >= 4, "{told:?}");
    // The time is sent as the second begins: it is late by the delay of the line, and not by a leap
    // second.
    assert!(told.ahead_s.abs() < 0.5, "{told:?}");
    Ok(())
}
