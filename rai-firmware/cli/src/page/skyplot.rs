//! Sky plot: zenith in the middle, horizon at the rim, north up, east to the right.
//!
//! Labels are beside their satellites, at the first of eight places where they cover nothing.

use std::f64::consts::FRAC_PI_2;

use anyhow::Result;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};
use raim_core::satellite::{Constellation, SatelliteId};

use super::canvas::{
    Area, BLUE, GREEN, Ground, INK, Mark, ORANGE, RED, TEXT_PX, VIOLET, heading, heading_px, svg, text,
    width_px,
};

/// Satellite in the sky.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Satellite of the point.
    pub satellite: SatelliteId,
    /// Angle above the horizon, rad.
    pub elevation_rad: f64,
    /// Angle from north over east, rad.
    pub azimuth_rad: f64,
    /// True if the satellite is excluded.
    pub is_excluded: bool,
}

/// Usual side of the picture, pixels.
pub const SIDE_PX: u32 = 460;

/// Elevations of the rings, °.
const RINGS_DEG: [f64; 3] = [0.0, 30.0, 60.0];

/// Returns the colour of a system's satellites.
pub(super) const fn colour(constellation: Constellation) -> RGBColor {
    match constellation {
        Constellation::Gps => BLUE,
        Constellation::Beidou => ORANGE,
        Constellation::Galileo => GREEN,
        _ => VIOLET,
    }
}

/// Returns the mark of a system's lines.
pub(super) const fn mark_of(constellation: Constellation) -> Mark {
    match constellation {
        Constellation::Gps | Constellation::Galileo => Mark::Line,
        _ => Mark::Dashed,
    }
}

/// Returns the name of a system.
pub(super) const fn name(constellation: Constellation) -> &'static str {
    match constellation {
        Constellation::Gps => "GPS",
        Constellation::Beidou => "BeiDou",
        Constellation::Galileo => "Galileo",
        Constellation::Glonass => "GLONASS",
        _ => "another system",
    }
}

/// Draws the sky.
///
/// # Errors
/// Plotters fails to draw.
pub fn skyplot(bodies: &[Body], mask_rad: f64, side_px: u32, ground: Ground) -> Result<String> {
    const TITLE: &str = "Satellites in the sky";
    let mask = format!("mask {:.0}°", mask_rad.to_degrees());
    let mut legend = legend(bodies);
    legend.push((&mask, RED, Mark::Line));
    let top = heading_px(side_px.cast_signed(), TITLE, &legend);
    svg((side_px, side_px + top), ground, &spoken(bodies), |area| {
        heading(area, TITLE, &legend)?;
        let disc = Disc::new(side_px.cast_signed() / 2, top.cast_signed());
        disc.rings(area, mask_rad)?;
        disc.bodies(area, bodies)
    })
}

/// Returns the sky in a sentence.
fn spoken(bodies: &[Body]) -> String {
    let names = |excluded: bool| {
        let of = bodies.iter().filter(|body| body.is_excluded == excluded);
        of.map(|body| body.satellite.to_string()).collect::<Vec<_>>().join(" ")
    };
    let left_out = names(true);
    let others = if left_out.is_empty() { String::new() } else { format!("; left out: {left_out}") };
    format!("Satellites in the sky by azimuth and elevation: {}{others}", names(false))
}

fn legend(bodies: &[Body]) -> Vec<(&'static str, RGBColor, Mark)> {
    let present = |constellation: &Constellation| {
        bodies.iter().any(|body| body.satellite.constellation() == *constellation)
    };
    let systems = Constellation::ALL.into_iter().filter(present);
    let mut legend: Vec<_> =
        systems.map(|constellation| (name(constellation), colour(constellation), Mark::Dots)).collect();
    if bodies.iter().any(|body| body.is_excluded) {
        legend.push(("left out", RED, Mark::Dots));
    }
    legend
}

/// Position of the sky in the picture, pixels.
struct Disc {
    centre: (i32, i32),
    radius: f64,
}

impl Disc {
    fn new(half: i32, top: i32) -> Self {
        Self { centre: (half, half + top), radius: f64::from(half - 34) }
    }

    fn point(&self, elevation_rad: f64, azimuth_rad: f64) -> (i32, i32) {
        let distance = self.radius * (1.0 - elevation_rad / FRAC_PI_2);
        let (sin, cos) = azimuth_rad.sin_cos();
        (self.centre.0 + (distance * sin).round() as i32, self.centre.1 - (distance * cos).round() as i32)
    }

