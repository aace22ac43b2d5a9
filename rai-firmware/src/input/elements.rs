//! Orbital elements in navigation messages: one table of places for each message, and one reader
//! for all messages.
//!
//! Every system sends the same elements, with its widths and units ([`Form`]). Every message has
//! them in a different order ([`Layout`]). References: [IS-GPS-200] 20.3.3.3 and 20.3.3.4;
//! [OS-SIS-ICD] 5.1; [BDS-SIS-B1I] 5.2.4.
//!
//! [IS-GPS-200]: crate#references
//! [OS-SIS-ICD]: crate#references
//! [BDS-SIS-B1I]: crate#references

use raim_core::satellite::SatelliteId;

use super::bits::{Bits, joined};
use crate::ephemeris::{Broadcast, Health, Source, times_power_of_two};
use crate::time::GpsTime;

/// Place of an element.
#[derive(Clone, Copy)]
pub(super) struct Place {
    /// Page, from 0.
    page: u8,
    /// Number of last bits that are on the next page, from bit [`Self::BEHIND`] on.
    behind: u8,
    /// First bit.
    start: u16,
}

/// Width of a number, bits, and the power of two of its unit.
type Number = (usize, i32);

/// Numbers that differ by system.
pub(super) struct Form {
    /// `Cuc`, `Cus`, `Cic`, `Cis`, rad.
    angle_correction: Number,
    /// `Crc`, `Crs`, m.
    length_correction: Number,
    /// `af0` to `af2`.
    clock: [Number; 3],
    /// Width of a group delay, bits, and its unit, s.
    group_delay: (usize, f32),
}

/// Numbers of all systems: `√A`, m^½; `e`; angles, semicircles; `Δn`, `Ω̇` and `i̇`, semicircles/s.
const SQRT_A: Number = (32, -19);
const ECCENTRICITY: Number = (32, -33);
const ANGLE: Number = (32, -31);
const MOTION: Number = (16, -43);
const NODE_RATE: Number = (24, -43);
const INCLINATION_RATE: Number = (14, -43);

/// GPS and QZSS.
pub(super) const GPS: Form = Form {
    angle_correction: (16, -29),
    length_correction: (16, -5),
    clock: [(22, -31), (16, -43), (8, -55)],
    group_delay: (8, times_power_of_two(1.0, -31) as f32),
};

/// Galileo.
pub(super) const GALILEO: Form = Form {
    angle_correction: (16, -29),
    length_correction: (16, -5),
    clock: [(31, -34), (21, -46), (6, -59)],
    group_delay: (10, times_power_of_two(1.0, -32) as f32),
};

/// `BeiDou`.
pub(super) const BEIDOU: Form = Form {
    angle_correction: (18, -31),
    length_correction: (18, -6),
    clock: [(24, -33), (22, -50), (11, -66)],
    group_delay: (10, 1e-10),
};

/// Places of the elements in a message.
pub(super) struct Layout {
    pub(super) form: &'static Form,
    /// `√A` and `e`.
    pub(super) ellipse: [Place; 2],
    /// `M0`, `Ω0`, `i0` and `ω`.
    pub(super) angles: [Place; 4],
    /// `Δn`, `Ω̇` and `i̇`.
    pub(super) rates: [Place; 3],
    /// `Cuc`, `Cus`, `Cic` and `Cis`.
    pub(super) angle_corrections: [Place; 4],
    /// `Crc` and `Crs`.
    pub(super) length_corrections: [Place; 2],
    /// `af0`, `af1` and `af2`.
    pub(super) clock: [Place; 3],
    pub(super) group_delays: [Option<Place>; 2],
}

/// Values of a message other than its elements, which each message codes differently.
pub(super) struct Head {
    pub(super) satellite: SatelliteId,
    pub(super) source: Source,
    pub(super) health: Health,
    pub(super) accuracy_m: Option<f32>,
    pub(super) toe: GpsTime,
    pub(super) toc: GpsTime,
}

