//! The macro that makes settings from rows, and their documentation.

/// Makes the key, the field and the documentation of each setting from its row.
///
/// A row names its columns, so that a row without one of them does not compile.
macro_rules! settings {
    ($(
        $(#[cfg($condition:meta)])?
        $key:literal $setting:ident {
            $field:ident: $value:ty = $at_start:expr,
            ranges: $ranges:expr,
            unit: $unit:literal,
            fields: $fields:literal,
            promise: $promise:literal,
            phase: $phase:ident,
            warning: $warning:expr,
            example: $example:literal,
            text: $text:literal,
        }
    )*) => {
        /// Key of a setting.
        #[allow(clippy::doc_markdown, reason = "the text is that of a document")]
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[non_exhaustive]
        pub enum Setting {
            $($(#[cfg($condition)])? #[doc = $text] $setting,)*
            /// No setting: a variant with a value, so that the others have no numbers, which a new row
            /// of the table would change.
            #[doc(hidden)]
            Unnumbered(core::convert::Infallible),
        }

        /// Everything that a command can change.
        #[allow(clippy::doc_markdown, reason = "the text is that of a document")]
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[non_exhaustive]
        pub struct Configuration {
            $($(#[cfg($condition)])? #[doc = $text] pub $field: $value,)*
        }

        impl Setting {
            /// Every setting, in the order of the table.
            pub const ALL: &'static [Self] = &[$($(#[cfg($condition)])? Self::$setting,)*];

            /// Returns the row of the setting.
            // Not inlined, because each caller would have its own copy of the table.
            #[inline(never)]
            pub const fn row(self) -> &'static Row {
                match self {
                    $($(#[cfg($condition)])? Self::$setting => {
                        const ROW: Row = Row {
                            key: $key,
                            ranges: $ranges,
                            bears_on_promise: $promise,
                            phase: PhaseEffect::$phase,
                            warning: $warning,
                        };
                        const {
                            assert!(ROW.ranges.len() == <$value as Spelled>::RANGES, "one range a number");
                        }
                        &ROW
                    })*
                }
            }

            /// Returns the documentation of the setting. The image does not contain it.
            pub const fn documentation(self) -> &'static Documentation {
                match self {
                    $($(#[cfg($condition)])? Self::$setting => &Documentation {
                        text: $text,
                        unit: $unit,
                        fields: $fields,
                        example: $example,
                        words: <$value as Spelled>::WORDS,
                    },)*
                }
            }
        }

        impl Configuration {
            /// Returns the settings at start.
            pub const fn at_start() -> Self {
                Self { $($(#[cfg($condition)])? $field: $at_start,)* }
            }

            pub(super) fn value(&self, setting: Setting) -> &dyn Value {
                match setting {
                    $($(#[cfg($condition)])? Setting::$setting => &self.$field,)*
                }
            }

            pub(super) fn value_mut(&mut self, setting: Setting) -> &mut dyn Value {
                match setting {
                    $($(#[cfg($condition)])? Setting::$setting => &mut self.$field,)*
                }
            }
        }
    };
}

pub(super) use settings;
