//! Records of Kepler elements to messages.
//!
//! Read row by row a record is `[af0 af1 af2 | row 1 | row 2 | …]` with four numbers in each row;
//! which is which depends on the system:
//!
//! | row | GPS LNAV | Galileo I/NAV, F/NAV | `BeiDou` D1, D2 |
//! |---|---|---|---|
//! | 1 | IODE, Crs, Δn, M₀ | `IODnav`, … | AODE, … |
//! | 2 | Cuc, e, Cus, √a | same | same |
//! | 3 | toe, Cic, Ω₀, Cis | same | same |
//! | 4 | i₀, Crc, ω, Ω̇ | same | same |
//! | 5 | İ, L2 codes, week, L2 P flag | İ, source, week | İ, –, week |
//! | 6 | accuracy, health, TGD, IODC | accuracy, health, BGD E5a, BGD E5b | accuracy, health, TGD1, TGD2 |
//! | 7 | sent at, fit interval | sent at | sent at, AODC |
//!
//! RINEX has radians where messages have semicircles, metres where they have accuracy indices.
//! Weeks are taken from the date of the time of clock, which is unambiguous, and not from row 5,
//! where files differ in what they count from. Times that a file does not know (0.9999e9 s) or that
//! are half a week off are replaced by the time of clock.
//!
//! QZSS has the rows of GPS. References: [RINEX-2.11] table A4, [RINEX-3.05] tables A6, A8, A14,
//! [RINEX-4.01] tables A8 to A18.
//!
//! [RINEX-2.11]: crate#references
//! [RINEX-3.05]: crate#references
//! [RINEX-4.01]: crate#references

use std::f64::consts::PI;

use anyhow::{Context, Result, ensure};
use raim_core::satellite::{Constellation, SatelliteId};
use raim_firmware::time::{BEIDOU_OFFSET_MS, BEIDOU_WEEK_OFFSET, GALILEO_WEEK_OFFSET, GpsTime};
use rtcm_rs::msg::{Msg1019T, Msg1042T, Msg1044T, Msg1045T, Msg1046T};

use crate::signal::calendar::{self, TimeSystem};
use crate::signal::measurement::{Ephemeris, TimedEphemeris};

/// Largest magnitudes by row and column that any of the messages has room for, in the file's units.
///
/// The bits and scale factors are those of [IS-GPS-200] tables 20-I and 20-III,
/// [Galileo-OS-SIS-ICD] tables 60 and 63 and [BDS-SIS-ICD] tables 5-8 and 5-10; the widest counts.
///
/// [IS-GPS-200]: crate#references
/// [Galileo-OS-SIS-ICD]: crate#references
/// [BDS-SIS-ICD]: crate#references
const LIMITS: [(usize, usize, f64); 14] = [
    (1, 1, 2048.0),
    (1, 2, 1.3e-8),
    (1, 3, 2.0 * PI),
    (2, 0, 6.2e-5),
    (2, 2, 6.2e-5),
    (2, 3, 8192.0),
    (3, 1, 6.2e-5),
    (3, 2, 2.0 * PI),
    (3, 3, 6.2e-5),
    (4, 0, 2.0 * PI),
    (4, 1, 2048.0),
    (4, 2, 2.0 * PI),
    (4, 3, 3.1e-6),
    (5, 0, 3.1e-9),
];

/// One ephemeris record as numbers.
pub(super) struct Record {
    pub(super) satellite: SatelliteId,
    /// Time of clock.
    pub(super) toc: GpsTime,
    pub(super) system: TimeSystem,
    pub(super) values: Vec<f64>,
}

impl Record {
    /// The number in a row from 1 and a column from 0.
    fn at(&self, row: usize, column: usize) -> f64 {
        self.values.get(4 * row - 1 + column).copied().unwrap_or(0.0)
    }

    /// An angle in semicircles.
    fn semicircles(&self, row: usize, column: usize) -> f64 {
        self.at(row, column) / PI
    }

    /// Checks that the fields of the messages have room for the numbers: a larger one was not
    /// broadcast.
    fn check(&self) -> Result<()> {
        for (row, column, limit) in LIMITS {
            let value = self.at(row, column);
            ensure!(value.abs() <= limit, "{}: {value:e} is beyond {limit:e}", self.satellite);
        }
        let eccentricity = self.at(2, 1);
        ensure!((0.0..=0.5).contains(&eccentricity), "{}: eccentricity {eccentricity:e}", self.satellite);
        let clock = self.values.iter().take(3).zip([0.0625, 1.5e-8, 3.6e-15]);
        ensure!(clock.clone().all(|(value, limit)| value.abs() <= limit), "{}: clock", self.satellite);
        Ok(())
    }

