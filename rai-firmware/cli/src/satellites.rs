//! Satellites of an epoch, one by one: direction, C/N0, residual, and the reason for which one is
//! not used.
//!
//! The module reports verdicts, not satellites. [`Watcher`] reads the same bytes beside it for
//! directions, C/N0 and orbits, and takes ranges and position from the module itself.
//!
//! ```text
//! w_i = r_i / (σ_i √(1 − h_i))     used        h_i = g_iᵀ (GᵀWG)⁻¹ g_i / σ_i²
//! w_i = r_i / (σ_i √(1 + h_i))     not used
//! ```
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `r` | [`Seen::residual_m`]: range minus distance and receiver clock | m |
//! | `σ` | [`Seen::sigma_m`] | m |
//! | `w` | [`Seen::w_test`] | 1 |
//! | `g`, `G` | row of the geometry: direction, and 1 for the clock of the system; of all used | 1 |
//! | `W` | diagonal of `1/σ²` | m⁻² |
//!
//! A forecast clock (`CLOCKAID`) is not part of `G`, so that w-tests are slightly too large with
//! it.
//!
//! References: W. Baarda, *A testing procedure for use in geodetic networks*, 1968 (w-test).

use std::fmt;

use embedded_hal::digital::OutputPin;
use nalgebra::{DMatrix, DVector};
use raim_core::epoch::{Epoch, Observation};
use raim_core::frame::{Ecef, LocalFrame};
use raim_core::report::{Report, Solution};
use raim_core::satellite::{Constellation, SatelliteId};
use raim_firmware::correction::CAPACITY;
use raim_firmware::ephemeris::{EphemerisError, Store};
use raim_firmware::input::{Event, Input};
use raim_firmware::raw::{RawEpoch, RawSatellite, RawSignal};
use raim_firmware::receiver::Receiver;
use raim_firmware::settings::Configuration;
use raim_firmware::time::GpsTime;

/// Treatment of a satellite in an epoch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Fate {
    /// Part of the position.
    Used,
    /// Excluded, because it contradicts the others.
    Excluded,
    /// Below the elevation mask.
    Low,
    /// No signal as strong as `CN0MASK`.
    Weak,
    /// System not in `SYSTEMS`.
    OtherSystem,
    /// No ephemeris, or a stale or disputed one.
    NoOrbit,
    /// Reported unhealthy by itself.
    Unhealthy,
    /// Left out for another reason: its bands, its range, or its twin.
    Other,
    /// Not judged, because the epoch has no position.
    NoPosition,
}

impl Fate {
    /// All fates, in the order of their numbers.
    pub const ALL: [Self; 9] = [
        Self::Used,
        Self::Excluded,
        Self::Low,
        Self::Weak,
        Self::OtherSystem,
        Self::NoOrbit,
        Self::Unhealthy,
        Self::Other,
        Self::NoPosition,
    ];

    /// Returns the reason in words.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Used => "used",
            Self::Excluded => "excluded: contradicts the others",
            Self::Low => "below the elevation mask",
            Self::Weak => "weaker than CN0MASK",
            Self::OtherSystem => "system not in SYSTEMS",
            Self::NoOrbit => "no usable ephemeris",
            Self::Unhealthy => "unhealthy",
            Self::Other => "range not usable",
            Self::NoPosition => "no position",
        }
    }
}

impl fmt::Display for Fate {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.words())
    }
}

/// A satellite of an epoch. Unknown values are `None`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// The satellite.
    pub satellite: SatelliteId,
    /// Angle from north over east, rad.
    pub azimuth_rad: Option<f64>,
    /// Angle above the horizon, rad.
    pub elevation_rad: Option<f64>,
    /// C/N0 of its strongest signal, dB-Hz.
    pub cn0_dbhz: Option<f64>,
    /// Range minus distance and receiver clock, m: positive for a range that is too long.
    pub residual_m: Option<f64>,
    /// Standard deviation of the range, m.
    pub sigma_m: Option<f64>,
    /// Residual over its standard deviation, dimensionless.
    pub w_test: Option<f64>,
    /// Treatment.
    pub fate: Fate,
}

