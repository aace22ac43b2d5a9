//! Text cut at a character, once for all that is read: what the standard library makes of it is
//! written anew wherever it is used.

/// What stands before the first of these characters and behind it.
///
/// A single one is written twice: the search for one alone keeps bounds checks that no compiler
/// sees through.
#[inline(never)]
pub(super) fn cut(text: &str, at: [char; 2]) -> Option<(&str, &str)> {
    text.split_once(at)
}

/// What stands between commas; of no text one that is empty.
#[derive(Clone, Debug)]
pub(super) struct Fields<'t>(Option<&'t str>);

impl<'t> Fields<'t> {
    pub(super) const fn of(text: &'t str) -> Self {
        Self(Some(text))
    }
}

impl<'t> Iterator for Fields<'t> {
    type Item = &'t str;

    #[inline(never)]
    fn next(&mut self) -> Option<&'t str> {
        let text = self.0?;
        let (field, rest) = cut(text, [',', ',']).map_or((text, None), |(field, rest)| (field, Some(rest)));
        self.0 = rest;
        Some(field)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_what_stands_between_commas() {
        for text in ["", ",", "MASK", "MASK,5", ",,5,", "IONO,1e-8,-2,,"] {
            assert!(Fields::of(text).eq(text.split(',')), "{text}");
        }
    }
}