    /// Returns the ephemeris.
    ///
    /// # Errors
    /// A number that no message has room for, or a toe that is no time of a week.
    pub(super) fn timed(&self) -> Result<TimedEphemeris> {
        self.check()?;
        let toe = calendar::nearest_week(self.at(3, 0), self.toc, self.system)
            .context("toe is no time of a week")?;
        Ok(TimedEphemeris { satellite: self.satellite, toe, sent: self.sent(), message: self.message(toe) })
    }

    /// Returns the time at which the satellite sent the set.
    fn sent(&self) -> GpsTime {
        const WEEK_S: f64 = 604_800.0;
        // Message times of the week before the week of the reference time are written negative by
        // some.
        let known = Some(self.at(7, 0)).filter(|tow_s| (-WEEK_S..=WEEK_S).contains(tow_s) && *tow_s != 0.0);
        known.and_then(|tow_s| calendar::nearest_week(tow_s, self.toc, self.system)).unwrap_or(self.toc)
    }

    fn message(&self, toe: GpsTime) -> Ephemeris {
        // Bit 1 of the source marks F/NAV of E5a.
        let is_fnav = self.at(5, 1) as u32 & 0b10 != 0;
        match self.satellite.constellation() {
            Constellation::Beidou => Ephemeris::Beidou(self.beidou(toe)),
            Constellation::Galileo if is_fnav => Ephemeris::GalileoFnav(self.galileo_fnav(toe)),
            Constellation::Galileo => Ephemeris::GalileoInav(self.galileo_inav(toe)),
            _ if self.satellite.is_qzss() => Ephemeris::Qzss(self.qzss(toe)),
            _ => Ephemeris::Gps(self.gps(toe)),
        }
    }
}

/// A message from a record: the fields that all systems share, then the system's own.
macro_rules! message {
    ($type:ident of $record:ident, $id:ident, clock: [$af0:ident, $af1:ident, $af2:ident], $($field:ident: $value:expr,)*) => {{
        let (record, system_tow) = ($record, |time: GpsTime| $record.system_tow_s(time));
        $type {
            $id: record.satellite.name().1,
            toc_s: system_tow(record.toc),
            $af0: record.values[0],
            $af1: record.values[1] as _,
            $af2: record.values[2] as _,
            crs_m: record.at(1, 1) as _,
            delta_n_sc_s: record.semicircles(1, 2) as _,
            m0_sc: record.semicircles(1, 3),
            cuc_rad: record.at(2, 0) as _,
            eccentricity: record.at(2, 1),
            cus_rad: record.at(2, 2) as _,
            sqrt_a_sqrt_m: record.at(2, 3),
            toe_s: record.at(3, 0) as _,
            cic_rad: record.at(3, 1) as _,
            omega0_sc: record.semicircles(3, 2),
            cis_rad: record.at(3, 3) as _,
            i0_sc: record.semicircles(4, 0),
            crc_m: record.at(4, 1) as _,
            omega_sc: record.semicircles(4, 2),
            omegadot_sc_s: record.semicircles(4, 3),
            idot_sc_s: record.semicircles(5, 0) as _,
            $($field: $value,)*
        }
    }};
}

impl Record {
    /// Seconds into the week of the satellite's own system.
    fn system_tow_s(&self, time: GpsTime) -> f32 {
        (self.system_time(time).tow_ms / 1000) as f32
    }

    /// An instant as the satellite's own system counts, weeks still those of GPS.
    fn system_time(&self, time: GpsTime) -> GpsTime {
        match self.system {
            TimeSystem::Beidou => GpsTime::from_ms(time.to_ms().saturating_sub(u64::from(BEIDOU_OFFSET_MS))),
            _ => time,
        }
    }

    fn gps(&self, toe: GpsTime) -> Msg1019T {
        message!(Msg1019T of self, gps_satellite_id, clock: [af0_s, af1_s_s, af2_s_s2],
            gps_week_number: toe.week % 1024,
            ura_index: ura_index(self.at(6, 0)),
            code_on_l2_ind: self.at(5, 1) as u8 & 3,
            iode: self.at(1, 0) as u8,
            iodc: self.at(6, 3) as u16 & 1023,
            tgd_s: self.at(6, 2) as f32,
            sv_health_ind: self.at(6, 1) as u8 & 63,
            l2_p_data_flag: self.at(5, 3) as u8 & 1,
            fit_interval_ind: u8::from(self.at(7, 1) > 4.0),
        )
    }

