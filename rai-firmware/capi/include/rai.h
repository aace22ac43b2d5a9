/* RAI: receiver autonomous integrity monitoring for microcontrollers. The C interface.
 *
 * Two levels, each with storage that the caller allocates: rai_monitor_* takes ranges and satellite positions and gives a
 * verdict; rai_receiver_* takes the bytes of a GNSS receiver and gives sentences and a pin.
 *
 * An object lives in memory of the caller. The library allocates nothing, keeps no globals, calls nothing back and holds no
 * pointer after a call has returned. Functions that can refuse return a status; a refused call has changed nothing. A struct
 * begins with its size, set by the caller to sizeof. One object may be used by one thread at a time.
 *
 * Stack that a call needs on a Cortex-M4F, KiB, with room for 16, 32 and 48 satellites:
 *
 *   rai_monitor_init                                    3     3     4
 *   rai_monitor_judge, classic RAIM                     5     6     7
 *   rai_monitor_judge, every search and ARAIM                       8
 *   rai_receiver_init                                               8
 *   rai_receiver_gnss                                               8
 *   rai_receiver_tick, which may end an epoch                       8
 *   rai_receiver_command, rai_receiver_set                          5
 *   all others                                          1     1     1
 */

#ifndef RAI_H
#define RAI_H

/* Made by `cargo xtask header` from rai-firmware/capi: do not edit. */

#include <stddef.h>
#include <stdint.h>
/* A program defines RAI_SATELLITES_16 or RAI_SATELLITES_32 if its library was built for no more satellites than that. */
#if !defined(RAI_SATELLITES_16) && !defined(RAI_SATELLITES_32)
#define RAI_SATELLITES_48
#endif

/* Version of the package that this header came with; rai_version() returns that of the library. */
#define RAI_VERSION "0.2.0"

/* A condition that must hold when this is compiled, whatever the standard. */
#if defined(__cplusplus)
#define RAI_ASSERT(condition, name) static_assert(condition, #name)
#elif defined(__STDC_VERSION__) && __STDC_VERSION__ >= 201112L
#define RAI_ASSERT(condition, name) _Static_assert(condition, #name)
#else
#define RAI_ASSERT(condition, name) typedef char rai_assert_##name[(condition) ? 1 : -1]
#endif


/**
 * Version of this interface. It grows by one with every change that would break a program compiled
 * against an older header. Such changes are a field that moved, a size that grew, and a constant
 * with a new meaning.
 */
#define RAI_ABI_VERSION 4

/**
 * There is no key, the setting `AUTH` is `OFF`, or the library was built without OSNMA.
 */
#define RAI_OSNMA_NONE 0

/**
 * There is a root of the tree and no key: a new key is awaited.
 */
#define RAI_OSNMA_NOKEY 1

/**
 * No root key is proved yet.
 */
#define RAI_OSNMA_WAIT 2

/**
 * The root key is signed by a key with another number.
 */
#define RAI_OSNMA_OTHERKEY 3

/**
 * The system uses functions that the library lacks.
 */
#define RAI_OSNMA_UNSUPPORTED 4

/**
 * Tags are checked; how old the sky is, is not known.
 */
#define RAI_OSNMA_UNDATED 5

/**
 * Tags are checked; those with a later key are proof.
 */
#define RAI_OSNMA_LATER 6

/**
 * Tags are checked; all are proof.
 */
#define RAI_OSNMA_DATED 7

/**
 * The system says that its tags must not be used.
 */
#define RAI_OSNMA_DONTUSE 8

/**
 * The system's alert has ended the use of OSNMA.
 */
#define RAI_OSNMA_STOPPED 9

/**
 * Two satellites sent false words or keys within the last 5 minutes.
 */
#define RAI_OSNMA_FALSE 10

/**
 * Bytes of a counter's name, with the NUL at its end.
 */
#define RAI_COUNTER_NAME_SIZE 36

/**
 * En route: HAL 3,704 m.
 */
#define RAI_PHASE_ENROUTE 0

/**
 * Terminal area: HAL 1,852 m.
 */
#define RAI_PHASE_TERMINAL 1

/**
 * Non-precision approach: HAL 556 m.
 */
#define RAI_PHASE_NPA 2

/**
 * Localiser performance with vertical guidance: HAL 40 m, VAL 35 m.
 */
#define RAI_PHASE_LPV200 3

/**
 * Policy: the threshold of the global test follows from the probability of false alarm.
 */
#define RAI_POLICY_T1 0

/**
 * Policy: the threshold of the global test follows from the probability of missed detection.
 */
#define RAI_POLICY_T2 1

/**
 * Policy: the threshold of the global test has the least cost of both errors.
 */
#define RAI_POLICY_TOP 2

/**
 * Method: every group of satellites if their number allows, else the largest w-test.
 */
#define RAI_METHOD_AUTO 0

/**
 * Method: the largest w-test, repeatedly.
 */
#define RAI_METHOD_BAARDA 1

/**
 * Method in parity space, all satellites at once. This one and those up to RANSAC need the
 * library's feature `searches`.
 */
