//! One frequency under a dense ionosphere.
//!
//! The delay is partly common to all satellites and grows towards the horizon. It goes into height
//! and clock and leaves little in the residuals. A level that takes it for independent noise is too
//! small.
//!
//! ```text
//! I = 40.3·10¹⁶ TEC m(E) / f²          TEC(φ) = TEC₀ (1 + g Δφ)
//! ```
//!
//! | symbol | meaning | value |
//! |---|---|---|
//! | `TEC₀` | electrons above the antenna | 60 to 150 TECU |
//! | `Δφ` | latitude of the pierce point minus that of the antenna, degrees | |
//! | `g` | slope to the south, as at the edge of the equatorial anomaly | 0, 0.06 per degree |

use raim::signal::encode::ubx;
use raim::signal::sky::atmosphere::ionosphere_m;

use crate::attack::prelude::*;

pub(super) const EVEN: Attack = Attack {
    name: "ionosphere",
    about: "one frequency, 60 to 150 TECU, three latitudes, no coefficients",
    branch: Branch::All,
    before: "72 of 288",
    note: "",
    run: |effort| run(effort, 0.0, None),
};

pub(super) const SLOPED: Attack = Attack {
    name: "ionosphere-slope",
    about: "the same with 6 % more or less per degree of latitude",
    branch: Branch::All,
    before: "116 of 288",
    note: "",
    run: |effort| run(effort, -0.06, None),
};

pub(super) const ZEROS: Attack = Attack {
    name: "ionosphere-zeros",
    about: "the same with broadcast coefficients that are all zero, if they are accepted",
    branch: Branch::All,
    before: "209 of 288",
    note: "coefficients of zero are refused",
    run: |effort| run(effort, 0.0, Some("IONO,0,0,0,0,0,0,0,0")),
};

pub(super) const FORGED: Attack = Attack {
    name: "ionosphere-forged",
    about: "one frequency, NOISE,AUTO, and after quiet minutes one forged page of coefficients",
    branch: Branch::All,
    before: "368 of 1,138, up to 75 m",
    note: "",
    run: forged,
};

/// Electron content above the antenna, TECU.
const ELECTRONS_TECU: [f64; 4] = [60.0, 90.0, 120.0, 150.0];

/// Latitudes of the antenna, degrees.
const LATITUDES_DEG: [f64; 3] = [5.0, 34.17, 62.0];

/// Frequency of L1, Hz. The slope is computed for it on both systems, which is 2 % too little for
/// `BeiDou`'s B1I.
const L1_HZ: f64 = 1_575.42e6;

/// Time between epochs, s.
const STEP_S: f64 = 600.0;

/// Latitude between the antenna and the pierce point for a satellite at the northern horizon,
/// degrees.
const FARTHEST_DEG: f64 = 14.0;

fn run(effort: Effort, slope_per_deg: f64, command: Option<&'static str>) -> Result<Vec<Figure>> {
    let skies: Vec<(f64, f64)> = LATITUDES_DEG
        .into_iter()
        .flat_map(|latitude_deg| ELECTRONS_TECU.map(|electrons_tecu| (latitude_deg, electrons_tecu)))
        .collect();
    let tallies: Vec<Tally> = skies
        .iter()
        .together(|&(latitude_deg, electrons_tecu)| {
            attempt(effort.pick(24, 144), latitude_deg, electrons_tecu, slope_per_deg, command)
        })
        .collect::<Result<_>>()?;
    let all: Tally = tallies.iter().collect();
    let mut figures = all.figures(0.0);
    for ((latitude_deg, electrons_tecu), tally) in skies.iter().zip(&tallies) {
        if tally.outcomes.misleading > 0 {
            let what = format!("of these at {latitude_deg:.0}° under {electrons_tecu} TECU");
            figures.push(Figure::plain(what, tally.misleading()));
        }
    }
    Ok(figures)
}

