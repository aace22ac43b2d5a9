//! Cache of flash lines that replaces the line that was unused for longest, as [RM0090] §3.5.2 has
//! it.
//!
//! [RM0090]: crate#references

/// Cache of `LINES` lines.
#[derive(Clone, Debug, Default)]
pub(super) struct Cache<const LINES: usize> {
    /// Numbers of the lines, the last used first.
    lines: Vec<u64>,
}

impl<const LINES: usize> Cache<LINES> {
    /// Returns true if the cache holds a line, and makes it the last used.
    pub(super) fn holds(&mut self, line: u64) -> bool {
        let place = self.lines.iter().position(|known| *known == line);
        if let Some(place) = place {
            self.lines.get_mut(..=place).into_iter().for_each(|recent| recent.rotate_right(1));
        } else {
            self.lines.truncate(LINES - 1);
            self.lines.insert(0, line);
        }
        place.is_some()
    }
}
