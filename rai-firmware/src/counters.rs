//! Named counters: every input that is not used says why, and the host can ask.

/// A struct of saturating `u32` counters whose field names are also text.
macro_rules! counters {
    ($(#[$of_struct:meta])* $name:ident { $($(#[$of_field:meta])* $field:ident,)* }) => {
        $(#[$of_struct])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        #[cfg_attr(all(target_os = "none", feature = "cortex-m-board"), derive(defmt::Format))]
        pub struct $name {
            $($(#[$of_field])* pub $field: u32,)*
        }

        impl $name {
            /// Nothing has happened yet.
            pub const NONE: Self = Self { $($field: 0,)* };

            const NAMES: &'static [&'static str] = &[$(stringify!($field),)*];

            /// Name and value of every counter, in the order of the fields.
            pub fn iter(&self) -> impl Iterator<Item = (&'static str, u32)> {
                Self::NAMES.iter().copied().zip(self.values())
            }

            /// The values in the order of the fields.
            fn values(&self) -> [u32; Self::NAMES.len()] {
                [$(self.$field,)*]
            }

            /// The counter of a number; where there are not as many, the number falls by how many there are.
            pub(crate) fn at(&self, number: &mut usize) -> Option<(&'static str, u32)> {
                $crate::counters::at(Self::NAMES, &self.values(), number)
            }
        }
    };
}

pub(crate) use counters;

/// The counter of a number; where there are not as many, the number falls by how many there are.
#[inline(never)]
pub(crate) fn at(names: &[&'static str], values: &[u32], number: &mut usize) -> Option<(&'static str, u32)> {
    let found = names.get(*number).copied().zip(values.get(*number).copied());
    *number = number.saturating_sub(names.len());
    found
}

/// One more, stopping at the largest value: a counter that wraps would tell that nothing happened.
// Not inlined: it is called in many places, and flash is dearer than the calls.
#[inline(never)]
pub(crate) fn count(counter: &mut u32) {
    *counter = counter.saturating_add(1);
}

/// `many` more, stopping at the largest value.
pub(crate) fn count_many(counter: &mut u32, many: usize) {
    *counter = counter.saturating_add(u32::try_from(many).unwrap_or(u32::MAX));
}
