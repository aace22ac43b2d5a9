//! Sizes of navigation messages, which determine the memory.

/// Sizes of a navigation message.
#[derive(Clone, Copy)]
pub(super) struct Sizes {
    pub(super) words: usize,
    pub(super) page_bytes: usize,
    pub(super) pages: usize,
}

impl Sizes {
    /// Returns the largest of each size.
    pub(super) const fn largest(all: &[Self]) -> (usize, usize, usize) {
        let (mut words, mut pages, mut set_bytes, mut index) = (0, 0, 0, 0);
        while index < all.len() {
            let sizes = all[index];
            words = larger(words, sizes.words);
            pages = larger(pages, sizes.pages);
            set_bytes = larger(set_bytes, sizes.set_bytes());
            index += 1;
        }
        (words, pages, set_bytes)
    }

    /// Returns the bytes of a complete set.
    pub(super) const fn set_bytes(self) -> usize {
        self.page_bytes * self.pages
    }
}

const fn larger(a: usize, b: usize) -> usize {
    if a > b { a } else { b }
}