#define RAI_METHOD_SIMULTANEOUS 2

/**
 * Method in parity space, one satellite after the other.
 */
#define RAI_METHOD_SEQUENTIAL 3

/**
 * Method in parity space, the simultaneous search, else the sequential one.
 */
#define RAI_METHOD_HYBRID 4

/**
 * Method in parity space, every group of satellites.
 */
#define RAI_METHOD_GROUPING 5

/**
 * Method: consensus of disjoint subsets.
 */
#define RAI_METHOD_RANSAC 6

/**
 * Method: ARAIM, which compares solutions with and without every plausible set of satellites. It
 * takes the probabilities of faults from the ICAO's standards, and needs the library's feature
 * `araim`.
 */
#define RAI_METHOD_SEPARATION 7

/**
 * Protection levels bound the error of a protected position, fault and noise together.
 */
#define RAI_LEVELS_BOUND 0

/**
 * Protection levels are the mean error under the worst missed fault, as in the papers.
 */
#define RAI_LEVELS_SLOPE 1

#if !(defined(RAI_SATELLITES_32) || defined(RAI_SATELLITES_48))
/**
 * Most satellites in one epoch.
 */
#define RAI_MAX_SATELLITES 16
#endif

#if (defined(RAI_SATELLITES_32) && !defined(RAI_SATELLITES_48))
/**
 * Most satellites in one epoch.
 */
#define RAI_MAX_SATELLITES 32
#endif

#if defined(RAI_SATELLITES_48)
/**
 * Most satellites in one epoch.
 */
#define RAI_MAX_SATELLITES 48
#endif

#if !(defined(RAI_SATELLITES_32) || defined(RAI_SATELLITES_48))
/**
 * Words of eight bytes of a monitor, enough on every processor.
 */
#define RAI_MONITOR_WORDS 1408
#endif

#if (defined(RAI_SATELLITES_32) && !defined(RAI_SATELLITES_48))
/**
 * Words of eight bytes of a monitor, enough on every processor.
 */
#define RAI_MONITOR_WORDS 1792
#endif

#if defined(RAI_SATELLITES_48)
/**
 * Words of eight bytes of a monitor, enough on every processor.
 */
#define RAI_MONITOR_WORDS 2176
#endif

/**
 * Bytes of a monitor.
 */
#define RAI_MONITOR_SIZE (RAI_MONITOR_WORDS * 8)

#if !(defined(RAI_SATELLITES_32) || defined(RAI_SATELLITES_48))
/**
 * Words of eight bytes of a receiver, enough on every processor.
 */
#define RAI_RECEIVER_WORDS 5376
#endif

#if (defined(RAI_SATELLITES_32) && !defined(RAI_SATELLITES_48))
/**
 * Words of eight bytes of a receiver, enough on every processor.
 */
#define RAI_RECEIVER_WORDS 6016
#endif

#if defined(RAI_SATELLITES_48)
/**
 * Words of eight bytes of a receiver, enough on every processor.
 */
#define RAI_RECEIVER_WORDS 8896
#endif

/**
 * Bytes of a receiver.
 */
#define RAI_RECEIVER_SIZE (RAI_RECEIVER_WORDS * 8)

/**
 * No verdict yet. It counts as unavailable.
 */
#define RAI_STATE_NONE 0

/**
 * The position may be used: an undetected fault of one satellite stays within the alert limits.
 */
#define RAI_STATE_PROTECTED 1

/**
 * The position must not be used, for one of the reasons `RAI_REASON_FAULT` to `RAI_REASON_TIME`.
 */
#define RAI_STATE_ALERT 2

/**
 * The position has no protection, because the means to test it are missing.
 */
#define RAI_STATE_UNAVAILABLE 3

/**
 * No verdict yet.
 */
#define RAI_REASON_NONE 0

/**
 * Protected: all satellites agree.
 */
#define RAI_REASON_OK 1

/**
 * Protected: the satellites agree after the faulty ones were left out.
 */
#define RAI_REASON_EXCLUDED 2

/**
 * Protected: systems contradict each other, and the one whose navigation data are proved has decided.
 */
#define RAI_REASON_SYSTEM 3

/**
 * Protected: several satellites may be the faulty one, and the levels hold for each of them. The one
 * that was left out may be healthy.
 */
#define RAI_REASON_COVERED 4

/**
 * Alert: a fault was detected and could not be isolated.
 */
#define RAI_REASON_FAULT 32

/**
 * Alert: several exclusions explain the data, and no level within the limits holds for each of them.
 */
#define RAI_REASON_AMBIGUOUS 33

/**
 * Alert: no epoch was judged within the time to alert.
 */
#define RAI_REASON_STALE 34

/**
 * Alert: the position moved farther than the receiver can.
 */
#define RAI_REASON_JUMP 35

/**
 * Alert: the receiver reports that its signals are false.
 */
#define RAI_REASON_SPOOFED 36

/**
 * Alert: a wrong time tag of all ranges explains the data.
 */
#define RAI_REASON_TIME 37

/**
 * Alert: epochs of another station or format came, and none of the receiver in use.
 */
#define RAI_REASON_SOURCE 38

