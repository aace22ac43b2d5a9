//! Wrong SBF beside a healthy sky: nothing of it changes a verdict or a level, or delays the pin.

use raim::signal::encode::{Frequency, Selection, sbf, ubx};
use raim::signal::pieces::{Kind, pieces};
use raim::signal::sky::raw::Simulation;
use raim_firmware::input::{Event, Input, SelfReport, Suspicion};
use raim_firmware::pin::MemoryPin;
use raim_firmware::receiver::{Boot, Receiver};
use raim_firmware::time::GpsTime;
use rand::rngs::ChaCha8Rng;
use rand::{Rng as _, RngExt as _, SeedableRng as _};

use super::reported;

/// Time of blocks that have none of their own: 2020-06-25, noon.
const NOON: GpsTime = GpsTime { week: 2111, tow_ms: (4 * 86_400 + 43_200) * 1000 };

/// Pause after each burst, in which a receiver would be silent, ms.
const PAUSE_MS: u64 = 600;

/// Returns a sky of GPS and `BeiDou`, one lump of SBF a second.
fn sky(epochs: u32) -> Vec<Vec<u8>> {
    let recording = Simulation::above_xian(3600.0, epochs, 11).record();
    let selection = Selection::new("GC", Frequency::Dual).unwrap();
    let mut encoder = ubx::Encoder::new(&recording.ephemerides, selection, None);
    let lump = |epoch| sbf::of_ubx(&encoder.epoch(epoch).unwrap(), epoch.time);
    recording.epochs.iter().map(lump).collect()
}

/// Returns the ranges in a lump.
fn meas_epoch(lump: &[u8]) -> Vec<u8> {
    pieces(lump).find(|piece| piece.kind == Kind::MEAS_EPOCH).expect("ranges").bytes.to_vec()
}

/// The module in process.
struct Module {
    receiver: Receiver<MemoryPin>,
    now_ms: u64,
}

impl Module {
    fn new() -> Self {
        Self { receiver: Receiver::new(MemoryPin::default(), Boot::on_host("sbf")).unwrap(), now_ms: 0 }
    }

    /// Sends a second's bytes and a pause; returns the verdicts with all levels, as they came with
    /// the bytes and after them, each with the level of the pin.
    fn receive(&mut self, bytes: &[u8]) -> [(Vec<String>, bool); 2] {
        let (mut at_once, mut later) = (Vec::new(), Vec::new());
        self.receiver.gnss(bytes, self.now_ms, &mut at_once);
        let pin = self.receiver.pin().high;
        self.receiver.tick(self.now_ms + PAUSE_MS, &mut later);
        self.now_ms += 1000;
        [(verdicts(&at_once), pin), (verdicts(&later), self.receiver.pin().high)]
    }

    fn counter(&self, name: &str) -> u32 {
        self.receiver.statistics().find(|(counter, _)| *counter == name).expect(name).1
    }
}

fn verdicts(reported: &[u8]) -> Vec<String> {
    let text = String::from_utf8_lossy(reported);
    let is_verdict = |line: &&str| ["$PRAIS", "$GNGNS", "$PRAIX"].iter().any(|name| line.starts_with(name));
    text.lines().filter(is_verdict).map(str::to_owned).collect()
}

/// Sends what `spoil` makes of each healthy lump; asserts that the module says the same as of the
/// healthy ones, at the same moment, and returns the growth of a counter.
fn unharmed(name: &str, counter: &str, mut spoil: impl FnMut(&[u8]) -> Vec<u8>) -> u32 {
    const GOOD: usize = 5;
    let lumps = sky(15);
    let (mut clean, mut spoiled) = (Module::new(), Module::new());
    for lump in &lumps[..GOOD] {
        clean.receive(lump);
        spoiled.receive(lump);
    }
    assert!(clean.receiver.pin().high, "the sky is healthy");
    let before = spoiled.counter(counter);
    for lump in &lumps[GOOD..] {
        let want = clean.receive(lump);
        assert!(!want[0].0.is_empty() && want[0].1, "{name}: the verdict comes with the bytes");
        assert_eq!(spoiled.receive(&spoil(lump)), want, "{name}");
    }
    spoiled.counter(counter) - before
}

