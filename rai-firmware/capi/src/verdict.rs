//! Verdict on an epoch: state, reason, position, levels, satellites left out.

use core::ffi::{CStr, c_char};

use raim_core::report::{MAX_EXCLUDED, Report, Suspect, Verdict};

use crate::pointer::Versioned;

/// No verdict yet. It counts as unavailable.
pub const RAI_STATE_NONE: u8 = 0;
/// The position may be used: an undetected fault of one satellite stays within the alert limits.
pub const RAI_STATE_PROTECTED: u8 = 1;
/// The position must not be used, for one of the reasons `RAI_REASON_FAULT` to `RAI_REASON_TIME`.
pub const RAI_STATE_ALERT: u8 = 2;
/// The position has no protection, because the means to test it are missing.
pub const RAI_STATE_UNAVAILABLE: u8 = 3;

/// No verdict yet.
pub const RAI_REASON_NONE: u8 = 0;

/// Protected: all satellites agree.
pub const RAI_REASON_OK: u8 = 1;
/// Protected: the satellites agree after the faulty ones were left out.
pub const RAI_REASON_EXCLUDED: u8 = 2;
/// Protected: systems contradict each other, and the one whose navigation data are proved has decided.
pub const RAI_REASON_SYSTEM: u8 = 3;
/// Protected: several satellites may be the faulty one, and the levels hold for each of them. The one
/// that was left out may be healthy.
pub const RAI_REASON_COVERED: u8 = 4;
/// Alert: a fault was detected and could not be isolated.
pub const RAI_REASON_FAULT: u8 = 32;
/// Alert: several exclusions explain the data, and no level within the limits holds for each of them.
pub const RAI_REASON_AMBIGUOUS: u8 = 33;
/// Alert: no epoch was judged within the time to alert.
pub const RAI_REASON_STALE: u8 = 34;
/// Alert: the position moved farther than the receiver can.
pub const RAI_REASON_JUMP: u8 = 35;
/// Alert: the receiver reports that its signals are false.
pub const RAI_REASON_SPOOFED: u8 = 36;
/// Alert: a wrong time tag of all ranges explains the data.
pub const RAI_REASON_TIME: u8 = 37;
/// Alert: epochs of another station or format came, and none of the receiver in use.
pub const RAI_REASON_SOURCE: u8 = 38;
/// Alert: the receiver clock contradicts its measured drift.
pub const RAI_REASON_CLOCK: u8 = 39;
/// Alert: the motion of the position contradicts its measured velocity.
pub const RAI_REASON_TRACK: u8 = 40;
/// Alert: satellites sent navigation data that their system did not make.
pub const RAI_REASON_AUTH: u8 = 41;
/// Alert: the time of the signals is not the trusted one.
pub const RAI_REASON_REPLAY: u8 = 42;
/// Unavailable: too few satellites for a position, or the fix did not converge.
pub const RAI_REASON_NOFIX: u8 = 64;
/// Unavailable: no redundancy to test the position with.
pub const RAI_REASON_REDUNDANCY: u8 = 65;
/// Unavailable: the geometry is singular, or leaves a satellite untested that moves the position.
pub const RAI_REASON_GEOMETRY: u8 = 66;
/// Unavailable: no threshold meets all probabilities.
pub const RAI_REASON_RISK: u8 = 67;
/// Unavailable: the horizontal protection level exceeds its share of the limit.
pub const RAI_REASON_HPL: u8 = 68;
/// Unavailable: the vertical protection level exceeds its share of the limit.
pub const RAI_REASON_VPL: u8 = 69;
/// Unavailable: the declared work budget cut the search.
pub const RAI_REASON_BUDGET: u8 = 70;
/// Unavailable: the whole input was refused.
pub const RAI_REASON_INPUT: u8 = 71;
/// Unavailable: the satellites agree again, but not yet for long enough.
pub const RAI_REASON_RECOVERING: u8 = 72;
/// Unavailable: the height or place is impossible for the receiver.
pub const RAI_REASON_PLACE: u8 = 73;
/// Unavailable: a known answer of the self-test was missed.
pub const RAI_REASON_SELFTEST: u8 = 74;
/// Unavailable: ranges came, but no orbits.
pub const RAI_REASON_EPHEMERIS: u8 = 75;
/// Unavailable: the host has not confirmed the settings after an unexpected restart.
pub const RAI_REASON_SETTINGS: u8 = 76;
/// Unavailable: the effective monitor threshold of ARAIM exceeds its limit.
pub const RAI_REASON_EMT: u8 = 77;
/// Unavailable: the vertical accuracy of ARAIM exceeds its limit.
pub const RAI_REASON_ACCURACY: u8 = 78;
/// Unavailable: the residuals of the last minute contradict the sigmas, or the satellites left
/// after an exclusion hardly agree.
pub const RAI_REASON_SIGMAS: u8 = 79;
/// Unavailable: fewer than four satellites with proved ephemerides were used.
pub const RAI_REASON_UNPROVED: u8 = 80;