/**
 * Alert: the receiver clock contradicts its measured drift.
 */
#define RAI_REASON_CLOCK 39

/**
 * Alert: the motion of the position contradicts its measured velocity.
 */
#define RAI_REASON_TRACK 40

/**
 * Alert: satellites sent navigation data that their system did not make.
 */
#define RAI_REASON_AUTH 41

/**
 * Alert: the time of the signals is not the trusted one.
 */
#define RAI_REASON_REPLAY 42

/**
 * Unavailable: too few satellites for a position, or the fix did not converge.
 */
#define RAI_REASON_NOFIX 64

/**
 * Unavailable: no redundancy to test the position with.
 */
#define RAI_REASON_REDUNDANCY 65

/**
 * Unavailable: the geometry is singular, or leaves a satellite untested that moves the position.
 */
#define RAI_REASON_GEOMETRY 66

/**
 * Unavailable: no threshold meets all probabilities.
 */
#define RAI_REASON_RISK 67

/**
 * Unavailable: the horizontal protection level exceeds its share of the limit.
 */
#define RAI_REASON_HPL 68

/**
 * Unavailable: the vertical protection level exceeds its share of the limit.
 */
#define RAI_REASON_VPL 69

/**
 * Unavailable: the declared work budget cut the search.
 */
#define RAI_REASON_BUDGET 70

/**
 * Unavailable: the whole input was refused.
 */
#define RAI_REASON_INPUT 71

/**
 * Unavailable: the satellites agree again, but not yet for long enough.
 */
#define RAI_REASON_RECOVERING 72

/**
 * Unavailable: the height or place is impossible for the receiver.
 */
#define RAI_REASON_PLACE 73

/**
 * Unavailable: a known answer of the self-test was missed.
 */
#define RAI_REASON_SELFTEST 74

/**
 * Unavailable: ranges came, but no orbits.
 */
#define RAI_REASON_EPHEMERIS 75

/**
 * Unavailable: the host has not confirmed the settings after an unexpected restart.
 */
#define RAI_REASON_SETTINGS 76

/**
 * Unavailable: the effective monitor threshold of ARAIM exceeds its limit.
 */
#define RAI_REASON_EMT 77

/**
 * Unavailable: the vertical accuracy of ARAIM exceeds its limit.
 */
#define RAI_REASON_ACCURACY 78

/**
 * Unavailable: the residuals of the last minute contradict the sigmas, or the satellites left
 * after an exclusion hardly agree.
 */
#define RAI_REASON_SIGMAS 79

/**
 * Unavailable: fewer than four satellites with proved ephemerides were used.
 */
#define RAI_REASON_UNPROVED 80

/**
 * Global Positioning System.
 */
#define RAI_SYSTEM_GPS 71

/**
 * `BeiDou`.
 */
#define RAI_SYSTEM_BEIDOU 67

/**
 * Galileo.
 */
#define RAI_SYSTEM_GALILEO 69

/**
 * GLONASS.
 */
#define RAI_SYSTEM_GLONASS 82

/**
 * QZSS, numbered 1 to 10. Its ranges have the receiver clock of GPS.
 */
#define RAI_SYSTEM_QZSS 74

/**
 * Most satellites that may be left out of one epoch.
 */
#define RAI_MAX_EXCLUDED 3

/**
 * Status of a call: `RAI_STATUS_OK`, or the reason of its refusal.
 */
typedef uint8_t rai_status_t;

/**
 * Memory of a monitor. Its contents are private to the library; only its size and alignment
 * matter.
 */
typedef struct {
    /**
     * Private contents.
     */
    uint64_t opaque[RAI_MONITOR_WORDS];
} rai_monitor_t;

/**
 * Accuracy of the position of an epoch. An undefined number is NaN.
 */
typedef struct {
    /**
     * `sizeof(rai_accuracy_t)`, set by the caller.
     */
    uint32_t size;
    /**
     * System of the satellite used with the largest w-test, `RAI_SYSTEM_…`; 0 if there is none.
     */
    uint8_t suspect_system;
    /**
     * Number of that satellite within the system.
     */
    uint8_t suspect_number;
    /**
     * Reserved for later use.
     */
    uint8_t reserved[2];
    /**
     * W-test of that satellite, in standard deviations, with its sign.
     */
    double suspect_w_test;
    /**
     * Covariance of east, north and up in this order: EE, EN, EU, NN, NU, UU, m².
     */
    double covariance_m2[6];
    /**
     * Horizontal dilution of precision.
     */
    double hdop;
    /**
     * Vertical dilution of precision.
     */
    double vdop;
    /**
     * Root mean square of the residuals of the satellites used, m.
     */
    double residual_rms_m;
    /**
     * Mean of SSE/dof over the last 60 tested epochs: about 1 if the sigmas are right.
     */
    double sigma_check;
    /**
     * Receiver clock of GPS and QZSS times the speed of light, m.
     */
    double gps_clock_m;
    /**
     * Receiver clock of GLONASS times the speed of light, m.
     */
    double glonass_clock_m;
    /**
     * Receiver clock of Galileo times the speed of light, m.
     */
    double galileo_clock_m;
    /**
     * Receiver clock of `BeiDou` times the speed of light, m.
     */
    double beidou_clock_m;
} rai_accuracy_t;

