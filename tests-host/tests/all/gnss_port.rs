//! The GNSS port at the rates of receivers: the input is read, and an unknown rate is found.

use raim::signal::encode::{Frequency, Selection, ubx};
use raim::signal::recording::Recording;
use raim::signal::sky::raw::Simulation;
use raim_firmware::bit_rate::{PATIENCE_MS, RATES};
use rig::paced::{Costs, Lines, Outcome, run, search};

/// Slowest clock of the board, Hz, and cost of an epoch, instructions.
const INTERNAL_HZ: u64 = 16_000_000;
const EPOCH: u64 = 1_100_000;
const COSTS: Costs = Costs::measured(INTERNAL_HZ, EPOCH);

const SECONDS: u32 = 20;

fn lines(gnss_baud: u64, rate_hz: u64) -> Lines<'static> {
    Lines { gnss_baud, host_baud: 115_200, period_ns: 1_000_000_000 / rate_hz, flood: &[], host_reads: true }
}

/// Returns a sky of three systems on two bands.
fn sky(epochs: u32) -> Recording {
    Simulation::above_xian(3600.0, epochs, 11).record()
}

/// Returns the bytes of a u-blox receiver at some epochs a second: all ranges of the epoch, and the
/// navigation bits that are due, which take 30 s. The first lump has all orbits.
fn lumps(epochs: u32, rate_hz: u32) -> Vec<Vec<u8>> {
    const FRAME_S: u32 = 30;
    let recording = sky(epochs);
    let selection = Selection::new("GCE", Frequency::Dual).unwrap();
    let mut encoder = ubx::Encoder::new(&recording.ephemerides, selection, None);
    let pages = recording
        .ephemerides
        .iter()
        .flat_map(|ephemeris| frames(&ubx::pages(ephemeris, recording.epochs[0].time).unwrap()));
    let pages: Vec<_> = pages.collect();
    let share = pages.len().div_ceil((FRAME_S * rate_hz) as usize);
    let due = pages.chunks(share).cycle();
    let epochs = recording.epochs.iter().zip(due);
    epochs.map(|(epoch, due)| [due.concat(), encoder.epoch(epoch).unwrap()].concat()).collect()
}

/// Splits a run of good frames.
fn frames(bytes: &[u8]) -> Vec<Vec<u8>> {
    let (mut frames, mut rest) = (Vec::new(), bytes);
    while let [_, _, _, _, low, high, ..] = *rest {
        let (frame, behind) = rest.split_at(8 + usize::from(u16::from_le_bytes([low, high])));
        frames.push(frame.to_vec());
        rest = behind;
    }
    frames
}

/// Checks that nothing was lost, and that every epoch was judged before the next.
fn assert_all_read(have: &Outcome, epochs: usize, case: &str) {
    let names = [
        "gnss_bytes_lost",
        "gnss_bytes_dropped",
        "crc_failures",
        "frames_cut",
        "epochs_broken",
        "epochs_skipped",
        "epochs_late",
        "line_stale",
    ];
    for name in names {
        assert_eq!(have.counter(name), 0, "{case}: {name} of {:?}", have.counters);
    }
    assert_eq!(have.lateness_ns.len(), epochs, "{case}");
}

#[test]
fn every_second_at_38400_and_five_times_a_second_at_115200_lose_nothing() {
    const QUIET: usize = 1;
    for (baud, rate_hz) in [(38_400, 1), (115_200, 5)] {
        let lumps = lumps(1 + SECONDS * rate_hz, rate_hz);
        let bytes: usize = lumps[QUIET..].iter().map(Vec::len).sum();
        let case = format!("{baud} baud, {rate_hz} Hz, {} bytes a second", bytes / SECONDS as usize);
        let have = run(&lumps, QUIET, lines(baud, u64::from(rate_hz)), COSTS);
        println!("{case}: pin {:.1} ms behind the last byte at most", have.latest_ms());
        assert_all_read(&have, lumps.len() - QUIET, &case);
        assert!(bytes as u64 * 10 < baud * u64::from(SECONDS), "{case}: more than the line carries");
    }
}

#[test]
fn every_rate_is_found_within_the_time_that_the_tries_before_it_take() {
    for (tries, baud) in RATES.into_iter().enumerate() {
        // Each earlier rate takes its patience; at a wrong rate a lump may end before that time is
        // over.
        let limit_s = (tries as u64 * (PATIENCE_MS + 1500)).div_ceil(1000);
        let epochs = limit_s as u32 + 8;
        // At 9600 baud a second carries a single system.
        let selection = Selection::new(if baud == 9_600 { "G" } else { "GC" }, Frequency::Single).unwrap();
        let recording = sky(epochs);
        let mut encoder = ubx::Encoder::new(&recording.ephemerides, selection.clone(), None);
        let lumps: Vec<_> = recording
            .epochs
            .iter()
            .map(|epoch| {
                // Orbits are repeated, as a receiver does.
                let mut anew = ubx::Encoder::new(&recording.ephemerides, selection.clone(), None);
                let is_due = epoch.time.tow_ms / 1000 % 4 == 0;
                if is_due { anew.epoch(epoch).unwrap() } else { encoder.epoch(epoch).unwrap() }
            })
            .collect();
        let have = search(&lumps, lines(u64::from(baud), 1), COSTS);
        let found_s = have.rates.last().map_or(0, |(at_ns, _)| at_ns / 1_000_000_000);
        println!("{baud} baud: found after {found_s} s, {} epochs judged", have.lateness_ns.len());
        assert_eq!(have.rates.len(), tries, "{baud}: {:?}", have.rates);
        assert_eq!(have.rates.last().map_or(RATES[0], |(_, rate)| *rate), baud);
        assert!(found_s <= limit_s, "{baud}: {found_s} s");
        assert!(have.counter("epochs") >= 4, "{baud}: {:?}", have.counters);
    }
}

#[test]
fn a_rate_that_a_command_fixes_is_set_at_once() {
    let lumps = lumps(10, 1);
    let command = raim::sentence::command("BAUD,230400");
    // The command comes once, followed by nothing that the module could read.
    let flood = [command.as_bytes(), vec![b' '; 300_000].as_slice()].concat();
    let have = search(&lumps, Lines { flood: &flood, ..lines(230_400, 1) }, COSTS);
    assert_eq!(have.rates.iter().map(|(_, rate)| *rate).collect::<Vec<_>>(), [230_400]);
    assert!(have.counter("epochs") >= 8, "{:?}", have.counters);
}