fn text(reason: u8) -> &'static CStr {
    Verdict::word_of(reason).unwrap_or(c"?")
}

/// Returns the word of a reason in the sentences, a string that lives as long as the program; `?`
/// for an unknown one.
#[unsafe(no_mangle)]
pub extern "C" fn rai_reason_text(reason: u8) -> *const c_char {
    text(reason).as_ptr()
}

/// Returns the number of a verdict's state.
pub(crate) fn state_of(verdict: Verdict) -> u8 {
    match verdict {
        Verdict::Protected(_) => RAI_STATE_PROTECTED,
        Verdict::Alert(_) => RAI_STATE_ALERT,
        Verdict::Unavailable(_) => RAI_STATE_UNAVAILABLE,
    }
}

/// Global Positioning System.
pub const RAI_SYSTEM_GPS: u8 = b'G';
/// `BeiDou`.
pub const RAI_SYSTEM_BEIDOU: u8 = b'C';
/// Galileo.
pub const RAI_SYSTEM_GALILEO: u8 = b'E';
/// GLONASS.
pub const RAI_SYSTEM_GLONASS: u8 = b'R';
/// QZSS, numbered 1 to 10. Its ranges have the receiver clock of GPS.
pub const RAI_SYSTEM_QZSS: u8 = b'J';

/// Most satellites that may be left out of one epoch.
pub const RAI_MAX_EXCLUDED: usize = 3;

const _: () = assert!(RAI_MAX_EXCLUDED == MAX_EXCLUDED);

/// A satellite that was left out.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct rai_excluded_t {
    /// Estimated bias of the range, m.
    pub bias_m: f64,
    /// W-test of the satellite when it was suspected, in standard deviations.
    pub w_test: f64,
    /// System of the satellite, a letter: `RAI_SYSTEM_…`.
    pub system: u8,
    /// Number of the satellite within the system.
    pub number: u8,
    /// Reserved for later use.
    pub reserved: [u8; 6],
}

impl rai_excluded_t {
    const NONE: Self = Self { bias_m: 0.0, w_test: 0.0, system: 0, number: 0, reserved: [0; 6] };

    fn of(suspect: &Suspect) -> Self {
        // The letters are ASCII.
        let (letter, number) = suspect.satellite.name();
        Self {
            bias_m: suspect.bias_m,
            w_test: suspect.w_test,
            system: letter as u8,
            number,
            reserved: [0; 6],
        }
    }
}

/// Verdict on one epoch. An undefined number is NaN.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct rai_verdict_t {
    /// `sizeof(rai_verdict_t)`, set by the caller.
    pub size: u32,
    /// State, `RAI_STATE_…`: the position may be used only if it is `RAI_STATE_PROTECTED`.
    pub state: u8,
    /// Reason of the state, `RAI_REASON_…`.
    pub reason: u8,
    /// Satellites in the epoch.
    pub tracked: u8,
    /// Satellites in the position.
    pub used: u8,
    /// Degrees of freedom of the global test.
    pub dof: u8,
    /// Number of elements of `excluded` that are filled.
    pub excluded_count: u8,
    /// Number of ranges of the call that were refused, at most 255; the others were judged.
    pub refused_count: u8,
    /// Status of the first refused range.
    pub refused_status: u8,
    /// Reserved for later use.
    pub reserved: [u8; 4],
    /// Statistic of the global test, `√(SSE/dof)`.
    pub statistic: f64,
    /// Threshold of the global test.
    pub threshold: f64,
    /// Horizontal protection level, m.
    pub hpl_m: f64,
    /// Vertical protection level, m.
    pub vpl_m: f64,
    /// Earth-fixed position, x, m.
    pub x_m: f64,
    /// Earth-fixed position, y, m.
    pub y_m: f64,
    /// Earth-fixed position, z, m.
    pub z_m: f64,
    /// Geodetic latitude, rad, north positive.
    pub latitude_rad: f64,
    /// Longitude, rad, east positive.
    pub longitude_rad: f64,
    /// Height above the ellipsoid, m.
    pub height_m: f64,
    /// Satellites left out, in the order of exclusion.
    pub excluded: [rai_excluded_t; RAI_MAX_EXCLUDED],
}