/// Returns the block with a change and a correct CRC.
fn changed(block: &[u8], change: impl FnOnce(&mut Vec<u8>)) -> Vec<u8> {
    let mut block = block.to_vec();
    change(&mut block);
    sbf::sealed(block)
}

/// Change of a block.
type Change = Box<dyn Fn(&mut Vec<u8>)>;

#[test]
fn an_epoch_that_contradicts_itself_is_refused_as_a_whole() {
    let set = |at: usize, value: u8| move |block: &mut Vec<u8>| block[at] = value;
    let cases: [(&str, &str, Change); 9] = [
        ("one satellite beyond the block", "messages_malformed", Box::new(|block| block[14] += 1)),
        ("255 satellites", "bytes_skipped", Box::new(set(14, 255))),
        ("sub-blocks of no byte", "messages_malformed", Box::new(set(15, 0))),
        ("sub-blocks of 255 bytes", "bytes_skipped", Box::new(set(15, 255))),
        ("further sub-blocks of no byte", "messages_malformed", Box::new(set(16, 0))),
        ("255 further signals", "messages_malformed", Box::new(set(20 + 19, 255))),
        ("scrambled ranges", "epochs_scrambled", Box::new(|block| block[17] |= 0x80)),
        ("unknown time", "epochs_without_week", Box::new(|block| block[8..12].fill(0xFF))),
        ("unknown week", "epochs_without_week", Box::new(|block| block[12..14].fill(0xFF))),
    ];
    for (name, counter, change) in &cases {
        let spoil = |lump: &[u8]| [changed(&meas_epoch(lump), change), lump.to_vec()].concat();
        assert!(unharmed(name, counter, spoil) >= 10, "{name}");
    }
    let time = |lump: &[u8]| {
        let impossible = |block: &mut Vec<u8>| block[8..12].copy_from_slice(&604_800_000_u32.to_le_bytes());
        [changed(&meas_epoch(lump), impossible), lump.to_vec()].concat()
    };
    assert_eq!(unharmed("a time beyond the week", "times_out_of_range", time), 10);
}

#[test]
fn a_length_that_no_block_has_is_no_frame() {
    for length in [0_u16, 4, 18, 65_532, 4_376] {
        let header = |lump: &[u8]| {
            let mut header = meas_epoch(lump)[..20].to_vec();
            header[6..8].copy_from_slice(&length.to_le_bytes());
            [header, lump.to_vec()].concat()
        };
        assert!(unharmed(&format!("length {length}"), "bytes_skipped", header) >= 200, "{length}");
    }
}

#[test]
fn nonsense_with_a_correct_crc_changes_nothing() {
    const READ: [u16; 19] = [
        4027, 5922, 4109, 4017, 4018, 4020, 4022, 4023, 4026, 4047, 4066, 5891, 4002, 4081, 4004, 4092, 4245,
        4001, 4011,
    ];
    let mut random = ChaCha8Rng::seed_from_u64(1);
    for number in READ {
        let spoil = |lump: &[u8]| {
            let mut bytes = Vec::new();
            for _ in 0..20 {
                let mut body = vec![0; random.random_range(0..160)];
                random.fill_bytes(&mut body);
                // A spoofing flag of nonsense is one of the receiver; here it is left out.
                if let (4092, Some(flags)) = (number, body.get_mut(2)) {
                    *flags &= 0b1111_1100;
                }
                let time = GpsTime { week: random.random(), tow_ms: random.random_range(0..604_800_000) };
                bytes.extend(sbf::block(
                    number,
                    if number == 4027 { GpsTime { tow_ms: u32::MAX, ..time } } else { time },
                    &body,
                ));
            }
            bytes.extend(lump);
            bytes
        };
        unharmed(&format!("{number}"), "frames", spoil);
    }
}

