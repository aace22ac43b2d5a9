//! Counters of what was checked.

use crate::counters::counters;

counters! {
    /// What was checked of OSNMA since start.
    Tally {
        /// Root keys whose signature was right.
        osnma_roots_right,
        /// Root keys whose signature was wrong.
        osnma_roots_wrong,
        /// New public keys and alerts that the root of the tree proves.
        osnma_renewals,
        /// Keys of subframes that follow from the chain, one for each satellite that sent one.
        osnma_keys_right,
        /// Keys of subframes that do not follow from the chain.
        osnma_keys_wrong,
        /// MACK messages whose flexible slots are those that the sender meant.
        osnma_sequences_right,
        /// MACK messages whose flexible slots are others.
        osnma_sequences_wrong,
        /// Tags of orbit and clock that are right.
        osnma_orbits_right,
        /// Tags of orbit and clock that are wrong.
        osnma_orbits_wrong,
        /// Tags of time parameters that are right.
        osnma_times_right,
        /// Tags of time parameters that are wrong.
        osnma_times_wrong,
        /// Tags of orbit and clock with a later key that are right.
        osnma_slow_right,
        /// Tags of orbit and clock with a later key that are wrong.
        osnma_slow_wrong,
        /// Tags whose words were not all received.
        osnma_tags_unread,
    }
}
