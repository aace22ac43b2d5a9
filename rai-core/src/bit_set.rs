//! Sets of rows as 64-bit words: bit `i` is set if row `i` is a member.

/// Returns the bit of a row, or 0 beyond the word.
pub(crate) fn bit(index: usize) -> u64 {
    1u64.checked_shl(index as u32).unwrap_or(0)
}

/// Returns the set of some rows.
pub(crate) fn set_of(rows: &[usize]) -> u64 {
    rows.iter().fold(0, |set, &index| set | bit(index))
}

/// Returns all bits above a member.
pub(crate) fn above(index: usize) -> u64 {
    u64::MAX.checked_shl(index as u32 + 1).unwrap_or(0)
}

/// Returns the set of the first `count` rows.
pub(crate) fn first(count: usize) -> u64 {
    1u64.checked_shl(count as u32).map_or(u64::MAX, |beyond| beyond - 1)
}

/// Returns the number of members.
// The processor has no instruction for this, so that it is compiled once and not inlined at every
// call.
#[inline(never)]
pub(crate) fn count_of(set: u64) -> usize {
    set.count_ones() as usize
}

/// Iterates over the members of a set, ascending.
pub(crate) fn members(mut set: u64) -> impl Iterator<Item = usize> + Clone {
    core::iter::from_fn(move || {
        let index = set.trailing_zeros() as usize;
        set &= set.wrapping_sub(1);
        (index < u64::BITS as usize).then_some(index)
    })
}