#[test]
fn a_second_epoch_of_one_time_is_left_out() {
    let twice = |lump: &[u8]| [lump, &meas_epoch(lump)].concat();
    assert_eq!(unharmed("twice", "epochs_backwards", twice), 10);
}

#[test]
fn signals_of_another_antenna_are_left_out() {
    // The first satellite once more, as the second antenna would see it: 40 m farther.
    let both = |lump: &[u8]| {
        let with_another = |block: &mut Vec<u8>| {
            let mut first: Vec<u8> = block[20..40].to_vec();
            first[1] |= 1 << 5;
            let range_mm = u32::from_le_bytes(first[4..8].try_into().unwrap()).wrapping_add(40_000);
            first[4..8].copy_from_slice(&range_mm.to_le_bytes());
            first[19] = 0;
            block.splice(20..20, first);
            block[14] += 1;
            let length = (block.len() as u16).to_le_bytes();
            block[6..8].copy_from_slice(&length);
        };
        let others = pieces(lump).filter(|piece| piece.kind != Kind::MEAS_EPOCH);
        let others: Vec<u8> = others.flat_map(|piece| piece.bytes).copied().collect();
        [others, changed(&meas_epoch(lump), with_another)].concat()
    };
    assert_eq!(unharmed("two antennas", "observations_other", both), 10);
}

#[test]
fn text_and_cut_blocks_between_blocks_cost_nothing() {
    let text = |lump: &[u8]| {
        let reported =
            b"$R: setSBFOutput, Stream1, COM1, MeasEpoch, sec1\r\n$GPGGA,,,,,,0,,,,,,,,*66\r\nCOM1>$@$@$$@";
        let blocks = pieces(lump).flat_map(|piece| [&reported[..], piece.bytes].concat());
        blocks.collect::<Vec<u8>>()
    };
    assert!(unharmed("text", "bytes_skipped", text) > 500);
    for at in [3, 9, 15, 21, 200] {
        let cut = |lump: &[u8]| [&meas_epoch(lump)[..at], lump].concat();
        assert!(unharmed(&format!("cut after {at}"), "bytes_skipped", cut) > 0, "{at}");
    }
}

#[test]
fn a_wrong_bit_of_a_navigation_block_makes_no_other_ephemeris() {
    let lump = sky(1).remove(0);
    let want = reported(&lump).0.ephemerides;
    assert!(want.len() > 15);
    let blocks: Vec<Vec<u8>> = pieces(&lump).map(|piece| piece.bytes.to_vec()).collect();
    let mut random = ChaCha8Rng::seed_from_u64(2);
    let mut refused = 0;
    for wrong in 0..blocks.len() - 1 {
        for _ in 0..20 {
            let mut stream = blocks.clone();
            let bit = random.random_range(8 * 20..8 * stream[wrong].len());
            stream[wrong][bit / 8] ^= 1 << (bit % 8);
            stream[wrong] = sbf::sealed(stream[wrong].clone());
            let (have, _) = reported(&stream.concat());
            assert!(have.ephemerides.iter().all(|one| want.contains(one)), "block {wrong}, bit {bit}");
            refused += usize::from(have.ephemerides.len() < want.len());
        }
    }
    assert!(refused > 800, "{refused}");
}

#[test]
fn compressed_ranges_alone_are_named() {
    let at = |second: u32| GpsTime { tow_ms: NOON.tow_ms + 1000 * second, ..NOON };
    let compressed = |second| sbf::block(4109, at(second), &[0; 20]);
    let alone: Vec<u8> = (0..10).flat_map(compressed).collect();
    assert!(reported(&alone).1.meas3_only >= 6);
    let plain = |second| sbf::block(4027, at(second), &[0, 20, 12, 0, 0, 0]);
    let both: Vec<u8> = (0..10).flat_map(|second| [compressed(second), plain(second)].concat()).collect();
    assert_eq!(reported(&both).1.meas3_only, 0);
}

