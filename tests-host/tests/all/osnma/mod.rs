//! OSNMA of recordings and official vectors, from the bytes of a receiver on: what is proved, what follows.
//!
//! The counts of right tags are those of an independent program, but for the begin of a recording: this
//! module keeps no tag from before its root key, and uses the messages of the subframe before that.

mod first_proofs;
mod outputs;
mod recorded;
mod second;
mod slices;
mod trusted;

use std::io::Read as _;

use flate2::read::MultiGzDecoder;
use raim::sentence;
use raim::signal::checksum::{crc24q, fletcher};
use raim::signal::encode::{Encoder, Frequency, Selection, sbf};
use raim::signal::sky::raw::Simulation;
use raim_firmware::osnma::{Keys, Osnma, State, Summary, Verdict, Worked};
use raim_firmware::pin::MemoryPin;
use raim_firmware::receiver::{Boot, Receiver};
use raim_firmware::time::GpsTime;
use rig::shared;

/// Keys of the recordings and of the vectors, by number and point.
const KEY_2025: (u8, &str) = (1, "0397EB43789AA0F6D052A638468ECF5278E6F6DF8465ECB8D8B84B8C7A3501F73B");
const KEY_2: (u8, &str) = (2, "0303B2CE64BC207BDD8BC4DF859187FCB686320D63FFA091410FC158FBB77980EA");
const KEY_7: (u8, &str) = (7, "02B48E874150D3029877757838A62D73380DA65BC8435C9653A4973C1DDC2978D9");
const KEY_1: (u8, &str) = (1, "02C15C5751082E525E02F39CE3C58827497C559EA2DBEE16480FA1ED775FAD65EA");

/// Roots of the trees of the vectors.
const TREE_2: &str = "A10C440F3AA62453526DB4AF76DF8D9410D35D8277397D7053C700D192702B0D";
const TREE_3: &str = "259B5243FEA8338253C28A05D8BD5DB04180C3F59A3027E391BF2B6E1AC3509B";

fn bytes_of<const N: usize>(text: &str) -> [u8; N] {
    let byte = |index: usize| u8::from_str_radix(&text[2 * index..2 * index + 2], 16).expect("digits");
    std::array::from_fn(byte)
}

/// A page as it was received: 15 bytes of the even part, 15 of the odd one.
#[derive(Clone, Copy)]
struct Page {
    satellite: u8,
    is_e1: bool,
    /// Second of Galileo system time at which it began.
    begin_s: u32,
    bytes: [u8; 30],
}

impl Page {
    fn bits(&self, start: usize, count: usize) -> u128 {
        (start..start + count)
            .fold(0, |value, bit| value << 1 | u128::from(self.bytes[bit / 8] >> (7 - bit % 8) & 1))
    }

    fn word(&self) -> [u8; 16] {
        (self.bits(2, 112) << 16 | self.bits(122, 16)).to_be_bytes()
    }

    fn authentication(&self) -> [u8; 5] {
        let bits = self.bits(138, 40).to_be_bytes();
        *bits.last_chunk().expect("5 bytes")
    }

    /// Returns `RXM-SFRBX`.
    fn message(&self) -> Vec<u8> {
        let mut payload = vec![2, self.satellite, if self.is_e1 { 1 } else { 5 }, 0, 8, 0, 2, 0];
        for half in self.bytes.chunks(15) {
            let mut padded = half.to_vec();
            padded.push(0);
            payload.extend(padded.chunks(4).flat_map(|word| word.iter().rev().copied().collect::<Vec<_>>()));
        }
        ubx(0x13, &payload)
    }

    /// Returns `GALRawINAV`, with the time at which the page was complete.
    fn block(&self) -> Vec<u8> {
        sbf::of_ubx(&self.message(), gps_time(self.begin_s + 2))
    }

    /// Turns a bit of the word, and makes the check good.
    fn turned(mut self, bit: usize) -> Self {
        let place = if bit < 112 { bit + 2 } else { bit - 112 + 122 };
        self.bytes[place / 8] ^= 0x80 >> (place % 8);
        let covered = self.bits(0, 114);
        let odd = self.bits(120, 82);
        // Four zeros, 114 and 82 bits: 200 bits, which 128 do not hold.
        let mut bits: Vec<bool> = vec![false; 4];
        bits.extend((0..114).rev().map(|bit| covered >> bit & 1 == 1));
        bits.extend((0..82).rev().map(|bit| odd >> bit & 1 == 1));
        let bytes: Vec<u8> = bits
            .chunks(8)
            .map(|byte| byte.iter().fold(0, |value, bit| value << 1 | u8::from(*bit)))
            .collect();
        let check = crc24q(&bytes);
        for (index, bit) in
            check.iter().flat_map(|byte| (0..8).rev().map(move |bit| byte >> bit & 1)).enumerate()
        {
            let place = 120 + 82 + index;
            let mask = 0x80 >> (place % 8);
            self.bytes[place / 8] = self.bytes[place / 8] & !mask | if bit == 1 { mask } else { 0 };
        }
        self
    }
}

