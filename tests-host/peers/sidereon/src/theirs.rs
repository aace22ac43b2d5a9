//! ARAIM by `sidereon-core`.

use anyhow::{Result, anyhow};
use sidereon_core::GnssSatelliteId;
use sidereon_core::GnssSystem;
use sidereon_core::araim::{
    AraimGeometry, AraimRow, ConstellationIsm, IntegrityAllocation, Ism, SatelliteIsm, SatelliteIsmModel,
    araim,
};
use sidereon_core::dop::LineOfSight;
use sidereon_core::frame::Wgs84Geodetic;

use super::{Answer, Line};

/// Systems in the order of the vectors' ids.
const SYSTEMS: [GnssSystem; 4] =
    [GnssSystem::Gps, GnssSystem::BeiDou, GnssSystem::Galileo, GnssSystem::Glonass];

/// An epoch in the form of `sidereon-core`.
pub(super) struct Case {
    geometry: AraimGeometry,
    ism: Ism,
}

impl Case {
    pub(super) fn of(line: &Line) -> Result<Self> {
        let mut rows = Vec::new();
        let mut satellites = Vec::new();
        for (index, &constellation) in line.con.iter().enumerate() {
            let system = SYSTEMS[constellation];
            let id = GnssSatelliteId::new(system, index as u8 + 1).map_err(|error| anyhow!("{error}"))?;
            // At latitude and longitude 0, up is x, east is y and north is z.
            let [east, north, up] = line.los_enu[index];
            let line_of_sight = LineOfSight::new(up, east, north);
            rows.push(AraimRow { id, line_of_sight, system, elevation_rad: up.asin() });
            let sigma_m = line.sigma[index];
            let accuracy_m = line.sigma_acc[index];
            satellites.push(SatelliteIsm::new_with_effective_sigmas(
                id,
                sigma_m,
                accuracy_m,
                line.b_nom[index],
                line.p_sat[index],
                sigma_m,
                accuracy_m,
            ));
        }
        let mut constellations = Vec::new();
        for (id, &probability) in &line.p_const {
            let system = SYSTEMS[id.parse::<usize>()?];
            // Every satellite has its own.
            let unused = SatelliteIsmModel::new(1.0, 1.0, 0.75, 1e-5);
            constellations.push(ConstellationIsm::new(system, probability, unused));
        }
        let clock_systems = SYSTEMS.into_iter().filter(|system| rows.iter().any(|row| row.system == *system));
        let receiver = Wgs84Geodetic::new(0.0, 0.0, 0.0).map_err(|error| anyhow!("{error}"))?;
        let geometry =
            AraimGeometry { clock_systems: clock_systems.collect(), rows, receiver, ut1_degraded: None };
        Ok(Self { geometry, ism: Ism::new(constellations, satellites) })
    }

    pub(super) fn judge(&self) -> Result<Answer> {
        let result = araim(&self.geometry, &self.ism, &IntegrityAllocation::lpv_200())
            .map_err(|error| anyhow!("{error}"))?;
        Ok(Answer { modes: result.fault_modes.len() - 1, levels_m: [result.hpl_m, result.vpl_m] })
    }
}
