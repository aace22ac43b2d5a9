//! Notes of an epoch for its account: each satellite that was refused with the reason, and the
//! w-tests. Without the feature `observer` they are empty, and every call is nothing.

#[cfg(feature = "observer")]
use heapless::Vec;
use raim_core::satellite::SatelliteId;
use raim_single::Workspace;

#[cfg(feature = "observer")]
use super::CAPACITY;
use super::{Fate, Sky};
#[cfg(feature = "observer")]
use crate::raw::EPOCH_CAPACITY;
use crate::raw::RawEpoch;

/// Notes of an epoch.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Notes {
    #[cfg(feature = "observer")]
    refused: Vec<(SatelliteId, Fate), EPOCH_CAPACITY>,
    /// W-tests of the ranges in the order of the epoch, dimensionless; NaN is unknown.
    #[cfg(feature = "observer")]
    w_tests: Vec<f32, CAPACITY>,
}

/// Number of the notes on refusals, to which [`Notes::truncate`] returns.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mark(#[cfg(feature = "observer")] usize);

#[cfg(feature = "observer")]
impl Notes {
    /// Forgets the epoch before.
    pub(crate) fn clear(&mut self) {
        self.refused.clear();
        self.w_tests.clear();
    }

    /// Notes why a satellite is left out.
    pub(crate) fn refuse(&mut self, satellite: SatelliteId, fate: impl Into<Fate>) {
        // Never full: each satellite of a raw epoch is refused once at most.
        let _ = self.refused.push((satellite, fate.into()));
    }

    /// Notes for all satellites that are neither in the sky nor refused yet why they are left out.
    pub(crate) fn refuse_missing(&mut self, raw: &RawEpoch, sky: &Sky, fate: Fate) {
        let is_in_sky = |satellite| sky.iter().any(|located| located.satellite() == satellite);
        for satellite in raw.satellites.iter().map(|raw| raw.satellite) {
            if !is_in_sky(satellite) && self.refusal(satellite).is_none() {
                self.refuse(satellite, fate);
            }
        }
    }

    /// Returns the present number of notes.
    pub(crate) fn mark(&self) -> Mark {
        Mark(self.refused.len())
    }

    /// Removes the notes after a mark.
    pub(crate) fn truncate(&mut self, mark: Mark) {
        self.refused.truncate(mark.0);
    }

    /// Notes the w-tests of a judgement, before its workspace is used again.
    pub(crate) fn measure(&mut self, workspace: &Workspace) {
        let rows = 0..workspace.equations().rows().len().min(CAPACITY);
        self.w_tests = rows.map(|index| workspace.w_test(index).unwrap_or(f32::NAN)).collect();
    }

    /// Returns why a satellite was left out.
    pub(crate) fn refusal(&self, satellite: SatelliteId) -> Option<Fate> {
        self.refused.iter().find(|(refused, _)| *refused == satellite).map(|(_, fate)| *fate)
    }

    /// Returns the w-test of a range by its index in the epoch, dimensionless.
    pub(crate) fn w_test(&self, index: usize) -> Option<f64> {
        self.w_tests.get(index).filter(|w_test| !w_test.is_nan()).map(|w_test| f64::from(*w_test))
    }
}

#[cfg(not(feature = "observer"))]
#[allow(clippy::inline_always, clippy::unused_self, reason = "nothing must remain of them")]
impl Notes {
    #[inline(always)]
    pub(crate) const fn clear(&mut self) {}

    #[inline(always)]
    pub(crate) fn refuse(&mut self, _: SatelliteId, _: impl Into<Fate>) {}

    #[inline(always)]
    pub(crate) const fn refuse_missing(&mut self, _: &RawEpoch, _: &Sky, _: Fate) {}

    #[inline(always)]
    pub(crate) const fn mark(&self) -> Mark {
        Mark()
    }

    #[inline(always)]
    pub(crate) const fn truncate(&mut self, _: Mark) {}

    #[inline(always)]
    pub(crate) const fn measure(&mut self, _: &Workspace) {}
}
