//! Splits text at a character, once for all readers, because each use of the standard library's
//! version is compiled again.

/// Returns the text before the first of an ASCII character and the text behind it.
#[inline(never)]
pub(super) fn cut(text: &str, at: u8) -> Option<(&str, &str)> {
    // No byte of a longer character is ASCII.
    let place = text.bytes().position(|byte| byte == at)?;
    text.get(..place).zip(text.get(place + 1..))
}

/// Fields between commas. An empty text has one empty field.
#[derive(Clone, Debug)]
pub(super) struct Fields<'t>(Option<&'t str>);

impl<'t> Fields<'t> {
    /// Returns the fields of a text; none without a text.
    pub(super) const fn between_commas(text: Option<&'t str>) -> Self {
        Self(text)
    }
}

impl<'t> Iterator for Fields<'t> {
    type Item = &'t str;

    #[inline(never)]
    fn next(&mut self) -> Option<&'t str> {
        let text = self.0?;
        let (field, rest) = cut(text, b',').map_or((text, None), |(field, rest)| (field, Some(rest)));
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
            assert!(Fields::between_commas(Some(text)).eq(text.split(',')), "{text}");
        }
    }
}
