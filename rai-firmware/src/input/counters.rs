//! What came in and what was not used.

use crate::counters::counters;

counters! {
    /// What came in and what was not used, by reason.
    Counters {
        /// Frames with a right check.
        frames,
        /// Bytes that belong to no good frame.
        bytes_skipped,
        /// Frames whose check was wrong.
        crc_failures,
        /// Beginnings of frames that were passed over because too many before them had been none.
        frames_unchecked,
        /// Frames that had not ended when the line fell silent, or when another inside them was
        /// complete and right.
        frames_cut,
        /// Messages of a type that is not read.
        messages_other,
        /// Observations of systems that are not used, SBAS and `NavIC`, and without full ranges:
        /// MSM1 to MSM3.
        observations_other,
        /// Messages too short for their type, or that contradict themselves.
        messages_malformed,
        /// Ephemerides decoded.
        ephemerides,
        /// Ephemerides with a value that no satellite sends.
        ephemerides_invalid,
        /// Messages of ranges that had come in another format already, or are of another station.
        observations_doubled,
        /// GLONASS messages before anything has said how many leap seconds there are.
        leap_unknown,
        /// Frames of navigation bits that were read.
        subframes,
        /// Frames of navigation bits of signals that are not read.
        subframes_other,
        /// Frames of navigation bits with another number of words, preamble or page than theirs.
        subframes_malformed,
        /// Navigation bits with a wrong parity or CRC.
        subframes_parity,
        /// Navigation bits beyond the sets that are assembled at a time.
        subframes_surplus,
        /// Sets of navigation bits whose pages are of different issues.
        subframes_mixed,
        /// Sets of navigation bits that lacked a page and were given up when none had come for two
        /// minutes.
        subframes_abandoned,
        /// Reference positions far from the surface of the earth.
        positions_invalid,
        /// Epochs handed on.
        epochs,
        /// Epochs, and ephemerides of GLONASS, dropped because nothing has told the week yet.
        epochs_without_week,
        /// Epochs dropped because they are not newer than the last one.
        epochs_backwards,
        /// Epochs dropped because their ranges are those of the epoch before, bit for bit.
        epochs_repeated,
        /// Times that went back and were accepted: they went on from there, or from what was known
        /// to be right.
        time_restarts,
        /// Weeks corrected because the ephemerides agreed on another one.
        week_corrections,
        /// Epochs dropped because bytes of them were lost.
        epochs_broken,
        /// Epochs of which observations came after a message had said that none would follow.
        observations_after_end,
        /// Observations without satellites that were tagged far ahead, or came before all others.
        observations_ahead,
        /// Observations dropped because their time of week is none.
        times_out_of_range,
        /// Signals of satellites that came twice in one epoch; the first are used.
        satellites_duplicate,
        /// Satellites with a number that their system does not have.
        satellites_unknown,
        /// Signals of satellites beyond the capacity of an epoch.
        satellites_surplus,
        /// Signals on bands that are not used.
        signals_other,
        /// Signals beyond what is kept of one satellite, or a second code on the same band.
        signals_surplus,
        /// Signals without a range.
        ranges_missing,
        /// Ranges that no satellite can have.
        ranges_out_of_bounds,
    }
}