/// Returns a second of Galileo system time as GPS time, which began 1024 weeks before.
fn gps_time(gst_s: u32) -> GpsTime {
    GpsTime { week: (gst_s / 604_800 + 1024) as u16, tow_ms: gst_s % 604_800 * 1000 }
}

fn ubx(id: u8, payload: &[u8]) -> Vec<u8> {
    let mut body = vec![2, id];
    body.extend((payload.len() as u16).to_le_bytes());
    body.extend(payload);
    let check = fletcher(&body);
    [&[0xB5, 0x62][..], &body, &check].concat()
}

fn text_of(name: &str) -> Option<String> {
    let path = shared::path_or_skip(&format!("data/osnma/{name}"))?;
    let mut text = String::new();
    MultiGzDecoder::new(std::fs::File::open(path).expect("a file")).read_to_string(&mut text).expect("text");
    Some(text)
}

/// Returns the pages of an official vector.
fn vector(name: &str) -> Option<Vec<Page>> {
    let text = text_of(&format!("vector_{name}.csv.gz"))?;
    let page = |line: &str| {
        let fields: Vec<&str> = line.trim().split(',').collect();
        let (tow, week): (u32, u32) =
            (fields[0].parse().expect("a number"), fields[1].parse().expect("a number"));
        Page {
            satellite: fields[2].parse().expect("a number"),
            is_e1: true,
            begin_s: week * 604_800 + tow,
            bytes: bytes_of(fields[3]),
        }
    };
    Some(text.lines().map(page).collect())
}

/// Returns the pages of an hour of a station, with their arrival at its end.
fn station() -> Option<Vec<Page>> {
    let text = text_of("046r_galinav.txt.gz")?;
    let page = |line: &str| {
        let fields: Vec<&str> = line.split_whitespace().collect();
        let (week, tow): (u32, u32) =
            (fields[0].parse().expect("a number"), fields[1].parse().expect("a number"));
        Page {
            satellite: fields[2].parse().expect("a number"),
            is_e1: fields[3] == "0",
            begin_s: (week - 1024) * 604_800 + tow - 2,
            bytes: bytes_of(fields[5]),
        }
    };
    Some(text.lines().map(page).collect())
}

fn keys((number, point): (u8, &str), root: Option<&str>) -> Keys {
    Keys { key: Some((number, bytes_of(point))), root: root.map(bytes_of) }
}

/// What was found in a vector.
struct Found {
    summary: Summary,
    /// Each state once, in its order.
    states: Vec<State>,
    counts: Vec<(&'static str, u32)>,
    first_four_s: Option<u32>,
    was_false: bool,
}

impl Found {
    fn count(&self, name: &str) -> u32 {
        self.counts.iter().find(|(its, _)| *its == name).expect("a counter").1
    }

    /// Returns the right tags of ADKD 0, 4 and 12.
    fn right(&self) -> [u32; 3] {
        ["osnma_orbits_right", "osnma_times_right", "osnma_slow_right"].map(|name| self.count(name))
    }
}

/// Room for the satellites of the whole world, which the vectors have.
type Large = Osnma<36, 80, 320>;

fn found<const S: usize, const R: usize, const L: usize>(
    osnma: &mut Osnma<S, R, L>,
    keys: &Keys,
    pages: &[Page],
) -> Found {
    let (mut states, mut first_four_s, mut was_false, mut now_ms) = (Vec::new(), None, false, 0);
    let first_s = pages.first().expect("a page").begin_s;
    for page in pages {
        now_ms = u64::from(page.begin_s - first_s + 2) * 1000;
        osnma.receive(page.satellite, &page.word(), page.authentication(), page.is_e1, now_ms);
        while osnma.work(keys, now_ms) != Worked::Nothing {}
        let summary = osnma.summary(keys, now_ms);
        if states.last() != Some(&summary.state) {
            states.push(summary.state);
        }
        if summary.proved >= 4 && first_four_s.is_none() {
            first_four_s = Some(page.begin_s + 2 - first_s);
        }
        was_false |= summary.false_ > 0 || summary.is_alarm;
    }
    let summary = osnma.summary(keys, now_ms);
    Found { summary, states, counts: osnma.tally().iter().collect(), first_four_s, was_false }
}

/// Checks that nothing was wrong, with the room of the largest image and with more.
fn all_right(keys: &Keys, pages: &[Page]) -> Found {
    let image = found(&mut Box::new(raim_firmware::osnma::Authentication::new()), keys, pages);
    let large = found(&mut Box::new(Large::new()), keys, pages);
    for found in [&image, &large] {
        let wrong: u32 =
            found.counts.iter().filter(|(name, _)| name.ends_with("_wrong")).map(|(_, count)| count).sum();
        assert_eq!((wrong, found.was_false), (0, false), "{:?}", found.counts);
    }
    assert_eq!(image.states, large.states);
    println!("{:?}, first four {:?} s, {:?}", large.right(), large.first_four_s, large.states);
    large
}

/// Vectors, which take seconds.
mod at_length {
    use super::*;