/// The module's view of an epoch beyond its sentences.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct View {
    /// Time tag of the epoch.
    pub time: Option<GpsTime>,
    /// Receiver clock times the speed of light, m: that of the first system with one.
    pub clock_m: Option<f64>,
    /// Satellites of the epoch.
    pub satellites: Vec<Seen>,
}

/// Reader of the GNSS port beside a module.
#[derive(Debug, Default)]
pub struct Watcher {
    input: Input,
    orbits: Box<Store>,
    last: Option<Box<RawEpoch>>,
    place: Option<Ecef>,
}

/// Returns √(SSE/dof) of the ranges used in the last epoch of a module: the residuals relative to
/// their standard deviations, whatever the method that tested them. `None` without redundancy.
pub fn misfit<P: OutputPin>(module: &Receiver<P>) -> Option<f64> {
    let (epoch, report) = (module.last_epoch()?, module.last_report()?);
    let solution = report.solution.as_ref()?;
    let used = || epoch.observations().iter().filter(|one| report.used.contains(&one.satellite));
    let square = |one| Some((solution.residual_m::<f64>(one)? / one.sigma_m).powi(2));
    let sse: f64 = used().filter_map(square).sum();
    let mut systems: Vec<_> = used().map(|one| one.satellite.constellation()).collect();
    systems.sort_unstable();
    systems.dedup();
    let dof = used().count().checked_sub(3 + systems.len()).filter(|dof| *dof > 0)?;
    Some((sse / dof as f64).sqrt())
}

impl Watcher {
    /// Returns a reader before the first byte.
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes this week as the present until the bytes state another one, as the module does for the
    /// command `WEEK`.
    pub fn assume(&mut self, week: u16) {
        self.input.assume(week);
    }

    /// Takes the bytes that the module takes.
    pub fn hear(&mut self, bytes: &[u8], now_ms: u64) {
        let Self { input, orbits, last, .. } = self;
        input.feed(bytes, now_ms, |event| note(&event, orbits, last));
    }

    /// Ends the epoch that is still open, because the module has judged it.
    fn close(&mut self) {
        let Self { input, orbits, last, .. } = self;
        if input.has_open_epoch() {
            input.end_epoch(|event| note(&event, orbits, last));
        }
    }

    /// Returns the view of the epoch that the module has judged last, with its satellites in the
    /// order of their names.
    pub fn view<P: OutputPin>(&mut self, module: &Receiver<P>) -> View {
        self.close();
        let (epoch, report) = (module.last_epoch(), module.last_report());
        let solution = report.and_then(|report| report.solution.as_ref());
        if let Some(solution) = solution {
            self.place = Some(solution.position);
        }
        let judged = Judged::of(epoch, report);
        let raw = self.last.take();
        let mut satellites: Vec<Seen> = Vec::new();
        if let Some(raw) = &raw {
            let seen = |one| self.seen(one, raw.time, judged.as_ref(), module.configuration());
            satellites.extend(raw.satellites.iter().map(seen));
        }
        satellites.sort_by_key(|seen| seen.satellite);
        View {
            time: raw.as_ref().map(|raw| raw.time),
            clock_m: solution.and_then(|solution| solution.clocks_m.iter().copied().flatten().next()),
            satellites,
        }
    }

