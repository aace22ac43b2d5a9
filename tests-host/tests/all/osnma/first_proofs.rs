//! Time from nothing but the key to the first four proved satellites: in process, and on the emulated
//! boards, with pages as `RXM-SFRBX` and as `GALRawINAV`.

use std::collections::BTreeSet;
use std::thread;
use std::time::{Duration, Instant};

use rig::board::{EmulatedBoard, Machine, MonitorSocket, Settings, is_installed};
use rig::image;

use super::*;

/// Formats of a page.
type Written = fn(&Page) -> Vec<u8>;
const FORMATS: [(&str, Written); 2] = [("SFRBX", Page::message), ("4023", Page::block)];

/// Longest time to four proved satellites, s: by a loop of a millisecond, and by ten ticks a second.
const BY_LOOP_S: f64 = 180.0;
const BY_TICKS_S: f64 = 240.0;

/// Returns the pages of the first seconds.
fn begin(pages: Vec<Page>, seconds: u32) -> Vec<Page> {
    let end_s = pages.first().expect("a page").begin_s + seconds;
    pages.into_iter().take_while(|page| page.begin_s < end_s).collect()
}

#[test]
fn the_first_four_satellites_are_proved_within_three_minutes_of_bytes() {
    let Some(station) = station() else { return };
    let pages = begin(station, 260);
    let start_s = pages[0].begin_s;
    for (tick_ms, most_s) in [(1, BY_LOOP_S), (100, BY_TICKS_S)] {
        let both = FORMATS.map(|(format, written)| {
            let mut module = Module::new(&[KEY]);
            let first_s = module.hear_as(&pages, start_s, tick_ms, written);
            println!("{format}, ticks of {tick_ms} ms: {first_s:?} s");
            assert!(first_s.is_some_and(|first_s| first_s <= most_s), "{first_s:?}");
            assert_eq!(module.counter("osnma_orbits_wrong"), 0);
            first_s
        });
        assert_eq!(both[0], both[1]);
    }
}

/// Bytes of the line, and when they come, ms after the first page is complete.
struct Lump {
    due_ms: u64,
    bytes: Vec<u8>,
}

/// Time of an epoch after the pages before it, ms. Slices that pages cause are done by then, but for
/// those of a signature and of a long chain.
const EPOCH_MS: u64 = 1500;

/// Returns the pages of each second in one lump, and an epoch after those of E1.
fn lumps(pages: &[Page], (_, written): (&str, Written)) -> Vec<Lump> {
    let start_s = pages[0].begin_s;
    let satellites: BTreeSet<u8> = pages.iter().map(|page| page.satellite).collect();
    let satellites: Vec<u8> = satellites.into_iter().collect();
    let is_sbf = written(&pages[0])[0] == b'$';
    let mut lumps = Vec::new();
    for together in pages.chunk_by(|a, b| a.begin_s == b.begin_s) {
        let came_ms = u64::from(together[0].begin_s - start_s) * 1000;
        lumps.push(Lump { due_ms: came_ms, bytes: together.iter().flat_map(written).collect() });
        if together[0].is_e1 {
            let rawx = ranges(&satellites, together[0].begin_s + 3);
            let bytes = if is_sbf { sbf::of_ubx(&rawx, gps_time(together[0].begin_s + 3)) } else { rawx };
            lumps.push(Lump { due_ms: came_ms + EPOCH_MS, bytes });
        }
    }
    lumps.sort_by_key(|lump| lump.due_ms);
    lumps
}

/// Longest silence of the board.
const PATIENCE: Duration = Duration::from_secs(30);

/// Sentences that follow from pages and epochs, not from the start of the board.
fn of_epochs<'t>(reported: impl Iterator<Item = &'t str>) -> Vec<String> {
    let is_of_start =
        |line: &&str| ["$PRAIV", "$PRAIA", "$PRAIQ", "$PRAIL"].iter().any(|its| line.starts_with(its));
    reported.filter(|line| !is_of_start(line)).map(|line| line.trim_end().to_owned()).collect()
}

