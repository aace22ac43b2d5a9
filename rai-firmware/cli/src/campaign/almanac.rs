//! YUMA almanacs: blocks of `name: value` lines, one block per satellite.
//!
//! ```text
//! Ω(t) = Ω_w − ω_e t_oa + (Ω̇ − ω_e)(t − t_oa)        the node is counted from Greenwich at the beginning of the week
//! ```
//!
//! A sky's `t = 0` is the time of applicability. Satellites whose health is not 0 are left out.
//! Reference: [GPS-SPS] 2.4.4 for the contents of an almanac; the format is that of the operator's
//! own files.
//!
//! [GPS-SPS]: crate#references

use std::collections::BTreeMap;

use anyhow::{Context as _, Result, ensure};
use raim_core::frame::EARTH_ROTATION_RAD_S;
use raim_core::satellite::{Constellation, SatelliteId};

use crate::signal::sky::Satellite;
use crate::signal::sky::orbit::{Orbit, mean_motion_rad_s};

/// Reads the healthy satellites of an almanac.
///
/// # Errors
/// If a block lacks a line, a value is not a number or not possible for an orbit, or no satellite
/// is healthy.
pub fn read(text: &str, constellation: Constellation) -> Result<Vec<Satellite>> {
    let mut satellites: Vec<Satellite> = Vec::new();
    for block in blocks(text) {
        let number = field(&block, "ID")?;
        let context = || format!("satellite {number}");
        if field(&block, "Health").with_context(context)? != 0.0 {
            continue;
        }
        let satellite = satellite(&block, constellation, number).with_context(context)?;
        let is_twice = satellites.iter().any(|known| known.id == satellite.id);
        ensure!(!is_twice, "{} occurs twice", satellite.id);
        satellites.push(satellite);
    }
    ensure!(!satellites.is_empty(), "no healthy satellite: is it a YUMA almanac?");
    Ok(satellites)
}

/// Returns each block's lines by the start of their names.
fn blocks(text: &str) -> Vec<BTreeMap<&str, &str>> {
    let mut blocks: Vec<BTreeMap<&str, &str>> = Vec::new();
    for line in text.lines() {
        let Some((name, value)) = line.split_once(':') else { continue };
        let name = name.split('(').next().unwrap_or(name).trim();
        if name == "ID" {
            blocks.push(BTreeMap::new());
        }
        if let Some(block) = blocks.last_mut() {
            block.insert(name, value.trim());
        }
    }
    blocks
}

fn field(block: &BTreeMap<&str, &str>, name: &str) -> Result<f64> {
    let text = block.get(name).with_context(|| format!("a block lacks `{name}`"))?;
    let number = text.parse().ok().filter(|number: &f64| number.is_finite());
    number.with_context(|| format!("{name}: `{text}` is not a number"))
}

fn satellite(block: &BTreeMap<&str, &str>, constellation: Constellation, number: f64) -> Result<Satellite> {
    let field = |name| field(block, name);
    let is_number = (1.0..=99.0).contains(&number) && number.fract() == 0.0;
    let id = SatelliteId::new(constellation, number as u8).filter(|_| is_number);
    let (eccentricity, root) = (field("Eccentricity")?, field("SQRT")?);
    ensure!((0.0..0.1).contains(&eccentricity), "eccentricity {eccentricity} must be within 0 to 0.1");
    ensure!((4000.0..7000.0).contains(&root), "root of the axis {root} must be within 4000 to 7000");
    let axis_m = root * root;
    let applicability_s = field("Time of Applicability")?;
    let orbit = Orbit {
        semi_major_axis_m: axis_m,
        eccentricity,
        inclination_rad: field("Orbital Inclination")?,
        node_rad: field("Right Ascen at Week")? - EARTH_ROTATION_RAD_S * applicability_s,
        node_rate_rad_s: field("Rate of Right Ascen")?,
        perigee_rad: field("Argument of Perigee")?,
        mean_anomaly_rad: field("Mean Anom")?,
        mean_motion_rad_s: mean_motion_rad_s(axis_m),
    };
    Ok(Satellite { id: id.context("the number must be within 1 to 99")?, orbit })
}