    fn seen(
        &self,
        raw: &RawSatellite,
        time: GpsTime,
        judged: Option<&Judged<'_>>,
        configuration: &Configuration,
    ) -> Seen {
        let satellite = raw.satellite;
        let cn0_dbhz =
            raw.signals.iter().filter_map(RawSignal::cn0_dbhz).map(f64::from).max_by(f64::total_cmp);
        let orbit = self.orbits.get(satellite, time);
        let of_orbit = || {
            let range_m = raw.signals.first()?.range_m;
            orbit.ok()?.at(time, range_m).ok().map(|state| state.position)
        };
        let row = judged.and_then(|judged| judged.row(satellite));
        let position = row.as_ref().map(|row| row.position).or_else(of_orbit);
        let toward =
            self.place.zip(position).map(|(place, position)| LocalFrame::at(place).rotate(position - place));
        let elevation_rad = toward.map(|toward| toward.up.atan2(toward.east.hypot(toward.north)));
        let fate = match (&row, judged) {
            (Some(row), _) => row.fate,
            (None, None) => Fate::NoPosition,
            (None, Some(_)) => left_out(satellite, orbit.err(), elevation_rad, cn0_dbhz, configuration),
        };
        Seen {
            satellite,
            azimuth_rad: toward
                .map(|toward| toward.east.atan2(toward.north).rem_euclid(std::f64::consts::TAU)),
            elevation_rad,
            cn0_dbhz,
            residual_m: row.as_ref().and_then(|row| row.residual_m),
            sigma_m: row.as_ref().map(|row| row.sigma_m),
            w_test: row.as_ref().and_then(|row| row.w_test),
            fate,
        }
    }
}

fn note(event: &Event<'_>, orbits: &mut Store, last: &mut Option<Box<RawEpoch>>) {
    let now = last.as_ref().map(|raw| raw.time);
    match event {
        Event::Ephemeris(ephemeris) => {
            orbits.insert(*ephemeris, now);
        }
        Event::Redated(present) => orbits.redate(*present),
        Event::Epoch(raw, _) => {
            orbits.observe(raw.satellites.iter().map(|satellite| satellite.satellite));
            *last = Some(Box::new((*raw).clone()));
        }
        _ => {}
    }
}

/// Returns the reason for which a satellite did not reach the test.
fn left_out(
    satellite: SatelliteId,
    orbit: Option<EphemerisError>,
    elevation_rad: Option<f64>,
    cn0_dbhz: Option<f64>,
    configuration: &Configuration,
) -> Fate {
    let letter = satellite.name().0;
    if !configuration.systems.contains(letter) {
        return Fate::OtherSystem;
    }
    match orbit {
        Some(EphemerisError::Unhealthy) => return Fate::Unhealthy,
        Some(
            EphemerisError::Missing
            | EphemerisError::Stale
            | EphemerisError::Disputed
            | EphemerisError::Unproved,
        ) => {
            return Fate::NoOrbit;
        }
        Some(EphemerisError::TravelTime) | None => {}
    }
    if elevation_rad.is_some_and(|elevation_rad| elevation_rad < configuration.mask_rad()) {
        return Fate::Low;
    }
    if cn0_dbhz.is_some_and(|cn0_dbhz| cn0_dbhz < configuration.signal_mask_db_hz) {
        return Fate::Weak;
    }
    Fate::Other
}

/// A range of the epoch that the module has tested.
struct Row {
    position: Ecef,
    residual_m: Option<f64>,
    sigma_m: f64,
    w_test: Option<f64>,
    fate: Fate,
}

/// An epoch with a position, as the module has judged it.
struct Judged<'e> {
    epoch: &'e Epoch<CAPACITY>,
    report: &'e Report<CAPACITY>,
    solution: &'e Solution,
    geometry: Geometry,
}

impl<'e> Judged<'e> {
    fn of(epoch: Option<&'e Epoch<CAPACITY>>, report: Option<&'e Report<CAPACITY>>) -> Option<Self> {
        let (epoch, report) = (epoch?, report?);
        let solution = report.solution.as_ref()?;
        let is_used = |observation: &&Observation| report.used.contains(&observation.satellite);
        let used: Vec<&Observation> = epoch.observations().iter().filter(is_used).collect();
        Some(Self { epoch, report, solution, geometry: Geometry::of(solution.position, &used) })
    }

