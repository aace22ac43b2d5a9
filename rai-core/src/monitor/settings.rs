//! Settings that a caller may change between two epochs: requirements, strategy, continuity,
//! integrity support and the start of the next fix.

use super::{
    ContinuityError, ContinuitySettings, Ism, MethodError, Monitor, MonitorError, Requirements, Strategy,
    ValidatedRequirements,
};
use crate::frame::Ecef;
use crate::numeric::real::Real;

impl<T: Real, const N: usize> Monitor<T, N> {
    /// Replaces the requirements; the state stays.
    ///
    /// # Errors
    /// As [`Self::new`]; nothing changes then.
    pub fn set_requirements(&mut self, requirements: Requirements) -> Result<(), MonitorError> {
        self.validated = ValidatedRequirements::new(requirements)?;
        Ok(())
    }

    /// Replaces the strategy.
    ///
    /// If clock aiding changes, the clocks are forgotten. If the noise changes, the residuals are
    /// forgotten. So they are if the sigmas change between expected ones and those of an integrity
    /// support message.
    ///
    /// # Errors
    /// [`MethodError`] names the feature that the method needs and this build lacks; nothing
    /// changes then.
    pub fn set_strategy(&mut self, strategy: Strategy) -> Result<(), MethodError> {
        strategy.method.built_in()?;
        if strategy.clock_aid != self.strategy.clock_aid {
            self.clocks.restart();
        }
        let is_weighted_alike = strategy.method.uses_ism() == self.strategy.method.uses_ism();
        if strategy.noise != self.strategy.noise || !is_weighted_alike {
            self.forget_residuals();
        }
        self.strategy = strategy;
        Ok(())
    }

    /// Replaces the limits of the receiver's motion and the required agreement; the state stays.
    ///
    /// # Errors
    /// [`ContinuityError`] names the setting that is out of its range; nothing changes then.
    pub fn set_continuity(&mut self, settings: ContinuitySettings) -> Result<(), ContinuityError> {
        self.continuity_settings = Some(settings.validate()?);
        Ok(())
    }

    /// Returns the continuity settings, or `None` if every epoch is judged independently.
    #[doc(hidden)]
    pub fn continuity_settings(&self) -> Option<&ContinuitySettings> {
        self.continuity_settings.as_ref()
    }

    /// Judges every epoch independently from now on: without detection of jumps and without
    /// recovery.
    ///
    /// Experiments need it if they draw each epoch independently.
    #[doc(hidden)]
    pub fn disable_continuity(&mut self) {
        self.continuity_settings = None;
    }

    /// Replaces the integrity support message ([`Ism::ICAO`] at first), for
    /// [`Method::Araim`](super::Method::Araim).
    ///
    /// An invalid message is ignored.
    pub fn set_ism(&mut self, ism: Ism) {
        // A message with a NaN is invalid.
        if ism.is_valid() {
            self.ism = ism;
        }
    }

    /// Returns the integrity support message.
    pub fn ism(&self) -> &Ism {
        &self.ism
    }

    /// Returns the requirements.
    pub fn requirements(&self) -> &Requirements {
        &self.validated.requirements
    }

    /// Returns the validated requirements, with their thresholds and factors.
    #[doc(hidden)]
    pub fn validated(&self) -> &ValidatedRequirements<T, N> {
        &self.validated
    }

    /// Returns the start of the next fix: the last position, or the point set by
    /// [`Self::start_from`].
    pub fn start(&self) -> Ecef {
        self.start
    }

    /// Sets the start of the next fix; a point that is not finite is ignored.
    pub fn start_from(&mut self, point: Ecef) {
        if point.is_finite() {
            self.start = point;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrity::raim::isolation::parity::Isolation;
    use crate::monitor::Method;

    /// `cargo xtask test` also runs it in a build that lacks both features.
    #[test]
    fn method_that_this_build_lacks_is_refused_by_the_name_of_its_feature() -> Result<(), MonitorError> {
        let mut monitor = Monitor::<f32, 16>::new(Requirements::en_route())?;
        let (searches, araim) = (cfg!(feature = "searches"), cfg!(feature = "araim"));
        let methods = [
            (Method::Auto, "", true),
            (Method::Parity(Isolation::Grouping), "searches", searches),
            (Method::Ransac, "searches", searches),
            (Method::Araim, "araim", araim),
        ];
        for (method, feature, is_built) in methods {
            let want = if is_built { Ok(()) } else { Err(MethodError { method, feature }) };
            assert_eq!(monitor.set_strategy(Strategy { method, ..Strategy::DEFAULT }), want);
            let kept = monitor.strategy.method;
            assert!(is_built == (kept == method), "{kept:?}");
        }
        Ok(())
    }
}
