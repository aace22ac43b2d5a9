//! The publisher: sends each sentence and message when it is due.
//!
//! | sent | when |
//! |---|---|
//! | the items of the [`Schedule`] | at their rates; all with a nonzero rate if the state is worse than that of the epoch before |
//! | `PRAIS`, `PRAIN` | with every epoch; `PRAIS` also with a verdict without an epoch, such as `STALE` |
//! | `PRAIX`, `PRAIM`, `PRAIH`, `PRAIE` | with every epoch to which they apply ([`crate::output::nmea`]) |
//! | `PRAIQ` | at start, after every change, every 60 s |
//! | `PRAIL` | every 60 s |

use embedded_io::Write;
use raim_core::report::Verdict;

use crate::output::Statement;
#[cfg(feature = "mavlink")]
use crate::output::mavlink::Sender;
#[cfg(feature = "osnma")]
use crate::output::nmea::AuthenticationReport;
use crate::output::nmea::{Losses, TimeOfDay, write_epoch, write_losses, write_without_epoch};
use crate::output::schedule::{Item, Schedule};
use crate::settings::Configuration;
use crate::time::GpsTime;

/// Time between repetitions of settings and losses, ms.
const AGAIN_MS: u64 = 60_000;

/// State between epochs.
#[derive(Clone, Debug)]
pub struct Publisher {
    epochs: u32,
    /// Distance of the last epoch from protection.
    told: Distance,
    /// Last second that `ZDA` has reported.
    told_second: Option<u32>,
    #[cfg(feature = "mavlink")]
    sender: Sender,
    settings_hash: u32,
    settings_due_ms: u64,
    losses_due_ms: u64,
}

/// Distance of a state from protection.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Distance {
    Protected,
    Unavailable,
    Alert,
}

impl Distance {
    const fn of(verdict: Verdict) -> Self {
        match verdict {
            Verdict::Protected(_) => Self::Protected,
            Verdict::Unavailable(_) => Self::Unavailable,
            Verdict::Alert(_) => Self::Alert,
        }
    }
}

impl Publisher {
    /// Returns a publisher before the first epoch, with the hash of the settings in force.
    pub fn new(settings_hash: u32) -> Self {
        Self {
            epochs: 0,
            told: Distance::Alert,
            told_second: None,
            #[cfg(feature = "mavlink")]
            sender: Sender::default(),
            settings_hash,
            settings_due_ms: 0,
            losses_due_ms: AGAIN_MS,
        }
    }

    /// Stores the hash of changed settings, which the next tick reports.
    pub fn reconfigured(&mut self, settings_hash: u32) {
        self.settings_hash = settings_hash;
        self.settings_due_ms = 0;
    }

    /// Takes what is known of the authentication, for the messages of this epoch.
    #[cfg(feature = "osnma")]
    pub(crate) fn authenticated(&mut self, report: Option<&AuthenticationReport>, is_off: bool) {
        #[cfg(not(feature = "mavlink"))]
        let _ = (report, is_off);
        #[cfg(feature = "mavlink")]
        {
            const DISABLED: u8 = 4;
            self.sender.authentication =
                if is_off { Some(DISABLED) } else { report.map(AuthenticationReport::state) };
        }
    }

    /// Returns the hash of the settings in force.
    pub fn settings_hash(&self) -> u32 {
        self.settings_hash
    }

    /// Sends the sentences and messages of an epoch.
    ///
    /// # Errors
    /// The writer's own, of the first sentence that it did not take.
    pub fn tell<W: Write, const N: usize>(
        &mut self,
        statement: &Statement<'_, N>,
        schedule: &Schedule,
        out: &mut W,
    ) -> Result<(), W::Error> {
        let distance = Distance::of(statement.report.verdict);
        // A worse state is sent at once. Otherwise, at a low rate, the host would take the last
        // state for the present one.
        let is_worse = distance > core::mem::replace(&mut self.told, distance);
        let mut due = schedule.due(if is_worse { 0 } else { self.epochs });
        self.epochs = self.epochs.wrapping_add(1);
        if due.has(Item::Zda) {
            let second = TimeOfDay::new(statement.time, statement.gps_minus_utc_s).second();
            if self.told_second.replace(second) == Some(second) {
                due = due.without(Item::Zda);
            }
        }
        write_epoch(statement, due, out)?;
        #[cfg(feature = "mavlink")]
        self.sender.write_epoch(statement, due, out)?;
        Ok(())
    }

    /// Sends a verdict without an epoch: no epoch was judged within the time to alert, or settings
    /// have changed.
    ///
    /// # Errors
    /// The writer's own.
    pub fn tell_without_epoch<W: Write>(
        &mut self,
        verdict: Verdict,
        last: Option<GpsTime>,
        gps_minus_utc_s: u8,
        configuration: &Configuration,
        out: &mut W,
    ) -> Result<(), W::Error> {
        write_without_epoch(verdict, last, gps_minus_utc_s, &configuration.requirements(), out)?;
        #[cfg(feature = "mavlink")]
        self.sender.write_stale(verdict, configuration.outputs.due(0), out)?;
        Ok(())
    }

    /// Repeats settings and losses if they are due.
    ///
    /// # Errors
    /// The writer's own.
    pub fn tick<W: Write>(
        &mut self,
        now_ms: u64,
        configuration: &Configuration,
        losses: &Losses,
        out: &mut W,
    ) -> Result<(), W::Error> {
        if now_ms >= self.settings_due_ms {
            self.settings_due_ms = now_ms + AGAIN_MS;
            configuration.write(out)?;
        }
        if now_ms >= self.losses_due_ms {
            self.losses_due_ms = now_ms + AGAIN_MS;
            write_losses(losses, out)?;
        }
        Ok(())
    }
}