/**
 * Memory of a receiver. Its contents are private to the library; only its size and alignment
 * matter.
 */
typedef struct {
    /**
     * Private contents.
     */
    uint64_t opaque[RAI_RECEIVER_WORDS];
} rai_receiver_t;

/**
 * What is known of Galileo's ephemerides. It is never about ranges, nor about the position.
 */
typedef struct {
    /**
     * `sizeof(rai_authentication_t)`, set by the caller.
     */
    uint32_t size;
    /**
     * State, `RAI_OSNMA_NONE` to `RAI_OSNMA_FALSE`.
     */
    uint8_t state;
    /**
     * Number of the public key that signed the root key; 0 before that.
     */
    uint8_t key;
    /**
     * Number of the chain in force; 0 before there is one.
     */
    uint8_t chain;
    /**
     * Number of satellites in view whose ephemerides are proved.
     */
    uint8_t proved;
    /**
     * Number of those whose ephemerides are not.
     */
    uint8_t unproved;
    /**
     * Number of those whose ephemerides are false.
     */
    uint8_t false_count;
    /**
     * Reserved for later use.
     */
    uint8_t reserved[6];
    /**
     * Age of the oldest proof, s; NaN without a proof.
     */
    double oldest_proof_s;
} rai_authentication_t;

/**
 * Counter of a receiver.
 */
typedef struct {
    /**
     * `sizeof(rai_counter_t)`, set by the caller.
     */
    uint32_t size;
    /**
     * Count since start; it stays at its largest value.
     */
    uint32_t value;
    /**
     * Name, as in the answer to the command `STATS`, with a NUL at its end.
     */
    char name[RAI_COUNTER_NAME_SIZE];
} rai_counter_t;

/**
 * Requirements on a position, and the strategy that monitors it. Fill it with
 * `rai_settings_preset`, then change single fields.
 */
typedef struct {
    /**
     * `sizeof(rai_settings_t)`, set by the caller.
     */
    uint32_t size;
    /**
     * Threshold of the global test, `RAI_POLICY_…`.
     */
    uint8_t policy;
    /**
     * Method that finds faulty satellites, `RAI_METHOD_…`.
     */
    uint8_t method;
    /**
     * Clock aiding: if not 0, a forecast of the receiver clock adds a row to the equations.
     */
    uint8_t clock_aid;
    /**
     * Kind of protection levels, `RAI_LEVELS_…`.
     */
    uint8_t levels;
    /**
     * Horizontal alert limit, m.
     */
    double hal_m;
    /**
     * Vertical alert limit, m; 0 if only the horizontal position matters.
     */
    double val_m;
    /**
     * Probability of a false alarm per epoch, from the committed tables.
     */
    double false_alarm;
    /**
     * Probability of missing a significant fault, from the committed tables.
     */
    double missed_detection;
    /**
     * Highest speed of the receiver, m/s: a position farther from the last one is an alert,
     * `RAI_REASON_JUMP`.
     */
    double max_speed_m_s;
    /**
     * Least height above the ellipsoid, m.
     */
    double min_height_m;
    /**
     * Greatest height above the ellipsoid, m.
     */
    double max_height_m;
    /**
     * Time for which satellites must agree after an alert, s.
     */
    double recovery_s;
    /**
     * Number of epochs for which satellites must agree after an alert.
     */
    uint16_t recovery_epochs;
    /**
     * Reserved for later use; must be 0.
     */
    uint8_t reserved[6];
} rai_settings_t;

/**
 * Corrected range of one satellite, with the satellite's position at transmission.
 */
typedef struct {
    /**
     * Satellite position in the earth-fixed frame at the instant of transmission, x, m.
     */
    double x_m;
    /**
     * Satellite position in the earth-fixed frame at the instant of transmission, y, m.
     */
    double y_m;
    /**
     * Satellite position in the earth-fixed frame at the instant of transmission, z, m.
     */
    double z_m;
    /**
     * Pseudorange corrected for satellite clock, relativity, group delay and atmosphere, m.
     */
    double range_m;
    /**
     * Standard deviation of `range_m`, m.
     */
    double sigma_m;
    /**
     * System of the satellite, a letter: `RAI_SYSTEM_…`.
     */
    uint8_t system;
    /**
     * Number of the satellite within the system, 1 to 99.
     */
    uint8_t number;
    /**
     * Reserved for later use; must be 0.
     */
    uint8_t reserved[6];
} rai_range_t;

/**
 * A satellite that was left out.
 */
typedef struct {
    /**
     * Estimated bias of the range, m.
     */
    double bias_m;
    /**
     * W-test of the satellite when it was suspected, in standard deviations.
     */
    double w_test;
    /**
     * System of the satellite, a letter: `RAI_SYSTEM_…`.
     */
    uint8_t system;
    /**
     * Number of the satellite within the system.
     */
    uint8_t number;
    /**
     * Reserved for later use.
     */
    uint8_t reserved[6];
} rai_excluded_t;

