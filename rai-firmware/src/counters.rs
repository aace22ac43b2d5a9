//! Named counters: all unused input is counted by its reason, and the host can ask for the counts.

/// Declares a struct of saturating `u32` counters whose field names are also text. `["feature"]`
/// before a field leaves it out of builds without the feature.
macro_rules! counters {
    ($(#[$of_struct:meta])* $name:ident { $($(#[$of_field:meta])* $([$feature:literal])? $field:ident,)* }) => {
        $(#[$of_struct])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        #[non_exhaustive]
        pub struct $name {
            $($(#[$of_field])* $(#[cfg(feature = $feature)])? pub $field: u32,)*
        }

        impl $name {
            /// All counters at zero.
            pub const NONE: Self = Self { $($(#[cfg(feature = $feature)])? $field: 0,)* };

            const NAMES: &'static [&'static str] = &[$($(#[cfg(feature = $feature)])? stringify!($field),)*];

            /// Iterates over name and value of every counter, in the order of the fields.
            pub fn iter(&self) -> impl Iterator<Item = (&'static str, u32)> {
                Self::NAMES.iter().copied().zip(self.values())
            }

            /// Returns the values in the order of the fields.
            fn values(&self) -> [u32; Self::NAMES.len()] {
                [$($(#[cfg(feature = $feature)])? self.$field,)*]
            }

            /// Returns counter `number`, or `None` beyond the last, with `number` reduced by the
            /// number of counters.
            pub(crate) fn at(&self, number: &mut usize) -> Option<(&'static str, u32)> {
                $crate::counters::at(Self::NAMES, &self.values(), number)
            }
        }
    };
}

pub(crate) use counters;

/// Returns counter `number`, or `None` beyond the last, with `number` reduced by the number of
/// counters.
#[inline(never)]
pub(crate) fn at(names: &[&'static str], values: &[u32], number: &mut usize) -> Option<(&'static str, u32)> {
    let found = names.get(*number).copied().zip(values.get(*number).copied());
    *number = number.saturating_sub(names.len());
    found
}

/// Adds one, up to the largest value. A counter that wraps would suggest that nothing happened.
// Not inlined, because it has many callers and flash is scarcer than time.
#[inline(never)]
pub(crate) fn count(counter: &mut u32) {
    *counter = counter.saturating_add(1);
}

/// Adds `many`, up to the largest value.
pub(crate) fn count_many(counter: &mut u32, many: usize) {
    *counter = counter.saturating_add(u32::try_from(many).unwrap_or(u32::MAX));
}