    #[test]
    fn a_station_and_the_second_configuration_have_the_tags_of_another_program() {
        let (Some(station), Some(vector)) = (station(), vector("configuration_2")) else { return };
        let have = all_right(&keys(KEY_2025, None), &station);
        // The other program: 1678, 267, 662, and 538 sequences.
        assert_eq!((have.right(), have.count("osnma_sequences_right")), ([1681, 267, 654], 539));
        let have = all_right(&keys(KEY_2, Some(TREE_2)), &vector);
        // 7080, 884, 2618 and 1770; sixteen satellites more at the begin, and no tag of before.
        assert_eq!((have.right(), have.count("osnma_sequences_right")), ([7144, 896, 2423], 1786));
    }

    #[test]
    fn every_vector_ends_as_its_name_says() {
        use State::{DontUse, Running, Stopped, Waiting};
        for (name, key, tree, states, ends, proved) in [
            // The chain in force is followed until the next begins.
            ("eoc_step1", KEY_7, TREE_2, &[Waiting, Running][..], Some((7, 3)), 20..27),
            // Both root keys are sent, the next of a time to come; it is in force after half an hour.
            ("eoc_step2", KEY_7, TREE_2, &[Waiting, Running], Some((7, 0)), 20..27),
            ("crev_step1", KEY_7, TREE_2, &[Waiting, Running, DontUse], Some((7, 0)), 0..1),
            ("npk_step1", KEY_7, TREE_2, &[Waiting, Running], Some((7, 1)), 20..27),
            // The root key is signed by the new key, which the tree has proved.
            ("npk_step2", KEY_7, TREE_2, &[Waiting, Running], Some((8, 1)), 20..27),
            ("oam_step1", KEY_1, TREE_3, &[Waiting, Running, Stopped], None, 0..1),
            ("oam_step2", KEY_1, TREE_3, &[Waiting, Stopped], None, 0..1),
        ] {
            let Some(pages) = vector(name) else { return };
            println!("{name}");
            let have = all_right(&keys(key, Some(tree)), &pages);
            assert_eq!(have.states, states, "{name}");
            assert_eq!(have.summary.key_and_chain, ends, "{name}");
            assert!(proved.contains(&have.summary.proved), "{name}: {:?}", have.summary);
            assert!(name == "oam_step2" || have.right().iter().all(|count| *count > 500), "{name}");
        }
        // Without the root of the tree the new key is not known.
        let Some(pages) = vector("npk_step2") else { return };
        let have = all_right(&keys(KEY_7, None), &pages);
        assert_eq!(have.summary.key_and_chain, Some((7, 1)));
    }
}

/// A module that hears pages as `RXM-SFRBX` and epochs as `RXM-RAWX`.
struct Module {
    receiver: Receiver<MemoryPin>,
    reported: Vec<u8>,
}

impl Module {
    fn new(settings: &[&str]) -> Self {
        let receiver = Receiver::new(MemoryPin::default(), Boot::on_host("osnma")).expect("a receiver");
        let mut module = Self { receiver, reported: Vec::new() };
        for setting in settings {
            module.obey(setting);
        }
        module
    }

    fn obey(&mut self, text: &str) {
        let mut reported = Vec::new();
        self.receiver.command(sentence::command(text).as_bytes(), &mut reported);
        let reported = String::from_utf8(reported).expect("ASCII");
        assert!(reported.contains(",OK"), "{reported}");
    }