    /// Makes the message of QZSS: that of GPS, with a flag for a fit interval beyond two hours.
    fn qzss(&self, toe: GpsTime) -> Msg1044T {
        message!(Msg1044T of self, qzss_satellite_id, clock: [af0_s, af1_s_s, af2_s_s2],
            qzss_week_number: toe.week % 1024,
            ura_index: ura_index(self.at(6, 0)),
            code_on_l2_ind: self.at(5, 1) as u8 & 3,
            iode: self.at(1, 0) as u8,
            iodc: self.at(6, 3) as u16 & 1023,
            tgd_s: self.at(6, 2) as f32,
            sv_health_ind: self.at(6, 1) as u8 & 63,
            fit_interval_ind: u8::from(self.at(7, 1) != 0.0),
        )
    }

    fn beidou(&self, toe: GpsTime) -> Msg1042T {
        message!(Msg1042T of self, bds_satellite_id, clock: [a0_s, a1_s_s, a2_s_s2],
            bds_week_number: self.system_time(toe).week.saturating_sub(BEIDOU_WEEK_OFFSET),
            ura_index: ura_index(self.at(6, 0)),
            aode: self.at(1, 0) as u8 & 31,
            aodc: self.at(7, 1) as u8 & 31,
            tgd1_s: self.at(6, 2) as f32,
            tgd2_s: self.at(6, 3) as f32,
            sv_health_flag: u8::from(self.at(6, 1) != 0.0),
        )
    }

    fn galileo_inav(&self, toe: GpsTime) -> Msg1046T {
        let health = self.at(6, 1) as u16;
        message!(Msg1046T of self, gal_satellite_id, clock: [af0_s, af1_s_s, af2_s_s2],
            gal_week_number: toe.week.saturating_sub(GALILEO_WEEK_OFFSET) % 4096,
            iodnav: self.at(1, 0) as u16 & 1023,
            sisa_e1_e5b_index: sisa_index(self.at(6, 0)),
            bgd_e1_e5a_s: self.at(6, 2) as f32,
            bgd_e1_e5b_s: self.at(6, 3) as f32,
            e1_b_data_validity_flag: (health & 1) as u8,
            e1_b_sig_health_ind: (health >> 1 & 3) as u8,
            e5b_data_validity_flag: (health >> 6 & 1) as u8,
            e5b_sig_health_ind: (health >> 7 & 3) as u8,
            reserved_502_2: 0,
        )
    }

    fn galileo_fnav(&self, toe: GpsTime) -> Msg1045T {
        let health = self.at(6, 1) as u16;
        message!(Msg1045T of self, gal_satellite_id, clock: [af0_s, af1_s_s, af2_s_s2],
            gal_week_number: toe.week.saturating_sub(GALILEO_WEEK_OFFSET) % 4096,
            iodnav: self.at(1, 0) as u16 & 1023,
            sisa_e1_e5a_index: sisa_index(self.at(6, 0)),
            bgd_e1_e5a_s: self.at(6, 2) as f32,
            e5a_data_validity_flag: (health >> 3 & 1) as u8,
            e5a_sig_health_ind: (health >> 4 & 3) as u8,
            reserved_489_7: 0,
        )
    }
}

/// The index of a user range accuracy in metres: the first class whose upper bound holds it
/// ([IS-GPS-200] 20.3.3.3.1.3).
///
/// [IS-GPS-200]: crate#references
fn ura_index(accuracy_m: f64) -> u8 {
    const UPPER_M: [f64; 15] =
        [2.4, 3.4, 4.85, 6.85, 9.65, 13.65, 24.0, 48.0, 96.0, 192.0, 384.0, 768.0, 1536.0, 3072.0, 6144.0];
    let class = UPPER_M.iter().position(|upper_m| (0.0..=*upper_m).contains(&accuracy_m));
    class.unwrap_or(UPPER_M.len()) as u8
}

/// The index of a signal-in-space accuracy in metres ([Galileo-OS-SIS-ICD] §5.1.12); 255 where
/// there is no prediction.
///
/// [Galileo-OS-SIS-ICD]: crate#references
fn sisa_index(accuracy_m: f64) -> u8 {
    let within =
        |from_m: f64, step_m: f64, first: f64| (first + ((accuracy_m - from_m) / step_m).round()) as u8;
    match accuracy_m {
        0.0..0.5 => within(0.0, 0.01, 0.0),
        0.5..1.0 => within(0.5, 0.02, 50.0),
        1.0..2.0 => within(1.0, 0.04, 75.0),
        2.0..=6.0 => within(2.0, 0.16, 100.0),
        _ => 255,
    }
}
