//! Layouts of the messages. No other file depends on the dialect.
//!
//! Fields are in the order of the wire: by size, the largest first, then in the order of the
//! definition. `crc_extra` is computed from the message's name and from the types and names of its
//! fields; a test repeats this. A change of the dialect changes `crc_extra`, so that a reader of
//! another revision refuses the message instead of misreading it.
//!
//! The dialect of `GNSS_INTEGRITY` is under review: [mavlink/rfcs#30] keeps the id and removes the
//! four qualities. This table and the order of the values must then change.

/// Definitions that the layouts follow.
pub const DIALECT: &str = "mavlink development.xml de1e078a (2026-07-22) and common.xml";

/// Type of a field on the wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Eight bits.
    U8,
    /// Sixteen bits.
    U16,
    /// Thirty-two bits.
    U32,
    /// Thirty-two bits with a sign.
    I32,
    /// Sixty-four bits.
    U64,
    /// Single precision.
    Float,
}

impl Kind {
    /// Returns the number of bytes on the wire.
    pub const fn bytes(self) -> usize {
        match self {
            Self::U8 => 1,
            Self::U16 => 2,
            Self::U32 | Self::I32 | Self::Float => 4,
            Self::U64 => 8,
        }
    }

    /// Returns the name in the definitions.
    pub const fn name(self) -> &'static str {
        match self {
            Self::U8 => "uint8_t",
            Self::U16 => "uint16_t",
            Self::U32 => "uint32_t",
            Self::I32 => "int32_t",
            Self::U64 => "uint64_t",
            Self::Float => "float",
        }
    }
}

/// Layout of a message.
#[derive(Clone, Copy, Debug)]
pub struct Layout {
    /// Name in the definitions.
    pub name: &'static str,
    /// Number of the message.
    pub id: u32,
    /// Seed of the checksum.
    pub crc_extra: u8,
    /// Fields in the order of the wire, without extensions. Readers take extensions that are not
    /// sent for zero.
    pub fields: &'static [(&'static str, Kind)],
}

/// `HEARTBEAT` of `minimal.xml`.
pub const HEARTBEAT: Layout = Layout {
    name: "HEARTBEAT",
    id: 0,
    crc_extra: 50,
    fields: &[
        ("custom_mode", Kind::U32),
        ("type", Kind::U8),
        ("autopilot", Kind::U8),
        ("base_mode", Kind::U8),
        ("system_status", Kind::U8),
        ("mavlink_version", Kind::U8),
    ],
};

/// `GPS_INPUT` of `common.xml`.
pub const GPS_INPUT: Layout = Layout {
    name: "GPS_INPUT",
    id: 232,
    crc_extra: 151,
    fields: &[
        ("time_usec", Kind::U64),
        ("time_week_ms", Kind::U32),
        ("lat", Kind::I32),
        ("lon", Kind::I32),
        ("alt", Kind::Float),
        ("hdop", Kind::Float),
        ("vdop", Kind::Float),
        ("vn", Kind::Float),
        ("ve", Kind::Float),
        ("vd", Kind::Float),
        ("speed_accuracy", Kind::Float),
        ("horiz_accuracy", Kind::Float),
        ("vert_accuracy", Kind::Float),
        ("ignore_flags", Kind::U16),
        ("time_week", Kind::U16),
        ("gps_id", Kind::U8),
        ("fix_type", Kind::U8),
        ("satellites_visible", Kind::U8),
    ],
};

/// `GNSS_INTEGRITY` of `development.xml`.
pub const GNSS_INTEGRITY: Layout = Layout {
    name: "GNSS_INTEGRITY",
    id: 441,
    crc_extra: 169,
    fields: &[
        ("system_errors", Kind::U32),
        ("raim_hfom", Kind::U16),
        ("raim_vfom", Kind::U16),
        ("id", Kind::U8),
        ("authentication_state", Kind::U8),
        ("jamming_state", Kind::U8),
        ("spoofing_state", Kind::U8),
        ("raim_state", Kind::U8),
        ("corrections_quality", Kind::U8),
        ("system_status_summary", Kind::U8),
        ("gnss_signal_quality", Kind::U8),
        ("post_processing_quality", Kind::U8),
    ],
};

#[cfg(test)]
mod tests {
    use super::super::frame::Checksum;
    use super::*;

    /// The serialization guide states the rule: checksum of the name, and of type and name of each
    /// field, folded into a byte.
    #[test]
    fn the_seed_of_each_checksum_follows_from_its_layout() {
        for layout in [HEARTBEAT, GPS_INPUT, GNSS_INTEGRITY] {
            let mut sum = Checksum::new();
            let mut words = std::vec![layout.name];
            words.extend(layout.fields.iter().flat_map(|(name, kind)| [kind.name(), *name]));
            for word in words {
                word.bytes().chain(*b" ").for_each(|byte| sum.push(byte));
            }
            let have = (sum.value() & 0xFF) as u8 ^ (sum.value() >> 8) as u8;
            assert_eq!(have, layout.crc_extra, "{}", layout.name);
        }
    }

    #[test]
    fn fields_stand_in_the_order_of_the_wire() {
        for (layout, want) in [(HEARTBEAT, 9), (GPS_INPUT, 63), (GNSS_INTEGRITY, 17)] {
            let widths = layout.fields.iter().map(|(_, kind)| kind.bytes());
            assert!(widths.clone().is_sorted_by(|a, b| a >= b), "{}", layout.name);
            assert_eq!(widths.sum::<usize>(), want, "{}", layout.name);
        }
    }
}
