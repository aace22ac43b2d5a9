//! The report: satellites as the module treats them, one page that needs nothing else, and the page
//! in a browser.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

use raim::page::report::{self, Facts, Happened, Journal, explanation};
use raim::page::timeline::Incident;
use raim::replay::{Lump, Pace, Playback};
use raim::satellites::{Account, Fate, View};
use raim::sentence;
use raim::signal::checksum::nmea_line;
use raim::signal::encode::{Encoder, Frequency, Selection};
use raim::signal::fault::{Fault, Injector};
use raim::signal::sky::Fleet;
use raim::signal::sky::raw::Simulation;
use raim::verdict::EpochOutput;
use raim_core::satellite::{Constellation, SatelliteId};

/// Largest size of the script.
const SCRIPT_BYTES: usize = 50 * 1024;

/// Returns a minute of three systems down to the horizon, with a fault.
fn lumps(fault: Option<Fault>) -> Vec<Lump> {
    let fleets = [Fleet::Gps31, Fleet::Galileo24, Fleet::Beidou24];
    let recording = Simulation {
        satellites: fleets.into_iter().flat_map(Fleet::satellites).collect(),
        mask_rad: 0.0,
        ..Simulation::above_xian(0.0, 60, 5)
    }
    .record();
    let mut encoder = Encoder::new(&recording.ephemerides, Selection::new("GCE", Frequency::Dual).unwrap());
    let epochs = Injector::new(recording.epochs.into_iter(), fault.into_iter().collect());
    (0..60)
        .zip(epochs)
        .map(|(second, epoch)| Lump {
            time: epoch.time,
            elapsed_s: f64::from(second),
            bytes: encoder.epoch(&epoch).unwrap(),
        })
        .collect()
}

/// Returns the same, where the highest satellite of those used is off for twenty seconds.
fn faulty() -> Vec<Lump> {
    let (epochs, _) = played(lumps(None), &[]);
    let (_, view) = &epochs[20];
    let used = view.satellites.iter().filter(|seen| seen.fate == Fate::Used);
    let highest =
        used.max_by(|one, other| one.elevation_rad.partial_cmp(&other.elevation_rad).unwrap()).unwrap();
    lumps(Some(Fault::parse_inject(&format!("{}:+300@20..40", highest.satellite)).unwrap()))
}

type Played = (Vec<(EpochOutput, View)>, BTreeMap<String, u32>);

fn played(lumps: Vec<Lump>, setup: &[String]) -> Played {
    let mut playback = Playback::start(lumps.into_iter().map(Ok), setup, Pace::Recorded).unwrap();
    playback.watch();
    let mut epochs = Vec::new();
    while let Some((_, reported)) = playback.advance().unwrap() {
        epochs.push((reported.output().unwrap().clone(), reported.view().unwrap().clone()));
    }
    (epochs, playback.counters().unwrap().into_iter().collect())
}

fn journal(epochs: &[(EpochOutput, View)]) -> Journal {
    let mut journal = Journal::default();
    for (second, (output, view)) in (0..).zip(epochs) {
        journal.push(&Happened {
            time_s: f64::from(second),
            output,
            error: None,
            pin_is_high: output.state.is_protected(),
            view: Some(view),
        });
    }
    journal
}

/// Fates that the module counts, with their counters.
const COUNTED: [(Fate, &str); 13] = [
    (Fate::BelowMask, "below_mask"),
    (Fate::SignalUnusable, "signal_unusable"),
    (Fate::SystemLeftOut, "system_left_out"),
    (Fate::EphemerisMissing, "ephemeris_missing"),
    (Fate::EphemerisStale, "ephemeris_stale"),
    (Fate::EphemerisDisputed, "ephemeris_disputed"),
    (Fate::EphemerisUnproved, "ephemeris_unproved"),
    (Fate::Unhealthy, "satellite_unhealthy"),
    (Fate::TravelTime, "travel_time_out_of_bounds"),
    (Fate::RangeImplausible, "range_implausible"),
    (Fate::BandsApart, "bands_apart"),
    (Fate::Twice, "satellite_twice"),
    (Fate::EpochFull, "epoch_full"),
];