    fn counter(&self, name: &str) -> u32 {
        let mut counters = self.receiver.statistics();
        counters.find_map(|(counter, count)| (counter == name).then_some(count)).expect("a counter")
    }

    /// Hears pages as they come, with ticks of this distance; returns the time to four proved
    /// satellites, s.
    fn receive(&mut self, pages: &[Page], start_s: u32, tick_ms: u64) -> Option<f64> {
        self.hear_as(pages, start_s, tick_ms, Page::message)
    }

    /// Works like [`Self::receive`], in the receiver's format that `written` makes of a page.
    fn hear_as(
        &mut self,
        pages: &[Page],
        start_s: u32,
        tick_ms: u64,
        written: fn(&Page) -> Vec<u8>,
    ) -> Option<f64> {
        let mut now_ms = 0;
        let mut first = None;
        for page in pages {
            let came_ms = u64::from(page.begin_s + 2 - start_s) * 1000;
            while now_ms < came_ms {
                now_ms = (now_ms + tick_ms).min(came_ms);
                self.receiver.tick(now_ms, &mut self.reported);
                let proved = self.receiver.authentication().map_or(0, |summary| summary.proved);
                if proved >= 4 && first.is_none() {
                    first = Some((now_ms as f64 - 2000.0) * 1e-3);
                }
            }
            self.receiver.gnss(&written(page), came_ms, &mut self.reported);
        }
        first
    }