#[allow(unsafe_code)]
// SAFETY: `repr(C)`, its size first, and integers and doubles, of which every pattern of bits is a
// value.
unsafe impl Versioned for rai_verdict_t {
    const FIRST_SIZE: usize = 168;
}

const _: () =
    assert!(size_of::<rai_verdict_t>() == 168, "a field came or moved: raise RAI_ABI_VERSION if it moved");

impl rai_verdict_t {
    /// Returns the state before the first verdict.
    pub(crate) fn none() -> Self {
        Self {
            size: size_of::<Self>() as u32,
            state: RAI_STATE_NONE,
            reason: RAI_REASON_NONE,
            tracked: 0,
            used: 0,
            dof: 0,
            excluded_count: 0,
            refused_count: 0,
            refused_status: 0,
            reserved: [0; 4],
            statistic: f64::NAN,
            threshold: f64::NAN,
            hpl_m: f64::NAN,
            vpl_m: f64::NAN,
            x_m: f64::NAN,
            y_m: f64::NAN,
            z_m: f64::NAN,
            latitude_rad: f64::NAN,
            longitude_rad: f64::NAN,
            height_m: f64::NAN,
            excluded: [rai_excluded_t::NONE; RAI_MAX_EXCLUDED],
        }
    }

    /// Returns a verdict without a position.
    pub(crate) fn without_position(verdict: Verdict) -> Self {
        Self { state: state_of(verdict), reason: verdict.code(), ..Self::none() }
    }

    /// Returns the verdict of a report.
    pub(crate) fn of<const N: usize>(report: &Report<N>) -> Self {
        let mut verdict = Self::without_position(report.verdict);
        verdict.tracked = report.tracked;
        verdict.used = report.used.len().min(255) as u8;
        verdict.excluded_count = report.excluded.len() as u8;
        for (slot, suspect) in verdict.excluded.iter_mut().zip(&report.excluded) {
            *slot = rai_excluded_t::of(suspect);
        }
        if let Some(test) = report.test {
            (verdict.statistic, verdict.threshold, verdict.dof) = (test.statistic, test.threshold, test.dof);
        }
        if let Some(levels) = report.protection {
            (verdict.hpl_m, verdict.vpl_m) = (levels.hpl_m, levels.vpl_m);
        }
        if let Some(solution) = &report.solution {
            let (position, geodetic) = (solution.position, solution.geodetic);
            (verdict.x_m, verdict.y_m, verdict.z_m) = (position.x_m, position.y_m, position.z_m);
            (verdict.latitude_rad, verdict.longitude_rad) = (geodetic.latitude_rad, geodetic.longitude_rad);
            verdict.height_m = geodetic.height_m;
        }
        verdict
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    #[test]
    fn every_reason_of_the_core_has_its_code_here() {
        let constants = include_str!("verdict.rs").lines().filter_map(|line| {
            let (name, code) = line.strip_prefix("pub const RAI_REASON_")?.split_once(": u8 = ")?;
            Some((name.to_owned(), code.trim_end_matches(';').parse().expect("a code")))
        });
        let have: BTreeMap<_, u8> = constants.collect();
        let none = [("NONE".to_owned(), RAI_REASON_NONE)];
        let reasons = Verdict::all().map(|verdict| (verdict.word().to_owned(), verdict.code()));
        assert_eq!(have, reasons.chain(none).collect());
    }

    #[test]
    fn code_without_a_reason_has_a_question_mark() {
        assert_eq!((text(RAI_REASON_NONE), text(255), text(RAI_REASON_FAULT)), (c"?", c"?", c"FAULT"));
    }
}
