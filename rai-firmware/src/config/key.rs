//! Keys: what a command can be about.

/// The subject of a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Key {
    /// `PHASE`: requirements by name.
    Phase,
    /// `HAL`: horizontal alert limit.
    HorizontalAlertLimit,
    /// `VAL`: vertical alert limit.
    VerticalAlertLimit,
    /// `PFA`: probability of a false alarm.
    FalseAlarm,
    /// `PMD`: probability of a missed detection.
    MissedDetection,
    /// `PFF`: risk without a fault.
    FaultFree,
    /// `TTA`: time to alert.
    TimeToAlert,
    /// `POLICY`: threshold of the global test.
    Policy,
    /// `METHOD`: how faulty satellites are found.
    Method,
    /// `LEVELS`: what the protection levels hold.
    Levels,
    /// `SYSTEMS`: who takes part.
    Systems,
    /// `MASK`: elevation mask.
    Mask,
    /// `CLOCKAID`: forecast of the receiver clock.
    ClockAid,
    /// `CN0MASK`: least strength of a signal.
    SignalMask,
    /// `VMAX`: greatest speed.
    GreatestSpeed,
    /// `HEIGHT`: least and greatest height.
    Heights,
    /// `RECOVER`: how long satellites must agree after an alert.
    Recovery,
    /// `FREQ`: one frequency or two.
    Frequencies,
    /// `SIGMA`: sigmas of the ranges.
    Sigma,
    /// `BAUD`: bit rate of the GNSS port.
    BitRate,
    /// `IONO`: coefficients of the ionosphere.
    Ionosphere,
    /// `ISM`: integrity support message.
    Support,
    /// `OUTPUT`: what is sent, how often.
    Output,
    /// `STATS`: counters.
    Statistics,
    /// `SELFTEST`: known answers.
    SelfTest,
    /// `CONFIRM`: the settings in force are meant.
    Confirm,
    /// `FORGET`: the last position counts for nothing.
    Forget,
    /// `WEEK`: the week of a recording.
    Week,
    /// `RESET`: start again.
    Reset,
}

/// Every key: its name, and whether this build does what it asks for. What is known and not built in is refused by
/// name, so that nobody believes it done.
const KEYS: [(&str, Key, bool); 29] = [
    ("PHASE", Key::Phase, true),
    ("HAL", Key::HorizontalAlertLimit, true),
    ("VAL", Key::VerticalAlertLimit, true),
    ("PFA", Key::FalseAlarm, true),
    ("PMD", Key::MissedDetection, true),
    ("PFF", Key::FaultFree, true),
    ("TTA", Key::TimeToAlert, true),
    ("POLICY", Key::Policy, true),
    ("METHOD", Key::Method, true),
    ("LEVELS", Key::Levels, true),
    ("SYSTEMS", Key::Systems, true),
    ("MASK", Key::Mask, true),
    ("CLOCKAID", Key::ClockAid, true),
    ("CN0MASK", Key::SignalMask, true),
    ("VMAX", Key::GreatestSpeed, true),
    ("HEIGHT", Key::Heights, true),
    ("RECOVER", Key::Recovery, true),
    ("FREQ", Key::Frequencies, true),
    ("SIGMA", Key::Sigma, true),
    ("BAUD", Key::BitRate, true),
    ("IONO", Key::Ionosphere, true),
    ("ISM", Key::Support, true),
    ("OUTPUT", Key::Output, true),
    ("STATS", Key::Statistics, true),
    ("SELFTEST", Key::SelfTest, true),
    ("CONFIRM", Key::Confirm, true),
    ("FORGET", Key::Forget, true),
    ("WEEK", Key::Week, true),
    ("RESET", Key::Reset, true),
];

impl Key {
    /// The key of this name.
    pub fn named(name: &str) -> Option<Self> {
        KEYS.iter().find(|(known, ..)| *known == name).map(|(_, key, _)| *key)
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        self.entry().map_or("", |(name, ..)| name)
    }

    /// Is what it asks for built in?
    pub fn is_built(self) -> bool {
        self.entry().is_some_and(|(.., built)| *built)
    }

    fn entry(self) -> Option<&'static (&'static str, Self, bool)> {
        KEYS.iter().find(|(_, key, _)| *key == self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_has_one_name_and_every_name_one_key() {
        for (name, key, built) in KEYS {
            assert_eq!((Key::named(name), key.name(), key.is_built()), (Some(key), name, built));
        }
        assert_eq!(Key::named("VOLUME"), None);
    }
}