/**
 * Verdict on one epoch. An undefined number is NaN.
 */
typedef struct {
    /**
     * `sizeof(rai_verdict_t)`, set by the caller.
     */
    uint32_t size;
    /**
     * State, `RAI_STATE_…`: the position may be used only if it is `RAI_STATE_PROTECTED`.
     */
    uint8_t state;
    /**
     * Reason of the state, `RAI_REASON_…`.
     */
    uint8_t reason;
    /**
     * Satellites in the epoch.
     */
    uint8_t tracked;
    /**
     * Satellites in the position.
     */
    uint8_t used;
    /**
     * Degrees of freedom of the global test.
     */
    uint8_t dof;
    /**
     * Number of elements of `excluded` that are filled.
     */
    uint8_t excluded_count;
    /**
     * Number of ranges of the call that were refused, at most 255; the others were judged.
     */
    uint8_t refused_count;
    /**
     * Status of the first refused range.
     */
    uint8_t refused_status;
    /**
     * Reserved for later use.
     */
    uint8_t reserved[4];
    /**
     * Statistic of the global test, `√(SSE/dof)`.
     */
    double statistic;
    /**
     * Threshold of the global test.
     */
    double threshold;
    /**
     * Horizontal protection level, m.
     */
    double hpl_m;
    /**
     * Vertical protection level, m.
     */
    double vpl_m;
    /**
     * Earth-fixed position, x, m.
     */
    double x_m;
    /**
     * Earth-fixed position, y, m.
     */
    double y_m;
    /**
     * Earth-fixed position, z, m.
     */
    double z_m;
    /**
     * Geodetic latitude, rad, north positive.
     */
    double latitude_rad;
    /**
     * Longitude, rad, east positive.
     */
    double longitude_rad;
    /**
     * Height above the ellipsoid, m.
     */
    double height_m;
    /**
     * Satellites left out, in the order of exclusion.
     */
    rai_excluded_t excluded[RAI_MAX_EXCLUDED];
} rai_verdict_t;

/**
 * Memory of the caller for sentences, with the number of bytes used.
 */
typedef struct {
    /**
     * Memory for sentences.
     */
    uint8_t *bytes;
    /**
     * Length of the memory, bytes; 2,048 hold the sentences of any epoch.
     */
    size_t capacity;
    /**
     * Bytes used. A call appends to them; the caller sets it to 0 after sending the text.
     */
    size_t length;
    /**
     * Number of sentences without room since the caller last set it to 0. A sentence is written
     * whole or not at all.
     */
    size_t lost;
} rai_text_t;

/**
 * Residual of one satellite's range.
 */
typedef struct {
    /**
     * Range minus distance and receiver clock, m: positive for a range that is too long; NaN if no
     * satellite of its system is used. The residual of an excluded satellite is its bias.
     */
    double residual_m;
    /**
     * Standard deviation of the range, m.
     */
    double sigma_m;
    /**
     * System of the satellite, a letter: `RAI_SYSTEM_…`.
     */
    uint8_t system;
    /**
     * Number of the satellite within the system.
     */
    uint8_t number;
    /**
     * True (1) if the satellite is part of the position, else 0.
     */
    uint8_t is_used;
    /**
     * Reserved for later use.
     */
    uint8_t reserved[5];
} rai_residual_t;

/**
 * Velocity at an epoch. All numbers are NaN if the range rates gave none that passed its test.
 */
typedef struct {
    /**
     * `sizeof(rai_velocity_t)`, set by the caller.
     */
    uint32_t size;
    /**
     * Degrees of freedom of the test of the range rates.
     */
    uint8_t dof;
    /**
     * Number of satellites whose range rate was left out.
     */
    uint8_t excluded_count;
    /**
     * Reserved for later use.
     */
    uint8_t reserved[2];
    /**
     * Velocity to the east, m/s.
     */
    double east_m_s;
    /**
     * Velocity to the north, m/s.
     */
    double north_m_s;
    /**
     * Velocity upwards, m/s.
     */
    double up_m_s;
    /**
     * Covariance of east, north and up in this order: EE, EN, EU, NN, NU, UU, m²/s².
     */
    double covariance_m2_s2[6];
    /**
     * Drift of the receiver clock times the speed of light, m/s.
     */
    double clock_drift_m_s;
    /**
     * Bound on the horizontal error, m/s.
     */
    double horizontal_level_m_s;
    /**
     * Bound on the vertical error, m/s.
     */
    double vertical_level_m_s;
    /**
     * Statistic of the test, `√(SSE/dof)`.
     */
    double statistic;
    /**
     * Threshold of the test.
     */
    double threshold;
} rai_velocity_t;

/**
 * Success.
 */
#define RAI_STATUS_OK 0

/**
 * A pointer must not be null.
 */
#define RAI_STATUS_NULL 1

/**
 * A pointer must be aligned for its type.
 */
#define RAI_STATUS_MISALIGNED 2

/**
 * The memory is shorter than the object.
 */
#define RAI_STATUS_SHORT 3

/**
 * The object was not initialised, or by another version.
 */
