//! Where the module said it was, and how wrong that was.

use std::io::Write;
use std::path::Path;

use anyhow::{Context, Result, ensure};
use rai_core::frame::{Ecef, Enu, LocalFrame};
use rai_firmware::time::GpsTime;

use super::Lump;
use crate::sentence::{self, EpochOutput};

/// Where the antenna really was.
#[derive(Clone, Debug, PartialEq)]
pub enum Truth {
    /// A fixed point.
    Fixed(Ecef),
    /// A point for each instant, in the order of time.
    Moving(Vec<(GpsTime, Ecef)>),
}

impl Truth {
    /// Reads `X,Y,Z` in metres.
    ///
    /// # Errors
    /// What is wrong with it, and an example.
    pub fn parse(text: &str) -> Result<Self> {
        let numbers: Vec<f64> =
            text.split(',').map(|part| part.trim().parse()).collect::<Result<_, _>>().with_context(|| {
                format!("truth {text:?} is not X,Y,Z in metres, as in 3582104.9,532590.2,5232755.3")
            })?;
        ensure!(numbers.len() == 3, "truth {text:?} has {} numbers, not 3: X,Y,Z in metres", numbers.len());
        let point = Ecef::new(numbers[0], numbers[1], numbers[2]);
        let height_m = LocalFrame::at(point).height_m();
        ensure!(
            point.is_finite() && height_m.abs() < 1e5,
            "truth {text:?} is no position near the ground: {:.0} km above the ellipsoid",
            height_m * 1e-3
        );
        Ok(Self::Fixed(point))
    }

    /// Reads rows of `week,tow,x_m,y_m,z_m`, with a heading line.
    ///
    /// # Errors
    /// The file or the line that cannot be read.
    pub fn from_csv(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path).with_context(|| format!("truth file {}", path.display()))?;
        let mut points = Vec::new();
        for (index, line) in text.lines().enumerate().skip(1).filter(|(_, line)| !line.trim().is_empty()) {
            let numbers: Vec<f64> = line.split(',').filter_map(|field| field.trim().parse().ok()).collect();
            let place = || format!("{}:{}", path.display(), index + 1);
            ensure!(numbers.len() == 5, "{}: not week,tow,x_m,y_m,z_m: {line:?}", place());
            let time = GpsTime { week: numbers[0] as u16, tow_ms: (numbers[1] * 1e3).round() as u32 };
            points.push((time, Ecef::new(numbers[2], numbers[3], numbers[4])));
        }
        ensure!(!points.is_empty(), "{} holds no position", path.display());
        points.sort_by_key(|(time, _)| *time);
        Ok(Self::Moving(points))
    }

    /// Where the antenna was at that time; `None` where that is not known.
    pub fn at(&self, time: GpsTime) -> Option<Ecef> {
        match self {
            Self::Fixed(point) => Some(*point),
            Self::Moving(points) => {
                let index = points.binary_search_by_key(&time, |(time, _)| *time).ok()?;
                points.get(index).map(|(_, point)| *point)
            }
        }
    }
}

/// One epoch of a run.
#[derive(Clone, Debug)]
pub struct Moment {
    /// Its time tag.
    pub time: GpsTime,
    /// Seconds after the first epoch of the recording.
    pub elapsed_s: f64,
    /// What the module said; `None` where it said nothing.
    pub output: Option<EpochOutput>,
    /// Position minus truth, east, north, up, m; `None` without a fix or a truth.
    pub error: Option<Enu>,
}

/// All epochs of a run.
pub type Track = Vec<Moment>;

/// Puts what the module said of each lump beside the truth.
///
/// # Errors
/// A sentence that cannot be read.
pub fn track(lumps: &[Lump], sentences: &[String], truth: Option<&Truth>) -> Result<Track> {
    let moment = |(lump, text): (&Lump, &String)| {
        let output = sentence::epochs(text)?.pop();
        let position = output.as_ref().and_then(|output| output.position);
        let error = position
            .zip(truth.and_then(|truth| truth.at(lump.time)))
            .map(|(position, truth)| LocalFrame::at(truth).rotate(position.to_ecef() - truth));
        Ok(Moment { time: lump.time, elapsed_s: lump.elapsed_s, output, error })
    };
    lumps.iter().zip(sentences).map(moment).collect()
}

/// One row per epoch, in the columns of the interface.
///
/// # Errors
/// The writer's own.
pub fn write_csv(track: &Track, out: &mut impl Write) -> std::io::Result<()> {
    writeln!(
        out,
        "week,tow,state,reason,lat_deg,lon_deg,height_m,used,excluded,dof,statistic,threshold,hpl_m,vpl_m,\
         horizontal_error_m,vertical_error_m"
    )?;
    track.iter().try_for_each(|moment| writeln!(out, "{}", row(moment)))
}

fn row(moment: &Moment) -> String {
    let number = |value: Option<f64>, decimals: usize| {
        value.map_or(String::new(), |value| format!("{value:.decimals$}"))
    };
    let output = moment.output.as_ref();
    let state = output.map(|output| &output.state);
    let position = output.and_then(|output| output.position);
    let excluded: Vec<String> = output
        .into_iter()
        .flat_map(|output| &output.excluded)
        .map(|excluded| excluded.satellite.to_string())
        .collect();
    [
        moment.time.week.to_string(),
        format!("{:.3}", f64::from(moment.time.tow_ms) * 1e-3),
        state.map_or(String::new(), |state| state.state.to_string()),
        state.map_or(String::new(), |state| state.reason.clone()),
        number(position.map(|position| position.latitude_rad.to_degrees()), 9),
        number(position.map(|position| position.longitude_rad.to_degrees()), 9),
        number(position.map(|position| position.height_m), 3),
        state.map_or(String::new(), |state| state.used.to_string()),
        excluded.join(" "),
        state.and_then(|state| state.dof).map_or(String::new(), |dof| dof.to_string()),
        number(state.and_then(|state| state.statistic), 3),
        number(state.and_then(|state| state.threshold), 3),
        number(state.and_then(|state| state.hpl_m), 1),
        number(state.and_then(|state| state.vpl_m), 1),
        number(moment.error.map(Enu::horizontal), 3),
        number(moment.error.map(|error| error.up.abs()), 3),
    ]
    .join(",")
}