/// Gives the lumps to a board at the pace of the sky, and to a module in process at the times of the
/// board's clock, with ticks of a millisecond. Returns what both say, host and board.
fn on_both(
    machine: Machine,
    image: &std::path::Path,
    lumps: &[Lump],
    settings: &[String],
) -> [Vec<String>; 2] {
    let socket = MonitorSocket::open().expect("a socket");
    let emulator =
        Settings { machine, arguments: socket.arguments().expect("an address"), ..Settings::default() };
    let mut board = EmulatedBoard::start_with(image, &emulator).expect("the board starts");
    let mut monitor = socket.accept(image).expect("a monitor");
    board.read_through("$PRAIV", PATIENCE).expect("the board greets");
    for setting in settings {
        board.command(setting).expect("the board takes a command");
        let answers = board.read_through("$PRAIA", PATIENCE).expect("an answer");
        assert!(answers.last().expect("an answer").contains(",OK"), "{answers:?}");
    }
    let settings: Vec<&str> = settings.iter().map(String::as_str).collect();
    let mut host = Module::new(&settings);
    let start_ms = u64::from(monitor.clock_ms().expect("a clock"));
    let (mut ticked_ms, mut heard) = (0, Vec::new());
    for lump in lumps {
        let due_ms = start_ms + lump.due_ms;
        let deadline = Instant::now() + PATIENCE;
        let now_ms = loop {
            let now_ms = u64::from(monitor.clock_ms().expect("a clock"));
            if now_ms >= due_ms {
                break now_ms;
            }
            assert!(Instant::now() < deadline, "the clock of the board does not go on: {now_ms} ms");
            thread::sleep(Duration::from_millis(due_ms - now_ms));
        };
        board.feed(&lump.bytes).expect("the board takes bytes");
        for tick_ms in ticked_ms + 1..=now_ms {
            host.receiver.tick(tick_ms, &mut host.reported);
        }
        ticked_ms = now_ms;
        host.receiver.gnss(&lump.bytes, now_ms, &mut host.reported);
        heard.extend(board.heard());
    }
    // The answer follows all sentences of the last epoch, if the board has read that.
    thread::sleep(Duration::from_secs(1));
    board.command("SELFTEST").expect("the board takes a command");
    heard.extend(
        board.read_through("$PRAIA", PATIENCE).expect("an answer").into_iter().map(String::into_bytes),
    );
    board.stop().expect("the board ran to its end");
    let [host, board] =
        [host.reported, heard.concat()].map(|reported| String::from_utf8(reported).expect("ASCII"));
    [of_epochs(host.lines()), of_epochs(board.lines())]
}

/// Takes the age of the oldest proof, s, out of a sentence, and the checksum, which covers it. The age
/// counts in units of 1.024 s of each clock, and the two clocks differ by the milliseconds that bytes
/// need.
fn without_age(line: &str) -> (String, Option<u32>) {
    let mut fields: Vec<&str> = line.split([',', '*']).collect();
    if fields[0] != "$PRAIO" {
        return (line.to_owned(), None);
    }
    fields.pop();
    let age_s = fields.remove(8).parse().ok();
    (fields.join(","), age_s)
}

/// Returns the time from the arrival of the first page, which begins at `start_s`, to the first epoch
/// with four proved satellites, s.
fn first_four_s(reported: &[String], start_s: u32) -> Option<f64> {
    let is_reached =
        |fields: &Vec<&str>| fields[0] == "$PRAIO" && fields[5].parse::<u32>().is_ok_and(|n| n >= 4);
    let fields = reported.iter().map(|line| line.split(',').collect::<Vec<&str>>()).find(is_reached)?;
    let two = |from: usize| fields[1][from..from + 2].parse::<u32>().expect("two digits");
    let utc_s = 3600 * two(0) + 60 * two(2) + two(4);
    let after_s = (86_400 + utc_s + 18 - start_s % 86_400) % 86_400;
    // The epoch of the time 3 s after the begin of a page comes 3.5 s after it.
    Some(f64::from(after_s) + 0.5 - 2.0)
}

/// Minutes at the pace of the sky.
mod at_length {
    use super::*;

    #[test]
    fn both_boards_prove_four_satellites_within_three_minutes_and_say_the_same_bytes() {
        if !is_installed() {
            return;
        }
        let Some(station) = station() else { return };
        let pages = begin(station, 184);
        let start_s = pages[0].begin_s;
        // UTC at the first page's end, to a few ms of the boards' clocks.
        let utc_s = f64::from(start_s + 2) + 1024.0 * 604_800.0 + 315_964_800.0 - 18.0;
        let settings = [KEY.to_owned(), format!("TRUST,{utc_s:.1},5")];
        let runs = [Machine::Stm32f405, Machine::Mps2An500].map(|machine| {
            let image = image::build_for(machine).expect("the image builds");
            FORMATS.map(|format| (machine, image.clone(), format))
        });
        thread::scope(|scope| {
            let threads: Vec<_> = runs
                .iter()
                .flatten()
                .map(|(machine, image, format)| {
                    let (pages, settings) = (&pages, &settings);
                    let run = move || on_both(*machine, image, &lumps(pages, *format), settings);
                    (machine, format.0, scope.spawn(run))
                })
                .collect();
            for (machine, format, thread) in threads {
                let [host, board] = thread.join().expect("a run");
                let first_s = first_four_s(&board, start_s);
                println!("{machine:?}, {format}: {first_s:?} s, {} sentences", board.len());
                assert!(first_s.is_some_and(|first_s| first_s <= BY_LOOP_S), "{board:#?}");
                assert_eq!(host.len(), board.len(), "{machine:?}, {format}");
                for (host, board) in host.iter().zip(&board) {
                    let ([host, board], [host_s, board_s]) = {
                        let ((host, host_s), (board, board_s)) = (without_age(host), without_age(board));
                        ([host, board], [host_s, board_s].map(|age_s| age_s.map_or(-9, u32::cast_signed)))
                    };
                    assert_eq!(board, host, "{machine:?}, {format}");
                    assert!(host_s.abs_diff(board_s) <= 2, "{machine:?}, {format}: {host_s} and {board_s} s");
                }
            }
        });
    }
}
