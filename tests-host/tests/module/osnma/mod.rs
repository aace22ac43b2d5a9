//! OSNMA by a sky that a key of our own signs: what is proved, what is false, and what one satellite
//! that lies can do.

mod bad_input;
mod phases;

use proptest::prelude::*;
use raim::signal::osnma::{Page, Phase, ROOT, Secret, System};
use raim_firmware::osnma::{Keys, Osnma, State, Summary, Verdict, Worked};

/// First subframe of every test, an even one, some time behind the root key.
const START: u32 = ROOT + 41;

/// The authentication, and the keys that it has.
struct Bench {
    osnma: Box<Osnma<36, 16, 72>>,
    keys: Keys,
    now_ms: u64,
}

impl Bench {
    fn new(point: [u8; 33]) -> Self {
        Self { osnma: Box::new(Osnma::new()), keys: Keys { key: Some((1, point)), root: None }, now_ms: 0 }
    }

    /// Takes a page when it is complete, and does all the work.
    fn receive(&mut self, page: &Page) {
        self.now_ms = u64::from(page.begin_s - 30 * ROOT + 2) * 1000;
        self.osnma.receive(page.satellite, &page.word, page.bits, true, self.now_ms);
        while self.osnma.work(&self.keys, self.now_ms) != Worked::Nothing {}
    }

    fn hear_all(&mut self, pages: &[Page]) {
        for page in pages {
            self.receive(page);
        }
    }

    /// Takes pages; returns the time from the first to the end of the page with which `when` is true,
    /// s.
    fn until(&mut self, pages: &[Page], when: impl Fn(&Self) -> bool) -> Option<u32> {
        let first = pages.first()?.begin_s;
        pages.iter().find_map(|page| {
            self.receive(page);
            when(self).then_some(page.begin_s + 2 - first)
        })
    }

    fn summary(&self) -> Summary {
        self.osnma.summary(&self.keys, self.now_ms)
    }

    fn verdict(&self, satellite: u8) -> Verdict {
        self.osnma.seal_of(satellite).verdict
    }

    fn count(&self, name: &str) -> u32 {
        self.osnma.tally().iter().find(|(its, _)| *its == name).expect("a counter").1
    }

    /// Returns the number of everything that was wrong.
    fn wrong(&self) -> u32 {
        self.osnma.tally().iter().filter(|(name, _)| name.ends_with("_wrong")).map(|(_, count)| count).sum()
    }
}

/// Returns the time to the first proof of four satellites, s.
fn first_four(bench: &mut Bench, pages: &[Page]) -> Option<u32> {
    bench.until(pages, |bench| bench.summary().proved >= 4)
}

#[test]
fn a_signed_sky_is_proved_and_nothing_in_it_is_wrong() {
    let system = System::new(1);
    let mut bench = Bench::new(system.public());
    assert_eq!(bench.summary().state, State::Waiting);
    let pages = system.pages(START..START + 45);
    // A subframe until the time is known, two for the blocks of the root key, one for the keys of the
    // tags.
    assert!(first_four(&mut bench, &pages) <= Some(120));
    bench.hear_all(&pages);
    assert_eq!(bench.wrong(), 0);
    assert_eq!(bench.summary().state, State::Running);
    assert_eq!((bench.summary().proved, bench.summary().key_and_chain), (6, Some((1, 0))));
    // The words change every twenty subframes, and tags with a later key follow eleven behind.
    let mut bench = Bench::new(system.public());
    let all_later = |bench: &Bench| {
        system.satellites.iter().all(|satellite| bench.verdict(*satellite) == Verdict::ProvedLater)
    };
    assert!(bench.until(&pages, all_later).is_some());
    assert_eq!(bench.wrong(), 0);
    bench.hear_all(&pages);
    let counts = ["osnma_orbits_right", "osnma_times_right", "osnma_slow_right", "osnma_sequences_right"];
    assert!(counts.iter().all(|name| bench.count(name) > 80), "{:?}", bench.osnma.tally());
}

