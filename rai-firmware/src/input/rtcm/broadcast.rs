//! Messages of Kepler elements: 1019 of GPS, 1042 of `BeiDou`, 1044 of QZSS, 1045 and 1046 of
//! Galileo.
//!
//! All begin with the satellite number, and have the elements of the navigation message of their
//! system in another order. The tables below follow the standard. Reference: [RTCM-10403.3] 3.5.12.
//!
//! [RTCM-10403.3]: crate#references

use raim_core::satellite::SatelliteId;

use crate::ephemeris::{Broadcast, Health, Source, galileo_sisa_m, ura_m};
use crate::input::Unread;
use crate::input::bits::Bits;
use crate::input::calendar::Calendar;
use crate::input::calendar::MessageWeek;
use crate::input::elements::{BEIDOU, GALILEO, GPS, Head, Layout, Place, at, on};
use crate::raw::Band;

/// First bit of the satellite number.
const SATELLITE: usize = 12;

/// Layout of a message of elements.
struct Table {
    source: Source,
    bytes: usize,
    satellite_bits: usize,
    /// First bit and width of the week.
    week: (usize, usize),
    toe: (usize, usize),
    toc: (usize, usize),
    /// Step of the reference times, s.
    step_s: u32,
    layout: Layout,
}

const GPS_1019: Table = Table {
    source: Source::GpsLnav,
    bytes: 61,
    satellite_bits: 6,
    week: (18, 10),
    toe: (288, 16),
    toc: (56, 16),
    step_s: 16,
    layout: Layout {
        form: &GPS,
        ellipse: at([256, 208]),
        angles: at([160, 320, 368, 416]),
        rates: at([144, 448, 34]),
        angle_corrections: at([192, 240, 304, 352]),
        length_corrections: at([400, 128]),
        clock: at([96, 80, 72]),
        group_delays: [Some(on(0, 472)), None],
    },
};

const BEIDOU_1042: Table = Table {
    source: Source::BeidouD1D2,
    bytes: 64,
    satellite_bits: 6,
    week: (18, 13),
    toe: (299, 17),
    toc: (54, 17),
    step_s: 8,
    layout: Layout {
        form: &BEIDOU,
        ellipse: at([267, 217]),
        angles: at([167, 334, 384, 434]),
        rates: at([151, 466, 35]),
        angle_corrections: at([199, 249, 316, 366]),
        length_corrections: at([416, 133]),
        clock: at([104, 82, 71]),
        group_delays: [Some(on(0, 490)), Some(on(0, 500))],
    },
};

const QZSS_1044: Table = Table {
    source: Source::QzssLnav,
    bytes: 61,
    satellite_bits: 4,
    week: (446, 10),
    toe: (246, 16),
    toc: (16, 16),
    step_s: 16,
    layout: Layout {
        form: &GPS,
        ellipse: at([214, 166]),
        angles: at([118, 278, 326, 374]),
        rates: at([102, 406, 430]),
        angle_corrections: at([150, 198, 262, 310]),
        length_corrections: at([358, 86]),
        clock: at([56, 40, 32]),
        group_delays: [Some(on(0, 466)), None],
    },
};

const GALILEO_1045: Table = Table {
    source: Source::GalileoFnav,
    bytes: 62,
    satellite_bits: 6,
    week: (18, 12),
    toe: (294, 14),
    toc: (62, 14),
    step_s: 60,
    layout: galileo([Some(on(0, 476)), None]),
};

const GALILEO_1046: Table = Table {
    source: Source::GalileoInav,
    bytes: 63,
    layout: galileo([Some(on(0, 476)), Some(on(0, 486))]),
    ..GALILEO_1045
};

const fn galileo(group_delays: [Option<Place>; 2]) -> Layout {
    Layout {
        form: &GALILEO,
        ellipse: at([262, 214]),
        angles: at([166, 324, 372, 420]),
        rates: at([150, 452, 48]),
        angle_corrections: at([198, 246, 308, 356]),
        length_corrections: at([404, 134]),
        clock: at([103, 82, 76]),
        group_delays,
    }
}

/// Reads the message with one of these numbers.
pub(super) fn read(number: u16, payload: &[u8], calendar: &Calendar) -> Result<Broadcast, Unread> {
    let table = match number {
        1019 => &const { GPS_1019 },
        1042 => &const { BEIDOU_1042 },
        1044 => &const { QZSS_1044 },
        1045 => &const { GALILEO_1045 },
        _ => &const { GALILEO_1046 },
    };
    let bits = Bits(payload.get(..table.bytes).ok_or(Unread::Malformed)?);
    let satellite = table.satellite(bits)?;
    let week = MessageWeek { constellation: satellite.constellation(), week: field(bits, table.week) as u16 };
    let instant = |place| calendar.stated(week, table.step_s * field(bits, place)).ok_or(Unread::Ephemeris);
    let (health, accuracy_m) = promises(table.source, bits);
    let head = Head {
        satellite,
        source: table.source,
        health,
        accuracy_m,
        toe: instant(table.toe)?,
        toc: instant(table.toc)?,
    };
    Ok(table.layout.read(&head, &[bits]))
}

impl Table {
    fn satellite(&self, bits: Bits<'_>) -> Result<SatelliteId, Unread> {
        let number = bits.small(SATELLITE, self.satellite_bits);
        if self.source == Source::QzssLnav {
            return SatelliteId::qzss(number).ok_or(Unread::Satellite);
        }
        SatelliteId::new(self.source.constellation(), number).ok_or(Unread::Ephemeris)
    }
}

/// Returns the health, and the sigma of the ranges, m.
fn promises(source: Source, bits: Bits<'_>) -> (Health, Option<f32>) {
    // Two bits are the signal's health, and one is that of its data.
    let with = |health: Health, band, start| {
        health.with_galileo(band, bits.unsigned(start, 2), bits.is_set(start + 2))
    };
    match source {
        Source::GpsLnav => (Health::of_satellite(bits.unsigned(480, 6) == 0), ura_m(bits.small(28, 4))),
        Source::QzssLnav => (Health::of_qzss(bits.small(460, 6)), ura_m(bits.small(456, 4))),
        Source::BeidouD1D2 => (Health::of_satellite(!bits.is_set(510)), ura_m(bits.small(31, 4))),
        Source::GalileoFnav => (with(Health::UNKNOWN, Band::E5a, 486), galileo_sisa_m(bits.small(40, 8))),
        _ => (with(with(Health::UNKNOWN, Band::E5b, 496), Band::E1, 499), galileo_sisa_m(bits.small(40, 8))),
    }
}

fn field(bits: Bits<'_>, (start, width): (usize, usize)) -> u32 {
    bits.unsigned(start, width)
}