#define RAI_STATUS_NOT_INITIALISED 4

/**
 * The size at the start of a struct belongs to no version known here.
 */
#define RAI_STATUS_SIZE 5

/**
 * A time must be finite.
 */
#define RAI_STATUS_TIME 6

/**
 * A count or length is out of bounds.
 */
#define RAI_STATUS_COUNT 7

/**
 * A text must be printable ASCII without `$` and `*`, and of at most 192 characters; a key has no
 * comma.
 */
#define RAI_STATUS_TEXT 8

/**
 * The phase of flight is unknown.
 */
#define RAI_STATUS_PHASE 16

/**
 * The horizontal alert limit must be in (0, 1e6] m.
 */
#define RAI_STATUS_HAL 17

/**
 * The vertical alert limit must be in (0, 1e6] m.
 */
#define RAI_STATUS_VAL 18

/**
 * The probability of false alarm must be in the committed tables.
 */
#define RAI_STATUS_FALSE_ALARM 19

/**
 * The probability of missed detection must be in the committed tables.
 */
#define RAI_STATUS_MISSED_DETECTION 20

/**
 * The policy is unknown.
 */
#define RAI_STATUS_POLICY 21

/**
 * The method is unknown in this library.
 */
#define RAI_STATUS_METHOD 22

/**
 * The kind of protection levels is unknown.
 */
#define RAI_STATUS_LEVELS 23

/**
 * A setting is out of its range.
 */
#define RAI_STATUS_SETTING 24

/**
 * The highest speed must be in [0, 1e5] m/s.
 */
#define RAI_STATUS_SPEED 25

/**
 * The heights must be in [−1.2e4, 1e8] m, the least below the greatest.
 */
#define RAI_STATUS_HEIGHT 26

/**
 * The recovery must be of at least one epoch and in [0, 3600] s.
 */
#define RAI_STATUS_RECOVERY 27

/**
 * The satellite is unknown.
 */
#define RAI_STATUS_SATELLITE 32

/**
 * A range must be finite and within that of receiver clocks.
 */
#define RAI_STATUS_RANGE 33

/**
 * A satellite's position must be finite, above the earth and within 100,000 km.
 */
#define RAI_STATUS_POSITION 34

/**
 * A standard deviation must be finite and in 1 mm to 1,000 km.
 */
#define RAI_STATUS_SIGMA 35

/**
 * A satellite appears twice.
 */
#define RAI_STATUS_DUPLICATE 36

/**
 * The epoch has more satellites than the library was built for.
 */
#define RAI_STATUS_FULL 37

/**
 * No setting and no order has this key.
 */
#define RAI_STATUS_KEY 48

/**
 * The key needs a value more.
 */
#define RAI_STATUS_VALUE_MISSING 49

/**
 * The key takes fewer values.
 */
#define RAI_STATUS_VALUE_EXTRA 50

/**
 * The value must be one of the key's words.
 */
#define RAI_STATUS_WORD 51

/**
 * The library was built without this key or word.
 */
#define RAI_STATUS_NOT_IN_BUILD 52

/**
 * The value must be a decimal number.
 */
#define RAI_STATUS_NUMBER 53

/**
 * Ionospheric coefficients must not all be zero.
 */
#define RAI_STATUS_ALL_ZERO 54

/**
 * The probability must be in the committed tables; the answer names the nearest.
 */
#define RAI_STATUS_PROBABILITY 55

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/**
 * Returns the version of the interface that the library was compiled with, equal to
 * `RAI_ABI_VERSION` of a matching header.
 */
uint32_t rai_abi_version(void);

/**
 * Returns the version of the library, equal to `RAI_VERSION` of the header that came with it; a
 * string that lives as long as the program.
 */
const char *rai_version(void);

/**
 * Writes the accuracy of the position that the last call of `rai_monitor_judge` has found.
 *
 * # Safety
 * `monitor` is null or points to memory of that size with initialised contents, not used elsewhere
 * during the call. `accuracy` is null or points to a struct of the size that it begins with.
 */
rai_status_t rai_monitor_accuracy(const rai_monitor_t *monitor, rai_accuracy_t *accuracy);

/**
 * Writes the accuracy of the position of the last epoch. After a silence all numbers are NaN.
 *
 * # Safety
 * As for `rai_receiver_pin`; `accuracy` is null or points to a struct of the size that it begins
 * with.
 */
rai_status_t rai_receiver_accuracy(const rai_receiver_t *receiver, rai_accuracy_t *accuracy);

/**
 * Writes what is known of Galileo's ephemerides now, as the sentence `PRAIO` does.
 *
 * # Safety
 * As for `rai_receiver_pin`; `authentication` is null or points to a struct of the size that it begins
 * with.
 */
rai_status_t rai_receiver_authentication(const rai_receiver_t *receiver,
                                         rai_authentication_t *authentication);

/**
 * Writes the counter with this number, counted from 0. Refuses numbers beyond the last with
 * `RAI_STATUS_COUNT`, so that a loop ends there.
 *
 * The numbers are those of one build of the library; a program that wants one counter compares the
 * names.
 *
 * # Safety
 * As for `rai_receiver_pin`; `counter` is null or points to a struct of the size that it begins
 * with.
 */