    /// Returns the place of a ring's label: inside the ring, beside north.
    fn ring_label(&self, elevation_deg: f64) -> Patch {
        let (x, y) = self.point(elevation_deg.to_radians(), 0.0);
        Patch::around((x + 14, y + 9), 26, TEXT_PX)
    }

    fn rings(&self, area: &Area<'_>, mask_rad: f64) -> Result<()> {
        for elevation_deg in RINGS_DEG {
            let radius = self.radius * (1.0 - elevation_deg / 90.0);
            area.draw(&Circle::new(self.centre, radius as i32, INK.mix(0.3)))?;
            let label = text(TEXT_PX - 2, INK, HPos::Center, VPos::Center);
            let centre = self.ring_label(elevation_deg).centre;
            area.draw(&Text::new(format!("{elevation_deg:.0}°"), centre, label))?;
        }
        if mask_rad > 0.0 {
            let radius = self.radius * (1.0 - mask_rad / FRAC_PI_2);
            area.draw(&Circle::new(self.centre, radius as i32, RED.mix(0.45)))?;
        }
        for (quarter, name) in ["N", "E", "S", "W"].into_iter().enumerate() {
            let azimuth_rad = FRAC_PI_2 * quarter as f64;
            let rim = self.point(0.0, azimuth_rad);
            area.draw(&PathElement::new(vec![self.centre, rim], INK.mix(0.18)))?;
            // Below the horizon: outside the rim.
            let beyond = self.point(-0.11, azimuth_rad);
            let label = text(TEXT_PX + 1, INK, HPos::Center, VPos::Center);
            area.draw(&Text::new(name, beyond, label))?;
        }
        Ok(())
    }

    fn bodies(&self, area: &Area<'_>, bodies: &[Body]) -> Result<()> {
        let at: Vec<(i32, i32)> =
            bodies.iter().map(|body| self.point(body.elevation_rad, body.azimuth_rad)).collect();
        let dots = at.iter().map(|&centre| Patch::around(centre, 14, 14));
        let rings = RINGS_DEG.map(|elevation_deg| self.ring_label(elevation_deg));
        let mut taken: Vec<Patch> = dots.chain(rings).collect();
        for (body, &point) in bodies.iter().zip(&at) {
            mark(area, body, point)?;
            let label = body.satellite.to_string();
            let patch = free_place(point, width_px(&label, TEXT_PX - 1), &taken);
            let style = text(TEXT_PX - 1, INK, HPos::Center, VPos::Center);
            area.draw(&Text::new(label, patch.centre, style))?;
            taken.push(patch);
        }
        Ok(())
    }
}

fn mark(area: &Area<'_>, body: &Body, point: (i32, i32)) -> Result<()> {
    area.draw(&Circle::new(point, 6, colour(body.satellite.constellation()).filled()))?;
    if body.is_excluded {
        area.draw(&Circle::new(point, 11, RED.stroke_width(3)))?;
        let (x, y) = point;
        for (from, to) in [((-8, -8), (8, 8)), ((-8, 8), (8, -8))] {
            let path = vec![(x + from.0, y + from.1), (x + to.0, y + to.1)];
            area.draw(&PathElement::new(path, RED.stroke_width(3)))?;
        }
    }
    Ok(())
}

/// Rectangle that is occupied, pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Patch {
    centre: (i32, i32),
    width: i32,
    height: i32,
}

impl Patch {
    const fn around(centre: (i32, i32), width: i32, height: i32) -> Self {
        Self { centre, width, height }
    }

    const fn covers(self, other: Self) -> bool {
        2 * (self.centre.0 - other.centre.0).abs() < self.width + other.width
            && 2 * (self.centre.1 - other.centre.1).abs() < self.height + other.height
    }
}

/// Returns the first place around a point where a label covers nothing; without one, the place to
/// the right.
fn free_place(point: (i32, i32), width: i32, taken: &[Patch]) -> Patch {
    let beside = width / 2 + 13;
    let places = [
        (beside, 0),
        (-beside, 0),
        (0, -17),
        (0, 17),
        (beside - 4, -13),
        (beside - 4, 13),
        (4 - beside, -13),
        (4 - beside, 13),
    ];
    let patches = places.map(|(x, y)| Patch::around((point.0 + x, point.1 + y), width, TEXT_PX));
    let free = patches.iter().find(|patch| taken.iter().all(|other| !patch.covers(*other)));
    *free.unwrap_or(&patches[0])
}
