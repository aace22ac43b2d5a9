//! Positions of a sky's satellites at each instant, computed once for all places.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, ensure};
use raim_core::frame::Ecef;
use raim_core::satellite::{Constellation, SatelliteId};

use super::almanac;
use super::navigation::Broadcast;
use super::spec::SkySpec;
use crate::signal::sky::{Fleet, Satellite};

/// Satellites and their positions at one instant.
pub type Heaven = Vec<(SatelliteId, Ecef)>;

/// A sky whose satellites can be located.
pub enum Sky {
    /// Satellites on given orbits.
    Orbits(Vec<Satellite>),
    /// Satellites located by their ephemerides.
    Broadcast(Box<Broadcast>),
}

impl Sky {
    /// Reads the sources of a sky. Files are relative to the specification.
    ///
    /// # Errors
    /// If a name is unknown, a file cannot be read, or a satellite occurs twice; the error names
    /// it.
    pub fn load(spec: &SkySpec, folder: &Path) -> Result<Self> {
        Self::of(spec, folder).with_context(|| format!("sky \"{}\"", spec.name))
    }

    fn of(spec: &SkySpec, folder: &Path) -> Result<Self> {
        if !spec.navigation.is_empty() {
            let files: Vec<PathBuf> = spec.navigation.iter().map(|file| folder.join(file)).collect();
            let systems = spec.systems.as_deref().unwrap_or("GEC");
            return Ok(Self::Broadcast(Box::new(Broadcast::load(&files, systems)?)));
        }
        let mut satellites: Vec<Satellite> = Vec::new();
        for name in &spec.fleets {
            satellites.extend(fleet(name)?.satellites());
        }
        for listed in &spec.almanacs {
            let letter = listed.system.chars().next().filter(|_| listed.system.len() == 1);
            let constellation = letter.and_then(Constellation::from_letter);
            let constellation =
                constellation.with_context(|| format!("system \"{}\": write G, E, C or R", listed.system))?;
            let path = folder.join(&listed.file);
            let text =
                std::fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))?;
            let read = almanac::read(&text, constellation).with_context(|| path.display().to_string())?;
            satellites.extend(read);
        }
        satellites.sort_by_key(|satellite| satellite.id);
        for pair in satellites.windows(2) {
            ensure!(
                pair[0].id != pair[1].id,
                "{} occurs twice: name one constellation per system",
                pair[0].id
            );
        }
        Ok(Self::Orbits(satellites))
    }

    /// Returns the satellites' positions at an instant, in the order of their names.
    pub fn at(&self, t_s: f64) -> Heaven {
        match self {
            Self::Orbits(satellites) => {
                satellites.iter().map(|satellite| (satellite.id, satellite.orbit.position(t_s))).collect()
            }
            Self::Broadcast(broadcast) => broadcast.positions(t_s),
        }
    }
}

fn fleet(name: &str) -> Result<Fleet> {
    let names = || Fleet::ALL.map(Fleet::name).join(", ");
    let found = Fleet::ALL.into_iter().find(|fleet| fleet.name() == name);
    found.with_context(|| format!("\"{name}\" is not a fleet; the fleets are {}", names()))
}