/// Whatever bit of orbit and clock is changed in all pages of a satellite, with its check made good.
#[test]
fn one_bit_that_was_changed_is_false_within_a_minute_of_its_subframe() {
    let system = System::new(2);
    let genuine = system.pages(START..START + 12);
    for (word, bit) in [(1, 40), (2, 6 + 10), (3, 127), (4, 125), (5, 72)] {
        let mut bench = Bench::new(system.public());
        let mut pages = genuine.clone();
        let is_its = |page: &&mut Page| page.satellite == 11 && page.word[0] >> 2 == word;
        for page in pages.iter_mut().filter(is_its) {
            page.word[bit / 8] ^= 0x80 >> (bit % 8);
        }
        let (before, behind) = pages.split_at(15 * 6 * 4);
        bench.hear_all(before);
        // The subframe that the tags are about, theirs, and that of the key.
        let is_false = |bench: &Bench| bench.verdict(11) == Verdict::False;
        assert!(is_false(&bench) || bench.until(behind, is_false) <= Some(60), "word {word}");
        bench.hear_all(behind);
        assert!(is_false(&bench), "word {word}");
        let others = system.satellites.iter().filter(|satellite| **satellite != 11);
        assert!(others.into_iter().all(|satellite| bench.verdict(*satellite).is_proved()), "word {word}");
        assert!(!bench.summary().is_alarm, "one satellite is no alarm");
    }
}

#[test]
fn two_satellites_with_false_words_are_an_alarm_and_true_words_end_it() {
    let system = System::new(3);
    let mut bench = Bench::new(system.public());
    let mut pages = system.pages(START..START + 32);
    let (forged, _) = pages.split_at_mut(15 * 6 * 12);
    for page in forged.iter_mut().filter(|page| page.satellite < 10 && page.word[0] >> 2 == 2) {
        page.word[5] ^= 1;
    }
    assert!(bench.until(&pages[..15 * 6 * 12], |bench| bench.summary().is_alarm).is_some());
    assert_eq!(bench.summary().false_, 2);
    bench.hear_all(&pages[15 * 6 * 12..]);
    assert_eq!((bench.summary().false_, bench.summary().proved), (0, 6));
    assert!(!bench.summary().is_alarm);
}

/// A satellite that was false is not believed with other words before they are proved.
#[test]
fn a_false_satellite_stays_false_with_every_new_set_until_one_is_proved() {
    let system = System::new(4);
    let mut bench = Bench::new(system.public());
    let mut pages = system.pages(START..START + 30);
    for page in pages.iter_mut().filter(|page| page.satellite == 24 && page.word[0] >> 2 == 2) {
        page.word[7] ^= (page.begin_s / 30 % 200) as u8 | 1;
    }
    bench.until(&pages, |bench| bench.verdict(24) == Verdict::False).expect("false words");
    for page in &pages[15 * 6 * 8..] {
        bench.receive(page);
        assert_eq!(bench.verdict(24), Verdict::False, "at {} s", page.begin_s);
    }
}

/// Returns the pages of a system whose first satellite sends another system's blocks and keys.
fn with_a_liar(system: &System, other: &System, id: u8) -> Vec<Page> {
    let mut pages = system.pages(START..START + 12);
    let theirs = other.pages(START..START + 12);
    for (page, lie) in pages.iter_mut().zip(&theirs).filter(|(page, _)| page.satellite == 2) {
        page.bits[0] = lie.bits[0];
        if page.begin_s % 30 == 3 {
            page.bits[0] = id << 4 | lie.bits[0] & 15;
        }
    }
    pages
}

