//! Pages that no system sends, and pages that come as they should not.
//!
//! Nothing of it makes words false that the system made, raises an alarm that is none, or leaves a
//! proof without an age.

use raim::signal::osnma::Chain;
use raim::signal::osnma::words::Arbitrary;
use sha2::{Digest as _, Sha256};

use super::*;

/// Takes pages at times of the module's own clock, and checks what must hold behind each.
fn hear_at(bench: &mut Bench, pages: impl IntoIterator<Item = (Page, u64)>) {
    for (page, now_ms) in pages {
        bench.now_ms = now_ms;
        bench.osnma.receive(page.satellite, &page.word, page.bits, true, now_ms);
        while bench.osnma.work(&bench.keys, now_ms) != Worked::Nothing {}
        must_hold(bench);
    }
}

fn must_hold(bench: &Bench) {
    let summary = bench.summary();
    assert_eq!(summary.proved > 0, summary.oldest_proof_s.is_some(), "a proof has an age");
    assert_eq!((summary.false_, summary.is_alarm), (0, false), "{:?}", bench.osnma.tally());
}

fn hear_checked(bench: &mut Bench, pages: &[Page]) {
    for page in pages {
        bench.receive(page);
        must_hold(bench);
    }
}

/// Returns the pages with their arrivals, the first `first_ms` after the start.
fn on_time(pages: &[Page], first_ms: u64) -> Vec<(Page, u64)> {
    let begin_s = pages[0].begin_s;
    pages.iter().map(|page| (*page, first_ms + 1000 * u64::from(page.begin_s - begin_s))).collect()
}

#[test]
fn number_of_blocks_beyond_the_table_delays_nothing() {
    let system = System::new(30);
    let want_s = first_four(&mut Bench::new(system.public()), &system.pages(START..START + 12));
    for code in (0..16).filter(|code| *code != 2) {
        let lie = |mut page: Page| {
            let is_first = page.begin_s % 30 == 5 && page.bits[0] >> 4 == 2;
            if is_first {
                page.bits[0] = code << 4 | page.bits[0] & 15;
            }
            page
        };
        // One satellite, then all of them.
        let pages = system.pages(START..START + 12);
        let one: Vec<Page> =
            pages.iter().map(|page| if page.satellite == 2 { lie(*page) } else { *page }).collect();
        let mut bench = Bench::new(system.public());
        let have_s = first_four(&mut bench, &one);
        assert!(have_s <= want_s.map(|want_s| want_s + 60), "{have_s:?} s, code {code}");
        let mut bench = Bench::new(system.public());
        hear_checked(&mut bench, &pages.iter().copied().map(lie).collect::<Vec<_>>());
        assert_eq!((bench.summary().proved, bench.wrong()), (0, 0), "code {code}");
    }
}

#[test]
fn chains_in_turn_are_not_those_of_the_root_key() {
    let system = System::new(31);
    let turn = |mut page: Page| {
        if page.begin_s % 30 == 1 {
            page.bits[0] = (page.bits[0] & !0x30) | ((page.begin_s / 30 % 4) as u8 * 16);
        }
        page
    };
    let pages = system.pages(START..START + 24);
    // One satellite, then all of them behind the first proof.
    for (satellites, from, least) in [(2..3, 0, 6), (2..37, 15 * 6 * 6, 0)] {
        let mut bench = Bench::new(system.public());
        let turned: Vec<Page> = pages
            .iter()
            .enumerate()
            .map(
                |(index, page)| {
                    if index >= from && satellites.contains(&page.satellite) { turn(*page) } else { *page }
                },
            )
            .collect();
        hear_checked(&mut bench, &turned);
        assert!(bench.summary().proved >= least, "{:?}", bench.summary());
        assert_eq!(bench.summary().key_and_chain, Some((1, 0)));
    }
}

/// Galileo's time leaps ahead and back, while the module's clock does not.
#[test]
fn leaps_of_the_systems_time_prove_nothing_and_end_with_it() {
    let system = System::new(32);
    for (ahead, back) in [(120, 0), (3, 0), (0, 30), (200, 100)] {
        let mut bench = Bench::new(system.public());
        let true_start = START + 40;
        let mut now_ms = 1000;
        for begin in [true_start, true_start + 8 + ahead - back, true_start + 16] {
            hear_at(&mut bench, on_time(&system.pages(begin..begin + 8), now_ms));
            now_ms += 8 * 30_000;
        }
        hear_at(&mut bench, on_time(&system.pages(true_start + 24..true_start + 36), now_ms));
        assert_eq!(bench.wrong(), 0, "{ahead} ahead, {back} back: {:?}", bench.osnma.tally());
        assert_eq!(bench.summary().proved, 6, "{ahead} ahead, {back} back");
    }
}

