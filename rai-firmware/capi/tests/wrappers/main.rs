//! The exported functions, called as a C program calls them: their results, their refusals, and the
//! memory that they leave unchanged.
//!
//! Under Miri (`cargo xtask miri`) this also proves that no call has undefined behaviour.
#![allow(unsafe_code)]

mod receiver;

use std::mem::MaybeUninit;
use std::ptr;

use rai::*;

type Monitor = Box<MaybeUninit<rai_monitor_t>>;

fn settings() -> rai_settings_t {
    let mut settings = MaybeUninit::<rai_settings_t>::zeroed();
    // SAFETY: zeros are a value of integers and doubles.
    let settings = unsafe { settings.assume_init_mut() };
    settings.size = size_of::<rai_settings_t>() as u32;
    // SAFETY: the struct has the size that it states.
    assert_eq!(unsafe { rai_settings_preset(settings, RAI_PHASE_NPA) }, RAI_STATUS_OK);
    *settings
}

fn verdict() -> rai_verdict_t {
    // SAFETY: zeros are a value of integers and doubles.
    let mut verdict: rai_verdict_t = unsafe { MaybeUninit::zeroed().assume_init() };
    verdict.size = size_of::<rai_verdict_t>() as u32;
    verdict
}

/// Returns a monitor in uninitialised memory.
fn monitor() -> Monitor {
    let mut memory: Monitor = Box::new_uninit();
    let settings = settings();
    // SAFETY: the memory has the stated size, the settings the size that they state.
    let status = unsafe { rai_monitor_init(memory.as_mut_ptr(), RAI_MONITOR_SIZE, &raw const settings) };
    assert_eq!(status, RAI_STATUS_OK);
    memory
}

/// Returns the seven satellites of the README of `raim-core`, of which G05 is wrong by 80 m.
fn ranges() -> [rai_range_t; 7] {
    const POSITIONS: [[f64; 3]; 7] = [
        [15909567.8, 2365446.2, 23362131.7],
        [-3367221.5, -500641.0, 26080759.6],
        [25324386.9, 3765248.4, 6140002.4],
        [8390254.2, 19040938.2, 16110381.0],
        [13566911.3, -15776330.8, 16110381.0],
        [922952.3, 13482327.0, 22817783.2],
        [1054936.5, -10519232.7, 24086683.9],
    ];
    let mut number = 0;
    POSITIONS.map(|[x_m, y_m, z_m]| {
        number += 1;
        let range_m = if number == 5 { 22e6 + 80.0 } else { 22e6 };
        rai_range_t { x_m, y_m, z_m, range_m, sigma_m: 2.0, system: RAI_SYSTEM_GPS, number, reserved: [0; 6] }
    })
}

fn judge(monitor: &mut Monitor, ranges: &[rai_range_t]) -> rai_verdict_t {
    let mut verdict = verdict();
    // SAFETY: the object is valid, there are as many ranges as stated, and the verdict has the size
    // that it states.
    let status = unsafe {
        rai_monitor_judge(monitor.as_mut_ptr(), 0.0, ranges.as_ptr(), ranges.len(), &raw mut verdict)
    };
    assert_eq!(status, RAI_STATUS_OK);
    verdict
}

fn assert_is_the_example(verdict: &rai_verdict_t) {
    assert_eq!((verdict.state, verdict.reason), (RAI_STATE_PROTECTED, RAI_REASON_EXCLUDED));
    assert_eq!((verdict.tracked, verdict.used, verdict.excluded_count), (7, 6, 1));
    let [excluded, ..] = verdict.excluded;
    assert_eq!((excluded.system, excluded.number), (b'G', 5));
    // All other ranges are exact, to the decimetre that their satellites' positions are rounded to.
    assert!((excluded.bias_m - 80.0).abs() < 0.5, "{}", excluded.bias_m);
}

#[test]
fn the_satellite_that_is_wrong_is_named() {
    assert_is_the_example(&judge(&mut monitor(), &ranges()));
}

#[test]
fn a_monitor_may_be_moved_between_calls() {
    let before = monitor();
    let mut after: Monitor = Box::new_uninit();
    // SAFETY: both have this size and do not overlap; uninitialised bytes stay uninitialised.
    unsafe { ptr::copy_nonoverlapping(before.as_ptr(), after.as_mut_ptr(), 1) };
    drop(before);
    assert_is_the_example(&judge(&mut after, &ranges()));
}

#[test]
fn ranges_that_cannot_be_any_are_counted_and_the_others_judged() {
    let mut ranges = ranges();
    let [first, second, ..] = &mut ranges;
    first.range_m = f64::NAN;
    second.system = b'X';
    let verdict = judge(&mut monitor(), &ranges);
    assert_eq!((verdict.refused_count, verdict.refused_status), (2, RAI_STATUS_RANGE));
    assert_eq!(verdict.tracked, 5);
    let nothing = judge(&mut monitor(), &[]);
    assert_eq!((nothing.state, nothing.reason), (RAI_STATE_UNAVAILABLE, RAI_REASON_NOFIX));
    assert!(nothing.hpl_m.is_nan() && nothing.x_m.is_nan());
}