fn attempt(
    epochs: u32,
    latitude_deg: f64,
    electrons_tecu: f64,
    slope_per_deg: f64,
    command: Option<&str>,
) -> Result<Tally> {
    let simulation = Simulation {
        site: Site::geodetic(latitude_deg, 108.57, 400.0),
        step_s: STEP_S,
        electrons_tecu,
        ..Simulation::above_xian(0.0, epochs, 9)
    };
    let sky = Sky::of(&simulation, Frequency::Single)?;
    let bytes = sky.bytes(|index, epoch| {
        for sight in simulation.sights_at(index as u32) {
            let sin_elevation = sight.line_of_sight.up;
            let cos_elevation = (1.0 - sin_elevation * sin_elevation).max(0.0).sqrt();
            // The pierce point moves away with the cotangent of the elevation, up to the farthest
            // point at which the shell is visible.
            let off_deg = (3.2 * cos_elevation / sin_elevation.max(0.05)).min(FARTHEST_DEG);
            let north_deg = off_deg * sight.line_of_sight.north / cos_elevation.max(1e-6);
            let more_m =
                ionosphere_m(sin_elevation, L1_HZ, electrons_tecu) * (slope_per_deg * north_deg).max(-1.0);
            epoch.lengthen(sight.satellite, more_m);
        }
    })?;
    let mut victim = Victim::new(&["PHASE,ENROUTE", "TTA,60"], STEP_S)?;
    if let Some(command) = command {
        // The answer does not matter, because only later promises count.
        let _ = victim.obey(command)?;
    }
    victim.judge(bytes, sky.truth)
}

/// Coefficients `α0…α3, β0…β3` in units of the page, and those units as powers of two.
type Page = [i8; 8];
const STEPS: [i32; 8] = [-30, -27, -24, -24, 11, 14, 16, 16];

/// Coefficients of an ordinary day.
const ORDINARY: Page = [10, 2, -1, -1, 44, 2, -1, -2];

/// Latitude, degrees, start, thousands of seconds, and forged page: the harmful ones of 5,000 drawn
/// at random.
const PAGES: [(f64, f64, Page); 4] = [
    (34.17, 4.0, [115, 32, 75, 3, -66, 101, 42, 6]),
    (-30.0, 76.0, [109, -3, 113, 55, -26, 71, 116, -102]),
    (-30.0, 44.0, [91, -5, -2, -6, -41, 39, 126, 117]),
    (34.17, 164.0, [126, -3, 5, -5, -62, 107, 57, 70]),
];

/// Quiet epochs, and all epochs.
const QUIET: usize = 160;
const EPOCHS: u32 = 400;

fn forged(_: Effort) -> Result<Vec<Figure>> {
    let forged = |(latitude_deg, start_ks, page)| under_forged(latitude_deg, 1e3 * start_ks, page);
    let tally: Tally = PAGES.into_iter().together(forged).collect::<Result<_>>()?;
    Ok(tally.figures(0.0))
}

fn under_forged(latitude_deg: f64, start_s: f64, page: Page) -> Result<Tally> {
    // The pages were found with this seed.
    let seed = (start_s / 4e3) as u64;
    let simulation = Simulation {
        site: Site::geodetic(latitude_deg, 108.57, 400.0),
        ..Simulation::above_xian(start_s, EPOCHS, seed)
    };
    let recording = simulation.record();
    let mut encoder = Encoder::new(&recording.ephemerides, Selection::new("GC", Frequency::Single)?);
    let satellite = SatelliteId::new(Constellation::Gps, 1).context("GPS must have a satellite 1")?;
    let (mut victim, mut tally) = (Victim::new(&["PHASE,ENROUTE", "NOISE,AUTO"], 1.0)?, Tally::default());
    for (index, epoch) in recording.epochs.iter().enumerate() {
        let reported = match index {
            0 => Some(ORDINARY),
            QUIET => Some(page),
            _ => None,
        };
        let mut bytes = Vec::new();
        if let Some(reported) = reported {
            let klobuchar = std::array::from_fn(|term| f64::from(reported[term]) * 2_f64.powi(STEPS[term]));
            let reported = ubx::IonosphereAndUtc { klobuchar, leap_s: (18, 18), change: (1929, 7) };
            bytes.extend(ubx::ionosphere_and_utc(satellite, &reported, epoch.time)?);
        }
        bytes.extend(encoder.epoch(epoch)?);
        tally.add_all(&victim.receive(&bytes, simulation.site.position)?);
    }
    Ok(tally)
}