/// Returns a place on a page.
pub(super) const fn on(page: u8, start: u16) -> Place {
    Place { page, behind: 0, start }
}

/// Returns places on the only page of a message.
pub(super) const fn at<const N: usize>(starts: [u16; N]) -> [Place; N] {
    let (mut places, mut index) = ([on(0, 0); N], 0);
    while index < N {
        places[index] = on(0, starts[index]);
        index += 1;
    }
    places
}

impl Place {
    /// First bit of a continuation on the next page. Only D2 of `BeiDou` has such elements.
    const BEHIND: usize = 42;

    /// Returns the place with this number of its last bits on the next page.
    pub(super) const fn behind(self, behind: u8) -> Self {
        Self { behind, ..self }
    }

    #[inline(never)]
    fn signed(self, pages: &[Bits<'_>], width: usize) -> i32 {
        let page = |index: u8| pages.get(usize::from(index)).copied().unwrap_or(Bits(&[]));
        let (here, behind) = (page(self.page), usize::from(self.behind));
        let upper = here.signed(usize::from(self.start), width - behind);
        if behind == 0 {
            return upper;
        }
        joined(upper, page(self.page + 1).unsigned(Self::BEHIND, behind), behind)
    }

    #[inline(never)]
    fn scaled(self, pages: &[Bits<'_>], (width, exponent): Number) -> f64 {
        times_power_of_two(f64::from(self.signed(pages, width)), exponent)
    }

    /// Reads an unsigned number of 32 bits.
    fn positive(self, pages: &[Bits<'_>], (width, exponent): Number) -> f64 {
        times_power_of_two(f64::from(self.signed(pages, width).cast_unsigned()), exponent)
    }
}

impl Layout {
    /// Reads the message with these pages.
    #[inline(never)]
    pub(super) fn read(&self, head: &Head, pages: &[Bits<'_>]) -> Broadcast {
        let form = self.form;
        let scaled = |place: Place, number| place.scaled(pages, number);
        let [sqrt_a, eccentricity] = self.ellipse;
        let [m0_sc, omega0_sc, i0_sc, omega_sc] = self.angles.map(|place| scaled(place, ANGLE));
        let [motion, node_rate, inclination_rate] = self.rates;
        // Single precision represents the corrections exactly.
        let [cuc_rad, cus_rad, cic_rad, cis_rad] =
            self.angle_corrections.map(|place| scaled(place, form.angle_correction) as f32);
        let [crc_m, crs_m] =
            self.length_corrections.map(|place| scaled(place, form.length_correction) as f32);
        let [af0, af1, af2] = self.clock;
        let [af0_number, af1_number, af2_number] = form.clock;
        let (width, unit_s) = form.group_delay;
        let group_delay =
            |place: Option<Place>| place.map_or(0.0, |place| place.signed(pages, width) as f32 * unit_s);
        Broadcast {
            satellite: head.satellite,
            source: head.source,
            health: head.health,
            accuracy_m: head.accuracy_m,
            toe: head.toe,
            // A set has one week number for `toe` and `toc`, which near the end of a week is right
            // for only one.
            toc: GpsTime::nearest(head.toc.tow_ms, head.toe),
            sqrt_a_sqrt_m: sqrt_a.positive(pages, SQRT_A),
            eccentricity: eccentricity.positive(pages, ECCENTRICITY),
            m0_sc,
            omega0_sc,
            i0_sc,
            omega_sc,
            delta_n_sc_s: scaled(motion, MOTION),
            omegadot_sc_s: scaled(node_rate, NODE_RATE),
            idot_sc_s: scaled(inclination_rate, INCLINATION_RATE),
            cuc_rad,
            cus_rad,
            crc_m,
            crs_m,
            cic_rad,
            cis_rad,
            af0_s: scaled(af0, af0_number),
            af1_s_s: scaled(af1, af1_number),
            af2_s_s2: scaled(af2, af2_number),
            group_delays_s: self.group_delays.map(group_delay),
        }
    }
}
