//! Counters of verdicts.

use crate::counters::counters;

counters! {
    /// Verdicts of the epochs, and events that prevented one.
    Verdicts {
        /// Epochs whose position is usable.
        epochs_protected,
        /// Epochs whose position must not be used.
        epochs_alert,
        /// Epochs without protection.
        epochs_unavailable,
        /// Epochs that were older than the time to alert when complete. The age
        /// includes their lateness.
        epochs_late,
        /// Epochs that were not judged, because their last byte had waited too long behind others.
        epochs_skipped,
        /// Alerts because no epoch was judged for the time to alert.
        line_stale,
        /// Ephemerides that were not stored, because the store kept the one in use. The new one is
        /// out of date, of F/NAV while I/NAV is in use, or of RTCM beside the receiver's own.
        ephemerides_kept,
        /// Ephemerides that contradict the one in use.
        ephemerides_disputed,
        /// Epochs whose known height contradicted the satellites and was left out.
        heights_excluded,
        /// Heights of the host that expired before the host sent a new one.
        heights_expired,
        /// Epochs with signal strengths that indicate a counterfeit.
        strengths_alike,
        /// Sentences that the host port did not take.
        host_lost,
        /// Times that the pin could not be set.
        pin_failures,
        /// Epochs in which a whole system was left out.
        system_excluded,
    }
}
