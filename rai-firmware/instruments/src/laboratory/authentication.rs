//! Slices of the authentication over the pages of a signed sky.
//!
//! The input is the number of what is measured, a public key, and pages of 26 bytes: satellite, arrival
//! in s, word, bits for authentication. The answer has the most ticks of one call:
//!
//! | number | call |
//! |---|---|
//! | 0 | any slice |
//! | 1 | a slice that checks a tag or a sequence |
//! | 2 | a slice that compares a key with the chain |
//! | 3 | a page |

use core::mem::MaybeUninit;

use raim_firmware::osnma::{Authentication, Keys, Worked};

use crate::answer::Answers;
use crate::request::Input;
use crate::stopwatch::Stopwatch;

/// Bytes of a page.
const PAGE: usize = 26;

/// Most slices between two pages; a signature takes 550.
const SLICES: usize = 2000;

/// Times the calls.
#[inline(never)]
pub fn authenticate(mut input: Input<'_>, stopwatch: &mut Stopwatch, answers: &mut Answers) -> Option<()> {
    let measured = input.byte()?;
    let (key, pages) = input.0.split_first_chunk()?;
    let keys = Keys { key: Some((1, *key)), root: None };
    let mut place = MaybeUninit::<Authentication>::uninit();
    let authentication = place.write(Authentication::new());
    let (mut most_ticks, mut slices) = (0, 0_u32);
    for page in pages.as_chunks::<PAGE>().0 {
        let [satellite, a, b, c, d, rest @ ..] = page;
        let now_ms = u64::from(u32::from_le_bytes([*a, *b, *c, *d])) * 1000;
        let (word, bits) = rest.split_first_chunk::<16>()?;
        let bits = *bits.first_chunk()?;
        let ((), ticks) = stopwatch.time(|| authentication.receive(*satellite, word, bits, true, now_ms));
        if measured == 3 {
            most_ticks = most_ticks.max(ticks);
        }
        for _ in 0..SLICES {
            let before = *authentication.tally();
            let (worked, ticks) = stopwatch.time(|| authentication.work(&keys, now_ms));
            if worked == Worked::Nothing {
                break;
            }
            slices += 1;
            let now = *authentication.tally();
            let is_tag = now.osnma_sequences_right != before.osnma_sequences_right
                || now.osnma_orbits_right != before.osnma_orbits_right
                || now.osnma_times_right != before.osnma_times_right
                || now.osnma_slow_right != before.osnma_slow_right;
            let is_measured = match measured {
                0 => true,
                1 => is_tag,
                // Behind the root key, and before the tags.
                2 => now.osnma_roots_right > 0 && !is_tag,
                _ => false,
            };
            if is_measured {
                most_ticks = most_ticks.max(ticks);
            }
        }
    }
    let tally = *authentication.tally();
    let wrong = tally.osnma_orbits_wrong + tally.osnma_keys_wrong + tally.osnma_roots_wrong;
    answers.write(most_ticks, &(slices, tally.osnma_orbits_right, wrong))
}