#[test]
fn pointers_and_lengths_are_refused_by_name() {
    let mut memory: Monitor = Box::new_uninit();
    let (at, settings) = (memory.as_mut_ptr(), settings());
    let beside = at.wrapping_byte_add(4);
    // SAFETY: a refused argument is not read.
    unsafe {
        let init = |memory, length, settings| rai_monitor_init(memory, length, settings);
        assert_eq!(init(ptr::null_mut(), RAI_MONITOR_SIZE, &raw const settings), RAI_STATUS_NULL);
        assert_eq!(init(at, RAI_MONITOR_SIZE, ptr::null()), RAI_STATUS_NULL);
        assert_eq!(init(beside, RAI_MONITOR_SIZE, &raw const settings), RAI_STATUS_MISALIGNED);
        assert_eq!(init(at, rai_monitor_size() - 1, &raw const settings), RAI_STATUS_SHORT);
    }
    let (mut monitor, mut verdict) = (self::monitor(), verdict());
    let (at, ranges, given) = (monitor.as_mut_ptr(), ranges(), &raw mut verdict);
    // SAFETY: as above.
    unsafe {
        let judge = |at, time_s, ranges, count, given| rai_monitor_judge(at, time_s, ranges, count, given);
        let first = ranges.as_ptr();
        assert_eq!(judge(ptr::null_mut(), 0.0, first, 7, given), RAI_STATUS_NULL);
        assert_eq!(judge(at, 0.0, ptr::null(), 7, given), RAI_STATUS_NULL);
        assert_eq!(judge(at, 0.0, first.wrapping_byte_add(1), 7, given), RAI_STATUS_MISALIGNED);
        assert_eq!(judge(at, 0.0, first, usize::MAX, given), RAI_STATUS_COUNT);
        assert_eq!(judge(at, 0.0, first, 7, ptr::null_mut()), RAI_STATUS_NULL);
        assert_eq!(judge(at, f64::NAN, first, 7, given), RAI_STATUS_TIME);
    }
    assert_eq!(verdict.state, RAI_STATE_NONE, "nothing has been written");
}

#[test]
fn memory_without_an_object_is_refused() {
    let mut monitor_words = vec![0_u64; RAI_MONITOR_WORDS];
    let monitor: *mut rai_monitor_t = monitor_words.as_mut_ptr().cast();
    let mut words = vec![0_u64; RAI_RECEIVER_WORDS];
    let receiver: *mut rai_receiver_t = words.as_mut_ptr().cast();
    let mut verdict = verdict();
    let not_initialised = RAI_STATUS_NOT_INITIALISED;
    // SAFETY: the memory is initialised, and the verdict has the size that it states.
    unsafe {
        assert_eq!(rai_monitor_forget(monitor), not_initialised);
        assert_eq!(rai_receiver_report(receiver, &raw mut verdict), not_initialised);
        assert_eq!(rai_receiver_pin(receiver), 0);
        assert_eq!(rai_receiver_state(receiver, ptr::null_mut()), RAI_STATE_NONE);
        // A monitor is no receiver.
        let settings = settings();
        let made = rai_monitor_init(receiver.cast(), RAI_MONITOR_SIZE, &raw const settings);
        assert_eq!(made, RAI_STATUS_OK);
        assert_eq!(rai_receiver_report(receiver, &raw mut verdict), not_initialised);
    }
}

#[test]
fn refused_settings_leave_the_monitor_as_it_was() {
    let mut monitor = monitor();
    let refused = [
        (rai_settings_t { hal_m: -1.0, ..settings() }, RAI_STATUS_HAL),
        (rai_settings_t { val_m: f64::NAN, ..settings() }, RAI_STATUS_VAL),
        (rai_settings_t { false_alarm: 0.3, ..settings() }, RAI_STATUS_FALSE_ALARM),
        (rai_settings_t { missed_detection: 0.3, ..settings() }, RAI_STATUS_MISSED_DETECTION),
        (rai_settings_t { policy: 9, ..settings() }, RAI_STATUS_POLICY),
        (rai_settings_t { method: 99, ..settings() }, RAI_STATUS_METHOD),
        (rai_settings_t { levels: 9, ..settings() }, RAI_STATUS_LEVELS),
        (rai_settings_t { max_speed_m_s: f64::INFINITY, ..settings() }, RAI_STATUS_SPEED),
        (rai_settings_t { min_height_m: 1e9, ..settings() }, RAI_STATUS_HEIGHT),
        (rai_settings_t { recovery_epochs: 0, ..settings() }, RAI_STATUS_RECOVERY),
        (rai_settings_t { size: 81, ..settings() }, RAI_STATUS_SIZE),
        (rai_settings_t { size: 79, ..settings() }, RAI_STATUS_SIZE),
    ];
    for (settings, want) in refused {
        // SAFETY: an object, settings that are no longer than they are.
        let have = unsafe {
            let at = monitor.as_mut_ptr();
            [
                rai_monitor_configure(at, &raw const settings),
                rai_monitor_init(at, RAI_MONITOR_SIZE, &raw const settings),
            ]
        };
        assert_eq!(have, [want; 2]);
    }
    assert_is_the_example(&judge(&mut monitor, &ranges()));
}