/// The module counts what it leaves out, by reason and without names. The names must add up to its
/// counts.
#[test]
fn satellites_that_are_not_used_add_up_to_the_counters_of_the_module() {
    let (epochs, counters) = played(faulty(), &["SYSTEMS,GE".to_owned(), "CN0MASK,20".to_owned()]);
    let have = |fate: Fate| -> u32 {
        epochs
            .iter()
            .map(|(_, view)| view.satellites.iter().filter(|seen| seen.fate == fate).count() as u32)
            .sum()
    };
    let counter = |name: &str| counters.get(name).copied().unwrap_or(0);
    assert!(have(Fate::SystemLeftOut) > 0 && have(Fate::BelowMask) > 0);
    for (fate, name) in COUNTED {
        assert_eq!(have(fate), counter(name), "{name}");
    }
    for (output, view) in &epochs {
        let of = |fate: Fate| view.satellites.iter().filter(|seen| seen.fate == fate).count();
        assert_eq!(of(Fate::Used), output.state.used as usize);
        assert_eq!(of(Fate::Excluded), output.excluded.len());
        assert_eq!(view.satellites.len(), output.state.tracked as usize);
    }
}

/// The w-test of an excluded satellite is that of its prediction by the others; its residual is the
/// bias that `PRAIX` reports.
#[test]
fn residuals_and_w_tests_are_those_of_the_sentences() {
    let (epochs, _) = played(faulty(), &[]);
    let mut excluded = 0;
    for (output, view) in &epochs {
        for one in &output.excluded {
            let seen = view.satellites.iter().find(|seen| seen.satellite == one.satellite).unwrap();
            assert!((seen.residual_m.unwrap() - one.bias_m).abs() < 0.1, "{seen:?} {one:?}");
            assert!(seen.w_test.unwrap() > 5.0, "{seen:?}");
            excluded += 1;
        }
        // SSE/dof is the square of the statistic.
        let squares = |seen: &Account| (seen.residual_m.unwrap() / seen.sigma_m.unwrap()).powi(2);
        let sse: f64 = view.satellites.iter().filter(|seen| seen.fate == Fate::Used).map(squares).sum();
        let state = &output.state;
        let have = (sse / f64::from(state.dof.unwrap())).sqrt();
        assert!((have - state.statistic.unwrap()).abs() < 2e-3, "{have} {state:?}");
    }
    assert_eq!(excluded, 20);
}

/// `GBS` names the used satellite with the largest w-test, by the core's own computation.
#[test]
fn the_worst_satellite_is_that_of_the_module() {
    let mut playback = Playback::start(faulty().into_iter().map(Ok), &[], Pace::Recorded).unwrap();
    playback.watch();
    let mut compared = 0;
    while let Some((_, reported)) = playback.advance().unwrap() {
        let line = reported.of_epoch.lines().find(|line| line.contains("GBS,")).unwrap().to_owned();
        let fields: Vec<&str> = line.split(',').collect();
        let used: Vec<Account> = reported
            .view()
            .unwrap()
            .satellites
            .iter()
            .filter(|seen| seen.fate == Fate::Used)
            .copied()
            .collect();
        let size = |seen: &Account| seen.w_test.unwrap_or(0.0).abs();
        let worst = used.iter().max_by(|one, other| size(one).total_cmp(&size(other))).unwrap();
        let number: u8 = fields[5].parse().unwrap();
        assert_eq!(worst.satellite.name().1, number, "{line} {worst:?}");
        compared += 1;
    }
    assert_eq!(compared, 60);
}

#[test]
fn every_reason_of_the_interface_is_explained() {
    let text = include_str!("../../../INTERFACES.md");
    let (_, table) = text.split_once("### States and reasons").unwrap();
    let (table, _) = table.split_once("\n###").unwrap();
    let mut words = 0;
    for row in table.lines().filter(|line| line.starts_with("| ") && line.contains('`')) {
        let reasons = row.split('|').nth(2).unwrap();
        for reason in reasons.split('`').skip(1).step_by(2) {
            assert!(explanation(reason).is_some(), "{reason}");
            words += 1;
        }
    }
    assert!(words >= 27, "{words}");
}

