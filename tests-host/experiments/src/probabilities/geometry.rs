//! Geometries: noise-free rows, with their dense least squares.
//!
//! Projection, gain and covariance come from [`oracle`], independently of the core.

use anyhow::Result;
use nalgebra::{DVector, Vector2};
use raim::replay::{self, Window};
use raim::second_opinion::dense::{self, Dense, Range};
use raim::signal::encode::{Frequency, Selection};
use raim::signal::sky::linear::Row;
use raim::signal::sky::{Fleet, Satellite, Sight, Site, sights};
use raim_core::epoch::{Epoch, Observation};
use raim_core::satellite::Constellation;
use rig::stations::{DGAR, ESBC, Station};

use super::{CAPACITY, CLOCKS_M, MASK_DEG, SIGMA};

/// Time between the instants of the geometries, s.
const STEP_S: f64 = 1800.0;
/// Number of instants in a day.
const INSTANTS: usize = 48;

/// Redundancy number below which dense inversion, too, is inaccurate; no largest slope is there.
pub(super) const UNTESTABLE: f64 = 1e-9;

/// Rows of an instant without noise, and their dense least squares.
pub(super) struct Geometry {
    pub(super) rows: Vec<Row>,
    pub(super) dense: Dense,
}

/// The satellite whose bias moves the position farthest before the test shows it.
#[derive(Clone, Copy)]
pub(super) struct Worst {
    pub(super) index: usize,
    /// Motion of the position per metre of bias, east and north.
    pub(super) moved: Vector2<f64>,
    /// Horizontal slope, m per unit of `√λ`.
    pub(super) slope_m: f64,
}

impl Geometry {
    /// Returns the geometry of rows; `None` without redundancy.
    pub(super) fn of(rows: Vec<Row>) -> Option<Self> {
        let range = |row: &Row| Range {
            line_of_sight: [row.line_of_sight.east, row.line_of_sight.north, row.line_of_sight.up],
            constellation: row.satellite.constellation(),
            residual_m: 0.0,
            sigma_m: row.sigma_m,
        };
        let dense = dense::solve(&rows.iter().map(range).collect::<Vec<_>>())?;
        (dense.dof > 0).then_some(Self { rows, dense })
    }

    /// Returns the geometry of the satellites in view.
    pub(super) fn seen(sights: &[Sight]) -> Option<Self> {
        let row = |sight: &Sight| Row {
            satellite: sight.satellite,
            line_of_sight: sight.line_of_sight,
            sigma_m: SIGMA.at(sight.line_of_sight),
            y_m: clock_m(sight.satellite.constellation()),
        };
        Self::of(sights.iter().map(row).collect())
    }

    pub(super) fn dof(&self) -> usize {
        self.dense.dof
    }

    /// Returns the part of normalised noise that the residuals show.
    pub(super) fn parity(&self, noise: &DVector<f64>) -> DVector<f64> {
        &self.dense.projection * noise
    }

    /// Returns the unit vector along which a satellite's bias appears in the residuals.
    pub(super) fn signature(&self, index: usize) -> DVector<f64> {
        self.dense.projection.column(index).normalize()
    }

    /// Returns the root of the non-centrality per metre of a satellite's bias, 1/m.
    pub(super) fn visibility(&self, index: usize) -> f64 {
        self.dense.projection[(index, index)].sqrt() / self.rows[index].sigma_m
    }

    /// Returns the rows with normalised noise, and with a bias on one of them.
    pub(super) fn noisy(&self, noise: &DVector<f64>, bias: Option<(usize, f64)>) -> Vec<Row> {
        let mut rows = self.rows.clone();
        for (row, noise) in rows.iter_mut().zip(noise) {
            row.y_m += row.sigma_m * noise;
        }
        if let Some((index, bias_m)) = bias {
            rows[index].y_m += bias_m;
        }
        rows
    }

    /// Returns the satellite with the largest slope.
    pub(super) fn worst(&self) -> Option<Worst> {
        let worst = |index: usize| {
            let moved = Vector2::new(self.dense.gain[(0, index)], self.dense.gain[(1, index)]);
            Worst { index, moved, slope_m: moved.norm() / self.visibility(index) }
        };
        let testable = |index: &usize| self.dense.projection[(*index, *index)] > UNTESTABLE;
        let slopes = (0..self.rows.len()).filter(testable).map(worst);
        slopes.max_by(|a, b| a.slope_m.total_cmp(&b.slope_m))
    }
}

/// Returns the receiver clock times the speed of light, m.
pub(super) fn clock_m(constellation: Constellation) -> f64 {
    CLOCKS_M[constellation as usize]
}

/// Returns the epoch for the module; clocks, noise and faults are in the rows.
pub(super) fn epoch(t_s: f64, sights: &[Sight], rows: &[Row]) -> Result<Epoch<CAPACITY>> {
    let mut epoch = Epoch::new(t_s);
    for (sight, row) in sights.iter().zip(rows) {
        let Sight { satellite, position, range_m, .. } = *sight;
        epoch.push(Observation { satellite, position, range_m: range_m + row.y_m, sigma_m: row.sigma_m })?;
    }
    Ok(epoch)
}

/// Returns a day of the simulated sky: GPS alone, and with `BeiDou`.
pub(super) fn simulated(site: &Site) -> Vec<Geometry> {
    let both = satellites();
    let gps = Fleet::Gps31.satellites();
    let at = |instant: usize| {
        let t_s = instant as f64 * STEP_S;
        [&gps, &both].map(|fleet| Geometry::seen(&sights(fleet, site, t_s, MASK_DEG.to_radians())))
    };
    (0..INSTANTS).flat_map(at).flatten().collect()
}

/// Returns all satellites of the simulated sky.
pub(super) fn satellites() -> Vec<Satellite> {
    [Fleet::Gps31, Fleet::BeidouGlobal].into_iter().flat_map(Fleet::satellites).collect()
}

/// Returns the geometries of real recordings, with the module's own sigmas; `None` if they are
/// missing.
pub(super) fn recorded() -> Result<Option<Vec<Geometry>>> {
    let mut geometries = Vec::new();
    for (station, systems) in [(&ESBC, "GCE"), (&DGAR, "G")] {
        let Some(recording) = station.load() else { return Ok(None) };
        let selection = Selection::new(systems, Frequency::Dual)?;
        let window = Window { every_s: STEP_S, ..Window::ALL };
        let lumps = replay::encode(&recording, &selection, &[], &window)?;
        let epochs = replay::corrected(&lumps, station.truth, MASK_DEG.to_radians(), None);
        geometries.extend(epochs.iter().filter_map(|epoch| of_epoch(station, epoch)));
    }
    Ok(Some(geometries))
}

fn of_epoch(station: &Station, epoch: &Epoch<CAPACITY>) -> Option<Geometry> {
    let site = Site::at(station.truth);
    let rows = epoch.observations().iter().map(|observation| Row {
        satellite: observation.satellite,
        line_of_sight: site.direction(observation.position),
        sigma_m: observation.sigma_m,
        y_m: clock_m(observation.satellite.constellation()),
    });
    Geometry::of(rows.collect())
}