#[test]
fn a_caller_that_knows_more_keeps_what_the_library_does_not_know() {
    #[repr(C)]
    struct Later {
        verdict: rai_verdict_t,
        more: [u8; 8],
    }
    let mut later = Later { verdict: verdict(), more: [7; 8] };
    later.verdict.size = size_of::<Later>() as u32;
    let (mut monitor, ranges) = (monitor(), ranges());
    // SAFETY: the object is valid, there are as many ranges as stated, and the verdict has the size
    // that it states.
    let status =
        unsafe { rai_monitor_judge(monitor.as_mut_ptr(), 0.0, ranges.as_ptr(), 7, (&raw mut later).cast()) };
    assert_eq!((status, later.more, later.verdict.size), (RAI_STATUS_OK, [7; 8], size_of::<Later>() as u32));
    assert_is_the_example(&later.verdict);
}

/// Returns a struct of zeros with its size.
fn sized<S: Copy>() -> S {
    // SAFETY: zeros are a value of integers and doubles, and all of these structs begin with a
    // `u32`.
    unsafe {
        let mut given = MaybeUninit::<S>::zeroed();
        given.as_mut_ptr().cast::<u32>().write(size_of::<S>() as u32);
        given.assume_init()
    }
}

#[test]
fn residuals_and_accuracy_are_those_of_the_last_epoch() {
    let mut monitor = monitor();
    let at = monitor.as_mut_ptr();
    let mut accuracy: rai_accuracy_t = sized();
    let mut residuals = [MaybeUninit::<rai_residual_t>::uninit(); 7];
    let (place, mut count) = (residuals.as_mut_ptr().cast::<rai_residual_t>(), 9);
    // SAFETY: the object is valid and the array has the stated length.
    unsafe {
        // Before the first epoch there is nothing.
        assert_eq!(rai_monitor_residuals(at, ptr::null_mut(), 0, &raw mut count), RAI_STATUS_OK);
        assert_eq!(rai_monitor_accuracy(at, &raw mut accuracy), RAI_STATUS_OK);
    }
    assert!(count == 0 && accuracy.covariance_m2[0].is_nan() && accuracy.residual_rms_m.is_nan());
    let verdict = judge(&mut monitor, &ranges());
    assert_is_the_example(&verdict);
    // SAFETY: as above.
    unsafe {
        let at = monitor.as_mut_ptr();
        assert_eq!(rai_monitor_residuals(at, place, 6, &raw mut count), RAI_STATUS_SHORT);
        assert_eq!(count, 0, "a refused call has written nothing");
        assert_eq!(rai_monitor_residuals(at, place, 7, ptr::null_mut()), RAI_STATUS_NULL);
        assert_eq!(rai_monitor_residuals(at, place, 7, &raw mut count), RAI_STATUS_OK);
        assert_eq!(rai_monitor_accuracy(at, &raw mut accuracy), RAI_STATUS_OK);
    }
    assert_eq!(count, 7);
    // SAFETY: all have been written.
    let residuals = residuals.map(|residual| unsafe { residual.assume_init() });
    for (range, residual) in ranges().iter().zip(&residuals) {
        assert_eq!((range.system, range.number), (residual.system, residual.number));
        let is_faulty = residual.number == 5;
        assert_eq!(residual.is_used, u8::from(!is_faulty));
        // The satellites' positions are rounded to a decimetre.
        let want = if is_faulty { 80.0 } else { 0.0 };
        assert!((residual.residual_m - want).abs() < 0.5, "{residual:?}");
    }
    let used = residuals.iter().filter(|residual| residual.is_used == 1);
    let squares: f64 = used.map(|residual| residual.residual_m * residual.residual_m).sum();
    assert!((accuracy.residual_rms_m - (squares / 6.0).sqrt()).abs() < 1e-3, "{accuracy:?}");
    // The dilutions of precision are roots of the covariance over the sigma of all ranges, 2 m.
    let [ee, _, _, nn, _, uu] = accuracy.covariance_m2;
    assert!(((ee + nn).sqrt() / 2.0 - accuracy.hdop).abs() < 1e-4, "{accuracy:?}");
    assert!((uu.sqrt() / 2.0 - accuracy.vdop).abs() < 1e-4, "{accuracy:?}");
    assert!(accuracy.gps_clock_m.is_finite() && accuracy.galileo_clock_m.is_nan());
}

#[test]
fn the_version_is_that_of_the_package() {
    // SAFETY: the string lives as long as the program.
    let version = unsafe { std::ffi::CStr::from_ptr(rai_version()) };
    assert_eq!(version.to_str(), Ok(env!("CARGO_PKG_VERSION")));
    let header = include_str!("../../include/rai.h");
    assert!(header.contains(&format!("#define RAI_VERSION \"{}\"", env!("CARGO_PKG_VERSION"))));
}
