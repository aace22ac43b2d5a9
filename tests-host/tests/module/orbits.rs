//! Broadcast messages of real satellites, with their positions.
//!
//! The elements come from receivers' navigation files (Esbjerg, 2020-06-25; Nagoya, 2024-06-24). A
//! separate program computed positions and clocks from them. It has the interface documents'
//! formulas as printed, with arc tangents and the libm of C, and solves Kepler's equation by 200
//! fixed-point iterations.
#![allow(dead_code, reason = "each test program uses a part")]

use std::f64::consts::PI;

use raim_core::satellite::{Constellation, SatelliteId};
use raim_firmware::ephemeris::{Broadcast, Health, Source};
use raim_firmware::time::GpsTime;

/// One instant: arrival of the signal, its pseudorange, and the state at transmission.
#[derive(Clone, Copy)]
pub(crate) struct Want {
    pub(crate) after_toe_ms: i64,
    pub(crate) range_m: f64,
    pub(crate) position_m: [f64; 3],
    pub(crate) clock_s: f64,
}

/// Message of one satellite, angles in radians as in navigation files.
#[derive(Clone, Copy)]
pub(crate) struct Case {
    pub(crate) satellite: (Constellation, u8),
    pub(crate) source: Source,
    pub(crate) week: u16,
    pub(crate) toe_ms: u32,
    pub(crate) toc_ms: u32,
    pub(crate) sqrt_a: f64,
    pub(crate) eccentricity: f64,
    /// Angles M0, Ω0, i0, ω, rad.
    pub(crate) angles_rad: [f64; 4],
    /// Rates Δn, dΩ/dt, di/dt, rad/s.
    pub(crate) rates_rad_s: [f64; 3],
    /// Corrections Cuc, Cus, Crc, Crs, Cic, Cis.
    pub(crate) corrections: [f64; 6],
    pub(crate) clock: [f64; 3],
    pub(crate) want: [Want; 2],
}

impl Case {
    pub(crate) fn id(&self) -> SatelliteId {
        SatelliteId::new(self.satellite.0, self.satellite.1).unwrap()
    }

    pub(crate) fn toe(&self) -> GpsTime {
        GpsTime { week: self.week, tow_ms: self.toe_ms }
    }

    pub(crate) fn angles_sc(&self) -> [f64; 4] {
        self.angles_rad.map(|angle| angle / PI)
    }

    pub(crate) fn rates_sc_s(&self) -> [f64; 3] {
        self.rates_rad_s.map(|rate| rate / PI)
    }

    pub(crate) fn broadcast(&self) -> Broadcast {
        let [m0_sc, omega0_sc, i0_sc, omega_sc] = self.angles_sc();
        let [delta_n_sc_s, omegadot_sc_s, idot_sc_s] = self.rates_sc_s();
        let [cuc_rad, cus_rad, crc_m, crs_m, cic_rad, cis_rad] = self.corrections.map(|c| c as f32);
        let [af0_s, af1_s_s, af2_s_s2] = self.clock;
        Broadcast {
            satellite: self.id(),
            source: self.source,
            health: Health::GOOD,
            accuracy_m: Some(2.0),
            toe: self.toe(),
            toc: GpsTime { week: self.week, tow_ms: self.toc_ms },
            sqrt_a_sqrt_m: self.sqrt_a,
            eccentricity: self.eccentricity,
            m0_sc,
            omega0_sc,
            i0_sc,
            omega_sc,
            delta_n_sc_s,
            omegadot_sc_s,
            idot_sc_s,
            cuc_rad,
            cus_rad,
            crc_m,
            crs_m,
            cic_rad,
            cis_rad,
            af0_s,
            af1_s_s,
            af2_s_s2,
            group_delays_s: [0.0, 0.0],
        }
    }
}

/// Returns the same orbit and clock, written about another reference time.
///
/// The elements move along the orbit by their own rates, so that both sets describe one motion
/// exactly. The harmonic corrections are functions of the place on the orbit and stay.
pub(crate) fn later(broadcast: &Broadcast, seconds: i64) -> Broadcast {
    let mu = if broadcast.source == Source::GpsLnav { 3.986005e14_f64 } else { 3.986004418e14 };
    let motion_sc_s = mu.sqrt() / broadcast.sqrt_a_sqrt_m.powi(3) / PI + broadcast.delta_n_sc_s;
    let moved = |time: GpsTime| GpsTime::from_ms(time.to_ms().checked_add_signed(seconds * 1000).unwrap());
    let turned = |angle: f64, rate: f64| (angle + rate * seconds as f64 + 1.0).rem_euclid(2.0) - 1.0;
    // The node counts from the start of the week, so that it changes with the week.
    let weeks = f64::from(moved(broadcast.toe).week) - f64::from(broadcast.toe.week);
    assert!(weeks == 0.0, "the orbits here stay within their week");
    Broadcast {
        toe: moved(broadcast.toe),
        toc: moved(broadcast.toc),
        m0_sc: turned(broadcast.m0_sc, motion_sc_s),
        omega0_sc: turned(broadcast.omega0_sc, broadcast.omegadot_sc_s),
        i0_sc: broadcast.i0_sc + broadcast.idot_sc_s * seconds as f64,
        af0_s: broadcast.af0_s + broadcast.af1_s_s * seconds as f64,
        ..*broadcast
    }
}

