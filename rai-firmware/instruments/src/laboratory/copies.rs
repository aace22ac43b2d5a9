//! Copies, fills and comparisons of memory (`raim_board_arm`), compared with plain loops.
//!
//! | routine | alignments | bytes | also |
//! |---|---|---|---|
//! | copy | 4 to, 4 from | 0 to 89 | the bytes around it |
//! | copy within a block | 4 | 0 to 89 | −50 to 50 bytes apart |
//! | fill, clear | 4 | 0 to 89 | the bytes around it |
//! | comparison | 4 and 4 | 0 to 89 | first and last byte different, both ways |
//!
//! The loops move one byte at a time through [`black_box`], so that the compiler cannot replace
//! them by the routines under test.

use core::cmp::Ordering;
use core::hint::black_box;

/// Largest number of bytes.
const LONGEST: usize = 89;
/// Largest distance of two blocks that overlap, bytes.
const FARTHEST: usize = 50;
/// Start of a block; the bytes before it must stay as they are.
const EDGE: usize = 8;
/// Memory of a block with what surrounds it.
const ROOM: usize = EDGE + FARTHEST + LONGEST + FARTHEST + EDGE;

type Block = [u8; ROOM];

/// Number of comparisons with a loop, and of those that differ.
#[derive(Clone, Copy, Debug, Default)]
pub struct Compared {
    /// All cases.
    pub cases: u32,
    /// Cases with another result than the loop's.
    pub wrong: u32,
}

impl Compared {
    fn add(&mut self, is_equal: bool) {
        self.cases += 1;
        self.wrong += u32::from(!is_equal);
    }

    fn blocks(&mut self, have: &Block, want: &Block) {
        let is_equal = have.iter().zip(want).all(|(have, want)| black_box(*have) == black_box(*want));
        self.add(is_equal);
    }
}

/// Runs every case of each routine.
pub fn compare() -> [(&'static str, Compared); 4] {
    [("copies", copies()), ("moves", moves()), ("fills", fills()), ("comparisons", comparisons())]
}

/// Block of known alignment.
#[repr(align(8))]
struct Aligned(Block);

fn pattern(seed: usize) -> Aligned {
    let mut block = Aligned([0; ROOM]);
    for (number, byte) in block.0.iter_mut().enumerate() {
        *byte = black_box((number * 37 + seed * 101 + 11) as u8);
    }
    block
}

fn alignments() -> impl Iterator<Item = (usize, usize)> {
    (0..4).flat_map(|to| (0..4).map(move |from| (EDGE + to, EDGE + from)))
}

/// Copies one byte at a time from another block.
#[inline(never)]
fn copy_by_loop(block: &mut Block, from: &Block, (to, start): (usize, usize), length: usize) {
    for number in 0..length {
        if let (Some(target), Some(byte)) = (block.get_mut(to + number), from.get(start + number)) {
            *target = black_box(*byte);
        }
    }
}

#[inline(never)]
fn copies() -> Compared {
    let mut compared = Compared::default();
    for ((to, from), length) in alignments().flat_map(|places| (0..=LONGEST).map(move |n| (places, n))) {
        let (mut have, mut want, source) = (pattern(1), pattern(1), pattern(2));
        let length = black_box(length);
        if let (Some(target), Some(bytes)) =
            (have.0.get_mut(to..to + length), source.0.get(from..from + length))
        {
            target.copy_from_slice(bytes);
        }
        copy_by_loop(&mut want.0, &source.0, (to, from), length);
        compared.blocks(black_box(&have.0), &want.0);
    }
    compared
}

#[inline(never)]
fn moves() -> Compared {
    let mut compared = Compared::default();
    for (alignment, apart) in (0..4).flat_map(|at| (0..=2 * FARTHEST).map(move |apart| (at, apart))) {
        for length in 0..=LONGEST {
            let (from, to) = (EDGE + FARTHEST + alignment, EDGE + alignment + apart);
            let (mut have, mut want, source) = (pattern(3), pattern(3), pattern(3));
            let length = black_box(length);
            have.0.copy_within(from..from + length, to);
            copy_by_loop(&mut want.0, &source.0, (to, from), length);
            compared.blocks(black_box(&have.0), &want.0);
        }
    }
    compared
}

#[inline(never)]
fn fills() -> Compared {
    let mut compared = Compared::default();
    for (to, length) in (0..4).flat_map(|at| (0..=LONGEST).map(move |length| (EDGE + at, length))) {
        for value in [0, 1, 0x80, 0xFF] {
            let (mut have, mut want) = (pattern(4), pattern(4));
            let length = black_box(length);
            if let Some(target) = have.0.get_mut(to..to + length) {
                // A clear is a routine of its own.
                if value == 0 { target.fill(0) } else { target.fill(black_box(value)) }
            }
            for byte in want.0.iter_mut().skip(to).take(length) {
                *byte = black_box(value);
            }
            compared.blocks(black_box(&have.0), &want.0);
        }
    }
    compared
}

#[inline(never)]
fn comparisons() -> Compared {
    let mut compared = Compared::default();
    for ((at, other), length) in alignments().flat_map(|places| (0..=LONGEST).map(move |n| (places, n))) {
        let one = pattern(5);
        let mut same = Aligned([0; ROOM]);
        copy_by_loop(&mut same.0, &one.0, (other, at), length);
        compared.add(order(&one.0, &same.0, (at, other), length) == Ordering::Equal);
        for place in [0, length.saturating_sub(1)].into_iter().filter(|place| *place < length) {
            for change in [1, 0x80] {
                let mut differs = Aligned(same.0);
                if let (Some(byte), Some(unlike)) = (differs.0.get_mut(other + place), one.0.get(at + place))
                {
                    *byte = black_box(unlike ^ change);
                    let want = if *unlike < *byte { Ordering::Less } else { Ordering::Greater };
                    compared.add(order(&one.0, &differs.0, (at, other), length) == want);
                }
            }
        }
    }
    compared
}

/// Compares as the routine does.
#[inline(never)]
fn order(one: &Block, two: &Block, (at, other): (usize, usize), length: usize) -> Ordering {
    let length = black_box(length);
    let slices = one.get(at..at + length).zip(two.get(other..other + length));
    slices.map_or(Ordering::Equal, |(one, two)| one.cmp(two))
}