#[test]
fn poisoned_blocks_and_a_forged_root_key_cost_no_minute() {
    let (system, mut other) = (System::new(5), System::of(Secret::of(b"attacker"), 6));
    let mut bench = Bench::new(system.public());
    let want_s = first_four(&mut bench, &system.pages(START..START + 12)).expect("four satellites");
    // A root key of another signer, whose message is whole: under a number of its own, and under that
    // of the true one.
    for id in [1, 7] {
        let mut bench = Bench::new(system.public());
        let have_s = first_four(&mut bench, &with_a_liar(&system, &other, id));
        assert!(have_s.is_some_and(|have_s| have_s <= want_s + 60), "{have_s:?} s, message {id}");
        assert_eq!((bench.count("osnma_roots_right"), bench.summary().is_alarm), (1, false));
    }
    // Blocks without sense, others in each subframe.
    let mut pages = system.pages(START..START + 12);
    for page in pages.iter_mut().filter(|page| page.satellite == 2 && page.begin_s % 30 > 3) {
        page.bits[0] ^= (page.begin_s % 251) as u8;
    }
    let mut bench = Bench::new(system.public());
    let have_s = first_four(&mut bench, &pages);
    assert!(have_s.is_some_and(|have_s| have_s <= want_s + 60), "{have_s:?} s");
    assert_eq!(bench.wrong(), 0, "a combination without sense costs no signature");
    // A sky that another key has signed is not believed at all.
    other.satellites.truncate(4);
    let mut bench = Bench::new(system.public());
    assert_eq!(first_four(&mut bench, &other.pages(START..START + 12)), None);
    assert_eq!((bench.count("osnma_roots_wrong"), bench.summary().state), (1, State::Waiting));
}

#[test]
fn keys_that_are_not_those_of_the_sky_prove_nothing() {
    let system = System::new(7);
    let pages = system.pages(START..START + 6);
    let mut bench = Bench::new(system.public());
    bench.keys.key = Some((2, system.public()));
    assert_eq!(first_four(&mut bench, &pages), None);
    assert_eq!(bench.summary().state, State::OtherKey);
    // No point of the curve, the opposite point, no form, and no key.
    let mut no_point = system.public();
    no_point[32] ^= 1;
    let mut opposite = system.public();
    opposite[0] ^= 1;
    for key in [no_point, opposite, [0; 33], [0xFF; 33]] {
        let mut bench = Bench::new(key);
        assert_eq!(first_four(&mut bench, &pages), None);
        assert_eq!(bench.count("osnma_roots_right"), 0);
    }
    let mut bench = Bench::new([0; 33]);
    bench.keys = Keys::NONE;
    assert_eq!(first_four(&mut bench, &pages), None);
    assert_eq!(bench.summary().state, State::NoKey);
}

#[test]
fn keys_of_another_chain_are_an_alarm_from_two_satellites_and_none_from_one() {
    let (system, other) = (System::new(8), System::new(9));
    for (liars, want) in [(1, false), (2, true)] {
        let mut bench = Bench::new(system.public());
        let mut pages = system.pages(START..START + 12);
        let theirs = other.pages(START..START + 12);
        let lying = &system.satellites[..liars];
        for (page, lie) in pages.iter_mut().zip(&theirs).filter(|(page, _)| lying.contains(&page.satellite)) {
            page.bits[1..].copy_from_slice(&lie.bits[1..]);
        }
        bench.hear_all(&pages);
        assert_eq!(bench.summary().is_alarm, want, "{liars} satellites");
        assert!(bench.count("osnma_keys_wrong") > 0 && bench.summary().proved == 6);
        assert_eq!((bench.summary().false_, bench.count("osnma_orbits_wrong")), (0, 0));
    }
}

#[test]
fn a_header_that_forbids_use_ends_the_checks() {
    let mut system = System::new(10);
    let mut bench = Bench::new(system.public());
    bench.hear_all(&system.pages(START..START + 6));
    assert_eq!((bench.summary().state, bench.summary().proved), (State::Running, 6));
    // The chain is revoked.
    system.then(START + 6, |phase| phase.header = 0b1100_0110);
    bench.hear_all(&system.pages(START + 6..START + 12));
    assert_eq!((bench.summary().state, bench.summary().proved), (State::DontUse, 0));
    // The alert of the system.
    system.then(START + 12, |phase| phase.header = 0b1100_1110);
    bench.hear_all(&system.pages(START + 12..START + 18));
    assert_eq!(bench.summary().state, State::Stopped);
}

