//! Real recordings of the reference folder: their files, and the places of their antennas.

use raim::signal::recording::Recording;
use raim_core::frame::Ecef;

use crate::shared;

/// A recording of the reference folder.
pub struct Station {
    /// Folder of the recording.
    pub folder: &'static str,
    observations: &'static str,
    navigation: &'static str,
    /// Surveyed position of the antenna.
    pub truth: Ecef,
}

impl Station {
    /// Reads the recording; returns `None` and reports a skip if the reference folder is missing.
    ///
    /// # Panics
    /// If the folder exists and its files cannot be read.
    pub fn load(&self) -> Option<Recording> {
        let folder = shared::path_or_skip(&format!("data/{}", self.folder))?;
        let (observations, navigation) = (folder.join(self.observations), folder.join(self.navigation));
        Some(Recording::load(&[observations], &[navigation]).expect("a recording of the reference folder"))
    }
}

/// Esbjerg: a day at 30 s, three systems.
pub const ESBC: Station = Station {
    folder: "esbc",
    observations: "ESBC00DNK_R_20201770000_01D_30S_MO.crx.gz",
    navigation: "ESBC00DNK_R_20201770000_01D_MN.rnx.gz",
    truth: Ecef::new(3582104.9254, 532590.2381, 5232755.2669),
};
/// Near Nagoya: five minutes at 1 Hz, many geostationary and inclined satellites.
pub const STATIC_BASE: Station = Station {
    folder: "static1hz",
    observations: "base.obs.gz",
    navigation: "base.nav.gz",
    truth: Ecef::new(-3817681.1213, 3562839.4311, 3650159.1593),
};
/// Diego Garcia: a day of GPS, RINEX 2.
pub const DGAR: Station = Station {
    folder: "dgar",
    observations: "dgar0100.24o.gz",
    navigation: "brdc0100.24n.gz",
    truth: Ecef::new(1916269.37, 6029977.79, -801719.83),
};
/// Copenhagen: RINEX 4.
pub const KMS3: Station = Station {
    folder: "kms3",
    observations: "KMS300DNK_R_20221591000_01H_30S_MO.crx",
    navigation: "KMS300DNK_R_20221591000_01H_MN.rnx.gz",
    truth: Ecef::new(3516213.4380, 781859.8595, 5246037.9660),
};
/// Toulouse: a merged navigation file.
pub const TLSE: Station = Station {
    folder: "tlse",
    observations: "TLSE00FRA_R_20240011200_15M_01S_MO.crx.gz",
    navigation: "BRDC00IGS_R_20240010000_01D_MN.rnx.gz",
    truth: Ecef::new(4627852.50, 119640.22, 4372995.28),
};
