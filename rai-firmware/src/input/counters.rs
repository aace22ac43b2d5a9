//! Counters of received and unused input.

use crate::counters::counters;

counters! {
    /// Received and unused input, by reason.
    Counters {
        /// Frames that passed their check.
        frames,
        /// Bytes that belong to no valid frame.
        bytes_skipped,
        /// Frames that failed their check.
        crc_failures,
        /// Candidates that were skipped without a check, because too many before them had failed.
        frames_unchecked,
        /// Frames that were incomplete when the line fell silent, or when a frame inside them was
        /// complete and valid.
        frames_cut,
        /// Messages of a type that is not read.
        messages_other,
        /// Observations of unused systems, SBAS and `NavIC`, and messages without full ranges: MSM1
        /// to MSM3.
        observations_other,
        /// Messages too short for their type, or that contradict themselves.
        messages_malformed,
        /// Ephemerides decoded.
        ephemerides,
        /// Ephemerides with a value that no satellite sends.
        ephemerides_invalid,
        /// Messages of ranges from a source that is not in use: another format or another station.
        observations_doubled,
        /// GLONASS messages before the leap seconds are known.
        leap_unknown,
        /// Frames of navigation bits that were read.
        subframes,
        /// Frames of navigation bits whose signal is not read.
        subframes_other,
        /// Frames of navigation bits with a wrong number of words, preamble or page.
        subframes_malformed,
        /// Navigation bits with a wrong parity or CRC.
        subframes_parity,
        /// Frames of navigation bits for which no slot is free.
        subframes_surplus,
        /// Sets of navigation bits whose pages are of different issues.
        subframes_mixed,
        /// Incomplete sets of navigation bits that were discarded, because no page came for two
        /// minutes.
        subframes_abandoned,
        /// Reference positions far from the surface of the earth.
        positions_invalid,
        /// Epochs that were complete and passed on.
        epochs,
        /// Epochs, and ephemerides of GLONASS, dropped because the week is unknown.
        epochs_without_week,
        /// Epochs dropped because they are not newer than the last one.
        epochs_backwards,
        /// Epochs dropped because their ranges equal those of the epoch before, bit for bit.
        epochs_repeated,
        /// Times that went back and were accepted, because later epochs continued from there or a
        /// confirmed epoch led to them.
        time_restarts,
        /// Weeks corrected because the ephemerides agreed on another one.
        week_corrections,
        /// Epochs dropped because bytes of them were lost.
        epochs_broken,
        /// Epochs with observations after a message had stated that none would follow.
        observations_after_end,
        /// Observations without satellites whose time is far ahead or not that of the open epoch,
        /// or that came before all others.
        observations_ahead,
        /// Observations of a system with a wrong time: the message before stated that more of its
        /// instant follow.
        observations_astray,
        /// Observations dropped because their time of week is out of range.
        times_out_of_range,
        /// Signals of satellites that came twice in one epoch; the first ones are used.
        satellites_duplicate,
        /// Satellites with a number that their system does not have.
        satellites_unknown,
        /// Signals of satellites beyond the capacity of an epoch.
        satellites_surplus,
        /// Signals on unused bands.
        signals_other,
        /// Signals beyond the capacity of one satellite, or a second code on the same band.
        signals_surplus,
        /// Signals without a range.
        ranges_missing,
        /// Ranges that are impossible for a satellite.
        ranges_out_of_bounds,
        /// Compressed ranges of SBF, which are not read, while its plain ones are missing.
        ["sbf"]
        meas3_only,
        /// Epochs of SBF whose ranges are smoothed by their carriers.
        ["sbf"]
        codes_smoothed,
        /// Epochs of SBF whose ranges are scrambled, because the receiver lacks a permission.
        ["sbf"]
        epochs_scrambled,
    }
}