/// All cases.
pub(crate) const CASES: [Case; 8] = [
    Case {
        // G05, GPS
        satellite: (Constellation::Gps, 5),
        source: Source::GpsLnav,
        week: 2111,
        toe_ms: 360000000,
        toc_ms: 360000000,
        sqrt_a: 5153.692087173,
        eccentricity: 0.005968191311695,
        angles_rad: [-2.717924257392, -2.702709198389, 0.9531610005359, 0.8076464307442],
        rates_rad_s: [4.565904473963e-09, -7.946045270394e-09, 1.23933733766e-10],
        corrections: [
            -6.094574928284e-06,
            9.035691618919e-06,
            202.6875,
            -112.375,
            2.98023223877e-08,
            -1.247972249985e-07,
        ],
        clock: [-1.532910391688e-05, -7.958078640513e-13, 0.0],
        want: [
            Want {
                after_toe_ms: -6900000,
                range_m: 21400000.0,
                position_m: [26200321.85718, -1078758.35145, -4991227.57306],
                clock_s: -1.533109582211e-5,
            },
            Want {
                after_toe_ms: 3333000,
                range_m: 24900000.0,
                position_m: [9994129.49389, 12136517.85689, -21528728.60384],
                clock_s: -1.532100867993e-5,
            },
        ],
    },
    Case {
        // G18, GPS
        satellite: (Constellation::Gps, 18),
        source: Source::GpsLnav,
        week: 2111,
        toe_ms: 360000000,
        toc_ms: 360000000,
        sqrt_a: 5153.722267151,
        eccentricity: 0.000642528408207,
        angles_rad: [1.212290643788, 2.58964421431, 0.9642604803823, 2.568944018578],
        rates_rad_s: [4.553403953266e-09, -8.347133405897e-09, 1.178620522847e-11],
        corrections: [
            -2.918764948845e-06,
            1.922249794006e-06,
            344.5625,
            -56.9375,
            2.98023223877e-08,
            -3.725290298462e-09,
        ],
        clock: [0.0002294853329659, 1.023181539495e-11, 0.0],
        want: [
            Want {
                after_toe_ms: -6900000,
                range_m: 21400000.0,
                position_m: [4735762.49950, -24921813.62846, 7815572.17628],
                clock_s: 2.294144317579e-4,
            },
            Want {
                after_toe_ms: 3333000,
                range_m: 24900000.0,
                position_m: [9041490.52517, -15339928.17792, -19710886.08331],
                clock_s: 2.2951797564268e-4,
            },
        ],
    },
    Case {
        // E31, Galileo
        satellite: (Constellation::Galileo, 31),
        source: Source::GalileoInav,
        week: 2111,
        toe_ms: 348000000,
        toc_ms: 348000000,
        sqrt_a: 5440.610378265,
        eccentricity: 0.0002500186674297,
        angles_rad: [-2.719897811416, 0.2095083646243, 0.982369488318, -2.163940512854],
        rates_rad_s: [2.648324599064e-09, -5.190930508806e-09, -7.118153642528e-10],
        corrections: [
            7.562339305878e-07,
            1.040101051331e-05,
            131.4375,
            15.0,
            -7.450580596924e-08,
            -1.490116119385e-07,
        ],
        clock: [-0.000472987361718, -1.42108547152e-13, 0.0],
        want: [
            Want {
                after_toe_ms: -6900000,
                range_m: 21400000.0,
                position_m: [18752928.90169, 19035905.04428, 12749049.89961],
                clock_s: -4.729866350855e-4,
            },
            Want {
                after_toe_ms: 3333000,
                range_m: 24900000.0,
                position_m: [-2437052.75646, 17284016.05326, 23912020.35188],
                clock_s: -4.729873874807e-4,
            },
        ],
    },
    Case {
        // E14, Galileo, eccentricity 0.17
        satellite: (Constellation::Galileo, 14),
        source: Source::GalileoInav,
        week: 2111,
        toe_ms: 358200000,
        toc_ms: 358200000,
        sqrt_a: 5289.414459229,
        eccentricity: 0.1668241642183,
        angles_rad: [-2.175720094538, 1.579900569246, 0.8830234222928, 1.752045650637],
        rates_rad_s: [2.330454215629e-09, -4.285535652619e-09, 8.136053184987e-10],
        corrections: [
            8.776783943176e-06,
            -1.909211277962e-06,
            391.125,
            122.09375,
            2.425163984299e-06,
            -8.940696716309e-08,
        ],
        clock: [-0.001061521354131, -1.337241428701e-11, 0.0],
        want: [
            Want {
                after_toe_ms: -6900000,
                range_m: 21400000.0,
                position_m: [21097350.37081, -3328655.61423, -24685498.18076],
                clock_s: -1.061417337743e-3,
            },
            Want {
                after_toe_ms: 3333000,
                range_m: 24900000.0,
                position_m: [28319994.14369, 4665264.71284, -6459112.74866],
                clock_s: -1.061193050035e-3,
            },
        ],
    },
    Case {
        // C05, BeiDou GEO
        satellite: (Constellation::Beidou, 5),
        source: Source::BeidouD1D2,
        week: 2111,
        toe_ms: 352814000,
        toc_ms: 352814000,
        sqrt_a: 6493.339422226,
        eccentricity: 0.000367101514712,
        angles_rad: [-0.05832509553148, -2.763007654839, 0.1039717149764, -1.844087868473],
        rates_rad_s: [2.153661137202e-10, 9.361104213279e-10, 5.539516457381e-10],
        corrections: [
            -1.488905400038e-05,
            1.109158620238e-05,
            -332.609375,
            -448.296875,
            5.820766091347e-08,
            7.776543498039e-08,
        ],
        clock: [-0.0005164267495275, -6.705391797368e-11, 0.0],
        want: [
            Want {
                after_toe_ms: -6900000,
                range_m: 38200000.0,
                position_m: [21891362.81937, 36002037.00786, -1110744.05573],
                clock_s: -5.15963504878e-4,
            },
            Want {
                after_toe_ms: 3333000,
                range_m: 39900000.0,
                position_m: [21866616.29023, 36022435.99175, -854669.34213],
                clock_s: -5.166504258952e-4,
            },
        ],
    },
    Case {
        // C59, BeiDou-3 GEO
        satellite: (Constellation::Beidou, 59),
        source: Source::BeidouD1D2,
        week: 2320,
        toe_ms: 115214000,
        toc_ms: 115214000,
        sqrt_a: 6493.406042099,
        eccentricity: 0.0004224977456033,
        angles_rad: [1.247035771794, -1.472383873144, 0.08621289890758, -1.497534982503],
        rates_rad_s: [1.076616273961e-08, -9.547897708264e-09, 2.892977646988e-10],
        corrections: [
            1.61174684763e-05,
            -1.373514533043e-05,
            411.984375,
            491.15625,
            -1.681037247181e-07,
            -4.656612873077e-09,
        ],
        clock: [5.364418029785e-07, -1.15463194561e-14, 0.0],
        want: [
            Want {
                after_toe_ms: -6900000,
                range_m: 38200000.0,
                position_m: [-32318307.55210, 27042948.03323, 944392.51796],
                clock_s: 5.356959402573e-7,
            },
            Want {
                after_toe_ms: 3333000,
                range_m: 39900000.0,
                position_m: [-32326138.96611, 27022877.08401, 1590171.66812],
                clock_s: 5.3518838338039e-7,
            },
        ],
    },
    Case {
        // C06, BeiDou IGSO
        satellite: (Constellation::Beidou, 6),
        source: Source::BeidouD1D2,
        week: 2111,
        toe_ms: 396014000,
        toc_ms: 396014000,
        sqrt_a: 6493.737188339,
        eccentricity: 0.009586160071194,
        angles_rad: [-3.058544204483, -1.513790037283, 0.9443672024674, -2.193316652511],
        rates_rad_s: [1.199692829165e-09, -1.833647807363e-09, 1.010756387775e-09],
        corrections: [
            5.359295755625e-06,
            1.848768442869e-05,
            -329.03125,
            174.4375,
            -3.790482878685e-07,
            3.129243850708e-07,
        ],
        clock: [0.0007632486522198, 1.006927874414e-11, 0.0],
        want: [
            Want {
                after_toe_ms: -6900000,
                range_m: 38200000.0,
                position_m: [-11179410.95616, 37078439.83258, 17598899.45068],
                clock_s: 7.6316799249231e-4,
            },
            Want {
                after_toe_ms: 3333000,
                range_m: 39900000.0,
                position_m: [-7794363.28324, 25827552.78899, 32907226.90871],
                clock_s: 7.6329099050552e-4,
            },
        ],
    },
    Case {
        // C23, BeiDou MEO
        satellite: (Constellation::Beidou, 23),
        source: Source::BeidouD1D2,
        week: 2111,
        toe_ms: 352814000,
        toc_ms: 352814000,
        sqrt_a: 5282.612390518,
        eccentricity: 0.0003096621949226,
        angles_rad: [-1.594501783434, -0.2226112771332, 0.9525497714186, -2.128191426595],
        rates_rad_s: [4.200889269614e-09, -6.888858377174e-09, -6.232402461722e-10],
        corrections: [
            -6.710179150105e-07,
            7.071997970343e-06,
            216.984375,
            -9.59375,
            4.516914486885e-08,
            -2.607703208923e-08,
        ],
        clock: [-0.0008493849309161, 4.463096558993e-12, 0.0],
        want: [
            Want {
                after_toe_ms: -6900000,
                range_m: 38200000.0,
                position_m: [3523024.95821, 15839235.44593, 22711981.84191],
                clock_s: -8.494153090922e-4,
            },
            Want {
                after_toe_ms: 3333000,
                range_m: 39900000.0,
                position_m: [-11704771.70620, 25156112.51556, 2953766.96680],
                clock_s: -8.493693946202e-4,
            },
        ],
    },
];
