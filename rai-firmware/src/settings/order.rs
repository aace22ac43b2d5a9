//! Orders: commands without a value, which the receiver carries out.

/// Makes the orders out of their keys.
macro_rules! orders {
    ($($key:literal $order:ident: $text:literal,)*) => {
        /// Order of the host.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Order {
            $(#[doc = $text] $order,)*
        }

        impl Order {
            /// Every order.
            pub const ALL: &'static [Self] = &[$(Self::$order,)*];

            /// Returns the key on the wire.
            pub const fn key(self) -> &'static str {
                match self {
                    $(Self::$order => $key,)*
                }
            }

            /// Returns one line for INTERFACES.md, which a test compares.
            pub const fn text(self) -> &'static str {
                match self {
                    $(Self::$order => $text,)*
                }
            }
        }
    };
}

orders! {
    "STATS" Statistics: "[Counters](#counters) by name, in as many answers as they need",
    "SELFTEST" SelfTest: "[Known answers](#self-test) are computed again",
    "CONFIRM" Confirm: "The settings in force are meant",
    "FORGET" Forget: "The module forgets the last position, the delays of epochs, the time, the source of the ranges, and the receiver's word on jamming and spoofing",
    "RESET" Reset: "The module starts again, with the pin low",
}

impl Order {
    /// Returns the order with this key.
    pub fn named(key: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|order| order.key() == key)
    }
}
