//! Two other verifiers beside ours: `galileo-osnma`, page by page, and a script of the reference
//! folder.
//!
//! `galileo-osnma` says which words of a satellite it has authenticated last, and never that words are
//! false. The verdicts agree if both call the present words proved, or neither does.

use std::collections::BTreeMap;
use std::io::Write as _;
use std::process::{Command, Stdio};

use galileo_osnma::storage::FullStorage;
use galileo_osnma::{Gst, InavBand, PublicKey, Svn};
use p256::ecdsa::VerifyingKey;
use raim::signal::osnma::{Phase, ROOT, System};

use super::*;

/// Word, first bit and number of bits of what tags of orbit and clock are about.
const ORBIT: [(u8, usize, usize); 5] = [(1, 6, 120), (2, 6, 120), (3, 6, 122), (4, 6, 120), (5, 6, 67)];

/// The other verifier, and the last words of each satellite.
struct Second {
    osnma: Box<galileo_osnma::Osnma<FullStorage>>,
    words: BTreeMap<u8, [Option<u128>; 5]>,
}

impl Second {
    fn new(keys: &Keys) -> Self {
        let (number, point) = keys.key.expect("a key");
        let key = PublicKey::from_p256(VerifyingKey::from_sec1_bytes(&point).expect("a point"), number);
        let key = key.force_valid();
        let osnma = match keys.root {
            Some(root) => galileo_osnma::Osnma::from_merkle_tree(root, Some(key), false),
            None => galileo_osnma::Osnma::from_pubkey(key, false),
        };
        Self { osnma: Box::new(osnma), words: BTreeMap::new() }
    }

    fn receive(&mut self, satellite: u8, begin_s: u32, word: &[u8; 16], bits: [u8; 5], is_e1: bool) {
        let number = Svn::try_from(satellite).expect("a satellite");
        let gst = Gst::new((begin_s / 604_800) as u16, begin_s % 604_800);
        let band = if is_e1 { InavBand::E1B } else { InavBand::E5B };
        self.osnma.feed_inav(word, number, gst, band);
        if is_e1 {
            self.osnma.feed_osnma(&bits, number, gst);
        }
        if let kind @ 1..=5 = word[0] >> 2 {
            let words = self.words.entry(satellite).or_default();
            words[usize::from(kind) - 1] = Some(u128::from_be_bytes(*word));
        }
    }

    /// Returns true if the last words of a satellite are those that it has authenticated.
    fn is_proved(&self, satellite: u8) -> bool {
        let number = Svn::try_from(satellite).expect("a satellite");
        let (Some(data), Some(words)) = (self.osnma.get_ced_and_status(number), self.words.get(&satellite))
        else {
            return false;
        };
        let mut bits = data.data().iter().by_vals();
        ORBIT.iter().zip(words).all(|(&(_, start, count), word)| {
            let Some(word) = word else { return false };
            (start..start + count).all(|bit| bits.next() == Some(word >> (127 - bit) & 1 == 1))
        })
    }
}

/// Pages by the verdicts of the two verifiers on the words of their satellite.
#[derive(Debug, Default, PartialEq, Eq)]
struct Agreement {
    both: u32,
    neither: u32,
    ours_alone: u32,
    its_alone: u32,
    /// First and last second of those.
    alone_s: Option<(u32, u32)>,
    /// False here, proved there.
    contrary: u32,
}

/// A page for both verifiers.
struct Heard {
    satellite: u8,
    begin_s: u32,
    word: [u8; 16],
    bits: [u8; 5],
    is_e1: bool,
}

fn compared(keys: &Keys, pages: impl Iterator<Item = Heard>) -> (Agreement, u32) {
    let mut ours = Box::new(Large::new());
    let mut second = Second::new(keys);
    let mut agreement = Agreement::default();
    let mut first_s = None;
    for Heard { satellite, begin_s, word, bits, is_e1 } in pages {
        let now_ms = u64::from(begin_s - *first_s.get_or_insert(begin_s) + 2) * 1000;
        ours.receive(satellite, &word, bits, is_e1, now_ms);
        while ours.work(keys, now_ms) != Worked::Nothing {}
        second.receive(satellite, begin_s, &word, bits, is_e1);
        let verdict = ours.seal_of(satellite).verdict;
        let is_its = second.is_proved(satellite);
        if !verdict.is_proved() && is_its {
            let since_s = begin_s - first_s.unwrap_or(begin_s);
            agreement.alone_s.get_or_insert((since_s, since_s)).1 = since_s;
        }
        *match (verdict.is_proved(), is_its) {
            (true, true) => &mut agreement.both,
            (true, false) => &mut agreement.ours_alone,
            (false, false) => &mut agreement.neither,
            (false, true) if verdict == Verdict::False => &mut agreement.contrary,
            (false, true) => &mut agreement.its_alone,
        } += 1;
    }
    let wrong =
        ours.tally().iter().filter(|(name, _)| name.ends_with("_wrong")).map(|(_, count)| count).sum();
    (agreement, wrong)
}