rai_status_t rai_receiver_counter(const rai_receiver_t *receiver, size_t number, rai_counter_t *counter);

/**
 * Makes a monitor without a position in memory of the caller.
 *
 * Refuses null and misaligned pointers, less than `rai_monitor_size()` bytes, and settings out of
 * their range. A refusal leaves a monitor that was in the memory as it is.
 *
 * # Safety
 * `memory` is null or points to `length` bytes that no other code uses during the call. `settings`
 * is null or points to a struct of the size that it begins with.
 */
rai_status_t rai_monitor_init(rai_monitor_t *memory, size_t length, const rai_settings_t *settings);

/**
 * Replaces the settings and keeps the state. Refused settings change nothing.
 *
 * # Safety
 * `monitor` is null or points to memory of that size with initialised contents, not used elsewhere
 * during the call. `settings` is null or points to a struct of the size that it begins with.
 */
rai_status_t rai_monitor_configure(rai_monitor_t *monitor, const rai_settings_t *settings);

/**
 * Forgets the last position, so that the next may be anywhere.
 *
 * # Safety
 * `monitor` is null or points to memory of that size with initialised contents, not used elsewhere
 * during the call.
 */
rai_status_t rai_monitor_forget(rai_monitor_t *monitor);

/**
 * Judges one epoch: `count` ranges of one instant.
 *
 * `time_s` counts seconds of any continuous time scale. An invalid range is left out and counted
 * in the verdict; the others are judged. The verdict is written if, and only if, the status is
 * `RAI_STATUS_OK`.
 *
 * # Safety
 * `monitor` is null or points to memory of that size with initialised contents, not used elsewhere
 * during the call. `ranges` is null or points to `count` ranges. `verdict` is null or points to a
 * struct of the size that it begins with.
 */
rai_status_t rai_monitor_judge(rai_monitor_t *monitor,
                               double time_s,
                               const rai_range_t *ranges,
                               size_t count,
                               rai_verdict_t *verdict);

/**
 * Returns the bytes of a monitor on this processor, at most `RAI_MONITOR_SIZE`.
 */
size_t rai_monitor_size(void);

/**
 * Returns the alignment of a monitor on this processor, bytes.
 */
size_t rai_monitor_align(void);

/**
 * Makes a receiver in memory of the caller, and writes sentences with its version and the result
 * of the self-test.
 *
 * # Safety
 * `memory` is null or points to `length` bytes that no other code uses during the call. `out` is
 * null or points to a text whose `bytes` point to `capacity` bytes.
 */
rai_status_t rai_receiver_init(rai_receiver_t *memory, size_t length, rai_text_t *out);

/**
 * Takes bytes of the GNSS port that came at `now_ms`, milliseconds of a clock that does not go
 * back and is accurate to 4 %. A larger clock error delays the detection of late bytes.
 *
 * If `judged` is not null, it becomes 1 if an epoch was judged during the call, else 0. Set the
 * pin after each call.
 *
 * # Safety
 * `receiver` is null or points to memory of that size with initialised contents, not used
 * elsewhere during the call. `bytes` is null or points to `count` bytes; `out` as for
 * `rai_receiver_init`; `judged` is null or points to a byte.
 */
rai_status_t rai_receiver_gnss(rai_receiver_t *receiver,
                               const uint8_t *bytes,
                               size_t count,
                               uint64_t now_ms,
                               rai_text_t *out,
                               uint8_t *judged);

/**
 * Advances the time, which detects a silent line. Call it at least ten times a second, and set the
 * pin after each call.
 *
 * # Safety
 * As for `rai_receiver_gnss`.
 */
rai_status_t rai_receiver_tick(rai_receiver_t *receiver, uint64_t now_ms, rai_text_t *out);

/**
 * Takes bytes of the host port, which are commands as sentences. Set the pin after each call.
 *
 * # Safety
 * As for `rai_receiver_gnss`.
 */
rai_status_t rai_receiver_command(rai_receiver_t *receiver,
                                  const uint8_t *bytes,
                                  size_t count,
                                  rai_text_t *out);

/**
 * Obeys one command, given as its key and its values: `"PHASE", "LPV200"` or `"OUTPUT", "RMC,1"`.
 * Null for `values` asks for the value in force. Set the pin after each call.
 *
 * Keys and values are those of `rai_receiver_command`, without address and checksum. The answer is
 * written to `out`. A refused command has changed nothing; `rai_status_text` has the reason.
 *
 * # Safety
 * As for `rai_receiver_gnss`; `key` is null or points to a text that ends with NUL, and so is
 * `values`.
 */
rai_status_t rai_receiver_set(rai_receiver_t *receiver, const char *key, const char *values, rai_text_t *out);

/**
 * Returns the level of the integrity pin: 1 while the position of the last epoch may be used, else
 * 0, also for an invalid handle.
 *
 * # Safety
 * `receiver` is null or points to memory of that size with initialised contents, not used
 * elsewhere during the call.
 */
