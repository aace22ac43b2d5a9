//! How often each sentence and message is sent.
//!
//! `OUTPUT,item,n` sends an item with every n-th epoch, or never with 0; and with an epoch whose state is worse than that of
//! the one before. The sentences that say whether the position may be used (`PRAIS`, `PRAIX`, `PRAIM`, `PRAIN`) and those of
//! the settings cannot be switched off.
//!
//! | item | at start |
//! |---|---|
//! | `RMC`, `GGA`, `GNS`, `VTG`, `GSA`, `GST`, `GBS` | 1 |
//! | `ZDA`: with every n-th epoch, once a second at most | 1 |
//! | `HEARTBEAT`, `GPS_INPUT`, `GNSS_INTEGRITY`: `MAVLink` | 0 |

/// Something that can be sent more or less often.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Item {
    /// Position, velocity and date.
    Rmc,
    /// Position.
    Gga,
    /// Position with the navigational status.
    Gns,
    /// Velocity.
    Vtg,
    /// Date and time.
    Zda,
    /// Satellites used.
    Gsa,
    /// Standard deviations.
    Gst,
    /// The satellite that fits worst.
    Gbs,
    /// `MAVLink`: that somebody is there.
    Heartbeat,
    /// `MAVLink`: a position for an autopilot.
    GpsInput,
    /// `MAVLink`: whether it may be used.
    GnssIntegrity,
}

/// All items with their names, in the order of [`Schedule::rates`].
const ITEMS: [(&str, Item); Schedule::ITEMS] = [
    ("RMC", Item::Rmc),
    ("GGA", Item::Gga),
    ("GNS", Item::Gns),
    ("VTG", Item::Vtg),
    ("ZDA", Item::Zda),
    ("GSA", Item::Gsa),
    ("GST", Item::Gst),
    ("GBS", Item::Gbs),
    ("HEARTBEAT", Item::Heartbeat),
    ("GPS_INPUT", Item::GpsInput),
    ("GNSS_INTEGRITY", Item::GnssIntegrity),
];

impl Item {
    /// Is it built in?
    pub const fn is_built(self) -> bool {
        !matches!(self, Self::Heartbeat | Self::GpsInput | Self::GnssIntegrity) || cfg!(feature = "mavlink")
    }

    /// The item of this name.
    pub fn named(name: &str) -> Option<Self> {
        ITEMS.iter().find(|(known, _)| *known == name).map(|(_, item)| *item)
    }
}

/// Every how many epochs each item is sent; 0 for never.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Schedule {
    every: [u8; Self::ITEMS],
}

impl Schedule {
    /// How many items there are.
    pub const ITEMS: usize = 11;

    /// All sentences with every epoch, no message of `MAVLink`.
    pub const AT_START: Self = Self { every: [1, 1, 1, 1, 1, 1, 1, 1, 0, 0, 0] };

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
        ITEMS.iter().zip(self.every).map(|((name, _), every)| (*name, every))
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
        for (index, (name, item)) in ITEMS.iter().enumerate() {
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
