//! Sets of rows as words: one bit for each, by its index.

/// The bit of a row; a row beyond the word is in no set.
pub(crate) fn bit(index: usize) -> u64 {
    1u64.checked_shl(index as u32).unwrap_or(0)
}

/// Everything above a member.
pub(crate) fn above(index: usize) -> u64 {
    u64::MAX.checked_shl(index as u32 + 1).unwrap_or(0)
}

/// So many first rows.
pub(crate) fn first(count: usize) -> u64 {
    1u64.checked_shl(count as u32).map_or(u64::MAX, |beyond| beyond - 1)
}

/// How many members a set has.
// The processor has no instruction for it: once, and not wherever sets are counted.
#[inline(never)]
pub(crate) fn count_of(set: u64) -> usize {
    set.count_ones() as usize
}

/// The members of a set, ascending.
pub(crate) fn members(mut set: u64) -> impl Iterator<Item = usize> + Clone {
    core::iter::from_fn(move || {
        let index = set.trailing_zeros() as usize;
        set &= set.wrapping_sub(1);
        (index < u64::BITS as usize).then_some(index)
    })
}
