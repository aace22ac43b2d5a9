//! Counters of the whole module, and the losses that it reports on its own.

use embedded_hal::digital::OutputPin;

use super::Receiver;
use crate::board::PortLosses;
use crate::counters::at;
use crate::output::nmea::Losses;

impl<P: OutputPin, O> Receiver<P, O> {
    pub(super) fn losses_to_say(&self) -> Losses {
        let wire = self.input.counters();
        let PortLosses { gnss_bytes_lost, gnss_bytes_dropped, command_bytes_lost, .. } = self.losses;
        Losses {
            gnss_bytes: gnss_bytes_lost.saturating_add(gnss_bytes_dropped),
            host_bytes: command_bytes_lost,
            frames_refused: wire.crc_failures.saturating_add(wire.messages_malformed),
            epochs_late: self.epochs.verdicts.epochs_late,
        }
    }

    /// Returns every counter by name: verdicts, ports, wire, satellites, range rates and commands.
    /// Behind the verdicts comes the mean of SSE/dof in percent, which is about 100 if the sigmas
    /// are right.
    pub fn statistics(&self) -> impl Iterator<Item = (&'static str, u32)> {
        self.statistics_from(0)
    }

    /// Returns the counter of the authentication with this number.
    #[cfg(feature = "osnma")]
    fn authentication_counter(&self, number: &mut usize) -> Option<(&'static str, u32)> {
        self.input.authentication().tally().at(number)
    }

    pub(super) fn statistics_from(&self, first: usize) -> impl Iterator<Item = (&'static str, u32)> {
        (first..).map_while(|number| self.statistic(number))
    }

    /// Returns name and value of the counter with this number, counted from 0; `None` beyond the
    /// last.
    #[inline(never)]
    pub fn statistic(&self, mut number: usize) -> Option<(&'static str, u32)> {
        let number = &mut number;
        let sigma_check =
            self.epochs.sigma_check.map(|mean| ("sigma_check_pct", libm::round(mean * 100.0) as u32));
        let tally = self.epochs.navigator.tally();
        let verdict = self.epochs.verdicts.at(number);
        let found = verdict
            .or_else(|| match sigma_check {
                Some((name, percent)) => at(&[name], &[percent], number),
                None => None,
            })
            .or_else(|| self.losses.at(number))
            .or_else(|| self.input.counters().at(number))
            .or_else(|| tally.ephemerides.at(number))
            .or_else(|| at(&["ephemerides_displaced"], &[self.epochs.navigator.displaced()], number))
            .or_else(|| tally.ranges.at(number))
            .or_else(|| self.epochs.navigator.rate_tally().at(number));
        #[cfg(feature = "osnma")]
        let found = found.or_else(|| self.authentication_counter(number));
        found.or_else(|| self.commands.counter(*number))
    }
}
