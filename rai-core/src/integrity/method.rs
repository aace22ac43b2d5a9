//! The methods that find the faulty satellites, and the features that they need.

use core::fmt;

use super::raim::isolation::parity;

/// Method that finds the faulty satellites.
///
/// ```
/// use raim_core::{Method, Monitor, Requirements};
/// use raim_core::monitor::Strategy;
///
/// let mut monitor = Monitor::<f32, 16>::new(Requirements::en_route())?;
/// let mut strategy = Strategy::DEFAULT;
/// strategy.method = Method::Araim;
/// monitor.set_strategy(strategy)?; // an error that names the feature in a build without ARAIM
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Method {
    /// Compares every set of one row, then of two, then of three. If these are more than
    /// [`super::AUTOMATIC_SETS`], it works like [`Self::Baarda`].
    Auto,
    /// Leaves out the row with the largest w-test, repeatedly.
    Baarda,
    /// Searches in parity space. Needs the feature `searches`.
    Parity(parity::Isolation),
    /// Consensus of disjoint subsets of the satellites. Needs the feature `searches`.
    Ransac,
    /// Solution separation over all monitored fault modes: ARAIM. Needs the feature `araim`.
    Araim,
}

impl Method {
    /// Returns true if a clock forecast or a known height may be a row. ARAIM has no fault mode for
    /// them.
    #[doc(hidden)]
    pub fn allows_aiding(self) -> bool {
        !self.uses_ism()
    }

    /// Returns true if the sigmas come from an integrity support message instead of the error
    /// model.
    pub(crate) fn uses_ism(self) -> bool {
        self == Self::Araim
    }

    /// Returns the method if this build has it.
    ///
    /// # Errors
    /// [`MethodError`] names the feature that the build lacks.
    pub(crate) const fn built_in(self) -> Result<Self, MethodError> {
        match self {
            Self::Parity(_) | Self::Ransac if !cfg!(feature = "searches") => {
                Err(MethodError { method: self, feature: "searches" })
            }
            Self::Araim if !cfg!(feature = "araim") => Err(MethodError { method: self, feature: "araim" }),
            Self::Auto | Self::Baarda | Self::Parity(_) | Self::Ransac | Self::Araim => Ok(self),
        }
    }
}

/// The method that this build lacks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct MethodError {
    /// The method that was asked for.
    pub method: Method,
    /// The feature of this crate that it needs.
    pub feature: &'static str,
}

impl fmt::Display for MethodError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("method must be one of this build: it needs the feature ")?;
        formatter.write_str(self.feature)
    }
}

impl core::error::Error for MethodError {}