#[test]
fn smoothed_ranges_are_counted_and_used() {
    let lump = sky(1).remove(0);
    let smoothed = changed(&meas_epoch(&lump), |block| block[17] |= 0b10);
    let (reported, counters) = reported(&smoothed);
    assert_eq!((counters.codes_smoothed, reported.epochs.len()), (1, 1));
}

/// Returns the reports of a block with this body.
fn reports(number: u16, body: &[u8]) -> Vec<SelfReport> {
    reported(&sbf::block(number, NOON, body)).0.reports
}

#[test]
fn either_flag_of_rf_status_is_a_certainty_of_the_receiver() {
    for (flags, mode, spoofing, jamming) in [
        (0, 0, Suspicion::None, Suspicion::None),
        (0b01, 1, Suspicion::Sure, Suspicion::Suspected),
        (0b10, 2, Suspicion::Sure, Suspicion::Suspected),
        (0b1111_1100, 8, Suspicion::None, Suspicion::Sure),
    ] {
        let body = [1, 8, flags, 0, 0, 0, 0, 0, 0, 0, 0, 0, mode, 0];
        let [SelfReport::Interference(reported)] = reports(4092, &body)[..] else { panic!("{flags}") };
        assert_eq!((reported.spoofing, reported.jamming), (Some(spoofing), Some(jamming)), "{flags} {mode}");
    }
    assert_eq!(reports(4092, &[255, 8, 3, 0, 0, 0]), []);
    assert_eq!(reports(4092, &[1, 0, 3, 0, 0, 0, 0, 0, 0, 0]), []);
}

#[test]
fn a_satellite_that_takes_part_and_is_not_authentic_is_a_suspicion() {
    let status = |status: u16, active: u64, authentic: u64| {
        let mut body = status.to_le_bytes().to_vec();
        body.extend([0; 4]);
        body.extend(active.to_le_bytes());
        body.extend(authentic.to_le_bytes());
        body.extend([0; 16]);
        reports(4245, &body)
    };
    let says = |signals, spoofing| vec![SelfReport::Authenticity(signals, spoofing)];
    assert_eq!(status(6, 0b1111, 0b1111), says(4, Suspicion::None));
    assert_eq!(status(6, 0b1111, 0b0111), says(3, Suspicion::Suspected));
    assert_eq!(status(6, 0, 0), says(0, Suspicion::Unknown));
    assert_eq!(status(5, 0b1111, 0b0111), says(0, Suspicion::Unknown));
}

#[test]
fn levels_of_an_augmentation_come_before_those_of_an_outlier() {
    let levels =
        |horizontal_m: f32, vertical_m: f32| [horizontal_m.to_le_bytes(), vertical_m.to_le_bytes()].concat();
    let dop = |horizontal_m, vertical_m| {
        sbf::block(4001, NOON, &[&[9; 10][..], &levels(horizontal_m, vertical_m)].concat())
    };
    let raim = |flag| sbf::block(4011, NOON, &[&[flag, 0][..], &levels(7.5, 12.25)].concat());
    let (mut input, mut reported) = (Input::new(), Vec::new());
    let mut receive = |bytes: &[u8], now_ms| {
        reported.clear();
        input.feed(bytes, now_ms, |event| {
            if let Event::SelfReport(SelfReport::Levels(levels)) = event {
                reported.push(levels.map(|levels| (levels.frame, levels.axes_mm)));
            }
        });
        reported.clone()
    };
    assert_eq!(receive(&raim(0), 0), [Some((11, [7500, 7500, 12_250]))]);
    assert_eq!(receive(&raim(1), 0), [None]);
    assert_eq!(receive(&dop(3.5, 5.0), 1000), [Some((10, [3500, 3500, 5000]))]);
    assert_eq!(receive(&raim(0), 1100), []);
    assert_eq!(receive(&raim(0), 4001), [Some((11, [7500, 7500, 12_250]))]);
    for unknown in [-2e10, f32::NAN, f32::INFINITY, 1e9] {
        assert_eq!(receive(&dop(unknown, 5.0), 5000), [None], "{unknown}");
    }
}