/// A header that one satellite changes is not that of the root key.
#[test]
fn a_changed_header_is_not_believed() {
    let system = System::new(11);
    let mut bench = Bench::new(system.public());
    let mut pages = system.pages(START..START + 12);
    for page in pages.iter_mut().filter(|page| page.satellite == 2 && page.begin_s % 30 == 1) {
        page.bits[0] = 0b1100_0110;
    }
    assert!(first_four(&mut bench, &pages) <= Some(180));
    bench.hear_all(&pages);
    assert_eq!((bench.summary().state, bench.wrong()), (State::Running, 0));
}

#[test]
fn lost_pages_lose_tags_and_make_nothing_wrong() {
    let system = System::new(12);
    let pages = system.pages(START..START + 40);
    for every in [3, 7, 50, 91] {
        let mut bench = Bench::new(system.public());
        for (_, page) in pages.iter().enumerate().filter(|(index, _)| index % every != 0) {
            bench.receive(page);
        }
        assert_eq!((bench.wrong(), bench.summary().false_), (0, 0), "every {every}th page lost");
    }
    // A page of zeros in a subframe.
    let mut bench = Bench::new(system.public());
    let mut zeros = pages.clone();
    zeros.iter_mut().filter(|page| page.begin_s % 210 == 57).for_each(|page| page.bits = [0; 5]);
    bench.hear_all(&zeros);
    assert_eq!((bench.wrong(), bench.summary().proved), (0, 6));
    // Every page twice.
    let mut bench = Bench::new(system.public());
    for page in &pages {
        bench.receive(page);
        bench.receive(page);
    }
    assert_eq!((bench.wrong(), bench.summary().proved), (0, 6));
}

/// Flexible slots that the sender did not mean say nothing, neither of the sender nor of others.
#[test]
fn flexible_tags_of_a_message_whose_sequence_is_wrong_are_not_checked() {
    let system = System::new(16);
    let mut bench = Bench::new(system.public());
    let mut pages = system.pages(START..START + 16);
    for page in pages.iter_mut().filter(|page| page.satellite == 2 && page.begin_s % 30 == 3) {
        // The second page has the sequence and the first bits of the tag behind it, which is flexible.
        page.bits[2] ^= 0x10;
        page.bits[4] ^= 0x01;
    }
    bench.hear_all(&pages);
    assert!(bench.count("osnma_sequences_wrong") > 5, "{:?}", bench.osnma.tally());
    assert_eq!(bench.count("osnma_orbits_wrong"), 0);
    assert_eq!((bench.summary().proved, bench.summary().false_), (6, 0));
}

/// Returns the slices of eight subframes in which a satellite states a time that is so much later,
/// behind eight genuine ones.
fn slices_with_a_clock(system: &System, ahead_s: u32) -> u32 {
    let mut bench = Bench::new(system.public());
    let pages = system.pages(START..START + 16);
    let (genuine, stated) = pages.split_at(15 * 6 * 8);
    bench.hear_all(genuine);
    assert_eq!(bench.summary().proved, 6);
    let mut slices = 0;
    for page in stated {
        let mut word = u128::from_be_bytes(page.word);
        if page.satellite == 2 && page.word[0] >> 2 == 5 {
            // Bits 85 to 104 of word 5 are the time of week, s.
            word += u128::from(ahead_s) << 23;
        }
        let now_ms = u64::from(page.begin_s - 30 * ROOT + 2) * 1000;
        bench.osnma.receive(page.satellite, &word.to_be_bytes(), page.bits, true, now_ms);
        while bench.osnma.work(&bench.keys, now_ms) != Worked::Nothing {
            slices += 1;
        }
        bench.now_ms = now_ms;
    }
    assert!(bench.summary().proved >= 5);
    assert_eq!(bench.summary().false_, 0);
    slices
}