uint8_t rai_receiver_pin(const rai_receiver_t *receiver);

/**
 * Returns 1 if the host has requested a restart by command, else 0. The caller then makes the
 * receiver again.
 *
 * # Safety
 * As for `rai_receiver_pin`.
 */
uint8_t rai_receiver_reset_requested(const rai_receiver_t *receiver);

/**
 * Returns the state of the last verdict (`RAI_STATE_…`), and writes its reason (`RAI_REASON_…`) to
 * `reason`.
 *
 * # Safety
 * As for `rai_receiver_pin`; `reason` is null or points to a byte.
 */
uint8_t rai_receiver_state(const rai_receiver_t *receiver, uint8_t *reason);

/**
 * Writes the last verdict: state and reason, and of the last epoch its position, levels and the
 * satellites left out.
 *
 * Before the first epoch the state is `RAI_STATE_NONE`; after a silence the verdict has no
 * position. Only `rai_receiver_pin` states if the position may be used now, because changed
 * settings drop the pin before the next epoch. The sentences count refused ranges; `refused_count`
 * is 0 here.
 *
 * # Safety
 * As for `rai_receiver_pin`; `verdict` is null or points to a struct of the size that it begins
 * with.
 */
rai_status_t rai_receiver_report(const rai_receiver_t *receiver, rai_verdict_t *verdict);

/**
 * Returns the bytes of a receiver on this processor, at most `RAI_RECEIVER_SIZE`.
 */
size_t rai_receiver_size(void);

/**
 * Returns the alignment of a receiver on this processor, bytes.
 */
size_t rai_receiver_align(void);

/**
 * Writes the residuals of the epoch that the last call of `rai_monitor_judge` has judged, and
 * their number to `count`. Without a position there are none.
 *
 * Refuses a `capacity` below the number of satellites; `RAI_MAX_SATELLITES` is always enough.
 *
 * # Safety
 * `monitor` is null or points to memory of that size with initialised contents, not used elsewhere
 * during the call. `residuals` is null or points to `capacity` residuals, `count` is null or
 * points to a number.
 */
rai_status_t rai_monitor_residuals(const rai_monitor_t *monitor,
                                   rai_residual_t *residuals,
                                   size_t capacity,
                                   size_t *count);

/**
 * Writes the residuals of the last epoch, after all corrections, and their number to `count`.
 * Without a position, and after a silence, there are none.
 *
 * Refuses a `capacity` below the number of satellites; `RAI_MAX_SATELLITES` is always enough.
 *
 * # Safety
 * As for `rai_receiver_pin`; `residuals` is null or points to `capacity` residuals, `count` is
 * null or points to a number.
 */
rai_status_t rai_receiver_residuals(const rai_receiver_t *receiver,
                                    rai_residual_t *residuals,
                                    size_t capacity,
                                    size_t *count);

/**
 * Fills settings with those of a phase of flight, `RAI_PHASE_…`, and the default method of the
 * module.
 *
 * Refuses a null or misaligned pointer, an unknown `size` and an unknown phase.
 *
 * # Safety
 * `settings` is null or points to a struct whose `size` states how much of it may be written.
 */
rai_status_t rai_settings_preset(rai_settings_t *settings, uint8_t phase);

/**
 * Returns a status in lower-case words, a string that lives as long as the program.
 */
const char *rai_status_text(rai_status_t status);

/**
 * Writes the velocity at the last epoch.
 *
 * # Safety
 * As for `rai_receiver_pin`; `velocity` is null or points to a struct of the size that it begins
 * with.
 */
rai_status_t rai_receiver_velocity(const rai_receiver_t *receiver, rai_velocity_t *velocity);

/**
 * Returns the word of a reason in the sentences, a string that lives as long as the program; `?`
 * for an unknown one.
 */
const char *rai_reason_text(uint8_t reason);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* RAI_H */

/* The layout that the library was compiled for: if one of these fails, the compiler lays structs out differently. */
RAI_ASSERT(sizeof(rai_settings_t) == 80, rai_settings_t_has_another_layout);
RAI_ASSERT(sizeof(rai_range_t) == 48, rai_range_t_has_another_layout);
RAI_ASSERT(sizeof(rai_verdict_t) == 168, rai_verdict_t_has_another_layout);
RAI_ASSERT(sizeof(rai_accuracy_t) == 128, rai_accuracy_t_has_another_layout);
RAI_ASSERT(sizeof(rai_velocity_t) == 120, rai_velocity_t_has_another_layout);
RAI_ASSERT(sizeof(rai_authentication_t) == 24, rai_authentication_t_has_another_layout);
RAI_ASSERT(sizeof(rai_residual_t) == 24, rai_residual_t_has_another_layout);
RAI_ASSERT(sizeof(rai_counter_t) == 44, rai_counter_t_has_another_layout);
RAI_ASSERT(sizeof(rai_monitor_t) == RAI_MONITOR_SIZE, rai_monitor_t_has_another_layout);
RAI_ASSERT(sizeof(rai_receiver_t) == RAI_RECEIVER_SIZE, rai_receiver_t_has_another_layout);