    /// Hears an epoch with a range to each satellite, and returns what the module says.
    fn epoch(&mut self, satellites: &[u8], gst_s: u32, now_ms: u64) -> String {
        self.reported.clear();
        self.receiver.gnss(&ranges(satellites, gst_s), now_ms, &mut self.reported);
        String::from_utf8(self.reported.clone()).expect("ASCII")
    }
}

/// Returns `RXM-RAWX` with a range to each satellite.
fn ranges(satellites: &[u8], gst_s: u32) -> Vec<u8> {
    ranges_at(satellites, f64::from(gst_s), 18)
}

/// Returns the same at a part of a second, with the receiver's GPS time minus UTC.
fn ranges_at(satellites: &[u8], gst_s: f64, leap_s: u8) -> Vec<u8> {
    let week = (gst_s / 604_800.0).floor();
    let mut payload = Vec::new();
    payload.extend((gst_s - 604_800.0 * week).to_le_bytes());
    payload.extend((week as u16 + 1024).to_le_bytes());
    payload.extend([leap_s, satellites.len() as u8, 1, 1, 0, 0]);
    // Equal ranges are those of an epoch that comes again.
    let range_m = 2.4e7 + gst_s % 600.0;
    for satellite in satellites {
        payload.extend(range_m.to_le_bytes());
        payload.extend([0; 8]);
        payload.extend(0_f32.to_le_bytes());
        payload.extend([2, *satellite, 0, 0, 0, 0, 45, 5, 0, 0, 1, 0]);
    }
    ubx(0x15, &payload)
}

const KEY: &str = "KEY,1,0397EB43789AA0F6D052A638468ECF5278E6F6DF8465ECB8D8B84B8C7A3501F73B";

/// A bit of one satellite is turned in all its pages, with the check made good. What follows depends
/// on the setting.
#[test]
fn a_false_ephemeris_is_said_or_left_out_as_the_setting_demands() {
    let Some(pages) = station() else { return };
    let start_s = pages[0].begin_s;
    let some = || pages.iter().copied().filter(|page| page.begin_s < start_s + 400);
    let mut counts = std::collections::BTreeMap::<u8, u32>::new();
    some().for_each(|page| *counts.entry(page.satellite).or_default() += 1);
    let satellites: Vec<u8> = counts.keys().copied().collect();
    // The one that is proved first without the lie.
    let mut genuine = Module::new(&[KEY]);
    genuine.receive(&some().collect::<Vec<_>>(), start_s, 100);
    let proved = genuine.receiver.authentication().expect("a summary").proved;
    assert!(proved >= 4);
    let forged = [2, 7, 8, 13, 19, 26, 27, 29, 30, 33]
        .into_iter()
        .find(|satellite| counts.get(satellite).is_some_and(|count| *count > 300))
        .expect("a satellite in view");
    let lie = |page: Page| {
        let is_its = page.satellite == forged && page.word()[0] >> 2 == 2;
        if is_its { page.turned(60) } else { page }
    };
    let lied: Vec<Page> = some().map(lie).collect();
    let (end_s, end_ms) = (start_s + 402, 402_000);
    let trust = format!("TRUST,{},5", f64::from(end_s) + 1024.0 * 604_800.0 + 315_964_800.0 - 18.0);
    for (settings, trusted, want_left_out) in [
        (&[KEY][..], false, 0),
        (&[KEY, "AUTH,PREFER"], false, 1),
        (&[KEY, "AUTH,OFF"], false, 0),
        (&[KEY, "AUTH,ONLY"], true, u32::MAX),
        (&[KEY, "AUTH,ONLY"], false, u32::MAX),
    ] {
        let mut module = Module::new(settings);
        module.receive(&lied, start_s, 100);
        module.receiver.tick(end_ms, &mut Vec::new());
        if trusted {
            module.obey(&trust);
        }
        let reported = module.epoch(&satellites, end_s, end_ms);
        let left_out = module.counter("ephemeris_unproved");
        let line = reported.lines().find(|line| line.starts_with("$PRAIO"));
        println!("{settings:?} trusted {trusted}: {left_out} left out, {line:?}");
        if settings.contains(&"AUTH,OFF") {
            assert_eq!((left_out, line), (0, None));
            continue;
        }
        let fields: Vec<&str> = line.expect("a sentence").split([',', '*']).collect();
        let have: Vec<u8> = fields[5..8].iter().map(|field| field.parse().expect("a number")).collect();
        assert_eq!((fields[2], fields[3]), (if trusted { "DATED" } else { "UNDATED" }, "1"));
        assert_eq!((have[0], have[2]), (proved - 1, 1), "{line:?}");
        match want_left_out {
            // Only with the time trusted a tag is proof.
            u32::MAX if trusted => assert!(left_out >= 1 && left_out < satellites.len() as u32),
            u32::MAX => assert!(left_out > 4),
            want => assert_eq!(left_out, want),
        }
        let is_unproved = reported.contains(",UNPROVED,");
        assert!(!is_unproved || settings.contains(&"AUTH,ONLY"));
    }
}

/// A sky of 40 s ago is one in the first epoch, without a key, and with any system.
#[test]
fn a_sky_of_another_time_is_a_replay_in_its_first_epoch() {
    let simulation = Simulation::above_xian(3600.0, 12, 1);
    let recording = simulation.record();
    let mut encoder =
        Encoder::new(&recording.ephemerides, Selection::new("GC", Frequency::Dual).expect("systems"));
    let epochs: Vec<_> =
        recording.epochs.iter().map(|epoch| encoder.epoch(epoch).expect("an epoch")).collect();
    let time = recording.epochs[0].time;
    let utc_s = time.to_ms() as f64 * 1e-3 + 315_964_800.0 - 18.0;
    for (late_s, bound_s, want) in [(0.0, 5, false), (40.0, 5, true), (-40.0, 5, true), (40.0, 60, false)] {
        let mut module = Module::new(&[&format!("WEEK,{}", time.week)]);
        module.obey(&format!("TRUST,{:.1},{bound_s}", utc_s + late_s));
        let mut reported = Vec::new();
        for (index, bytes) in epochs.iter().enumerate() {
            module.receiver.gnss(bytes, 1000 * index as u64, &mut reported);
            module.receiver.tick(1000 * index as u64 + 600, &mut reported);
        }
        let reported = String::from_utf8(reported).expect("ASCII");
        let replays = reported.lines().filter(|line| line.contains(",A,REPLAY,")).count();
        let states = reported.lines().filter(|line| line.starts_with("$PRAIS")).count();
        println!("{late_s} s late, bound {bound_s} s: {replays} of {states}");
        assert_eq!(replays, if want { states } else { 0 }, "{reported}");
        assert_eq!(module.receiver.pin().high, !want);
    }
}

/// Verdicts are never of a satellite's former words.
#[test]
fn no_seal_outlives_the_words_that_it_is_of() {
    let Some(pages) = station() else { return };
    let mut osnma = Box::new(Large::new());
    let keys = keys(KEY_2025, None);
    let start_s = pages[0].begin_s;
    let mut versions = 0;
    for page in &pages {
        let now_ms = u64::from(page.begin_s - start_s + 2) * 1000;
        let before = osnma.seal_of(page.satellite);
        osnma.receive(page.satellite, &page.word(), page.authentication(), page.is_e1, now_ms);
        let seal = osnma.seal_of(page.satellite);
        if seal.version != before.version {
            versions += 1;
            assert_eq!(seal.verdict, Verdict::Unproved);
        }
        while osnma.work(&keys, now_ms) != Worked::Nothing {}
    }
    assert!(versions > 20, "{versions} changes of words");
}
