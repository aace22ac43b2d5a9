//! Trust in rates: whether their velocity may be compared with the past, and whether it may be
//! reported.
//!
//! Some of many false rates agree by chance. After contradictory rates, a velocity is therefore
//! compared with the past again only if rates have agreed for the recovery time of positions
//! ([`raim_core::internals::continuity`]).
//!
//! Other velocities are reported if ten epochs in a row agreed with sigmas of a receiver in motion,
//! they have three degrees of freedom, and their horizontal level is at most 10 m/s.

use raim_core::internals::continuity::{ContinuitySettings, Standing};
use raim_core::internals::velocity::{Velocity, VelocityError};

use crate::time::GpsTime;

/// Largest horizontal level of a velocity that reflections disturb, m/s.
const WIDEST_M_S: f64 = 10.0;

/// Least degrees of freedom of rates that hardly agree by chance.
const CONVINCING: u8 = 3;

/// Least number of epochs in a row whose rates agree in motion.
const ENOUGH: u8 = 10;

/// Trust in the rates.
#[derive(Clone, Debug)]
pub(super) struct Trust {
    standing: Standing,
    /// First of the consecutive epochs whose rates agreed.
    since: GpsTime,
    /// Number of these epochs.
    epochs: u16,
    /// True if one of them had one degree of freedom or exclusions.
    is_weak: bool,
    /// Why the velocity of the last epoch must not be compared with the past.
    pub(super) refusal: Option<VelocityError>,
    /// Why the trust was lost.
    pub(super) loss: VelocityError,
    /// Epochs in a row whose rates agree with sigmas of a receiver in motion.
    in_motion: u8,
}

impl Trust {
    pub(super) const fn new() -> Self {
        let (standing, since, loss) = (Standing::New, GpsTime::from_ms(0), VelocityError::Fault);
        Self { standing, since, epochs: 0, is_weak: false, refusal: None, loss, in_motion: 0 }
    }

    /// Notes the rates of an epoch with sigmas of a receiver at rest. Those that agree again, but
    /// not yet for long enough, are refused for the same reason as those before them.
    pub(super) fn note(
        &mut self,
        settings: Option<&ContinuitySettings>,
        time: GpsTime,
        velocity: &Result<Velocity, VelocityError>,
    ) {
        self.refusal = match velocity {
            Ok(velocity) => {
                let is_good = settings.is_none_or(|settings| self.agree(settings, time, velocity));
                Some(self.loss).filter(|_| !is_good)
            }
            Err(error) => {
                self.epochs = 0;
                if error.is_contradiction() {
                    (self.standing, self.loss) = (Standing::Lost, *error);
                }
                Some(*error)
            }
        };
    }

    /// Notes rates that agree; returns true if their velocity may be compared with the past.
    fn agree(&mut self, settings: &ContinuitySettings, time: GpsTime, velocity: &Velocity) -> bool {
        let is_weak = velocity.test.dof <= 1;
        if self.standing == Standing::Good || self.standing == Standing::New && !is_weak {
            self.standing = Standing::Good;
            return true;
        }
        if self.epochs == 0 {
            (self.since, self.is_weak) = (time, false);
        }
        self.epochs = self.epochs.saturating_add(1);
        self.is_weak |= is_weak || !velocity.excluded.is_empty();
        let seconds = time.since_ms(self.since) as f64 * 1e-3;
        if settings.recovery.is_met(self.epochs, seconds, self.is_weak) {
            self.standing = Standing::Good;
        }
        self.standing == Standing::Good
    }

    /// Notes the rates of an epoch with sigmas of a receiver in motion; returns true if their velocity
    /// may be reported.
    pub(super) fn note_in_motion(&mut self, velocity: &Result<Velocity, VelocityError>) -> bool {
        let mut is_precise = false;
        match velocity {
            Ok(velocity) if velocity.test.dof >= CONVINCING => {
                self.in_motion = self.in_motion.saturating_add(u8::from(velocity.excluded.is_empty()));
                is_precise = velocity.levels_m_s.hpl_m <= WIDEST_M_S;
            }
            Err(error) if error.is_contradiction() => self.in_motion = 0,
            _ => {}
        }
        self.refusal.is_none() || self.in_motion >= ENOUGH && is_precise
    }
}

#[cfg(test)]
mod tests {
    use std::vec;
    use std::vec::Vec;

    use raim_core::internals::velocity::{Velocity, VelocityError};
    use raim_core::report::{ProtectionLevels, TestStatistic};

    use super::{ENOUGH, Trust};
    use crate::time::GpsTime;

    type Rates = Result<Velocity, VelocityError>;

    fn velocity(dof: u8, hpl_m: f64) -> Velocity {
        Velocity::zero(TestStatistic::new(0.5, 2.0, dof), ProtectionLevels::new(hpl_m, 20.0))
    }

    /// Returns whether each of these velocities of a receiver in motion may be reported.
    fn reported(velocities: &[Rates]) -> Vec<bool> {
        let mut trust = Trust::new();
        trust.note(None, GpsTime::from_ms(0), &Err(VelocityError::Fault));
        velocities.iter().map(|velocity| trust.note_in_motion(velocity)).collect()
    }

    #[test]
    fn velocity_in_motion_waits_for_its_epochs() {
        let mut velocities = vec![Ok(velocity(3, 5.0)); 12];
        assert_eq!(reported(&velocities), [[false; 9].as_slice(), &[true; 3]].concat());
        velocities.extend([Err(VelocityError::Noise), Ok(velocity(3, 5.0))]);
        assert_eq!(reported(&velocities)[11..], [true, false, false], "a contradiction begins it anew");
    }

    #[test]
    fn velocity_in_motion_needs_freedom_and_a_level() {
        for refused in [velocity(2, 5.0), velocity(3, 10.5), velocity(3, f64::NAN)] {
            let mut velocities = vec![Ok(velocity(3, 5.0)); usize::from(ENOUGH)];
            velocities.extend([Ok(refused), Ok(velocity(3, 5.0))]);
            assert_eq!(reported(&velocities)[9..], [true, false, true]);
        }
    }
}