#[test]
fn the_page_has_every_part_and_needs_nothing_from_elsewhere() {
    let (epochs, _) = played(faulty(), &[]);
    let facts = Facts {
        title: "a <test>".to_owned(),
        source: "capture </script>.ubx".to_owned(),
        command: "rai replay 'x'".to_owned(),
        settings_hash: "75F8C850".to_owned(),
        mask_deg: 10.0,
        ..Facts::default()
    };
    // The namespace of SVG is a name, which no browser opens.
    let html =
        report::page(&journal(&epochs), &facts).unwrap().html().replace("http://www.w3.org/2000/svg", "");
    for foreign in ["http://", "https://", " src=", "<link", "@import", "url(", "fetch("] {
        assert!(!html.contains(foreign), "{foreign}");
    }
    for part in [
        "75F8C850",
        "rai replay 'x'",
        "States and their reasons",
        "the remaining satellites agree after an exclusion",
        "Satellites in the sky",
        "Positions over the ground",
        "C/N0 / dB-Hz",
        "residual / m",
        "below the elevation mask",
        "data-from=",
        " UTC",
    ] {
        assert!(html.contains(part), "{part}");
    }
    let (_, script) = html.rsplit_once("<script>").unwrap();
    assert!(script.len() <= SCRIPT_BYTES && script.contains("MIT OR Apache-2.0"), "{} bytes", script.len());
    let (_, data) = html.split_once("id=\"data\">").unwrap();
    let (data, _) = data.split_once("</script>").unwrap();
    let data: serde_json::Value = serde_json::from_str(data).unwrap();
    assert_eq!(data["n"], 60);
    assert_eq!(data["scale"], "UTC");
    // Without script the same is drawn twice: for a wide page and for a telephone.
    assert_eq!(html.matches("class=\"wide-page\"").count(), html.matches("class=\"narrow-page\"").count());
    assert!(html.matches("<svg").count() >= 10);
}

fn chromium() -> Option<&'static str> {
    ["chromium", "chromium-browser", "google-chrome"]
        .into_iter()
        .find(|name| Command::new(name).arg("--version").output().is_ok_and(|output| output.status.success()))
}