fn recorded(pages: &[Page]) -> impl Iterator<Item = Heard> + '_ {
    pages.iter().map(|page| Heard {
        satellite: page.satellite,
        begin_s: page.begin_s,
        word: page.word(),
        bits: page.authentication(),
        is_e1: page.is_e1,
    })
}

fn signed(pages: &[raim::signal::osnma::Page]) -> impl Iterator<Item = Heard> + '_ {
    pages.iter().map(|page| Heard {
        satellite: page.satellite,
        begin_s: page.begin_s,
        word: page.word,
        bits: page.bits,
        is_e1: true,
    })
}

/// First subframe of the signed skies.
const START: u32 = ROOT + 125;

#[test]
fn the_script_of_the_reference_folder_accepts_what_the_signer_makes() {
    let Some(script) = shared::path_or_skip("tools/osnma.py") else { return };
    let modules = Command::new("python3").args(["-c", "import cryptography"]).output();
    if !modules.is_ok_and(|output| output.status.success()) {
        rig::skip::say("python3 with cryptography");
        return;
    }
    let system = System::new(46);
    let key = system.public().iter().map(|byte| format!("{byte:02x}")).collect::<Vec<_>>().concat();
    let mut program = Command::new("python3")
        .arg(script)
        .arg(key)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("python3 was there a moment ago");
    let lines: Vec<String> =
        system.pages(START..START + 40).iter().map(raim::signal::osnma::Page::line).collect();
    program.stdin.take().expect("an input").write_all((lines.join("\n") + "\n").as_bytes()).expect("written");
    let output = program.wait_with_output().expect("an end");
    let reported = String::from_utf8(output.stdout).expect("text");
    println!("{reported}");
    assert!(reported.contains("padding True signature True"), "{reported}");
    assert!(!reported.contains("WRONG") && !reported.contains("ADKD not as table"), "{reported}");
    assert!(["ADKD0 ok", "ADKD4 ok", "ADKD12 ok", "macseq ok"].iter().all(|count| reported.contains(count)));
}

/// Recordings and vectors, which take seconds.
mod at_length {
    use super::*;

    #[test]
    fn galileo_osnma_accepts_what_the_signer_makes() {
        type Change = fn(&mut Phase);
        type Case<'a> = (&'a str, &'a [(u32, Change)], u32);
        let all: [Case<'_>; 5] = [
            ("plain", &[], 40),
            ("chain ends", &[(8, Phase::chain_ends), (16, Phase::next_chain)], 32),
            ("chain revoked", &[(8, Phase::chain_revoked), (16, Phase::chain_replaced)], 32),
            ("key follows", &[(6, Phase::key_comes), (40, Phase::key_follows)], 60),
            ("key revoked", &[(6, Phase::key_revoked), (50, Phase::key_replaced)], 70),
        ];
        for (seed, (name, changes, end)) in (40..).zip(all) {
            let mut system = System::new(seed);
            for &(from, change) in changes {
                system.then(START + from, change);
            }
            let keys = Keys { key: Some((1, system.public())), root: Some(system.tree_root()) };
            let (agreement, wrong) = compared(&keys, signed(&system.pages(START..START + end)));
            println!("{name}: {agreement:?}");
            assert_eq!((wrong, agreement.contrary), (0, 0), "{name}");
            // All satellites are proved there too, at the end.
            let mut second = Second::new(&keys);
            for page in system.pages(START..START + end) {
                second.receive(page.satellite, page.begin_s, &page.word, page.bits, true);
            }
            assert!(system.satellites.iter().all(|satellite| second.is_proved(*satellite)), "{name}");
        }
    }

    #[test]
    fn galileo_osnma_agrees_page_by_page() {
        for (name, key, tree) in [
            ("eoc_step2", KEY_7, Some(TREE_2)),
            ("eoc_step1", KEY_7, Some(TREE_2)),
            ("npk_step1", KEY_7, Some(TREE_2)),
            ("npk_step2", KEY_7, Some(TREE_2)),
            ("station", KEY_2025, None),
            ("configuration_2", KEY_2, Some(TREE_2)),
            ("crev_step1", KEY_7, Some(TREE_2)),
            ("oam_step1", KEY_1, Some(TREE_3)),
            ("oam_step2", KEY_1, Some(TREE_3)),
        ] {
            let Some(pages) = (if name == "station" { station() } else { vector(name) }) else { return };
            let (agreement, wrong) = compared(&keys(key, tree), recorded(&pages));
            println!("{name}: {agreement:?}");
            assert_eq!((agreement.contrary, agreement.ours_alone, wrong), (0, 0, 0), "{name}");
            // What was proved before a revocation or an alert stays so there, and does not here.
            let is_ended = name.starts_with("crev") || name.starts_with("oam");
            // It also uses a subframe from before the root key was known, at the begin.
            let is_at_begin = agreement.alone_s.is_none_or(|(_, last_s)| last_s < 120);
            assert!(is_at_begin || is_ended, "{name}: {agreement:?}");
        }
    }
}