#[test]
fn end_of_the_week_costs_nothing() {
    const WEEK: u32 = 20_160;
    let (seed, first) = (33, 1340 * WEEK - 8);
    let root = Chain::root(1339, 167);
    let system = System::with(Secret::test(), seed, root, vec![2, 5, 11, 19], Box::new(Arbitrary { seed }));
    let mut bench = Bench::new(system.public());
    hear_at(&mut bench, on_time(&system.pages(first..first + 24), 1000));
    assert_eq!((bench.wrong(), bench.summary().proved), (0, 4));
    // Each of the subframes behind the first six has been checked, those about the end as well.
    assert!(bench.count("osnma_orbits_right") >= 17 * 4 * 3, "{:?}", bench.osnma.tally());
}

/// The week of word 5 is another in all pages of one satellite, or of all.
#[test]
fn wrong_week_of_a_satellite_is_its_own_loss() {
    let system = System::new(34);
    let genuine = system.pages(START..START + 16);
    let is_time = |page: &Page| page.word[0] >> 2 == 5;
    for by in [-1_i32, 1, 1024, 4095] {
        for (liars, proved) in [(2..3, 5..7), (1..37, 0..1)] {
            let mut bench = Bench::new(system.public());
            let mut pages = genuine.clone();
            for page in pages.iter_mut().filter(|page| is_time(page) && liars.contains(&page.satellite)) {
                let word = u128::from_be_bytes(page.word);
                let week = (word >> 43 & 0xFFF) as i32;
                let other = (week + by).rem_euclid(4096) as u128;
                page.word = (word & !(0xFFF << 43) | other << 43).to_be_bytes();
            }
            hear_checked(&mut bench, &pages);
            let summary = bench.summary();
            assert!(proved.contains(&summary.proved), "week by {by}: {summary:?}");
        }
    }
}

/// Pages of a second receiver on the same line: of the same instant a little later, and of a sky that
/// is minutes old.
#[test]
fn pages_of_two_receivers_make_nothing_false() {
    let system = System::new(35);
    let pages = on_time(&system.pages(START + 20..START + 44), 1000);
    for (late, after_ms) in [(0, 300), (0, 900), (1, 10), (10, 10)] {
        let others = system.pages(START + 20 - late..START + 44 - late);
        let others = others.iter().zip(&pages).map(|(other, (_, now_ms))| (*other, now_ms + after_ms));
        let mut mixed: Vec<(Page, u64)> = pages.iter().copied().chain(others).collect();
        mixed.sort_by_key(|(_, now_ms)| *now_ms);
        let mut bench = Bench::new(system.public());
        hear_at(&mut bench, mixed);
        println!("{late} subframes and {after_ms} ms: {:?} {:?}", bench.summary(), bench.osnma.tally());
        if late == 0 {
            assert_eq!((bench.wrong(), bench.summary().proved), (0, 6));
        }
    }
}

/// The true message with another signature, whose padding is right, comes first and from all satellites.
#[test]
fn true_root_key_is_tried_behind_one_with_a_forged_signature() {
    const BLOCK: usize = 13;
    let system = System::new(36);
    let pages = system.pages(START..START + 16);
    let block_of = |page: &Page| {
        let begin_s = page.begin_s / 30 * 30 + 3;
        let mut heads = pages.iter();
        let head = heads.find(|head| (head.satellite, head.begin_s) == (page.satellite, begin_s));
        usize::from(head.expect("a head").bits[0] & 15)
    };
    let place_of = |page: &Page| BLOCK * block_of(page) + ((page.begin_s % 30) as usize - 5) / 2;
    let mut message = [0; 8 * BLOCK];
    for page in pages.iter().filter(|page| page.begin_s % 30 > 3) {
        message[place_of(page)] = page.bits[0];
    }
    // The last byte of s, behind 13 bytes of head, the key, r and the rest of s.
    message[13 + 16 + 63] ^= 1;
    let padding = Sha256::new().chain_update([0b1000_0010]).chain_update(&message[1..93]).finalize();
    message[93..].copy_from_slice(&padding[..11]);
    let mut forged = pages.clone();
    for page in forged.iter_mut().take(15 * 6 * 5) {
        match page.begin_s % 30 {
            1 => {}
            3 => page.bits[0] = 7 << 4 | page.bits[0] & 15,
            _ => page.bits[0] = message[place_of(page)],
        }
    }
    let mut bench = Bench::new(system.public());
    hear_checked(&mut bench, &forged);
    assert_eq!((bench.count("osnma_roots_wrong"), bench.count("osnma_roots_right")), (1, 1));
    assert_eq!(bench.summary().proved, 6);
}
