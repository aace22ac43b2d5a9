//! Rate of each sentence and message.
//!
//! `OUTPUT,item,n` sends an item with every n-th epoch, or never if n is 0. If the state of an
//! epoch is worse than that of the epoch before, every item with a nonzero rate is sent. The other
//! sentences of the module (`PRAIS`, `PRAIX`, `PRAIM`, `PRAIH`, `PRAIE`, `PRAIN`, and `PRAIQ` with
//! the settings) cannot be switched off.

/// Makes the items from their names, rates at start, and features.
macro_rules! items {
    ($($name:literal $item:ident = $at_start:literal $(if $feature:literal)?: $text:literal,)*) => {
        /// Sentence or message with an adjustable rate.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Item {
            $(#[doc = $text] $item,)*
        }

        impl Item {
            /// Every item, in the order of [`Schedule::rates`].
            pub const ALL: &'static [Self] = &[$(Self::$item,)*];

            /// Names of the items.
            pub const NAMES: &'static [&'static str] = &[$($name,)*];

            const AT_START: [u8; Self::ALL.len()] = [$(if Self::$item.is_built() { $at_start } else { 0 },)*];

            /// Returns true if the item is built in.
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
    "GNS" Gns = 1 if "sentences": "Position with the navigational status.",
    "VTG" Vtg = 1 if "sentences": "Velocity.",
    "ZDA" Zda = 1 if "sentences": "Date and time, once a second at most.",
    "GSA" Gsa = 1 if "sentences": "Satellites used.",
    "GST" Gst = 1 if "sentences": "Standard deviations.",
    "GBS" Gbs = 1 if "sentences": "The satellite that fits worst.",
    "GSV" Gsv = 0 if "gsv": "Satellites in view.",
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

/// Rate of each item: sent with every n-th epoch; 0 for never.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Schedule {
    every: [u8; Self::ITEMS],
}

impl Schedule {
    /// Number of items.
    pub const ITEMS: usize = Item::ALL.len();

    /// All sentences with every epoch except `GSV`, and no message of `MAVLink`.
    pub const AT_START: Self = Self { every: Item::AT_START };

    /// Returns the schedule with another rate of one item.
    #[must_use]
    pub fn with(mut self, item: Item, every: u8) -> Self {
        if let Some(slot) = self.every.get_mut(item as usize) {
            *slot = every;
        }
        self
    }

    /// Returns the name and the rate of each item.
    pub fn rates(&self) -> impl Iterator<Item = (&'static str, u8)> {
        Item::NAMES.iter().copied().zip(self.every)
    }

    /// Returns the items that are due with the epoch of this number.
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

/// Set of items.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Due(u16);

impl Due {
    /// Returns true if the item is in the set.
    pub const fn has(self, item: Item) -> bool {
        item.is_built() && self.0 >> item as u16 & 1 == 1
    }

    /// Returns the set without this item.
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
