//! How often each sentence and message is sent.
//!
//! `OUTPUT,item,n` sends an item with every n-th epoch, or never with 0; and with an epoch whose
//! state is worse than that of the one before. The sentences that say whether the position may be
//! used (`PRAIS`, `PRAIX`, `PRAIM`, `PRAIN`) and those of the settings cannot be switched off.

/// Makes the items out of their names, rates at start, and features.
macro_rules! items {
    ($($name:literal $item:ident = $at_start:literal $(if $feature:literal)?: $text:literal,)*) => {
        /// Item that the module sends more or less often.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Item {
            $(#[doc = $text] $item,)*
        }

        impl Item {
            /// Every item, in the order of [`Schedule::rates`].
            pub const ALL: &'static [Self] = &[$(Self::$item,)*];

            /// Their names.
            pub const NAMES: &'static [&'static str] = &[$($name,)*];

            const AT_START: [u8; Self::ALL.len()] = [$($at_start,)*];

            /// Returns true for an item that is built in.
            pub const fn is_built(self) -> bool {
                match self {
                    $(Self::$item => true $(&& cfg!(feature = $feature))?,)*
                }
            }
        }
    };
}

items! {
    "RMC" Rmc = 1: "Position, velocity and date.",
    "GGA" Gga = 1: "Position.",
    "GNS" Gns = 1: "Position with the navigational status.",
    "VTG" Vtg = 1: "Velocity.",
    "ZDA" Zda = 1: "Date and time, once a second at most.",
    "GSA" Gsa = 1: "Satellites used.",
    "GST" Gst = 1: "Standard deviations.",
    "GBS" Gbs = 1: "The satellite that fits worst.",
    "HEARTBEAT" Heartbeat = 0 if "mavlink": "`MAVLink`: the module is there.",
    "GPS_INPUT" GpsInput = 0 if "mavlink": "`MAVLink`: a position for an autopilot.",
    "GNSS_INTEGRITY" GnssIntegrity = 0 if "mavlink": "`MAVLink`: use of the position.",
}

impl Item {
    /// Returns the item of this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().zip(Self::NAMES).find(|(_, known)| **known == name).map(|(item, _)| *item)
    }
}

/// Every how many epochs each item is sent; 0 for never.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Schedule {
    every: [u8; Self::ITEMS],
}

impl Schedule {
    /// How many items there are.
    pub const ITEMS: usize = Item::ALL.len();

    /// All sentences with every epoch, no message of `MAVLink`.
    pub const AT_START: Self = Self { every: Item::AT_START };

    /// With another rate of one item.
    #[must_use]
    pub fn with(mut self, item: Item, every: u8) -> Self {
        if let Some(slot) = self.every.get_mut(item as usize) {
            *slot = every;
        }
        self
    }

    /// Every how many epochs, item by item, with their names.
    pub fn rates(&self) -> impl Iterator<Item = (&'static str, u8)> {
        Item::NAMES.iter().copied().zip(self.every)
    }

    /// What is due with the epoch of this number.
    pub fn due(&self, epoch: u32) -> Due {
        let is_due = |every: &u8| *every > 0 && epoch.is_multiple_of(u32::from(*every));
        Due(self
            .every
            .iter()
            .enumerate()
            .filter(|(_, every)| is_due(every))
            .fold(0, |set, (bit, _)| set | 1 << bit))
    }
}

/// A set of items.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Due(u16);

impl Due {
    /// Is this item in the set?
    pub const fn has(self, item: Item) -> bool {
        self.0 >> item as u16 & 1 == 1
    }

    /// The set without this item.
    #[must_use]
    pub const fn without(self, item: Item) -> Self {
        Self(self.0 & !(1 << item as u16))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_stand_in_the_order_of_their_numbers() {
        for (index, (name, item)) in Item::NAMES.iter().zip(Item::ALL).enumerate() {
            assert_eq!((*item as usize, Item::named(name)), (index, Some(*item)));
        }
    }

    #[test]
    fn an_item_is_due_with_every_nth_epoch() {
        let schedule = Schedule::AT_START.with(Item::Gsa, 5).with(Item::Rmc, 0).with(Item::GpsInput, 2);
        for epoch in 0..20 {
            let due = schedule.due(epoch);
            assert!(due.has(Item::Gns) && !due.has(Item::Rmc) && !due.has(Item::Heartbeat));
            assert_eq!((due.has(Item::Gsa), due.has(Item::GpsInput)), (epoch % 5 == 0, epoch % 2 == 0));
        }
    }
}