/// The chain is followed only as far as the module's clock has run since the newest key.
#[test]
fn a_satellite_that_states_a_later_time_costs_no_thousands_of_steps() {
    let system = System::new(17);
    let honest = slices_with_a_clock(&system, 0);
    for ahead_s in [60, 3_600, 150_000] {
        let have = slices_with_a_clock(&system, ahead_s);
        assert!(have < honest + 100, "{have} slices instead of {honest}, {ahead_s} s ahead");
    }
}

/// Callers that tick ten times a second get four slices a tick.
#[test]
fn four_slices_ten_times_a_second_prove_four_satellites_in_three_minutes() {
    let system = System::new(13);
    let mut bench = Bench::new(system.public());
    let pages = system.pages(START..START + 12);
    let start_s = pages[0].begin_s;
    let mut ahead = pages.iter().peekable();
    let mut first_s = None;
    for tick in 0..3600 {
        let now_ms = u64::from(start_s - 30 * ROOT) * 1000 + 100 * tick;
        while let Some(page) = ahead.next_if(|page| u64::from(page.begin_s - 30 * ROOT + 2) * 1000 <= now_ms)
        {
            bench.osnma.receive(page.satellite, &page.word, page.bits, true, now_ms);
        }
        for _ in 0..4 {
            bench.osnma.work(&bench.keys, now_ms);
        }
        if bench.osnma.summary(&bench.keys, now_ms).proved >= 4 && first_s.is_none() {
            first_s = Some(tick / 10);
        }
    }
    println!("first four proved after {first_s:?} s");
    assert!(first_s.is_some_and(|first_s| first_s <= 180), "{first_s:?}");
    assert_eq!(bench.wrong(), 0);
}

/// The pages by which the cost on the chip is measured are those of this signer.
#[test]
fn the_pages_that_are_measured_are_signed_here() {
    let system = System::of(Secret::of(&[15, 1]), 15);
    let mut bytes = system.public().to_vec();
    for page in system.pages(START..START + 7) {
        bytes.push(page.satellite);
        bytes.extend((page.begin_s - 30 * ROOT + 2).to_le_bytes());
        bytes.extend(page.word);
        bytes.extend(page.bits);
    }
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/vectors/osnma_pages.bin");
    if std::env::var_os("RAI_BLESS").is_some() {
        std::fs::write(path, &bytes).expect("the file is written");
    }
    assert!(std::fs::read(path).expect("the file") == bytes, "RAI_BLESS=1 writes the file");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    /// Pages of a signed sky with bits turned, satellites exchanged, and arrivals at any time.
    #[test]
    fn no_pages_are_proved_that_the_system_did_not_make(
        turned in prop::collection::vec((0_usize..15 * 6 * 8, 0_usize..168, 0_u8..40, 0_u64..5_000), 0..400),
    ) {
        let system = System::new(14);
        let mut bench = Bench::new(system.public());
        let mut pages = system.pages(START..START + 8);
        let mut late = vec![0; pages.len()];
        for (index, bit, satellite, late_ms) in turned {
            let page = &mut pages[index];
            match bit {
                0..128 => page.word[bit / 8] ^= 0x80 >> (bit % 8),
                _ => page.bits[(bit - 128) / 8] ^= 0x80 >> (bit % 8),
            }
            if satellite % 7 == 0 {
                page.satellite = satellite;
            }
            late[index] = late_ms;
        }
        for (page, late_ms) in pages.iter().zip(late) {
            let now_ms = u64::from(page.begin_s - 30 * ROOT + 2) * 1000 + late_ms;
            bench.osnma.receive(page.satellite, &page.word, page.bits, true, now_ms);
            for _ in 0..3000 {
                if bench.osnma.work(&bench.keys, now_ms) == Worked::Nothing {
                    break;
                }
            }
        }
        let summary = bench.osnma.summary(&bench.keys, bench.now_ms);
        prop_assert!(summary.proved + summary.unproved + summary.false_ <= 36);
    }
}