/// Opens a page in a browser; returns the document after its scripts.
fn opened(browser: &str, path: &Path, folder: &Path) -> String {
    let output = Command::new(browser)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--allow-file-access-from-files", "--dump-dom"])
        .args(["--timeout=60000", "--virtual-time-budget=20000"])
        .arg(format!("--user-data-dir={}", folder.join("profile").display()))
        .arg(format!("file://{}", path.display()))
        .output()
        .unwrap();
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// The fault is in the capture from 20 s to 40 s; the module leaves its satellite out.
#[test]
fn the_pointer_names_the_satellite_that_is_left_out() {
    let Some(browser) = chromium() else { return rig::skip::say("a browser (chromium)") };
    let folder = tempfile::tempdir().unwrap();
    let (epochs, _) = played(faulty(), &[]);
    let satellite = epochs[30].0.excluded[0].satellite;
    let incident = Incident { name: format!("fault of {satellite}"), range_s: 20.0..40.0 };
    let facts = Facts { title: "a fault".to_owned(), incidents: vec![incident], ..Facts::default() };
    let html = report::page(&journal(&epochs), &facts).unwrap().html();
    // The rows show 0 s to 60 s between the labels, 58 pixels, and the margin, 14 pixels.
    let script = "const frame=document.querySelector('.frame'),box=frame.getBoundingClientRect();for(const t of [10,30]){\
                  frame.dispatchEvent(new PointerEvent('pointermove',{clientX:box.left+58+t/60*(box.width-72)}));\
                  document.body.dataset['at'+t]=document.querySelector('output.instantly').textContent}\
                  document.body.dataset.legends=[...document.querySelectorAll('.row-live')].filter((row)=>\
                  row.querySelector('.legend').textContent.includes('fault of')).length;\
                  document.body.dataset.rows=document.querySelectorAll('.row-live').length";
    let path = folder.path().join("page.html");
    std::fs::write(&path, format!("{html}<script>{script}</script>")).unwrap();
    let dom = opened(browser, &path, folder.path());
    let value = |name: &str| {
        let (_, rest) = dom.split_once(&format!("data-{name}=\"")).unwrap_or_else(|| panic!("{name}: {dom}"));
        rest.split_once('"').unwrap().0.to_owned()
    };
    assert!(!value("at10").contains("left out"), "{}", value("at10"));
    assert!(value("at30").ends_with(&format!(" used, {satellite} left out")), "{}", value("at30"));
    // Every row but that of the states has the tint of the fault.
    let [legends, rows] = ["legends", "rows"].map(|name| value(name).parse::<u32>().unwrap());
    assert!(legends >= 4 && legends == rows - 1, "{legends} of {rows}");
}

/// Returns a day at one epoch a second with thirty satellites.
fn day() -> Journal {
    let mut journal = Journal::default();
    let satellite = |number: u8, second: u32| {
        let turn = f64::from(second) * 1e-4 + f64::from(number);
        let mut account = Account::of(SatelliteId::new(Constellation::Gps, number).unwrap(), Fate::Used);
        account.azimuth_rad = Some(turn.rem_euclid(std::f64::consts::TAU));
        account.elevation_rad = Some(0.8 + 0.5 * turn.sin());
        account.cn0_dbhz = Some(42.0 + 6.0 * turn.sin());
        account.residual_m = Some((f64::from(second) * 0.1 + f64::from(number)).sin());
        account.sigma_m = Some(2.0);
        account.w_test = Some(0.5);
        account
    };
    for second in 0..86_400 {
        let (hour, minute) = (second / 3600, second / 60 % 60);
        let time = format!("{hour:02}{minute:02}{:02}.00", second % 60);
        let level = 8.0 + f64::from(second % 600) * 0.01;
        let text =
            nmea_line(&format!("PRAIS,{time},P,OK,30,30,26,0.9,1.8,{level:.1},{:.1},40.0,35.0", 1.5 * level));
        let output = sentence::epochs(&text).unwrap().pop().unwrap();
        let view = View {
            time: None,
            clock_m: Some(level),
            satellites: (1..=30).map(|n| satellite(n, second)).collect(),
        };
        let time_s = f64::from(second);
        journal.push(&Happened {
            time_s,
            output: &output,
            error: None,
            pin_is_high: true,
            view: Some(&view),
        });
    }
    journal
}

#[test]
fn name_that_ends_in_html_is_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("day.html");
    let path = report::write(&Journal::default(), &Facts::default(), &file).unwrap();
    assert_eq!(path, file);
    assert!(file.is_file());
}

/// Many seconds each.
mod at_length {
    use super::*;

    #[test]
    fn a_browser_draws_a_day_and_no_page_is_wider_than_a_telephone() {
        let Some(browser) = chromium() else { return rig::skip::say("a browser (chromium)") };
        let folder = tempfile::tempdir().unwrap();
        let journal = day();
        let path =
            report::write(&journal, &Facts { title: "a day".to_owned(), ..Facts::default() }, folder.path())
                .unwrap();
        println!("{} KiB", std::fs::metadata(&path).unwrap().len() / 1024);
        let dom = opened(browser, &path, folder.path());
        let ready = dom.split_once("data-ready=\"").and_then(|(_, rest)| rest.split_once('"'));
        let (ready_ms, _) = ready.expect("the script has run to its end");
        println!("ready after {ready_ms} ms");
        assert!(dom.contains("class=\"live\""));

        // A frame of the width of a telephone reports its own width.
        let frame = folder.path().join("frame.html");
        let script = "onload=()=>{const d=frames[0].document,w=d.documentElement.scrollWidth-d.documentElement.clientWidth,c=[...d.querySelectorAll('canvas')];\
                      document.body.dataset.width=w;document.body.dataset.beyond=c.filter((one)=>{const \
                      b=one.getBoundingClientRect();return b.left<0||b.right>390}).length;document.body.dataset.canvases=c.length}";
        let html = format!(
            "<body><iframe src=\"report.html\" style=\"width:390px;height:2000px;border:0\"></iframe><script>{script}</script>"
        );
        std::fs::write(&frame, html).unwrap();
        let dom = opened(browser, &frame, folder.path());
        for want in ["data-width=\"0\"", "data-beyond=\"0\"", "data-canvases=\"10\""] {
            assert!(dom.contains(want), "{want}: {}", &dom[..dom.len().min(400)]);
        }
    }
}
