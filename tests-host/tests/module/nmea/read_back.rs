//! Every report that there may be, read back by a reader that others wrote.

use nmea::sentences::gns::NavigationStatus;
use nmea::sentences::gnss_type::GnssSystemId;
use nmea::{ParseResult, parse_str};
use proptest::prelude::*;
use raim_core::report::{
    Alert, Protected, ProtectionLevels, Report, Solution, Suspect, TestStatistic, Unavailable, Verdict,
};
use raim_core::satellite::{Constellation, SatelliteId};

use super::{CAPACITY, npa, satellite, sentences, solution};

/// Numbers of any size that a report may hold, the infinite one included.
fn magnitude() -> impl Strategy<Value = f64> {
    prop_oneof![4 => 0.0..1e3, 1 => 0.0..1e12, 1 => Just(f64::INFINITY), 1 => Just(0.0)]
}

fn signed() -> impl Strategy<Value = f64> {
    prop_oneof![4 => -1e3..1e3, 1 => -1e12..1e12]
}

fn any_satellite() -> impl Strategy<Value = SatelliteId> {
    (0..4usize, 1..=63u8).prop_map(|(system, number)| satellite(Constellation::ALL[system], number))
}

fn any_verdict() -> impl Strategy<Value = Verdict> {
    prop_oneof![
        Just(Verdict::Protected(Protected::Excluded)),
        Just(Verdict::Alert(Alert::Ambiguous)),
        Just(Verdict::Alert(Alert::Time)),
        Just(Verdict::Unavailable(Unavailable::Redundancy)),
        Just(Verdict::Unavailable(Unavailable::Hpl)),
    ]
}

fn any_solution() -> impl Strategy<Value = Solution> {
    let variances = (0.0..1e4, -1.0..1.0f64, 0.0..1e4, 0.0..1e4);
    (-90.0..=90.0, -180.0..=180.0, -99_999.9..1e5, variances, magnitude(), magnitude()).prop_map(
        |(latitude, longitude, height, (east, correlation, north, up), hdop, vdop)| {
            let mut solution = solution(latitude, longitude, height);
            solution.covariance_m2 = [east, correlation * f64::sqrt(east * north), 0.0, north, 0.0, up];
            solution.hdop = hdop;
            solution.vdop = vdop;
            solution
        },
    )
}

fn any_suspect() -> impl Strategy<Value = Suspect> {
    (any_satellite(), signed(), signed(), magnitude()).prop_map(
        |(satellite, w_test, bias_m, bias_sigma_m)| Suspect::new(satellite, w_test, bias_m, bias_sigma_m),
    )
}

prop_compose! {
    fn any_report()(
        verdict in any_verdict(),
        solution in proptest::option::weighted(0.8, any_solution()),
        test in proptest::option::of((magnitude(), magnitude(), 0..=61u8)),
        protection in proptest::option::of((magnitude(), magnitude())),
        excluded in proptest::collection::vec(any_suspect(), 0..=3),
        suspect in proptest::option::of(any_suspect()),
        used in proptest::collection::btree_set(any_satellite(), 0..=CAPACITY),
        residual_rms_m in magnitude(),
        tracked in any::<u8>(),
    ) -> Report<CAPACITY> {
        { let mut report = Report::nothing(); report.verdict = verdict; report.solution = solution; report.test = test.map(|(statistic, threshold, dof)| TestStatistic::new(statistic, threshold, dof)); report.protection = protection.map(|(hpl_m, vpl_m)| ProtectionLevels::new(hpl_m, vpl_m)); report.excluded = excluded.into_iter().collect(); report.excluded_constellations = 0; report.suspect = suspect; report.used = used.into_iter().collect(); report.residual_rms_m = residual_rms_m; report.tracked = tracked; report.araim = None; report.height = None; report.sigma_check = None; report }
    }
}

/// Returns true if a value is within half a unit of the last decimal and the rounding of a reader's
/// `f32`.
fn near(have: Option<f32>, want: f64, step: f64) -> bool {
    have.is_some_and(|have| (f64::from(have) - want).abs() <= 0.5 * step + want.abs() * 1e-6)
}