    fn row(&self, satellite: SatelliteId) -> Option<Row> {
        let observation = self.epoch.observations().iter().find(|one| one.satellite == satellite)?;
        let is_used = self.report.used.contains(&satellite);
        let residual_m = self.solution.residual_m::<f64>(observation);
        let suspect = self.report.excluded.iter().find(|suspect| suspect.satellite == satellite);
        Some(Row {
            position: observation.position,
            residual_m,
            sigma_m: observation.sigma_m,
            w_test: residual_m.and_then(|residual_m| self.geometry.w_test(observation, residual_m, is_used)),
            fate: match (is_used, suspect) {
                (true, _) => Fate::Used,
                (false, Some(_)) => Fate::Excluded,
                (false, None) => Fate::Other,
            },
        })
    }
}

/// Geometry of the satellites used.
struct Geometry {
    place: Ecef,
    systems: Vec<Constellation>,
    /// `(GᵀWG)⁻¹`, m²; `None` if it is singular.
    covariance_m2: Option<DMatrix<f64>>,
}

impl Geometry {
    fn of(place: Ecef, used: &[&Observation]) -> Self {
        let mut systems: Vec<_> = used.iter().map(|one| one.satellite.constellation()).collect();
        systems.sort_unstable();
        systems.dedup();
        let mut geometry = Self { place, systems, covariance_m2: None };
        let columns = 3 + geometry.systems.len();
        let mut normal = DMatrix::zeros(columns, columns);
        for one in used {
            let row = geometry.row(one);
            normal += &row * row.transpose() / (one.sigma_m * one.sigma_m);
        }
        geometry.covariance_m2 = normal.try_inverse();
        geometry
    }

    fn row(&self, observation: &Observation) -> DVector<f64> {
        let toward = observation.position - self.place;
        let distance_m = observation.position.distance_m(self.place);
        let system = observation.satellite.constellation();
        let direction = [toward.x_m, toward.y_m, toward.z_m].map(|metres| -metres / distance_m);
        let clocks = self.systems.iter().map(|one| f64::from(u8::from(*one == system)));
        DVector::from_iterator(3 + self.systems.len(), direction.into_iter().chain(clocks))
    }

    /// Returns the w-test; `None` if nothing else tests the range.
    fn w_test(&self, observation: &Observation, residual_m: f64, is_used: bool) -> Option<f64> {
        /// Share of a range's variance below which its residual is rounding.
        const LEAST_SHARE: f64 = 1e-9;
        let covariance_m2 = self.covariance_m2.as_ref()?;
        let row = self.row(observation);
        let leverage = (row.transpose() * covariance_m2 * &row)[(0, 0)] / observation.sigma_m.powi(2);
        let share = if is_used { 1.0 - leverage } else { 1.0 + leverage };
        (share > LEAST_SHARE).then(|| residual_m / (observation.sigma_m * share.sqrt()))
    }
}

/// Heading of a table with a row for each satellite of each epoch.
pub const HEADING: &str =
    "week,tow,satellite,azimuth_deg,elevation_deg,cn0_dbhz,residual_m,sigma_m,w_test,used,reason";

impl Seen {
    /// Returns the row of the satellite in the columns of [`HEADING`]. Unknown values are empty.
    pub fn row(&self, time: GpsTime) -> String {
        let number = |value: Option<f64>, decimals: usize| {
            value.map_or_else(String::new, |value| format!("{value:.decimals$}"))
        };
        let degrees = |radians: Option<f64>| number(radians.map(f64::to_degrees), 2);
        format!(
            "{},{:.3},{},{},{},{},{},{},{},{},{}",
            time.week,
            f64::from(time.tow_ms) * 1e-3,
            self.satellite,
            degrees(self.azimuth_rad),
            degrees(self.elevation_rad),
            number(self.cn0_dbhz, 2),
            number(self.residual_m, 3),
            number(self.sigma_m, 3),
            number(self.w_test, 3),
            u8::from(self.fate == Fate::Used),
            self.fate
        )
    }
}
