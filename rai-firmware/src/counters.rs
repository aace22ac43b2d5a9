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

            /// Name and value of every counter, in the order of the fields.
            pub fn iter(&self) -> impl Iterator<Item = (&'static str, u32)> {
                [$((stringify!($field), self.$field),)*].into_iter()
            }
        }
    };
}

pub(crate) use counters;

/// One more, stopping at the largest value: a counter that wraps would tell that nothing happened.
pub(crate) fn count(counter: &mut u32) {
    count_many(counter, 1);
}

/// `many` more, stopping at the largest value.
pub(crate) fn count_many(counter: &mut u32, many: usize) {
    *counter = counter.saturating_add(u32::try_from(many).unwrap_or(u32::MAX));
}
