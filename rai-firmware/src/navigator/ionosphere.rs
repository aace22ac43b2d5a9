//! The models of the ionosphere that satellites broadcast.

use raim_core::satellite::Constellation;

use crate::correction::Klobuchar;
use crate::settings::Configuration;
use crate::time::GpsTime;

/// Lifetime of broadcast coefficients, ms; satellites renew them at least every six days.
const IONOSPHERE_HOLDS_MS: u64 = 6 * 86_400_000;

/// Models broadcast by GPS and by `BeiDou`, with the time of arrival.
///
/// Coefficients that come before the first epoch have no time until that epoch.
#[derive(Debug)]
pub(super) struct Broadcast {
    models: [Option<(Klobuchar, Option<GpsTime>)>; 2],
    /// True from the arrival of a different model until the next epoch.
    has_new_model: bool,
}

impl Broadcast {
    /// Returns the state before any model came.
    pub(super) const fn new() -> Self {
        Self { models: [None; 2], has_new_model: false }
    }

    /// Stores broadcast coefficients for the model of their constellation. Invalid coefficients
    /// change nothing.
    pub(super) fn receive(
        &mut self,
        constellation: Constellation,
        coefficients: [f64; 8],
        now: Option<GpsTime>,
    ) {
        if !cfg!(feature = "ubx") {
            return;
        }
        let [of_gps, of_beidou] = &mut self.models;
        let (known, heard) = match constellation {
            Constellation::Beidou => (of_beidou, Klobuchar::of_beidou(coefficients)),
            _ => (of_gps, Klobuchar::new(coefficients)),
        };
        if let Some(heard) = heard {
            self.has_new_model |= known.is_some_and(|(known, _)| known != heard);
            *known = Some((heard, now));
        }
    }

    /// Gives models that came before the first epoch the time of that epoch.
    pub(super) fn date(&mut self, time: GpsTime) {
        if !cfg!(feature = "ubx") {
            return;
        }
        for (_, came) in self.models.iter_mut().flatten() {
            came.get_or_insert(time);
        }
    }

    /// Returns true once after a different model came.
    pub(super) fn take_news(&mut self) -> bool {
        cfg!(feature = "ubx") && core::mem::take(&mut self.has_new_model)
    }

    /// Returns the model in force: that of a command, otherwise a fresh one of GPS, otherwise a
    /// fresh one of `BeiDou`.
    pub(super) fn model(&self, time: GpsTime, configuration: &Configuration) -> Option<Klobuchar> {
        let is_fresh = |came: GpsTime| time.since_ms(came).unsigned_abs() <= IONOSPHERE_HOLDS_MS;
        let mut heard = self.models.iter().flatten();
        let fresh = || {
            let newest = heard.find(|(_, came)| came.is_none_or(is_fresh));
            newest.filter(|_| cfg!(feature = "ubx")).map(|(klobuchar, _)| *klobuchar)
        };
        configuration.klobuchar.and_then(Klobuchar::new).or_else(fresh)
    }
}