proptest! {
    #[test]
    fn the_crate_reads_every_report_back(report in any_report()) {
        let lines = sentences(&report, &npa());
        let mut named = Vec::new();
        for line in lines.iter().filter(|line| line.starts_with("$G") && !line.contains("GBS")) {
            match parse_str(line).map_err(|error| TestCaseError::fail(format!("{line}: {error:?}")))? {
                ParseResult::GNS(gns) => gns_is_the_reports(&gns, &report, decimals(line, 9))?,
                ParseResult::GST(gst) => gst_is_the_reports(&gst, &report)?,
                ParseResult::GSA(gsa) => named.extend(gsa.fix_sats_prn.iter().map(|prn| (gsa.system_id, *prn))),
                ParseResult::RMC(rmc) => {
                    let usable = report.solution.is_some() && !matches!(report.verdict, Verdict::Alert(_));
                    prop_assert_eq!(rmc.lat.is_some(), usable);
                    prop_assert_eq!(rmc.fix_date.map(|date| date.to_string()), Some(String::from("2026-01-06")));
                }
                ParseResult::GGA(gga) => {
                    let usable = report.solution.is_some() && !matches!(report.verdict, Verdict::Alert(_));
                    prop_assert_eq!((gga.latitude.is_some(), gga.longitude.is_some()), (usable, usable));
                }
                ParseResult::VTG(vtg) => prop_assert_eq!(vtg.speed_over_ground, None),
                ParseResult::ZDA(zda) => prop_assert_eq!((zda.day, zda.month, zda.year), (Some(6), Some(1), Some(2026))),
                other => prop_assert!(false, "unexpected {other:?}"),
            }
        }
        prop_assert_eq!(named.len(), if report.solution.is_some() { report.used.len() } else { 0 });
        for used in report.used.iter().filter(|_| report.solution.is_some()) {
            let want = match used.constellation() {
                Constellation::Gps => (GnssSystemId::Gps, used.number()),
                Constellation::Glonass => (GnssSystemId::Glonass, used.number() + 64),
                Constellation::Galileo => (GnssSystemId::Galileo, used.number()),
                Constellation::Beidou => (GnssSystemId::Beidou, used.number()),
                other => panic!("no number for {other:?}"),
            };
            prop_assert!(named.contains(&(Some(want.0), u32::from(want.1))), "{} in {:?}", used, named);
        }
    }

    #[test]
    fn every_epoch_has_one_verdict_and_its_exclusions_last(report in any_report()) {
        let lines = sentences(&report, &npa());
        let verdicts = lines.iter().filter(|line| line.starts_with("$PRAIS")).count();
        prop_assert_eq!(verdicts, 1);
        prop_assert!(lines.last().is_some_and(|line| line.starts_with("$PRAIN")));
        let excluded = lines.iter().rev().skip(1).take_while(|line| line.starts_with("$PRAIX")).count();
        prop_assert_eq!(excluded, report.excluded.len());
        let fault = report.suspect.is_some() && report.solution.is_some();
        prop_assert_eq!(lines.iter().filter(|line| line.starts_with("$GNGBS")).count(), usize::from(fault));
    }
}

/// Returns the number of decimals of a field, counted from the address as 0.
fn decimals(line: &str, field: usize) -> usize {
    let field = line.split(',').nth(field).unwrap_or_default();
    field.split_once('.').map_or(0, |(_, decimals)| decimals.len())
}

fn gns_is_the_reports(
    gns: &nmea::sentences::GnsData,
    report: &Report<CAPACITY>,
    altitude_decimals: usize,
) -> Result<(), TestCaseError> {
    let status = match (report.verdict, &report.solution) {
        (Verdict::Protected(_), _) => NavigationStatus::Safe,
        (Verdict::Alert(_), _) => NavigationStatus::Unsafe,
        (_, Some(_)) => NavigationStatus::Caution,
        (_, None) => NavigationStatus::NotValidForNavigation,
    };
    prop_assert_eq!(gns.nav_status, Some(status));
    let is_alert = matches!(report.verdict, Verdict::Alert(_));
    let Some(solution) = report.solution.as_ref().filter(|_| !is_alert) else {
        prop_assert_eq!((gns.lat, gns.lon, gns.alt), (None, None, None));
        return Ok(());
    };
    // Half of 1e-7 minutes.
    let step_deg = 0.5e-7 / 60.0 + 1e-12;
    let want = [solution.geodetic.latitude_rad.to_degrees(), solution.geodetic.longitude_rad.to_degrees()];
    let have = [gns.lat, gns.lon].map(|angle| angle.unwrap_or(f64::NAN));
    prop_assert!((have[0] - want[0]).abs() <= step_deg, "{:?} {:?}", have, want);
    prop_assert!((have[1] - want[1]).abs() <= step_deg, "{:?} {:?}", have, want);
    let separation_m = f64::from(gns.geoid_separation.unwrap_or(f32::NAN));
    prop_assert!((-106.0..=85.0).contains(&separation_m));
    let altitude_m = solution.geodetic.height_m - separation_m;
    prop_assert!(near(gns.alt, altitude_m, 0.1_f64.powf(altitude_decimals as f64)));
    // The altitude loses decimals only if long fields stand beside it.
    let least = if altitude_m.abs() < 1e3 { 2 } else { usize::from(altitude_m.abs() < 1e4) };
    prop_assert!(altitude_decimals >= least);
    prop_assert!(near(gns.hdop, solution.hdop.min(99.99), 0.01));
    prop_assert_eq!(usize::from(gns.nsattelites), report.used.len());
    Ok(())
}

fn gst_is_the_reports(
    gst: &nmea::sentences::GstData,
    report: &Report<CAPACITY>,
) -> Result<(), TestCaseError> {
    let Some(solution) = &report.solution else {
        prop_assert_eq!(gst.lat_sd, None);
        return Ok(());
    };
    let [east, covariance, _, north, _, up] = solution.covariance_m2;
    prop_assert!(near(gst.lat_sd, north.sqrt(), 0.001));
    prop_assert!(near(gst.long_sd, east.sqrt(), 0.001));
    prop_assert!(near(gst.alt_sd, up.sqrt(), 0.001));
    // The ellipse must give back the covariance matrix: R diag(a², b²) Rᵀ.
    let angle = f64::from(gst.err_ellipse_orientation.unwrap_or(f32::NAN)).to_radians();
    let major = f64::from(gst.ellipse_semi_major_sd.unwrap_or(f32::NAN)).powi(2);
    let minor = f64::from(gst.ellipse_semi_minor_sd.unwrap_or(f32::NAN)).powi(2);
    let (sin, cos) = angle.sin_cos();
    // 0.05° of rotation and 0.0005 m of an axis.
    let tolerance = 1e-3 * (major - minor) + 1.1e-3 * major.sqrt() + 1e-6 * major + 1e-6;
    prop_assert!((major * cos * cos + minor * sin * sin - north).abs() <= tolerance);
    prop_assert!((major * sin * sin + minor * cos * cos - east).abs() <= tolerance);
    prop_assert!(((major - minor) * sin * cos - covariance).abs() <= tolerance);
    Ok(())
}
