//! Recordings of any length: memory does not grow with them, and `monitor` reads the same files as
//! `replay`.
//!
//! A simulated sky of three systems is written as RTCM 3, as UBX and as RINEX. Its length is that
//! of the test, or `RAI_EPOCHS`; 86,400 epochs are a day. It is compared with an eighth of it.

use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::{BufWriter, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::Duration;

use flate2::Compression;
use flate2::write::GzEncoder;
use raim::signal::encode::{Encoder, Frequency, Selection, ubx};
use raim::signal::measurement::{Ephemeris, MeasuredEpoch};
use raim::signal::sky::Fleet;
use raim::signal::sky::raw::Simulation;
use raim_firmware::time::GpsTime;

/// Satellites of every epoch.
const SATELLITES: usize = 28;

/// Largest memory of a replay of any length, KiB.
const MEMORY_KIB: u64 = 64 * 1024;

/// Epochs of the longer recording; the shorter has an eighth of them.
const EPOCHS: u32 = 3600;

/// Largest growth of the memory with eight times as many epochs, KiB: values that are counted
/// exactly, and the report's 44 bytes of each epoch, of which it has at most 90,000.
const GROWTH_KIB: u64 = 6 * 1024;

fn sky(epochs: u32, step_s: f64) -> Simulation {
    let fleets = [Fleet::Gps31, Fleet::Galileo24, Fleet::Beidou24];
    Simulation {
        satellites: fleets.into_iter().flat_map(Fleet::satellites).collect(),
        step_s,
        mask_rad: 0.0,
        ..Simulation::above_xian(0.0, epochs, 7)
    }
}

/// Returns the epochs of a sky, one by one, because a day of them does not fit into the memory.
fn epochs_of(sky: &Simulation) -> impl Iterator<Item = MeasuredEpoch> {
    sky.epochs().map(|mut epoch| {
        epoch.satellites.truncate(SATELLITES);
        epoch
    })
}

fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn write(path: &Path, parts: impl Iterator<Item = Vec<u8>>) {
    let mut file = BufWriter::new(File::create(path).unwrap());
    parts.for_each(|part| file.write_all(&part).unwrap());
    file.flush().unwrap();
}

fn selection() -> Selection {
    Selection::new("GCE", Frequency::Dual).unwrap()
}

fn rtcm(sky: &Simulation) -> impl Iterator<Item = Vec<u8>> {
    let mut encoder = Encoder::new(&sky.ephemerides(), selection()).as_receiver();
    epochs_of(sky).map(move |epoch| encoder.epoch(&epoch).unwrap())
}

fn of_u_blox(sky: &Simulation) -> impl Iterator<Item = Vec<u8>> {
    let mut encoder = ubx::Encoder::new(&sky.ephemerides(), selection(), None).as_receiver();
    epochs_of(sky).map(move |epoch| encoder.epoch(&epoch).unwrap())
}

/// Returns date and time of an instant of January 2024. Week 2295 begins on the day before.
fn date(time: GpsTime) -> String {
    let day = u32::from(time.week - 2295) * 7 + time.tow_ms / 86_400_000;
    let (date, second) = (format!("2024 01 {day:02}"), time.tow_ms / 1000 % 86_400);
    let date = if day == 0 { "2023 12 31" } else { &date };
    assert!(day <= 31, "the dates of this test end with January");
    format!("{date} {:02} {:02} {:02}", second / 3600, second / 60 % 60, second % 60)
}

fn header(kind: &str, rows: &str) -> String {
    format!(
        "     3.04           {kind:<20}M                   RINEX VERSION / TYPE\n{rows}{:60}END OF HEADER\n",
        ""
    )
}

fn observation_header() -> String {
    let kinds = [("G", "C1C S1C C2W S2W"), ("E", "C1C S1C C5Q S5Q"), ("C", "C2I S2I C6I S6I")];
    let row = |(system, codes)| format!("{:<60}SYS / # / OBS TYPES\n", format!("{system}    4 {codes}"));
    header("OBSERVATION DATA", &kinds.map(row).concat())
}

fn observations(epoch: &MeasuredEpoch) -> Vec<u8> {
    let fraction = f64::from(epoch.time.tow_ms % 1000) * 1e-3;
    let clock = date(epoch.time);
    let second: f64 = clock[17..].parse::<f64>().unwrap() + fraction;
    let mut text = format!("> {}{second:11.7}  0{:3}\n", &clock[..16], epoch.satellites.len());
    for satellite in &epoch.satellites {
        let _ = write!(text, "{}", satellite.satellite);
        for signal in &satellite.signals {
            let _ = write!(text, "{:14.3}  {:14.3}  ", signal.pseudorange_m, signal.cn0_dbhz.unwrap());
        }
        text.push('\n');
    }
    text.into_bytes()
}

/// Makes the rows of a record, with the fields that the messages of all systems share.
macro_rules! record {
    ($known:ident, $m:ident, [$af0:ident, $af1:ident], $issue:expr) => {{
        let radians = |semicircles: f64| semicircles * std::f64::consts::PI;
        let toe_s = f64::from($m.toe_s);
        let clock = [f64::from($m.$af0), f64::from($m.$af1), 0.0];
        let rows = [
            [f64::from($issue), 0.0, radians($m.delta_n_sc_s.into()), radians($m.m0_sc)],
            [0.0, $m.eccentricity, 0.0, $m.sqrt_a_sqrt_m],
            [toe_s, 0.0, radians($m.omega0_sc), 0.0],
            [radians($m.i0_sc), 0.0, radians($m.omega_sc), radians($m.omegadot_sc_s.into())],
            [0.0, 0.0, 2295.0, 0.0],
            [2.0, 0.0, 0.0, 0.0],
            [toe_s - 1800.0, 0.0, 0.0, 0.0],
        ];
        let numbers = |row: &[f64]| row.iter().map(|value| format!("{value:19.12e}")).collect::<String>();
        // In the system's own time, whose week ends up to 14 s after that of GPS.
        let week = $known.toe.week - u16::from($known.toe.tow_ms < 14_000 && toe_s > 14.0);
        let toe = GpsTime { week, tow_ms: (toe_s * 1e3) as u32 };
        let mut text = format!("{} {}{}\n", $known.satellite, date(toe), numbers(&clock));
        for row in &rows {
            text.push_str(&format!("    {}\n", numbers(row)));
        }
        text.into_bytes()
    }};
}

fn navigation(sky: &Simulation) -> impl Iterator<Item = Vec<u8>> {
    let head = header("N: GNSS NAV DATA", "").into_bytes();
    let records = sky.ephemerides().into_iter().map(|known| match &known.message {
        Ephemeris::Gps(m) => record!(known, m, [af0_s, af1_s_s], m.iode),
        Ephemeris::GalileoInav(m) => record!(known, m, [af0_s, af1_s_s], m.iodnav),
        Ephemeris::Beidou(m) => record!(known, m, [a0_s, a1_s_s], m.aode),
        _ => Vec::new(),
    });
    std::iter::once(head).chain(records)
}

/// Returns the ways to replay one sky, by name, and the arguments of each.
fn ways(folder: &Path, epochs: u32) -> Vec<(&'static str, Vec<String>)> {
    let sky = sky(epochs, 1.0);
    let path = |name: &str| folder.join(format!("{epochs}{name}"));
    write(&path(".rtcm3"), rtcm(&sky));
    write(&path(".ubx"), of_u_blox(&sky));
    let head = std::iter::once(observation_header().into_bytes());
    write(&path(".obs"), head.chain(epochs_of(&sky).map(|epoch| observations(&epoch))));
    write(&path(".nav"), navigation(&sky));
    let name = |name: &str| path(name).display().to_string();
    vec![
        ("RTCM 3", vec![name(".rtcm3")]),
        ("UBX", vec![name(".ubx")]),
        ("RINEX", vec!["--obs".to_owned(), name(".obs"), "--nav".to_owned(), name(".nav")]),
    ]
}

fn program() -> Command {
    Command::new(std::env::var_os("RAI_RIG").unwrap_or_else(|| env!("CARGO_BIN_EXE_rig").into()))
}

/// Runs a replay; returns its output and its largest memory, KiB.
fn replay(arguments: &[String]) -> (String, u64) {
    let mut child =
        program().arg("replay").args(arguments).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
    let status = format!("/proc/{}/status", child.id());
    let mut most_kib = 0;
    while child.try_wait().unwrap().is_none() {
        let text = fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kib = line.and_then(|line| line.trim().strip_suffix(" kB")?.parse().ok());
        most_kib = most_kib.max(kib.unwrap_or(0));
        std::thread::sleep(Duration::from_millis(5));
    }
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{arguments:?}");
    (String::from_utf8(output.stdout).unwrap(), most_kib)
}

fn monitor(path: &Path, more: &[&str]) -> Output {
    program().args(["monitor", "--plain", "--file"]).arg(path).args(more).output().unwrap()
}

/// Returns the lines of verdicts that `monitor --plain` prints.
fn verdicts(output: &Output) -> Vec<String> {
    let text = String::from_utf8(output.stdout.clone()).unwrap();
    let is_verdict = |line: &&str| line.contains("statistic");
    text.lines().filter(is_verdict).map(str::to_owned).collect()
}

#[test]
fn monitor_judges_every_epoch_that_replay_judges() {
    const TEN_HERTZ: u32 = 600;
    let folder = folder("monitor");
    let sky = sky(TEN_HERTZ, 0.1);
    for (name, bytes) in [
        ("tenth.rtcm3", rtcm(&sky).flatten().collect::<Vec<u8>>()),
        ("tenth.ubx", of_u_blox(&sky).flatten().collect()),
    ] {
        let (plain, packed) = (folder.join(name), folder.join(format!("{name}.gz")));
        fs::write(&plain, &bytes).unwrap();
        let mut encoder = GzEncoder::new(File::create(&packed).unwrap(), Compression::fast());
        encoder.write_all(&bytes).unwrap();
        encoder.finish().unwrap();
        let have = monitor(&plain, &[]);
        assert!(have.status.success());
        assert_eq!(verdicts(&have).len(), TEN_HERTZ as usize, "{name}");
        assert_eq!(verdicts(&monitor(&packed, &[])), verdicts(&have), "{name}");
        // The recorded sentences are a file again.
        let reported = folder.join("said.nmea");
        let record = ["--record", reported.to_str().unwrap()];
        assert_eq!(verdicts(&monitor(&plain, &record)), verdicts(&have), "{name}");
        assert_eq!(verdicts(&monitor(&reported, &["--speed", "max"])), verdicts(&have), "{name}");
    }
}

#[test]
fn monitor_refuses_what_is_no_stream_as_replay_does() {
    let folder = folder("refused");
    let bzip2 = b"BZh91AY&SY and more".to_vec();
    let nmea = b"$GPGLL,4916.45,N,12311.12,W,225444,A,*1D\r\n".repeat(9);
    for (name, bytes, want) in [
        ("empty", Vec::new(), "is empty"),
        ("packed", bzip2, "bzip2"),
        ("day.obs", observation_header().into_bytes(), "RINEX observation file"),
        ("text", b"no stream at all\n".to_vec(), "text"),
        ("nmea", nmea, "9 lines of NMEA. missing: ranges"),
    ] {
        let path = folder.join(name);
        fs::write(&path, bytes).unwrap();
        for output in [monitor(&path, &[]), program().arg("replay").arg(&path).output().unwrap()] {
            let reported = String::from_utf8(output.stderr).unwrap();
            assert_eq!(output.status.code(), Some(1), "{name}: {reported}");
            assert!(reported.contains(want) && reported.contains(name), "{name}: {reported}");
            assert_eq!(reported.lines().count(), 1, "{name}: {reported}");
        }
    }
    let output = monitor(Path::new("day.obs"), &["--speed", "0"]);
    assert!(String::from_utf8_lossy(&output.stderr).contains("more than 0"), "{output:?}");
}

/// Many seconds each.
mod at_length {
    use super::*;

    #[test]
    fn memory_does_not_grow_with_the_recording() {
        if !Path::new("/proc/self/status").exists() {
            return rig::skip::say("memory of a child (/proc)");
        }
        let many = std::env::var("RAI_EPOCHS").map_or(EPOCHS, |many| many.parse().unwrap());
        let folder = folder("memory");
        let mut of_few = Vec::new();
        for epochs in [many / 8, many] {
            for (index, (way, mut arguments)) in ways(&folder, epochs).into_iter().enumerate() {
                let csv = folder.join("rows.csv");
                let truth = "34.17,108.57,400".to_owned();
                let report = folder.join("report").display().to_string();
                arguments.extend([
                    "--csv".to_owned(),
                    csv.display().to_string(),
                    "--truth".to_owned(),
                    truth,
                ]);
                arguments.extend(["--report".to_owned(), report]);
                let (reported, kib) = replay(&arguments);
                let rows = fs::read_to_string(&csv).unwrap().lines().count();
                println!("{way}, {epochs} epochs: {kib} KiB; {}", reported.lines().next().unwrap_or(""));
                assert_eq!(rows, epochs as usize + 1, "{way}");
                assert!(
                    reported.contains(&format!("epochs {epochs}, fixes {epochs}: ")),
                    "{way}: {reported}"
                );
                assert!(kib < MEMORY_KIB, "{way}, {epochs} epochs: {kib} KiB");
                match of_few.get(index) {
                    None => of_few.push(kib),
                    Some(few_kib) => assert!(kib < few_kib + GROWTH_KIB, "{way}: {few_kib} and {kib} KiB"),
                }
            }
        }
    }
}
